"""What stands for what in equations of motion: velocities and other names on which rates rest.

A line such as ``dX/dt = V`` tells nothing without V, and equations by vectors leave out scalars.
Comes in: Equations and their vector form. Goes out: further lines. Read next:
`coadjoint.derive.motion`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Final

from coadjoint.derive.equations import Equations
from coadjoint.derive.lines import Line, equal, formula_line
from coadjoint.derive.mechanics.legendre import legendre
from coadjoint.derive.mechanics.solver import definitions_under
from coadjoint.derive.records import Left, symbol
from coadjoint.derive.vectors import VectorForm
from coadjoint.exact import Element
from coadjoint.notation.names import name, partial
from coadjoint.notation.written import enclose
from coadjoint.spec.core import tree
from coadjoint.spec.model import Variable

#: Characters of text of what names stand for, up to which it stands with equations by vectors, and
#: with their components.
LONGEST_NAMES: Final = 1500
LONGEST_COMPONENTS: Final = 3000


def write_names(
    equations: Equations, values: Sequence[Element], told: Collection[str] = ()
) -> list[Line]:
    """What the names stand for on which values rest, but for those of which a reader was told.

    Velocities that the kernel solves for are told by their momenta. Nothing is told at length.
    """
    setting, exact = equations.setting, equations.exact
    untold = [line for line in exact.definitions if line[0] not in told]
    needed = definitions_under(setting.field, untold, values)
    solved = {each for solve in exact.solves for each in solve.names}
    pairs: Iterable[tuple[str, Element]] = needed
    if not solved.isdisjoint(label for label, _ in needed):
        if equations.spec.lagrangian is None or equations.distribution is not None:
            return []
        slopes = zip(setting.conjugates, legendre(setting).momenta, strict=True)
        pairs = [(p, value / weight) for (_, p, weight), value in slopes]
    lines = [formula_line(setting.field, symbol(label), value) for label, value in pairs]
    return lines if measure(lines) <= LONGEST_COMPONENTS else []


def complete_vectors(
    equations: Equations, form: VectorForm, rates: Mapping[str, tuple[Element, Line]]
) -> tuple[Line, ...]:
    """What equations by vectors leave out: rates of scalars, and what velocities are.

    Args:
        equations: Of one body.
        form: Its equations by vectors.
        rates: Of components, as elements and as lines, but for those that a kernel solves for.
    """
    spec, field = equations.spec, equations.setting.field
    defined = {line.left.name for line in form.lines if isinstance(line.left, tree.Name)}
    further = [
        n
        for v in spec.state
        for n in v.components
        if n in rates and n not in form.within
        if {v.name, n} & {*form.missing} or not v.value_shape
    ]
    lines = [rates[n][1] for n in further]
    if measure(lines) > LONGEST_NAMES:
        further, lines = [], []
    reached = frozenset[str]().union(*(field.reach(rates[n][0]) for n in further))
    reached |= {n for line in form.lines for n in _list_names(line.right)}
    moving = [v for v in spec.having_role("velocity") if v not in spec.state]
    moving = [v for v in moving if reached & {v.name, *v.components}]
    twins = {v.name: _find_twin(equations, v) for v in moving}
    known = {v for v, twin in twins.items() if v in defined or (twin and twin.name in defined)}
    told = {n for v in moving if v.name in known for n in v.components}
    left = [v for v in moving if v.name not in known]
    for v in left:
        slope = _write_slope(equations, v)
        lines += slope
        told |= {*v.components} if slope else set()
    values = [rates[n][0] for n in further]
    values += [field[n] for v in left for n in v.components if n not in told]
    named = write_names(equations, values, told)
    if measure(named) > LONGEST_NAMES:
        others = (v for v in left if told.isdisjoint(v.components))
        named = [line for v in others for line in _bracket(equations, v)]
    return (*lines, *named)


def _list_names(node: tree.Node) -> Iterator[str]:
    """The names in a formula."""
    return (each.name for each in tree.walk(node) if isinstance(each, tree.Name | tree.Index))


def _find_twin(equations: Equations, velocity: Variable) -> Variable | None:
    """The momentum of a velocity, where it is a part of the state."""
    momenta = [p for v, p, _ in equations.setting.conjugates if v in velocity.components]
    return next((v for v in equations.spec.state if [*v.components] == momenta), None)


def _whole(variable: Variable) -> Left:
    """A quantity as equations by vectors have it."""
    return name(variable.name, bold=len(variable.value_shape) == 1)


def measure(lines: Iterable[Line]) -> int:
    """Characters of text."""
    return sum(len(line.text) for line in lines)


def _write_slope(equations: Equations, velocity: Variable) -> list[Line]:
    """A velocity as the slope of h, or its momentum as that of l; none if it is not found so."""
    setting, spec, field = equations.setting, equations.spec, equations.setting.field
    pairs = [each for each in setting.conjugates if each[0] in velocity.components]
    twin = _find_twin(equations, velocity)
    if {"h", "l"} & {n for v in spec.variables for n in (v.name, *v.components)}:
        return []  # the name of an energy is that of something else
    if twin is None or any(weight != 1 for _, _, weight in pairs):
        return []
    if spec.hamiltonian is None:
        return [equal(_whole(twin), partial(name("l"), _whole(velocity)))]
    energy, known = equations.exact.energy, dict(equations.exact.definitions)
    if energy is None or not known.keys() >= set(velocity.components):
        return []
    closed = equations.close(energy)
    slopes = (field.derivative(closed, p) - equations.close(known[v]) for v, p, _ in pairs)
    if not all(map(field.is_zero, slopes)):
        return []
    return [equal(_whole(velocity), partial(name("h"), _whole(twin)))]


def _bracket(equations: Equations, velocity: Variable) -> Iterator[Line]:
    """A velocity as the bracket of what moves with it and h, where it is one."""
    tensor, energy, field = (
        equations.exact.poisson_tensor,
        equations.exact.energy,
        equations.setting.field,
    )
    moved = next((v for v in equations.spec.state if v.name == velocity.of), None)
    if tensor is None or energy is None or moved is None or "h" in equations.variables:
        return
    slopes = field.gradient(equations.close(energy), equations.variables)
    known = dict(equations.exact.definitions)
    for own, of in zip(velocity.components, moved.components, strict=True):
        row = tensor[equations.variables.index(of)]
        rate = field.sum(equations.close(a) * b for a, b in zip(row, slopes, strict=True))
        if not field.is_zero(rate - equations.close(known[own])):
            return
    yield equal(_whole(velocity), enclose([_whole(moved), symbol("h")], "{}"))
