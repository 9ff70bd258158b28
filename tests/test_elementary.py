"""The table of elementary functions: each entry against mpmath, which knows nothing of it."""

from dataclasses import replace
from fractions import Fraction

import mpmath
import numpy as np
import pytest

from coadjoint import elementary
from coadjoint.crosscheck.recurrences import ORDER, bounded_coefficients
from coadjoint.crosscheck.series import solve
from coadjoint.elementary import ELEMENTARY, Arithmetic, evaluate, jump_of, slopes_of
from coadjoint.exact.witness import INTERVALS, Enclosure, enclose_function
from coadjoint.render.solvers import arrange
from tests.kernels import ProgramReference
from tests.programs import program

REAL = Arithmetic(
    number=lambda x: mpmath.mpf(x.numerator) / x.denominator,
    call=lambda name, *of: getattr(mpmath, name)(*of),
)
#: Arguments at which each function of one or two arguments has a value.
POINTS = [(Fraction(3, 10), Fraction(-7, 10)), (Fraction(9, 11), Fraction(2, 3))]
#: Names as a test has them, apart from those of one function alone.
WORDS = list(ELEMENTARY)


def check_slopes(function, digits=30):
    """The slopes of a function are its numerical derivatives."""
    entry = ELEMENTARY[function]
    with mpmath.workdps(digits + 20):
        for point in POINTS:
            of = tuple(map(REAL.number, point[: entry.arity]))
            slopes = slopes_of(function, of, REAL.call(function, *of), REAL)
            assert len(slopes) == entry.arity
            for place, slope in enumerate(slopes):
                order = tuple(int(n == place) for n in range(entry.arity))
                wanted = mpmath.diff(getattr(mpmath, function), of, order)
                assert abs(slope - wanted) < mpmath.mpf(10) ** -digits, (function, place)


@pytest.mark.parametrize("function", WORDS)
def test_slopes_are_derivatives(function):
    """By each argument, at points on both sides of 0."""
    check_slopes(function)


def test_a_spoiled_slope_is_seen(monkeypatch):
    """The check above fails where a slope is that of another function."""
    spoiled = replace(ELEMENTARY["asin"], slopes=("1/(1 - u*u)",))
    monkeypatch.setitem(elementary._TABLE, "asin", spoiled)
    with pytest.raises(AssertionError, match="asin"):
        check_slopes("asin")


@pytest.mark.parametrize("function", WORDS)
def test_facts_hold_in_numbers(function):
    """Parity, value at 0, square, sign and size."""
    entry, value = ELEMENTARY[function], getattr(mpmath, function)
    with mpmath.workdps(30):
        if entry.at_zero is not None:
            assert value(0) == entry.at_zero
        for u in (mpmath.mpf("0.3"), mpmath.mpf("0.8")):
            if entry.parity:
                assert value(-u) == entry.parity * value(u)
            if entry.square:
                p = getattr(mpmath, entry.partner)(u) if entry.partner else None
                assert mpmath.almosteq(value(u) ** 2, evaluate(entry.square, REAL, u=u, p=p))
            if entry.is_positive:
                assert value(-40 * u) > 0
            if entry.is_bounded:
                assert abs(value(40 * u)) <= 1
    assert getattr(np, entry.numpy_name)(*[0.5] * entry.arity) == pytest.approx(
        float(value(*[0.5] * entry.arity)), rel=1e-15
    )


@pytest.mark.parametrize("function", WORDS)
def test_bounds_hold_the_value(function):
    """Interval bounds are narrow, and hold the value that mpmath has with more digits."""
    entry = ELEMENTARY[function]
    for point in POINTS:
        bounds = enclose_function(function, *map(Enclosure.of, point[: entry.arity])).bounds
        with mpmath.workdps(80):
            value = getattr(mpmath, function)(*map(REAL.number, point[: entry.arity]))
            low, high = mpmath.mpf(bounds.a), mpmath.mpf(bounds.b)
            assert low <= value <= high
            assert high - low < mpmath.mpf(10) ** -55


@pytest.mark.parametrize(
    ("function", "pairs"),
    [
        ("sign", [(-1, 1)]),
        ("asin", [(0.5, 1.5)]),
        ("acos", [(-1, 0)]),
        ("atan2", [(-1, 1), (-2, -1)]),
        ("atan2", [(-1, 1), (-1, 1)]),
    ],
)
def test_no_bounds_across_a_jump_or_an_edge(function, pairs):
    """An interval that holds one may have no value, or two."""
    intervals = [Enclosure(INTERVALS.mpf(list(pair))) for pair in pairs]
    with pytest.raises(ValueError, match="no value"):
        enclose_function(function, *intervals)


def test_an_angle_next_to_the_cut_has_bounds():
    """The cut is on the negative side alone: (1, 0) has the angle 0."""
    y, x = (Enclosure(INTERVALS.mpf(pair)) for pair in ([-1, 1], [2, 3]))
    bounds = enclose_function("atan2", y, x).bounds
    assert bounds.a < 0 < bounds.b
    assert jump_of("atan2", (0, -1)) == (0, -1)
    assert jump_of("sin", (0,)) == (None, None)


#: Rates of x in which a function stands as motions have it: alone, nested, of constants.
MOTIONS = {
    **{name: f"1/2 + {name}(x/3)" for name, entry in ELEMENTARY.items() if entry.arity == 1},
    "atan2": "atan2(x, y)",
    "atan2 of a constant": "atan2(k, x*y) + atan2(x, 2)",
    "nested": "asin(tanh(x)/2)*cosh(atan(x - y)) - acos(x*y/9)",
    "twice": "tanh(x) + tanh(x)*sinh(x) + cosh(x)",
}


def gap_of_series(text):
    """How far recurrences are from power series that differentiate mpmath's functions."""
    rhs = program("rhs", "x y", "k", "", f"{text}; x*y - 1", (2,))
    state, given = {"x": 0.75, "y": -0.5}, {"k": (1.5,)}

    def rates(values, number, call):
        return ProgramReference([rhs]).evaluate("rhs", values, number, call)

    wanted = solve(rates, state, given, ORDER)
    found = bounded_coefficients(arrange({"rates": rhs}), state, given, ORDER)
    return max(
        abs(a.value - b) for name in state for a, b in zip(found[name], wanted[name], strict=True)
    )


@pytest.mark.parametrize("name", MOTIONS)
def test_recurrences_are_power_series(name):
    """Each word has the Taylor coefficients that its numerical derivatives give."""
    assert gap_of_series(MOTIONS[name]) < 1e-45


def test_a_spoiled_recurrence_is_seen(monkeypatch):
    """The derivative of a function is that of its recurrence, and nothing of the series."""
    spoiled = replace(ELEMENTARY["atan"], slopes=("1/(2 + u*u)",))
    monkeypatch.setitem(elementary._TABLE, "atan", spoiled)
    assert gap_of_series(MOTIONS["atan"]) > 1e-6
