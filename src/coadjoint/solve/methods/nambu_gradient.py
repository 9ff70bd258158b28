"""Nambu's discrete gradient: steps that keep the energy and all distinguished functions.

A motion by Nambu's bracket is the product of the gradients of its energy h and of n - 2
distinguished functions of n coordinates, ``x' = dc x dh`` of three. In a step each gradient is a
discrete one, ``g.(y - x) = F(y) - F(x)`` (`coadjoint.solve.methods.discrete_gradient`). Their
product is orthogonal to each of them, so that no function changes.
R. I. McLachlan, G. R. W. Quispel and N. Robidoux, Philosophical Transactions A 357 (1999) 1021.
Comes in: where members are. Goes out: the middle of a step by sweeps, and its chord.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.lower.compositions import COMPOSITIONS
from coadjoint.solve.methods.average_gradient import find_excess
from coadjoint.solve.methods.discrete_gradient import Corrected, find_factor
from coadjoint.solve.methods.lie_poisson import Arc, LiePoisson, Sweep

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    Array = NDArray[np.float64]


def make(functions: Mapping[str, Any], size: float, order: int) -> NambuGradient:
    """The method of an order, from functions of the kernel."""
    return NambuGradient(
        values=functions["values"], gradients=functions["gradients"], size=size, order=order
    )


class NambuGradient(LiePoisson):
    """The product of discrete gradients.

    Args:
        values: The energy and the distinguished functions, ``(n - 1, N)``, at states some time
            later.
        gradients: Their gradients, ``((n - 1) * n, N)``, one below the other.
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

    def prepare(self, arc: Arc, middle: Array) -> Corrected:
        """As `LiePoisson.prepare`; with a factor for each function."""
        n, members = arc.state.shape
        return Corrected(arc.state, np.zeros((n - 1, members)))

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
        gradients = (slopes + (excess + corrections)).reshape(n - 1, n, members)
        rise = arc.length * multiply_gradients(gradients)
        return Sweep(arc.state + (arc.low + 0.5 * rise), rise)


def multiply_gradients(gradients: Array) -> Array:
    """Nambu's product, ``dc x dh`` for dh above dc, by minors of the first rows.

    Args:
        gradients: ``(n - 1, n, N)``.

    >>> rows = np.array([[[1.0], [0.0], [0.0]], [[0.0], [1.0], [0.0]]])
    >>> multiply_gradients(rows).ravel().tolist()  # of (0, 1, 0) and (1, 0, 0)
    [-0.0, 0.0, -1.0]
    """
    _, n, members = gradients.shape
    minors = {0: np.ones(members)}
    for columns in range(1, (1 << n) - 1):
        row, place, total = columns.bit_count() - 1, 0, np.zeros(members)
        for i in range(n):
            if columns >> i & 1:
                term = gradients[row, i] * minors[columns ^ 1 << i]
                total = total - term if (row + place) % 2 else total + term
                place += 1
        minors[columns] = total
    cofactors = [minors[((1 << n) - 1) ^ 1 << i] for i in range(n)]
    return np.array([each if i % 2 else -each for i, each in enumerate(cofactors)])
