"""Ranks at almost every point."""

from coadjoint.exact import Field
from coadjoint.poisson.ranks import generic_rank, is_exact


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
