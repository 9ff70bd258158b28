r"""Equations of a page whose sums break at their signs, wherever a screen or paper ends.

No browser breaks a formula by itself; formulas that stand one after the other in a line it does.
Comes in: MathML of an equation. Goes out: its left side and the addends of its right one, and what
of the size of letters fits on paper. Read next: `coadjoint.render.widths`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final, NamedTuple
from xml.etree import ElementTree as ET

from coadjoint.notation.written import row
from coadjoint.render.widths import PAPER, SMALLEST, measure

#: Width of a right side, in sizes of letters, up to which it stays in one piece.
WHOLE: Final = 12.0
#: Width of a line of a phone, and the smallest part of the size of letters to be read there.
PHONE, SMALL = 18.0, 0.65
#: Room before a sum of several lines, and before a right side below the left one.
HANGING, INDENT = 2.0, 1.0
#: Width of an equation up to which two of them stand side by side on paper.
HALF: Final = 16.0


class OnPhone(NamedTuple):
    """How an equation stands on a phone.

    Attributes:
        is_below: Whether its right side stands below a left one that is long.
        part: The part of the size of letters at which it fits.
    """

    is_below: bool
    part: float


def split_sides(mathml: str) -> tuple[str, str]:
    """The two sides of an equation as formulas of their own, the sign with the second one.

    >>> left, right = split_sides("<math><mrow><mi>a</mi><mo>=</mo><mi>b</mi></mrow></math>")
    >>> left
    '<math displaystyle="true"><mi>a</mi></math>'
    >>> long = "<mo>+</mo>".join(f"<mi>{c * 9}</mi>" for c in "bcd")
    >>> made = split_sides(f"<math><mrow><mi>a</mi><mo>=</mo><mrow>{long}</mrow></mrow></math>")[1]
    >>> made.count("<math"), made.count("> <")
    (3, 2)
    """
    left, *pieces = _list_pieces(mathml)
    if not pieces:
        return "", mathml
    shown = " ".join(f'<math displaystyle="true"><mrow>{each}</mrow></math>' for each in pieces)
    if len(pieces) > 1:
        shown = f'<span class="sum">{shown}</span>'
    return f'<math displaystyle="true">{left}</math>', shown


def break_inline(mathml: str) -> str:
    """A formula within words, which may break at its sign of equality and those of its sum.

    >>> break_inline("<math><mi>a</mi><mo>=</mo><mi>b</mi></math>")
    '<math><mi>a</mi></math> <math><mo rspace="0.3em">=</mo><mi>b</mi></math>'
    """
    pieces = _list_pieces(mathml)
    return " ".join(f"<math>{each}</math>" for each in pieces) if pieces[1:] else mathml


def _list_pieces(mathml: str) -> list[str]:
    """The left side of an equation, and the addends of its right one behind the sign."""
    left, right = _part(mathml)
    if right is None:
        return [left]
    first, *others = _split_sum(right)
    return [left, f'<mo rspace="0.3em">=</mo>{first}', *others]


def fit_paper(mathml: str) -> float:
    """The part of the size of letters at which an equation fits on paper: 1 for most.

    >>> fit_paper("<math><mi>x</mi><mo>=</mo><mn>1</mn></math>")
    1.0
    >>> product = "<mi>x</mi>" * 100
    >>> fit_paper(f"<math><mi>y</mi><mo>=</mo><mrow>{product}</mrow></math>")
    0.59
    >>> sum_of_many = "<mi>x</mi><mo>+</mo>" * 40 + "<mi>x</mi>"
    >>> fit_paper(f"<math><mi>y</mi><mo>=</mo><mrow>{sum_of_many}</mrow></math>")
    1.0
    """
    width = _measure_pieces(mathml)
    return 1.0 if width <= PAPER else round(max(SMALLEST, PAPER / width), 2)


def fit_phone(lines: Iterable[Mapping[str, str]]) -> list[OnPhone]:
    """How equations whose signs of equality are in one column stand on a phone.

    >>> short, long = ("<mi>x</mi>" * n for n in (1, 20))
    >>> one, other = (f"<math>{each}<mo>=</mo><mi>y</mi></math>" for each in (short, long))
    >>> fit_phone([{"mathml": one}, {"mathml": other}])
    [OnPhone(is_below=False, part=1.0), OnPhone(is_below=True, part=1.0)]
    >>> fit_phone([{"mathml": one.replace("y", "y" * 50)}])
    [OnPhone(is_below=False, part=0.65)]
    """
    sides = list[tuple[float, float]]()
    for line in lines:
        first, *pieces = (
            measure(f"<math>{row(each)}</math>") for each in _list_pieces(line["mathml"])
        )
        sides.append((first, max(pieces, default=0.0) + HANGING * (len(pieces) > 1)))
    column = max((left for left, right in sides if right and left <= PHONE / 3), default=0.0)
    placed = list[OnPhone]()
    for left, right in sides:
        is_below = left > PHONE / 3 and right > 0
        if is_below or not right:
            part = PHONE / max(left, right + INDENT)
        else:
            part = (PHONE - column) / right
        placed.append(OnPhone(is_below, min(1.0, round(max(SMALL, part), 2))))
    return placed


def is_narrow(section: Mapping[str, Any]) -> bool:
    """Whether a step takes less than half of a line of paper."""
    lines: Iterable[Mapping[str, str]] = section["lines"]
    return all(measure(line["mathml"]) <= HALF for line in lines)


def _measure_pieces(mathml: str) -> float:
    """The width of the widest piece, behind the left side."""
    left, right = _part(mathml)
    if right is None:
        return measure(mathml)
    return measure(f"<math>{left}</math>") + max(
        measure(f"<math>{each}</math>") for each in _split_sum(right)
    )


def _part(mathml: str) -> tuple[str, str | None]:
    """What stands on the left and on the right of the first sign of equality."""
    inner = mathml.removeprefix("<math>").removesuffix("</math>")
    if len(root := ET.fromstring(mathml)) == 1 and root[0].tag == "mrow":  # noqa: S314 - as below
        inner = inner.removeprefix("<mrow>").removesuffix("</mrow>")
    left, sign, right = inner.partition("<mo>=</mo>")
    return left, right if sign else None


def _split_sum(mathml: str) -> Iterator[str]:
    """The addends of a sum, each with its sign, if it is wide; what is no sum is one piece."""
    root = ET.fromstring(f"<mrow>{mathml}</mrow>")  # noqa: S314 - made of elements by this package
    if measure(f"<math>{mathml}</math>") <= WHOLE and root.find("mtable") is None:
        yield mathml
        return
    piece = list[ET.Element]()
    for element in _list_top(root):
        if element.tag == "mo" and element.text in ("+", "\u2212") and piece:
            yield _write(piece)
            piece = []
            element.set("form", "infix")
        piece.append(element)
    yield _write(piece)


def _list_top(element: ET.Element) -> Iterator[ET.Element]:
    """The elements of a sum, rows of a table one after the other."""
    children = list(element)
    if element.tag == "mrow" and len(children) == 1 and children[0].tag in ("mrow", "mtable"):
        yield from _list_top(children[0])
    elif element.tag == "mtable" and element.get("displaystyle"):
        for row in element:
            (cell,) = row
            content = list(cell)
            if len(content) == 1 and content[0].tag == "mrow":
                content = list(content[0])
            if [each.tag for each in content] == ["mo", "mrow"]:  # its sign, and a sum behind it
                content = [content[0], *content[1]]
            yield from content
    else:
        yield from children


def _write(elements: Iterable[ET.Element]) -> str:
    """Elements as text."""
    whole = "".join(ET.tostring(each, encoding="unicode") for each in elements)
    # what stands between a function and its argument is not printable, and terminals escape it
    return re.sub(r" />", "/>", whole).replace("\u2061", "&#x2061;")
