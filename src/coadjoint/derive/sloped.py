"""Sloped: values with their slopes, by the product, quotient and chain rules.

Comes in: values in any arithmetic. Goes out: the same with derivatives by some variables.
Read next: `coadjoint.derive.reference`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from operator import add, mul, truediv
from typing import Any, Generic, TypeVar

from coadjoint.exact.factored import factor as factor_matrix
from coadjoint.exact.factored import place_of, rows_of

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

    @staticmethod
    def factor(entries: Sequence[Sloped[Any]]) -> SlopedEquations:
        """What solves symmetric equations; see `coadjoint.exact.factored`."""
        return SlopedEquations(entries)


class SlopedEquations:
    """Symmetric equations ``A x = b``, whose solution has slopes ``A x' = b' - A' x``.

    Args:
        entries: Of A, on and below the diagonal, row by row.
    """

    def __init__(self, entries: Sequence[Sloped[Any]]) -> None:
        self._entries, self._size = entries, rows_of(len(entries))
        self._values = factor_matrix([each.value for each in entries])

    def __getitem__(self, place: int) -> Sloped[Any]:
        """A pivot, without its slopes: no function whose slopes are asked for reads one."""
        return Sloped(self._values[place], {})

    def solve(self, known: Sequence[Sloped[Any]]) -> list[Sloped[Any]]:
        """The x of ``A x = b``."""
        x = self._values.solve([each.value for each in known])
        rows = [dict(each.slopes) for each in known]
        for i in range(self._size):
            for j in range(self._size):
                entry = self._entries[place_of(max(i, j), min(i, j))]
                rows[i] = add_slopes(rows[i], scale(entry.slopes, negative(x[j])))
        slopes = list[dict[int, Any]]({} for _ in x)
        zero = _zero(x[0])
        for variable in sorted(set[int]().union(*rows)):
            column = self._values.solve([row.get(variable, zero) for row in rows])
            for slope, value in zip(slopes, column, strict=True):
                slope[variable] = value
        return list(map(Sloped, x, slopes))


def _zero(value: Any) -> Any:
    """0 in the arithmetic of a value, in which ``x - x`` may have an error."""
    return value.zero() if hasattr(value, "zero") else add(value, negative(value))


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
