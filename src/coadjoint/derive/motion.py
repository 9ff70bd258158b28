"""The equations of motion as sections: by vectors as far as these were found, and in components.

Documents begin with them, notebooks show them, and generated packages carry them. They read without
the steps of the derivation: rates that a kernel solves for are given as what it solves.
Comes in: Equations. Goes out: a `Section` of the motion, and those of members.
Read next: `coadjoint.derive.document`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

from coadjoint.derive.equations import Equations
from coadjoint.derive.generic import show_members
from coadjoint.derive.lines import Line, Section, equal, formula_line
from coadjoint.derive.mechanics.noise import write_moves
from coadjoint.derive.mechanics.solver import Solve
from coadjoint.derive.motion_names import complete_vectors, measure, write_names
from coadjoint.derive.records import is_of_kernel, rate, symbol
from coadjoint.derive.vectors import VectorForm, vector_form
from coadjoint.derive.vectors.words import value_shape
from coadjoint.exact import Element, Field
from coadjoint.notation.elements import write_element
from coadjoint.notation.trees import write_tree
from coadjoint.notation.written import Written, add, multiply, negate
from coadjoint.spec import Spec
from coadjoint.spec.core import tree
from coadjoint.spec.core.components import Shape
from coadjoint.spec.model import Time

#: Characters of text of linear equations beyond which they are left to the steps.
LONGEST_SOLVE: Final = 1500
#: Characters up to which they stand with equations by vectors, and not only with components.
SHORT_SOLVE: Final = 800


@dataclass(frozen=True)
class Names:
    """How the names of a system are written."""

    shapes: Mapping[str, Shape]
    written: Mapping[str, Written]

    @classmethod
    def of(cls, spec: Spec, form: VectorForm | None) -> Names:
        """Of a spec, and of the vectors that were found in its equations."""
        quantities: list[Any] = [*spec.variables, *spec.parameters, *spec.inputs, *spec.jets]
        shapes = {each.name: value_shape(each) for each in quantities}
        shapes |= {each.name: each.shape for each in spec.definitions if each.shape}
        shapes |= {each.name: each.shape for each in spec.observables if each.shape}
        if spec.family is not None:
            for name, shape in list(shapes.items()):
                shapes.setdefault(name.rpartition("_")[0], shape)
        return cls({**shapes, **(form.shapes if form else {})}, form.written if form else {})

    def write(self, node: tree.Node) -> Written:
        """A tree."""
        return write_tree(node, self.shapes, self.written)


def motion_sections(equations: Equations) -> list[Section]:
    """The motion, and what is to be said of members that are not the generic one."""
    form = find_form(equations)
    return list_motion(equations, form, Names.of(equations.spec, form))


def find_form(equations: Equations) -> VectorForm | None:
    """The vector form, which a chart of its own has none of."""
    return vector_form(equations) if equations.chart is None else None


def list_motion(equations: Equations, form: VectorForm | None, names: Names) -> list[Section]:
    """The same with names that further sections share."""
    own = _motion(equations, form, names)
    clock = equations.spec.clock
    if clock.label != Time.label:
        own = replace(own, law=f"{own.law}; d/dt is the rate along the {clock.label} {clock.name}")
    if equations.spec.family is None:
        return [own]
    generic, *others = show_members(equations)
    whole = f"{own.law}; {generic.law}" if own.vectors else generic.law
    return [replace(own, law=whole, lines=generic.lines), *others]


def vector_lines(equations: Equations) -> tuple[Line, ...]:
    """The equations of motion by vectors, or none if those of some quantity were not found."""
    form = find_form(equations)
    if form is None or form.missing:
        return ()
    return _write_vectors(form, Names.of(equations.spec, form))


def _motion(equations: Equations, form: VectorForm | None, names: Names) -> Section:
    """The equations of motion: by vectors as far as they were found, and in components."""
    vectors = _write_vectors(form, names)
    missing = tuple(dict.fromkeys(form.missing)) if form is not None and vectors else ()
    if equations.spec.family is not None:
        law, lines = _say_where(vectors, missing, None), list[Line]()
        if equations.spec.noise:
            law += "; what stands here is the drift, and the noise has a section of its own"
    else:
        field = equations.setting.field
        pairs = list(zip(equations.variables, equations.exact.rates, strict=True))
        rates = {n: value for n, value in pairs if not _is_solved(field, value)}
        written = (_write_motion(equations, name, value) for name, value in rates.items())
        lines = [each for each in written if not _says_nothing(each)]
        left = [value for n, value in pairs if n not in rates]
        owners = {n: v.name for v in equations.spec.variables for n in v.components}
        if vectors:
            left = [v for n, v in pairs if n not in rates and {n, owners.get(n)} & {*missing}]
        solved = list(_write_solved(equations, left)) if left else None
        law = _say_where(vectors, missing, solved)
        if any("_u1 " in line.text for line in solved or ()):
            law += ", where _u1 and the like are minus the multipliers of constraints"
        lines += solved or []
        if equations.chart is None and not equations.spec.space:
            told = {line.text.partition(" = ")[0] for line in solved or ()}
            lines += write_names(equations, list(rates.values()), told)
            if form is not None and vectors:
                bare = {n: (rates[n], _write_motion(equations, n, rates[n])) for n in rates}
                short = solved if solved and measure(solved) <= SHORT_SOLVE else ()
                vectors += (*short, *complete_vectors(equations, form, bare))
        if form is not None and form.told:
            law += f"; {form.told}"
        if equations.spec.noise:
            law += "; the noise is in the sense of Stratonovich"
    return Section(
        title="Equations of motion",
        law=law,
        law_latex="",
        lines=tuple(lines),
        vectors=vectors,
        kind="motion",
    )


def _says_nothing(line: Line) -> bool:
    """Whether both sides are written alike, as the rate of phi and its velocity phidot."""
    left, _, right = line.latex.partition(" &= ")
    return left == right


def _write_motion(equations: Equations, name: str, value: Element) -> Line:
    """The equation of a component, with its noise where there is some."""
    if equations.spec.noise and equations.chart is None:
        return equal(*write_moves(equations.setting, name, value))
    return formula_line(equations.setting.field, rate(name), value)


def _write_vectors(form: VectorForm | None, names: Names) -> tuple[Line, ...]:
    """Equations between vectors as formulas."""
    lines = () if form is None else form.lines
    return tuple(equal(names.write(line.left), names.write(line.right)) for line in lines)


def _is_solved(field: Field, value: Element) -> bool:
    """Whether a rate is what the kernel solves for, a symbol by itself."""
    return any(is_of_kernel(name) and field[name] == value for name in field.reach(value))


def _write_solved(equations: Equations, rates: Iterable[Element]) -> list[Line]:
    """What is solved for rates, with the names that it rests on; none if that is long."""
    field, lines = equations.setting.field, list[Line]()
    for each in _list_solved(equations, rates):
        if not isinstance(each, Solve):
            name, value = each
            lines.append(formula_line(field, symbol(name), value))
        elif each.newton is not None:  # whose rows are those of an iteration
            return []
        else:
            lines += _write_rows(field, each)
    return lines if measure(lines) <= LONGEST_SOLVE else []


def _list_solved(
    equations: Equations, rates: Iterable[Element]
) -> Iterator[Solve | tuple[str, Element]]:
    """The solves and the definitions on which rates rest, each after what it rests on itself."""
    field, definitions = equations.setting.field, dict(equations.exact.definitions)
    solves = {name: each for each in equations.exact.solves for name in each.names}
    order, seen = {name: n for n, name in enumerate(definitions)}, set[str]()

    def visit(elements: Collection[Element]) -> Iterator[Solve | tuple[str, Element]]:
        reached = frozenset[str]().union(*map(field.reach, elements))
        for name in sorted(reached & {*definitions, *solves}, key=lambda n: order.get(n, -1)):
            if name in seen:
                continue
            if name in solves:
                each = solves[name]
                seen.update(each.names)
                yield from visit([*(entry for row in each.matrix for entry in row), *each.known])
                yield each
            else:
                seen.add(name)
                yield from visit([definitions[name]])
                yield name, definitions[name]

    yield from visit(list(rates))


def _write_rows(field: Field, solve: Solve) -> Iterator[Line]:
    """Linear equations row by row."""
    unknowns = list(map(symbol, solve.names))
    for row, side in zip(solve.matrix, solve.known, strict=True):
        products = [
            _multiply(field, entry, unknown)
            for entry, unknown in zip(row, unknowns, strict=True)
            if entry
        ]
        yield equal(add(products), write_element(field, side))


def _multiply(field: Field, entry: Element, unknown: Written) -> Written:
    """A coefficient times an unknown, with the sign before it that leaves fewer in brackets."""
    plain, turned = write_element(field, entry), write_element(field, -entry)
    if len(turned.text) < len(plain.text):
        return negate(multiply([turned, unknown]))
    return multiply([plain, unknown])


def _say_where(
    vectors: Collection[Line], missing: Collection[str], solved: Collection[Line] | None
) -> str:
    """What a reader is told of the form in which equations stand.

    Args:
        vectors: Those by vectors.
        missing: Names of quantities that have none, where others have some.
        solved: Linear equations, empty where they are long; None where no rate is solved for.
    """
    if vectors and not missing:
        return "by vectors, each line found equal to its components in exact arithmetic"
    lead = f"by vectors where that form was found; those of {', '.join(missing)} "
    lead = lead if vectors else ""
    if solved is None:
        return f"{lead}in components"
    if solved:
        return f"{lead}in components, as the linear equations that the kernel solves"
    return f"{lead or 'they '}are linear equations, which the derivation sets up step by step"
