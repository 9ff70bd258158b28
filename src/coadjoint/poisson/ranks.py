"""Ranks of matrices of functions at almost every point, by arithmetic modulo a large prime.

Comes in: sparse rows of elements. Goes out: their rank at a random point. A rank modulo p at a
point never exceeds the generic rank, and falls short of it only where a nonzero minor happens to
vanish there: for polynomials of degree d with a chance below d/p, about 1e-17, at each of two
points. The points are the same in every run.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice

from coadjoint.algebra.linear import PRIME, rank_modulo
from coadjoint.errors import AlgebraError
from coadjoint.exact import Element, Field

#: Points at which a rank is taken; the largest counts.
POINTS = 2


@dataclass(frozen=True)
class Residue:
    """An integer modulo `PRIME`, with what evaluation needs."""

    value: int

    def __add__(self, other: Residue) -> Residue:
        return Residue((self.value + other.value) % PRIME)

    def __mul__(self, other: Residue) -> Residue:
        return Residue(self.value * other.value % PRIME)

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

    Raises:
        AlgebraError: An entry holds a function other than ``sqrt``.

    >>> field = Field(["x", "y"])
    >>> x, y = field["x"], field["y"]
    >>> generic_rank(field, [{0: x, 1: y}, {0: x * y, 1: y**2}])
    1
    """
    return max(map(rank_modulo, islice(_sampled(field, rows), POINTS)))


def _sampled(field: Field, rows: Sequence[Mapping[int, Element]]) -> Iterator[list[dict[int, int]]]:
    """The matrix at random points; poles, and points without the square roots, are passed over."""
    source = random.Random(1)  # noqa: S311 (not for secrets)
    while True:
        point = {name: Residue(source.randrange(1, PRIME)) for name in field.names}
        try:
            yield [{j: _value(field, e, point).value for j, e in row.items()} for row in rows]
        except ZeroDivisionError:
            continue


def _value(field: Field, element: Element, point: Mapping[str, Residue]) -> Residue:
    return field.evaluate(element, point, residue, _call)


def _call(function: str, argument: Residue) -> Residue:
    """A square root modulo `PRIME`.

    Raises:
        AlgebraError: Another function.
        ZeroDivisionError: There is no root, as at every other point.
    """
    if function != "sqrt":
        raise AlgebraError(
            f"the rank of a tensor with {function!r} in it cannot be found; expected rational "
            "functions and square roots.",
            found=function,
        )
    root = pow(argument.value, (PRIME + 1) // 4, PRIME)  # PRIME is 3 modulo 4
    if root * root % PRIME != argument.value:
        raise ZeroDivisionError(f"no square root of {argument.value} modulo {PRIME}")
    return Residue(root)
