"""The discrete gradient of any energy: its mean along the chord, corrected along the chord.

``g = mean + c (y - x)`` with the number c for which ``g.(y - x) = H(y) - H(x)``, as O. Gonzalez,
Journal of Nonlinear Science 6 (1996) 449, corrects the gradient at the middle. The mean, by Gauss's
formula, leaves so little to c that the energies at both ends mostly differ from it by roundings
alone; then c is 0. To take their difference in any case would divide roundings of the energy by a
short chord: a rattleback that turns slowly was not solved with it.
Comes in: where members are. Goes out: the middle of a step by sweeps, and its chord.
Read next: `coadjoint.solve.methods.average_gradient`, which says what steps keep.
"""

from __future__ import annotations

from math import sqrt
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.families import LANES
from coadjoint.solve.methods.average_gradient import NODES, AverageGradient
from coadjoint.solve.methods.lie_poisson import Arc, Gradient, Sweep

if TYPE_CHECKING:
    from collections.abc import Mapping

    from coadjoint.array_types import Array

#: The part of the energies at both ends that is no more than their roundings.
ROUNDINGS: Final = 2.0**-50
#: By what part of the state the middle of a step may move once c stays: what c corrects is so small
#: that it is known by then, and its roundings would go on to move the step.
NEAR: Final = 2.0**-40
#: These numbers, as templates read them.
GRADIENTS: Final = MappingProxyType(
    {"NODES": NODES, "ROUNDINGS": ROUNDINGS, "NEAR": NEAR, "PARTS": LANES}
)


def make(functions: Mapping[str, Any], size: float, order: int) -> DiscreteGradient:
    """The method of an order, from functions of the kernel."""
    return DiscreteGradient(
        energy=functions["energy"],
        rates=functions["rates"],
        gradient=functions["gradient"],
        bracket=functions["bracket"],
        size=size,
        order=order,
        members=functions.get("members", 1),
    )


class Corrected:
    """What sweeps of a step know of it.

    Attributes:
        middle: Where the last sweep began, ``(n, N)``.
        factor: c, ``(N,)``; of several functions ``(k, N)``.
        done: Where c stays.
    """

    def __init__(self, state: Array, factor: Array | None = None) -> None:
        self.middle, self.done = np.full(state.shape, np.inf), np.zeros(state.shape[1], bool)
        self.factor = np.zeros(state.shape[1]) if factor is None else factor

    def approach(self, middle: Array) -> None:
        """Go on to a middle."""
        change, size = (
            np.fmax.reduce(np.abs(rows), axis=0, initial=0.0)  # what is no number is left out
            for rows in (middle - self.middle, middle)
        )
        self.middle, self.done = middle, self.done | (change <= NEAR * size)


class DiscreteGradient(AverageGradient):
    """The mean of the gradient, corrected along the chord for the energy between its ends.

    Args:
        energy: The energy, ``(1, N)`` or ``(N,)``.
        members: Of how many equal members it is a sum. Kernels add them up in `LANES` parts, whose
            roundings grow as a walk with steps to both sides.
        given: As of `AverageGradient`.
    """

    def __init__(self, *, energy: Gradient, members: int = 1, **given: Any) -> None:
        super().__init__(**given)
        self.energy, self.growth = energy, sqrt(max(1.0, members / LANES))

    def prepare(self, arc: Arc, middle: Array) -> Corrected:
        """As `LiePoisson.prepare`."""
        return Corrected(arc.state)

    def sweep(self, arc: Arc, middle: Array, kept: Corrected) -> Sweep:
        """As `LiePoisson.sweep`."""
        chord = 2.0 * ((middle - arc.state) - arc.low)
        excess = self.find_excess(arc, middle, chord)
        slope = self.gradient(arc.lanes, arc.middle, middle)
        first, last = (
            self.energy(arc.lanes, arc.middle, end).reshape(-1)
            for end in (arc.state, arc.state + (arc.low + chord))
        )
        along, square = (  # row by row, as C adds them up
            np.add.accumulate(rows)[-1] for rows in ((slope + excess) * chord, chord * chord)
        )
        missing = (last - first) - along
        size = self.growth * (np.abs(first) + np.abs(last))
        factor = find_factor(missing, size, square)
        kept.approach(middle)
        kept.factor = np.where(kept.done, kept.factor, factor)
        return self.move(arc, middle, excess + kept.factor * chord)


def find_factor(missing: Array, size: Array, square: Array) -> Array:
    """By what the chord is multiplied for what gradients along it miss; 0 for roundings.

    Args:
        missing: What they miss.
        size: Of the values whose difference it is part of.
        square: Of the chord.
    """
    is_seen = np.abs(missing) > ROUNDINGS * size
    return np.where(is_seen, missing / np.where(is_seen, square, 1.0), 0.0)
