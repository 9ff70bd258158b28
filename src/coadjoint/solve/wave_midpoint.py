r"""The implicit midpoint for fields by Fourier derivatives, as SciPy's loop takes steps.

A step of length h is :math:`x_1 = x_0 + h f(m)` with :math:`m = x_0 + \tfrac{h}{2} f(m)`, so that
:math:`x_1 = 2 m - x_0`. It keeps quadratic integrals of the motion: the energy where it is
quadratic, since derivatives sum by parts. The middle is found by sweeps of this equation, until
they no longer come closer, as generated solvers do; a linear part of f, however stiff, may direct
them. What directs them decides how many there are, never what is found: a middle is taken only
where the equation itself holds to rounding. Between two steps the path is a cubic.
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

#: The most sweeps of a step, and how many of them may come no closer.
SWEEPS: Final = 200
VAIN: Final = 3
#: The part of the state below which they may end, and what misses the equation of a step may be.
CLOSE: Final = 1e-12
#: How many times what rounding of the middle makes of its rates may miss this equation.
ROUNDINGS: Final = 16
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
        direct: Of a state and half of a step, what takes what misses the equation of the step to
            corrections of its middle; None for plain sweeps.
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
        direct: Callable[[Array, float], Callable[[Array], Array]] | None = None,
        **given: Any,
    ) -> None:
        super().__init__(rates, start, state, end, vectorized=False)
        self._length, self._start, self._count = step, start, 0
        self._direct = direct

    def _step_impl(self) -> tuple[bool, str | None]:
        """One step: whether it was solved, and what to say if not."""
        self._count += 1
        end = self._start + self._count * self._length
        if end > self.t_bound - LONGER * self._length:
            end = self.t_bound
        h, old = end - self.t, self.y
        middle = self._find_middle(old, h / 2)
        if middle is None:
            return False, FAILED
        self._before, self.t, self.y = (self.t, old), end, 2 * middle - old
        return True, None

    def _find_middle(self, old: Array, half: float) -> Array | None:
        """The middle; None where sweeps come no closer, NaN where rates have no value."""
        correct = None if self._direct is None else self._direct(old, half)
        middle, nearest, vain = old, np.inf, 0
        for _ in range(SWEEPS):
            missing = self._miss(old, middle, half)
            change = missing if correct is None else correct(missing)
            moved, again = float(np.abs(change).max()), middle + change
            if not np.isfinite(moved):
                return again
            if moved == 0 or moved >= nearest:  # rounding, or no convergence
                if min(moved, nearest) <= CLOSE * float(np.abs(again).max()):
                    return again if self._is_solved(missing, middle, half) else None
                vain += 1
                if vain == VAIN:
                    return None
            middle, nearest = again, min(moved, nearest)
        return None

    def _miss(self, old: Array, middle: Array, half: float) -> Array:
        """By how much a middle misses the equation of the step."""
        missing: Array = old - middle + half * self.fun(self.t + half, middle)
        return missing

    def _is_solved(self, missing: Array, middle: Array, half: float) -> bool:
        """Whether a middle misses its equation by rounding alone."""
        most = float(np.abs(missing).max())
        if most <= CLOSE * float(np.abs(middle).max()):
            return True
        source = np.random.default_rng(0)
        rounded = np.nextafter(middle, np.where(source.random(middle.size) < 0.5, -np.inf, np.inf))
        time = self.t + half
        noise = half * float(np.abs(self.fun(time, rounded) - self.fun(time, middle)).max())
        return most <= ROUNDINGS * noise

    def _dense_output_impl(self) -> Cubic:
        """The path of the last step."""
        start, old = self._before
        slopes = self.fun(start, old), self.fun(self.t, self.y)
        return Cubic(start, self.t, (old, self.y), slopes)


class Cubic(DenseOutput):
    """The cubic of Hermite through both ends of a step."""

    def __init__(
        self, start: float, end: float, states: tuple[Array, Array], slopes: tuple[Array, Array]
    ) -> None:
        super().__init__(start, end)
        self._states, self._slopes = np.stack(states), np.stack(slopes)

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
