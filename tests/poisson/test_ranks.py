"""Ranks at almost every point."""

import pytest

from coadjoint.errors import AlgebraError
from coadjoint.exact import Field
from coadjoint.poisson.ranks import generic_rank


def test_ranks_refuse_functions_that_cannot_be_sampled():
    """A sine in a tensor is named."""
    field = Field(["x"], slots=1)
    with pytest.raises(AlgebraError, match="'sin'"):
        generic_rank(field, [{0: field.call("sin", field["x"])}])


def test_ranks_pass_over_poles_and_missing_roots():
    """sqrt(x)/(x - y) has rank one; a matrix of equal columns too; the zero matrix has none."""
    field = Field(["x", "y"], slots=1)
    x, y = field["x"], field["y"]
    entry = field.call("sqrt", x) / (x - y)
    assert generic_rank(field, [{0: entry, 1: entry}, {0: y * entry, 1: y * entry}]) == 1
    assert generic_rank(field, [{0: entry}, {1: y}]) == 2
    assert generic_rank(field, [{}, {}]) == 0
