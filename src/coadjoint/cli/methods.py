"""Methods of integration as a command shows them: what each keeps of a system, and why.

Comes in: the record of `coadjoint.bounded.methods_bounded`. Goes out: a table of those that apply,
the default first, and a line for each of the others.
Read next: `coadjoint.prove.methods`, which judges them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from coadjoint.cli.output import print_table, say
from coadjoint.methods import (
    OF_PATHS,
    PLAIN,
    PLAIN_WITH_NOISE,
    list_fitting,
    list_kept,
    list_unfit,
    tell_order,
)


def print_methods(record: Mapping[str, Any]) -> None:
    """The methods of a system: order, what is kept, whether a step is a Poisson map, and cost."""
    name, methods = record["system"], record["methods"]
    if not methods:
        say(f"The certificate of {name} judges no methods: run `coadjoint regenerate`.")
        return
    fit, is_noisy = list_fitting(methods), "noise" in record["structure"].get("acts", ())
    if fit:
        columns = ("method", ">order", "keeps exactly", "keeps nearly", "why", "a step takes")
        print_table(columns, list(map(_row, fit)), f"Methods of {name} with a fixed step")
        say("keeps nearly: up to an error of the order of the method")
    if is_noisy:
        say(f"With noise, {OF_PATHS}.")
    first = next((each["name"] for each in fit if each["rank"] == 1), "")
    say(f'"auto" with step= takes {first or (PLAIN_WITH_NOISE if is_noisy else PLAIN)}.')
    for why, names in list_unfit(methods).items():
        say(f"{', '.join(names)} {'do' if len(names) > 1 else 'does'} not apply: {why}.")


def _row(method: Mapping[str, Any]) -> tuple[str, ...]:
    """A line of the table."""
    return (
        method["name"],
        tell_order(method["name"], method["order"]),
        ", ".join(list_kept(method)) or "-",
        ", ".join(method["nearly"]) or "-",
        method["decides"],
        method["cost"],
    )
