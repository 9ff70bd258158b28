"""Sloped: values with their slopes, by the product, quotient and chain rules.

Comes in: values in any arithmetic. Goes out: the same with derivatives by some variables.
Read next: `coadjoint.derive.reference`.
"""

from __future__ import annotations

from collections.abc import Mapping
from operator import add, mul, truediv
from typing import Generic, TypeVar

Value = TypeVar("Value")


class Sloped(Generic[Value]):
    """A value with its slopes by some variables, and the arithmetic of both.

    Args:
        value: The value, in any arithmetic that has ``+ * /`` and ``-u``.
        slopes: Derivatives by the place of the variable; one that is left out is zero.
        factors: What the value is the product of, itself by default: the slope of ``1/D^2`` is
            ``-2 D'/D / D^2``, where the rule for a quotient would say ``-2 D D' / (D^2 D^2)``.
    """

    __slots__ = ("factors", "slopes", "value")

    def __init__(
        self,
        value: Value,
        slopes: Mapping[int, Value],
        factors: tuple[Sloped[Value], ...] = (),
    ) -> None:
        self.value, self.slopes = value, slopes
        self.factors = factors or (self,)

    def __add__(self, other: Sloped[Value]) -> Sloped[Value]:
        return Sloped(add(self.value, other.value), add_slopes(self.slopes, other.slopes))

    def __mul__(self, other: Sloped[Value]) -> Sloped[Value]:
        slopes = add_slopes(scale(self.slopes, other.value), scale(other.slopes, self.value))
        return Sloped(mul(self.value, other.value), slopes, self.factors + other.factors)

    def __truediv__(self, other: Sloped[Value]) -> Sloped[Value]:
        quotient = truediv(self.value, other.value)
        slopes = {j: truediv(slope, other.value) for j, slope in self.slopes.items()}
        for factor in other.factors:
            part = {
                j: negative(mul(quotient, truediv(slope, factor.value)))
                for j, slope in factor.slopes.items()
            }
            slopes = add_slopes(slopes, part)
        return Sloped(quotient, slopes)

    def __neg__(self) -> Sloped[Value]:
        return Sloped(
            negative(self.value), {j: negative(slope) for j, slope in self.slopes.items()}
        )


def negative(value: Value) -> Value:
    """``-u``."""
    return -value  # type: ignore[operator, no-any-return]


def add_slopes(one: Mapping[int, Value], other: Mapping[int, Value]) -> dict[int, Value]:
    """The sums of two sets of slopes."""
    total = dict(one)
    for j, slope in other.items():
        total[j] = add(total[j], slope) if j in total else slope
    return total


def scale(slopes: Mapping[int, Value], factor: Value) -> dict[int, Value]:
    """Slopes times a factor."""
    return {j: mul(slope, factor) for j, slope in slopes.items()}
