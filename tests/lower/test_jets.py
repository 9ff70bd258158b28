"""Recurrences against closed forms: each function, products, quotients, time and inputs."""

from dataclasses import replace
from fractions import Fraction
from math import comb, factorial

import pytest

from coadjoint.crosscheck.recurrences import run_recurrences
from coadjoint.lower.jets import make_jets
from coadjoint.lower.program import Symbol
from coadjoint.render.recurrences import SUMS
from coadjoint.render.solvers import arrange
from tests.programs import program

ORDER = 9
#: Functions at the points where they are rational.
AT = {("sqrt", 1): 1, ("exp", 0): 1, ("log", 1): 0, ("sin", 0): 0, ("cos", 0): 1, ("sqrt", 4): 2}
half = Fraction(1, 2)


def called(function, argument):
    """A function at a point where it is rational."""
    return Fraction(AT[function, argument])


def expand(rhs, state, **given):
    """Coefficients of a motion, exact; a pair is an input and its rate."""
    first = {name: value if isinstance(value, tuple) else (value,) for name, value in given.items()}
    return run_recurrences(
        arrange({"rates": rhs}),
        {name: Fraction(value) for name, value in state.items()},
        {name: tuple(map(Fraction, values)) for name, values in first.items()},
        ORDER,
        Fraction,
        called,
    )


def rates(state, rows, parameters="", statements=""):
    """A Program of rates."""
    return program("rhs", state, parameters, statements, rows, (len(state.split()),))


def binomial(power, k):
    """The coefficient of t^k in (1 + t)^power."""
    result = Fraction(1)
    for j in range(k):
        result *= (power - j) / Fraction(j + 1)
    return result


ORDERS = range(ORDER + 1)
TANGENT = [0, 1, 0, Fraction(1, 3), 0, Fraction(2, 15), 0, Fraction(17, 315), 0, Fraction(62, 2835)]
SINE = [Fraction((0, 1, 0, -1)[k % 4], factorial(k)) for k in ORDERS]
COSINE = [Fraction((1, 0, -1, 0)[k % 4], factorial(k)) for k in ORDERS]
LOGARITHM = [0, *(Fraction((-1) ** (k + 1), k) for k in ORDERS[1:])]
#: Rates, where the motion begins, and its coefficients: of the component that is named.
CLOSED = {
    "a square: 1/(1-t)": ("x", "x*x", {"x": 1}, [1] * 10),
    "a quotient: sqrt(1+2t)": ("x", "1/x", {"x": 1}, [binomial(half, k) * 2**k for k in ORDERS]),
    "a quotient of what moves: exp(t)": (
        "x y",
        "x*y/y; y*y",
        {"x": 1, "y": 1},
        [Fraction(1, factorial(k)) for k in ORDERS],
    ),
    "the tangent": ("x", "1 + x*x", {"x": 0}, TANGENT),
    "a square root: (1+t/2)^2": ("x", "sqrt(x)", {"x": 1}, [1, 1, Fraction(1, 4), *[0] * 7]),
    "a root of a sum: sinh(t)": (
        "x",
        "sqrt(1 + x*x)",
        {"x": 0},
        [Fraction(k % 2, factorial(k)) for k in ORDERS],
    ),
    "an exponential: -log(1-t)": (
        "x",
        "exp(x)",
        {"x": 0},
        [0, *(Fraction(1, k) for k in ORDERS[1:])],
    ),
    "a logarithm: its integral": (
        "y x",
        "log(x); 1",
        {"y": 0, "x": 1},
        [0, *(LOGARITHM[k - 1] / Fraction(k) for k in ORDERS[1:])],
    ),
    "a sine": ("y x", "sin(x); 1", {"y": -1, "x": 0}, [-c for c in COSINE]),
    "a cosine": ("y x", "cos(x); 1", {"y": 0, "x": 0}, SINE),
    "a sine and a cosine: sin^2 / 2": (
        "y x",
        "sin(x)*cos(x); 1",
        {"y": 0, "x": 0},
        [
            0,
            *(
                Fraction((0, 1, 0, -1)[(k - 1) % 4] * 2 ** (k - 1), 2 * factorial(k - 1)) / k
                for k in ORDERS[1:]
            ),
        ],
    ),
    "the same root twice in a quotient": (
        "x y",
        "x*y/sqrt(y); 0",
        {"x": 1, "y": 1},
        [Fraction(1, factorial(k)) for k in ORDERS],
    ),
    "a root of a product in a quotient": (
        "x y",
        "sqrt(y)*x/(y*y); 0",
        {"x": 1, "y": 1},
        [Fraction(1, factorial(k)) for k in ORDERS],
    ),
    "a rate of nothing": ("x", "0", {"x": 3}, [3, *[0] * 9]),
}


@pytest.mark.parametrize("case", CLOSED)
def test_recurrences_give_closed_forms(case):
    """Coefficients of order 0 to 9 are those of the solution that books have."""
    names, rows, state, expected = CLOSED[case]
    assert expand(rates(names, rows), state)[names.split()[0]] == expected


def test_a_logarithm_of_a_square():
    """(log x^2)' by t with x = 1 + t is twice that of log x."""
    found = expand(rates("y x", "log(x*x); 1"), {"y": 0, "x": 1})["y"]
    assert found[1:] == [2 * LOGARITHM[k - 1] / Fraction(k) for k in ORDERS[1:]]


def test_parameters_are_factors_and_divisors():
    """The motion x' = -k x / m is exp(-k t / m)."""
    found = expand(rates("x", "-(k*x)/m", "k m"), {"x": 1}, k=3, m=2)["x"]
    assert found == [Fraction(-3, 2) ** k / factorial(k) for k in ORDERS]


def test_statements_of_the_program_are_followed():
    """With statements: x' = 1/(1+x) is sqrt(1 + 2 (1 + t)) where 1 + x begins at 1."""
    found = expand(rates("x", "q", "", "s = 1 + x; q = 1/s"), {"x": 0})["x"]
    assert [1, *found[1:]] == [binomial(half, k) * 2**k for k in ORDERS]


def test_time_and_inputs_are_lines():
    """Integrals of t^2 and of u = 3 + 5 t; z' = u z with u = 1 + 2 t is exp(t + t^2)."""
    timed = replace(rates("x", "t*t"), time=("t",))
    assert expand(timed, {"x": 0}, t=(2, 1))["x"] == [0, 4, 2, Fraction(1, 3), *[0] * 6]
    driven = replace(rates("y", "u"), inputs=("u",))
    assert expand(driven, {"y": 7}, u=(3, 5))["y"] == [7, 3, Fraction(5, 2), *[0] * 7]
    driven = replace(rates("z", "u*z"), inputs=("u",))
    expected = [
        sum(Fraction(comb(n, k - n), factorial(n)) for n in range(k + 1) if k >= n) for k in ORDERS
    ]
    assert expand(driven, {"z": 1}, u=(1, 2))["z"] == expected


def test_a_sine_has_its_cosine():
    """Each of the two is the partner of the other, also where the Program calls one alone."""
    cells = make_jets(rates("y x", "sin(x); 1")).cells
    partners = {cell.name: cell.factors[0][0] for cell in cells}
    assert len(partners) == 2
    assert all(partners[partners[name]] == name for name in partners)


def test_no_cell_reads_itself_at_order_zero():
    """A quotient of a product, and of a function, has a cell for its numerator."""
    jets = make_jets(rates("x y", "x*y/(1+x); sin(x)/(1+x)"))
    assert all(cell.value != Symbol(cell.name) for cell in jets.cells)


def test_loops_hold_so_many_sums():
    """Many products stand in several loops."""
    names = " ".join(f"x{i}" for i in range(SUMS + 2))
    rows = "; ".join(f"x{i}*x{i}" for i in range(SUMS + 2))
    stages = [stage for stage in arrange({"rates": rates(names, rows)}).stages if stage.terms]
    assert [len(stage.terms) for stage in stages] == [SUMS, 2]
