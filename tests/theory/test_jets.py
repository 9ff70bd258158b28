"""Undetermined functions: total derivatives commute, agree with real functions, and end."""

import pytest

from coadjoint.exact import Field
from coadjoint.theory.jets import JetField

NAMES = ("x", "y")


@pytest.fixture
def field():
    """Two functions of x and y, up to third derivatives, and a constant."""
    return JetField(NAMES, ["f", "g"], order=3, parameters=["k"])


def expression(ring, f, g, k):
    """Some rational expression of functions and variables."""
    x, y = ring["x"], ring["y"]
    return (k * f**2 * x + g) / (y + g * f) - x * y * g


def check_commute(field, element):
    """d/dx d/dy = d/dy d/dx."""
    first = field.derivative(field.derivative(element, "x"), "y")
    assert first != 0
    assert first == field.derivative(field.derivative(element, "y"), "x")


def test_total_derivatives_commute(field):
    """Mixed derivatives of an expression of undetermined functions agree."""
    check_commute(field, expression(field, field["f"], field["g"], field["k"]))


def test_the_check_sees_a_chain_rule_with_a_hole(field, monkeypatch):
    """The check above can fail: let the derivative of g by y be forgotten."""
    whole = field.derivative

    def holed(element, name):
        return field.substitute(whole(element, name), {"g_y": field.zero})

    monkeypatch.setattr(field, "derivative", holed)
    with pytest.raises(AssertionError):
        check_commute(field, expression(field, field["f"], field["g"], field["k"]))


def test_jets_of_actual_functions_are_their_derivatives(field):
    """Differentiating and then putting in functions equals putting in and then differentiating."""
    plain = Field([*NAMES, "k"])
    x, y, k = (plain[name] for name in (*NAMES, "k"))
    actual = {"f": x**2 * y - 3, "g": x / (1 + y)}
    values = {"x": x, "y": y, "k": k}
    for name, function in actual.items():
        values |= {name: function}
        for first in NAMES:
            values[f"{name}_{first}"] = plain.derivative(function, first)
            for second in NAMES:
                known = plain.derivative(values[f"{name}_{first}"], second)
                values["_".join((name, *sorted((first, second))))] = known
    jet = expression(field, field["f"], field["g"], field["k"])
    concrete = expression(plain, actual["f"], actual["g"], k)
    for path in ("x", "y", "xy", "yy"):
        derived, expected = jet, concrete
        for name in path:
            derived, expected = field.derivative(derived, name), plain.derivative(expected, name)
        assert field.evaluate(derived, values, plain.number, None) == expected
        assert expected != 0


def test_partial_derivatives_by_functions_and_constants(field):
    """By a function's own symbol or a constant, the derivative is the partial one."""
    f, k = field["f"], field["k"]
    assert field.derivative(k * f**2, "f") == 2 * k * f
    assert field.derivative(k * f**2, "k") == f**2


def test_an_order_that_is_too_low_is_an_error(field):
    """A proof that needs a fourth derivative of a third-order field stops, and names it."""
    with pytest.raises(KeyError, match="f_x_x_x_y"):
        field.derivative(field["f_x_x_x"], "y")
