"""Values decided in the exact field: zeros that only definitions show, and no others."""

import pytest

from coadjoint.derive.mechanics import decided as module
from coadjoint.derive.mechanics.decided import Decided
from coadjoint.exact import Field

NAMES = ("x", "y", "a", "m", "_b1", "_b2", "_k1", "_k2", "_d1")


def turning():
    """``_b = a (cos x, sin x)`` and ``_k = m y (sin x, -cos x)``: at right angles."""
    field = Field(NAMES, slots=2)
    x, y, a, m = (field[name] for name in "xyam")
    decided = Decided(field, ["x", "y"])
    cos, sin = field.call("cos", x), field.call("sin", x)
    values = {"_b1": a * cos, "_b2": a * sin, "_k1": m * y * sin, "_k2": -m * y * cos}
    for name, value in values.items():
        assert decided.define(name, value) == value
    return field, decided


def test_a_zero_shows_once_definitions_are_put_in():
    """B . k = 0 and its double; what is not zero stays as it is."""
    field, decided = turning()
    b1, b2, k1, k2 = (field[name] for name in ("_b1", "_b2", "_k1", "_k2"))
    assert decided.value(b1 * k1 + b2 * k2) == 0
    assert decided.is_zero(2 * b1 * k1 + 2 * b2 * k2)
    for other in (b1 * k1 - b2 * k2, b1 * k1 + b2 * k2 + field["x"], b1 * k2 + b2 * k1):
        assert decided.value(other) == other
        assert not decided.is_zero(other)


def test_what_depends_on_parameters_alone_is_written_so():
    """M b . b = m a^2; a m y^2 keeps its names, and so does a sum of parameters."""
    field, decided = turning()
    b1, b2, k1, k2, a, m = (field[name] for name in ("_b1", "_b2", "_k1", "_k2", "a", "m"))
    assert decided.define("_d1", m * b1**2 + m * b2**2) == m * a**2
    assert not decided.moves(field["_d1"])
    assert decided.value(k1**2 + k2**2) == k1**2 + k2**2
    assert decided.value(a + m) == a + m


def test_numbers_are_put_in():
    """A definition that is 0 is a factor nowhere."""
    field, decided = turning()
    decided.define("_d1", field["_b1"] * field["_k1"] + field["_b2"] * field["_k2"])
    assert decided.numbers == {"_d1": 0}
    assert decided.value(field["_d1"] * field["x"] + field["y"]) == field["y"]


def test_roots_satisfy_their_relation():
    """H = sqrt(x^2 + y) has h^2 - x^2 - y = 0, also where a residue has no root at first."""
    field = Field(["x", "y", "_b1"], slots=1)
    decided = Decided(field, ["x", "y"])
    x, y = field["x"], field["y"]
    decided.define("_b1", field.call("sqrt", x**2 + y))
    assert decided.is_zero(field["_b1"] ** 2 - x**2 - y)
    assert not decided.is_zero(field["_b1"] ** 2 - x**2 + y)


def zero_through_a_definition():
    """``_b1 - x^2 - x`` with ``_b1 = x^2 + x``, and what is made of it."""
    field = Field(["x", "_b1"])
    decided, x = Decided(field, ["x"]), field["x"]
    decided.define("_b1", x**2 + x)
    element = field["_b1"] - x**2 - x
    return element, decided.value(element)


@pytest.mark.parametrize("limit", ["TERMS", "TRIES"])
def test_nothing_is_decided_without_a_proof(limit, monkeypatch):
    """Where the closed form would be too long, or points are missing, even a zero stays."""
    assert zero_through_a_definition()[1] == 0
    monkeypatch.setattr(module, limit, 1)
    if limit == "TRIES":  # every point is a pole
        monkeypatch.setattr(module.Field, "evaluate", divide_by_zero)
    element, value = zero_through_a_definition()
    assert value == element != 0


def divide_by_zero(*_):
    """A pole."""
    raise ZeroDivisionError
