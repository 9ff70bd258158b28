"""Witness points: what is called nonzero is nonzero at a point, with bounds that exclude zero."""

import random
from fractions import Fraction

import mpmath
import pytest

from coadjoint.exact import Condition, Field, Region
from coadjoint.exact.witness import (
    Enclosure,
    enclose_function,
    enclosure,
    is_nonzero,
    points_inside,
    witness_nonzero,
)


def hidden_zero(field):
    """``2 sin(x) cos(x) sin(y) - (cos(x - y) - cos(x + y)) cos(x)``, which is zero."""
    x, y = field["x"], field["y"]
    sine, cosine = field.call("sin", x), field.call("cos", x)
    product = field.call("cos", x - y) - field.call("cos", x + y)
    return 2 * sine * cosine * field.call("sin", y) - product * cosine


def test_a_hidden_zero_has_no_witness():
    """However often it is asked, no point shows a zero to be nonzero."""
    field = Field(["x", "y"], slots=4)
    zero = hidden_zero(field)
    assert witness_nonzero(field, zero) is None
    assert not is_nonzero(field, zero)


def test_a_witness_shows_its_value():
    """At the point the value differs from zero, as mpmath says on its own."""
    field = Field(["x", "y"], slots=5)
    element = hidden_zero(field) + field.call("exp", -(field["x"] ** 2)) / 10**30
    point = witness_nonzero(field, element)
    with mpmath.workdps(80):
        x, y = (mpmath.mpf(point[n].numerator) / point[n].denominator for n in "xy")
        zero = 2 * mpmath.sin(x) * mpmath.cos(x) * mpmath.sin(y)
        zero -= (mpmath.cos(x - y) - mpmath.cos(x + y)) * mpmath.cos(x)
        assert zero + mpmath.exp(-(x**2)) / mpmath.mpf(10) ** 30 > 0


def test_intervals_enclose_the_value():
    """Bounds of a sum of functions contain its value to 100 digits, and are narrow."""
    field = Field(["x", "y"], slots=4)
    x, y = field["x"], field["y"]
    element = field.call("sqrt", x) * field.call("log", y) / (field.call("sin", x) + y) - x**3
    found = enclosure(field, element, {"x": Fraction(7, 3), "y": Fraction(1, 9)}).bounds
    with mpmath.workdps(100):
        at, to = mpmath.mpf(7) / 3, mpmath.mpf(1) / 9
        value = mpmath.sqrt(at) * mpmath.log(to) / (mpmath.sin(at) + to) - at**3
        assert mpmath.mpf(found.a) <= value <= mpmath.mpf(found.b)
        assert found.delta < 1e-50


@pytest.mark.parametrize("function", ["sqrt", "sin", "cos", "exp", "log"])
def test_bounds_of_functions_contain_their_values(function):
    """At random rationals, and near multiples of pi/2, as mpmath says with 120 digits."""
    source = random.Random(6)
    with mpmath.workdps(120):
        for n in range(60):
            near = Fraction(int(n * mpmath.pi * 10**30 / 2), 10**30)
            x = abs(source.choice([near, Fraction(source.randint(-900, 900), 77)]))
            if not x:
                continue
            value = getattr(mpmath, function)(mpmath.mpf(x.numerator) / x.denominator)
            low, high = enclose_function(function, Enclosure.of(x)).bounds._mpi_
            assert mpmath.make_mpf(low) <= value <= mpmath.make_mpf(high)


def test_a_pole_is_no_value():
    """A division by what may be zero, a root or a logarithm outside its domain: no bounds."""
    field = Field(["x", "y"], slots=4)
    root = field.call("sqrt", field["x"])
    pole = field.one / (field.call("sqrt", field["x"] + 1 + 2 * root) - 1 - root)
    with pytest.raises(ZeroDivisionError):
        enclosure(field, pole, {"x": Fraction(1)})
    assert witness_nonzero(field, pole) is None
    for function in ("sqrt", "log"):
        with pytest.raises(ValueError, match="may have no value"):
            enclosure(field, field.call(function, field["y"]), {"y": Fraction(-1)})


def test_numbers_too_large_to_write_are_undefined():
    """The exponential of a million has no bounds, and costs no time."""
    field = Field(["x"], slots=4)
    tower = field["x"] ** 2 + 10
    for _ in range(3):
        tower = field.call("exp", tower)
    with pytest.raises(ValueError, match="exp of"):
        enclosure(field, tower, {"x": Fraction(9)})
    assert witness_nonzero(field, tower) is None


@pytest.mark.parametrize("text", ["far", "thin", "ball", "declared"])
def test_points_lie_inside_the_domain(text):
    """Points are found far out, in a thin slab, in a small ball, and where conditions hold."""
    names = [f"x{n}" for n in range(6)]
    field = Field(names, slots=4, positive=["x1"])
    x = field["x0"]
    inside = {
        "far": x - 1234,
        "thin": (x - 100) * (101 - x),
        "ball": 1 - field.sum(field[name] ** 2 for name in names) * 1000,
        "declared": x,
    }[text]
    if text == "declared":
        field.assume([Condition(field["x1"] - field["x0"] - 300, strict=True)])
    element = field.call("sqrt", inside) * x
    points = [point for point, _ in zip(points_inside(field, [element]), range(5), strict=False)]
    assert len(points) == 5
    for point in points:
        assert field.evaluate(inside, point, Fraction, None) > 0
        assert point.get("x1", 1) > 0
        for each in field.region.conditions:
            assert field.evaluate(each.element, point, Fraction, None) > 0
    assert is_nonzero(field, element)


def test_nothing_is_found_in_an_empty_domain():
    """sqrt(-1 - x^2) has no value anywhere, so nothing shows that it is not zero."""
    field = Field(["x"], slots=2)
    assert witness_nonzero(field, field.call("sqrt", -(field["x"] ** 2) - 1)) is None


def test_the_sign_of_an_interval_around_zero_is_none():
    """Bounds that straddle zero say nothing."""
    third = Enclosure.of(Fraction(1, 3))
    assert third.sign == 1
    assert (third + Enclosure.of(-1) * third).sign == 0
    with pytest.raises(ZeroDivisionError):
        third / (third + Enclosure.of(-1) * third)


def test_an_empty_domain_hides_no_analytic_function():
    """With conditions that contradict each other, x - 1 is shown not to be zero all the same."""
    field = Field(["x"], slots=2)
    x = field["x"]
    field.assume([Condition(x, strict=True), Condition(-x, strict=True)])
    assert witness_nonzero(field, x - 1)["x"] != 1
    assert witness_nonzero(field, field.call("exp", x) - 1)
    assert witness_nonzero(field, field.call("sqrt", x) - 1) is None


def test_defaults_lead_into_a_domain_that_is_hard_to_find():
    """sin(50 x) > 0.9999 for x near 10^4: a default lies inside, and no step leads there."""
    field = Field(["x", "y"], slots=3)
    x = field["x"]
    narrow = field.call("sin", 50 * x) - Fraction(9999, 10000)
    inside = (narrow, 1 - (x - 10**4) ** 2)
    element = field.sum(field.call("sqrt", each) for each in inside) * field["y"]
    assert witness_nonzero(field, element) is None
    default = next(
        Fraction(10**7 + n, 1000)
        for n in range(1000)
        if mpmath.sin(50 * (mpmath.mpf(10**7 + n) / 1000)) > 0.99995
    )
    field.region = Region(defaults={"x": default})
    assert abs(witness_nonzero(field, element)["x"] - 10**4) < 1
