"""Derived equations against the formulas of books, exactly, by every route."""

from fractions import Fraction

import pytest
import sympy

from coadjoint.derive import ROUTES, derive, make_setting
from tests.conftest import SYSTEMS, rational_points
from tests.sources import textbook
from tests.specs import shipped

BY_ROUTE = [(name, route) for name in SYSTEMS for route in shipped(name).routes]


def values(expressions, point):
    """SymPy expressions at a rational point, as fractions."""
    at = {sympy.Symbol(n): sympy.Rational(v.numerator, v.denominator) for n, v in point.items()}
    found = [sympy.sympify(e).xreplace(at) for e in expressions]
    assert all(value.is_Rational for value in found), found
    return [Fraction(int(value.p), int(value.q)) for value in found]


def points(name, count):
    """Exact random points, each with its values of state and parameters."""
    state, parameters = textbook.STATES[name], textbook.PARAMETERS[name]
    for point in rational_points((*state, *parameters), count):
        yield point, [point[n] for n in state], [point[n] for n in parameters]


def check_rates(equations, name):
    """Rates at exact random points equal the book's."""
    for point, x, p in points(name, 5):
        expected = textbook.RATES[name](x, p)
        assert any(expected)
        assert values(equations.rates, point) == expected


def test_every_system_and_route_is_visited():
    """The book's formulas are there for each spec on disk, and no route goes without one."""
    for table in (textbook.RATES, textbook.OBSERVABLES, textbook.TENSORS, textbook.STATES):
        assert sorted(table) == sorted(SYSTEMS) == sorted(textbook.PARAMETERS)
    assert {route for _, route in BY_ROUTE} == set(ROUTES)


@pytest.mark.parametrize(("name", "route"), BY_ROUTE)
def test_rates_are_those_of_the_book(name, route):
    """Each route gives the textbook equations of motion."""
    check_rates(derive(shipped(name), route), name)


@pytest.mark.parametrize("name", SYSTEMS)
def test_names_and_order_are_the_contract(name):
    """State and parameters stand in the declared order under their names."""
    setting = make_setting(shipped(name))
    assert setting.state == textbook.STATES[name]
    assert setting.parameters == textbook.PARAMETERS[name]


@pytest.mark.parametrize(("name", "route"), BY_ROUTE)
def test_poisson_tensor_is_that_of_the_book(name, route):
    """{x_i, x_j} in the tables of Holm (2011), 2.5, 4.3.3, 6.4 to 6.6, 7.1.2, 8.3.2 and C.4."""
    tensor = list(derive(shipped(name), route).poisson_tensor)
    for point, x, p in points(name, 3):
        assert values(tensor, point) == [e for row in textbook.TENSORS[name](x, p) for e in row]


@pytest.mark.parametrize(("name", "route"), BY_ROUTE)
def test_observables_are_those_of_the_book(name, route):
    """Energy, Casimirs and velocities, under their names."""
    found = derive(shipped(name), route).observables
    for point, x, p in points(name, 3):
        expected = textbook.OBSERVABLES[name](x, p)
        assert set(expected) == set(found)
        assert values([found[n] for n in expected], point) == list(expected.values())


# -- closed forms of the motion -------------------------------------------------------------------


def check_solution(name, solution, slopes):
    """A curve obeys the derived equations.

    Args:
        name: The system.
        solution: The state as polynomials in symbols.
        slopes: The time derivative of each of these symbols.
    """
    equations = derive(shipped(name))
    at = dict(zip(equations.state, solution, strict=True))
    for value, rate in zip(solution, equations.rates, strict=True):
        moved = sum(sympy.diff(value, s) * slope for s, slope in slopes.items())
        assert sympy.expand(moved - rate.xreplace(at)) == 0, (value, rate)


A, B, C, S, W = sympy.symbols("a b c s w")


@pytest.mark.parametrize("turn", [1, -1])
def test_4_3_4_coadjoint_motion_of_heisenberg_is_an_oscillator(turn):
    """mu1 + i mu2 = e^{i mu3 t} (a + i b): the other direction of turning does not pass."""
    turning = {C: -turn * W * S, S: turn * W * C}  # c = cos wt, s = sin wt
    solution = (A * C - B * S, A * S + B * C, W)
    if turn == 1:
        check_solution("heisenberg", solution, turning)
    else:
        with pytest.raises(AssertionError):
            check_solution("heisenberg", solution, turning)


@pytest.mark.parametrize("side", [1, -1])
def test_6_4_coadjoint_motion_of_se2_is_a_pendulum(side):
    """With b = (cos q, -sin q), m = dq/dt obey q'' = sin q, q from above; not -sin q."""
    m = sympy.Symbol("m")
    falling = {C: -S * m, S: C * m, m: side * S}  # c = cos q, s = sin q
    if side == 1:
        check_solution("se2_pendulum", (m, C, -S), falling)
    else:
        with pytest.raises(AssertionError):
            check_solution("se2_pendulum", (m, C, -S), falling)


def test_9_1_geodesics_of_the_affine_group_are_half_circles():
    """The curve mu = (-tanh t, 1/cosh t): body momentum along a half circle."""
    check_solution("affine_line", (-A, B), {A: B**2, B: -A * B})
    with pytest.raises(AssertionError):
        check_solution("affine_line", (A, B), {A: B**2, B: -A * B})


def test_the_comparison_sees_a_wrong_sign():
    """Exchange two systems' formulas and the comparison fails."""
    with pytest.raises(AssertionError):
        check_rates(derive(shipped("heavy_top")), "kirchhoff")


@pytest.mark.parametrize("name", SYSTEMS)
def test_the_comparison_sees_reversed_time(name):
    """Invariants cannot see motion that runs backwards; this comparison does."""
    equations = derive(shipped(name))
    backwards = textbook.RATES[name]
    for point, x, p in points(name, 1):
        assert values(equations.rates, point) != [-rate for rate in backwards(x, p)]
