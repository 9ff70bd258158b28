"""Derived equations against the formulas of books, exactly, by every route."""

from fractions import Fraction

import pytest
import sympy

from coadjoint.derive import ROUTES, derive
from tests.conftest import rational_points
from tests.sources import textbook
from tests.specs import shipped

SYSTEMS = sorted(textbook.RATES)


def values(expressions, point):
    """SymPy expressions at a rational point, as fractions."""
    at = {sympy.Symbol(n): sympy.Rational(v.numerator, v.denominator) for n, v in point.items()}
    found = [sympy.sympify(e).subs(at) for e in expressions]
    assert all(value.is_Rational for value in found), found
    return [Fraction(int(value.p), int(value.q)) for value in found]


def check_rates(equations, name):
    """Rates at exact random points equal the book's."""
    state, parameters = textbook.STATES[name], textbook.PARAMETERS[name]
    for point in rational_points((*state, *parameters), 5):
        x, p = [point[n] for n in state], [point[n] for n in parameters]
        expected = textbook.RATES[name](x, p)
        assert any(expected)
        assert values(equations.rates, point) == expected


@pytest.mark.parametrize("route", sorted(ROUTES))
@pytest.mark.parametrize("name", SYSTEMS)
def test_rates_are_those_of_the_book(name, route):
    """Each route gives the textbook equations of motion."""
    check_rates(derive(shipped(name), route), name)


@pytest.mark.parametrize("name", SYSTEMS)
def test_names_and_order_are_the_contract(name):
    """State and parameters stand in the declared order under their names."""
    equations = derive(shipped(name))
    assert tuple(map(str, equations.state)) == textbook.STATES[name]
    assert tuple(map(str, equations.parameters)) == textbook.PARAMETERS[name]


@pytest.mark.parametrize("name", SYSTEMS)
def test_poisson_tensor_is_that_of_the_book(name):
    """{x_i, x_j} in the tables of Holm (2011), 2.5.2, 7.1.2 and 8.3.2."""
    equations = derive(shipped(name), "lie-poisson")
    for point in rational_points((*textbook.STATES[name], *textbook.PARAMETERS[name]), 3):
        expected = textbook.TENSORS[name]([point[n] for n in textbook.STATES[name]])
        assert values(list(equations.poisson_tensor), point) == [x for row in expected for x in row]


@pytest.mark.parametrize("route", sorted(ROUTES))
@pytest.mark.parametrize("name", SYSTEMS)
def test_observables_are_those_of_the_book(name, route):
    """Energy, Casimirs and velocities, under their names."""
    equations = derive(shipped(name), route)
    for point in rational_points((*textbook.STATES[name], *textbook.PARAMETERS[name]), 3):
        x = [point[n] for n in textbook.STATES[name]]
        p = [point[n] for n in textbook.PARAMETERS[name]]
        expected = textbook.OBSERVABLES[name](x, p)
        found = equations.observables
        assert set(expected) <= set(found)
        assert values([found[n] for n in expected], point) == list(expected.values())


def test_the_comparison_sees_a_wrong_sign():
    """Exchange two systems' formulas and the comparison fails."""
    with pytest.raises(AssertionError):
        check_rates(derive(shipped("heavy_top")), "kirchhoff")
