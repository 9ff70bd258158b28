"""The derivation as a document: plain strings, ready for any format.

Comes in: Equations. Goes out: a `Document` with every formula as text, LaTeX and MathML. Names are
those of the spec, which the reader has restricted; titles and sources are free text that the writer
of a format must escape. Read next: `coadjoint.render.document`.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy
from sympy.printing.mathml import mathml

from coadjoint.derive.equations import Equations, Left, Step
from coadjoint.exact import Element, Field, element_text


@dataclass(frozen=True)
class Line:
    """``left = right`` as text, LaTeX and presentation MathML."""

    text: str
    latex: str
    mathml: str


@dataclass(frozen=True)
class Section:
    """One step: its title, the general law, what it gives for this system, and plain words."""

    title: str
    law: str
    law_latex: str
    lines: tuple[Line, ...]
    words: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Document:
    """A derivation, or what was found out about an algebra.

    Attributes:
        title: Free text of the spec, as are ``source`` and ``description``.
        about: What the document shows, in one sentence.
        sections: The steps in order.
    """

    title: str
    about: str
    source: str
    description: str
    sections: tuple[Section, ...]


def document(equations: Equations) -> Document:
    """The document of a derivation, ending with the closed equations of motion."""
    spec = equations.spec
    sections = [_section(equations, step) for step in equations.steps]
    about = f"System {spec.name}, route {equations.route}."
    return Document(spec.title, about, spec.source, spec.description, tuple(sections))


def _section(equations: Equations, step: Step) -> Section:
    field = equations.setting.field
    lines = tuple(formula_line(field, left, right) for left, right in step.lines)
    return Section(step.title, step.text, step.latex, lines)


def formula_line(field: Field, left: Left, right: Element) -> Line:
    """``left = right`` in every format."""
    expression = sympy.Add(*(field.to_sympy(part) for part in field.partial_fractions(right)))
    return Line(
        f"{left.text} = {element_text(field, right)}",
        f"{left.latex} &= {sympy.latex(expression)}",
        _mathml(left, expression),
    )


def _mathml(left: Left, expression: sympy.Expr) -> str:
    """The line as a MathML row, which browsers show without any script."""
    # The one named entity that SymPy prints is none of XML's own, so readers of XML refuse it.
    right = mathml(expression, printer="presentation").replace("&InvisibleTimes;", "&#x2062;")
    return f"<math><mrow>{left.mathml}<mo>=</mo>{right}</mrow></math>"


def equation_lines(equations: Equations) -> tuple[str, ...]:
    """Definitions and rates as text, one line each, for the head of generated files."""
    field, exact = equations.setting.field, equations.exact
    definitions = [f"{name} = {element_text(field, value)}" for name, value in exact.definitions]
    rates = [
        f"d{name}/dt = {element_text(field, rate)}"
        for name, rate in zip(equations.setting.state, exact.rates, strict=True)
    ]
    return (*definitions, *rates)
