"""Holm (2011), sections 12.2 and 12.3: the principle for any Lagrangian and any arm.

By hand and by SymPy on one side, by the engine's two routes on the other; what is wrong by one term
or sign is refuted.
"""

from functools import cache

import pytest
import sympy

from coadjoint.algebra import algebra_by_name
from coadjoint.derive import derive
from tests.sources.balls import BALLS
from tests.sources.components import cross, dot, hat, plus, times
from tests.sources.test_equations import derived, emitted, values
from tests.sources.test_rolling_balls import (
    GAMMA,
    OMEGA,
    ball,
    check_law,
    check_values,
    motion_at,
    rate_at,
    total,
)
from tests.specs import spec

#: A body with everything coupled that rolls on any arm s: 12.2 holds for every l and s.
ANY_BODY = """
title = "A body with any kinetic energy on any arm"
routes = ["nonholonomic", "hamel"]

[algebra]
name = "se(3)"

[variables]
Omega = { role = "velocity", block = "rotation" }
Y     = { role = "velocity", block = "translation" }
Gamma = { role = "advected", representation = "vector" }

[parameters]
A = { shape = [6], form = "symmetric" }
B = { shape = [6], form = "symmetric" }
C = { shape = [6], form = "symmetric" }
b = { shape = [3] }
c = { shape = [3] }
d = { shape = [3] }

[definitions]
s = "dot(Gamma, b)*Gamma + cross(Gamma, c) + d"
V = "Gamma1^2*Gamma2 + 3*Gamma3 + dot(b, Gamma)*Gamma2"

[lagrangian]
l = "dot(Omega, A*Omega)/2 + dot(Omega, B*Y) + dot(Y, C*Y)/2 + dot(Gamma, c)*dot(Y, Y) - V"

[constraints]
rolling = "Y == cross(Omega, s)"
"""
Y = sympy.symbols("Y1:4")


def symbols(*names):
    """Symbols of one or of three components each."""
    return [sympy.symbols(f"{n[:-1]}1:4") if n[-1] == "*" else sympy.Symbol(n) for n in names]


@cache
def any_body():
    """The equations of the general body by both routes."""
    sample = spec(ANY_BODY)
    return {route: derive(sample, route) for route in sample.routes}


@cache
def moving(route):
    """Where the general body is, and how its state moves there by a route."""
    return motion_at(any_body()[route])


# -- 12.2 the principle of Hamilton and Pontryagin -------------------------------------------------


def variation(given, sign=1):
    """``dl . (variations of Omega, Y and Gamma) - d(Sigma . P)/dt + Sigma . (law)``.

    With P = l_Omega + s x l_Y and the law ``DP - ds/dt x l_Y - l_Gamma x Gamma``; Y = Omega x s.
    """
    l_Omega, l_Y, l_Gamma, s, Sigma = (given[n] for n in ("lO*", "lY*", "lG*", "s*", "S*"))
    Omega, moved = given["O*"], given["ds*"]
    velocity = cross(Omega, s)
    # with O^-1 dO = Sigma and O^-1 dx = Sigma x s
    reached, speed = cross(Sigma, s), plus(cross(given["dS*"], s), cross(Sigma, moved))
    by_turn = plus(given["dS*"], cross(Omega, Sigma))
    by_shift = plus(plus(speed, cross(Omega, reached)), times(sign, cross(velocity, Sigma)))
    varied = dot(l_Omega, by_turn) + dot(l_Y, by_shift) + dot(l_Gamma, cross(given["G*"], Sigma))
    P = plus(l_Omega, cross(s, l_Y))
    dP = plus(given["dlO*"], plus(cross(moved, l_Y), cross(s, given["dlY*"])))
    law = plus(dP, cross(Omega, P))
    law = plus(law, times(-1, plus(cross(moved, l_Y), cross(l_Gamma, given["G*"]))))
    return sympy.expand(varied - dot(given["dS*"], P) - dot(Sigma, dP) + dot(Sigma, law))


def test_12_2_the_constraint_enters_after_the_variation():
    """Up to a time derivative dl is -Sigma . (DP - s' x l_Y - l_Gamma x Gamma)."""
    names = ("lO*", "lY*", "lG*", "s*", "S*", "O*", "G*", "dS*", "ds*", "dlO*", "dlY*")
    given = dict(zip(names, symbols(*names), strict=True))
    assert variation(given) == 0
    assert variation(given, sign=-1) != 0


@cache
def in_slopes():
    """``l_Omega + s x l_Y``, ``s``, ``l_Y`` and ``l_Gamma`` of the general body, by SymPy."""
    A, B, C = map(symmetric, "ABC")
    b, c, d = symbols("b*", "c*", "d*")
    s = plus(plus(times(dot(GAMMA, b), GAMMA), cross(GAMMA, c)), d)
    V = GAMMA[0] ** 2 * GAMMA[1] + 3 * GAMMA[2] + dot(b, GAMMA) * GAMMA[1]
    kinetic = (
        dot(OMEGA, A * sympy.Matrix(OMEGA)) / 2
        + dot(OMEGA, B * sympy.Matrix(Y))
        + dot(Y, C * sympy.Matrix(Y)) / 2
        + dot(GAMMA, c) * dot(Y, Y)
    )
    rolling = dict(zip(Y, cross(OMEGA, s), strict=True))
    slopes = [[sympy.diff(kinetic - V, x).xreplace(rolling) for x in v] for v in (OMEGA, Y, GAMMA)]
    return plus(slopes[0], cross(s, slopes[1])), s, slopes[1], slopes[2]


def symmetric(name):
    """A symmetric matrix of symbols."""
    return sympy.Matrix(3, 3, lambda i, j: sympy.Symbol(f"{name}{min(i, j) + 1}{max(i, j) + 1}"))


@pytest.mark.parametrize("route", ["nonholonomic", "hamel"])
def test_12_2_the_law_for_any_lagrangian_and_any_arm(route):
    """P' + Omega x P = s' x l_Y + l_Gamma x Gamma, P = l_Omega + s x l_Y, by both routes."""
    P, s, l_Y, l_Gamma = in_slopes()
    moved = along(s)
    parts = [cross(P, OMEGA), cross(moved, l_Y), cross(l_Gamma, GAMMA)]
    point, rates = moving(route)
    found = rate_at(point, rates, P)
    check_values(found, total(parts), point)
    for spoiled in (
        [*parts[:1], parts[2]],  # no s' x l_Y
        [*parts[:2], times(-1, parts[2])],  # Gamma x l_Gamma
        [times(-1, parts[0]), *parts[1:]],
    ):
        with pytest.raises(AssertionError):
            check_values(found, total(spoiled), point)


def along(expressions):
    """Rates of functions of Gamma, which moves by Gamma x Omega."""
    turning = cross(GAMMA, OMEGA)
    return [
        sum(sympy.diff(e, x) * v for x, v in zip(GAMMA, turning, strict=True)) for e in expressions
    ]


# -- 12.3 nonholonomic motion on semidirect products -----------------------------------------------


def test_12_3_1_velocities_of_se3_in_body_axes():
    """(O, x)^-1 d(O, x)/dt = (hat(Omega), O^-1 dx/dt), and Gamma = O^-1 z turns by Gamma x Omega.

    At a rotation with O' = O hat(Omega); with O' = hat(Omega) O the velocities are not these.
    """
    turn = sympy.Matrix([[1, -2, 2], [2, -1, -2], [2, 2, 1]]) / 3
    assert (turn.T, turn.det()) == (turn.inv(), 1)
    speed = sympy.Matrix(sympy.symbols("v1:4"))
    g = turn.row_join(sympy.Matrix([5, 7, 11])).col_join(sympy.Matrix([[0, 0, 0, 1]]))
    algebra, W = algebra_by_name("se(3)"), sympy.Matrix(hat(OMEGA))
    eta = [*OMEGA, *(turn.T * speed)]
    expected = sympy.zeros(4)
    for place, matrix in enumerate(algebra.matrices):
        for entry, value in matrix.items():
            expected[entry] += sympy.Rational(str(value)) * eta[place]
    up = sympy.Matrix([0, 0, 1])
    for moved in (turn * W, W * turn):
        rate = moved.row_join(speed).col_join(sympy.zeros(1, 4))
        body = (g.inv() * rate - expected).applyfunc(sympy.expand)
        turning = (moved.T * up - sympy.Matrix(cross(turn.T * up, OMEGA))).applyfunc(sympy.expand)
        assert (body == sympy.zeros(4)) == (moved == turn * W) == (turning == sympy.zeros(3, 1))


def energy_of_any_body():
    """``P . Omega/2 + V``, for P . Omega = l_Omega . Omega + l_Y . (Omega x s)."""
    P, *_ = in_slopes()
    (b,) = symbols("b*")
    return dot(P, OMEGA) / 2 + GAMMA[0] ** 2 * GAMMA[1] + 3 * GAMMA[2] + dot(b, GAMMA) * GAMMA[1]


@pytest.mark.parametrize("route", ["nonholonomic", "hamel"])
def test_12_3_2_energy_stays_for_any_lagrangian_and_any_arm(route):
    """Its rate is 0 by both routes, and is not when an acceleration is spoiled."""
    equations = any_body()[route]
    point, rates = moving(route)
    energy = energy_of_any_body()
    assert values([equations.energy], point) == values([energy], point)
    assert rate_at(point, rates, [energy]) == [0]
    assert rate_at(point, rates | {OMEGA[0]: rates[OMEGA[0]] + 1}, [energy]) != [0]


def test_12_3_3_the_constrained_lagrangian_misses_a_force():
    """Plain Euler-Poincare of l_c lacks m r (Gamma x Y) x Omega, which has no power."""
    for name in BALLS:
        given, equations = ball(name), emitted(name)
        reduced = given.energy - 2 * given.m * given.g * dot(given.Gamma, given.chi)  # l_c
        M = [sympy.diff(reduced, x) for x in given.Omega]
        plain = plus(
            cross(M, given.Omega), cross([sympy.diff(reduced, x) for x in given.Gamma], given.Gamma)
        )
        missing = times(given.m * given.r, cross(cross(given.Gamma, given.Y), given.Omega))
        assert sympy.expand(dot(missing, given.Omega)) == 0
        check_law(equations, M, plus(plain, missing))
        with pytest.raises(AssertionError):
            check_law(equations, M, plain)


def test_12_3_3_the_wrong_motion_keeps_energy_and_vertical_momentum_too():
    """For the centred ball the missing force has no part along Gamma: invariants see nothing."""
    given = ball("chaplygin_ball_centred")
    missing = cross(cross(given.Gamma, given.Y), given.Omega)
    assert sympy.expand(dot(missing, given.Gamma)) == 0
    assert any(sympy.expand(part) != 0 for part in missing)
    off = ball("chaplygin_ball")
    assert sympy.expand(dot(cross(cross(off.Gamma, off.Y), off.Omega), off.Gamma)) != 0


def test_12_3_3_the_road_by_the_constrained_lagrangian_is_hamel_s():
    """With the force it gives the motion of the principle, for each ball and any body."""
    motions = [[motion_at(equations) for equations in derived(name).values()] for name in BALLS]
    for (_, one), *others in (*motions, map(moving, any_body())):
        assert others
        assert all(other == one for _, other in others)
        assert any(one.values())
