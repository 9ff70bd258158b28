"""Discrete gradients: steps that keep the energy, or balance it with the power of forces.

A step is ``y - x = h (J(m) g + f(m))``, where m is the middle of x and y, J the tensor of the
motion, f its forces, and g a discrete gradient of the energy: ``g.(y - x) = H(y) - H(x)``. J is
antisymmetric, so ``H(y) - H(x) = h g.f(m)``; it need not fulfil Jacobi's identity. The rates at m
are ``J(m) dH(m) + f(m)``, so that the step follows from them and from ``J(m) (g - dH(m))``.
R. I. McLachlan, G. R. W. Quispel and N. Robidoux, Philosophical Transactions A 357 (1999) 1021.
Comes in: where members are. Goes out: the middle of a step by sweeps, and its chord.
Read next: `coadjoint.solve.methods.lie_poisson`, whose search it shares.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

import numpy as np

from coadjoint.solve.methods.gauss import TABLEAUS
from coadjoint.solve.methods.lie_poisson import Arc, LiePoisson, Sweep

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.methods.lie_poisson import Bracket, Gradient

    Array = NDArray[np.float64]
    Mask = NDArray[np.bool_]

#: By what part of the energies at both ends the last correction may differ from the one before.
ROUNDINGS: Final = 2.0**-49
#: A chord whose square is a smaller part of that of the state has no correction that is no more
#: than such roundings: divided by the square it would outgrow the derivatives of the energy.
SHORT: Final = 2.0**-46
_OUTER, _INNER = TABLEAUS[8].nodes[:2]
_WEIGHT: Final = TABLEAUS[8].lengths[0]
#: Nodes between the ends and their weights, of those nearer to the start.
NODES: Final = ((_OUTER, _WEIGHT), (_INNER, 0.5 - _WEIGHT))


class AverageGradient(LiePoisson):
    """The mean of the gradient along the chord, by Gauss's formula with four nodes.

    It is a discrete gradient of polynomials up to degree 8.
    E. Celledoni et al., Journal of Computational Physics 231 (2012) 6770.

    Args:
        rates: Rates of lanes, at states some time later.
        gradient: The derivative of the energy.
        bracket: The tensor times a vector.
        size: The step.
    """

    def __init__(
        self,
        *,
        rates: Callable[..., Array],
        gradient: Gradient,
        bracket: Bracket,
        size: float,
    ) -> None:
        super().__init__(gradient=gradient, bracket=bracket, size=size)
        self.rates = rates

    def sweep(self, arc: Arc, middle: Array, kept: None) -> Sweep:
        """As `LiePoisson.sweep`."""
        at_middle = self.gradient(arc.lanes, arc.middle, middle)
        chord = 2.0 * (middle - arc.state)
        total = np.zeros(middle.shape)
        for node, weight in NODES:
            near = self.gradient(arc.lanes, arc.middle, arc.state + node * chord)
            far = self.gradient(arc.lanes, arc.middle, arc.state + (1.0 - node) * chord)
            total = total + weight * (near + far - 2.0 * at_middle)
        return self.move(arc, middle, total)

    def move(self, arc: Arc, middle: Array, correction: Array) -> Sweep:
        """The step, by what is to be added to the gradient at its middle."""
        rates = self.rates(arc.lanes, arc.middle, middle)
        turn = self.bracket(arc.lanes, arc.middle, middle, correction)
        rise = arc.length * (rates + turn)
        return Sweep(arc.state + 0.5 * rise, rise)


class Corrections:
    """What a search knows of the factor of the chord in the gradient.

    Attributes:
        factor: ``(N,)``.
        last: How much the last sweep changed it, as an energy.
        done: Where it stays: it changed by no more than rounding, and no less than before.
    """

    def __init__(self, count: int) -> None:
        self.factor, self.last = np.zeros(count), np.full(count, np.inf)
        self.done = np.zeros(count, bool)

    def take(self, missing: Array, square: Array, reach: Array, size: Array) -> None:
        """Go on to the factor that gives a missing energy, for squares of a chord and a state."""
        least = ROUNDINGS * size
        moves = (square > SHORT * reach) | ((np.abs(missing) > least) & (square > 0.0))
        factor = np.where(moves, missing / np.where(moves, square, 1.0), 0.0)
        change = np.abs(factor - self.factor) * square
        self.factor = np.where(self.done, self.factor, factor)
        ends = moves & (change <= least) & (change >= self.last)
        self.last = np.where(self.done | ~moves, self.last, change)
        self.done = self.done | ends


class DiscreteGradient(AverageGradient):
    """The gradient at the middle, corrected along the chord for the energy between its ends.

    O. Gonzalez, Journal of Nonlinear Science 6 (1996) 449. It is one of any energy.

    Args:
        energy: The energy, ``(1, N)``.
        given: As of `AverageGradient`.
    """

    def __init__(self, *, energy: Gradient, **given: object) -> None:
        super().__init__(**given)  # type: ignore[arg-type]
        self.energy = energy

    def prepare(self, arc: Arc) -> Corrections:
        """As `LiePoisson.prepare`."""
        return Corrections(arc.state.shape[1])

    def sweep(self, arc: Arc, middle: Array, kept: Corrections) -> Sweep:  # type: ignore[override]
        """As `LiePoisson.sweep`."""
        gradient = self.gradient(arc.lanes, arc.middle, middle)
        chord = 2.0 * (middle - arc.state)
        first = self.energy(arc.lanes, arc.middle, arc.state)[0]
        last = self.energy(arc.lanes, arc.middle, arc.state + chord)[0]
        along, square, reach = (np.zeros(first.shape) for _ in range(3))
        for slope, part, place in zip(gradient, chord, middle, strict=True):
            along = along + slope * part
            square, reach = square + part * part, reach + place * place
        kept.take((last - first) - along, square, reach, np.abs(first) + np.abs(last))
        return self.move(arc, middle, kept.factor * chord)
