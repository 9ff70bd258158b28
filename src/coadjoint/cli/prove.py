"""Command ``prove``: every claim about a system, proved or refuted.

Comes in: a spec. Goes out: its certificate, with the time that each proof took, and a
counter-example for what is false. Read next: `coadjoint.prove.claims`.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

from coadjoint.cli.arguments import seconds_option, spec_path, system_argument
from coadjoint.cli.output import json_option, print_json, print_table, say


@click.command("prove")
@system_argument
@seconds_option
@json_option
def command(system: str, seconds: int | None, as_json: bool) -> int:
    """Prove every claim about a system, or refute it.

    Jacobi identity, Casimirs, conserved quantities, and equality of the routes.
    """
    from coadjoint.bounded import prove_bounded

    record = prove_bounded(spec_path(system), seconds=seconds)
    if as_json:
        print_json(record)
    else:
        _print(record)
    for claim in _refuted(record):
        say(f"error: refuted: {claim['statement']}. {_refutation(claim)}", err=True)
    return 1 if _refuted(record) else 0


def certificate_record(argument: Mapping[str, str]) -> dict[str, Any]:
    """The certificate of a spec as JSON values, times included; runs in a bounded child."""
    from coadjoint.prove import prove
    from coadjoint.sandbox import report_progress
    from coadjoint.spec import read_spec

    report_progress("prove", 0, 1)
    certificate = prove(read_spec(Path(argument["path"])))
    claims = [claim.as_record() | {"seconds": claim.seconds} for claim in certificate.claims]
    return {"system": certificate.system, "holds": certificate.holds, "claims": claims}


def _print(record: Mapping[str, Any]) -> None:
    """The certificate as a table."""
    print_table(
        ("verdict", "statement", "method", ">time"),
        [
            (
                claim["verdict"],
                claim["statement"],
                claim["method"],
                f"{claim['seconds'] * 1e3:.1f} ms",
            )
            for claim in record["claims"]
        ],
        title=f"Certificate of {record['system']}",
    )


def _refuted(record: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The claims that are false."""
    return [claim for claim in record["claims"] if claim["verdict"] == "refuted"]


def _refutation(claim: Mapping[str, Any]) -> str:
    """Where a claim fails, and by how much."""
    point = ", ".join(f"{name} = {value}" for name, value in claim["counterexample"].items())
    return f"At {point} the difference is {claim['defect']}; expected 0."
