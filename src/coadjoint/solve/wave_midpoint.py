r"""The implicit midpoint for fields by Fourier derivatives, as SciPy's loop takes steps.

A step of length h is :math:`x_1 = x_0 + h f(m)` with :math:`m = x_0 + \tfrac{h}{2} f(m)`. It keeps
quadratic integrals of the motion: the energy where it is quadratic, since derivatives sum by parts.
The middle is found by sweeps of this equation, until they no longer come closer, as generated
solvers do. Between two steps the path is a cubic.
Comes in: rates in Python. Goes out: an `OdeSolver` of SciPy with steps of one length.
Read next: `coadjoint.solve.simulate`.

Source:
    Hairer, Lubich and Wanner (2006), Geometric Numerical Integration, theorem IV.2.1.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np
from scipy.integrate import DenseOutput, OdeSolver

from coadjoint.solve.simulate import NOT_SOLVED

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

#: The most sweeps of a step, and the part of the state below which they may end.
SWEEPS: Final = 200
CLOSE: Final = 1e-12
#: The part of a step by which the last one may be longer.
LONGER: Final = 1e-6
#: What SciPy's loop is told where sweeps come no closer.
FAILED: Final = f"{NOT_SOLVED}: its sweeps come no closer. Shorten steps."


class WaveMidpoint(OdeSolver):
    """Steps of one length.

    Args:
        rates: Of the state.
        start: When it begins.
        state: Where.
        end: When it ends.
        step: The length of steps; the last one may be shorter.
        given: What else SciPy's loop gives, which steps of one length do not look at.
    """

    def __init__(
        self,
        rates: Callable[[float, Array], Array],
        start: float,
        state: Array,
        end: float,
        *,
        step: float,
        **given: Any,
    ) -> None:
        super().__init__(rates, start, state, end, vectorized=False)
        self._length, self._start, self._count = step, start, 0

    def _step_impl(self) -> tuple[bool, str | None]:
        """One step: whether it was solved, and what to say if not."""
        self._count += 1
        end = self._start + self._count * self._length
        if end > self.t_bound - LONGER * self._length:
            end = self.t_bound
        h, old = end - self.t, self.y
        slope = self._find_slope(old, h)
        if slope is None:
            return False, FAILED
        self._before, self.t, self.y = (self.t, old), end, old + h * slope
        return True, None

    def _find_slope(self, old: Array, h: float) -> Array | None:
        """The rates at the middle; None where sweeps come no closer, NaN where rates have none."""
        time, slope = self.t + h / 2, self.fun(self.t, old)
        middle, nearest = old + h / 2 * slope, np.inf
        for _ in range(SWEEPS):
            slope = self.fun(time, middle)
            again = old + h / 2 * slope
            moved, middle = float(np.abs(again - middle).max()), again
            if not np.isfinite(moved):
                return slope
            if moved >= nearest:  # rounding, or no convergence
                return slope if nearest <= CLOSE * float(np.abs(middle).max()) else None
            if moved == 0:
                return slope
            nearest = moved
        return None

    def _dense_output_impl(self) -> _Cubic:
        """The path of the last step."""
        start, old = self._before
        slopes = self.fun(start, old), self.fun(self.t, self.y)
        return _Cubic(start, self.t, (old, self.y), slopes)


class _Cubic(DenseOutput):
    """The cubic of Hermite through both ends of a step."""

    def __init__(
        self, start: float, end: float, states: tuple[Array, Array], slopes: tuple[Array, Array]
    ) -> None:
        super().__init__(start, end)
        self._states, self._slopes = states, slopes

    def _call_impl(self, t: Array) -> Array:
        """States at times."""
        h = self.t - self.t_old
        x = (np.asarray(t) - self.t_old) / h
        (a, b), (u, v) = self._states, self._slopes
        if x.ndim:
            a, b, u, v = (each[:, np.newaxis] for each in (a, b, u, v))
        found: Array = (1 - x) ** 2 * ((1 + 2 * x) * a + x * h * u) + x**2 * (
            (3 - 2 * x) * b - (1 - x) * h * v
        )
        return found
