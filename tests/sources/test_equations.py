"""Derived equations against the formulas of books, exactly, by every route."""

from fractions import Fraction
from importlib import import_module
from math import prod

import pytest
import sympy

from coadjoint.prove.ideals import Ideal
from coadjoint.spec.routes import ROUTES
from tests.conftest import ROUTES_OF, SYSTEMS, rational_points
from tests.sources import textbook
from tests.sources.points import DIGITS
from tests.specs import derived, emitted

BY_ROUTE = [(name, route) for name in SYSTEMS for route in ROUTES_OF[name]]
#: Certificates prove that other routes give the motion of the first one; here some of them again.
REGULAR = {
    pair for route in ROUTES for pair in [each for each in BY_ROUTE if each[1] == route][:3]
} | {(name, ROUTES_OF[name][0]) for name in SYSTEMS}
each_route = pytest.mark.parametrize(
    ("name", "route"),
    [
        pytest.param(*pair, marks=() if pair in REGULAR else pytest.mark.campaign)
        for pair in BY_ROUTE
    ],
)
#: A unit quaternion, for charts whose only relation is that.
UNIT = {f"q{n}": Fraction(part, 5) for n, part in enumerate((1, 2, 2, 4))}


def fraction(number):
    """A rational number of SymPy as a fraction; another one as it is."""
    return Fraction(int(number.p), int(number.q)) if number.is_Rational else number


def values(expressions, point):
    """SymPy expressions at a rational point, as fractions where sums, products and powers are.

    What occurs in several of them is computed once, and without SymPy's own numbers.
    """
    known = {sympy.Symbol(n): fraction(sympy.sympify(v)) for n, v in point.items()}

    def value(expression):
        if expression not in known:
            parts = [value(part) for part in expression.args]
            known[expression] = combined(expression, parts)
        return known[expression]

    found = [value(sympy.sympify(e)) for e in expressions]
    assert all(isinstance(x, Fraction) or x.is_number for x in found), found
    return found


def combined(expression, parts):
    """An expression with values in the places of its parts."""
    if parts and all(isinstance(part, Fraction) for part in parts):
        if expression.is_Add:
            return sum(parts)
        if expression.is_Mul:
            return prod(parts)
        if expression.is_Pow and parts[1].denominator == 1:
            return parts[0] ** int(parts[1])
    return fraction(expression.func(*map(sympy.sympify, parts)) if parts else expression)


def same(found, expected):
    """Exactly where values are rational; to 40 digits where functions make them irrational."""
    pairs = list(zip(found, expected, strict=True))
    rational = all(
        # of what is typed to 80 digits the denominators tell
        isinstance(a, Fraction) and Fraction(b).denominator < 10 ** (DIGITS // 2)
        for a, b in pairs
    )
    small = Fraction(0) if rational else Fraction(1, 10**40)
    return all(abs(digits(a) - b) <= small * max(1, abs(b)) for a, b in pairs)


def digits(value):
    """A number to 60 digits as a fraction; a rational one as it is."""
    return value if isinstance(value, Fraction) else Fraction(str(value.evalf(60)))


def points(name, count):
    """Exact random points, each with its values of the state, and of what else is given."""
    state, parameters = textbook.STATES[name], textbook.GIVEN[name]
    for free in rational_points((*state, *parameters), count):
        point = textbook.rational(name, free)
        yield point, [point[n] for n in state], [point[n] for n in parameters]


def check_rates(equations, name):
    """Rates at exact random points equal the book's; of a chart, at the images of its points."""
    moved = equations.rates if equations.chart is None else carried(equations)
    for point, x, p in points(name, 5) if equations.chart is None else in_chart(equations, name, 5):
        expected = textbook.RATES[name](x, p)
        assert any(expected)
        assert same(values(moved, solved(equations, point)), expected)


def solved(equations, point):
    """A point with the values of what the kernel solves for, one after the other.

    Newton's iteration has its end at the velocities of the book: the step after it stays there.
    """
    for newton in equations.iterations:
        parts = textbook.OBSERVABLES[equations.spec.name](
            [point[n] for n in textbook.STATES[equations.spec.name]],
            [point[n] for n in textbook.GIVEN[equations.spec.name]],
        )
        names = [equations.setting.velocities[place] for place in newton.block]
        found = [sympy.sympify(parts[name]).evalf(DIGITS) for name in names]
        point = point | dict(zip(newton.names, found, strict=True))
    for name in equations.kept:
        (value,) = values([equations.velocities[name]], point)
        # nested roots and sines would grow exponentially
        point = point | {name: value if isinstance(value, Fraction) else value.evalf(80)}
    return point


def carried(equations):
    """How the declared state moves by a route in variables of its own, as sums of its slopes."""
    image = map(equations.setting.field.to_sympy, equations.chart.state)
    pairs = list(zip(equations.state, equations.rates, strict=True))
    return [sum(sympy.diff(value, v) * rate for v, rate in pairs) for value in image]


def in_chart(equations, name, count):
    """Exact random points of a chart where its relations hold, each with its state."""
    setting, chart = equations.setting, equations.chart
    field, parameters = setting.field, textbook.GIVEN[name]
    relations = [relation.element for relation in chart.relations]
    domain = Ideal(field, relations, variables=chart.variables)
    for free in rational_points((*chart.variables, *parameters), count):
        point = free | UNIT
        if domain.is_solved:
            pairs = domain.solved.items()
            point = free | {name: field.evaluate(x, free, Fraction, None) for name, x in pairs}
        assert not any(values(map(field.to_sympy, relations), point))
        x = values(map(field.to_sympy, chart.state), point)
        yield point, x, [point[n] for n in parameters]


def shipped_functions(name):
    """Names of the functions of a shipped system."""
    return import_module(f"coadjoint.systems.{name}").system.functions


def test_every_system_and_route_is_visited():
    """The book's formulas are there for each spec on disk, and no route goes without one."""
    for table in (textbook.RATES, textbook.OBSERVABLES, textbook.STATES):
        assert sorted(table) == sorted(SYSTEMS) == sorted(textbook.PARAMETERS)
    without = {name for name in SYSTEMS if "poisson_tensor" not in shipped_functions(name)}
    assert set(textbook.TENSORS) == set(SYSTEMS) - without
    assert {route for _, route in BY_ROUTE} == set(ROUTES)


@each_route
def test_rates_are_those_of_the_book(name, route):
    """Each route gives the textbook equations of motion."""
    check_rates(derived(name)[route], name)


@pytest.mark.parametrize("name", SYSTEMS)
def test_names_and_order_are_the_contract(name):
    """State and parameters stand in the declared order under their names."""
    setting = emitted(name).setting
    assert setting.state == textbook.STATES[name]
    assert setting.parameters == textbook.PARAMETERS[name]
    assert (*setting.inputs, *setting.time) == textbook.DRIVING.get(name, ())


@each_route
def test_poisson_tensor_is_that_of_the_book(name, route):
    """{x_i, x_j} in the tables of Holm (2011), 2.5, 4.3.3, 6.4 to 6.6, 7.1.2, 8.3.2 and C.4."""
    equations = derived(name)[route]
    tensor = list(equations.poisson_tensor or ())
    assert bool(tensor) == (name in textbook.TENSORS and equations.chart is None)
    for point, x, p in points(name, 3) if tensor else ():
        expected = [e for row in textbook.TENSORS[name](x, p) for e in row]
        assert same(values(tensor, point), expected)


@each_route
def test_observables_are_those_of_the_book(name, route):
    """Energy, Casimirs and velocities, under their names."""
    equations = derived(name)[route]
    found = equations.observables
    if equations.chart is not None:  # it shows its energy alone
        assert set(found) <= {"energy"}
        return
    for point, x, p in points(name, 3):
        expected = textbook.OBSERVABLES[name](x, p)
        assert set(expected) == set(found)
        at = solved(equations, point)  # reactions among it, which may be long in the state alone
        shown = {n: value for n, value in found.items() if n not in at}
        told = [n for n in shown if set(map(str, shown[n].free_symbols)) <= set(at)]
        assert len(told) == len(shown) or route == "hamel"  # which knows no multipliers
        given = at | dict(zip(told, values([shown[n] for n in told], at), strict=True))
        known = [n for n in expected if n in given]
        assert same([given[n] for n in known], [expected[n] for n in known])


# -- closed forms of the motion -------------------------------------------------------------------


def check_solution(name, solution, slopes):
    """A curve obeys the derived equations.

    Args:
        name: The system.
        solution: The state as polynomials in symbols.
        slopes: The time derivative of each of these symbols.
    """
    equations = emitted(name)
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
        check_rates(emitted("heavy_top"), "kirchhoff")


@pytest.mark.parametrize("name", SYSTEMS)
def test_the_comparison_sees_reversed_time(name):
    """Invariants cannot see motion that runs backwards; this comparison does."""
    equations = emitted(name)
    backwards = textbook.RATES[name]
    for point, x, p in points(name, 1):
        found = values(equations.rates, solved(equations, point))
        assert not same(found, [-rate for rate in backwards(x, p)])
