"""Labels of pictures: units, symbols and times, as matplotlib writes them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from coadjoint.notation.names import spell

if TYPE_CHECKING:
    from coadjoint.solve.solution import Solution


def unit_label(unit: str) -> str:
    """A unit for an axis, its exponents raised."""
    raised = re.sub(r"\^(-?\d+)", r"$^{\1}$", unit)
    several = len(set(unit.split(", "))) > 1  # one for each component: the axis has none of its own
    return "" if unit in ("", "1") or several else f"[{raised}]"


def symbol_label(name: str) -> str:
    """A name as a symbol with its number below."""
    whole, bracket, member = name.partition("[")  # of a member: its number stands in brackets
    letter, below = spell(whole)
    return (f"{letter}$_{{{below}}}$" if below else letter) + bracket + member


def tell_time(solution: Solution, at: int) -> str:
    """The time of a sample, with its unit."""
    return f"t = {solution.time[at]:.4g} {unit_label(solution.unit('time'))}".strip()
