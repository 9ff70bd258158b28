"""Labels of pictures: units, symbols and times, as matplotlib writes them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from coadjoint.notation.names import GREEK

if TYPE_CHECKING:
    from coadjoint.solve.solution import Solution


def unit_label(unit: str) -> str:
    """A unit for an axis, its exponents raised."""
    raised = re.sub(r"\^(-?\d+)", r"$^{\1}$", unit)
    return "" if unit in ("", "1") else f"[{raised}]"


def symbol_label(name: str) -> str:
    """A Greek name as its letter, in matplotlib's own TeX; other names as they are."""
    return rf"$\{name}$" if name in GREEK else name


def tell_time(solution: Solution, at: int) -> str:
    """The time of a sample, with its unit."""
    return f"t = {solution.time[at]:.4g} {unit_label(solution.unit('time'))}".strip()
