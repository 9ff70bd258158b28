r"""Discrete gradients of a metriplectic motion: steps that keep the energy, and never lose entropy.

The motion is ``x' = P dH + G dS`` with ``P dS = 0`` and ``G dH = 0``, G symmetric and positive
semidefinite (P. J. Morrison, Physica D 18 (1986) 410). Discrete gradients g of H and s of S
(`coadjoint.solve.methods.discrete_gradient`) fulfil neither condition with P and G at the middle m
of a step, unless H and S are quadratic. With the projections along them,
``Q = 1 - g g^T/(g.g)`` and ``R = 1 - s s^T/(s.s)``, the step

    y - x = h (R P(m) R g + Q G(m) Q s)

fulfils both: as R P R is antisymmetric and s.R = 0, and g.Q = 0,

    H(y) - H(x) = g.(y - x) = 0,  S(y) - S(x) = s.(y - x) = h (Q s).G(m) (Q s) >= 0.

On the motion itself R P R is P and Q G Q is G, and x and y play the same part: the order is 2. That
conditions of degeneracy are kept in discrete form is what H. C. Oettinger, Journal of
Non-Equilibrium Thermodynamics 43 (2018) 89, asks of integrators for such motions.
Comes in: where members are. Goes out: the middle of a step by sweeps, and its chord.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.solve.methods.several_gradients import SeveralGradients

if TYPE_CHECKING:
    from collections.abc import Mapping

    from coadjoint.array_types import Array
    from coadjoint.solve.methods.lie_poisson import Arc, Bracket


def make(functions: Mapping[str, Any], size: float, order: int) -> MetriplecticGradient:
    """The method of an order, from functions of the kernel."""
    evaluate = functions["evaluate"]
    return MetriplecticGradient(
        values=partial(evaluate, ("energy", "entropy")),
        gradients=partial(evaluate, ("energy_gradient", "entropy_gradient")),
        bracket=functions["bracket"],
        metric=functions["metric"],
        size=size,
        order=order,
    )


class MetriplecticGradient(SeveralGradients):
    """The bracket and G at the middle of a step, projected along discrete gradients.

    Args:
        bracket: The tensor P times a vector.
        metric: G times a vector.
        given: As of `SeveralGradients`: the energy and the entropy.
    """

    def __init__(self, *, bracket: Bracket, metric: Bracket, **given: Any) -> None:
        super().__init__(**given)
        self.bracket, self.metric = bracket, metric

    def find_rates(self, arc: Arc, middle: Array, gradients: Array) -> Array:
        """As `SeveralGradients.find_rates`."""
        g, s = gradients
        moved = self.bracket(arc.lanes, arc.middle, middle, project(g, s))
        relaxed = self.metric(arc.lanes, arc.middle, middle, project(s, g))
        return project(moved, s) + project(relaxed, g)


def project(vector: Array, along: Array) -> Array:
    """What is left of a vector without its part along another one; all of it where that is 0.

    >>> project(np.array([[3.0], [1.0]]), np.array([[2.0], [2.0]])).ravel().tolist()
    [1.0, -1.0]
    >>> project(np.array([[3.0], [1.0]]), np.zeros((2, 1))).ravel().tolist()
    [3.0, 1.0]
    """
    product, square = np.zeros(vector.shape[1:]), np.zeros(vector.shape[1:])
    for one, other in zip(vector, along, strict=True):
        product, square = product + one * other, square + other * other
    part = product / np.where(square == 0.0, 1.0, square)
    return np.asarray(vector - part * along)
