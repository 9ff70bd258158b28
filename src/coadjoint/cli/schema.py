"""Command ``schema``: the JSON Schema of specs, for editors that complete and check them.

Comes in: nothing. Goes out: JSON on standard output. Read next: `coadjoint.spec.schema`.
"""

from __future__ import annotations

import click

from coadjoint.cli.output import print_json


@click.command("schema")
def command() -> None:
    """Print the JSON Schema of specs, for editors."""
    from coadjoint.spec.schema import json_schema

    print_json(json_schema())
