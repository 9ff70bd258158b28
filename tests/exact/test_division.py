"""Remainders of polynomials: those of SymPy, and what makes them remainders."""

from random import Random

import pytest
from sympy import QQ, grevlex, ring

from coadjoint.exact.denominators import remove_factor
from coadjoint.exact.division import find_remainder

R, *SYMBOLS = ring("x, y, z, w", QQ, grevlex)


def polynomial(random, terms, degree):
    """A polynomial with so many terms at the most."""
    powers = [tuple(random.randint(0, degree) for _ in SYMBOLS) for _ in range(terms)]
    return R.from_dict(
        {p: QQ(random.randint(-9, 9), random.randint(1, 5)) or QQ(1) for p in powers}
    )


@pytest.mark.parametrize("seed", range(20))
def test_remainders_are_those_of_sympy(seed):
    """For any divisors and not only bases of Groebner, in their order; another order may differ."""
    random = Random(seed)
    divisors = [polynomial(random, 4, 2) for _ in range(3)]
    for _ in range(5):
        p = polynomial(random, 30, 5)
        assert find_remainder(p, divisors) == p.rem(divisors)


def test_the_order_of_divisors_matters():
    """As in Cox, Little and O'Shea, section 2.3, examples 4 and 5, where the order is lex."""
    x, y, *_ = SYMBOLS
    p, f, g = x**2 * y + x * y**2 + y**2, x * y - 1, y**2 - 1
    assert find_remainder(p, [f, g]) == x + y + 1
    assert find_remainder(x * y**2 - x, [f, g]) == -x + y
    assert find_remainder(x * y**2 - x, [g, f]) == 0


def test_nothing_is_left_of_a_multiple():
    """And all of what no divisor divides; the divisors and the polynomial stay as they are."""
    x, y, z, w = SYMBOLS
    f = x**2 + 3 * y - z
    p = f * (w**3 - x + y * z)
    before = dict(p)
    assert find_remainder(p, [f]) == 0
    assert find_remainder(p + w, [f]) == w
    assert (dict(p), find_remainder(w, [])) == (before, w)
    assert find_remainder(R.zero, [f]) == 0


@pytest.mark.parametrize("seed", range(10))
def test_factors_are_removed_as_often_as_they_divide(seed):
    """In the order lex: powers of a factor from a product, none from its neighbour."""
    lex, *symbols = ring("x, y, z, w", QQ)
    random = Random(seed)
    factor, other = (lex.from_dict(dict(polynomial(random, 5, 2))) + symbols[0] for _ in range(2))
    count = random.randint(1, 3)
    p = factor**count * other
    before = dict(p)
    most, left = remove_factor(p, factor)
    assert most >= count
    assert left * factor**most == p
    assert left.div(factor)[1] != 0
    assert remove_factor(p, factor, 1) == (1, p.quo(factor))
    assert remove_factor(p + symbols[3] ** 20, factor)[0] == 0
    assert dict(p) == before
