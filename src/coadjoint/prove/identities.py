"""The identities that mechanics claims, each as elements that must be zero.

Comes in: Equations. Goes out: lists of elements; `coadjoint.prove.zero` decides them.
"""

from __future__ import annotations

from collections.abc import Sequence

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.driving import explicit
from coadjoint.derive.mechanics.noise import noise_fields
from coadjoint.derive.setting import once
from coadjoint.errors import DerivationError
from coadjoint.exact import Element
from coadjoint.exact.dense import dot
from coadjoint.prove.equivalence import in_velocities, kept_velocities

Tensor = Sequence[Sequence[Element]]


def antisymmetry_defects(tensor: Sequence[Sequence[Element]]) -> list[Element]:
    """``J_ij + J_ji`` for i <= j."""
    return [tensor[i][j] + tensor[j][i] for i in range(len(tensor)) for j in range(i + 1)]


def casimir_defects(
    equations: Equations, function: Element, coordinates: Sequence[int] | None = None
) -> list[Element]:
    """``{x_i, C}`` for every state component: J grad C.

    Args:
        equations: The motion with its tensor J.
        function: C.
        coordinates: Places of components whose brackets give all others; by default all. By the
            Jacobi identity C commutes with ``{x_i, x_j}`` where it commutes with both.
    """
    tensor = equations.exact.poisson_tensor
    assert tensor is not None, "only a bracket has Casimirs"
    places = range(len(tensor)) if coordinates is None else coordinates
    slopes = gradient(equations, function)
    return [dot(in_velocities(equations, tensor[i]), slopes) for i in places]


def drift(equations: Equations, function: Element) -> list[Element]:
    """Time derivative of a function of state and time along the motion, inputs held constant."""
    carried = dot(gradient(equations, function), decidable_rates(equations))
    (followed,) = in_velocities(equations, [followed_rate(equations, function)])
    return [carried + own_rate(equations, function) + followed]


@once
def decidable_rates(equations: Equations) -> list[Element]:
    """The rates of the state with a decidable zero, computed once for all functions."""
    return in_velocities(equations, equations.exact.rates)


def noise_rates(equations: Equations, function: Element) -> list[Element]:
    """``{F, h_k}`` for each Wiener process; none without noise."""
    fields = noise_fields(equations.setting)
    slopes = gradient(equations, function) if fields else []
    return [dot(slopes, in_velocities(equations, each.field)) for each in fields]


def followed_rate(equations: Equations, function: Element) -> Element:
    """What the rates of variables that are reconstructed add, of a function that names any."""
    field, closed = equations.setting.field, equations.close(function)
    reached = field.reach(closed)
    named = [(name, rate) for name, rate in equations.followed if name in reached]
    slopes = field.gradient(closed, [name for name, _ in named])
    return field.sum(slope * rate for slope, (_, rate) in zip(slopes, named, strict=True))


def own_rate(equations: Equations, function: Element) -> Element:
    """The explicit part of that, at fixed state."""
    own = explicit(equations.setting, equations.close(function))
    return in_velocities(equations, [own])[0]


def hamiltonian_defects(equations: Equations, energy: Element, tensor: Tensor) -> list[Element]:
    """``dx/dt - {x, h}``, and minus the external forces, for every state component."""
    field, slopes = equations.setting.field, gradient(equations, energy)
    forces = equations.exact.forces or (field.zero,) * len(equations.exact.rates)
    free = [x - f for x, f in zip(equations.exact.rates, forces, strict=True)]
    rates = in_velocities(equations, free)
    return [
        rate - dot(in_velocities(equations, row), slopes)
        for rate, row in zip(rates, tensor, strict=True)
    ]


def gradient(equations: Equations, function: Element) -> list[Element]:
    """Derivatives of a function by the state.

    Where the kernel solves for velocities, the function must be stationary in them at fixed state,
    as the energy ``<mu, xi> - l`` is: their own derivatives are not needed then.

    Raises:
        DerivationError: It is not.
    """
    field, closed = equations.setting.field, equations.close(function)
    solved = kept_velocities(equations)
    inner = in_velocities(equations, field.gradient(closed, solved))
    named = [xi for xi, slope in zip(solved, inner, strict=True) if not field.is_zero(slope)]
    if named:
        path = equations.spec.path
        raise DerivationError(
            f"{path}: a claimed integral or Casimir names the velocities {', '.join(named)}, which "
            "the kernel solves for; expected a function of momenta. Write it with momenta.",
            path=str(path),
            found=named[0],
        )
    return in_velocities(equations, field.gradient(closed, equations.setting.state))
