"""[rolling] on a surface: its keys go together, and its names are there."""

import pytest

from coadjoint.errors import SpecError
from tests.contacts import BALL_INSIDE, ELLIPSOID, TURNS
from tests.specs import spec

TOUCHES = 'contact = "X"'
CYLINDER = "b^2 - X1^2 - X2^2"


def test_a_ball_and_a_body_on_a_surface_are_read():
    """Points of contact are state, and nothing is followed that is not declared."""
    ball, body = spec(BALL_INSIDE), spec(ELLIPSOID)
    assert [v.name for v in ball.state] == ["omega", "c", "X"]
    assert [v.name for v in body.state] == ["Omega", "E1", "E2", "E3", "s", "X"]
    assert (ball.rolling.turning, ball.rolling.velocity) == ("omega", "v")
    assert (body.rolling.turning, body.rolling.velocity) == ("Omega", "Y")
    assert ball.rolling.contact.centre == "c"
    assert body.rolling.contact.axes == ("E1", "E2", "E3")
    assert ball.reconstruction == body.reconstruction == ()


@pytest.mark.parametrize(
    ("text", "change", "key", "problem"),
    [
        (BALL_INSIDE, (TOUCHES, 'contact = "Z"'), "variables.X.role", "which surfaces touch"),
        (BALL_INSIDE, ('contact = "X"\n', ""), "variables.X.role", "which surfaces touch"),
        (BALL_INSIDE, (TOUCHES, f'{TOUCHES}\npoint = "X"'), "rolling.point", "no body"),
        (BALL_INSIDE, ('radius = "r"\n', ""), "rolling.surface", "has no surface"),
        (ELLIPSOID, (TOUCHES, f'{TOUCHES}\nradius = "b"'), "rolling.surface", "has two surfaces"),
        (ELLIPSOID, (TOUCHES, f'{TOUCHES}\nnormal = "E3"'), "rolling.normal", "normal of a plane"),
        (
            BALL_INSIDE,
            (CYLINDER, "b^2 - c1^2"),
            "rolling.surface",
            "'c1' is a coordinate",
        ),
        (BALL_INSIDE, (CYLINDER, "b^2 - 1"), "rolling.surface", "the value is a scalar"),
        (BALL_INSIDE, ('"r"\n', '"c1"\n'), "rolling.radius", "'c1' is a coordinate"),
        (BALL_INSIDE, (TOUCHES, f'{TOUCHES}\nturning = "W"'), "rolling.turning", "a scalar"),
        (ELLIPSOID, (TOUCHES, TURNS.replace("W", "g")), "rolling.turning", "is no ball"),
        (ELLIPSOID, ('"E1", "E2", "E3"', '"E1", "E2", "E4"'), "rolling.axes", "'E4'"),
        (ELLIPSOID, ('"E1", "E2", "E3"', '"E1", "E2", "E2"'), "rolling", "are not named"),
        (ELLIPSOID, ('axes = ["E1", "E2", "E3"]\n', ""), "rolling", "are not named"),
        (
            BALL_INSIDE,
            (TOUCHES, f'{TOUCHES}\naxes = ["c", "c", "c"]'),
            "rolling.axes",
            "from space",
        ),
        (ELLIPSOID, ('arm = "-s"', 'arm = "s1"'), "rolling.arm", "a scalar"),
        (
            BALL_INSIDE,
            ("[rolling]", '[transformations.flip]\nmap = { omega = "-omega" }\n[rolling]'),
            "transformations",
            "points of contact",
        ),
    ],
)
def test_what_does_not_fit_is_refused(text, change, key, problem):
    """Each at its key."""
    with pytest.raises(SpecError) as caught:
        spec(text, change)
    assert caught.value.parts["key"] == key
    assert problem in str(caught.value)


def test_a_point_of_contact_needs_rolling_at_all():
    """Without the table the role has no meaning."""
    without = BALL_INSIDE[: BALL_INSIDE.index("[rolling]")]
    with pytest.raises(SpecError, match="nothing says which surfaces touch at 'X'"):
        spec(without)


def test_rolling_says_on_what():
    """An arm alone is not enough."""
    text = ELLIPSOID[: ELLIPSOID.index("body =")].replace(" - m*g*(X3 - dot(E3, s))", "")
    lines = [line for line in text.splitlines() if '"contact"' not in line]
    changes = ("cross(s, Omega)", "cross(E1, Omega)"), ('"-s"', '"E1"')
    with pytest.raises(SpecError, match="nothing says what the body rolls on"):
        spec("\n".join(lines), *changes)


@pytest.mark.parametrize(
    "change",
    [
        ('X = { role = "contact", unit = "m"', 'X = { role = "contact", unit = "s"'),
        ('r = { positive = true, default = 1, unit = "m" }', 'r = { default = 1, unit = "kg" }'),
    ],
)
def test_units_of_a_contact_are_lengths(change):
    """Of points and of radii."""
    with pytest.raises(SpecError, match="unit"):
        spec(BALL_INSIDE, change)
