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
from coadjoint.exact import Element, element_text


@dataclass(frozen=True)
class Line:
    """``left = right`` as text, LaTeX and presentation MathML."""

    text: str
    latex: str
    mathml: str


@dataclass(frozen=True)
class Section:
    """One step: its title, the general law, and what it gives for this system."""

    title: str
    law: str
    law_latex: str
    lines: tuple[Line, ...]


@dataclass(frozen=True)
class Document:
    """A derivation.

    Attributes:
        name: Name of the system.
        title: Free text of the spec, as are ``source`` and ``description``.
        route: The route followed.
        sections: The steps in order.
    """

    name: str
    title: str
    source: str
    description: str
    route: str
    sections: tuple[Section, ...]


def document(equations: Equations) -> Document:
    """The document of a derivation, ending with the closed equations of motion."""
    spec = equations.spec
    sections = [_section(equations, step) for step in equations.steps]
    return Document(
        spec.name, spec.title, spec.source, spec.description, equations.route, tuple(sections)
    )


def _section(equations: Equations, step: Step) -> Section:
    lines = tuple(_line(equations, left, right) for left, right in step.lines)
    return Section(step.title, step.text, step.latex, lines)


def _line(equations: Equations, left: Left, right: Element) -> Line:
    field = equations.setting.field
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
