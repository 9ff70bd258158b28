"""A ball on an ellipsoid: contact without a closed form, on a surface without symmetry."""

import pytest

from coadjoint.derive import derive, make_setting
from coadjoint.prove import prove
from tests.specs import spec

BALL_ON_ELLIPSOID = """
title  = "A ball that rolls on an ellipsoid"
routes = ["nonholonomic", "hamel"]

[algebra]
name       = "so(3)"
invariance = "right"

[variables]
omega = { role = "velocity", unit = "1/s", default = ["0.5", 0, 1] }
c     = { role = "coordinate", shape = [3], unit = "m", default = [0, 0, 2] }
v     = { role = "velocity", of = "c", unit = "m/s" }
X     = { role = "contact", unit = "m", default = [0, 0, 1] }

[parameters]
I = { positive = true, default = "0.4", unit = "kg m^2" }
m = { positive = true, default = 1, unit = "kg" }
r = { positive = true, default = 1, unit = "m" }
a = { shape = [3], positive = true, default = [3, 2, 1], unit = "m" }
g = { default = "9.81", unit = "m/s^2" }

[lagrangian]
l = "I*dot(omega, omega)/2 + m*dot(v, v)/2 - m*g*c3"

[constraints]
rolling = "v == cross(omega, c - X)"

[rolling]
arm     = "c - X"
radius  = "r"
surface = "(X1/a1)^2 + (X2/a2)^2 + (X3/a3)^2 - 1"
contact = "X"

[claims]
conserved = ["energy"]
"""


@pytest.mark.campaign  # 100 seconds, most of them for Groebner bases
def test_a_ball_on_an_ellipsoid_is_proved():
    """Both routes agree, the energy and the contact are kept, and the bracket is not Poisson."""
    ball = spec(BALL_ON_ELLIPSOID)
    setting = make_setting(ball)
    certificate = prove(ball, [derive(ball, each, setting=setting) for each in ball.routes])
    certificate.require()
    proved = {str(each.statement) for each in certificate.claims}
    assert "nonholonomic and hamel give the same motion" in proved
    assert "the energy is conserved" in proved
    assert "the centre c stays at the radius from the surface" in proved
