"""Formulas: what each function of a kernel computes, as elements of the Equations.

Comes in: Equations. Goes out: the rows of a function with their labels, or None where a system does
not have it. Each function here has the name of an entry of `coadjoint.kernel_functions`; lowering,
its check and the reference ask here, and nothing else knows what a function is.
Read next: `coadjoint.lower.lowering` and `coadjoint.derive.reference`.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import dataclass, replace

from coadjoint.derive import sandwich as products
from coadjoint.derive.domain import bounds
from coadjoint.derive.emitted import list_following
from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.noise import noise_fields
from coadjoint.derive.mechanics.turning import turning_residuals
from coadjoint.derive.setting import vector_names
from coadjoint.derive.times_vector import metric_times_vector, times_vector
from coadjoint.exact import Element
from coadjoint.kernel_functions import KERNEL_FUNCTIONS


@dataclass(frozen=True)
class Rows:
    """What a function computes, for one member.

    Attributes:
        of: The equations that define what the elements name.
        lines: Label and value of each row; of a derivative, of each row of what is differentiated.
        shape: Of the result.
        state: What the rows of its first argument are.
        by: Of a derivative, the names that it is by; else none.
        along: Of a derivative along a vector, the components of it, which follow the state.
        may_hide_zeros: Whether a row may vanish everywhere that is not written as zero.
    """

    of: Equations
    lines: tuple[tuple[str, Element], ...]
    shape: tuple[int, ...]
    state: tuple[str, ...]
    by: tuple[str, ...] = ()
    along: tuple[str, ...] = ()
    may_hide_zeros: bool = False

    @property
    def elements(self) -> list[Element]:
        """The values alone."""
        return [value for _, value in self.lines]


def rows_of(equations: Equations, function: str) -> Rows | None:
    """What a function of the table computes; None where a system has no such function."""
    formula = getattr(sys.modules[__name__], KERNEL_FUNCTIONS[function].formula)
    rows: Rows | None = formula(equations)
    return rows


def rhs(equations: Equations) -> Rows:
    """The rates."""
    return _rows(equations, _rates(equations))


def jacobian(equations: Equations) -> Rows:
    """Derivatives of the rates by the state."""
    return _slopes(equations, equations.setting.state)


def jacobian_vector(equations: Equations) -> Rows:
    """The derivative of the rates along a vector, which follows the state in the first argument."""
    state = equations.setting.state
    vector = vector_names(len(state))
    rates = _rows(equations, _rates(equations), state=(*state, *vector))
    return replace(rates, by=state, along=vector)


def input_jacobian(equations: Equations) -> Rows | None:
    """Derivatives of the rates by the inputs."""
    inputs = equations.setting.inputs
    return _slopes(equations, inputs) if inputs else None


def parameter_jacobian(equations: Equations) -> Rows | None:
    """Derivatives of the rates by the parameters."""
    parameters = equations.setting.parameters
    return _slopes(equations, parameters) if parameters else None


def energy(equations: Equations) -> Rows | None:
    """The energy, a number for each member."""
    value = equations.exact.energy
    return None if value is None else _rows(equations, [("energy", value)], ())


def observables(equations: Equations) -> Rows | None:
    """The observables in their order."""
    values = equations.exact.observables
    return _rows(equations, values) if values else None


def poisson_tensor(equations: Equations) -> Rows | None:
    """The brackets of the components of the state, row by row."""
    state, tensor = equations.setting.state, equations.exact.poisson_tensor
    if tensor is None:
        return None
    brackets = (
        (f"{{{a}, {b}}}", entry)
        for a, row in zip(state, tensor, strict=True)
        for b, entry in zip(state, row, strict=True)
    )
    return _rows(equations, brackets, (len(state), len(state)))


def energy_gradient(equations: Equations) -> Rows | None:
    """Derivatives of the energy by the state, velocities that the kernel solves for at rest.

    By them the energy is stationary: it is ``<mu, xi> - l`` with ``mu = dl/dxi``.
    """
    energy = equations.exact.energy
    if energy is None or times_vector(equations) is None:
        return None
    return _gradient(equations, "energy", equations.close(energy))


def bracket_vector(equations: Equations) -> Rows | None:
    """The tensor times a vector, which follows the state in the first argument."""
    return _times_vector(times_vector(equations), "{%s, v}")


def entropy(equations: Equations) -> Rows | None:
    """The entropy of a metriplectic motion, a number for each member."""
    value = _find_entropy(equations)
    return None if value is None else _rows(equations, [("entropy", value)], ())


def entropy_gradient(equations: Equations) -> Rows | None:
    """Derivatives of the entropy by the state."""
    value = _find_entropy(equations)
    return None if value is None else _gradient(equations, "entropy", value)


def metric_vector(equations: Equations) -> Rows | None:
    """G of a metriplectic motion times a vector, which follows the state in the first argument."""
    return _times_vector(metric_times_vector(equations), "(%s, v)")


def distinguished(equations: Equations) -> Rows | None:
    """The distinguished functions of Nambu's bracket, where there is an energy as well."""
    functions = _find_distinguished(equations)
    return _rows(equations, functions) if functions else None


def distinguished_gradient(equations: Equations) -> Rows | None:
    """Their derivatives by the state, row by row."""
    state, field = equations.setting.state, equations.setting.field
    slopes = [
        (f"d{label}/d{name}", slope)
        for label, function in _find_distinguished(equations)
        for name, slope in zip(state, field.gradient(function, state), strict=True)
    ]
    if not slopes:
        return None
    shape = (len(slopes) // len(state), len(state))
    return replace(_rows(equations, slopes, shape), may_hide_zeros=True)


def sandwich(equations: Equations) -> Rows | None:
    """``B W B`` of the matrices of the state and of a vector, which follows it."""
    own = products.sandwich(equations)
    if own is None:
        return None
    state = equations.setting.state
    lines = [(f"(v {name} v)", row) for name, row in zip(state, own.exact.rates, strict=True)]
    return _rows(own, lines, state=(*state, *vector_names(len(state))))


def noise(equations: Equations) -> Rows | None:
    """What each Wiener process does to each component of the state, row by row."""
    state, fields = equations.setting.state, noise_fields(equations.setting)
    if not fields:
        return None
    entries = (
        (f"d{name}/d{each.name}", each.field[row])
        for row, name in enumerate(state)
        for each in fields
    )
    return _rows(equations, entries, (len(state), len(fields)))


def noise_gradient(equations: Equations) -> Rows | None:
    """Derivatives of the Hamiltonian of each Wiener process by the state, row by row."""
    state, fields = equations.setting.state, noise_fields(equations.setting)
    if not fields or energy_gradient(equations) is None:
        return None
    ring = equations.setting.field
    slopes = [ring.gradient(equations.close(each.hamiltonian), state) for each in fields]
    entries = (
        (f"d {each.name}/d {name}", slopes[column][row])
        for row, name in enumerate(state)
        for column, each in enumerate(fields)
    )
    return replace(_rows(equations, entries, (len(state), len(fields))), may_hide_zeros=True)


def noise_vector(equations: Equations) -> None:
    """Of equal members alone, whose noise is read off from `noise` of a few of them."""


def flow(equations: Equations) -> None:
    """Of equal members alone, of which a Family has the flow of each part of the energy."""


def sided_rhs(equations: Equations) -> None:
    """Of equal members alone, whose rates with given signs are those of a Family."""


def kinks(equations: Equations) -> None:
    """Of equal members alone, likewise."""


def constraint_residual(equations: Equations) -> Rows | None:
    """What vanishes on the constraints, then what vanishes where attitudes are rotations."""
    residuals = [*equations.exact.residuals, *turning_residuals(equations.setting)]
    return _rows(equations, residuals) if residuals else None


def projection(equations: Equations) -> Rows | None:
    """The nearest state with rotations and on the constraints, by equations of its own."""
    own = equations.projection
    if own is None:
        return None
    nearest = _rows(own, zip(own.setting.state, own.exact.rates, strict=True))
    return replace(nearest, may_hide_zeros=True)


def reconstruction(equations: Equations) -> Rows | None:
    """The rates of what is reconstructed, which follows the state in the first argument."""
    followed = equations.followed
    if not followed:
        return None
    state = (*equations.setting.state, *(name for name, _ in followed))
    return _rows(equations, [(f"d{name}/dt", rate) for name, rate in followed], state=state)


def reconstructed_observables(equations: Equations) -> Rows | None:
    """The observables of what is reconstructed, which follows the state in the first argument."""
    values = [
        line
        for each in list_following(equations.setting)
        for line in zip(each.components, each.values, strict=True)
    ]
    state = (*equations.setting.state, *(name for name, _ in equations.followed))
    return _rows(equations, values, state=state) if values else None


def domain(equations: Equations) -> Rows | None:
    """What is positive where the system is defined."""
    positive = [(bound.label, value) for bound, value in bounds(equations)]
    return _rows(equations, positive) if positive else None


def _rows(
    equations: Equations,
    lines: Iterable[tuple[str, Element]],
    shape: tuple[int, ...] | None = None,
    state: tuple[str, ...] | None = None,
) -> Rows:
    """Rows of the state, one for each line, unless something else is said."""
    listed = tuple(lines)
    return Rows(
        of=equations,
        lines=listed,
        shape=(len(listed),) if shape is None else shape,
        state=equations.setting.state if state is None else state,
    )


def _rates(equations: Equations) -> list[tuple[str, Element]]:
    """The rates with their labels."""
    state, rates = equations.setting.state, equations.exact.rates
    return [(f"d{name}/dt", rate) for name, rate in zip(state, rates, strict=True)]


def _find_distinguished(equations: Equations) -> list[tuple[str, Element]]:
    """The distinguished functions with labels; none where no method asks for them."""
    setting, poisson = equations.setting, equations.spec.poisson
    if poisson is None or energy_gradient(equations) is None:
        return []
    functions = [equations.close(setting.formula(each)) for each in poisson.functions]
    return [(f"c{n}", function) for n, function in enumerate(functions, 1)]


def _find_entropy(equations: Equations) -> Element | None:
    """The entropy, where a method asks for it."""
    relaxation = equations.spec.relaxation
    if relaxation is None or relaxation.S is None or metric_times_vector(equations) is None:
        return None
    return equations.close(equations.setting.formula(relaxation.S))


def _gradient(equations: Equations, name: str, value: Element) -> Rows:
    """Derivatives of a function by the state."""
    state = equations.setting.state
    slopes = equations.setting.field.gradient(value, state)
    lines = ((f"d {name}/d {x}", slope) for x, slope in zip(state, slopes, strict=True))
    return replace(_rows(equations, lines), may_hide_zeros=True)


def _times_vector(own: Equations | None, label: str) -> Rows | None:
    """Rows of a tensor times a vector below the state; ``label`` has the place of a component."""
    if own is None:
        return None
    state = own.setting.state
    lines = [(label % x, row) for x, row in zip(state, own.exact.rates, strict=True)]
    return _rows(own, lines, state=(*state, *vector_names(len(state))))


def _slopes(equations: Equations, by: tuple[str, ...]) -> Rows:
    """Derivatives of the rates by names."""
    rates = _rows(equations, _rates(equations))
    return replace(rates, shape=(len(rates.lines), len(by)), by=by, may_hide_zeros=True)
