"""A ball on an ellipsoid: contact without a closed form, on a surface without symmetry."""

import pytest

from coadjoint.derive import derive, make_setting
from coadjoint.prove import prove
from tests.contacts import BALL_INSIDE
from tests.specs import spec

#: Outside of it, in place of a cylinder that turns.
ON_ELLIPSOID = (
    (
        'routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]',
        'routes = ["nonholonomic", "hamel"]',
    ),
    ("default = [2, 0, 0]", "default = [0, 0, 2]"),
    ("default = [3, 0, 0]", "default = [0, 0, 1]"),
    (
        "b = { positive = true, default = 3,",
        "a = { shape = [3], positive = true, default = [3, 2, 1],",
    ),
    ("b^2 - X1^2 - X2^2", "(X1/a1)^2 + (X2/a2)^2 + (X3/a3)^2 - 1"),
)


@pytest.mark.campaign  # 100 seconds, most of them for Groebner bases
def test_a_ball_on_an_ellipsoid_is_proved():
    """Both routes agree, and the energy and the contact are kept."""
    ball = spec(BALL_INSIDE, *ON_ELLIPSOID)
    setting = make_setting(ball)
    certificate = prove(ball, [derive(ball, each, setting=setting) for each in ball.routes])
    certificate.require()
    proved = {str(each.statement) for each in certificate.claims}
    assert "nonholonomic and hamel give the same motion" in proved
    assert "the energy is conserved" in proved
    assert "the centre c stays at the radius from the surface" in proved
