"""Columns: the oracle at many points at a time is the oracle at each of them."""

from contextlib import suppress
from decimal import Decimal, localcontext
from fractions import Fraction

import numpy as np
import pytest

from coadjoint.crosscheck import columns
from coadjoint.crosscheck.columns import Column, find_exact
from coadjoint.crosscheck.oracle import CONTEXT, OutsideDomain, oracle
from coadjoint.derive.mechanics.iteration import SETTLE, SETTLE_LAST
from coadjoint.exact.factored import factor


class Formulas:
    """A reference of one function, by what it computes of its inputs."""

    def __init__(self, formulas):
        self.formulas = formulas

    def evaluate(self, function, inputs, number, call):
        """All outputs."""
        return self.formulas(number=number, call=call, **inputs)


def one_by_one(reference, points):
    """What the oracle has at each point."""
    found = {}
    for n in range(len(points["x"])):
        with suppress(OutsideDomain):
            inputs = {name: float(row[n]) for name, row in points.items()}
            found[n] = oracle(reference, "f", inputs)
    return found


def compare(reference, points):
    """Points and outputs that agree: values to the last digit.

    Envelopes are read to two digits. A sum is followed in doubles down to 2^-30 of its envelope,
    where it still has 23 bits: errors are about 1e-7, times a few operations.
    """
    expected, found = one_by_one(reference, points), find_exact(reference, "f", points)
    assert found.keys() == expected.keys()
    count = 0
    for n, outputs in expected.items():
        for one, other in zip(found[n], outputs, strict=True):
            assert one.value == other.value
            with localcontext(CONTEXT):
                assert abs(one.envelope - other.envelope) <= Decimal("1e-6") * other.envelope
            count += 1
    return len(found), count


def draw(count, scale=1.0):
    """Random points, every fifth with a zero."""
    source = np.random.default_rng(3)
    x, y, z = scale * source.normal(size=(3, count))
    x[::5] = 0.0
    return {"x": x, "y": y, "z": z}


def arithmetic(number, call, x, y, z):
    """Sums that cancel, products of what cancels, quotients, and constants alone."""
    third, large = number(Fraction(1, 3)), number(Fraction(2**60))
    gone = (x + large) + -(y + large)
    return [
        (x * x + -(y * y)) / (z + third),
        gone * gone,
        gone * (x + -x) + x,
        third * third + large,
        -x,
        x.zero(),
    ]


@pytest.mark.parametrize("scale", [1.0, 1e-30, 1e30])
def test_arithmetic(scale):
    """More points than a column has."""
    points = draw(2 * columns.SIZE + 7, scale)
    assert compare(Formulas(arithmetic), points) == (len(points["x"]), 6 * len(points["x"]))


def test_functions_and_where_they_have_no_value():
    """The root and the logarithm of what is negative are left out, as one by one."""

    def formulas(number, call, x, y, z):
        return [call("sqrt", x), call("sin", y * z), call("log", y), call("atan2", x, z)]

    points = draw(200)
    reached, count = compare(Formulas(formulas), points)
    assert count == 4 * reached
    assert 20 < reached < 80  # about 60: y is positive at half of them, x no less than 0 at 3/5


def test_quotients_by_what_may_be_nothing_are_left_out():
    """Where rounding alone may be the divisor."""

    def formulas(number, call, x, y, z):
        large = number(Fraction(2**80))
        return [y / ((x + large) + -large), y / (z + number(Fraction(1)))]

    points = draw(60)
    points["x"][1::5] *= 2.0**60
    reached, _ = compare(Formulas(formulas), points)
    assert reached == 12  # those made large: their envelopes are 2^21 of them, the others' 2^81


def test_what_is_settled_is_as_if_it_were_given():
    """Both words that arithmetics know."""

    def formulas(number, call, x, y, z):
        rough = (x + number(Fraction(2**20))) + -number(Fraction(2**20))
        return [rough, call(SETTLE, rough), call(SETTLE_LAST, rough)]

    assert compare(Formulas(formulas), draw(50)) == (50, 150)


@pytest.mark.parametrize("scale", [1e-300, 1e300])
def test_envelopes_that_doubles_do_not_hold(scale):
    """Such points are evaluated one by one."""
    points = draw(40, scale)
    points["y"][::2] = 1.0

    def formulas(number, call, x, y, z):
        product = (x * x * y + z) * (z * z)
        return [product, product / z]

    reached, _ = compare(Formulas(formulas), points)
    assert reached == 40


def test_equations_that_are_solved_are_so_point_by_point():
    """A column has no loop over rows."""

    def formulas(number, call, x, y, z):
        one = number(Fraction(5))
        return factor([one + x * x, y, one + z * z]).solve([x, z])

    points = draw(30)
    assert compare(Formulas(formulas), points) == (30, 60)


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("__add__", lambda a, b: Column(a.values + b.values, a.near + b.near, a.wide, a.fate)),
        ("__neg__", lambda a: Column(-a.values, a.near, a.wide, a.fate)),
        ("__mul__", lambda a, b: Column(a.values * b.values, a.near * b.near, a.wide, a.fate)),
    ],
)
def test_a_wrong_column_differs(monkeypatch, name, wrong):
    """An envelope that is lost, and a sign."""
    monkeypatch.setattr(Column, name, wrong)
    with pytest.raises(AssertionError):
        compare(Formulas(arithmetic), draw(40))
