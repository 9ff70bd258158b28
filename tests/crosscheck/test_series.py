"""Products of power series, against Cauchy's rule typed by hand and closed forms."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from math import factorial

from coadjoint.crosscheck.series import Series, constant

LENGTH = 9
#: Coefficients of the exponential of 2 t, each a decimal of few digits when it is scaled.
DOUBLE = Series(tuple(Decimal(2**k * factorial(LENGTH)) / factorial(k) for k in range(LENGTH)))


def _multiply(one: Series, other: Series) -> list[Fraction]:
    a, b = ([Fraction(each) for each in series.of] for series in (one, other))
    return [sum((a[i] * b[k - i] for i in range(k + 1)), Fraction(0)) for k in range(len(a))]


def test_products_follow_the_rule_of_cauchy() -> None:
    """Also by numbers, which have a short way, and by what is zero at first alone."""
    late = Series((Decimal(0), *DOUBLE.of[1:]))
    sparse = Series((*[Decimal(0)] * (LENGTH - 1), Decimal(3)))
    factors = [DOUBLE, late, sparse, constant(Decimal("-1.5"), LENGTH)]
    factors += [constant(Decimal(0), LENGTH)]
    for one in factors:
        for other in factors:
            assert [Fraction(each) for each in (one * other).of] == _multiply(one, other)


def test_a_number_multiplies_every_coefficient() -> None:
    """On either side, and a product that is not a number differs from one that is."""
    three = constant(Decimal(3), LENGTH)
    assert (three * DOUBLE).of == (DOUBLE * three).of == tuple(3 * each for each in DOUBLE.of)
    assert (three * DOUBLE).of != (three * three).of
