"""Schema: the checked-in JSON Schema is current, and editors' linters accept the shipped specs."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from coadjoint.resources import derivations_folder
from coadjoint.spec.core.parts import Part
from coadjoint.spec.schema import SpecFile, json_schema

SPECS = sorted(Path(derivations_folder()).glob("*.toml"))
TOMBI = shutil.which("tombi", path=str(Path(sys.executable).parent)) or shutil.which("tombi")


def every_table(schema):
    """Every description of a table in the schema."""
    return [schema, *schema["$defs"].values()]


def test_checked_in_schema_is_current():
    """derivations/spec.schema.json is what `coadjoint schema` prints."""
    text = (derivations_folder() / "spec.schema.json").read_text(encoding="utf-8")
    assert text == json.dumps(json_schema(), indent=2) + "\n"


def test_every_key_is_described():
    """Editors show a description for each key of each table."""
    keys = 0
    for table in every_table(json_schema()):
        table = table["anyOf"][1] if "anyOf" in table else table
        assert table["additionalProperties"] is False
        for name, key in table["properties"].items():
            assert key["description"], name
            keys += 1
    assert keys > 25


def test_schema_has_no_null():
    """TOML has no null, so no editor may offer one."""
    assert "null" not in json.dumps(json_schema())


def test_shipped_specs_name_the_schema():
    """The first line of each spec tells editors where the schema is."""
    assert len(SPECS) >= 3
    for path in SPECS:
        assert path.read_text(encoding="utf-8").startswith("#:schema spec.schema.json\n")


def every_model(base):
    """A model and all that are made of it."""
    return [base, *(model for each in base.__subclasses__() for model in every_model(each))]


def test_models_are_frozen_and_closed():
    """No model converts values, takes unknown keys, or can be changed."""
    kinds = set(every_model(Part))
    assert SpecFile in kinds
    assert len(kinds) >= 30
    for cls in kinds:
        assert cls.model_config["extra"] == "forbid"
        assert cls.model_config["strict"]
        assert cls.model_config["frozen"]


def lint(path):
    """Exit status and text of the linter, offline."""
    done = subprocess.run([TOMBI, "lint", "--offline", str(path)], capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


@pytest.mark.skipif(TOMBI is None, reason="the linter tombi is not installed")
def test_linter_accepts_the_shipped_specs(tmp_path):
    """tombi, which knows only the schema, finds nothing; and it does find a spoiled key."""
    for path in SPECS:
        status, text = lint(path)
        assert status == 0, text
        assert "not found" not in text
    shutil.copy(derivations_folder() / "spec.schema.json", tmp_path)
    spoiled = tmp_path / "spoiled.toml"
    text = SPECS[0].read_text(encoding="utf-8").replace('role = "velocity"', "rol = 3")
    spoiled.write_text(text, encoding="utf-8")
    status, text = lint(spoiled)
    assert status != 0
    assert "rol" in text
