"""Small constrained systems as text, their equations short enough to be solved by hand."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache

from coadjoint.derive import Equations, derive, make_setting
from coadjoint.prove.agreement import about_equality
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.constraints import about_constraints, about_kept
from coadjoint.prove.integrals import about_energy
from coadjoint.prove.zero import Examined
from tests.specs import spec

#: The constraint of many books, dz - y dx = 0.
PARTICLE = """
title = "A particle whose height follows its way"
routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]
[variables]
x = { role = "coordinate" }
y = { role = "coordinate" }
z = { role = "coordinate" }
u = { role = "velocity", of = "x" }
v = { role = "velocity", of = "y" }
w = { role = "velocity", of = "z" }
[parameters]
m = { positive = true, default = 1 }
k = { default = 1 }
[lagrangian]
l = "m*(u^2 + v^2 + w^2)/2"
[constraints]
blade = "w == y*u"
[claims]
conserved = ["energy"]
"""
#: Chaplygin's: v along the blade, u across it, a from the blade to the centre of mass.
SLEIGH = """
title = "A sleigh"
routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]
[algebra]
name = "se(2)"
[variables]
omega = { role = "velocity", block = "rotation" }
v = { role = "velocity", block = ["P1"] }
u = { role = "velocity", block = ["P2"] }
[parameters]
m = { positive = true, default = 1 }
I = { positive = true, default = 1 }
a = { default = 1 }
k = { default = 1 }
[lagrangian]
l = "m*(v^2 + (u + a*omega)^2)/2 + I*omega^2/2"
[constraints]
blade = "u == 0"
"""
#: Suslov's, with the products of inertia b; one direction of the body does not turn.
SUSLOV = """
title = "A body that does not turn about its third axis"
routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]
[algebra]
name = "so(3)"
[variables]
turn = { role = "velocity", block = ["J1", "J2"] }
spin = { role = "velocity", block = ["J3"] }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
b = { default = 1 }
[lagrangian]
l = "(I1*turn1^2 + I2*turn2^2 + I3*spin^2)/2 + b*turn1*spin"
[constraints]
wheel = "spin == 0"
"""
#: A pendulum as a particle that keeps its distance: no constraint gives a velocity.
PENDULUM = """
title = "A particle on a rod"
routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]
[variables]
x = { role = "coordinate" }
y = { role = "coordinate" }
u = { role = "velocity", of = "x" }
v = { role = "velocity", of = "y" }
[parameters]
m = { positive = true, default = 1 }
g = { default = 1 }
[lagrangian]
l = "m*(u^2 + v^2)/2 - m*g*y"
[constraints]
rod = "x*u + y*v == 0"
"""
#: se(3) with a vector that the body carries, and a ball that is not centred.
BALL = """
title = "A ball on a plane"
routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]
[algebra]
name = "se(3)"
[variables]
Omega = { role = "velocity", block = "rotation" }
Y = { role = "velocity", block = "translation" }
Gamma = { role = "advected", representation = "vector" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
m = { positive = true, default = 1 }
r = { default = 1 }
g = { default = 1 }
chi = { shape = [3], default = ["0.1", "0.2", "0.3"] }
[definitions]
s = "r*Gamma + chi"
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2 + m*dot(Y, Y)/2 - m*g*dot(Gamma, chi)"
[constraints]
rolling = "Y == cross(Omega, s)"
"""
#: Constraints that are kept where free motion has no acceleration: no force acts on them.
STRAIGHT = """
title = "A free particle on a line"
routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]
[variables]
x = { role = "coordinate" }
y = { role = "coordinate" }
u = { role = "velocity", of = "x" }
v = { role = "velocity", of = "y" }
[parameters]
m = { positive = true, default = 1 }
k = { default = 2 }
[lagrangian]
l = "m*(u^2 + v^2)/2"
[constraints]
line = "u + k*v == 0"
"""
#: Every axis of the body is principal, so that it turns uniformly about any.
ROUND = """
title = "A body of unit inertia"
routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]
[algebra]
name = "so(3)"
[variables]
w = { role = "velocity" }
[lagrangian]
l = "dot(w, w)/2"
[constraints]
gear = "3*w1 == 2*w2"
"""
#: Its centre on a cylinder of radius R, the radius of the ball r, no slip; upright, weight along z.
CYLINDER = """
title = "A ball in an upright cylinder"
routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]
[variables]
theta = { role = "coordinate" }
z = { role = "coordinate" }
a = { role = "coordinate", shape = [3] }
u = { role = "velocity", of = "theta" }
w = { role = "velocity", of = "z" }
s = { role = "velocity", of = "a" }
[parameters]
m = { positive = true, default = 1 }
I = { positive = true, default = 1 }
R = { positive = true, default = 3 }
r = { positive = true, default = 1 }
g = { default = 1 }
[lagrangian]
l = "m*(R^2*u^2 + w^2)/2 + I*dot(s, s)/2 - m*g*z"
[constraints]
around = "R*u + r*s3 == 0"
along = "w - r*(-sin(theta)*s1 + cos(theta)*s2) == 0"
"""
#: Appell's: a weight on a thread that a rolling wheel winds up; a mass at rho before the wheel.
APPELL = """
title = "Appell's machine"
routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]
[variables]
x = { role = "coordinate" }
y = { role = "coordinate" }
z = { role = "coordinate" }
psi = { role = "coordinate" }
phi = { role = "coordinate" }
vx = { role = "velocity", of = "x" }
vy = { role = "velocity", of = "y" }
vz = { role = "velocity", of = "z" }
vpsi = { role = "velocity", of = "psi" }
vphi = { role = "velocity", of = "phi" }
[parameters]
m = { positive = true, default = 1 }
M = { positive = true, default = 2 }
I = { positive = true, default = 1 }
J = { positive = true, default = 1 }
a = { positive = true, default = 1 }
b = { positive = true, default = 1 }
rho = { default = 1 }
g = { default = 1 }
[definitions]
X = "vx - rho*sin(psi)*vpsi"
Y = "vy + rho*cos(psi)*vpsi"
[lagrangian]
l = "M*(X^2 + Y^2)/2 + m*(X^2 + Y^2 + vz^2)/2 + I*vphi^2/2 + J*vpsi^2/2 - m*g*z"
[constraints]
along = "vx == a*cos(psi)*vphi"
across = "vy == a*sin(psi)*vphi"
thread = "vz == b*vphi"
"""
#: Painleve's (1895): a rod slides with one end on a rough floor, its slip speed regularised by eps.
ROD = """
title = "A rod on a rough floor"
routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]
[variables]
x = { role = "coordinate" }
y = { role = "coordinate" }
theta = { role = "coordinate" }
u = { role = "velocity", of = "x" }
w = { role = "velocity", of = "y" }
om = { role = "velocity", of = "theta" }
[parameters]
m = { positive = true, default = 1 }
I = { positive = true, default = "1/3" }
l = { positive = true, default = 1 }
g = { default = 1 }
mu = { positive = true, default = 3 }
eps = { positive = true, default = 1 }
[definitions]
slip = "u + l*sin(theta)*om"
F = "-mu*floor_reaction*slip/sqrt(slip^2 + eps^2)"
[lagrangian]
l = "m*(u^2 + w^2)/2 + I*om^2/2 - m*g*y"
[constraints]
floor = "w - l*cos(theta)*om == 0"
[forces]
u = "F"
om = "F*l*sin(theta)"
"""


@cache
def derived(text: str, *changes: tuple[str, str]) -> dict[str, Equations]:
    """Equations by every route of a changed text, in one Setting."""
    declared = spec(text, *changes)
    setting = make_setting(declared)
    return {route: derive(declared, route, setting=setting) for route in declared.routes}


def motion(text: str, *changes: tuple[str, str], route: str = "nonholonomic") -> ConstrainedRates:
    """The motion of a changed text by one route."""
    return ConstrainedRates(derived(text, *changes)[route])


def about_routes(routes: Sequence[Equations]) -> Iterator[Examined]:
    """The claims about constrained motions that need no search."""
    along = ConstrainedRates(routes[0])
    yield from about_constraints(along)
    yield from about_equality(routes)
    yield from about_energy(along)
    yield from about_kept(along)
