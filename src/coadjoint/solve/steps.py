"""Steps: integration over many members at a time, in NumPy, and Taylor's method.

Comes in: where members are, and how far they may go. Goes out: where a step of each leads, and
whether its error is small enough. These are the functions of the generated ``solver.c``, operation
by operation: where a system calls nothing beyond sqrt, the exact build has the same bits.
Read next: `coadjoint.solve.runge_kutta`, and `coadjoint.solve.ensemble`, which calls them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.array_types import Array, Mask

#: The part of the largest component below which no error can be seen.
ROUNDING = 2.0**-48


@dataclass
class Lanes:
    """Members on their way.

    Attributes:
        state: ``(n, N)``.
        time: ``(N,)``.
        end: How far each may go, ``(N,)``.
        step: The step that is tried next, ``(N,)``; 0 to have it chosen.
        parameters: ``(k, N)``, or ``(k,)`` if all share them.
        driving: Inputs and time now, ``(m, N)``.
        slopes: Their rates, ``(m, N)``.
        member: Places of the members in the whole batch, ``(N,)``.
        steps: Steps that they have made, ``(N,)``.
        memory: What the steps before left, as `Ensemble` has it, ``(m, N)``; None where nobody
            keeps it.
        sides: The sides of kinks on which they are, -1, 0 or 1, ``(m, N)``; None without kinks.
        joined: Room for a state with these below it, as parts of steps in C take it.
    """

    state: Array
    time: Array
    end: Array
    step: Array
    parameters: Array
    driving: Array
    slopes: Array
    member: NDArray[np.uint64]
    steps: NDArray[np.uint64]
    memory: Array | None = None
    sides: Array | None = None
    joined: Array | None = None

    @property
    def given(self) -> Array:
        """Parameters with the sides below them, as solvers take them."""
        if self.sides is None:
            return self.parameters
        shape = (len(self.parameters), self.sides.shape[1])
        own = self.parameters if self.parameters.ndim > 1 else self.parameters[:, np.newaxis]
        return np.concatenate([np.broadcast_to(own, shape), self.sides])


@dataclass
class Attempt:
    """A step that was tried.

    Attributes:
        took: Its length, ``(N,)``.
        state: Where it leads, ``(n, N)``.
        accepted: Whether its error is small enough, ``(N,)``.
        path: The state after a part of it.
        coefficients: Those of the path as polynomials in the time since the step began, that of
            order 0 first, ``(n, degree + 1, N)``.
        left: Of implicit methods, and of those that keep structure, what the step leaves besides
            its end; else None.
    """

    took: Array
    state: Array
    accepted: Mask
    path: Callable[[Array], Array]
    coefficients: Callable[[], Array]
    left: Left | None = None


@dataclass
class Left:
    """What a step leaves besides its end.

    Attributes:
        memory: What rounding took of the state, and what is kept of searches, ``(m, N)``; None
            with noise.
        sweeps: How many sweeps its equation took, ``(N,)``.
        solved: Where that was solved, ``(N,)``.
    """

    memory: Array | None
    sweeps: NDArray[np.uint64]
    solved: Mask


@dataclass(frozen=True)
class Cubic:
    """The path between the ends of a step: the cubic with the states and rates of both.

    Attributes:
        h: The length of the step, ``(N,)``.
        start: Where it begins, ``(n, N)``.
        end: Where it ends.
        first: The rates at its start, when they are asked for.
        last: Those at its end.
    """

    h: Array
    start: Array
    end: Array
    first: Callable[[], Array]
    last: Callable[[], Array]

    @cached_property
    def _parts(self) -> tuple[Array, Array, Array, Array]:
        first, chord = self.first(), self.end - self.start
        rise = self.h * first - chord
        return first, chord, rise, self.h * (self.last() - first) + 2.0 * rise

    def follow(self, after: Array) -> Array:
        """The state some time after the start; after the whole step it is the end to the bit."""
        part, (_, chord, rise, both) = after / self.h, self._parts
        within = self.start + part * (chord + (1.0 - part) * (rise - part * both))
        return np.asarray(np.where(after == self.h, self.end, within))

    def coefficients(self) -> Array:
        """Those of the path in the time since the start, ``(n, 4, N)``."""
        h, (first, _, rise, both) = self.h, self._parts
        return np.stack([self.start, first, -(both + rise) / h / h, both / h / h / h], axis=1)


class Method(Protocol):
    """A method of integration.

    Attributes:
        tries_again: Whether a step that is not finite is tried again, a tenth as long.
        halves: Whether a step that meets a kink early is tried again, half as long or up to there.
    """

    tries_again: bool
    halves: bool

    def try_step(self, lanes: Lanes) -> Attempt:
        """Try a step of each lane; its `Lanes.step` becomes the next one to try."""
        ...


# -- Taylor -------------------------------------------------------------------------------------


def rough_log2(a: Array) -> Array:
    """The logarithm to base 2 within 0.01, by operations that round alike everywhere.

    >>> bool(abs(rough_log2(np.array([10.0])) - np.log2(10.0))[0] < 0.01)
    True
    """
    bits = a.view(np.int64)
    exponent = ((bits >> 52) | 0x4330000000000000).view(np.float64) - 4503599627371519.0
    m = ((bits & 0xFFFFFFFFFFFFF) | 0x3FF0000000000000).view(np.float64)
    return np.asarray(exponent + ((2.0 - m * 0.3333333333333333) * m - 1.6666666666666667))


def rough_power(octaves: Array) -> Array:
    """Two to a power between -1000 and 1000, within one part in 5000, alike everywhere.

    >>> bool(abs(rough_power(np.array([0.5])) - np.sqrt(2))[0] < 3e-4)
    True
    """
    shifted = octaves + 6755399441055744.0
    rest = octaves - (shifted - 6755399441055744.0)
    part = ((rest * 0.055008 + 0.242209) * rest + 0.693283) * rest + 1.0
    scale = ((shifted.view(np.int64) - 0x4338000000000000 + 1023) << 52).view(np.float64)
    return np.asarray(part * scale)


class Taylor:
    """The method of Taylor's series: A. Jorba and M. Zou, Experimental Mathematics 14 (2005) 99.

    Args:
        expand: The coefficients of the motion of lanes up to an order, ``(n, order + 1, N)``.
        rates: Rates of lanes, at states some time later.
        order: The order.
        rtol: Relative tolerance.
        atol: Absolute tolerance.
        size: A fixed step, or 0.
        branches: Whether the rates have branch points: each step is then compared with them.
    """

    halves = False

    def __init__(
        self,
        *,
        expand: Callable[[Lanes, int], Array],
        rates: Callable[[Lanes, Array, Array], Array],
        order: int,
        rtol: float,
        atol: float,
        size: float = 0.0,
        branches: bool = False,
    ) -> None:
        self.expand, self.rates, self.order = expand, rates, order
        self.rtol, self.atol, self.size, self.branches = rtol, atol, size, branches
        self.tries_again = branches and not size > 0

    def try_step(self, lanes: Lanes) -> Attempt:
        """As `Method.try_step`."""
        path, most = self.expand(lanes, self.order), lanes.end - lanes.time
        asked = self._choose(path) if not self.size > 0 else np.full(most.shape, self.size)
        if self.branches:
            h, state, accepted = self._follow(lanes, path, asked, most)
        else:
            h = find_step(lanes, self.size, asked, most)
            state, accepted = _evaluate_path(path, h), np.ones(h.shape, bool)
        return Attempt(
            took=h,
            state=state,
            accepted=accepted,
            path=partial(_evaluate_path, path),
            coefficients=lambda: path,
        )

    def _follow(
        self, lanes: Lanes, path: Array, asked: Array, most: Array
    ) -> tuple[Array, Array, Mask]:
        """How far a series is followed, where to, and whether it has the rates there.

        A step that has not is followed by a shorter one, and this by longer ones, as long as the
        tolerances ask for more. There is none where it has a fixed length.
        """
        bound, adaptive = lanes.step, not self.size > 0
        wanted = np.where(bound > 0.0, smaller(bound, asked), asked)
        h = find_step(lanes, self.size, wanted, most)
        state, slopes = _evaluate_end(path, h)
        accepted = self._is_followed(lanes, path, h, state, slopes)
        # where a shorter step cannot help, there is none
        known = np.isfinite(state).all(axis=0) & np.array(not adaptive)
        ends = ~accepted & (_has_no_series(path) | known)
        state, h = np.where(ends, lanes.state, state), np.where(ends, 0.0, h)
        if adaptive:
            longer = np.where(asked <= bound, 0.0, larger(bound, h * 2.0))
            lanes.step = np.where(accepted, np.where(bound > 0.0, longer, 0.0), h * 0.4)
        return h, state, accepted

    def _is_followed(
        self, lanes: Lanes, path: Array, h: Array, state: Array, slopes: Array
    ) -> Mask:
        """Whether a series still has the rates of the system after a step."""
        rates = self.rates(lanes, h, state)
        gaps = rates - slopes
        gap, size = _norm(gaps), larger(_norm(rates), _norm(slopes))
        tolerance, error = self._tolerance(path), h * gap
        finite = np.isfinite(gaps).all(axis=0)
        if self.size > 0:
            return finite & ((gap <= size) | (error <= tolerance))
        known = (gap <= 0.5 * size) | (error <= _norm(path[:, 0]) * 2.0**-44)
        return finite & known & (error <= 128.0 * tolerance)

    def _tolerance(self, path: Array) -> Array:
        """What an error may be."""
        return larger(self.rtol * _norm(path[:, 0]), np.full(path.shape[2], self.atol))

    def _choose(self, path: Array) -> Array:
        """The step in which the last two orders are a 64th of what the tolerances allow."""
        order, size = self.order, rough_log2(self._tolerance(path))
        one = (size - 6.0 - rough_log2(_norm(path[:, order - 1]))) * (1.0 / (order - 1))
        two = (size - 6.0 - rough_log2(_norm(path[:, order]))) * (1.0 / order)
        octaves = smaller(one, two) - 0.7 / (order - 1) * 1.4426950408889634
        if self.branches:
            most = size - rough_log2(self.rtol * _norm(path[:, 1])) + 2.0
            octaves = smaller(octaves, most)
        limit = np.full(octaves.shape, 1000.0)
        return rough_power(smaller(larger(octaves, -limit), limit))


def _evaluate_path(path: Array, after: Array) -> Array:
    """The state of a path some time after it began."""
    total = path[:, -1]
    for k in range(path.shape[1] - 2, -1, -1):
        total = total * after + path[:, k]
    return total


def _evaluate_end(path: Array, after: Array) -> tuple[Array, Array]:
    """The state of a path some time after it began, and its rates."""
    state = path[:, -1]
    rates = np.zeros(state.shape)
    for k in range(path.shape[1] - 2, -1, -1):
        rates = rates * after + state
        state = state * after + path[:, k]
    return state, rates


def _has_no_series(path: Array) -> Mask:
    """Whether rates are finite, and coefficients of the highest order are not."""
    rates, last = (np.isfinite(path[:, order]).all(axis=0) for order in (1, -1))
    return np.asarray(rates & ~last)


def _norm(rows: Array) -> Array:
    """The largest row; a row that is no number is left out, unless it is the first."""
    sizes = np.abs(rows)
    return np.asarray(np.where(np.isnan(sizes[0]), sizes[0], np.fmax.reduce(sizes, axis=0)))


def find_step(lanes: Lanes, size: float, asked: Array, most: Array) -> Array:
    """A fixed step, if it has a size, or one that is asked for, rounded so that time is exact."""
    if size > 0:
        return find_fixed_step(lanes, size)
    return smaller((lanes.time + asked) - lanes.time, most)


def find_fixed_step(lanes: Lanes, size: float) -> Array:
    """A fixed step; what is left where that is shorter, or longer by next to nothing.

    Where rounding of times alone tells the two apart, it is the fixed step: all steps are equal.
    """
    most, whole = lanes.end - lanes.time, np.full(lanes.time.shape, size)
    return np.where((most < size * 1.000001) & ~reaches_end(lanes, whole), most, whole)


def reaches_end(lanes: Lanes, took: Array) -> Mask:
    """Whether a step ends where its trajectory does, but for rounding of times."""
    times = larger(np.abs(lanes.end), np.abs(lanes.time))
    rounding = smaller(times * 2.0**-50, took * 2.0**-20)
    return np.asarray(np.abs(took - (lanes.end - lanes.time)) <= rounding)


def larger(a: Array, b: Array) -> Array:
    """The larger of two, the second where they do not compare."""
    return np.where(a > b, a, b)


def smaller(a: Array, b: Array) -> Array:
    """The smaller of two, the second where they do not compare."""
    return np.where(a < b, a, b)


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
