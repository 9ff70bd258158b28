"""The derivation as a document: plain strings, ready for any format.

Comes in: Equations. Goes out: a `Document` with every formula as text, LaTeX and MathML. Names are
those of the spec, which the reader has restricted; titles and sources are free text that the writer
of a format must escape. Read next: `coadjoint.render.document`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import sympy
from sympy.printing.mathml import mathml

from coadjoint.derive.charts import declared_charts
from coadjoint.derive.equations import Equations
from coadjoint.derive.records import Emitted, Left, Step, is_of_kernel, symbol
from coadjoint.derive.setting import Declared
from coadjoint.exact import Element, Field, element_text
from coadjoint.spec.model import Definition, Reconstructed

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
    """The document of a derivation: its steps, what is emitted as well, and declared charts."""
    spec = equations.spec
    sections = [_section(equations, step) for step in equations.steps]
    if spec.definitions:
        sections.insert(0, _definitions(spec.definitions))
    sections += [*_observables(equations), *_units(equations)]
    if equations.chart is None and equations.route == spec.routes[0]:
        sections += [part for chart in declared_charts(equations) for part in _chart(chart)]
    about = f"System {spec.name}, route {equations.route}."
    return Document(
        title=spec.title,
        about=about,
        source=spec.source,
        description=spec.description,
        sections=tuple(sections),
    )


def _observables(equations: Equations) -> Iterator[Section]:
    """Observables and Casimirs as they are declared, and the values of momentum maps."""
    spec, field = equations.spec, equations.setting.field
    words = [(f"casimir{n}", f"= {each.in_one_line}") for n, each in enumerate(spec.casimirs, 1)]
    for each in spec.observables:
        unit = f" ({each.unit})" * (each.unit != "1")
        words.append((each.name, f"= {each.formula.in_one_line}{unit}"))
    named = {each.name for each in spec.symmetries} | {each.name for each in spec.sections}
    lines = [
        formula_line(field, symbol(name), value)
        for each in equations.exact.emitted
        if each.name in named
        for name, value in zip(each.components, each.values, strict=True)
    ]
    if words or lines:
        yield Section(
            title="Observables",
            law="emitted with the motion",
            law_latex="",
            lines=tuple(lines),
            words=tuple(words),
        )


def _units(equations: Equations) -> Iterator[Section]:
    """The units of all that a kernel takes and gives, where the spec has any."""
    spec = equations.spec
    named: list[Declared | Emitted | Reconstructed] = [*spec.state, *spec.parameters, *spec.inputs]
    named += [*equations.exact.emitted, *spec.reconstruction]
    words = [(each.name, each.unit or "not told by the spec") for each in named]
    if {unit for _, unit in words} - {"1"}:
        yield Section(
            title="Units",
            law="1 for a pure number; those that are not declared are inferred",
            law_latex="",
            lines=(),
            words=(*words, ("time", spec.units.time)),
        )


def _chart(chart: Equations) -> Iterator[Section]:
    """The map of a declared chart to the state, what is zero in it, and its motion."""
    own, field = chart.chart, chart.setting.field
    assert own is not None, "declared as one"
    pairs = zip(chart.setting.state, own.state, strict=True)
    lines = tuple(formula_line(field, symbol(name), value) for name, value in pairs)
    where = tuple((each.text, "throughout") for each in own.relations)
    yield Section(
        title=f"Chart {own.name}", law="x = x(y)", law_latex="x = x(y)", lines=lines, words=where
    )
    yield from (_section(chart, step) for step in chart.steps)


def _definitions(definitions: Sequence[Definition]) -> Section:
    """The short names of a spec; the steps below show what they stand for in its place."""
    words = tuple((each.signature, f"= {each.in_one_line}") for each in definitions)
    return Section(
        title="Definitions", law="short names in the spec", law_latex="", lines=(), words=words
    )


def _section(equations: Equations, step: Step) -> Section:
    field = equations.setting.field
    lines = tuple(formula_line(field, left, right) for left, right in step.lines)
    return Section(title=step.title, law=step.text, law_latex=step.latex, lines=lines)


def formula(field: Field, element: Element) -> Line:
    """An element in every format."""
    terms = _terms(field, element)
    return Line(element_text(field, element), _latex(terms), f"<math>{_mathml(terms)}</math>")


def formula_line(field: Field, left: Left, right: Element) -> Line:
    """``left = right`` in every format."""
    terms = _terms(field, right)
    return Line(
        f"{left.text} = {element_text(field, right)}",
        f"{left.latex} &= {_latex(terms)}",
        f"<math><mrow>{left.mathml}<mo>=</mo>{_mathml(terms)}</mrow></math>",
    )


def _terms(field: Field, element: Element) -> list[sympy.Expr]:
    """Addends in the order in which SymPy prints them."""
    whole = sympy.Add(*(field.to_sympy(part) for part in field.partial_fractions(element)))
    return list(whole.as_ordered_terms())


def _latex(terms: list[sympy.Expr]) -> str:
    """A sum, continued on further lines if it is long."""
    names = {s: symbol(s.name).latex for s in _of_kernel(terms)}
    texts = [sympy.latex(term, symbol_names=names) for term in terms]
    signed = [text if text.startswith("-") else f"+ {text}" for text in texts]
    rows = [" ".join(signed[n : n + ADDENDS]) for n in range(0, len(signed), ADDENDS)]
    return " \\\\\n&\\quad ".join(rows).removeprefix("+ ")


def _mathml(terms: list[sympy.Expr]) -> str:
    """A sum as MathML, which browsers show without any script."""
    text: str = mathml(sympy.Add(*terms), printer="presentation")
    for s in _of_kernel(terms):
        text = text.replace(mathml(s, printer="presentation"), symbol(s.name).mathml)
    # The one named entity that SymPy prints is none of XML's own, so readers of XML refuse it.
    return text.replace("&InvisibleTimes;", "&#x2062;")


def _of_kernel(terms: list[sympy.Expr]) -> list[sympy.Symbol]:
    """The symbols whose names are those of kernels, in order."""
    symbols = {s for term in terms for s in term.free_symbols if is_of_kernel(s.name)}
    return sorted(symbols, key=str)


def equation_lines(equations: Equations) -> tuple[str, ...]:
    """Definitions and rates as text, one line each, for the head of generated files."""
    field, exact = equations.setting.field, equations.exact
    definitions = [f"{name} = {element_text(field, value)}" for name, value in exact.definitions]
    rates = [
        f"d{name}/dt = {element_text(field, rate)}"
        for name, rate in zip(equations.setting.state, exact.rates, strict=True)
    ]
    followed = [f"d{name}/dt = {element_text(field, rate)}" for name, rate in equations.followed]
    return (*definitions, *rates, *followed)
