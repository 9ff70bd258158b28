"""Discrete gradients: steps that keep the energy, or balance it with the power of forces.

A step is ``y - x = h (J(m) g + f(m))``, where m is the middle of x and y, J the tensor of the
motion, f its forces, and g a discrete gradient of the energy: ``g.(y - x) = H(y) - H(x)``. J is
antisymmetric, so ``H(y) - H(x) = h g.f(m)``; it need not fulfil Jacobi's identity. The rates at m
are ``J(m) dH(m) + f(m)``, so that the step follows from them and from ``J(m) (g - dH(m))``. Without
forces a function C of degree 2 at the most with ``J dC = 0`` changes by ``dC(m).(y - x) = 0``.
R. I. McLachlan, G. R. W. Quispel and N. Robidoux, Philosophical Transactions A 357 (1999) 1021.
Here g is the mean of the gradient along the chord, by Gauss's formula with five nodes: a discrete
gradient of polynomials up to degree 10 (E. Celledoni et al., Journal of Computational Physics 231
(2012) 6770). The fifth node is the middle, whose gradient is there at any rate.
Comes in: where members are. Goes out: the middle of a step by sweeps, and its chord.
Read next: `coadjoint.solve.methods.discrete_gradient`, for any energy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.solve.methods.lie_poisson import Arc, Gradient, LiePoisson, Sweep

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from coadjoint.array_types import Array
    from coadjoint.solve.methods.lie_poisson import Bracket

#: Nodes between the ends and their weights, of those nearer to the start: 1/2 - sqrt(5 +- 2
#: sqrt(10/7))/6 and (322 -+ 13 sqrt(70))/1800. The middle has the rest.
NODES: Final = (
    (0.046910077030668004, 0.11846344252809454),
    (0.23076534494715845, 0.23931433524968324),
)


def make(functions: Mapping[str, Any], size: float, order: int) -> AverageGradient:
    """The method of an order, from functions of the kernel."""
    return AverageGradient(
        rates=functions["rates"],
        gradient=functions["gradient"],
        bracket=functions["bracket"],
        size=size,
        order=order,
    )


class AverageGradient(LiePoisson):
    """The mean of the gradient along the chord.

    Args:
        rates: Rates of lanes, at states some time later.
        gradient: The derivative of the energy.
        bracket: The tensor times a vector.
        size: The step.
        order: 2, or that of a composition.
    """

    def __init__(
        self,
        *,
        rates: Callable[..., Array],
        gradient: Gradient,
        bracket: Bracket,
        size: float,
        order: int = 2,
    ) -> None:
        super().__init__(gradient=gradient, bracket=bracket, size=size, order=order)
        self.rates = rates

    def sweep(self, arc: Arc, middle: Array, kept: Any) -> Sweep:
        """As `LiePoisson.sweep`."""
        chord = 2.0 * ((middle - arc.state) - arc.low)
        return self.move(arc, middle, self.find_excess(arc, middle, chord))

    def find_excess(self, arc: Arc, middle: Array, chord: Array) -> Array:
        """The mean of the gradient minus the gradient at the middle."""
        at_middle = self.gradient(arc.lanes, arc.middle, middle)
        return find_excess(self.gradient, arc, at_middle, chord)

    def move(self, arc: Arc, middle: Array, correction: Array) -> Sweep:
        """The step, by what is to be added to the gradient at its middle."""
        rates = self.rates(arc.lanes, arc.middle, middle)
        turn = self.bracket(arc.lanes, arc.middle, middle, correction)
        rise = arc.length * (rates + turn)
        return Sweep(arc.state + (arc.low + 0.5 * rise), rise)


def find_excess(gradient: Gradient, arc: Arc, at_middle: Array, chord: Array) -> Array:
    """The mean of gradients along a chord minus those at its middle, by Gauss's formula."""
    total = np.zeros(at_middle.shape)
    for node, weight in NODES:
        ends = (arc.state + (arc.low + part * chord) for part in (node, 1.0 - node))
        near, far = (gradient(arc.lanes, arc.middle, end) for end in ends)
        total = total + weight * (near + far - 2.0 * at_middle)
    return total
