"""Steps: the methods of integration over many members at a time, in NumPy.

Comes in: where members are, and how far they may go. Goes out: where a step of each leads, and
whether its error is small enough. These are the functions of the generated ``solver.c``, operation
by operation: where a system calls nothing beyond sqrt, the exact build has the same bits.
Read next: `coadjoint.solve.ensemble`, which calls them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Protocol

import numpy as np

from coadjoint.lower.tableau import END, EXTRA, FIFTH, PATH, STAGES, THIRD, dop853

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Mask = NDArray[np.bool_]

#: Rates at a state, some time after that of the lanes.
Rates = Callable[["Array", "Array"], "Array"]


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
    """

    took: Array
    state: Array
    accepted: Mask
    path: Callable[[Array], Array]
    coefficients: Callable[[], Array]


class Method(Protocol):
    """A method of integration.

    Attributes:
        tries_again: Whether a step that is not finite is tried again, a tenth as long.
    """

    tries_again: bool

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
            h = find_fixed_step(self.size, most) if self.size > 0 else _free(lanes, asked, most)
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
        wanted = np.where(bound > 0.0, _smaller(bound, asked), asked)
        h = _free(lanes, wanted, most) if adaptive else find_fixed_step(self.size, most)
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
        octaves = _smaller(one, two) - 0.7 / (order - 1) * 1.4426950408889634
        if self.branches:
            most = size - rough_log2(self.rtol * _norm(path[:, 1])) + 2.0
            octaves = _smaller(octaves, most)
        limit = np.full(octaves.shape, 1000.0)
        return rough_power(_smaller(larger(octaves, -limit), limit))


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


def _free(lanes: Lanes, step: Array, most: Array) -> Array:
    """A step that follows the tolerances, rounded so that the time after it is exact."""
    return _smaller((lanes.time + step) - lanes.time, most)


def find_fixed_step(size: float, most: Array) -> Array:
    """A fixed step, a little longer where it would leave next to nothing."""
    return np.where(most < size * 1.000001, most, size)


def larger(a: Array, b: Array) -> Array:
    """The larger of two, the second where they do not compare."""
    return np.where(a > b, a, b)


def _smaller(a: Array, b: Array) -> Array:
    return np.where(a < b, a, b)


# -- Runge and Kutta ----------------------------------------------------------------------------

#: The part of the largest component below which no error can be seen.
ROUNDING = 2.0**-48


def _check_end(
    rates: Callable[[Lanes, Array, Array], Array], lanes: Lanes, h: Array, state: Array
) -> Array:
    """A state at which the rates are not finite is none: the motion ends before it."""
    finite = np.isfinite(rates(lanes, h, state)).all(axis=0)
    return np.where(finite, state, np.nan)


class RungeKutta4:
    """The classical method of order 4 with a fixed step.

    Args:
        rates: Rates of lanes, at states some time later.
        size: The step.
        branches: Whether the rates have branch points: they have to be finite after each step.
    """

    tries_again = False

    def __init__(
        self,
        rates: Callable[[Lanes, Array, Array], Array],
        size: float,
        *,
        branches: bool = False,
    ) -> None:
        self.rates, self.size, self.branches = rates, size, branches

    def try_step(self, lanes: Lanes) -> Attempt:
        """As `Method.try_step`."""
        x, none = lanes.state, np.zeros(lanes.time.shape)
        h = find_fixed_step(self.size, lanes.end - lanes.time)
        half = h * 0.5
        first = self.rates(lanes, none, x)
        k = self.rates(lanes, half, x + half * first)
        total = first + 2.0 * k
        k = self.rates(lanes, half, x + half * k)
        total = total + 2.0 * k
        k = self.rates(lanes, h, x + h * k)
        end = x + h * 0.16666666666666666 * (total + k)

        def parts() -> tuple[Array, Array, Array]:
            chord = end - x
            start = h * first - chord
            return chord, start, h * (self.rates(lanes, h, end) - first) + 2.0 * start

        def path(after: Array) -> Array:
            part, (chord, start, both) = after / h, parts()
            return np.asarray(x + part * (chord + (1.0 - part) * (start - part * both)))

        def coefficients() -> Array:
            _, start, both = parts()
            return np.stack([x, first, -(both + start) / h / h, both / h / h / h], axis=1)

        return Attempt(
            took=h,
            state=_check_end(self.rates, lanes, h, end) if self.branches else end,
            accepted=np.ones(h.shape, bool),
            path=path,
            coefficients=coefficients,
        )


class DormandPrince8:
    """The method of Dormand and Prince of order 8, with steps that follow the tolerances.

    Args:
        rates: Rates of lanes, at states some time later.
        rtol: Relative tolerance.
        atol: Absolute tolerance.
        size: A fixed step, or 0.
        branches: Whether the rates have branch points: they have to be finite after each step.
    """

    def __init__(
        self,
        rates: Callable[[Lanes, Array, Array], Array],
        rtol: float,
        atol: float,
        size: float = 0.0,
        *,
        branches: bool = False,
    ) -> None:
        self.branches = branches
        self.rates, self.table, self.tries_again = rates, dop853(), not size > 0
        self.rtol, self.atol, self.size = rtol, atol, size

    def try_step(self, lanes: Lanes) -> Attempt:
        """As `Method.try_step`."""
        most = lanes.end - lanes.time
        if not self.size > 0:
            fresh = lanes.step == 0.0
            if fresh.any():
                lanes.step = np.where(fresh, self._first(lanes, most), lanes.step)
        h = find_fixed_step(self.size, most) if self.size > 0 else _free(lanes, lanes.step, most)
        k, x = self._find_stages(lanes, h)
        if self.branches:
            x = _check_end(self.rates, lanes, h, x)
        accepted = np.ones(h.shape, bool)
        if not self.size > 0:
            accepted = self._control(lanes, h, most, k, x)
        start, parts = lanes.state, partial(self._parts, lanes, h, k, x)
        return Attempt(
            took=h,
            state=x,
            accepted=accepted,
            path=lambda after: _evaluate(start, parts(), after / h),
            coefficients=lambda: _multiply_out(start, parts(), h),
        )

    def _find_stages(self, lanes: Lanes, h: Array) -> tuple[list[Array], Array]:
        """The rates of all stages, and the end of the step."""
        k: list[Array] = []
        x = lanes.state
        for stage in range(STAGES):
            k.append(self.rates(lanes, self.table.nodes[stage] * h, x))
            x = lanes.state + h * self._add(k, stage + 1)
        return k, x

    def _find_errors(self, lanes: Lanes, k: list[Array], end: Array) -> tuple[Array, Array]:
        """The squares of the errors that orders 5 and 3 tell of, in units of what is allowed."""
        sizes = larger(np.abs(lanes.state), np.abs(end))
        top = np.fmax.reduce(sizes, axis=0, initial=0.0)
        # below the roundings of the largest component no error can be seen
        least = larger(np.full(top.shape, self.atol), ROUNDING * top)
        unit = 1.0 / (least + self.rtol * sizes)
        five, three = (_square(self._add(k, row) * unit) for row in (FIFTH, THIRD))
        return five, three

    def _add(self, k: list[Array], row: int) -> Array:
        """The sum of a row of the table over rates."""
        (weight, column), *rest = self.table.row(row)
        total = weight * k[column]
        for weight, column in rest:
            total = total + weight * k[column]
        return total

    def _square_norm(self, rows: Array, scale: Array) -> Array:
        return _square(rows / scale) / float(len(rows))

    def _first(self, lanes: Lanes, most: Array) -> Array:
        """A first step: Hairer, Norsett and Wanner, II.4."""
        x, none = lanes.state, np.zeros(most.shape)
        rates = self.rates(lanes, none, x)
        scale = self.atol + self.rtol * np.abs(x)
        d0 = np.sqrt(self._square_norm(x, scale))
        d1 = np.sqrt(self._square_norm(rates, scale))
        tiny = (d0 < 1e-5) | (d1 < 1e-5)
        h0 = _smaller(np.where(tiny, 1e-6, 0.01 * d0 / d1), most)
        later = self.rates(lanes, h0, x + h0 * rates) - rates
        d2 = np.sqrt(self._square_norm(later, scale)) / h0
        d = larger(d1, d2)
        h1 = np.where(d <= 1e-15, larger(np.full(d.shape, 1e-6), h0 * 1e-3), _root(0.01 / d))
        return _smaller(_smaller(100.0 * h0, h1), most)

    def _control(self, lanes: Lanes, h: Array, most: Array, k: list[Array], end: Array) -> Mask:
        """Whether the error is small enough, and the next step."""
        five, three = self._find_errors(lanes, k, end)
        part, rest = h * five, (five + 0.01 * three) * float(len(end))
        accepted: Mask = (part * part < rest) | (rest == 0.0)
        octaves = (0.5 * rough_log2(rest) - rough_log2(part)) * 0.125 - 0.15200309344504997
        limit = np.full(h.shape, 3.321928094887362), np.full(h.shape, -2.321928094887362)
        octaves = _smaller(larger(octaves, limit[1]), limit[0])
        wanted = np.where(part - part == 0.0, h * rough_power(octaves), h * 0.1)
        # one that is rejected and rounds to the same would be tried for ever
        wanted = np.where(~accepted & (_free(lanes, wanted, most) >= h), h * 0.25, wanted)
        short = accepted & (h < lanes.step)
        lanes.step = np.where(short, larger(lanes.step, wanted), wanted)
        return accepted

    def _parts(self, lanes: Lanes, h: Array, k: list[Array], end: Array) -> list[Array]:
        """The coefficients of the path of a step, as the method has them."""
        k, start = list(k), lanes.state
        k.append(self.rates(lanes, h, end))
        for extra in range(3):
            x = start + h * self._add(k, EXTRA + extra)
            k.append(self.rates(lanes, self.table.nodes[END + 1 + extra] * h, x))
        chord = end - start
        parts = [chord, h * k[0] - chord, 2.0 * chord - h * (k[END] + k[0])]
        return parts + [h * self._add(k, PATH + row) for row in range(4)]


def _evaluate(start: Array, parts: list[Array], part: Array) -> Array:
    """The state after a part of a step."""
    total, rest = np.zeros(start.shape), 1.0 - part
    for row in range(6, -1, -1):
        total = (total + parts[row]) * (rest if row % 2 else part)
    return start + total


def _multiply_out(start: Array, parts: list[Array], h: Array) -> Array:
    """The same as polynomials in the time since the step began."""
    path = [np.zeros(start.shape) for _ in range(8)]
    for row in range(6, -1, -1):
        path[0] = path[0] + parts[row]
        for order in range(7 - row, 0, -1):
            path[order] = path[order] - path[order - 1] if row % 2 else path[order - 1]
        path[0] = path[0] if row % 2 else np.zeros(start.shape)
    path[0] = start
    for order in range(1, 8):
        for _ in range(order):
            path[order] = path[order] / h
    return np.stack(path, axis=1)


def _square(rows: Array) -> Array:
    """The sum of the squares of rows, from the first to the last."""
    return np.asarray(np.add.accumulate(rows * rows, axis=0)[-1])


def _root(a: Array) -> Array:
    """The eighth root."""
    return np.asarray(np.sqrt(np.sqrt(np.sqrt(a))))
