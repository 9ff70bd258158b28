"""Inputs and time in a spec: where they may stand, what they are called, and refusals."""

import pytest

from coadjoint.errors import SpecError
from coadjoint.spec.model import Input, Time
from tests.driven_specs import BELT, BOOST, PENDULUM, ROD, SUSLOV, TOP
from tests.specs import spec


def test_inputs_and_time_are_read():
    """A vector and its default, written once for all components; a time with the unit s."""
    found = spec(SUSLOV)
    assert found.inputs == (Input("u", (3,), (0, 0, 0), "N m"),)
    assert found.inputs[0].components == ("u1", "u2", "u3")
    assert found.time is None
    assert spec(BOOST).time == Time("t", "s")
    assert [each.name for each in spec(PENDULUM).driving] == ["u", "t"]


REFUSED = [
    (TOP, ('casimirs = ["dot(Gamma, Gamma)"', 'casimirs = ["dot(u, Gamma)"'), "'u' is an input"),
    (SUSLOV, ("u = { shape = [3], default = 0", "u = { shape = [3], default = [0, 0]"), "shape"),
    (SUSLOV, ('Omega = "u"', 'Omega = "dot(u, u)"'), "as 'Omega' is"),
    (SUSLOV, ('Omega = "u"', 'Omega = "Omega"'), "'u' occurs in no formula"),
    (BOOST, ('"t*P - m*r"', '"P - m*r"'), "'t' occurs in no formula"),
    (BOOST, ('name = "t"', 'name = "m"'), "'m' is doubled"),
    (BOOST, ('name = "t"', 'name = "time"'), "'time' is a name that generated code"),
    (PENDULUM, ("u = {", "t = {"), "'t' is a name that generated code"),
    (PENDULUM, ("u = {", "phi = {"), "'phi' is doubled"),
    (ROD, ("m = {", "inputs = {"), "'inputs' is a name that generated code"),
]


REFUSED += [
    (BELT, ('rate = "db"', 'rate = "dc"'), "'dc' is not another input .* expected one of f, db"),
    (BELT, ('rate = "db"', 'rate = "b"'), "'b' is not another input with the shape of 'b'"),
    (
        BELT,
        ("db = { default = 0 }", "db = { shape = [2], default = 0 }"),
        "'db' is not another input",
    ),
    (
        BELT,
        ("db = { default = 0 }", 'db = { default = 0, rate = "b" }'),
        "b -> db -> b form a circle",
    ),
    (
        BELT,
        ("db = { default = 0 }", 'db = { default = 0, rate = "zz" }'),
        "'zz' is not another input",
    ),
]


@pytest.mark.parametrize(("text", "change", "problem"), REFUSED)
def test_what_cannot_be_is_refused(text, change, problem):
    """With the name, and what was expected."""
    with pytest.raises(SpecError, match=problem):
        spec(text, change)


ALGEBRA = """
title = "Constants of time"
routes = ["lie-poisson"]
[algebra]
basis = ["e1", "e2", "e3"]
brackets = { "[e1, e2]" = "CONSTANT" }
[variables]
p = { role = "momentum" }
[inputs]
u = { default = 1 }
[time]
name = "t"
[hamiltonian]
h = "dot(p, p)/2 + u*p1 + t*p2"
"""
BRACKET = """
title = "Brackets of time"
routes = ["poisson"]
[poisson]
brackets = { "{x, y}" = "CONSTANT" }
[variables]
x = { role = "coordinate" }
y = { role = "coordinate" }
[inputs]
u = { default = 1 }
[time]
name = "t"
[definitions]
twice = "2*t"
[hamiltonian]
h = "x^2 + u*y + t"
"""


@pytest.mark.parametrize("text", [ALGEBRA, BRACKET])
@pytest.mark.parametrize(
    ("constant", "problem"), [("t*e3", "'t' is the time"), ("u*e3", "'u' is an input")]
)
def test_brackets_and_constants_stay(text, constant, problem):
    """Structure constants and brackets know neither time nor inputs."""
    constant = constant if text == ALGEBRA else constant.replace("e3", "x")
    with pytest.raises(SpecError, match=rf"{problem}.*\. Put a parameter in its place\."):
        spec(text, ("CONSTANT", constant))
    parameter = ("[inputs]", "[parameters]\nk = { default = 1 }\n[inputs]")
    assert spec(text, ("CONSTANT", f"k{constant[1:]}"), parameter)


def test_definitions_do_not_hide_time():
    """What a definition names is refused where it is used."""
    with pytest.raises(SpecError, match="'t' is the time"):
        spec(BRACKET, ("CONSTANT", "twice*x"))


def test_a_lax_pair_is_the_same_at_all_times():
    """The routes by Lax pairs refuse driven systems, and say what to remove."""
    with pytest.raises(SpecError, match=r'does not accept inputs or time.*\n*.*Remove "manakov"'):
        spec(TOP, ('"newton-euler"]', '"newton-euler", "manakov"]'))
