r"""The tensor of a motion times a vector, in a field with components of the vector.

Comes in: Equations. Goes out: Equations with the products in place of the rates. Methods that keep
the structure of a motion ask for them: the motion is the tensor times the gradient of the energy.

Over a distribution the tensor J is that of the momenta :math:`M = B^T p` along it and of the
positions z (`coadjoint.derive.mechanics.almost_poisson`), and the state has the velocities
:math:`\eta` in place of M. With :math:`T = \partial (M, z)/\partial (\eta, z)` the tensor in the
state is :math:`T^{-1} J T^{-T}`, so that its product with (a, b) is :math:`(\mathcal{M}^{-1} (r -
\partial_z M \, s), s)` where :math:`(r, s) = J (u, b - (\partial_z M)^T u)` and
:math:`\mathcal{M} u = a`. It is antisymmetric as J is. Both solves are those of the accelerations.
Read next: `coadjoint.derive.formulas`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.almost_poisson import momenta_along
from coadjoint.derive.mechanics.decided import Decided
from coadjoint.derive.mechanics.distribution import Distribution
from coadjoint.derive.mechanics.external import metric
from coadjoint.derive.mechanics.kinematics import rate_name
from coadjoint.derive.mechanics.solver import (
    Solve,
    definitions_under,
    solve_in_kernel,
    solver_names,
)
from coadjoint.derive.records import Exact
from coadjoint.derive.setting import Setting, list_components, once, vector_names
from coadjoint.exact import Element, Field
from coadjoint.spec import Spec

Tensor = Sequence[Sequence[Element]]
_BOUND: Final = (
    "constraints between velocities are kept by multipliers, which do no work where these hold "
    "alone, and not at the middle of a chord; multipliers for a discrete gradient are not generated"
)
_COUPLED: Final = (
    "its state has velocities that are solved for, whose momenta have a tensor: that of the "
    "velocities is not in closed form"
)
_RESTRICTED: Final = "a metriplectic bracket acts on the whole system, and not on a section of it"
#: Terms of the derivatives of momenta by positions beyond which a product is not written out:
#: rolling ellipsoids have 60, and Veselova's problem on so(4) has 1900.
TERMS: Final = 1000


def symbols(spec: Spec) -> tuple[str, ...]:
    """The names that products need in the field of a spec whose tensors may call functions."""
    count = len(list_components(spec.state))
    if spec.in_frame:
        unknowns = (*_number("eta", count), *_number("acc", count))
        moving = sum(len(each.components) for each in spec.reduced_momenta)
        blocks = (range(moving), range(moving, 2 * moving))
        return (*vector_names(count), *unknowns, *(n for own in blocks for n in solver_names(own)))
    has_velocities = spec.algebra is None and not spec.having_role("momentum")
    has_entropy = spec.relaxation is not None and spec.relaxation.S is not None
    needs = has_velocities or has_entropy or spec.poisson is not None
    return vector_names(count) if needs else ()


def _number(word: str, count: int) -> list[str]:
    """Names of what a tensor over a distribution turns, and of what it gives."""
    return [f"_{word}{n + 1}" for n in range(count)]


@once
def times_vector(equations: Equations) -> Equations | None:
    """``J(x) v`` in place of the rates; None where there is no such J in closed form.

    It is for motions by a route with an energy and a bracket, whose momenta do not move at a
    fixed state. The certificate proves it of each. A double bracket belongs to it: J is
    ``P + P G P``. A metriplectic one does not: `metric_times_vector` is G times a vector.
    """
    found = find_product(equations)
    return None if isinstance(found, str) else found


@once
def find_product(equations: Equations) -> Equations | str:
    """The same, or why there is none, as a clause."""
    setting, exact, spec = equations.setting, equations.exact, equations.spec
    tensor, relaxation = exact.poisson_tensor, spec.relaxation
    if relaxation is not None and relaxation.S is not None and spec.reduction is not None:
        return _RESTRICTED
    if spec.constraints and (equations.distribution is None or equations.distribution.kept):
        return _BOUND
    if exact.energy is None or tensor is None:
        return "it expects an energy, and a Poisson or almost-Poisson tensor"
    if equations.chart is not None or (relaxation and equations.distribution is not None):
        return _COUPLED
    G = [] if relaxation is None or relaxation.S is not None else metric(setting)
    if equations.distribution is not None and all(_is_seen(equations, row) for row in tensor):
        return _over_distribution(equations, tensor)
    return _multiply(equations, tensor, G)


@once
def metric_times_vector(equations: Equations) -> Equations | None:
    """``G(x) v`` of a metriplectic motion in place of the rates; None where `times_vector` is."""
    relaxation = equations.spec.relaxation
    if relaxation is None or relaxation.S is None or times_vector(equations) is None:
        return None
    found = _multiply(equations, metric(equations.setting), [])
    return None if isinstance(found, str) else found


def _is_seen(equations: Equations, row: Sequence[Element]) -> bool:
    """Whether entries are functions of the state and of what is given."""
    setting = equations.setting
    named = {*setting.state, *setting.parameters, *setting.driving}
    return not any(setting.field.reach(equations.close(entry)) - named for entry in row)


def _multiply(equations: Equations, tensor: Tensor, G: Tensor) -> Equations | str:
    """``P v``, and ``P G P v`` in addition if there is a G, with components of v in the field."""
    setting = equations.setting
    if not all(_is_seen(equations, row) for row in (*tensor, *G)):
        return _COUPLED
    closed, G = ([list(map(equations.close, row)) for row in each] for each in (tensor, G))
    vector = vector_names(len(setting.state))
    if {*vector} <= {*setting.field.names}:
        own = Exact(
            definitions=(),
            rates=_turn(setting.field, closed, G, setting.elements(vector)),
            energy=None,
            emitted=(),
            poisson_tensor=None,
        )
        return replace(equations, exact=own, steps=())
    return _in_wider_field(equations, closed, G)


def _turn(
    field: Field, tensor: Tensor, G: Tensor, vector: Sequence[Element]
) -> tuple[Element, ...]:
    """``P v``, and ``P G P v`` in addition if there is a G."""
    turned = _apply(field, tensor, vector)
    if not G:
        return turned
    lost = _apply(field, tensor, _apply(field, G, turned))
    return tuple(a + b for a, b in zip(turned, lost, strict=True))


def _apply(field: Field, tensor: Tensor, vector: Sequence[Element]) -> tuple[Element, ...]:
    """A matrix times a vector."""
    return tuple(
        field.sum(x * v for x, v in zip(row, vector, strict=True) if x and v) for row in tensor
    )


def _in_wider_field(equations: Equations, tensor: Tensor, G: Tensor) -> Equations | str:
    """The same in a field of its own; not of a tensor with functions, which stay in theirs."""
    setting, field = equations.setting, equations.setting.field
    if not all(field.is_function_free(entry) for row in (*tensor, *G) for entry in row):
        return "its tensor calls functions"
    vector = vector_names(len(setting.state))
    named = (*setting.state, *vector, *setting.parameters, *setting.driving)
    wide = Field(named, 0, field.positive & {*named})
    adopted, lost = (
        [[wide.adopt(entry) for entry in row] for row in matrix] for matrix in (tensor, G)
    )
    own = Exact(
        definitions=(),
        rates=_turn(wide, adopted, lost, [wide[name] for name in vector]),
        energy=None,
        emitted=(),
        poisson_tensor=None,
    )
    return replace(
        equations, setting=Setting(spec=equations.spec, field=wide, values={}), exact=own, steps=()
    )


def _over_distribution(equations: Equations, tensor: Tensor) -> Equations | str:
    """The same where velocities along a distribution are the state, in place of their momenta."""
    setting, of = equations.setting, equations.distribution
    assert of is not None, equations.route
    field, state = setting.field, setting.state
    if setting.driving:
        return "inputs or the time move its momenta"
    if _number("eta", 1)[0] not in field.names:
        return _COUPLED
    along = map(equations.close, momenta_along(setting, list(zip(*of.B, strict=True))))
    momenta = dict(zip(of.independent, along, strict=True))
    if any(field.reach(each) - {*state, *setting.parameters} for each in momenta.values()):
        return _COUPLED
    positions = [name for name in state if name not in momenta]
    slopes = {
        name: dict(zip(positions, field.gradient(each, positions), strict=True))
        for name, each in momenta.items()
    }
    count = sum(len(field.terms(x)) for each in slopes.values() for x in each.values())
    if count > TERMS:
        return (
            f"derivatives of its momenta by positions have {count} terms, and products of the "
            f"tensor are written out up to {TERMS}: a limit on cost, not on the method"
        )
    mass = _Mass(equations, of, tensor)
    vector = dict(zip(state, setting.elements(vector_names(len(state))), strict=True))
    eta = mass.divide("eta", vector)
    eta |= mass.name(
        "eta",
        {z: vector[z] - field.sum(slopes[name][z] * eta[name] for name in eta) for z in positions},
    )
    moved = dict(zip(state, _apply(field, tensor, [eta[name] for name in state]), strict=True))
    rates = mass.name("acc", {z: moved[z] for z in positions})
    forces = {
        name: moved[name] - field.sum(slopes[name][z] * rates[z] for z in positions)
        for name in momenta
    }
    rates |= mass.divide("acc", forces)
    own = Exact(
        definitions=tuple(mass.definitions),
        rates=tuple(rates[name] for name in state),
        energy=None,
        emitted=(),
        poisson_tensor=None,
        solves=tuple(mass.solves),
    )
    return replace(equations, exact=own, steps=())


class _Mass:
    """The reduced mass matrix, with what is computed by it, each value by a name of its own.

    Attributes:
        solves: What was solved, block by block.
        definitions: On which the matrix and the tensor rest, then those of the solves.
    """

    def __init__(self, equations: Equations, of: Distribution, tensor: Tensor) -> None:
        self._blocks, self._field = equations.exact.solves, equations.setting.field
        self._names, self._state = of.independent, equations.setting.state
        rows = [row for each in self._blocks for row in each.matrix]
        needed = [entry for row in (*rows, *tensor) for entry in row]
        self.solves = list[Solve]()
        self.definitions = definitions_under(self._field, equations.exact.definitions, needed)
        self._decided = Decided(self._field, [*self._state, *vector_names(len(self._state))])
        for name, value in self.definitions:
            self._decided.define(name, value)

    def divide(self, word: str, known: Mapping[str, Element]) -> dict[str, Element]:
        """Velocities from momenta, or accelerations from forces, by names of velocities."""
        first = len(self._names) if self.solves else 0
        by_rate = {rate_name(name): name for name in self._names}
        for each in self._blocks:
            own = [by_rate[name] for name in each.names]
            solve = Solve(
                matrix=each.mirrored,  # without what forces add
                known=[known[name] for name in own],
                block=[first + place for place in each.block],
                names=[self._find_name(word, name) for name in own],
            )
            self.solves.append(solve)
            self.definitions += solve_in_kernel(self._field, solve, self._decided)
        return {name: self._take(word, name) for name in self._names}

    def name(self, word: str, values: Mapping[str, Element]) -> dict[str, Element]:
        """Components that are read several times: products of sums are not multiplied out."""
        for name, value in values.items():
            own = self._find_name(word, name)
            self.definitions.append((own, self._decided.define(own, value)))
        return {name: self._take(word, name) for name in values}

    def _find_name(self, word: str, name: str) -> str:
        return f"_{word}{self._state.index(name) + 1}"

    def _take(self, word: str, name: str) -> Element:
        """A named value as others read it: zero where it is that."""
        own = self._find_name(word, name)
        return self._decided.numbers.get(own, self._field[own])
