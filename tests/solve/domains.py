"""Systems with a domain, as specs: they are derived, rendered and loaded without a compiler."""

from __future__ import annotations

from functools import cache

from coadjoint.solve.folders import load_folder
from coadjoint.solve.system import System
from tests.specs import render_claims, spec
from tests.trees_of_files import folder_until_exit

#: A stone above the ground, which it reaches from rest after sqrt(2 h/g).
STONE = """
title = "A stone that falls"
routes = ["euler-lagrange"]
[variables]
h = { role = "coordinate", default = 2 }
v = { role = "velocity", of = "h" }
p = { role = "momentum", of = "h", default = 0 }
[parameters]
m = { positive = true, default = 1 }
g = { default = 1 }
[lagrangian]
l = "m*v^2/2 - m*g*h"
[domain]
above = "h > 0"
heavy = "m >= g"
"""

#: The straight fall of Kepler's problem.
KEPLER = """
title = "Fall to a centre"
routes = ["euler-lagrange"]
[variables]
r = { role = "coordinate", default = 2 }
v = { role = "velocity", of = "r" }
p = { role = "momentum", of = "r", default = 0 }
[parameters]
m = { positive = true, default = 1 }
k = { default = 1 }
closest = { default = 0 }
[lagrangian]
l = "m*v^2/2 + k/r"
[domain]
apart = "r > closest"
"""

#: A motion whose momentum is v/sqrt(1 + v^2), of a size below 1, and grows by x.
BENT = """
title = "A bounded momentum"
routes = ["euler-lagrange", "canonical"]
[variables]
x = { role = "coordinate", default = 0 }
p = { role = "momentum", of = "x", default = "0.5" }
v = { role = "velocity", of = "x" }
[lagrangian]
l = "sqrt(1 + v^2) + x^2/2"
"""

#: Holm 12.2.3: a disk of radius r on its sharp rim, which cannot lie flat.
DISK = """
title = "Disk"
routes = ["nonholonomic"]
[algebra]
name = "se(3)"
[variables]
Omega = { role = "velocity", block = "rotation" }
Y = { role = "velocity", block = "translation" }
Gamma = { role = "advected", representation = "vector" }
[parameters]
I1 = { positive = true, default = 1 }
I3 = { positive = true, default = 2 }
m = { positive = true, default = 1 }
r = { default = 1 }
g = { default = "9.81" }
margin = { default = "0.0001" }
[definitions]
sine = "sqrt(Gamma1^2 + Gamma2^2)"
s = "r/sine*vector(Gamma1, Gamma2, 0)"
[lagrangian]
l = "I1*(Omega1^2 + Omega2^2)/2 + I3*Omega3^2/2 + m*dot(Y, Y)/2 - m*g*r*sine"
[constraints]
rolling = "Y == cross(Omega, s)"
[domain]
tilted = "Gamma1^2 + Gamma2^2 > margin"
"""

#: Holm 12.1.2: Chaplygin's ball of radius r, whose centre of mass is inside.
BALL = """
title = "Ball"
routes = ["nonholonomic"]
[algebra]
name = "se(3)"
[variables]
Omega = { role = "velocity", block = "rotation" }
Y = { role = "velocity", block = "translation" }
Gamma = { role = "advected", representation = "vector" }
[parameters]
I = { shape = [6], form = "symmetric", default = [1, 0, 0, 2, 0, 3] }
m = { positive = true, default = 1 }
r = { default = 1 }
g = { default = "9.81" }
chi = { shape = [3], default = ["0.1", "0.2", "0.3"] }
[definitions]
s = "r*Gamma + chi"
[lagrangian]
l = "dot(Omega, I*Omega)/2 + m*dot(Y, Y)/2 - m*g*dot(Gamma, chi)"
[constraints]
rolling = "Y == cross(Omega, s)"
[domain]
inside = "dot(chi, chi) <= r^2"
"""

#: Suslov's problem: a . Omega = 0, with a multiplier.
SUSLOV = """
title = "Suslov"
routes = ["nonholonomic"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
[parameters]
I = { shape = [3], default = [1, 2, 3] }
a = { shape = [3], default = [1, 2, 2] }
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2"
[constraints]
wheels = "dot(a, Omega) == 0"
"""


@cache
def built(text: str, *changes: tuple[str, str]) -> System:
    """The System of a spec, proved but not compiled: use the target ``numpy``."""
    folder = folder_until_exit()
    for name, content in render_claims(spec(text, *changes)).texts.items():
        (folder / name).write_text(content)
    return load_folder(folder)
