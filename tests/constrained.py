"""Small constrained systems as text, their equations short enough to be solved by hand."""

from __future__ import annotations

from functools import cache

from coadjoint.derive import Equations, derive, make_setting
from coadjoint.prove.constrained import ConstrainedRates
from tests.specs import spec

#: The constraint of many books, dz - y dx = 0.
PARTICLE = """
title = "A particle whose height follows its way"
routes = ["nonholonomic", "hamel"]
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
routes = ["nonholonomic", "hamel"]
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
routes = ["nonholonomic", "hamel"]
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
routes = ["nonholonomic", "hamel"]
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
routes = ["nonholonomic", "hamel"]
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


@cache
def derived(text: str, *changes: tuple[str, str]) -> dict[str, Equations]:
    """Equations by every route of a changed text, in one Setting."""
    declared = spec(text, *changes)
    setting = make_setting(declared)
    return {route: derive(declared, route, setting=setting) for route in declared.routes}


def motion(text: str, *changes: tuple[str, str], route: str = "nonholonomic") -> ConstrainedRates:
    """The motion of a changed text by one route."""
    return ConstrainedRates(derived(text, *changes)[route])
