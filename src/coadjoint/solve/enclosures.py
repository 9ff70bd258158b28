"""Enclosures: a straight line over each step, and how far a function may be from it.

Comes in: polynomials of the state over steps. Goes out: `Enclosure` records, with which formulas
and kernels compute as they do with numbers. A step on which the enclosure of a function keeps away
from zero has no root. One on which it is monotone has at most one. Neither has to be looked at more
closely, and most steps are of these kinds.

With the part s of a step that has passed, from 0 to 1, an enclosure says ``|f - (start + rise s)|
<= off`` and ``|f' - rise| <= bend``. The roundings of its own operations and those of a function
that is evaluated are within off and bend.
Read next: `coadjoint.solve.events`, which encloses formulas.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from coadjoint.array_types import Array, Mask

#: Roundings of an operation, relative to the largest value.
ROUNDED: Final = 8 * float(np.finfo(float).eps)


class Enclosure:
    """A function over steps; each attribute is ``(S,)``, or a number.

    Attributes:
        start: Of the line.
        rise: Of the line, over the step.
        off: How far the function is from the line at the most.
        bend: How far its derivative is from the rise at the most.
    """

    __slots__ = ("bend", "off", "rise", "start")

    def __init__(self, start: Any, rise: Any = 0.0, off: Any = 0.0, bend: Any = 0.0) -> None:
        self.start, self.rise, self.off, self.bend = start, rise, off, bend

    @classmethod
    def of_polynomial(cls, path: Array, size: Array) -> Enclosure:
        """That of polynomials in time.

        The sum of ``t_k (s^k - s)`` from k = 2 on is what is off the line between the ends, and
        ``0 <= s - s^k <= w_k`` with ``w_k = (k - 1) k^(-k/(k - 1))``.

        Args:
            path: Coefficients, ``(degree + 1, S)``.
            size: The lengths of the steps, ``(S,)``.
        """
        power = size.copy()
        rise = path[1] * power
        total = np.abs(path[0]) + np.abs(rise)
        middle, off, bend = np.zeros((3, len(size)))
        for k in range(2, len(path)):
            power *= size
            term = path[k] * power
            rise += term
            term *= 0.5 * (k - 1) * k ** (-k / (k - 1))
            middle += term
            np.abs(term, out=term)
            off += term
            term *= 2.0 * k ** (k / (k - 1))
            bend += term
        rounded = ROUNDED * (total + bend)
        return cls(path[0] - middle, rise, off + rounded, bend + rounded)

    @classmethod
    def of_line(cls, start: Array, rise: Array) -> Enclosure:
        """That of straight lines."""
        rounded = ROUNDED * (np.abs(start) + np.abs(rise))
        return cls(start, rise, rounded, rounded)

    # -- what it says -----------------------------------------------------------------------------

    @property
    def low(self) -> Array:
        """A bound from below."""
        return np.asarray(self.start + np.minimum(self.rise, 0.0) - self.off)

    @property
    def high(self) -> Array:
        """A bound from above."""
        return np.asarray(self.start + np.maximum(self.rise, 0.0) + self.off)

    @property
    def top(self) -> Array:
        """A bound of the size."""
        return np.asarray(np.maximum(-self.low, self.high))

    @property
    def is_monotone(self) -> Mask:
        """Where the derivative keeps its sign."""
        return np.asarray(np.abs(self.rise) > self.bend)

    # -- operations -------------------------------------------------------------------------------

    def _round(self) -> Enclosure:
        """With the roundings of the operation that made it."""
        rounded = ROUNDED * self.top
        return Enclosure(self.start, self.rise, self.off + rounded, self.bend + rounded)

    def __add__(self, other: Any) -> Enclosure:
        other = as_enclosure(other)
        return Enclosure(
            self.start + other.start,
            self.rise + other.rise,
            self.off + other.off,
            self.bend + other.bend,
        )._round()

    __radd__ = __add__

    def __neg__(self) -> Enclosure:
        return Enclosure(-self.start, -self.rise, self.off, self.bend)

    def __sub__(self, other: Any) -> Enclosure:
        return self.__add__(-other)

    def __rsub__(self, other: Any) -> Enclosure:
        return (-self).__add__(other)

    def __mul__(self, other: Any) -> Enclosure:
        """``s^2`` is between ``s - 1/4`` and ``s``."""
        if not isinstance(other, Enclosure):
            size = abs(other)
            return Enclosure(
                self.start * other, self.rise * other, self.off * size, self.bend * size
            )._round()
        a, b, c, d = self.start, self.rise, other.start, other.rise
        square, line, width = b * d, np.maximum(np.abs(a), np.abs(a + b)), np.abs(b)
        top = other.top
        return Enclosure(
            a * c - 0.125 * square,
            a * d + b * c + square,
            0.125 * np.abs(square) + self.off * top + other.off * line,
            np.abs(square)
            + width * other.off
            + np.abs(d) * self.off
            + self.bend * top
            + other.bend * (line + self.off),
        )._round()

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Enclosure:
        return self.__mul__(other.invert() if isinstance(other, Enclosure) else 1.0 / other)

    def __rtruediv__(self, other: Any) -> Enclosure:
        return self.invert().__mul__(other)

    def __abs__(self) -> Enclosure:
        """Between zero and the largest size: sizes are asked for no more than that."""
        half = 0.5 * self.top
        return Enclosure(half, 0.0, half, np.abs(self.rise) + self.bend)

    # -- functions, which NumPy calls by these names ----------------------------------------------

    def _apply(
        self,
        function: Callable[[Array], Array],
        slope: Callable[[Array], Array],
        curve: Callable[[Array, Array], Array | float],
    ) -> Enclosure:
        """A function by its line at the middle of the values.

        Args:
            function: The function.
            slope: Its derivative.
            curve: A bound of the second derivative between two values; infinite for none.
        """
        low, high = self.low, self.high
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        at, curved = slope(middle), curve(low, high) * half
        size = np.abs(at)
        return Enclosure(
            function(middle) + at * (self.start - middle),
            at * self.rise,
            size * self.off + 0.5 * curved * half,
            size * self.bend + curved * (np.abs(self.rise) + self.bend),
        )._round()

    def invert(self) -> Enclosure:
        """One by it."""

        def curve(low: Array, high: Array) -> Array:
            least = np.where(low > 0, low, -high)
            return np.where(least > 0, 2.0 / least**3, np.inf)

        return self._apply(lambda x: 1.0 / x, lambda x: -1.0 / x**2, curve)

    def sqrt(self) -> Enclosure:
        """The square root."""
        return self._apply(
            np.sqrt,
            lambda x: 0.5 / np.sqrt(x),
            lambda low, _: np.where(low > 0, 0.25 / (low * np.sqrt(low)), np.inf),
        )

    def exp(self) -> Enclosure:
        """The exponential."""
        return self._apply(np.exp, np.exp, lambda _, high: np.asarray(np.exp(high)))

    def log(self) -> Enclosure:
        """The logarithm."""
        return self._apply(
            np.log,
            lambda x: 1.0 / x,
            lambda low, _: np.where(low > 0, 1.0 / low**2, np.inf),
        )

    def sin(self) -> Enclosure:
        """The sine."""
        return self._apply(np.sin, np.cos, lambda *_: 1.0)

    def cos(self) -> Enclosure:
        """The cosine."""
        return self._apply(np.cos, lambda x: -np.sin(x), lambda *_: 1.0)

    def tan(self) -> Enclosure:
        """The tangent."""
        return self.sin() / self.cos()


def as_enclosure(value: Any) -> Enclosure:
    """A value as it is, constant over steps."""
    return value if isinstance(value, Enclosure) else Enclosure(value)
