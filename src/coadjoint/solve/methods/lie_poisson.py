"""Lie-Poisson steps: what the implicit methods on coadjoint orbits have in common, in NumPy.

Each moves a state along its coadjoint orbit by an element of the group that is found from the
energy's gradient at some middle of the step. Each is its own adjoint, so that compositions with
symmetric coefficients have order 4 and 6.

The search for the middle begins where those of the last steps ended, continued as a parabola in the
number of the step. Newton's method takes the place of sweeps alone where it is asked for
(`coadjoint.solve.methods.newton`, and for equal members `coadjoint.solve.methods.bands` and
`coadjoint.solve.methods.krylov`). What a
step leaves for the next one stands in its memory: rows of what rounding took of the state, and for
each search the last offsets of the middle from the state, the newest one first.
Comes in: where members are. Goes out: where a step of each leads.
Read next: `coadjoint.solve.methods.coadjoint_mean`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.lower.compositions import COMPOSITIONS
from coadjoint.lower.normals import SWEEPS
from coadjoint.methods import TERMS
from coadjoint.solve.methods import bands as banded
from coadjoint.solve.methods import krylov, newton
from coadjoint.solve.steps import Lanes, add_low

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.array_types import Array, Mask

#: The derivative of the energy by the state, some time after that of the lanes, ``(n, N)``.
Gradient = Callable[[Lanes, "Array", "Array"], "Array"]
#: The Poisson tensor at a state times a vector, likewise: arguments are lanes, time after them,
#: state and vector.
Bracket = Callable[[Lanes, "Array", "Array", "Array"], "Array"]

#: Sweeps that are made before any may be the last one.
FREE: Final = 3
#: Sweeps that end a search only where they change nothing: to ask that costs less than to ask how
#: much they change.
EXACT: Final = 13
#: Rows of a state up to which every other of these is asked, and not each: to ask costs as much as
#: to sweep there.
FEW_ROWS: Final = 8
#: The part of the largest component by which the last sweep of a step may change it.
SOLVED: Final = 2.0**-44
#: These numbers, as templates read them.
STOPPING: Final = MappingProxyType(
    {"FREE": FREE, "EXACT": EXACT, "FEW_ROWS": FEW_ROWS, "SOLVED": SOLVED}
)


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

    A lane is done at the first sweep that changes nothing, after `FREE`, of those that are asked:
    where a state has no more than `FEW_ROWS`, every other one. Where roundings never end
    that, it goes on to `EXACT` of them and stops one sweep after one that changes next to nothing,
    and no less than the sweep before it: what the step adds belongs to the middle before the last
    sweep, which has to be such an end itself. To stop earlier leaves an error of one sign: with
    steps of 0.1 of a free body 1e-10 of its Casimir in 2e6 steps where it is at a given size of the
    change, and 2e-21 a step where it is by one.

    Args:
        middle: Where it begins, ``(n, N)``.
        rows: Those of the state.
        exact: `EXACT`, or `FREE` of Newton's method, which has no such errors.
        holds: Whether lanes that are done are left as they are. A sweep that changes nothing
            changes nothing again, so that this is asked for only where they are done otherwise.

    Attributes:
        middle: What was found, ``(n, N)``.
        rise: What the step adds to a state.
        done: Where the search has ended.
        turned: Where a sweep changed next to nothing, and no less than the one before.
        made: How many sweeps there were, ``(N,)``.
    """

    def __init__(
        self, middle: Array, rows: int, exact: int = EXACT, *, holds: bool = False
    ) -> None:
        count, self.exact, self.holds = middle.shape[1], exact, holds
        self.middle, self.rise = middle, np.zeros((rows, count))
        self.done, self.turned = np.zeros(count, bool), np.zeros(count, bool)
        self.last, self.made = np.full(count, np.inf), np.zeros(count, np.uint64)

    @property
    def solved(self) -> Mask:
        """Where it has ended, and what the step adds is finite."""
        return np.asarray(self.done & np.isfinite(self.rise).all(axis=0))

    def take(self, number: int, sweep: Sweep) -> None:
        """Go on to what a sweep finds, in lanes that have not ended; sweeps are counted from 0."""
        ends = ~np.asarray(sweep.goes_on)
        held = self.done & np.array(self.holds or number >= self.exact)
        middle = np.where(held, self.middle, sweep.middle)
        if number >= self.exact:
            ends = ends & self._may_end(middle)
        elif self._is_asked(number):
            ends = ends & (middle == self.middle).all(axis=0)
        self.middle, self.rise = middle, np.where(held, self.rise, sweep.rise)
        self.made = np.where(self.done, self.made, self.made + np.uint64(1))
        if number >= self.exact or self._is_asked(number):
            self.done = self.done | ends

    def _is_asked(self, number: int) -> bool:
        """Whether a sweep before the exact ones may end the search by changing nothing."""
        few = len(self.rise) <= FEW_ROWS
        return number >= FREE and (not few or (number - FREE) % 2 == 1)

    def _may_end(self, middle: Array) -> Mask:
        """Where a sweep changes nothing, or follows one after which roundings turn back."""
        change, size = (
            np.fmax.reduce(np.abs(rows), axis=0, initial=0.0)  # what is no number is left out
            for rows in (middle - self.middle, middle)
        )
        small = change <= SOLVED * size
        ends = small & ((change == 0.0) | self.turned)
        self.turned = self.turned | (small & (change >= self.last))
        self.last = change
        return np.asarray(ends)

    def take_over(self, other: Search, lanes: Mask) -> None:
        """Have what another search found in some lanes; its sweeps count in all of them."""
        self.middle = np.where(lanes, other.middle, self.middle)
        self.rise = np.where(lanes, other.rise, self.rise)
        self.made = self.made + other.made
        self.done = self.done | lanes


class LiePoisson:
    """An implicit method on coadjoint orbits.

    Args:
        gradient: The derivative of the energy.
        bracket: The Poisson tensor times a vector; it is linear in the state.
        size: The step.
        order: 2, or that of a composition: 4 or 6.

    Attributes:
        jacobian: The derivatives of the rates by the state, row by row, some time after lanes, for
            Newton's method; None without it.
        along: In its place, of equal members, the derivative of the rates along a vector.
        bands: Which of these are coupled, where not all are.
        holds: Whether a sweep that changes nothing may change something again.
    """

    jacobian: Callable[[Lanes, Array, Array], Array] | None = None
    along: Bracket | None = None
    bands: banded.Bands | None = None
    holds = False

    def __init__(
        self, *, gradient: Gradient, bracket: Bracket, size: float, order: int = 2
    ) -> None:
        self.gradient, self.bracket, self.size = gradient, bracket, size
        self.stages = COMPOSITIONS[order]

    def advance(
        self, lanes: Lanes, h: Array, state: Array, memory: Array
    ) -> tuple[Array, Array, Mask, NDArray[np.uint64]]:
        """The state after a step, what it leaves, where it was solved, and how many sweeps it took.

        Args:
            lanes: Members where it begins.
            h: Its length, ``(N,)``.
            state: Where it begins, ``(n, N)``.
            memory: What the step before left, as `StructuredMethod.count_memory` says; zeros at
                the first one. Without what is kept of searches all begin at the state.
        """
        after, solved = np.zeros(h.shape), np.ones(h.shape, bool)
        made, (low, *offsets) = np.zeros(h.shape, np.uint64), split_memory(memory, len(state))
        kept = []
        for number, stage in enumerate(self.stages):
            length = stage * h
            arc = Arc(lanes=lanes, middle=after + 0.5 * length, length=length, state=state, low=low)
            offset = continue_offset(offsets[number]) if offsets else np.zeros(state.shape)
            found = self.search(arc, state, offset, ~solved)
            if offsets:
                kept.append(keep_offset(offsets[number], found.middle - state))
            state, low = add_low(state, low, found.rise)
            made = made + np.where(solved, found.made, np.uint64(0))  # up to one that fails
            after, solved = after + length, solved & found.solved
        return state, np.concatenate([low, *kept]), solved, made

    def search(self, arc: Arc, start: Array, offset: Array, done: Mask) -> Search:
        """The middle of a step, and what the step adds to its state, in lanes that are not done.

        Where the search leads nowhere from some way off its start it begins again without that.
        """
        first, solved = self._try_search(arc, start + offset, done)
        over = solved | ~(offset != 0.0).any(axis=0)
        if over.all():
            first.done = solved
            return first
        again, more = self._try_search(arc, start, over, holds=True)
        again.take_over(first, over)
        again.done = np.where(over, solved, more)
        return again

    def _try_search(
        self, arc: Arc, middle: Array, done: Mask, *, holds: bool = False
    ) -> tuple[Search, Mask]:
        """A search from some middle on in lanes that are not done, and where it is solved."""
        has_newton = self.jacobian is not None or self.along is not None
        exact = FREE if has_newton else EXACT
        search = Search(middle, len(arc.state), exact, holds=holds or self.holds)
        kept = self.prepare(arc, middle)
        search.done = done
        for number in range(SWEEPS):
            if search.done.all():
                break
            found = self.sweep(arc, search.middle, kept)
            if has_newton:
                found.middle = self._improve(arc, search.middle, found.middle, kept)
            search.take(number, found)
        return search, search.solved & self.confirm(kept)

    def _improve(self, arc: Arc, middle: Array, following: Array, kept: Any) -> Array:
        """Where Newton's method leads from a middle, which a sweep leads to what follows."""
        if self.along is None:
            slopes = self.linearise(arc, middle, following, kept)
            return newton.improve(middle, following, slopes)

        def apply(vector: Array) -> Array:
            return self.apply_slopes(arc, middle, following, kept, vector)

        if self.bands is not None:
            return banded.improve(middle, following, apply, self.bands)
        return krylov.improve(middle, following, apply)

    def prepare(self, arc: Arc, middle: Array) -> Any:
        """What sweeps of a step share from some middle on, and may change."""
        return None

    def confirm(self, kept: Any) -> Mask | bool:
        """Where what sweeps share is that of a solution."""
        return True

    def sweep(self, arc: Arc, middle: Array, kept: Any) -> Sweep:
        """A better middle of a step."""
        raise NotImplementedError

    def linearise(self, arc: Arc, middle: Array, following: Array, kept: Any) -> Array:
        """The slopes of a sweep that led from a middle to what follows, ``(n, n, N)``.

        Exact of the midpoint; of others they are those of the first order in the step.
        """
        return self.find_slopes(arc, arc.middle, 0.5 * arc.length, middle)

    def apply_slopes(
        self, arc: Arc, middle: Array, following: Array, kept: Any, vector: Array
    ) -> Array:
        """What `linearise` has times a vector, of equal members, whose matrix is not formed."""
        assert self.along is not None, "asked for by Newton's method alone"
        return 0.5 * arc.length * self.along(arc.lanes, arc.middle, middle, vector)

    def find_slopes(self, arc: Arc, after: Array, length: Array, state: Array) -> Array:
        """A length times the Jacobian; rows that are reconstructed have none, and are swept."""
        assert self.jacobian is not None, "asked for by Newton's method alone"
        size, count = state.shape
        rows = self.jacobian(arc.lanes, after, state)
        slopes, known = np.zeros((size, size, count)), len(rows)
        slopes[:known, :known] = length * rows
        return slopes


def split_memory(memory: Array, rows: int) -> list[Array]:
    """The low part of a state, and for each search what is kept of it, ``(TERMS, n, N)``."""
    count = memory.shape[1]
    return [memory[:rows], *memory[rows:].reshape(-1, TERMS, rows, count)]


def continue_offset(kept: Array) -> Array:
    """The next value of a sequence whose third differences are zero, from its last three.

    >>> kept = np.zeros((TERMS, 1, 1))
    >>> for value in (1.0, 4.0, 9.0):
    ...     kept = keep_offset(kept, np.full((1, 1), value)).reshape(kept.shape)
    >>> float(continue_offset(kept)[0, 0])
    16.0
    """
    last, before, first = kept
    return np.asarray(first + 3.0 * (last - before))


def keep_offset(kept: Array, offset: Array) -> Array:
    """What is kept of searches after one that ended at an offset; it is 0 of those before all."""
    return np.concatenate([offset, *kept[:-1]])
