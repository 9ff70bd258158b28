"""Ranks at almost every point: certain from below, whatever stands in the entries."""

from fractions import Fraction

import pytest

from coadjoint.errors import AlgebraError
from coadjoint.exact import Field
from coadjoint.exact.linear import PRIME
from coadjoint.exact.ranks import (
    CHANCE,
    ENCLOSED,
    MODULO,
    NO_CHANCE,
    error_of_ranks,
    generic_rank,
    independent_rows,
    is_exact,
    source_of_ranks,
)
from coadjoint.exact.residues import Residue, residue


def test_ranks_with_functions_are_those_of_values():
    """Rows of exp(2 x) and exp(x)^2 are dependent, of sin(x) and x not."""
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


def test_ranks_pass_over_poles():
    """sqrt(x)/(x - y) has rank one; a matrix of equal columns too; the zero matrix has none."""
    field = Field(["x", "y"], slots=1)
    x, y = field["x"], field["y"]
    entry = field.call("sqrt", x) / (x - y)
    assert generic_rank(field, [{0: entry, 1: entry}, {0: y * entry, 1: y * entry}]) == 1
    assert generic_rank(field, [{0: entry}, {1: y}]) == 2
    assert generic_rank(field, [{}, {}]) == 0


@pytest.mark.parametrize("number", [2, 3, 5, 6, 7, 11, 2**61])
def test_every_square_root_of_a_number_has_its_place(number):
    """Modulo a prime half of them do not exist; (r, 1; r^2, r) has rank one, others have two."""
    field = Field(["x"], slots=1)
    r, x, one = field.call("sqrt", field.number(number)), field["x"], field.one
    assert generic_rank(field, [{0: r, 1: one}, {0: r * r, 1: r}]) == 1
    assert generic_rank(field, [{0: r, 1: one}, {0: r * r, 1: r + x}]) == 2
    assert independent_rows(field, [{0: r}, {0: x}, {1: r}]) == [0, 2]


def test_roots_have_the_sign_of_the_real_one():
    """sqrt(x^2) is x where x is positive: modulo a prime it may be -x, which is not zero with x."""
    field = Field(["x"], slots=2, positive=["x"])
    entry = field.call("sqrt", field["x"] ** 2) - field["x"]
    assert generic_rank(field, [{0: entry}]) == 0


@pytest.mark.parametrize("factor", [PRIME, PRIME**2])
def test_a_prime_among_the_numbers_does_not_count(factor):
    """The entries p x and x/p have rank one, and (1, 1; 1, 1 + p) has two, at the first prime p."""
    field = Field(["x"])
    x, one = field["x"], field.one
    assert generic_rank(field, [{0: factor * x}]) == 1
    assert generic_rank(field, [{0: x / factor}]) == 1
    nearly = [{0: one, 1: one}, {0: one, 1: one + factor}]
    assert generic_rank(field, nearly) == 2
    assert independent_rows(field, nearly) == [0, 1]
    assert generic_rank(field, [{0: x, 1: one}, {0: x * factor, 1: one * factor}]) == 1


def test_numbers_modulo_a_prime():
    """The prime is 0 and 1/p is nothing; of another prime it is a number like others."""
    assert residue(PRIME).value == 0
    assert residue(-1) == Residue(PRIME - 1)
    assert residue(PRIME, 7) == Residue(PRIME % 7, 7)
    with pytest.raises(ZeroDivisionError):
        residue(Fraction(1, PRIME))


@pytest.mark.parametrize(
    ("function", "shift"), [("log", -40), ("sqrt", -40), ("log", 2000), ("sqrt", -(10**4))]
)
def test_points_lie_where_functions_are_defined(function, shift):
    """log(x - 40) and sqrt(x - 10^4) are defined far from 1."""
    field = Field(["x", "y"], slots=1)
    value = field.call(function, field["x"] + shift)
    assert generic_rank(field, [{0: value, 1: field["y"]}]) == 1


def test_a_place_that_is_nowhere_is_an_error_and_no_endless_loop():
    """log(-x^2 - 1) is real nowhere; the message shows it and ends."""
    field = Field(["x"], slots=1)
    nowhere = field.call("log", -(field["x"] ** 2) - 1)
    with pytest.raises(AlgebraError, match=r"no point was found where log\(-x\^2 - 1\)"):
        generic_rank(field, [{0: nowhere}])
    with pytest.raises(AlgebraError, match="no point"):
        independent_rows(field, [{0: nowhere}])


def test_how_ranks_are_known_is_said():
    """Rational ones modulo a prime with a chance; others at real points, which bound no chance."""
    field = Field(["x", "y"], slots=8)
    x, cosine = field["x"], field.call("cos", field["x"])
    plain, functions = [{0: x}], [{0: cosine}]
    assert source_of_ranks(field, (plain, 1)) == MODULO
    assert source_of_ranks(field, (plain, 1), (functions, 1)) == ENCLOSED
    assert error_of_ranks(field, plain) == CHANCE
    assert error_of_ranks(field, plain, functions) == NO_CHANCE


def test_hidden_zeros_raise_no_rank():
    """sin(2 x) - 2 sin x cos x and log(x y) - log x - log y are zero, with no normal form of 0."""
    field = Field(["x", "y"], slots=8)
    x, y = field["x"], field["y"]
    call = field.call
    doubled = call("sin", 2 * x) - 2 * call("sin", x) * call("cos", x)
    product = call("log", x * y) - call("log", x) - call("log", y)
    assert generic_rank(field, [{0: doubled}]) == 0
    assert generic_rank(field, [{0: product}]) == 0
    assert generic_rank(field, [{0: product + doubled, 1: x}, {0: y, 1: x}]) == 2
