"""Limits: what bounds a motion, its kinks, and where within a step it comes to either.

Comes in: functions of a kernel, and a step that was tried. Goes out: where the step leaves the
domain or meets a kink, found by halving. These are the functions of the generated ``solver.c``,
operation by operation.
Read next: `coadjoint.solve.ensemble`, which ends steps there.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from coadjoint.solve.steps import Attempt, Lanes

    Array = NDArray[np.float64]
    Mask = NDArray[np.bool_]
    #: Rows of a function at states, some time after lanes.
    Function = Callable[[Lanes, Array, Array], Array]

#: Halvings of a step that leaves the domain: its last state inside is known to 1e-12 of it. Those
#: of one that may meet a kink, which is found as closely as times are known.
HALVINGS, KINK_HALVINGS = 40, 64
#: Halvings that look for the place of a step that is nearest to a kink.
DIP_HALVINGS = 32
#: Halvings until a step is tried again that is to end behind a kink; how far behind, as a factor;
#: and the part of a step after which a kink is close to its end.
ROUGH_HALVINGS, BEHIND, CLOSE = 10, 1.0 + 2.0**-8, 1.0 - 2.0**-7
#: The part of a step over which straight lines are drawn.
NEAR = 2.0**-20
#: The part of a step, or of the time, within which a kink follows another one briefly.
BRIEF = 2.0**-30
#: The part of an allowed error by which a step may differ on the two sides of a kink that does not
#: end it.
ALIKE = 0.0625


@dataclass(frozen=True)
class Limits:
    """What bounds a motion, and where it has kinks.

    Attributes:
        domain: Rows that are positive in the domain; None where there is none.
        strict: For each row, whether it may not be zero.
        projection: The nearest states on the constraints; None where none are kept.
        kinks: Rows whose signs are the sides of kinks; None where there are none.
        rates: The rates on the sides of lanes; without them all kinks count.
        branches: Whether they have roots, or other branch points.
    """

    domain: Function | None = None
    strict: tuple[bool, ...] = ()
    projection: Function | None = None
    kinks: Function | None = None
    rates: Function | None = None
    branches: bool = False

    def find_sides(self, lanes: Lanes) -> None:
        """Set lanes on the sides on which they are: rates are those of these sides for a step."""
        if self.kinks is not None:
            none = np.zeros(lanes.time.shape)
            lanes.sides = self.choose_sides(lanes, none, lanes.state)

    def choose_sides(self, lanes: Lanes, after: Array, state: Array) -> Array:
        """The sides on which states are, some time after that of the lanes, ``(m, N)``."""
        assert self.kinks is not None
        return np.sign(self.kinks(lanes, after, state))

    def are_inside(self, lanes: Lanes, after: Array, state: Array) -> Mask:
        """Where states are in the domain, some time after that of the lanes."""
        if self.domain is None:
            return np.ones(after.shape, bool)
        rows = self.domain(lanes, after, state)
        least = np.where(self.strict, np.nextafter(0.0, 1.0), 0.0)[:, np.newaxis]
        return np.asarray(((rows >= least) & (rows < np.inf)).all(axis=0))

    def find_beyond(self, lanes: Lanes, after: Array, state: Array) -> Mask:
        """Beyond which kinks states are from where their step began, ``(m, N)``."""
        if self.kinks is None:
            return np.zeros((0, *after.shape), bool)
        sides = self.choose_sides(lanes, after, state)
        return np.asarray(~((sides == lanes.sides) | (sides == 0.0)))

    def project(self, lanes: Lanes, after: Array, state: Array) -> Array:
        """The nearest states on the constraints; where there is none, the state itself."""
        if self.projection is None:
            return state
        nearest = self.projection(lanes, after, state)
        return np.where(np.isfinite(nearest).all(axis=0), nearest, state)


#: Nothing.
NONE = Limits()


@dataclass(frozen=True)
class Step:
    """A step of some members.

    Attributes:
        lanes: Where it begins.
        attempt: Where it leads.
        limits: What bounds the motion.
        accepted: Whether its end is taken.
        allowed: How much rates may differ on the two sides of a kink that does not end it,
            ``(n, N)``.
    """

    lanes: Lanes
    attempt: Attempt
    limits: Limits
    accepted: Mask
    allowed: Array

    def find_state(self, after: Array) -> Array:
        """The state after a part of the step, on the constraints."""
        return self.limits.project(self.lanes, after, self.attempt.path(after))

    def are_held(self, after: Array, state: Array) -> Mask:
        """Where it is in the domain after a part of the step, and beyond no kink that counts."""
        inside = self.limits.are_inside(self.lanes, after, state)
        beyond = self.limits.find_beyond(self.lanes, after, state)
        held = ~beyond.any(axis=0)
        if (self.accepted & inside & ~held).any():
            held |= self.accepted & ~self._do_count(after, state, beyond)
        return inside & held

    def _do_count(self, after: Array, state: Array, beyond: Mask) -> Mask:
        """Where a tolerance tells the rates of the step's sides from those beyond kinks.

        Beads that only just touch push each other by next to nothing.
        """
        limits, lanes = self.limits, self.lanes
        if limits.rates is None:
            return np.asarray(beyond.any(axis=0))
        assert lanes.sides is not None
        sides = np.where(beyond, limits.choose_sides(lanes, after, state), lanes.sides)
        there = limits.rates(replace(lanes, sides=sides), after, state)
        gap = np.abs(limits.rates(lanes, after, state) - there)
        return np.asarray(~(gap <= self.allowed).all(axis=0))

    def _find_counting(self, after: Array) -> Mask:
        """Which kinks count, of those beyond which the step is after a part of it, ``(m, N)``.

        They do so by themselves, or all together.
        """
        state = self.find_state(after)
        beyond = self.limits.find_beyond(self.lanes, after, state)
        counts = np.zeros(beyond.shape, bool)
        for row in np.flatnonzero(beyond.any(axis=1)).tolist():
            alone = np.zeros(beyond.shape, bool)
            alone[row] = beyond[row]
            counts[row] = beyond[row] & self._do_count(after, state, alone)
        return np.where(counts.any(axis=0), counts, beyond)

    def find_dips(self) -> Array:
        """When the step is found beyond a kink, or outside the domain, before its end.

        A step may meet a kink and come back. Where it comes nearer and then goes away, straight
        lines through both ends tell how near it may come, and halving finds the place; also before
        a kink at which it is found already.

        Returns:
            The length of the step where it is found nowhere, ``(N,)``.
        """
        took = self.attempt.took
        outside = took.copy()
        if self.limits.kinks is None:
            return outside
        near, half = took * NEAR, took * 0.5
        for begin, end in ((np.zeros(took.shape), half), (half, took)):
            places = (begin, begin + near, end - near, end)
            gaps = [self._look(after, self.accepted, outside) for after in places]
            fall, rise = gaps[0] - gaps[1], gaps[3] - gaps[2]
            place = (gaps[0] - gaps[3] + rise * (0.5 / NEAR)) / (fall + rise)
            near_zero = (fall > 0.0) & (rise > 0.0) & (gaps[0] - fall * place < 0.0)
            for row in np.flatnonzero((near_zero & self.accepted).any(axis=1)).tolist():
                low = near_zero[row] & self.accepted & (begin < outside)
                if low.any():
                    self._search(row, (begin, end), low, outside)
        return outside

    def _look(self, after: Array, open_: Mask, outside: Array) -> Array:
        """How far it is from each kink after a part of it, positive on the side where it began.

        An open lane that is on another side ends there, at the first such place.
        """
        state = self.find_state(after)
        assert self.limits.kinks is not None
        assert self.lanes.sides is not None
        gaps = self.limits.kinks(self.lanes, after, state) * self.lanes.sides
        gone = open_ & ~self.are_held(after, state) & (after < outside)
        outside[gone] = after[gone]
        return np.asarray(gaps)

    def _search(self, row: int, part: tuple[Array, Array], low: Mask, outside: Array) -> None:
        """Look where a part of the step is nearest to a kink."""
        (one, other), near = part, self.attempt.took * NEAR
        nowhere = np.zeros(low.shape, bool)
        for _ in range(DIP_HALVINGS):
            middle = (one + other) * 0.5
            here = self._look(middle, low, outside)[row]
            falls = self._look(middle + near, nowhere, outside)[row] < here
            one, other = np.where(falls, middle, one), np.where(falls, other, middle)

    def find_retries(self, outside: Array) -> tuple[Mask, Array]:
        """Which steps are to be tried again since they meet a kink early, and their new lengths.

        The error that a method tells is that of the end of a step, on the sides of its start. Where
        rates have roots, they are not smooth beyond a kink: then each step is to end close behind.

        Args:
            outside: When the step is found beyond a kink.
        """
        took = self.attempt.took
        met = self.accepted & (outside < took)
        if not self.limits.branches:
            return met & (outside <= took * 0.5) & (outside > took * NEAR), took * 0.5
        one, other = np.zeros(took.shape), outside
        for _ in range(ROUGH_HALVINGS if met.any() else 0):
            middle = (one + other) * 0.5
            good = self.are_held(middle, self.find_state(middle))
            one, other = np.where(good, middle, one), np.where(good, other, middle)
        return met & (other <= took * CLOSE) & (other > took * NEAR), other * BEHIND

    def find_brief(self) -> Array:
        """The length within which a kink follows another one briefly, ``(N,)``."""
        took, time = self.attempt.took, np.abs(self.lanes.time)
        return np.where(took > time, took, time) * BRIEF

    def find_exit(self, inside: Array, outside: Array) -> tuple[Array, Array]:
        """How far the step is in the domain and on its sides, and when it is not."""
        counts = self._find_counting(outside)
        for _ in range(HALVINGS if self.limits.kinks is None else KINK_HALVINGS):
            middle = (inside + outside) * 0.5
            state = self.find_state(middle)
            good = self.limits.are_inside(self.lanes, middle, state)
            good &= ~(counts & self.limits.find_beyond(self.lanes, middle, state)).any(axis=0)
            inside = np.where(good, middle, inside)
            outside = np.where(good, outside, middle)
        return inside, outside

    def cross(self, left: Mask, outside: Array, found: tuple[Array, Array]) -> Crossing:
        """Where members go beyond a kink, instead of ending at the bound of the domain.

        Args:
            left: The members that do not come to the end of the step.
            outside: When they are beyond.
            found: The state and the time at which each comes to an end otherwise.
        """
        (state, time), lanes = found, self.lanes
        if self.limits.kinks is None:
            return Crossing(np.zeros(left.shape, bool), state, time, np.zeros((0, len(left)), bool))
        beyond = self.find_state(outside)
        met = left & self.limits.are_inside(lanes, outside, beyond)
        after = lanes.time + outside
        least = lanes.time + np.abs(lanes.time) * 2.0**-52
        after = np.where(after > lanes.time, after, least)
        sides = self.limits.choose_sides(lanes, outside, beyond)
        return Crossing(
            met=met,
            state=np.where(met, beyond, state),
            time=np.where(met, after, time),
            kinks=met & ~(sides == lanes.sides),
        )


@dataclass(frozen=True)
class Crossing:
    """Where members go beyond a kink.

    Attributes:
        met: Which of them do.
        state: Where they are then, and others as they were.
        time: When.
        kinks: Which kinks those are, ``(m, N)``.
    """

    met: Mask
    state: Array
    time: Array
    kinks: Mask
