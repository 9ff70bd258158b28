"""Crossings: where a function along trajectories passes through zero, or touches it.

Comes in: steps of many members, in calls of any length, and a function of their states. Goes out:
the time, member, direction and state of each crossing.

A value counts as zero within a band, which is as wide as the tolerance of the integration. A
function that leaves the band on the other side has crossed zero, once, at the first change of its
sign. One that comes back out on the same side has touched zero, once, where it came closest or
farthest beyond. So a double root is one touch, whichever side rounding has put it on, and a root at
the end of a step, which is the start of the next, is one root. A trajectory that begins within the
band has crossed nothing yet.
Read next: `coadjoint.solve.roots`, which finds the knots.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.solve.held import Held, Point, restore_held, save_held
from coadjoint.solve.roots import Knots, find_knots, find_roots

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.array_types import Array, Mask, Places
    from coadjoint.solve.roots import Function
    from coadjoint.solve.taken import Enclosed, Steps

EPS: Final = float(np.finfo(float).eps)
#: The part of a step over which the slope at its end is taken.
_BACK: Final = 2.0**-10


@dataclass
class Crossings:
    """Where a function crossed or touched zero.

    Attributes:
        member: Whose each is, ``(E,)``.
        time: When.
        direction: 1 where it rises, -1 where it falls, 0 where it touches.
        state: The states there, ``(n, E)``.
        decided: The row of the step of the last call that decided it; -1 for the end of a
            trajectory.
    """

    member: Places
    time: Array
    direction: NDArray[np.int8]
    state: Array
    decided: Places

    def take(self, which: Mask | Places) -> Crossings:
        """Some of them."""
        return Crossings(
            member=self.member[which],
            time=self.time[which],
            direction=self.direction[which],
            state=self.state[:, which],
            decided=self.decided[which],
        )


def join(lots: list[Crossings], size: int) -> Crossings:
    """All of several lots, by member and time.

    Args:
        lots: What is joined.
        size: Rows of the state.
    """
    if not lots:
        none = np.empty(0, np.intp)
        return Crossings(
            member=none,
            time=np.empty(0),
            direction=none.astype(np.int8),
            state=np.empty((size, 0)),
            decided=none,
        )
    whole = Crossings(
        member=np.concatenate([each.member for each in lots]),
        time=np.concatenate([each.time for each in lots]),
        direction=np.concatenate([each.direction for each in lots]),
        state=np.concatenate([each.state for each in lots], axis=1),
        decided=np.concatenate([each.decided for each in lots]),
    )
    return whole.take(np.lexsort((whole.time, whole.member)))


def _make_crossing(member: int, point: Point, direction: int, decided: int) -> Crossings:
    """A crossing at a point."""
    return Crossings(
        member=np.array([member]),
        time=np.array([point.time]),
        direction=np.array([direction], np.int8),
        state=point.state[:, np.newaxis],
        decided=np.array([decided]),
    )


class Watch:
    """The search for the crossings of one function.

    Args:
        band_of: What is as good as zero, by the size of the terms of the function.
        slack: Part of the time by which a root at the end of a trajectory may be late.
        members: How many there are.

    Attributes:
        undefined: When the function of each member stopped being finite first; infinite for never.
    """

    def __init__(self, band_of: Callable[[Array], Array], slack: float, members: int) -> None:
        self._band_of, self._slack = band_of, max(slack, 16 * EPS)
        self._sign = np.zeros(members, np.int8)
        self._value = np.full(members, np.nan)
        self._held: dict[int, Held] = {}
        self.undefined = np.full(members, np.inf)

    def scan(self, function: Function, steps: Steps, known: Enclosed | None = None) -> Crossings:
        """The crossings that the next steps decide.

        Args:
            function: The function, of the rows of the steps and parts of them.
            steps: The steps that follow those of the call before.
            known: Its enclosure over all steps, if one is known: most steps then cost no more.
        """
        with np.errstate(all="ignore"):
            knots, band = self._find_knots(function, steps, known)
            return _Scan(self, function, steps, knots, band).find()

    def _find_knots(
        self, function: Function, steps: Steps, known: Enclosed | None
    ) -> tuple[Knots, Array]:
        """The knots of steps.

        On a step where the enclosure is monotone they are its ends. Where it keeps away from zero,
        the start is enough; and none is needed if the step before has the same sign.
        """
        if known is None:
            return find_knots(function, len(steps.member), steps.degree, self._band_of)
        band = self._band_of(known.size)
        low, high = known.value.low, known.value.high
        sign = (low > band).astype(np.int8) - (high < -band)
        fresh = np.append(True, (sign[1:] != sign[:-1]) | np.diff(steps.member).astype(bool))
        away = np.flatnonzero((sign != 0) & fresh[: sign.size])
        monotone = (sign == 0) & known.value.is_monotone
        simple, left = np.flatnonzero(monotone), np.flatnonzero((sign == 0) & ~monotone)
        knots, band[left] = find_knots(
            lambda rows: function(left[rows]), len(left), steps.degree, self._band_of
        )
        values, sizes = function(simple)(np.array([[0.0], [1.0]]) + np.zeros(simple.size))
        band[simple] = self._band_of(np.maximum(*sizes))
        row = np.concatenate([left[knots.row], simple, simple, away])
        order = np.argsort(row, kind="stable")
        ends = np.repeat([0.0, 1.0, 0.0], [simple.size, simple.size, away.size])
        number = -2 - np.concatenate([simple, simple, away])
        parts = (
            np.concatenate([knots.part, ends]),
            np.concatenate([knots.value, values.ravel(), np.where(low > 0, low, high)[away]]),
            np.concatenate([knots.piece, number]),
        )
        return Knots(row[order], *(each[order] for each in parts)), band

    def finish(self, member: int) -> Crossings | None:
        """The crossing that the end of a trajectory decides, if there is one."""
        held, sign = self._held.pop(member, None), int(self._sign[member])
        if held is None:
            return None
        if not held.ends and not (held.clear and (held.turned or held.root is not None)):
            return None
        point, direction = held.touch, -sign if held.ends else 0
        if held.root is not None:
            point, direction = held.root, -sign
        return _make_crossing(member, point, direction, -1)

    def save(self) -> dict[str, Any]:
        """What is known of the members, as arrays."""
        held = {f"held_{name}": array for name, array in save_held(self._held).items()}
        return {"sign": self._sign, "value": self._value, "undefined": self.undefined, **held}

    def restore(self, arrays: Mapping[str, Any]) -> None:
        """Know what was saved."""
        self._sign[:], self._value[:] = arrays["sign"], arrays["value"]
        self.undefined[:] = arrays["undefined"]
        self._held = restore_held(
            {name[5:]: array for name, array in arrays.items() if name.startswith("held_")}
        )


class _Scan:
    """The search in the steps of one call."""

    def __init__(
        self, watch: Watch, function: Function, steps: Steps, knots: Knots, band: Array
    ) -> None:
        self.watch, self.function, self.steps = watch, function, steps
        self.row, self.part, self.value = knots.row, knots.part, knots.value
        self.piece, self.band = knots.piece, band
        member = steps.member[knots.row]
        sign = np.where(np.abs(self.value) <= band[knots.row], 0, np.sign(self.value))
        gap = np.isnan(self.value)
        self._note_gaps(member, gap)
        # before the first knot of a member, one for what is known of it
        front = np.flatnonzero(np.append(True, member[1:] != member[:-1]))[: member.size]
        self.member = np.insert(member, front, member[front])
        self.is_known = np.insert(np.zeros(len(member), bool), front, values=True)
        known = self.member[self.is_known]
        self.row = np.insert(self.row, front, self.row[front])
        self.part = np.insert(self.part, front, 0.0)
        self.piece = np.insert(self.piece, front, -1)
        self.value = np.insert(self.value, front, watch._value[known])
        self.sign = np.insert(np.where(gap, 0, sign).astype(np.int8), front, watch._sign[known])
        anchored = (self.sign != 0) | self.is_known | np.insert(gap, front, values=False)
        #: The last knot of each run: outside the band, or where nothing is known.
        self.anchor = np.maximum.accumulate(np.where(anchored, np.arange(len(self.sign)), -1))
        self.side = self.sign[self.anchor]

    def _note_gaps(self, member: Places, gap: Mask) -> None:
        """Keep when a function was not finite."""
        time = self.steps.start[self.row] + self.part * self.steps.size[self.row]
        np.minimum.at(self.watch.undefined, member[gap], time[gap])

    def find(self) -> Crossings:
        """The crossings that are decided; what is known after the last knots is kept."""
        changes = self._find_changes()
        nearest = self._find_nearest()
        inner = np.flatnonzero((self.sign != 0) & ~self.is_known)
        begun = self.anchor[inner - 1]
        before, after = self.sign[begun], self.sign[inner]
        crossed = before == -after
        held = self.is_known[begun] & self._has_held(begun)
        touched = (before == after) & ((nearest[begun] >= 0) | held)
        lots = [
            self._take_crossings(begun[crossed], inner[crossed], changes),
            self._take_touches(begun[touched], inner[touched], nearest),
        ]
        self._keep(changes, nearest)
        return join(lots, len(lots[0].state))

    def _has_held(self, places: Places) -> Mask:
        """Whether something is held of the members of knots."""
        return np.isin(self.member[places], list(self.watch._held))

    def _find_changes(self) -> Places:
        """The knot after which the sign changes first, by the first knot of the run; -1 for none.

        A run goes from one knot outside the band to the next.
        """
        side, value = self.side[:-1], self.value
        inside = ~self.is_known[1:]
        change = inside & (side * value[:-1] > 0) & (side * value[1:] <= 0)
        return self._first_of_runs(np.flatnonzero(change))

    def _find_nearest(self) -> Places:
        """The knot within the band at which a run is closest to zero, or farthest beyond."""
        within = np.flatnonzero((self.sign == 0) & (self.side != 0) & ~self.is_known)
        key = self.side[within] * self.value[within]
        return self._first_of_runs(within[np.lexsort((key, self.anchor[within]))])

    def _first_of_runs(self, knots: Places) -> Places:
        """The first of some knots in each run, by the first knot of the run."""
        runs, first = np.unique(self.anchor[knots], return_index=True)
        found = np.full(len(self.sign), -1)
        found[runs] = knots[first]
        return found

    # -- places -----------------------------------------------------------------------------------

    def _take_crossings(self, begun: Places, ended: Places, changes: Places) -> Crossings:
        """Crossings of runs between two knots, in the direction of the sign after them."""
        sign = self.sign[ended]
        rooted = [m for m, held in list(self.watch._held.items()) if held.root is not None]
        known = self.is_known[begun] & np.isin(self.member[begun], rooted)
        lots = [self._recall(begun[known], ended[known], sign[known])]
        here = ~known & (changes[begun] >= 0)
        row, part, real = self._polish(changes[begun[here]])
        lots.append(self._locate(row[real], part[real], ended[here][real], sign[here][real]))
        return join(lots, len(lots[0].state))

    def _take_touches(self, begun: Places, ended: Places, nearest: Places) -> Crossings:
        """Touches of runs between two knots."""
        knots, known = nearest[begun], self._has_held(begun) & self.is_known[begun]
        least = np.where(knots < 0, np.inf, self.side[knots] * self.value[knots])
        for place in np.flatnonzero(known):
            held = self.watch._held[int(self.member[begun[place]])]
            known[place] = held.least <= least[place]
        here, none = knots[~known], np.zeros(len(begun), np.int8)
        lots = [
            self._recall(begun[known], ended[known], none[known]),
            self._locate(self.row[here], self.part[here], ended[~known], none[~known]),
        ]
        return join(lots, len(lots[0].state))

    def _recall(self, begun: Places, ended: Places, sign: NDArray[np.int8]) -> Crossings:
        """The crossings that are held of earlier calls."""
        size = len(self._states(self.row[:0], self.part[:0]))
        lots = []
        places = zip(begun.tolist(), self.row[ended].tolist(), sign.tolist(), strict=True)
        for place, decided, direction in places:
            member = int(self.member[place])
            held = self.watch._held[member]
            point = held.root if direction else held.touch
            assert point is not None, member
            lots.append(_make_crossing(member, point, direction, decided))
        return join(lots, size)

    def _polish(self, knots: Places) -> tuple[Places, Array, Mask]:
        """The roots after some knots: their steps, the parts passed, and whether they are real.

        A function that changes its sign at a pole has no root there.
        """
        after = knots + 1
        row, left, right = self.row[after], self.part[knots], self.part[after]
        part, real = right.copy(), np.ones(len(knots), bool)
        place = np.flatnonzero(self.piece[knots] == self.piece[after])
        if place.size:
            rows, ends = row[place], (self.value[knots[place]], self.value[after[place]])
            start, size = self.steps.start[rows], self.steps.size[rows]
            close = 2.0 * EPS * np.maximum(np.abs(start), np.abs(start + size)) / np.abs(size)

            def value(active: Places) -> Callable[[Array], Array]:
                evaluate = self.function(rows[active])
                return lambda x: evaluate(x)[0]

            part[place], there = find_roots(value, left[place], right[place], *ends, close)
            there = np.abs(there)
            real[place] = (there < np.minimum(*np.abs(ends))) | (there <= self.band[rows])
        return row, part, real

    def _locate(self, row: Places, part: Array, ended: Places, sign: NDArray[np.int8]) -> Crossings:
        """Crossings at parts of steps, of runs that ended at some knots."""
        return Crossings(
            member=self.steps.member[row],
            time=self._times(row, part),
            direction=sign,
            state=self._states(row, part),
            decided=self.row[ended],
        )

    def _times(self, row: Places, part: Array) -> Array:
        return np.asarray(self.steps.start[row] + part * self.steps.size[row])

    def _states(self, row: Places, part: Array) -> Array:
        """States at parts of steps, ``(n, R)``."""
        return self.steps.follow(row)(part * self.steps.size[row])

    # -- between two calls ------------------------------------------------------------------------

    def _keep(self, changes: Places, nearest: Places) -> None:
        """Keep what is known of each member after its last knot."""
        watch = self.watch
        last = np.flatnonzero(np.append(self.is_known[1:], True))[: self.sign.size]
        place = self.member[last]
        watch._sign[place], watch._value[place] = self.side[last], self.value[last]
        within = (self.sign[last] == 0) & (self.side[last] != 0)
        within &= np.abs(self.value[last]) < np.inf
        for member in self.member[last][~within].tolist():
            watch._held.pop(member, None)
        self._hold(last[within], changes, nearest)

    def _hold(self, last: Places, changes: Places, nearest: Places) -> None:
        """Hold the places of runs that have not ended, by their last knots."""
        if not last.size:
            return
        begun = self.anchor[last]
        row, size = self.row[last], self.steps.size[self.row[last]]
        parts = np.stack([np.full(len(row), 1.0 - _BACK), np.ones(len(row))])
        values, sizes = self.function(row)(parts)
        slope = np.abs(values[1] - values[0]) / (_BACK * np.abs(size))
        time = np.maximum(np.abs(self._times(row, parts[1])), np.abs(size))
        value = np.abs(values[1])
        ends = value <= self.watch._slack * time * slope
        clear = value > 64 * EPS * sizes[1]
        roots: dict[int, Point | None] = {}
        some = np.flatnonzero(changes[begun] >= 0)
        root_row, part, real = self._polish(changes[begun[some]])
        times, states = self._times(root_row, part), self._states(root_row, part)
        for n, place in enumerate(some.tolist()):
            roots[place] = Point(float(times[n]), states[:, n].copy()) if real[n] else None
        knots = nearest[begun]
        times, states = (
            self._times(self.row[knots], self.part[knots]),
            self._states(self.row[knots], self.part[knots]),
        )
        for n, knot in enumerate(knots.tolist()):
            least = float(self.side[knot] * self.value[knot])
            touch = Point(float(times[n]), states[:, n].copy())
            before = self.watch._held.get(int(self.member[knot]))
            before = before if self.is_known[begun[n]] else None
            root, turned = roots.get(n), knot != last[n]
            if before is not None:
                root = before.root or root
                if before.least <= least:
                    touch, least, turned = before.touch, before.least, True
            self.watch._held[int(self.member[knot])] = Held(
                root=root,
                touch=touch,
                least=least,
                turned=bool(turned),
                ends=bool(ends[n]),
                clear=bool(clear[n]),
            )
