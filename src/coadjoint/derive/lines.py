"""Lines of a derivation: formulas in every format.

Comes in: elements of a field, or SymPy expressions with names for their symbols. Goes out: a
`Line`, and a `Section` of some. Read next: `coadjoint.derive.document`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import sympy

from coadjoint.derive.records import Left
from coadjoint.exact import Element, Field
from coadjoint.notation.elements import write_element, write_sympy
from coadjoint.notation.names import name
from coadjoint.notation.written import (
    LONG_LEFT,
    Written,
    add,
    stack,
    stack_latex,
    stack_sides,
)


@dataclass(frozen=True)
class Line:
    """A formula, or ``left = right``, as text, LaTeX, presentation MathML and Typst."""

    text: str
    latex: str
    mathml: str
    typst: str


@dataclass(frozen=True)
class Section:
    """One step of a derivation, or one part of what was found out.

    Attributes:
        title: What is done.
        law: The general law as plain text.
        law_latex: The same law as LaTeX; empty where it is words.
        lines: What the law gives here.
        words: Names and what is said of them, both free text.
        table: Rows of formulas, the first one and the first column being heads; empty if none.
        vectors: The lines once more for whole vectors and matrices; empty where none was found.
        kind: What part of a chapter it is: a ``step``, ``symbols``, ``bracket`` and others.
        rows: Rows of words, the first one being the heads; empty if none.
        theorem: What a step rests on, by name and number; empty of what is no step.
    """

    title: str
    law: str
    law_latex: str
    lines: tuple[Line, ...]
    words: tuple[tuple[str, str], ...] = ()
    table: tuple[tuple[Line, ...], ...] = ()
    vectors: tuple[Line, ...] = ()
    kind: str = "step"
    rows: tuple[tuple[Line | str, ...], ...] = ()
    theorem: str = ""


def formula(field: Field, element: Element) -> Line:
    """An element in every format."""
    return whole_line(write_element(field, element))


def whole_line(written: Written) -> Line:
    """A formula by itself."""
    whole = add([written]) if written.sign < 0 else written
    return Line(whole.text, stack_latex(whole), f"<math>{whole.mathml}</math>", whole.typst)


def formula_line(field: Field, left: Left, right: Element) -> Line:
    """``left = right`` in every format."""
    return equal(left, write_element(field, right))


def equal(left: Left, right: Written) -> Line:
    """``left = right``."""
    right = add([right]) if right.sign < 0 else right
    if len(left.text) > LONG_LEFT:
        return Line(
            f"{left.text} = {right.text}",
            f"&{stack_latex(left)} \\\\\n&\\quad = {stack_latex(right)}",
            f"<math>{stack_sides(left, right)}</math>",
            f"{left.typst} &= {right.typst}",
        )
    return Line(
        f"{left.text} = {right.text}",
        f"{left.latex} &= {stack_latex(right)}",
        f"<math><mrow>{left.mathml}<mo>=</mo>{stack(right)}</mrow></math>",
        f"{left.typst} &= {right.typst}",
    )


def write_line(
    left: Left, text: str, terms: Sequence[sympy.Expr], names: Mapping[sympy.Symbol, Left]
) -> Line:
    """``left = right`` in every format.

    Args:
        left: The left side.
        text: The right side as text.
        terms: Its addends, in order.
        names: How symbols are written that are not written as they are called.
    """
    known = {s.name: written for s, written in names.items()}
    parts = [write_sympy(term, lambda text: known.get(text) or name(text)) for term in terms]
    return equal(left, replace(add(parts), text=text))
