"""The identities that mechanics claims, each as elements that must be zero.

Comes in: Equations. Goes out: lists of elements; `coadjoint.prove.zero` decides them.
"""

from __future__ import annotations

from collections.abc import Sequence

from coadjoint.derive import Equations
from coadjoint.exact import Element, Field

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
    field = equations.setting.field
    gradient = field.gradient(equations.closed(function), equations.setting.state)
    tensor = equations.exact.poisson_tensor
    assert tensor is not None, "only a bracket has Casimirs"
    places = range(len(tensor)) if coordinates is None else coordinates
    return [_dot(field, tensor[i], gradient) for i in places]


def drift(equations: Equations, function: Element) -> list[Element]:
    """Time derivative of a function of the state along the motion."""
    field, state = equations.setting.field, equations.setting.state
    gradient = field.gradient(equations.closed(function), state)
    return [_dot(field, gradient, [equations.closed(rate) for rate in equations.exact.rates])]


def hamiltonian_defects(equations: Equations, energy: Element, tensor: Tensor) -> list[Element]:
    """``dx/dt - {x, h}`` for every state component."""
    field, state = equations.setting.field, equations.setting.state
    gradient = field.gradient(equations.closed(energy), state)
    return [
        equations.closed(rate) - _dot(field, row, gradient)
        for rate, row in zip(equations.exact.rates, tensor, strict=True)
    ]


def _dot(field: Field, a: Sequence[Element], b: Sequence[Element]) -> Element:
    return field.sum(x * y for x, y in zip(a, b, strict=True) if x and y)
