"""`coadjoint schema` prints the schema that editors read."""

from __future__ import annotations

import json


def test_schema_describes_the_keys_of_a_spec(run):
    """The schema is JSON and knows the tables of a spec."""
    result = run("schema")
    assert result.exit_code == 0
    schema = json.loads(result.stdout)
    assert {"title", "algebra", "variables", "lagrangian", "claims"} <= set(schema["properties"])
