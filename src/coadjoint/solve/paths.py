"""Paths between samples: cubic Hermite curves through them, their points and their length.

Comes in: a `Solution` with x and y. Goes out: points of a smooth curve, and its length. The rates
come from the kernels: at the samples they shape the curve, and along it they are the speed, which
Gauss's rule integrates. So a path that turns back between two samples is neither cut short nor
drawn as a straight spike. Where the samples are too far apart for cubics, points between them are
integrated first.
Read next: `coadjoint.solve.trace`, which draws it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.array_types import Array
    from coadjoint.solve.solution import Solution

#: Pieces of each interval between samples: points that are drawn, and panels of the integral.
PIECES = 4
#: The least number of pieces of a whole path: the speed has a kink at a cusp, where the error of
#: the integral falls only with the square of a piece.
LEAST = 4000
#: Gauss's rule on each panel: exact for polynomials up to degree 7.
NODES, WEIGHTS = (np.asarray(part) for part in np.polynomial.legendre.leggauss(4))
#: Points between two samples are added until an integration from one arrives so close to the next,
#: relative to the largest value of the row; cubics over its steps are then as close.
CLOSE = 1e-7
#: The most steps from one sample to the next, as a power of two.
MOST_HALVINGS = 7
#: A miss above which the samples do not show the path.
LOST = 1e-4
#: Half a step of the difference that is the rate of an observable, as part of an interval.
STEP = 1e-4


class Path:
    """The path of the point (x, y) of a solution.

    Between samples the state, with what is reconstructed, is the cubic that has the values and
    rates of both ends: its error falls with the fourth power of the interval.

    Attributes:
        is_close: Whether the path between the samples is known to the digits that are printed.
    """

    def __init__(self, solution: Solution) -> None:
        self._solution = solution
        self._size = solution.system.STATE.size
        followed = solution.reconstructed
        parts = [solution.state] if followed is None else [solution.state, followed]
        self._time, self._inputs = solution.time, solution.inputs
        self._samples = np.concatenate(parts)  # (r, *batch, T)
        self.is_close = self._add_points()
        self._rates = self._evaluate_rates(self._samples, self._time, self._inputs)

    def _add_points(self) -> bool:
        """Add points between the samples until cubics can follow; whether they can."""
        miss, kept, count = np.inf, self._samples[..., :-1, np.newaxis], 1
        for steps in (2**halvings for halvings in range(MOST_HALVINGS + 1)):
            dense, found = self._march(steps)
            if found < miss:
                miss, kept, count = found, dense, steps
            if miss <= CLOSE:
                break
        last = self._samples[..., -1:]
        self._samples = np.concatenate([kept.reshape(*kept.shape[:-2], -1), last], axis=-1)
        place: Array = np.arange((len(self._time) - 1) * count + 1) / np.float64(count)
        self._time, self._inputs = self._find_driving(place)
        return bool(miss <= LOST)

    def _march(self, steps: int) -> tuple[Array, float]:
        """Steps of Runge and Kutta's fourth order from each sample to the next.

        Returns:
            The states on the way, ``(r, *batch, T - 1, steps)``, and how far the ends are from the
            next samples.
        """
        left = np.arange(len(self._time) - 1)
        size = np.diff(self._time) / steps
        state, way = self._samples[..., :-1], []

        def find_rates(at: Array, passed: float) -> Array:
            place = np.asarray(left + passed / steps, dtype=np.float64)
            return self._evaluate_rates(at, *self._find_driving(place))

        with np.errstate(all="ignore"):  # what leaves the finite numbers has missed
            for step in range(steps):
                way.append(state)
                k1 = find_rates(state, step)
                k2 = find_rates(state + size / 2 * k1, step + 0.5)
                k3 = find_rates(state + size / 2 * k2, step + 0.5)
                k4 = find_rates(state + size * k3, step + 1)
                state = state + size / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        return np.stack(way, axis=-1), _compare(state, self._samples[..., 1:])

    def take(self, kept: NDArray[np.bool_] | slice = slice(None)) -> Solution:
        """The motion at its samples and the points that were added, or at some of them."""
        inputs = self._inputs
        if inputs is not None and inputs.ndim == self._samples.ndim:
            inputs = inputs[..., kept]
        return self._make_part(self._samples[..., kept], self._time[kept], inputs)

    def find_points(self) -> Array:
        """Points of the curve, ``(2, *batch, P)``, all samples among them."""
        pieces = self._count_pieces()
        place: Array = np.arange((len(self._time) - 1) * pieces + 1) / np.float64(pieces)
        points = self._find_xy(*self._interpolate(place))
        points[..., ::pieces] = self._find_xy(self._samples, self._time, self._inputs)
        return points

    def find_length(self) -> Array:
        """The length of the path, ``batch``: the integral of the speed over time."""
        pieces = self._count_pieces()
        panels = np.arange((len(self._time) - 1) * pieces) / pieces
        inside = (panels[:, np.newaxis] + (NODES + 1) / (2 * pieces)).ravel()  # (4 panels,)
        speed = np.hypot(*self._find_velocity(inside))  # (*batch, 4 panels)
        widths = np.repeat(np.diff(self._time), pieces) / (2 * pieces)
        weights = (widths[:, np.newaxis] * WEIGHTS).ravel()
        return np.asarray(np.nansum(speed * weights, axis=-1))  # NaN where a member has ended

    def _count_pieces(self) -> int:
        """The pieces of each interval."""
        return max(PIECES, -(-LEAST // max(1, len(self._time) - 1)))

    def _find_velocity(self, place: Array) -> Array:
        """Rates of (x, y), ``(2, *batch, P)``: those of the kernel, or of observables differences.

        Args:
            place: Where: the number of an interval and the part of it that has passed.
        """
        states, time, inputs = self._interpolate(place)
        names = self._row_names()
        if "x" in names and "y" in names:
            rates = self._evaluate_rates(states, time, inputs)
            return rates[[names.index("x"), names.index("y")]]
        ends = (self._find_xy(*self._interpolate(place + side)) for side in (-STEP, STEP))
        before, after = ends
        widths = np.diff(self._time)[place.astype(np.intp)]
        return np.asarray((after - before) / (2 * STEP * widths))

    def _find_xy(self, states: Array, time: Array, inputs: Array | None) -> Array:
        """The point at states of the path, ``(2, *batch, P)``."""
        names = self._row_names()
        if "x" in names and "y" in names:
            rows: Array = states[[names.index("x"), names.index("y")]]
            return rows
        part = self._make_part(states, time, inputs)
        return np.stack([part["x"], part["y"]])

    def _row_names(self) -> list[str]:
        """Names of the rows of the path."""
        system = self._solution.system
        return [*system.STATE.components, *system.RECONSTRUCTED.components][: len(self._samples)]

    def _interpolate(self, place: Array) -> tuple[Array, Array, Array | None]:
        """States, times and inputs at places of the path."""
        left, right, part = self._split(place)
        time, inputs = self._find_driving(place)
        width = self._time[right] - self._time[left]
        before, after = self._samples[..., left], self._samples[..., right]
        step = after - before
        rising = _or_zero(self._rates[..., left] * width - step)
        falling = _or_zero(step - self._rates[..., right] * width)
        states = before + part * (step + (1 - part) * ((1 - part) * rising + part * falling))
        return states, time, inputs

    def _find_driving(self, place: Array) -> tuple[Array, Array | None]:
        """Times and inputs at places of the path.

        Inputs that change are taken as straight lines between the samples, since a solution does
        not hold what they were there.
        """
        left, right, part = self._split(place)
        time = self._time[left] + part * (self._time[right] - self._time[left])
        inputs = self._inputs
        if inputs is not None and inputs.ndim == self._samples.ndim:
            inputs = inputs[..., left] + part * (inputs[..., right] - inputs[..., left])
        return time, inputs

    def _split(self, place: Array) -> tuple[NDArray[np.intp], NDArray[np.intp], Array]:
        """The samples on both sides of places, and the part of the interval that has passed."""
        last = len(self._time) - 1
        left = np.clip(place.astype(np.intp), 0, max(last - 1, 0))
        return left, np.minimum(left + 1, last), place - left

    def _evaluate_rates(self, states: Array, time: Array, inputs: Array | None) -> Array:
        """Rates of the state and of what is reconstructed, ``(r, *batch, P)``."""
        part = self._make_part(states, time, inputs)
        rates = [part.evaluate("rhs", np.ascontiguousarray(states[: self._size]))]
        if len(states) > self._size:
            rates.append(part.evaluate("reconstruction", np.ascontiguousarray(states)))
        return np.concatenate(rates)

    def _make_part(self, states: Array, time: Array, inputs: Array | None) -> Solution:
        """The solution of the same motion at other times."""
        from coadjoint.solve.solution import Solution

        whole = self._solution
        return Solution(
            system=whole.system,
            time=time,
            state=states[: self._size],
            parameters=whole.parameters,
            status=whole.status,
            message="",
            reconstructed=states[self._size :] if len(states) > self._size else None,
            inputs=inputs,
        )


def _or_zero(values: Array) -> Array:
    """Values, and 0 for those that are not finite: a run may end where the rates are infinite."""
    return np.where(np.isfinite(values), values, 0.0)


def _compare(found: Array, expected: Array) -> float:
    """The largest difference relative to the largest value of its row, of what is finite."""
    worst = 0.0
    for ours, theirs in zip(found, expected, strict=True):
        finite = np.isfinite(theirs)
        size = float(np.abs(theirs[finite]).max(initial=0.0)) or 1.0
        far = np.abs(ours[finite] - theirs[finite])
        worst = max(worst, float(np.where(np.isfinite(far), far, np.inf).max(initial=0.0)) / size)
    return worst
