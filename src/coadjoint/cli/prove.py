"""Command ``prove``: the verdict on every claim about a system, and the findings.

Comes in: a spec. Goes out: its certificate, with the time that each proof took, and a
counterexample for what is false. Read next: `coadjoint.prove.claims`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import click

from coadjoint.cli.arguments import seconds_option, size_option, spec_path, system_argument
from coadjoint.cli.output import json_option, print_json, print_table, say
from coadjoint.notation.numbers import shorten_numbers


@click.command("prove")
@system_argument
@size_option
@seconds_option
@json_option
def command(system: str, sizes: dict[str, int], seconds: int | None, as_json: bool) -> int:
    """Prove every claim about a system, or refute it.

    Jacobi identity, Casimirs, conserved quantities, and equality of the routes. The exit status is
    1 if a claim is refuted, or numerically supported where the spec does not accept that.
    """
    from coadjoint.bounded import prove_bounded

    record = prove_bounded(spec_path(system), sizes=sizes, seconds=seconds)
    if as_json:
        print_json(record)
    else:
        _print(record)
    for failure in record["failures"]:
        say(f"error: {failure}", err=True)
    return 0 if record["holds"] else 1


def _print(record: Mapping[str, Any]) -> None:
    """The certificate as two tables: claims and findings."""
    claims = [
        (_verdict(claim), claim["statement"], shorten_numbers(claim["method"]), _time(claim))
        for claim in record["claims"]
    ]
    title = f"Certificate of {record['system']}"
    print_table(("verdict", "statement", "method", ">time"), claims, title=title)
    findings = [
        (
            each["statement"],
            shorten_numbers(each["method"]),
            each["scope"],
            each["error"] or "none",
            _time(each),
        )
        for each in record["findings"]
    ]
    if findings:
        print_table(("finding", "method", "scope", "error", ">time"), findings)


def _verdict(claim: Mapping[str, Any]) -> str:
    """The verdict, with the word of the spec on numerical support."""
    accepted = {True: " (accepted)", False: " (not accepted)", None: ""}[claim.get("accepted")]
    return str(claim["verdict"]) + accepted


def _time(entry: Mapping[str, Any]) -> str:
    return f"{entry['seconds'] * 1e3:.1f} ms"
