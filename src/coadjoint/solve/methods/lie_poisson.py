"""Lie-Poisson steps: what the implicit methods on coadjoint orbits have in common, in NumPy.

Each moves a state along its coadjoint orbit by an element of the group that is found from the
energy's gradient at some middle of the step. Each is its own adjoint, so that compositions with
symmetric coefficients have order 4 and 6.
Comes in: where members are. Goes out: where a step of each leads.
Read next: `coadjoint.solve.methods.coadjoint_mean`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.lower.compositions import COMPOSITIONS
from coadjoint.lower.normals import SWEEPS
from coadjoint.solve.steps import Lanes, larger

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Mask = NDArray[np.bool_]

#: The derivative of the energy by the state, some time after that of the lanes, ``(n, N)``.
Gradient = Callable[[Lanes, "Array", "Array"], "Array"]
#: The Poisson tensor at a state times a vector, likewise: arguments are lanes, time after them,
#: state and vector.
Bracket = Callable[[Lanes, "Array", "Array", "Array"], "Array"]

#: The part of the largest component by which the last sweep of a step may change it.
SOLVED: Final = 2.0**-44


@dataclass
class Arc:
    """A step of a composition.

    Attributes:
        lanes: Members where the whole step begins.
        middle: Time from there to the middle of this one, ``(N,)``.
        length: How long it takes, ``(N,)``.
        state: Where it begins, ``(n, N)``.
        low: What rounding took of that.
    """

    lanes: Lanes
    middle: Array
    length: Array
    state: Array
    low: Array


@dataclass
class Sweep:
    """What a sweep finds.

    Attributes:
        middle: A better middle of the step, ``(n, N)``.
        rise: What the step adds to a state, with the gradient at the middle before, ``(n, N)``.
        goes_on: Where it cannot be the last one, ``(N,)``.
    """

    middle: Array
    rise: Array
    goes_on: Mask | bool = False


class Search:
    """The search for the middle of a step: sweeps, until they no longer improve it.

    A lane stops at the first sweep that changes its middle next to nothing, and no less than the
    sweep before it. To stop earlier, at a given size of the change, leaves an error of one sign:
    of a free body with steps of 0.1 it made the Casimir drift by 1e-10 in 2e6 steps, in place of
    6e-14.

    Attributes:
        middle: What was found, ``(n, N)``.
        rise: What the step adds to a state.
        done: Where the search has ended.
        solved: Where the last sweep changed next to nothing.
        made: How many sweeps there were, ``(N,)``.
    """

    def __init__(self, state: Array) -> None:
        count = state.shape[1]
        self.middle, self.rise = state, np.zeros(state.shape)
        self.done, self.solved = np.zeros(count, bool), np.zeros(count, bool)
        self.last, self.made = np.full(count, np.inf), np.zeros(count, np.uint64)

    def take(self, sweep: Sweep) -> None:
        """Go on to what a sweep finds, in lanes that have not ended."""
        change, size = np.zeros(self.last.shape), np.zeros(self.last.shape)
        for one, other in zip(sweep.middle, self.middle, strict=True):
            change, size = larger(np.abs(one - other), change), larger(np.abs(one), size)
        small = (change <= SOLVED * size) & ~np.asarray(sweep.goes_on)
        ends = small & ((change == 0.0) | (change >= self.last))
        self.middle = np.where(self.done, self.middle, sweep.middle)
        self.rise = np.where(self.done, self.rise, sweep.rise)
        self.made = np.where(self.done, self.made, self.made + np.uint64(1))
        self.solved = np.where(self.done, self.solved, small)
        self.last = np.where(self.done, self.last, change)
        self.done = self.done | ends


class LiePoisson:
    """An implicit method on coadjoint orbits.

    Args:
        gradient: The derivative of the energy.
        bracket: The Poisson tensor times a vector; it is linear in the state.
        size: The step.
        order: 2, or that of a composition: 4 or 6.
    """

    def __init__(
        self, *, gradient: Gradient, bracket: Bracket, size: float, order: int = 2
    ) -> None:
        self.gradient, self.bracket, self.size = gradient, bracket, size
        self.stages = COMPOSITIONS[order]

    def advance(
        self, lanes: Lanes, h: Array, state: Array, low: Array
    ) -> tuple[Array, Array, Mask, NDArray[np.uint64]]:
        """The state after a step, what rounding took of it, where it was solved, and sweeps."""
        after, solved = np.zeros(h.shape), np.ones(h.shape, bool)
        made = np.zeros(h.shape, np.uint64)
        for stage in self.stages:
            length = stage * h
            arc = Arc(lanes=lanes, middle=after + 0.5 * length, length=length, state=state, low=low)
            found = self._search(arc)
            state, low = add_low(state, low, found.rise)
            after, solved, made = after + length, solved & found.solved, made + found.made
        return state, low, solved, made

    def _search(self, arc: Arc) -> Search:
        """The middle of a step, and what the step adds to its state."""
        search, kept = Search(arc.state), self.prepare(arc)
        for _ in range(SWEEPS):
            if search.done.all():
                break
            search.take(self.sweep(arc, search.middle, kept))
        search.solved &= np.isfinite(search.rise).all(axis=0) & self.confirm(kept)
        return search

    def prepare(self, arc: Arc) -> Any:
        """What sweeps of a step share, and may change."""
        return None

    def confirm(self, kept: Any) -> Mask | bool:
        """Where what sweeps share is that of a solution."""
        return True

    def sweep(self, arc: Arc, middle: Array, kept: Any) -> Sweep:
        """A better middle of a step."""
        raise NotImplementedError


def add_low(high: Array, low: Array, rise: Array) -> tuple[Array, Array]:
    """A compensated sum: a value plus what rounding took of it before, and takes now.

    >>> total, low = add_low(np.ones(1), np.zeros(1), np.array([2.0**-60]))
    >>> (float(total[0]), float(low[0]) == 2.0**-60)
    (1.0, True)
    """
    added = rise + low
    total = high + added
    other = total - high
    return total, (high - (total - other)) + (added - other)
