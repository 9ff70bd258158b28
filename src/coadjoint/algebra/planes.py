"""Planes: so(n) recognised in a basis that is declared by brackets.

Comes in: an algebra. Goes out: antisymmetric matrices of its basis, each of which turns one plane
of R^n, where the basis is that of the planes in some order and with some senses.
Read next: `coadjoint.derive.sandwich`, which needs matrices.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations
from math import isqrt

from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.algebra.matrices import SparseMatrix

#: Two axes, in order.
Plane = tuple[int, int]


def find_planes(algebra: LieAlgebra) -> tuple[SparseMatrix, ...]:
    """A matrix for each basis vector, so that commutators are brackets; () where there are none.

    >>> from coadjoint.algebra import from_brackets
    >>> table = {(0, 1): {2: 1}, (1, 2): {0: 1}, (0, 2): {1: -1}}
    >>> turning = from_brackets("turning", ("a", "b", "c"), table)
    >>> [dict(each) for each in find_planes(turning)][0]
    {(0, 1): 1, (1, 0): -1}
    """
    axes = (1 + isqrt(1 + 8 * algebra.dimension)) // 2
    if axes * (axes - 1) != 2 * algebra.dimension or axes < 3:
        return ()
    found: dict[Plane, tuple[int, int]] = {}
    for pair, row in algebra.constants.items():
        if len(row) != 1:
            return ()
        ((place, value),) = row.items()
        if not isinstance(value, int) or abs(value) != 1:
            return ()
        found[pair] = (place, value)
    planes = next(_place([], algebra.dimension, axes, found), None)
    senses = None if planes is None else _turn(planes, found)
    if planes is None or senses is None:
        return ()
    return tuple(
        {(i, j): sense, (j, i): -sense} for (i, j), sense in zip(planes, senses, strict=True)
    )


def _place(
    planes: list[Plane], count: int, axes: int, brackets: Mapping[Plane, tuple[int, int]]
) -> Iterator[list[Plane]]:
    """Planes for all basis vectors: those of two have an axis in common where these do not commute.

    Their bracket then turns the plane of the other two axes.
    """
    if len(planes) == count:
        yield planes
        return
    for plane in combinations(range(axes), 2):
        longer = [*planes, plane]
        if plane not in planes and all(
            _fits(longer, (before, len(planes)), brackets) for before in range(len(planes))
        ):
            yield from _place(longer, count, axes, brackets)


def _fits(
    planes: list[Plane], pair: tuple[int, int], brackets: Mapping[Plane, tuple[int, int]]
) -> bool:
    """Whether the bracket of two vectors is as their planes say."""
    one, other = ({*planes[place]} for place in pair)
    if pair not in brackets:
        return not one & other
    third, _ = brackets[pair]
    return len(one & other) == 1 and (third >= len(planes) or {*planes[third]} == one ^ other)


def _turn(planes: list[Plane], brackets: Mapping[Plane, tuple[int, int]]) -> tuple[int, ...] | None:
    """The senses in which planes are turned; None where brackets contradict one another."""
    senses: dict[int, int] = {}
    for first in range(len(planes)):
        senses.setdefault(first, 1)
        while True:
            known = len(senses)
            for (a, b), (c, value) in brackets.items():
                sign = value * _commute(planes[a], planes[b], planes[c])
                unknown = [each for each in (a, b, c) if each not in senses]
                if not unknown and senses[a] * senses[b] * senses[c] != sign:
                    return None
                if len(unknown) == 1:
                    senses[unknown[0]] = sign
                    for each in {a, b, c} - {*unknown}:
                        senses[unknown[0]] *= senses[each]
            if len(senses) == known:
                break
    return tuple(senses[place] for place in range(len(planes)))


def _commute(one: Plane, other: Plane, third: Plane) -> int:
    """The sign with which the commutator of two planes with one axis in common is a third."""
    a = {one: 1, one[::-1]: -1}
    b = {other: 1, other[::-1]: -1}
    i, j = third
    ahead = sum(x * b.get((k, j), 0) for (row, k), x in a.items() if row == i)
    back = sum(x * a.get((k, j), 0) for (row, k), x in b.items() if row == i)
    return ahead - back
