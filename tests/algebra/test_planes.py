"""Tests of so(n) recognised in a basis that is declared by brackets."""

from __future__ import annotations

import random
from itertools import combinations

import pytest

from coadjoint.algebra import LieAlgebra, algebra_by_name, from_brackets
from coadjoint.algebra.planes import find_planes


def shuffle(n: int, seed: int) -> LieAlgebra:
    """so(n) in another order of the planes, and with other senses."""
    own, source = algebra_by_name(f"so({n})"), random.Random(seed)
    count = own.dimension
    order = source.sample(range(count), count)
    senses = [source.choice((-1, 1)) for _ in range(count)]
    place = {old: new for new, old in enumerate(order)}
    table: dict[tuple[int, int], dict[int, int]] = {}
    for (i, j), row in own.constants.items():
        ((k, value),) = row.items()
        a, b, sign = place[i], place[j], senses[i] * senses[j] * senses[k] * int(value)
        table[min(a, b), max(a, b)] = {place[k]: sign if a < b else -sign}
    return from_brackets("shuffled", tuple(f"e{n}" for n in range(count)), table)


@pytest.mark.parametrize("n", [3, 4, 5, 6])
def test_commutators_are_the_brackets(n: int) -> None:
    """Of matrices found for so(n) in any order and with any senses of its planes."""
    algebra = shuffle(n, n)
    planes = find_planes(algebra)
    assert len(planes) == algebra.dimension
    rows = [[[dict(m).get((i, j), 0) for j in range(n)] for i in range(n)] for m in planes]

    def multiply(a: list[list[int]], b: list[list[int]]) -> list[list[int]]:
        return [[sum(x * b[k][j] for k, x in enumerate(row)) for j in range(n)] for row in a]

    for a, b in combinations(range(len(rows)), 2):
        ahead, back = multiply(rows[a], rows[b]), multiply(rows[b], rows[a])
        expected = [[0] * n for _ in range(n)]
        for k, value in algebra.constants.get((a, b), {}).items():
            expected = [[int(value) * x for x in row] for row in rows[k]]
        assert [
            [x - y for x, y in zip(*p, strict=True)] for p in zip(ahead, back, strict=True)
        ] == (expected)


def test_other_algebras_have_none() -> None:
    """Of six dimensions se(3), of three sl(2), and so(3, 1), which differs from so(4) by signs."""
    assert find_planes(algebra_by_name("se(3)")) == ()
    assert find_planes(algebra_by_name("sl(2)")) == ()
    boosts = {(0, 1): {2: 1}, (1, 2): {0: 1}, (0, 2): {1: -1}}  # three turns
    boosts |= {(0, 4): {5: 1}, (1, 3): {5: -1}, (1, 5): {3: 1}, (2, 4): {3: -1}}
    boosts |= {(2, 3): {4: 1}, (0, 5): {4: -1}}
    for sign, count in ((1, 6), (-1, 0)):
        table = boosts | {(3, 4): {2: sign}, (4, 5): {0: sign}, (3, 5): {1: -sign}}
        algebra = from_brackets("lorentz", ("J1", "J2", "J3", "K1", "K2", "K3"), table)
        assert len(find_planes(algebra)) == count
