"""Steps by the methods of Runge and Kutta: the classical one, and that of Dormand and Prince.

Comes in: where members are, and how far they may go. Goes out: where a step of each leads.
Read next: `coadjoint.solve.steps`, with what all methods share.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import TYPE_CHECKING, Protocol

import numpy as np

from coadjoint.lower.tableau import END, EXTRA, FIFTH, PATH, STAGES, THIRD, dop853
from coadjoint.solve.steps import (
    ROUNDING,
    Attempt,
    Cubic,
    Lanes,
    Left,
    find_fixed_step,
    find_step,
    larger,
    rough_log2,
    rough_power,
    smaller,
)

if TYPE_CHECKING:
    from coadjoint.array_types import Array, Mask


def end_where_rates_end(
    rates: Callable[[Lanes, Array, Array], Array], lanes: Lanes, h: Array, state: Array
) -> Array:
    """A state at which the rates are not finite is none: the motion ends before it."""
    finite = np.isfinite(rates(lanes, h, state)).all(axis=0)
    return np.where(finite, state, np.nan)


class FixedStep(Protocol):
    """A method with steps of one length, by rates that may have branch points."""

    rates: Callable[[Lanes, Array, Array], Array]
    branches: bool


def follow_cubic(
    method: FixedStep,
    lanes: Lanes,
    h: Array,
    end: Array,
    *,
    first: Callable[[], Array] | None = None,
    accepted: Mask | None = None,
    left: Left | None = None,
) -> Attempt:
    """A step that was made; between its ends the path is the cubic with the states and rates.

    Args:
        method: What made it.
        lanes: Where they are.
        h: The length of the step.
        end: Where it leads.
        first: The rates at the start, where they are known.
        accepted: Which lanes it takes on; None for all.
        left: What it leaves besides its end.
    """
    rates, none = method.rates, np.zeros(h.shape)
    path = Cubic(
        h=h,
        start=lanes.state,
        end=end,
        first=first or (lambda: rates(lanes, none, lanes.state)),
        last=lambda: rates(lanes, h, end),
    )
    return Attempt(
        took=h if accepted is None else np.where(accepted, h, 0.0),
        state=end_where_rates_end(rates, lanes, h, end) if method.branches else end,
        accepted=np.ones(h.shape, bool) if accepted is None else accepted,
        path=path.follow,
        coefficients=path.coefficients,
        left=left,
    )


class RungeKutta4:
    """The classical method of order 4 with a fixed step.

    Args:
        rates: Rates of lanes, at states some time later.
        size: The step.
        branches: Whether the rates have branch points: they have to be finite after each step.
    """

    tries_again = halves = False

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
        h = find_fixed_step(lanes, self.size)
        half = h * 0.5
        first = self.rates(lanes, none, x)
        k = self.rates(lanes, half, x + half * first)
        total = first + 2.0 * k
        k = self.rates(lanes, half, x + half * k)
        total = total + 2.0 * k
        k = self.rates(lanes, h, x + h * k)
        end = x + h * 0.16666666666666666 * (total + k)
        return follow_cubic(self, lanes, h, end, first=lambda: first)


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
        self.rates, self.table = rates, dop853()
        self.tries_again = self.halves = not size > 0
        self.rtol, self.atol, self.size = rtol, atol, size

    def try_step(self, lanes: Lanes) -> Attempt:
        """As `Method.try_step`."""
        most = lanes.end - lanes.time
        if not self.size > 0:
            fresh = lanes.step == 0.0
            if fresh.any():
                lanes.step = np.where(fresh, self._first(lanes, most), lanes.step)
        h = find_step(lanes, self.size, lanes.step, most)
        k, x = self._find_stages(lanes, h)
        if self.branches:
            x = end_where_rates_end(self.rates, lanes, h, x)
        accepted = np.ones(h.shape, bool)
        if not self.size > 0:
            accepted = self._control(lanes, h, most, k, x)
        start, parts = lanes.state, cache(partial(self._parts, lanes, h, k, x))
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
        h0 = smaller(np.where(tiny, 1e-6, 0.01 * d0 / d1), most)
        later = self.rates(lanes, h0, x + h0 * rates) - rates
        d2 = np.sqrt(self._square_norm(later, scale)) / h0
        d = larger(d1, d2)
        h1 = np.where(d <= 1e-15, larger(np.full(d.shape, 1e-6), h0 * 1e-3), _root(0.01 / d))
        return smaller(smaller(100.0 * h0, h1), most)

    def _control(self, lanes: Lanes, h: Array, most: Array, k: list[Array], end: Array) -> Mask:
        """Whether the error is small enough, and the next step."""
        five, three = self._find_errors(lanes, k, end)
        part, rest = h * five, (five + 0.01 * three) * float(len(end))
        accepted: Mask = (part * part < rest) | (rest == 0.0)
        octaves = (0.5 * rough_log2(rest) - rough_log2(part)) * 0.125 - 0.15200309344504997
        limit = np.full(h.shape, 3.321928094887362), np.full(h.shape, -2.321928094887362)
        octaves = smaller(larger(octaves, limit[1]), limit[0])
        wanted = np.where(part - part == 0.0, h * rough_power(octaves), h * 0.1)
        # one that is rejected and rounds to the same would be tried for ever
        wanted = np.where(~accepted & (find_step(lanes, 0.0, wanted, most) >= h), h * 0.25, wanted)
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
