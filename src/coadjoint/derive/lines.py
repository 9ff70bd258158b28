"""Lines of a derivation: formulas as text, LaTeX and presentation MathML.

Comes in: elements of a field, or SymPy expressions with names for their symbols. Goes out: a
`Line`, and a `Section` of some. Read next: `coadjoint.derive.document`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html.entities import html5

import sympy
from sympy.printing.mathml import mathml

from coadjoint.derive.records import Left, is_of_kernel, symbol
from coadjoint.exact import Element, Field, element_text

#: A character by its name, but for those that XML has: &InvisibleTimes; &pi; &ExponentialE;
_ENTITY = re.compile(r"&(?!(?:amp|lt|gt|quot|apos);)(\w+;)")
#: Addends on one line of LaTeX; nine fill a landscape page.
ADDENDS = 9


@dataclass(frozen=True)
class Line:
    """A formula, or ``left = right``, as text, LaTeX and presentation MathML."""

    text: str
    latex: str
    mathml: str


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
    """

    title: str
    law: str
    law_latex: str
    lines: tuple[Line, ...]
    words: tuple[tuple[str, str], ...] = ()
    table: tuple[tuple[Line, ...], ...] = ()


def formula(field: Field, element: Element) -> Line:
    """An element in every format."""
    terms = _terms(field, element)
    names = _name_kernel(terms)
    maths = f"<math>{_mathml(terms, names)}</math>"
    return Line(element_text(field, element), _latex(terms, names), maths)


def formula_line(field: Field, left: Left, right: Element) -> Line:
    """``left = right`` in every format."""
    terms = _terms(field, right)
    return write_line(left, element_text(field, right), terms, _name_kernel(terms))


def write_line(
    left: Left, text: str, terms: Sequence[sympy.Expr], names: Mapping[sympy.Symbol, Left]
) -> Line:
    """``left = right`` in every format.

    Args:
        left: The left side.
        text: The right side as text.
        terms: Its addends, in order.
        names: How symbols are written that are not written as they are called, each before those
            in whose names it occurs.
    """
    return Line(
        f"{left.text} = {text}",
        f"{left.latex} &= {_latex(terms, names)}",
        f"<math><mrow>{left.mathml}<mo>=</mo>{_mathml(terms, names)}</mrow></math>",
    )


def _terms(field: Field, element: Element) -> list[sympy.Expr]:
    """Addends in the order in which SymPy prints them."""
    whole = sympy.Add(*(field.to_sympy(part) for part in field.partial_fractions(element)))
    return list(whole.as_ordered_terms())


def _latex(terms: Sequence[sympy.Expr], names: Mapping[sympy.Symbol, Left]) -> str:
    """A sum, continued on further lines if it is long."""
    written = {s: left.latex for s, left in names.items()}
    texts = [sympy.latex(term, symbol_names=written) for term in terms]
    signed = [text if text.startswith("-") else f"+ {text}" for text in texts]
    rows = [" ".join(signed[n : n + ADDENDS]) for n in range(0, len(signed), ADDENDS)]
    return " \\\\\n&\\quad ".join(rows).removeprefix("+ ")


def _mathml(terms: Sequence[sympy.Expr], names: Mapping[sympy.Symbol, Left]) -> str:
    """A sum as MathML, which browsers show without any script."""
    text: str = mathml(sympy.Add(*terms), printer="presentation")
    for s, left in names.items():
        text = text.replace(mathml(s, printer="presentation"), left.mathml)
    # SymPy prints entities by names that are none of XML's own, so that readers of XML refuse them
    return _ENTITY.sub(lambda name: html5.get(name[1], name[0]), text)


def _name_kernel(terms: Sequence[sympy.Expr]) -> dict[sympy.Symbol, Left]:
    """The symbols whose names are those of kernels, in order, as a book would write them."""
    symbols = {s for term in terms for s in term.free_symbols if is_of_kernel(s.name)}
    return {s: symbol(s.name) for s in sorted(symbols, key=str)}
