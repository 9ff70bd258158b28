"""Cross-check, columns: the oracle at many points at a time.

Comes in: a `Reference`, and names with a double for each of many points. Goes out: what `oracle`
has at each of them, value for value: the same operations on the same decimals, a column of points
at a time. Envelopes are computed in doubles, which is as good: they are sizes of errors, and nobody
reads more than two digits of them. Where doubles cannot hold an envelope, and where equations are
solved by what an arithmetic knows of them, points are evaluated one by one.
Read next: `coadjoint.crosscheck.compare`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from coadjoint.crosscheck.oracle import (
    CONTEXT,
    LARGEST_CONDITION,
    Bounded,
    OutsideDomain,
    Reference,
    call,
    exact,
    oracle,
    take,
)
from coadjoint.derive.mechanics.iteration import SETTLE, SETTLE_LAST

#: Points of a column: many spare Python's work for each operation, and all results are kept.
SIZE: Final = 128
#: Envelopes of which doubles hold the product of any two; that of nothing is nothing.
_LEAST, _MOST = 2.0**-480, 2.0**480
#: Below this part of its envelope a value is no longer followed in doubles, but rounded to one.
_NEAR: Final = 2.0**-30
_UNIT, _LARGEST = 2.0**-53, float(LARGEST_CONDITION)


class _AloneError(Exception):
    """Something that columns cannot do."""


@dataclass(slots=True)
class _Fate:
    """Which points of a column are left out, or evaluated alone; a point is one of both at most.

    Attributes:
        outside: Where the equations have no value that doubles could find.
        alone: Where a double does not hold an envelope.
    """

    outside: NDArray[np.bool_]
    alone: NDArray[np.bool_]

    def leave(self, where: Any) -> None:
        """Points at which the equations have no value."""
        self.outside |= where & ~self.alone

    def set_aside(self, where: Any) -> None:
        """Points that are evaluated one by one."""
        self.alone |= where & ~self.outside


class Column:
    """A value at each point, or one at all, as `Bounded`.

    Args:
        values: Decimals.
        near: The same in doubles: to a part in a million, wherever that can be said at all.
        wide: Envelopes.
        fate: Which points are left out by now, or evaluated alone.
    """

    __slots__ = ("fate", "near", "values", "wide")

    def __init__(self, values: Any, near: Any, wide: Any, fate: _Fate) -> None:
        self.values, self.near, self.wide, self.fate = values, near, wide, fate
        held = (wide <= _MOST) & ((wide >= _LEAST) | (wide == 0))
        if not held.all():
            fate.set_aside(~held)

    def __add__(self, other: Column) -> Column:
        values, wide = self.values + other.values, self.wide + other.wide
        near = self.near + other.near
        lost = np.abs(near) < _NEAR * wide
        if lost.any():
            near = np.array(near)
            near[lost] = np.asarray(values, dtype=object)[lost].astype(float)
        return Column(values, near, wide, self.fate)

    def __mul__(self, other: Column) -> Column:
        size = np.abs(self.near) * other.wide + np.abs(other.near) * self.wide
        wide = np.maximum(size, _UNIT * self.wide * other.wide)
        return Column(self.values * other.values, self.near * other.near, wide, self.fate)

    def __truediv__(self, other: Column) -> Column:
        size, values = np.abs(other.near), other.values
        left = other.wide >= _LARGEST * size
        if left.any():
            self.fate.leave(left)
            size, values = np.where(left, 1.0, size), _replace(values, left)
        near = self.near / np.where(left, 1.0, other.near)
        wide = (self.wide + np.abs(near) * other.wide) / size
        return Column(self.values / values, near, wide, self.fate)

    def __neg__(self) -> Column:
        return Column(-self.values, -self.near, self.wide, self.fate)

    def settled(self) -> Column:
        """As `Bounded.settled`."""
        return Column(self.values, self.near, np.abs(self.near), self.fate)

    def zero(self) -> Column:
        """0, exactly."""
        return Column(Decimal(0), np.float64(0), np.float64(0), self.fate)

    @staticmethod
    def factor(entries: Sequence[Column]) -> Any:
        """What solves symmetric equations, which points do by themselves.

        Raises:
            _AloneError: Always.
        """
        raise _AloneError

    def list_points(self) -> list[Bounded]:
        """The value at each point."""
        count = len(self.fate.outside)
        if not np.ndim(self.wide):
            return [Bounded(self.values, Decimal(float(self.wide)))] * count
        return list(map(Bounded, self.values, map(Decimal, self.wide.tolist())))


def find_exact(
    reference: Reference, function: str, points: Mapping[str, NDArray[np.float64]]
) -> dict[int, list[Bounded]]:
    """The outputs of one function at each point where the equations have a value, as `oracle`.

    Args:
        reference: The equations.
        function: Which function.
        points: State and parameter components by name, a row of points each.
    """
    found, count = dict[int, list[Bounded]](), min(map(len, points.values()))
    for first in range(0, count, SIZE):
        some = {name: row[first : first + SIZE] for name, row in points.items()}
        found |= {first + n: values for n, values in _find_some(reference, function, some).items()}
    return found


def _find_some(
    reference: Reference, function: str, points: Mapping[str, NDArray[np.float64]]
) -> dict[int, list[Bounded]]:
    """The same for so many points as a column has."""
    count = min(map(len, points.values()))
    fate = _Fate(np.zeros(count, bool), np.zeros(count, bool))
    found = dict[int, list[Bounded]]()
    with localcontext(CONTEXT), np.errstate(all="ignore"):
        try:
            values = _evaluate(reference, function, points, fate)
        except (_AloneError, ArithmeticError):
            fate = _Fate(np.zeros(count, bool), np.ones(count, bool))
        else:
            whole = np.flatnonzero(~(fate.outside | fate.alone)).tolist()
            rows = list(zip(*(column.list_points() for column in values), strict=True))
            found = {point: list(rows[point]) for point in whole}
    for point in np.flatnonzero(fate.alone).tolist():
        try:
            inputs = {name: float(row[point]) for name, row in points.items()}
            found[point] = oracle(reference, function, inputs)
        except OutsideDomain:
            continue
    return dict(sorted(found.items()))


def _evaluate(
    reference: Reference, function: str, points: Mapping[str, NDArray[np.float64]], fate: _Fate
) -> list[Column]:
    """The equations at all points."""

    def number(value: Fraction) -> Column:
        taken = exact(value)
        return Column(taken.value, np.float64(taken.value), np.float64(taken.envelope), fate)

    def apply(name: str, *arguments: Column) -> Column:
        return _call(name, arguments, fate)

    known = {
        name: Column(_column([take(x).value for x in row.tolist()]), row, np.abs(row), fate)
        for name, row in points.items()
    }
    return reference.evaluate(function, known, number, apply)


def _call(function: str, arguments: Sequence[Column], fate: _Fate) -> Column:
    """A function of columns, point by point: most of its time is the function's own."""
    if function == SETTLE:
        return arguments[0].settled()
    if function == SETTLE_LAST:
        return arguments[0]
    found, nothing = list[Bounded](), exact(1.0)
    left = np.zeros(len(fate.outside), bool)
    gone = (fate.outside | fate.alone).tolist()
    for point, given in enumerate(zip(*(each.list_points() for each in arguments), strict=True)):
        try:
            found.append(nothing if gone[point] else call(function, *given))
        except (OutsideDomain, ArithmeticError):
            found.append(nothing)
            left[point] = True
    fate.leave(left)
    near, wide = (
        np.array([float(number) for number in row])
        for row in ([each.value for each in found], [each.envelope for each in found])
    )
    return Column(_column([each.value for each in found]), near, wide, fate)


def _replace(values: Any, where: Any) -> NDArray[Any]:
    """Decimals with 1 in the place of some."""
    row = np.array(np.broadcast_to(np.asarray(values, dtype=object), np.shape(where)))
    row[where] = Decimal(1)
    return row


def _column(values: Sequence[Decimal]) -> NDArray[Any]:
    """Decimals in a row."""
    row = np.empty(len(values), dtype=object)
    row[:] = values
    return row
