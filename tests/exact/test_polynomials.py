"""Products of polynomials and powers of generators, against SymPy's."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
from sympy import QQ, ring
from sympy.polys.orderings import lex

from coadjoint.exact import polynomials
from coadjoint.exact.denominators import Factors, remove_factor
from coadjoint.exact.rationals import Rationals

RING, *SYMBOLS = ring("a b c d e", QQ, lex)


def draw(source, terms, most=6, below=1):
    """A polynomial of so many terms at most."""
    found = RING.zero
    for _ in range(terms):
        monomial = tuple(source.randrange(most) for _ in SYMBOLS)
        found += RING.from_dict(
            {monomial: QQ(source.randint(-9, 9) or 1, source.randint(1, below))}
        )
    return found


@pytest.mark.parametrize("below", [1, 7])
@pytest.mark.parametrize("most", [6, 127, 200, 300])
def test_products_are_those_of_sympy_in_the_same_order(below, most):
    """Whole coefficients and fractions; exponents within a byte, and sums and others beyond."""
    source = random.Random(most + below)
    for _ in range(20):
        a, b = draw(source, 9, most, below), draw(source, 7, most, below)
        found, expected = polynomials.multiply(a, b), a * b
        assert list(found.items()) == list(expected.items())
        assert all(type(one) is type(other) for one, other in zip(found, expected, strict=True))
    assert polynomials.multiply(a - b, a + b) == a * a - b * b  # whose middle terms cancel


def test_single_generators_are_removed_as_any_factor_is():
    """As often as asked for, or as they divide."""
    source, factors = random.Random(5), Factors(RING)
    factors.split(SYMBOLS[2] * (SYMBOLS[0] + SYMBOLS[1]))
    assert factors.places == [2, -1]
    for _ in range(50):
        p = draw(source, source.randint(1, 4), 4) or RING.one
        for number, known in enumerate(factors.known):
            for most in (1, 2, 5):
                assert factors.remove(p, number, most) == remove_factor(p, known, most)
    assert factors.remove(SYMBOLS[2] ** 3, 0, 2) == (2, SYMBOLS[2])


def test_terms_whose_ratio_has_no_generator_have_equal_powers_of_it():
    """Above and below the bar, as their ratio says itself."""
    field = Rationals(["x", "y", "k"])
    x, y, k = (field[name] for name in "xyk")
    terms = [x, y, k * x, x / k, x / (y * k), k / y, x * x / (x + y), x / (x + y), 3 * x / y]
    powers = [field.powers_in(each, [0, 1]) for each in terms]
    assert powers[4] == [1, -1]
    free = 0
    for one, own in zip(terms, powers, strict=True):
        for other, others in zip(terms, powers, strict=True):
            if field.names_in(one * other.inverse()) <= {"k"}:
                assert own == others
                free += one is not other
    assert free == 8  # of k*x, x and x/k, and of x/(y*k) and 3*x/y, either way
    assert field.first_term(x * y + Fraction(1, 2) * x) == x * y
