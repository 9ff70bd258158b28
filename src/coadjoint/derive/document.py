"""The derivation as a document: plain strings, ready for any format.

Comes in: Equations. Goes out: a `Document` with every formula as text, LaTeX and MathML. Names are
those of the spec, which the reader has restricted; titles and sources are free text that the writer
of a format must escape. Read next: `coadjoint.derive.motion`, whose
sections a document begins with; `coadjoint.render.document`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from coadjoint.derive.charts import declared_charts
from coadjoint.derive.equations import Equations
from coadjoint.derive.generic import count_written, fold_step
from coadjoint.derive.lines import Line, Section, equal, formula, formula_line, whole_line
from coadjoint.derive.motion import Names, find_form, list_motion
from coadjoint.derive.records import Emitted, Step, is_of_kernel, symbol
from coadjoint.derive.setting import Declared
from coadjoint.derive.theorems import find_theorem
from coadjoint.exact import element_text
from coadjoint.notation.elements import write_element
from coadjoint.notation.names import unit
from coadjoint.notation.tex import is_formula
from coadjoint.spec import Spec
from coadjoint.spec.core import tree
from coadjoint.spec.model import Definition, Reconstructed, Time

#: Components of a state beyond which its bracket is no matrix that a page holds.
LARGEST_BRACKET = 9
#: Characters of an entry beyond which it is too wide for a matrix.
WIDEST_ENTRY = 24


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
    """The document of a derivation: what was found, how, and what is emitted with it."""
    spec = equations.spec
    form = find_form(equations)
    names = Names.of(spec, form)
    sections = list_motion(equations, form, names)
    sections.append(_symbols(equations, names))
    if spec.definitions:
        sections.append(_definitions(spec.definitions, names))
    sections.append(_principle(equations))
    sections += [_section(equations, step, names) for step in equations.steps]
    sections += [*_bracket(equations), *_observables(equations, names)]
    if equations.chart is None and equations.route == spec.routes[0]:
        sections += [part for chart in declared_charts(equations) for part in _chart(chart)]
    about = f"System {spec.name}, route {equations.route}."
    return Document(
        title=spec.title,
        about=about,
        source=spec.source,
        description=spec.description,
        sections=tuple(each for each in sections if each is not None),
    )


def _principle(equations: Equations) -> Section:
    """The theorem that the route follows."""
    route = equations.route
    words = [("route", route), ("theorem", find_theorem(route).text)]
    others = [each for each in equations.spec.routes if each != route]
    if others:
        words.append(("proved equal to", ", ".join(others)))
    if equations.spec.family is not None:
        words.append(("steps", f"those of {count_written(equations)}"))
    return Section(
        title="Principle", law="", law_latex="", lines=(), words=tuple(words), kind="principle"
    )


def _symbols(equations: Equations, names: Names) -> Section:
    """Every name with its meaning and its unit."""
    spec, emitted = equations.spec, equations.exact.emitted
    rows = _list_symbols(spec, names, emitted if spec.family is None else ())
    return Section(
        title="Symbols", law="", law_latex="", lines=(), rows=tuple(rows), kind="symbols"
    )


def symbol_rows(spec: Spec) -> list[tuple[Line | str, ...]]:
    """The names of a spec with meaning and unit, under their heads."""
    return _list_symbols(spec, Names.of(spec, None), ())


def write_formulas(spec: Spec) -> list[Line]:
    """The Lagrangian and the Hamiltonian of a spec."""
    names, given = Names.of(spec, None), (("l", spec.lagrangian), ("h", spec.hamiltonian))
    return [
        equal(symbol(name), names.write(each.sums or each.tree)) for name, each in given if each
    ]


def _list_symbols(
    spec: Spec, names: Names, emitted: Sequence[Emitted]
) -> list[tuple[Line | str, ...]]:
    """Names, as they are written, with meaning and unit."""
    declared: list[Declared | Reconstructed] = [*spec.variables, *spec.parameters, *spec.inputs]
    declared += spec.reconstruction
    rows = list[tuple[Line | str, ...]]([("symbol", "name", "meaning", "unit")])
    known = {each.name for each in declared}
    family, seen = spec.family, set[str]()
    for each in declared:
        label, shown = each.name, names.write(tree.Name(each.name))
        base, _, number = label.rpartition("_")
        if family is not None and number.isdigit():
            if base in seen:
                continue
            seen.add(base)
            i = family.index.member
            shown = names.write(tree.Member(name=base, index=i, shift=0, indices=()))
            label = f"{base}[{i}]"
        rows.append(
            (
                whole_line(shown),
                label,
                getattr(each, "doc", "") or _role(each),
                unit_line(each.unit),
            )
        )
    docs = {each.name: each.doc for each in spec.observables}
    docs |= {each.name: each.doc for each in spec.sections}
    docs |= {each.name: each.doc for each in spec.symmetries}
    for own in emitted:
        if own.name not in known:
            doc = docs.get(own.name) or _tell_emitted(own.name, spec)
            shown = names.write(tree.Name(own.name))
            rows.append((whole_line(shown), own.name, doc, unit_line(own.unit)))
    clock = spec.clock
    label = clock.name if clock.label != Time.label else clock.label
    meaning, measured = clock.doc or clock.label, unit_line(spec.units.time)
    rows.append((whole_line(symbol(clock.name)), label, meaning, measured))
    return rows


def unit_line(text: str) -> Line | str:
    """A unit as a formula; words where the spec does not tell."""
    return whole_line(unit(text)) if text else "not told by the spec"


_EMITTED = {
    "energy": "energy",
    "casimir": "Casimir, kept by every motion of the bracket",
    "integral": "coefficient of a trace of a power of the Lax matrix",
}


def _tell_emitted(name: str, spec: Spec) -> str:
    """What is emitted with the motion and has no words in the spec."""
    lead, _, end = name.rpartition("_")
    if end == "reaction":
        return f"force of the constraint {lead}"
    if end == "momentum" and lead:
        return f"momentum of the velocity {lead}"
    if end == "spatial" and lead:
        return f"{lead} as seen from space"
    if end == "gram" and lead:
        return f"products of the columns of {lead}, which are orthogonal and of unit length"
    for each in spec.symmetries:
        if each.name == name:
            return f"momentum map of the action of {each.algebra.name}"
    return _EMITTED.get(name.rstrip("0123456789"), "observable, whose formula stands below")


def _role(quantity: object) -> str:
    """What a quantity without words of its own is."""
    return str(getattr(quantity, "role", "parameter"))


def _bracket(equations: Equations) -> Iterator[Section]:
    """The bracket as a matrix, where it fits on a page."""
    tensor, field = equations.exact.poisson_tensor, equations.setting.field
    names = equations.variables
    if tensor is None or len(names) > LARGEST_BRACKET or equations.spec.family is not None:
        return
    allowed = equations.distribution
    # of velocities the bracket is that of their momenta
    momenta = {} if allowed is None else {name: f"M_{name}" for name in allowed.independent}
    told = ""
    if allowed is not None:
        told = "; M_v = dl/dv for a velocity v"
        if allowed.equations:
            told = "; M_v = dl_c/dv for a velocity v, l_c being l on the constraints"
    heads = tuple(whole_line(symbol(momenta.get(name, name))) for name in names)
    rows = [(Line("", "", "", ""), *heads)]
    for head, row in zip(heads, tensor, strict=True):
        rows.append((head, *(formula(field, entry) for entry in row)))
    if max(len(cell.text) for row in rows for cell in row) > WIDEST_ENTRY:
        return
    yield Section(
        title="Bracket",
        law=f"{{x_i, x_j}}, x_i at the left of a row, x_j above a column{told}",
        law_latex="",
        lines=(),
        table=tuple(rows),
        kind="bracket",
    )


def _observables(equations: Equations, names: Names) -> Iterator[Section]:
    """Observables and Casimirs as they are declared, and the values of momentum maps."""
    spec, field = equations.spec, equations.setting.field
    lines = [
        equal(symbol(f"casimir{n}"), names.write(each.typed))
        for n, each in enumerate(spec.casimirs, 1)
    ]
    lines += [
        equal(names.write(tree.Name(each.name)), names.write(each.formula.typed))
        for each in spec.observables
    ]
    named = {each.name for each in spec.symmetries} | {each.name for each in spec.sections}
    lines += [
        formula_line(field, symbol(name), value)
        for each in equations.exact.emitted
        if each.name in named
        for name, value in zip(each.components, each.values, strict=True)
    ]
    if lines:
        yield Section(
            title="Casimirs, observables and momentum maps",
            law="emitted with the motion"
            if spec.space is None
            else "densities, whose integrals along space are emitted with the motion",
            law_latex="",
            lines=tuple(lines),
            kind="observables",
        )


def _chart(chart: Equations) -> Iterator[Section]:
    """The map of a declared chart to the state, what is zero in it, and its motion."""
    own, field = chart.chart, chart.setting.field
    assert own is not None, "declared as one"
    pairs = zip(chart.setting.state, own.state, strict=True)
    lines = tuple(formula_line(field, symbol(name), value) for name, value in pairs)
    where = tuple((each.text, "throughout") for each in own.relations)
    yield Section(
        title=f'Chart "{own.name}"',
        law="x = x(y)",
        law_latex="x = x(y)",
        lines=lines,
        words=where,
        theorem=find_theorem("chart").text,
    )
    yield from (_section(chart, step) for step in chart.steps)


def _definitions(definitions: Sequence[Definition], names: Names) -> Section:
    """The short names of a spec; the steps below show what they stand for in its place."""
    lines = tuple(
        equal(names.write(tree.Name(each.name)), names.write(each.typed))
        for each in definitions
        if not each.arguments
    )
    words = tuple(
        (each.signature, f"= {each.in_one_line}") for each in definitions if each.arguments
    )
    return Section(
        title="Definitions",
        law="short names in the spec",
        law_latex="",
        lines=lines,
        words=words,
        kind="definitions",
    )


def _section(equations: Equations, step: Step, names: Names | None = None) -> Section:
    """A step; of equal members that of one, with energies as the sums that the spec declares."""
    field, spec = equations.setting.field, equations.spec
    words: tuple[tuple[str, str], ...] = ()
    declared = dict[str, tree.Node]()
    if names is not None and spec.family is not None:
        step, words = fold_step(equations, step)
        given = {"l": spec.lagrangian, "h": spec.hamiltonian}
        declared = {name: each.sums for name, each in given.items() if each and each.sums}
    lines = list[Line]()
    for left, right in step.lines:
        written = write_element(field, right)
        if written.latex == left.latex:  # what has no other name, as what a kernel solves for
            is_rate = is_of_kernel(written.text) and not words
            words += (("the other rates", "as the kernel solves for them"),) * is_rate
        elif names is not None and left.text in declared:
            lines.append(equal(left, names.write(declared[left.text])))
        else:
            lines.append(equal(left, written))
    return Section(
        title=step.title,
        law=step.text,
        law_latex=step.latex if is_formula(step.latex, step.text) else "",
        lines=tuple(lines),
        words=words,
        theorem=step.theorem.text,
    )


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
