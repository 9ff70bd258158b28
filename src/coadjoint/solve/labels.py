"""Labels of pictures: units, symbols and times, as matplotlib writes them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from coadjoint.notation.names import name as write
from coadjoint.notation.names import spell
from coadjoint.notation.prose import Formula, read_prose

if TYPE_CHECKING:
    from coadjoint.solve.solution import Solution
    from coadjoint.solve.system import System

#: Characters of the formula of a Casimir up to which a legend has room for it.
SHORT: Final = 24


def unit_label(unit: str) -> str:
    """A unit for an axis, its exponents raised."""
    several = len(set(unit.split(", "))) > 1  # one for each component: the axis has none of its own
    return "" if unit in ("", "1") or several else f"[{_raise(unit)}]"


def _raise(unit: str) -> str:
    """A unit with its exponents raised."""
    return re.sub(r"\^(-?\d+)", r"$^{\1}$", unit)


def symbol_label(name: str) -> str:
    r"""A name as a symbol with its number below, and that of the member, ``S1[0]``, behind it.

    >>> symbol_label("q[0]"), symbol_label("S1[12]"), symbol_label("casimir1")
    ('q$_{0}$', 'S$_{1,12}$', '$\\mathcal{C}_1$')
    """
    whole, _, member = name.partition("[")
    letter, below = spell(whole)
    if max(letter) > "\uffff":  # which fonts of pictures lack
        return f"${write(whole).latex}$"
    numbers = ",".join(each for each in (below, member.rstrip("]")) if each)
    return f"{letter}$_{{{numbers}}}$" if numbers else letter


def observable_label(system: System, name: str) -> str:
    """An observable in a legend: a Casimir by its formula where that is short, else by a letter."""
    number = name.removeprefix("casimir")
    if number == name or not number.isdigit():
        label = symbol_label(name)
        return label if "$" in label else label.replace("_", " ")
    texts = system.certificate.get("casimirs", [])
    text = texts[int(number) - 1] if int(number) <= len(texts) else ""
    return _write_formula(text) or symbol_label(name)


def _write_formula(text: str) -> str:
    """A short formula as matplotlib writes it; "" where it cannot, or there is no room."""
    from matplotlib.mathtext import MathTextParser

    text = re.sub(r"dot\((\w+), \1\)", r"norm(\1)^2", text)
    parts = read_prose(text)
    if len(text) > SHORT or len(parts) != 1 or not isinstance(parts[0], Formula):
        return ""
    shown = re.sub(r"\\[lr]vert ?", "|", f"${parts[0].written.latex}$")
    # in a legend a fraction above a line is too small to read
    shown = re.sub(r"\\frac\{((?:[^{}+-]|\{\w*\})*)\}\{(\w+)\}", r"{\1}/\2", shown)
    try:
        MathTextParser("path").parse(shown)
    except ValueError:  # of LaTeX it knows a part
        return ""
    return shown


def number_label(text: str) -> str:
    r"""A number with its power of ten raised, and what stands behind it.

    >>> number_label("1.5e-12 absolute")
    '1.5$\\cdot 10^{-12}$ absolute'
    """
    return re.sub(r"e([-+]\d+)", lambda power: rf"$\cdot 10^{{{int(power[1])}}}$", text)


def time_axis(solution: Solution) -> str:
    """The independent variable of an axis: the time, or what is in its place."""
    return f"{solution.system.clock[1]} {unit_label(solution.unit('time'))}".rstrip()


def tell_time(solution: Solution, at: int) -> str:
    """The time of a sample, with its unit."""
    unit = solution.unit("time").removeprefix("1")  # of what has no dimension
    return f"{solution.system.clock[0]} = {solution.time[at]:.4g} {_raise(unit)}".rstrip()
