r"""Gauss's methods for fields by Fourier derivatives, as SciPy's loop takes steps.

A step of length h with s stages, :math:`X_i = x_0 + Z_i`, is

.. math:: Z_i = h \sum_j a_{ij} f(X_j), \qquad x_1 = x_0 + \sum_i d_i Z_i, \qquad d = A^{-T} b.

With one stage that is the implicit midpoint, of order 2, and with s stages Gauss's method of order
2 s. They keep quadratic integrals of the motion: the energy where it is quadratic, since
derivatives sum by parts. Stages are found by sweeps of their equation, until they no longer come
closer, as generated solvers do; a linear part of f, however stiff, may direct them. What directs
them decides how many there are, never what is found: stages are taken only where the equation
itself holds to rounding. What rounding leaves out of a step is added to the next one (Kahan), and
between two steps the path is a cubic.
Comes in: rates in Python. Goes out: an `OdeSolver` of SciPy with steps of one length.
Read next: `coadjoint.solve.scipy_steps`.

Source:
    Hairer, Lubich and Wanner (2006), Geometric Numerical Integration, theorem IV.2.1, and sections
    VIII.5 for the sum of roundings and VIII.6 for steps by Z.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from scipy.integrate import DenseOutput, OdeSolver

from coadjoint.solve.methods.gauss import TABLEAUS
from coadjoint.solve.scipy_steps import NOT_SOLVED

if TYPE_CHECKING:
    from collections.abc import Callable

    from coadjoint.array_types import Array

    #: What takes by how much stages ``(s, n)`` miss their equation to corrections of these.
    Correct = Callable[[Array], Array]
    #: Of a state and h A.
    Direct = Callable[[Array, Array], Correct]

#: The most sweeps of a step, and how many of them may come no closer.
SWEEPS: Final = 200
VAIN: Final = 3
#: The part of the state below which they may end, and what misses the equation of a step may be.
CLOSE: Final = 1e-12
#: How many times what rounding of the stages makes of their rates may miss this equation.
ROUNDINGS: Final = 16
#: The part of a step by which the last one may be longer.
LONGER: Final = 1e-6
#: What SciPy's loop is told where sweeps come no closer.
FAILED: Final = f"{NOT_SOLVED}: its sweeps come no closer. Shorten steps."


@dataclass
class Made:
    """What a run is made of, through all its stretches.

    Attributes:
        steps: Steps that were taken.
        sweeps: Sweeps by which their equations were solved, those of a failed step too.
    """

    steps: int = 0
    sweeps: int = 0


class WaveGauss(OdeSolver):
    """Steps of one length.

    Args:
        rates: Of the state.
        start: When it begins.
        state: Where.
        end: When it ends.
        step: The length of steps; the last one may be shorter.
        order: 2, 4, 6 or 8: twice as many as there are stages.
        direct: Of a state and h A, what takes what misses the equation of the stages to their
            corrections; None for plain sweeps.
        made: Where steps and sweeps are counted; None for nowhere.
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
        order: int = 2,
        direct: Direct | None = None,
        made: Made | None = None,
        **given: Any,
    ) -> None:
        super().__init__(rates, start, state, end, vectorized=False)
        self._length, self._start, self._count = step, start, 0
        self._direct, self._made = direct, made or Made()
        self._matrix, weights = list_weights(order)
        self._nodes = self._matrix.sum(axis=1)
        self._factors = np.linalg.solve(self._matrix.T, weights)
        self._left_out: Array = np.zeros_like(self.y)

    def save(self) -> tuple[float, int, Array]:
        """When steps began, how many were made since then, and what the last one left out."""
        return self._start, self._count, self._left_out

    def resume(self, start: float, count: int, left_out: Array) -> None:
        """Go on as an integrator that `save` is of."""
        self._start, self._count, self._left_out = start, count, left_out

    def _step_impl(self) -> tuple[bool, str | None]:
        """One step: whether it was solved, and what to say if not."""
        self._count += 1
        end = self._start + self._count * self._length
        if end > self.t_bound - LONGER * self._length:
            end = self.t_bound
        h, old = end - self.t, self.y
        stages = self._find_stages(old, h)
        if stages is None:
            return False, FAILED
        whole = self._factors @ stages + self._left_out
        new = old + whole
        self._left_out = whole - (new - old)
        self._before, self.t, self.y = (self.t, old), end, new
        self._made.steps += 1
        return True, None

    def _find_stages(self, old: Array, h: float) -> Array | None:
        """All Z_i; None where sweeps come no closer, NaN where rates have no value."""
        scaled = h * self._matrix
        correct = None if self._direct is None else self._direct(old, scaled)
        stages, nearest, vain = np.zeros((len(scaled), old.size)), np.inf, 0
        for _ in range(SWEEPS):
            self._made.sweeps += 1
            missing = self._miss(old, stages, scaled, h)
            change = missing if correct is None else correct(missing)
            moved, again = float(np.abs(change).max()), stages + change
            if not np.isfinite(moved):
                return again
            if moved == 0 or moved >= nearest:  # rounding, or no convergence
                if min(moved, nearest) <= CLOSE * float(np.abs(old + again).max()):
                    return again if self._is_solved(old, missing, stages, h) else None
                vain += 1
                if vain == VAIN:
                    return None
            stages, nearest = again, min(moved, nearest)
        return None

    def _miss(self, old: Array, stages: Array, scaled: Array, h: float) -> Array:
        """By how much stages miss their equation."""
        missing: Array = scaled @ self._find_rates(old + stages, h) - stages
        return missing

    def _find_rates(self, states: Array, h: float) -> Array:
        """The rates at the nodes of a step."""
        return np.stack(
            [self.fun(self.t + c * h, x) for c, x in zip(self._nodes, states, strict=True)]
        )

    def _is_solved(self, old: Array, missing: Array, stages: Array, h: float) -> bool:
        """Whether stages miss their equation by rounding alone."""
        most, states = float(np.abs(missing).max()), old + stages
        if most <= CLOSE * float(np.abs(states).max()):
            return True
        source = np.random.default_rng(0)
        ways = np.where(source.random(states.shape) < 0.5, -np.inf, np.inf)
        rounded = self._find_rates(np.nextafter(states, ways), h) - self._find_rates(states, h)
        return most <= ROUNDINGS * float(np.abs(h * self._matrix @ rounded).max())

    def _dense_output_impl(self) -> Cubic:
        """The path of the last step."""
        start, old = self._before
        slopes = self.fun(start, old), self.fun(self.t, self.y)
        return Cubic(start, self.t, (old, self.y), slopes)


def list_weights(order: int) -> tuple[Array, Array]:
    """A and b of Gauss's method of an order, 2, 4, 6 or 8.

    >>> list_weights(2)
    (array([[0.5]]), array([1.]))
    """
    if order == 2:
        return np.array([[0.5]]), np.ones(1)
    table = TABLEAUS[order]
    outer, inner = np.array(table.lengths), order // 2 - 2 * len(table.lengths)
    b = np.concatenate([outer, np.full(inner, (1 - 2 * outer.sum()) / inner), outer[::-1]])
    return np.array(table.shares) * b, b


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
