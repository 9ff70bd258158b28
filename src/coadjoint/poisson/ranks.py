"""Ranks of matrices of functions at almost every point, by arithmetic modulo a large prime.

Comes in: sparse rows of elements. Goes out: their rank at a random point. A rank modulo p at a
point never exceeds the generic rank, and falls short of it only where a nonzero minor happens to
vanish there: for polynomials of degree d with a chance below d/p, about 1e-17, at each of two
points. Where sines or exponentials occur the rank is that of 50-digit values, and `is_exact` says
that it bounds nothing; `certain_rank` does, since sin 0, cos 0 and exp 0 are whole numbers. The
points are the same in every run.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice
from typing import Any

import mpmath

from coadjoint.algebra.linear import PRIME, rank_modulo
from coadjoint.exact import Element, Field
from coadjoint.exact.written import Adjoined

#: Points at which a rank is taken; the largest counts.
POINTS = 2
#: Decimal digits of values where a rank modulo a prime has no meaning, and the relative size below
#: which a pivot is nothing but rounding.
DIGITS = 50
NEGLIGIBLE = mpmath.mpf(10) ** -30
#: How ranks are known, in words; the last way proves nothing.
MODULO = "at random points modulo a prime"
AT_REST = f"{MODULO}, where the arguments of functions are 0"
BY_VALUES = f"by {DIGITS}-digit values"
#: Functions of 0, where they are rational.
AT_ZERO = {"sin": 0, "cos": 1, "exp": 1}
#: Points without a pole and with all square roots are looked for that often.
TRIES = 50


@dataclass(frozen=True)
class Residue:
    """An integer modulo `PRIME`, with what evaluation needs."""

    value: int

    def __add__(self, other: Residue) -> Residue:
        return Residue((self.value + other.value) % PRIME)

    def __mul__(self, other: Residue) -> Residue:
        return Residue(self.value * other.value % PRIME)

    def __neg__(self) -> Residue:
        return Residue(-self.value % PRIME)

    def __truediv__(self, other: Residue) -> Residue:
        if not other.value:
            raise ZeroDivisionError(f"division by zero modulo {PRIME}")
        return Residue(self.value * pow(other.value, -1, PRIME) % PRIME)


def residue(number: Fraction | int) -> Residue:
    """A rational number modulo `PRIME`."""
    exact = Fraction(number)
    return Residue(exact.numerator) / Residue(exact.denominator % PRIME)


def generic_rank(field: Field, rows: Sequence[Mapping[int, Element]]) -> int:
    """Rank of a sparse matrix of elements at almost every point.

    >>> field = Field(["x", "y"])
    >>> x, y = field["x"], field["y"]
    >>> generic_rank(field, [{0: x, 1: y}, {0: x * y, 1: y**2}])
    1
    """
    if is_exact(field, (entry for row in rows for entry in row.values())):
        return _largest(map(rank_modulo, islice(_sampled(field, rows), POINTS)), len(rows))
    with mpmath.workdps(DIGITS):
        return _largest(map(_rank_of_values, islice(_valued(field, rows), POINTS)), len(rows))


def certain_rank(field: Field, rows: Sequence[Mapping[int, Element]]) -> int:
    """A bound of the generic rank from below, without rounding.

    Where functions occur, it is the rank where all symbols in their arguments are 0: no rank at a
    point exceeds the generic one. 0 where they are not rational there, as ``log(x)``.

    >>> field = Field(["x", "y"], slots=2)
    >>> cosine = field.call("cos", field["x"])
    >>> certain_rank(field, [{0: cosine, 1: field["y"]}, {0: field["x"], 1: cosine}])
    2
    """
    entries = [entry for row in rows for entry in row.values()]
    if is_exact(field, entries):
        return generic_rank(field, rows)
    functions = [f for f in _functions(field, entries) if f.function != "sqrt"]
    resting = frozenset[str]().union(*(field.reach(f.argument) for f in functions))
    if not all(_vanishes(field, f.argument) for f in functions):
        return 0
    source = random.Random(1)  # noqa: S311 (not for secrets)
    for _ in range(TRIES):
        with suppress(ZeroDivisionError):
            point = _random_point(field, source) | dict.fromkeys(resting, Residue(0))
            return rank_modulo(_residues(field, rows, point))
    return 0


def source_of_ranks(field: Field, *ranks: tuple[Sequence[Mapping[int, Element]], int]) -> str:
    """How the ranks of some matrices are known: `MODULO`, `AT_REST` or `BY_VALUES`.

    >>> field = Field(["x"], slots=2)
    >>> source_of_ranks(field, ([{0: field.call("cos", field["x"])}], 1))
    'at random points modulo a prime, where the arguments of functions are 0'
    """
    if all(is_exact(field, row.values()) for rows, _ in ranks for row in rows):
        return MODULO
    certain = all(certain_rank(field, rows) == rank for rows, rank in ranks)
    return AT_REST if certain else BY_VALUES


def _vanishes(field: Field, argument: Element) -> bool:
    """Whether an argument without functions is 0 where its symbols are."""
    zeros = dict.fromkeys(field.names, Fraction(0))
    with suppress(ZeroDivisionError):
        return field.function_free(argument) and not field.evaluate(
            argument, zeros, Fraction, lambda function, x: x
        )
    return False


def independent_rows(field: Field, rows: Sequence[Mapping[int, Element]]) -> list[int]:
    """Places of the rows that do not depend on those before them, at almost every point.

    >>> field = Field(["x", "y"])
    >>> x, y = field["x"], field["y"]
    >>> independent_rows(field, [{0: x}, {0: x * y}, {0: x, 1: y}])
    [0, 2]
    """
    if is_exact(field, (entry for row in rows for entry in row.values())):
        return _greedy(next(_sampled(field, rows)), rank_modulo)
    with mpmath.workdps(DIGITS):
        return _greedy(next(_valued(field, rows)), _rank_of_values)


def _greedy(
    rows: Sequence[dict[int, Any]], rank: Callable[[list[dict[int, Any]]], int]
) -> list[int]:
    """Places of rows of numbers, each of which raises the rank of those chosen before."""
    chosen: list[int] = []
    for place, row in enumerate(rows):
        if rank([*(rows[n] for n in chosen), row]) > len(chosen):
            chosen.append(place)
    return chosen


def _largest(ranks: Iterable[int], most: int) -> int:
    """The largest of the ranks at several points; one that cannot grow ends the search."""
    largest = 0
    for rank in ranks:
        largest = max(largest, rank)
        if largest == most:
            break
    return largest


def is_exact(field: Field, elements: Iterable[Element]) -> bool:
    """Whether ranks of such entries are exact: no function occurs but ``sqrt``."""
    return all(known.function == "sqrt" for known in _functions(field, elements))


def _functions(field: Field, elements: Iterable[Element]) -> Iterator[Adjoined]:
    """The functions that occur in elements, or in the arguments of such."""
    return (field.adjoined[name] for e in elements for name in field.functions_in(e))


def _sampled(field: Field, rows: Sequence[Mapping[int, Element]]) -> Iterator[list[dict[int, int]]]:
    """The matrix at random points; poles, and points without the square roots, are passed over."""
    source = random.Random(1)  # noqa: S311 (not for secrets)
    while True:
        with suppress(ZeroDivisionError):
            yield _residues(field, rows, _random_point(field, source))


def _random_point(field: Field, source: random.Random) -> dict[str, Residue]:
    return {name: Residue(source.randrange(1, PRIME)) for name in field.names}


def _residues(
    field: Field, rows: Sequence[Mapping[int, Element]], point: Mapping[str, Residue]
) -> list[dict[int, int]]:
    """The matrix at a point."""
    return [
        {j: field.evaluate(e, point, residue, residue_call).value for j, e in row.items()}
        for row in rows
    ]


def residue_call(function: str, argument: Residue) -> Residue:
    """A square root modulo `PRIME`, or another function where its argument is 0.

    Raises:
        ZeroDivisionError: There is no such value, for roots at every other point.
    """
    if function in AT_ZERO and not argument.value:
        return Residue(AT_ZERO[function])
    if function != "sqrt":
        raise ZeroDivisionError(f"{function}({argument.value}) is not rational")
    root = pow(argument.value, (PRIME + 1) // 4, PRIME)  # PRIME is 3 modulo 4
    if root * root % PRIME != argument.value:
        raise ZeroDivisionError(f"no square root of {argument.value} modulo {PRIME}")
    return Residue(root)


# -- 50-digit values ------------------------------------------------------------------------------


def _valued(field: Field, rows: Sequence[Mapping[int, Element]]) -> Iterator[list[dict[int, Any]]]:
    """The matrix at random points between 1/2 and 2; points outside a domain are passed over."""
    source = random.Random(2)  # noqa: S311 (not for secrets)
    while True:
        point = {name: mpmath.mpf(source.randint(1000, 4000)) / 2000 for name in field.names}
        with suppress(ZeroDivisionError, ValueError):
            yield [
                {j: field.evaluate(e, point, _decimal, _real) for j, e in row.items()}
                for row in rows
            ]


def _rank_of_values(rows: Sequence[Mapping[int, Any]]) -> int:
    """Rank by elimination with the largest pivot, until what is left is rounding."""
    pending = [dict(row) for row in rows]
    largest = max((abs(x) for row in pending for x in row.values()), default=0)
    rank = 0
    while True:
        pivots = [(abs(x), i, j) for i, row in enumerate(pending) for j, x in row.items()]
        size, i, j = max(pivots, default=(0, 0, 0))
        if size <= NEGLIGIBLE * largest:
            return rank
        rank += 1
        pivot = pending.pop(i)
        for row in pending:
            factor = row.get(j, 0) / pivot[j]
            for column, x in pivot.items():
                row[column] = row.get(column, 0) - factor * x


def _decimal(value: Fraction) -> Any:
    return mpmath.mpf(value.numerator) / value.denominator


def _real(function: str, argument: Any) -> Any:
    """A real elementary function.

    Raises:
        ValueError: The argument is outside the real domain.
    """
    if argument <= 0 and function in ("sqrt", "log"):
        raise ValueError(f"{function} of {argument}")
    return getattr(mpmath, function)(argument)
