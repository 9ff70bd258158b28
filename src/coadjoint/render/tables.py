"""Render, tables: tables of numbers as lines of text, for kernels and solvers that loop over them.

Comes in: Programs with a `Table`, and the loops of recurrences. Goes out: plain records that
templates print.
Read next: `coadjoint.render.kernels`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from coadjoint.lower.program import Program
from coadjoint.render.printers import WIDTH
from coadjoint.render.solvers import LoopText


@dataclass(frozen=True)
class TableText:
    """The table of coefficients of a system as lines of numbers, each number with a comma.

    Attributes:
        starts: Where the entries of each row begin, and where those of the last one end.
        left: Places of the left factors.
        right: Places of the right factors.
        coefficients: The numbers that multiply both.
        scaled: Rows that are multiplied by scales.
        rows: How many rows a vector has.
        size: How many values follow from these, with the rows themselves.
    """

    starts: list[str]
    left: list[str]
    right: list[str]
    coefficients: list[str]
    scaled: list[str]
    rows: int
    size: int


def arrange_table(programs: Iterable[Program]) -> tuple[TableText | None, dict[str, int]]:
    """The table that functions loop over, all of them together, and the first row of each.

    The rates and their derivative along a vector have the same rows.
    """
    tables = {each.name: each.table for each in programs if each.table}
    if not tables:
        return None, {}
    firsts, entries = dict[Any, int](), list[tuple[int, int, int, Fraction]]()
    for table in tables.values():
        if table.entries not in firsts:
            first = firsts[table.entries] = entries[-1][0] + 1 if entries else 0
            entries += ((first + i, j, k, c) for i, j, k, c in table.entries)
    whole = replace(tables["rhs"], entries=tuple(entries))
    size = len(whole.vectors[0])
    columns = {
        name.removeprefix("table_"): fill(map(repr, column))
        for name, column in whole.columns().items()
    }
    text = TableText(rows=size - len(whole.scaled), size=size, **columns)
    return text, {name: firsts[table.entries] for name, table in tables.items()}


def tell_loops(loops: LoopText, *, is_empty: bool = False) -> dict[str, Any]:
    """What templates read of the loops of recurrences, perhaps with empty tables."""
    return {
        "scales": loops.scales,
        "sizes": loops.sizes,
        "star_sizes": loops.star_sizes,
        "tables": {
            name: () if is_empty else fill(map(repr, column))
            for name, column in loops.numbers.items()
        },
    }


def fill(entries: Iterable[str]) -> list[str]:
    """Entries of a table as lines, each with its comma; `textwrap` would take half a second."""
    lines = [""]
    for entry in entries:
        if len(lines[-1]) + len(entry) + 2 > WIDTH - 8:
            lines.append("")
        lines[-1] += f" {entry}," if lines[-1] else f"{entry},"
    return lines
