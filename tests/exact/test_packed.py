"""Dense rows modulo a prime: pivots and null spaces that closed forms give."""

import random
from math import comb

import pytest

from coadjoint.exact.dense import dot
from coadjoint.exact.linear import PRIME, nullspace_modulo
from coadjoint.exact.packed import PackedSpan


@pytest.mark.parametrize("prime", [7, 8191, PRIME])
def test_polynomials_of_low_degree_are_orthogonal_to_differences(prime):
    """Values of 1, x, x^2 at 0, 1, ... are annihilated by shifts of third differences alone."""
    size = 6
    span = PackedSpan(prime, size, [[x**k % prime for x in range(size)] for k in range(3)])
    assert sorted(span.pivots) == [0, 1, 2]
    difference = [(-1) ** k * comb(3, k) for k in range(4)]
    for vector in span.nullspace():
        row = [vector.get(n, 0) for n in range(size)]
        assert all(sum(x**k * v for x, v in enumerate(row)) % prime == 0 for k in range(3))
    shifts = [[0] * n + difference + [0] * (2 - n) for n in range(3)]
    whole = PackedSpan(prime, size, [[x % prime for x in row] for row in shifts])
    assert len(whole.pivots) == len(span.nullspace()) == 3


def test_columns_that_depend_on_those_before_them_have_no_pivot():
    """With column 2 the sum of columns 0 and 1 the pivots are 0, 1, 3, in the order of the rows."""
    rows = [[0, 1, 1, 4], [1, 0, 1, 0], [2, 3, 5, 12], [0, 0, 0, 6]]
    span = PackedSpan(PRIME, 4, rows)
    assert span.pivots == [1, 0, 3]
    assert span.nullspace() == [{0: 1, 1: 1, 2: PRIME - 1}]
    rows[2][2] += 1  # spoiled: the columns are independent
    assert PackedSpan(PRIME, 4, rows).nullspace() == []


def test_no_rows_leave_every_unit_vector():
    """The null space of no condition is everything; of no unknown it is nothing."""
    assert PackedSpan(PRIME, 2).nullspace() == [{0: 1}, {1: 1}]
    assert PackedSpan(PRIME, 0, [[]]).nullspace() == []


@pytest.mark.parametrize("rank", [1, 5, 12])
def test_the_null_space_is_that_of_sparse_elimination(rank):
    """Random rows of a given rank: the same reduced basis as by the rows one entry at a time."""
    source, size = random.Random(rank), 12
    base = [[source.randrange(PRIME) for _ in range(size)] for _ in range(rank)]
    weights = [[source.randrange(PRIME) for _ in base] for _ in range(size + 3)]
    rows = [[dot(each, column) % PRIME for column in zip(*base, strict=True)] for each in weights]
    sparse = nullspace_modulo([dict(enumerate(row)) for row in rows], size, PRIME)
    assert PackedSpan(PRIME, size, rows).nullspace() == sparse
    assert len(sparse) == size - rank
