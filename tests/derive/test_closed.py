"""Rates for people: closed expressions, or the equations whose solution fills pages."""

from fractions import Fraction

import numpy as np
import pytest
import sympy

from coadjoint.derive.closed import LARGEST
from coadjoint.derive.reference import Reference
from coadjoint.systems import chaplygin_ball
from tests.constrained import PARTICLE, SLEIGH, derived
from tests.specs import emitted


def point_of(equations, seed=7):
    """Rational values of everything that a kernel is given."""
    setting = equations.setting
    names = (*setting.state, *setting.parameters, *setting.driving)
    return {name: Fraction(seed * n % 11 + 3, 5 + n % 4) for n, name in enumerate(names)}


def evaluated(expressions, point):
    """Expressions with rational values put in."""
    at = {sympy.Symbol(name): sympy.sympify(value) for name, value in point.items()}
    return [sympy.sympify(each).xreplace(at) for each in expressions]


def by_kernel(equations, function, point):
    """What a kernel computes, in fractions, by its own solve."""
    return Reference(equations).evaluate(function, point, Fraction, no_call)


def no_call(function, argument):
    """Systems of rational functions alone call none."""
    raise AssertionError(function)


def check_closed(equations):
    """Nothing but what a kernel is given occurs."""
    setting = equations.setting
    given = {*setting.state, *setting.parameters, *setting.driving}
    written = (*equations.rates, equations.energy, *equations.observables.values())
    assert not {str(s) for each in written for s in each.free_symbols} - given


def test_rates_of_the_sleigh_are_those_on_paper():
    """dv/dt = a omega^2, (I + m a^2) domega/dt = -m a v omega; the blade pushes sideways."""
    equations = derived(SLEIGH)["nonholonomic"]
    check_closed(equations)
    m, inertia, a, v, omega = sympy.symbols("m I a v omega")
    rates = dict(zip(map(str, equations.state), equations.rates, strict=True))
    whole = inertia + m * a**2
    expected = {"v": a * omega**2, "omega": -m * a * v * omega / whole}
    assert all(sympy.cancel(rates[name] - value) == 0 for name, value in expected.items())
    push = equations.observables["blade_reaction"]
    assert sympy.cancel(push - m * inertia * v * omega / whole) == 0
    assert sympy.cancel(push + m * inertia * v * omega / whole) != 0


@pytest.mark.parametrize("name", ["chaplygin_ball", "suslov", "veselova", "chaplygin_sleigh"])
def test_closed_rates_are_what_kernels_compute(name):
    """At a rational point, to the last digit, where up to four unknowns are solved for."""
    equations = emitted(name)
    assert not equations.unsolved
    check_closed(equations)
    point = point_of(equations)
    for function, written in (
        ("rhs", equations.rates),
        ("observables", equations.observables.values()),
    ):
        expected = by_kernel(equations, function, point)
        assert any(expected)
        assert evaluated(written, point) == [sympy.Rational(value) for value in expected]


def test_closed_rates_are_those_of_the_emitted_kernel():
    """The NumPy kernel of the generated package, at doubles."""
    equations = emitted("chaplygin_ball")
    state, parameters = np.linspace(0.3, 1.1, 6), np.linspace(1.2, 2.5, 9)
    names = (*equations.setting.state, *equations.setting.parameters)
    point = dict(zip(names, map(Fraction, (*state, *parameters)), strict=True))
    found = [float(value) for value in evaluated(equations.rates, point)]
    kernel = chaplygin_ball.rhs(state, parameters, target="numpy")
    assert np.allclose(found, kernel, rtol=1e-12)  # both sides round some fifty operations
    assert not np.allclose(found, -kernel, rtol=1e-12)


@pytest.mark.parametrize("name", ["coupled_bodies", "snakeboard"])
def test_rates_of_a_large_solve_come_with_its_equations(name):
    """Six unknowns: the rates name them, and matrix and right side give what kernels compute."""
    equations = emitted(name)
    (system,) = equations.unsolved
    assert len(system.unknowns) > LARGEST
    assert system.matrix == system.matrix.T
    point = point_of(equations)
    matrix, right = (
        sympy.Matrix(*each.shape, evaluated(each, point)) for each in (system.matrix, system.right)
    )
    assert not right.free_symbols | matrix.free_symbols
    expected = by_rational_kernel(equations, point)
    for turned, agrees in ((right, True), (-right, False)):
        solution = dict(zip(map(str, system.unknowns), matrix.solve(turned), strict=True))
        found = evaluated(equations.rates, point | solution)
        assert all(value.is_number for value in found)
        assert (numbers(found) == numbers(expected)) is agrees


def by_rational_kernel(equations, point):
    """The rates by the kernel's own solve, with functions at a rational point kept exact."""

    def call(function, argument):
        return getattr(sympy, function)(argument)

    at = {name: sympy.Rational(value) for name, value in point.items()}
    return Reference(equations).evaluate("rhs", at, sympy.sympify, call)


def numbers(values):
    """To 25 digits, where sines and cosines stay."""
    return [sympy.N(value, 30).round(25) for value in values]


def test_free_motion_is_closed():
    """Velocities put in, on every route of a top."""
    for route in ("euler-poincare", "lie-poisson", "newton-euler"):
        equations = emitted("heavy_top", route)
        check_closed(equations)
        assert not equations.unsolved


def test_two_roads_have_the_same_closed_rates():
    """Hamel's equations name no reactions; their rates are closed all the same."""
    one, two = (derived(PARTICLE)[route] for route in ("nonholonomic", "hamel"))
    differences = [a - b for a, b in zip(one.rates, two.rates, strict=True)]
    assert [sympy.cancel(each) for each in differences] == [0] * len(differences)
    assert any(one.rates)
