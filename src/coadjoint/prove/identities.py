"""The identities that mechanics claims, each as elements that must be zero.

Comes in: Equations. Goes out: lists of elements; `coadjoint.prove.zero` decides them.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from coadjoint.derive import Equations
from coadjoint.exact import Element, Field


def jacobi_defects(
    tensor: Sequence[Sequence[Element]], names: Sequence[str], field: Field
) -> list[Element]:
    """Schouten bracket of a tensor J: ``J_il d_l J_jk + cyclic`` for i < j < k."""
    slope = {
        (j, k): field.gradient(tensor[j][k], names) for j in range(len(names)) for k in range(j)
    }
    for j, k in list(slope):
        slope[k, j] = tuple(-entry for entry in slope[j, k])
    defects = []
    for i, j, k in combinations(range(len(names)), 3):
        cycle = ((i, j, k), (j, k, i), (k, i, j))
        defects.append(
            sum(
                (
                    tensor[a][m] * slope[b, c][m]
                    for a, b, c in cycle
                    for m in range(len(names))
                    if tensor[a][m] != 0 and slope[b, c][m] != 0
                ),
                field.zero,
            )
        )
    return defects


def antisymmetry_defects(tensor: Sequence[Sequence[Element]]) -> list[Element]:
    """``J_ij + J_ji`` for i <= j."""
    return [tensor[i][j] + tensor[j][i] for i in range(len(tensor)) for j in range(i + 1)]


def casimir_defects(equations: Equations, function: Element) -> list[Element]:
    """``{x_i, C}`` for every state component: J grad C."""
    gradient = equations.setting.field.gradient(equations.closed(function), equations.setting.state)
    return [_dot(row, gradient) for row in equations.exact.poisson_tensor]


def drift(equations: Equations, function: Element) -> list[Element]:
    """Time derivative of a function of the state along the motion."""
    state = equations.setting.state
    gradient = equations.setting.field.gradient(equations.closed(function), state)
    return [_dot(gradient, [equations.closed(rate) for rate in equations.exact.rates])]


def hamiltonian_defects(equations: Equations) -> list[Element]:
    """``dx/dt - {x, h}`` for every state component."""
    field, state = equations.setting.field, equations.setting.state
    gradient = field.gradient(equations.closed(equations.exact.energy), state)
    return [
        equations.closed(rate) - _dot(row, gradient)
        for rate, row in zip(equations.exact.rates, equations.exact.poisson_tensor, strict=True)
    ]


def _dot(a: Sequence[Element], b: Sequence[Element]) -> Element:
    products = [x * y for x, y in zip(a, b, strict=True) if x != 0 and y != 0]
    return sum(products, 0 * a[0])
