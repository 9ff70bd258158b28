"""Bodies by attitude and position, and with coordinates inside, against derivations of their own.

The heavy top by its attitude is the heavy top of the books by Gamma = R^T e3. The force and the
torque of gravity are written out from the multipoles. The body with an oscillator is compared with
Lagrange's equations in coordinates: rotation vectors about the moving attitude, and the place.
"""

from functools import cache
from pathlib import Path

import pytest
import sympy
from sympy import Matrix, diag, symbols

from coadjoint.derive import derive
from coadjoint.spec import read_spec
from tests.specs import spec
from tests.turning import BY_QUATERNION, TOP

EXAMPLES = Path(__file__).parents[2] / "examples"
I3 = diag(*symbols("I1:4"))
PI = Matrix(symbols("Pi1:4"))


def same(found, expected):
    """Whether two lists of expressions are equal."""
    return all(sympy.cancel(x - y) == 0 for x, y in zip(found, expected, strict=True))


def along(values, equations):
    """The rates of functions of the state."""
    motion = dict(zip(equations.state, equations.rates, strict=True))
    return [sum(x.diff(name) * rate for name, rate in motion.items()) for x in values]


@pytest.mark.parametrize("changes", [(), BY_QUATERNION], ids=["attitude", "quaternion"])
def test_the_top_by_its_attitude_is_the_heavy_top(changes):
    """dPi/dt = Pi x Omega + w Gamma x chi and dGamma/dt = Gamma x Omega, of Gamma = R^T e3."""
    equations = derive(spec(TOP, *changes))
    if changes:  # the last row of the matrix of Euler and Rodrigues, written out
        a, b, c, d = symbols("q0:4")
        Gamma = Matrix([2 * (b * d - a * c), 2 * (c * d + a * b), a**2 - b**2 - c**2 + d**2])
    else:
        Gamma = Matrix(symbols("R31 R32 R33"))
    Omega, chi, w = I3.inv() * PI, Matrix(symbols("chi1:4")), sympy.Symbol("w")
    assert same(along(PI, equations), PI.cross(Omega) + w * Gamma.cross(chi))
    assert same(along(Gamma, equations), Gamma.cross(Omega))
    assert not same(along(PI, equations), PI.cross(Omega) - w * Gamma.cross(chi))


def test_gravity_pulls_and_turns_the_orbiting_body():
    """Newton's force with terms of second order and the torque 3k/r^3 e x J e, in body axes."""
    equations = derive(read_spec(EXAMPLES / "orbiting_body.toml"))
    turn = Matrix([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3
    x, P, (k, m) = Matrix([2, 3, 6]), Matrix(symbols("P1:4")), symbols("k m")  # at the distance 7
    pose = turn.row_join(x)
    at = {sympy.Symbol(f"g{i + 1}{j + 1}"): pose[i, j] for i in range(3) for j in range(4)}
    rates = [rate.subs(at) for rate in along((*PI, *P), equations)]
    r, e, Omega = sympy.Integer(7), turn.T * x / 7, I3.inv() * PI
    torque = 3 * k / r**3 * e.cross(I3 * e)
    bulge = I3.trace() - 5 * (e.T * I3 * e)[0]
    force = -k * m / r**2 * e - 3 * k / (2 * r**4) * (bulge * e + 2 * I3 * e)
    assert same(rates, [*(PI.cross(Omega) + torque), *(P.cross(Omega) + force)])
    assert not same(rates, [*(PI.cross(Omega) - torque), *(P.cross(Omega) + force)])


#: A state of the body with an oscillator, and its parameters.
NUMBERS = {"Omega1": 2, "Omega2": -3, "Omega3": 5, "s": 7, "u": 11, "m": 13, "k": 17, "a": 19}
NUMBERS |= {"I1": 3, "I2": 5, "I3": 4}
AT = {sympy.Symbol(name): value for name, value in NUMBERS.items()}
VELOCITIES = ("Omega1", "Omega2", "Omega3", "u")


@cache
def accelerations():
    """By Lagrange's equations in coordinates, at the moving attitude.

    Near it the attitude is R exp(hat(theta)), and Omega = dtheta/dt - theta x dtheta/dt / 2 up to
    terms of second order in theta, which have no part in the equations at theta = 0.
    """
    t = sympy.Symbol("t")
    theta = Matrix([sympy.Function(f"theta{n}")(t) for n in range(3)])
    s, (m, k, a) = sympy.Function("s")(t), symbols("m k a")
    Omega = theta.diff(t) - theta.cross(theta.diff(t)) / 2
    place = Matrix([a, 0, s])
    moved = Omega.cross(place) + place.diff(t)
    energy = (Omega.T * I3 * Omega)[0] / 2 + m * moved.dot(moved) / 2 - k * s**2 / 2
    named = list(zip((*theta, s), VELOCITIES, strict=True))
    second = {q.diff(t, 2): sympy.Symbol(f"d{v}") for q, v in named}
    first = {q.diff(t): sympy.Symbol(v) for q, v in named}
    still = dict.fromkeys(theta, 0) | {s: sympy.Symbol("s")}
    rows = [energy.diff(q.diff(t)).diff(t) - energy.diff(q) for q, _ in named]
    rows = [row.subs(second).subs(first).subs(still).subs(AT) for row in rows]
    return sympy.solve(rows, list(second.values()))


@pytest.mark.parametrize("route", ["nonholonomic", "hamel"])
def test_the_body_with_an_oscillator_moves_as_in_coordinates(route):
    """The accelerations solve Lagrange's equations."""
    equations = derive(read_spec(EXAMPLES / "body_with_oscillator.toml"), route)
    rates = dict(zip(map(str, equations.state), equations.rates, strict=True))
    known = dict(AT)
    for each in equations.unsolved:
        values = each.matrix.subs(AT).LUsolve(each.right.subs(AT))
        known |= zip(each.unknowns, values, strict=True)
    for name in VELOCITIES:
        assert rates[name].subs(known) == accelerations()[sympy.Symbol(f"d{name}")], name
    assert rates["s"] == sympy.Symbol("u")
