"""Regular matrices: determinants that are not zero, shown at a point."""

import random

import pytest

from coadjoint.exact import Field
from coadjoint.exact.ranks import certain_minors, witness_regular


def outer(field, rank, size, functions):
    """A symmetric matrix of given rank with random integers, functions or symbols in it."""
    source = random.Random(rank)
    x = field["x"]
    factors = (
        [field.call("exp", x), field.call("sin", x), x] if functions else [x, x + 1, field.one]
    )
    vectors = [
        [
            field.number(source.randint(-4, 4)) * factors[n % 3] + source.randint(1, 9)
            for n in range(size)
        ]
        for _ in range(rank)
    ]
    return [[field.sum(v[i] * v[j] for v in vectors) for j in range(size)] for i in range(size)]


@pytest.mark.parametrize("functions", [False, True])
@pytest.mark.parametrize("size", [1, 4, 6])
def test_regular_matrices_have_a_witness_and_singular_ones_none(size, functions):
    """A sum of as many dyads as rows is regular, of one fewer it is not."""
    field = Field(["x", "y"], slots=2)
    full, short = (outer(field, rank, size, functions) for rank in (size, size - 1))
    assert witness_regular(field, full) is not None
    assert certain_minors(field, full) == size
    assert witness_regular(field, short or [[field.zero]]) is None
    assert certain_minors(field, short or [[field.zero]]) == size - 1


def test_a_hidden_zero_is_no_pivot():
    """exp(2x) - exp(x)^2 stands in the second minor, and elimination stops before it."""
    field = Field(["x"], slots=2)
    single, double = field.call("exp", field["x"]), field.call("exp", 2 * field["x"])
    matrix = [[double, single], [single, field.one]]
    assert certain_minors(field, matrix) == 1
    assert witness_regular(field, matrix) is None


def test_rows_change_places_for_a_determinant_alone():
    """[[0, 1], [1, 0]] is regular, and its first leading minor is zero."""
    field = Field(["x"])
    matrix = [[field.zero, field.one], [field.one, field.zero]]
    assert witness_regular(field, matrix) == {}
    assert certain_minors(field, matrix) == 0


def test_one_point_serves_all_matrices():
    """Of two matrices one is singular where x = y and one elsewhere regular: both at one point."""
    field = Field(["x", "y"])
    x, y = field["x"], field["y"]
    point = witness_regular(field, [[x - y]], [[x, y], [y, x]])
    assert point["x"] ** 2 != point["y"] ** 2
