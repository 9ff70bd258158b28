"""Driven systems for tests: specs with inputs and time, as text and built."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from coadjoint.pipeline import Rendered
from coadjoint.solve.folders import load_folder
from coadjoint.solve.system import System
from tests.specs import render_claims, spec

#: A pendulum whose pivot moves up and down by a cos(w t), driven by a torque u.
PENDULUM = """
title = "Driven pendulum"
routes = ["euler-lagrange", "canonical"]
[variables]
phi = { role = "coordinate", unit = "rad" }
v = { role = "velocity", of = "phi" }
p = { role = "momentum", of = "phi" }
[parameters]
L = { positive = true, default = 1 }
g = { positive = true, default = "9.81" }
a = { default = "0.1" }
w = { positive = true, default = 5 }
[inputs]
u = { default = 0, unit = "1/s^2", doc = "torque" }
[time]
name = "t"
[lagrangian]
l = "(L*v)^2/2 - L*a*w*sin(w*t)*sin(phi)*v + g*L*cos(phi) + u*phi"
"""
#: A free particle with the integral of Galilean boosts, K = t P - m r.
BOOST = """
title = "Free particle"
routes = ["canonical"]
[variables]
r = { role = "coordinate", shape = [3] }
P = { role = "momentum", of = "r" }
[parameters]
m = { positive = true, default = 2 }
[time]
name = "t"
[hamiltonian]
h = "dot(P, P)/(2*m)"
[observables]
K = "t*P - m*r"
[claims]
conserved = ["energy", "K"]
"""
#: A heavy body in a field that is an input.
TOP = """
title = "Heavy top in a field that changes"
routes = ["euler-poincare", "lie-poisson", "hamilton-pontryagin", "poincare", "newton-euler"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
Pi = { role = "momentum" }
Gamma = { role = "advected", representation = "vector" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
[inputs]
u = { shape = [3], default = [0, 0, 1] }
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2 - dot(u, Gamma)"
[claims]
casimirs = ["dot(Gamma, Gamma)", "dot(Pi, Gamma)"]
conserved = ["energy", "dot(Pi, Gamma)"]
"""
#: Suslov's body, driven by a torque.
SUSLOV = """
title = "Suslov's body with a torque"
routes = ["nonholonomic", "hamel"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
[inputs]
u = { shape = [3], default = 0, unit = "N m" }
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2"
[constraints]
knife = "Omega[3] == 0"
[forces]
Omega = "u"
"""
#: A particle in a plane whose velocities are the state, with a mass that grows with time.
VELOCITIES = """
title = "Growing mass"
routes = ["euler-lagrange", "canonical"]
[variables]
x = { role = "coordinate", shape = [2] }
v = { role = "velocity", of = "x" }
[parameters]
c = { positive = true, default = 1 }
[inputs]
u = { shape = [2], default = 0 }
[time]
name = "t"
[lagrangian]
l = "exp(c*t)*dot(v, v)/2 + dot(u, x) + t*v[1]"
"""
#: A bead on a rod that turns with the angle t^2/2: the constraint moves.
ROD = """
title = "Bead on a turning rod"
routes = ["nonholonomic", "hamel"]
[variables]
x = { role = "coordinate" }
y = { role = "coordinate" }
vx = { role = "velocity", of = "x" }
vy = { role = "velocity", of = "y" }
[parameters]
m = { positive = true, default = 1 }
[inputs]
f = { default = 0 }
[time]
name = "t"
[lagrangian]
l = "m*(vx^2 + vy^2)/2"
[constraints]
belt = "vy == t^2*vx + sin(t)"
[forces]
vx = "f"
"""
#: The same, its belt moved by an input whose rate is another one.
BELT = ROD.replace("sin(t)", "b").replace(
    "f = { default = 0 }",
    'f = { default = 0 }\nb = { default = 0, rate = "db" }\ndb = { default = 0 }',
)
#: A particle driven by a force.
POINT = """
title = "Pushed particle"
routes = ["newton"]
[variables]
x = { role = "coordinate" }
v = { role = "velocity", of = "x" }
[parameters]
m = { positive = true, default = 2 }
[inputs]
f = { default = 3, unit = "N" }
k = { shape = [2], default = [0, 1] }
[newton]
x = { mass = "m", force = "f + k[1]*v*k[2]" }
"""


def rendered(text: str, *changes: tuple[str, str], name: str = "sample") -> Rendered:
    """A driven system as text, proved."""
    return render_claims(spec(text, *changes, name=name))


def build(texts: Mapping[str, str], folder: Path) -> System:
    """The System of rendered texts, in a folder."""
    folder.mkdir(exist_ok=True)
    for name, text in texts.items():
        (folder / name).write_text(text)
    return load_folder(folder)
