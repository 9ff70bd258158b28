"""How wide formulas are on a page, about: those that paper cannot hold are set smaller there.

On a screen a wide formula is moved sideways in a box of its own; paper has none. No browser breaks
a root or a product over lines. Comes in: MathML. Goes out: a width in units of its letters' size.
Read next: `coadjoint.render.sums`.
"""

from __future__ import annotations

from typing import Final
from xml.etree import ElementTree as ET

#: Width of a line of paper, in sizes of letters, and the smallest part of that size to be read.
PAPER, SMALLEST = 36.0, 0.45
#: Widths of characters, as fonts of books have them on the average: letters and digits, signs
#: between operands with the space around them, brackets and commas.
LETTER, SIGN, BRACKET = 0.6, 1.2, 0.4
_BETWEEN: Final = frozenset("+−-=×⋅∘⊗→≤≥<>≠≈")
#: Scripts are smaller than what they stand at, and so are parts of a fraction within a line.
_SCRIPT: Final = 0.75


def measure(mathml: str) -> float:
    """The width of a formula.

    >>> measure("<math><mi>x</mi><mo>=</mo><mn>1</mn></math>")
    2.4
    """
    return _measure(ET.fromstring(mathml))  # noqa: S314 - made of elements by this package


def _measure(element: ET.Element) -> float:
    """The width of an element."""
    widths = [_measure(each) for each in element]
    match element.tag:
        case "mi" | "mn" | "mtext":
            return LETTER * len(element.text or "")
        case "mo":
            return SIGN if (element.text or "") in _BETWEEN else BRACKET
        case "mspace":
            return float(element.get("width", "0em").removesuffix("em"))
        case "mfrac" | "mover" | "munder" | "munderover" | "mtable":
            return max(widths, default=0.0)
        case "msub" | "msup":
            return widths[0] + _SCRIPT * widths[1]
        case "msubsup":
            return widths[0] + _SCRIPT * max(widths[1:])
        case "msqrt":
            return sum(widths) + LETTER
    return sum(widths)  # rows, and rows of tables
