"""The derivation as a document: plain strings, ready for any format.

Comes in: Equations. Goes out: a `Document` with every formula as text, LaTeX and MathML. Names are
those of the spec, which the reader has restricted; titles and sources are free text that the writer
of a format must escape. Read next: `coadjoint.render.document`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from coadjoint.derive.charts import declared_charts
from coadjoint.derive.equations import Equations
from coadjoint.derive.generic import show_members
from coadjoint.derive.lines import Section, formula_line
from coadjoint.derive.records import Emitted, Step, symbol
from coadjoint.derive.setting import Declared
from coadjoint.exact import element_text
from coadjoint.spec.model import Definition, Reconstructed


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
    if spec.family is not None:
        sections[:0] = show_members(equations)
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
