"""Ranks at almost every point."""

import pytest

from coadjoint.exact import Field
from coadjoint.poisson.ranks import certain_rank, generic_rank, is_exact


def test_ranks_with_functions_are_those_of_values():
    """Rows of exp(2 x) and exp(x)^2 are dependent, of sin(x) and x not; neither rank is exact."""
    field = Field(["x", "y"], slots=3)
    x, y = field["x"], field["y"]
    single, double, sine = (
        field.call("exp", x),
        field.call("exp", 2 * x),
        field.call("sin", x),
    )
    assert generic_rank(field, [{0: double, 1: y}, {0: single**2, 1: y}]) == 1
    assert generic_rank(field, [{0: sine, 1: y}, {0: x, 1: y}]) == 2
    assert generic_rank(field, [{0: sine}, {}]) == 1
    assert is_exact(field, [x * y])
    assert not is_exact(field, [x, sine])
    assert not is_exact(field, [field.call("sqrt", single)])


def test_ranks_pass_over_poles_and_missing_roots():
    """sqrt(x)/(x - y) has rank one; a matrix of equal columns too; the zero matrix has none."""
    field = Field(["x", "y"], slots=1)
    x, y = field["x"], field["y"]
    entry = field.call("sqrt", x) / (x - y)
    assert generic_rank(field, [{0: entry, 1: entry}, {0: y * entry, 1: y * entry}]) == 1
    assert generic_rank(field, [{0: entry}, {1: y}]) == 2
    assert generic_rank(field, [{}, {}]) == 0


def test_ranks_with_functions_are_certain_where_their_arguments_are_zero():
    """cos(x) and exp(x) are 1 there; a rank at one point bounds others, and may fall short."""
    field = Field(["x", "y"], slots=8)
    x, y = field["x"], field["y"]
    cosine, sine, growth = (field.call(name, x) for name in ("cos", "sin", "exp"))
    assert certain_rank(field, [{0: cosine, 1: sine}, {0: -sine, 1: cosine}]) == 2
    assert certain_rank(field, [{0: growth + cosine, 1: y}, {0: x + 2, 1: y}]) == 1
    assert generic_rank(field, [{0: growth + cosine, 1: y}, {0: x + 2, 1: y}]) == 2
    assert certain_rank(field, [{0: x, 1: y}, {0: x * y, 1: y**2}]) == 1


@pytest.mark.parametrize("name", ["log", "cos"])
def test_values_that_are_not_rational_bound_no_rank(name):
    """log(x) has a pole at 0, cos(x + 1) is irrational, 1/sin(x) is infinite."""
    field = Field(["x", "y"], slots=4)
    x, y = field["x"], field["y"]
    value = field.call(name, x + (name == "cos"))
    pole = field.one / field.call("sin", x)
    for entry in (value, pole):
        assert certain_rank(field, [{0: entry * y}]) == 0
        assert generic_rank(field, [{0: entry * y}]) == 1
