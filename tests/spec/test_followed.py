"""What follows from a motion: its names, units and scopes, and what is refused."""

from fractions import Fraction

import pytest

from coadjoint.derive import derive
from coadjoint.errors import SpecError
from tests.prove.test_reductions import ABOUT_AN_AXIS, IN_STEP
from tests.rolling import BALL, FOLLOWED_SLEIGH
from tests.specs import RIGID_BODY, spec

MORE = "[rolling]"


def test_a_rolling_body_has_attitude_and_contact_followed():
    """Undeclared: q with components q0 .. q3, and x and y in the unit of the arm."""
    found = spec(BALL)
    assert [each.components for each in found.reconstruction] == [
        ("q0", "q1", "q2", "q3"),
        ("x",),
        ("y",),
    ]
    assert [each.unit for each in found.reconstruction] == ["1", "m", "m"]
    assert (found.rolling.turning, found.rolling.velocity) == ("Omega", "Y")


def test_declared_variables_have_rates_units_and_defaults():
    """A rate alone, or a table; rates may name other variables that follow."""
    theta, x, y = spec(FOLLOWED_SLEIGH).reconstruction
    assert (theta.rate.text, theta.unit, theta.default) == ("omega", "1", None)
    assert (x.rate.text, x.unit) == ("v*cos(theta)", "m")
    assert y.default == (Fraction(3),)


def test_a_free_motion_may_have_its_attitude_followed():
    """No constraint is needed: any velocity over the rotations turns it."""
    text = RIGID_BODY + '[reconstruction]\nturn = { attitude = "quaternion" }\n'
    (turn,) = spec(text).reconstruction
    assert turn.components == ("turn0", "turn1", "turn2", "turn3")


FAULTS = [
    ('r = { default = 1, unit = "m" }', 'x = { default = 1 }\nr = { unit = "m" }', "rolling", "x"),
    (MORE, '[reconstruction]\nq = { attitude = "quaternion" }\n[rolling]', "rolling", "q"),
    (MORE, '[observables]\ny = "Omega1"\n[rolling]', "rolling", "y"),
    (MORE, "[parameters.q0]\ndefault = 1\n[rolling]", "rolling", "q0"),
    ('arm = "s"', 'arm = "r"', "rolling.arm", "a scalar"),
    ('arm = "s"', 'arm = "Omega"', "rolling.arm", "Omega"),
    ('normal = "Gamma"', 'normal = "Gama"', "rolling.normal", "Gama"),
    ('name = "se(3)"', 'name = "se(3)"\ninvariance = "right"', "algebra.invariance", "right"),
    (MORE, '[reconstruction]\nz = "dot(Y, Y) + w"\n[rolling]', "reconstruction.z", "w"),
    (MORE, '[reconstruction]\nz = "Omega"\n[rolling]', "reconstruction.z", "a 3-vector"),
    (
        MORE,
        '[reconstruction]\np = { attitude = "quaternion", default = [0, 0, 0, 0] }\n[rolling]',
        "reconstruction.p.default",
        "[0, 0, 0, 0]",
    ),
    (
        MORE,
        '[reconstruction]\np = { attitude = "quaternion", default = [1, 0, 0] }\n[rolling]',
        "reconstruction.p.default",
        "3",
    ),
]


@pytest.mark.parametrize(("old", "new", "key", "found"), FAULTS)
def test_faults_are_shown_at_their_place(old, new, key, found):
    """The key and the guilty value."""
    with pytest.raises(SpecError) as caught:
        spec(BALL, (old, new))
    assert caught.value.parts["key"] == key
    assert found in str(caught.value)


def test_a_rolling_body_needs_constraints_and_space():
    """Without constraints nothing rolls; so(3) and se(2) know no body in space."""
    tables = '[rolling]\narm = "Omega"\nnormal = "Omega"\n'
    with pytest.raises(SpecError, match="there are no constraints"):
        spec(RIGID_BODY + tables)
    with pytest.raises(SpecError, match=r'expected the algebra "se\(3\)"'):
        spec(FOLLOWED_SLEIGH + tables)


def test_an_attitude_needs_rotations_of_space():
    """A sleigh turns in the plane: its attitude is an angle."""
    with pytest.raises(SpecError, match="nothing turns the attitude 'q'") as caught:
        spec(FOLLOWED_SLEIGH + 'q = { attitude = "quaternion" }\n')
    assert caught.value.parts["found"] == "se(2)"
    assert 'theta = "omega"' in str(caught.value)


def test_what_follows_from_a_restricted_motion_may_name_its_section():
    """q2 is q1 there, so that z = p1 q2 is followed at the rate p1 q1."""
    text = IN_STEP.replace("[reduction]", '[reconstruction]\nz = "p1*q2"\n[reduction]')
    equations = derive(spec(text))
    ((name, rate),) = equations.followed
    field = equations.setting.field
    assert name == "z"
    assert equations.close(rate) == field["p1"] * field["q1"]


def test_an_attitude_belongs_to_the_whole_system():
    """The restricted motion has no algebra; an angle about the axis is followed."""
    attitude = ("[reduction]", '[reconstruction]\nq = { attitude = "quaternion" }\n[reduction]')
    with pytest.raises(SpecError, match='Declare an angle, as theta = "omega"') as caught:
        spec(ABOUT_AN_AXIS, attitude)
    assert caught.value.parts["found"] == "q"
    angle = ("[reduction]", '[reconstruction]\nq = "along/I3"\n[reduction]')
    assert derive(spec(ABOUT_AN_AXIS, angle)).followed
