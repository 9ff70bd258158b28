"""Discrete gradients of several functions: a motion that is made of them at the middle of a step.

For each function F a discrete gradient g has ``g.(y - x) = F(y) - F(x)``, x and y the ends of a
step; it is found as that of the energy alone (`coadjoint.solve.methods.discrete_gradient`). What
the rates are by these gradients decides which functions stay.
Comes in: where members are. Goes out: the middle of a step by sweeps, and its chord.
Read next: `coadjoint.solve.methods.metriplectic_gradient`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from coadjoint.lower.compositions import COMPOSITIONS
from coadjoint.solve.methods.average_gradient import find_excess
from coadjoint.solve.methods.discrete_gradient import Corrected, find_factor
from coadjoint.solve.methods.lie_poisson import Arc, LiePoisson, Sweep

if TYPE_CHECKING:
    from collections.abc import Callable

    from coadjoint.array_types import Array


class SeveralGradients(LiePoisson):
    """A motion by the gradients of several functions.

    Args:
        values: The functions, ``(k, N)``, at states some time later.
        gradients: Their gradients, ``(k * n, N)``, one below the other.
        size: The step.
        order: 2, or that of a composition.
    """

    def __init__(
        self,
        *,
        values: Callable[..., Array],
        gradients: Callable[..., Array],
        size: float,
        order: int = 2,
    ) -> None:
        self.values, self.gradients = values, gradients
        self.size, self.stages = size, COMPOSITIONS[order]

    def find_rates(self, arc: Arc, middle: Array, gradients: Array) -> Array:
        """The rates by discrete gradients, ``(k, n, N)``."""
        raise NotImplementedError

    def prepare(self, arc: Arc, middle: Array) -> Corrected:
        """As `LiePoisson.prepare`; with a factor for each function."""
        count = len(self.values(arc.lanes, arc.middle, arc.state))
        return Corrected(arc.state, np.zeros((count, arc.state.shape[1])))

    def sweep(self, arc: Arc, middle: Array, kept: Corrected) -> Sweep:
        """As `LiePoisson.sweep`."""
        n, members = middle.shape
        chord = 2.0 * ((middle - arc.state) - arc.low)
        square = np.zeros(members)
        for step in chord:
            square = square + step * step
        ends = (arc.state, arc.state + (arc.low + chord))
        first, last = (self.values(arc.lanes, arc.middle, end) for end in ends)
        slopes = self.gradients(arc.lanes, arc.middle, middle)
        excess = find_excess(self.gradients, arc, slopes, chord)
        along = np.zeros(first.shape)
        for i in range(n):
            along = along + (slopes[i::n] + excess[i::n]) * chord[i]
        missing = (last - first) - along
        factors = find_factor(missing, np.abs(first) + np.abs(last), square)
        kept.approach(middle)
        kept.factor = np.where(kept.done, kept.factor, factors)
        corrections = (kept.factor[:, np.newaxis] * chord).reshape(slopes.shape)
        gradients = (slopes + (excess + corrections)).reshape(-1, n, members)
        rise = arc.length * self.find_rates(arc, middle, gradients)
        return Sweep(arc.state + (arc.low + 0.5 * rise), rise)
