"""Charts of the sphere: numbers, poles."""

from fractions import Fraction

import pytest

from coadjoint.errors import AlgebraError
from coadjoint.exact.dense import dot
from coadjoint.groups.complex_numbers import Complex
from coadjoint.theory.charts import north_chart, north_point, south_chart, south_point

POINT = (Fraction(2, 7), Fraction(3, 7), Fraction(6, 7))


def test_charts_of_a_rational_point():
    """A rational point has rational coordinates, (2, 3, 6)/7 has 2 + 3i and (2 - 3i)/13."""
    assert north_chart(POINT) == Complex(2, 3)
    assert south_chart(POINT) == Complex(2, -3) / 13
    assert north_point(Complex(2, 3)) == POINT
    assert south_point(Complex(2, -3) / 13) == POINT
    assert north_point(Complex(2, -3)) != POINT


def test_every_chart_value_is_on_the_sphere():
    """The centres of the charts are the opposite poles."""
    assert north_point(Complex(0)) == (0, 0, -1)
    assert south_point(Complex(0)) == (0, 0, 1)
    assert dot(north_point(Complex(5, -8)), north_point(Complex(5, -8))) == 1


@pytest.mark.parametrize(("chart", "pole"), [(north_chart, 1), (south_chart, -1)])
def test_a_chart_leaves_out_its_pole(chart, pole):
    """The pole itself is refused; the other pole is the centre."""
    with pytest.raises(AlgebraError, match="has no inverse"):
        chart((0, 0, pole))
    assert chart((0, 0, -pole)) == 0
