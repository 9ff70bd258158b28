"""The oracle: 50 digits under cancellation, envelopes that bound what rounding does."""

import decimal
import math
from decimal import Decimal, localcontext
from fractions import Fraction
from itertools import product

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from coadjoint.crosscheck import oracle as oracle_module
from coadjoint.crosscheck.oracle import (
    CONTEXT,
    Bounded,
    OutsideDomain,
    call,
    error_in_envelopes,
    errors,
    exact,
    oracle,
    take,
)
from coadjoint.elementary import ELEMENTARY
from coadjoint.lower.evaluation import evaluate
from coadjoint.lower.program import FUNCTIONS
from tests.kernels import ProgramReference
from tests.programs import program
from tests.trees import NAMES, trees


def one_output(text, inputs, **values):
    """The oracle's answer for one expression."""
    reference = ProgramReference([program("rhs", " ".join(inputs), "", "", text, (1,))])
    return oracle(reference, "rhs", values)[0]


def test_cancellation_loses_no_digits():
    """(1 + u) - 1 with u = 2^-80 has all its digits, where doubles have none."""
    bounded = one_output("(x*x + y) - x*x", "xy", x=1.0, y=2.0**-80)
    assert abs(bounded.value - decimal.Decimal(2.0**-80)) < decimal.Decimal("1e-50")
    # Each of the two squares moves by twice what x moves by.
    assert float(bounded.envelope) == pytest.approx(4.0, abs=1e-9)


def test_fifty_digits_of_every_function():
    """Each elementary function agrees with mpmath at 80 digits to 50."""
    with mpmath.workdps(80):
        for function, entry in ELEMENTARY.items():
            names = "xy"[: entry.arity]
            value = one_output(f"{function}({', '.join(names)})", "xy", x=0.7345, y=-0.25).value
            arguments = map(mpmath.mpf, (0.7345, -0.25)[: entry.arity])
            wanted = getattr(mpmath, function)(*arguments)
            assert abs(mpmath.mpf(str(value)) / wanted - 1) < mpmath.mpf(10) ** -50


@pytest.mark.parametrize("function", [f for f in FUNCTIONS if f != "atan2"])
def test_envelopes_grow_with_the_slope(function):
    """The envelope of f(u) is |f(u)| + |f'(u)| envelope(u)."""
    slopes = {
        "sqrt": lambda u: 0.5 / math.sqrt(u),
        "sin": math.cos,
        "cos": math.sin,
        "exp": math.exp,
        "log": lambda u: 1 / u,
        "sinh": math.cosh,
        "cosh": math.sinh,
        "tanh": lambda u: 1 / math.cosh(u) ** 2,
        "asin": lambda u: 1 / math.sqrt(1 - u**2),
        "acos": lambda u: 1 / math.sqrt(1 - u**2),
        "asinh": lambda u: 1 / math.sqrt(1 + u**2),
        "atanh": lambda u: 1 / (1 - u**2),
        "atan": lambda u: 1 / (1 + u**2),
        "sign": lambda u: 0.0,
    }
    u = 0.7345
    bounded = one_output(f"{function}(x + y - y)", "xy", x=u, y=100.0)
    value = 1.0 if function == "sign" else getattr(math, function)(u)
    wanted = abs(value) + abs(slopes[function](u)) * (u + 200.0)
    assert float(bounded.envelope) == pytest.approx(
        wanted, rel=1e-14
    )  # a few operations of doubles


def test_the_envelope_of_an_angle_has_both_slopes():
    """The gradient of atan2(y, x) is (x, -y)/(x^2 + y^2): the slopes in the order of arguments."""
    bounded = one_output("atan2(y + z - z, x)", "xyz", x=-2.0, y=1.5, z=100.0)
    square = 2.0**2 + 1.5**2
    wanted = math.atan2(1.5, -2.0) + 2.0 / square * (1.5 + 200.0) + 1.5 / square * 2.0
    assert float(bounded.envelope) == pytest.approx(wanted, rel=1e-14)  # as above


def test_a_division_amplifies_by_its_condition():
    """The envelope of a/b is envelope(a)/|b| and |a/b| times envelope(b)/|b|."""
    bounded = one_output("x/(y - 1)", "xy", x=3.0, y=1.5)
    wanted = 3 / 0.5 + 3 / 0.5 * (2.5 / 0.5)
    assert float(bounded.envelope) == pytest.approx(wanted, rel=1e-14)  # as above


def test_relative_errors_of_factors_add():
    """The envelope of a product is |a| envelope(b) + |b| envelope(a), not their product."""
    bounded = one_output("(x - 1)*(y - 1)", "xy", x=1.25, y=1.5)
    assert float(bounded.envelope) == 0.25 * 2.5 + 0.5 * 2.25


def test_the_product_of_two_rounding_errors_is_one():
    """Both factors are 0 exactly and 1e-16 in doubles: an error of 1e-16 in their product shows."""
    turn = "(sin({0})*sin({0}) + cos({0})*cos({0}) - 1)"
    bounded = one_output(f"{turn.format('x')}*{turn.format('y')}", "xy", x=FIRST, y=SECOND)
    one, two = (math.sin(x) ** 2 + math.cos(x) ** 2 - 1 for x in (FIRST, SECOND))
    assert one * two != 0
    assert error_in_envelopes(one * two, bounded) < 4
    assert error_in_envelopes(one, bounded) > 1e14


#: Where a sine and a cosine in doubles miss the unit circle.
FIRST, SECOND = 0.125, 0.25


@pytest.mark.parametrize(
    ("text", "x"),
    [
        ("1/x", 0.0),
        ("1/(x - x)", 2.0),
        ("1/((x + 1) - x - 1)", 1.0),
        ("sqrt(x)", -1.0),
        ("log(x)", 0.0),
        ("sqrt(x - x)", 1.0),
        ("exp(x)", 1e300),
        ("exp(x)", -800.0),
        ("log(x)", -1.0),
        ("sinh(x)", 800.0),
        ("asin(x)", 1.5),
        ("asin(x)", 1.0),  # no slope
        ("acos(x + 1 - 1)", -1.0),
        ("atan2(x, x)", 0.0),
        ("atan2(x - x, -x)", 1.0),  # at the cut
        ("atan2((x + 1) - x - 1, -x)", 1.0),
    ],
)
def test_points_without_a_value_are_rejected(text, x):
    """A point is rejected where a divisor or argument may be pure rounding error."""
    with pytest.raises(OutsideDomain):
        one_output(text, "x", x=x)


def test_the_square_root_of_an_exact_zero_is_zero():
    """An exact zero has a root; a zero by cancellation is rejected."""
    assert one_output("sqrt(x)", "x", x=0.0).value == 0


def test_sign_errors_exceed_every_threshold():
    """The k of a wrong sign is about 1e16, of float32 inside about 1e8; of a rounding at most 1."""
    bounded = one_output("x*y", "xy", x=1.1, y=1.3)
    assert error_in_envelopes(1.1 * 1.3, bounded) <= 1
    assert error_in_envelopes(-1.1 * 1.3, bounded) > 1e15
    assert error_in_envelopes(float(np.float32(1.1) * np.float32(1.3)), bounded) > 1e7
    assert error_in_envelopes(math.inf, bounded) == math.inf


def test_the_floor_is_one_subnormal():
    """A result that rounds to zero below all doubles has an error below one unit."""
    assert error_in_envelopes(0.0, one_output("x*x", "x", x=2.0**-600)) <= 1


def test_ulp_are_counted_only_without_cancellation():
    """Units of the last place are given for a product and not for a difference that cancels."""
    assert errors(1.0 + 2.0**-51, exact(1.0))[1] == 2.0
    assert errors(5.0, one_output("x - y", "xy", x=1.0, y=1.0 - 2.0**-30))[1] == 0.0


def test_global_precision_is_unchanged():
    """Neither mpmath's nor decimal's global precision is changed by an evaluation."""
    before = (mpmath.mp.dps, decimal.getcontext().prec)
    one_output("sin(x)", "x", x=1.0)
    assert (mpmath.mp.dps, decimal.getcontext().prec) == before


@settings(deadline=None)
@given(trees(functions=("sqrt",)), st.integers(0, 1000))
def test_double_evaluation_stays_within_its_operations(tree, seed):
    """In doubles, a tree is off by less than its operations, in units of the envelope."""
    generator = np.random.default_rng(seed)
    values = dict(zip(NAMES, generator.normal(size=len(NAMES)).tolist(), strict=True))
    try:
        with decimal.localcontext(decimal.Context(prec=60)):
            known = {name: exact(value) for name, value in values.items()}
            bounded = evaluate(tree, known, exact, call)
    except (OutsideDomain, ArithmeticError):
        return
    if not 1e-200 < bounded.envelope < 1e200:
        return
    doubles = {name: np.float64(value) for name, value in values.items()}
    with np.errstate(all="ignore"):
        computed = evaluate(tree, doubles, np.float64, lambda function, u: np.sqrt(u))
    # Each of at most 80 operations and 40 constants adds one rounding; second order is below 1 %.
    assert error_in_envelopes(float(computed), bounded) <= 122


def test_constants_are_exact_rationals():
    """A third is a third to 50 digits, not the double next to it."""
    third = exact(Fraction(1, 3)).value
    assert abs(third * 3 - 1) < decimal.Decimal("1e-50")
    assert third != exact(1 / 3).value


def find_products():
    """Products of numbers that cancelled by 0 to 40 digits, beside their sizes by the formula."""
    numbers = [Bounded(Decimal(0), Decimal(size)) for size in ("0", "1e-3", "7")]
    for digits in range(41):
        for value in ("1", "-9.99", "3.7e200"):
            number = Decimal(value)
            numbers.append(Bounded(number, abs(number).scaleb(digits) * Decimal("1.5")))
    found = []
    with localcontext(CONTEXT):
        for one, other in product(numbers, repeat=2):
            size = abs(one.value) * other.envelope + abs(other.value) * one.envelope
            both = Decimal(2.0**-53) * one.envelope * other.envelope
            found.append((one * other, Bounded(one.value * other.value, max(size, both))))
    return [a == b for a, b in found]


def test_products_have_their_sizes_however_much_factors_cancel(monkeypatch):
    """What is not looked at would never be the larger one; a wider margin leaves out some."""
    same = find_products()
    assert len(same) == (3 + 3 * 41) ** 2
    assert all(same)
    monkeypatch.setattr(oracle_module, "_KNOWN", 20)
    assert not all(find_products())


def test_zeros_of_both_signs_stay_apart():
    """The same doubles are taken once, and zeros each time."""
    pairs = [(each, take(each).value) for each in (0.0, -0.0, 0.0, 1.5, -1.5, 1.5)]
    for double, taken in pairs:
        assert float(taken) == double
        assert math.copysign(1.0, taken) == math.copysign(1.0, double)
    assert take(1.5) is take(1.5)
