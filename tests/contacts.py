"""Bodies that roll on surfaces as text, and states of theirs in contact."""

from __future__ import annotations

import numpy as np

from coadjoint.derive import Equations
from coadjoint.derive.reference import Reference

#: A ball in a vertical cylinder; its surface, the constraint and what more is said are to replace.
BALL_INSIDE = """
title = "A ball inside a surface"
routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]
[algebra]
name = "so(3)"
invariance = "right"
[variables]
omega = { role = "velocity", unit = "1/s", default = [0, 1, 5] }
c = { role = "coordinate", shape = [3], unit = "m", default = [2, 0, 0] }
v = { role = "velocity", of = "c", unit = "m/s" }
X = { role = "contact", unit = "m", default = [3, 0, 0] }
[parameters]
I = { positive = true, default = "0.4", unit = "kg m^2" }
m = { positive = true, default = 1, unit = "kg" }
r = { positive = true, default = 1, unit = "m" }
b = { positive = true, default = 3, unit = "m" }
g = { default = "9.81", unit = "m/s^2" }
W = { default = "0.7", unit = "1/s" }
[lagrangian]
l = "I*dot(omega, omega)/2 + m*dot(v, v)/2 - m*g*c3"
[constraints]
rolling = "v == cross(omega, c - X)"
[rolling]
arm = "c - X"
radius = "r"
surface = "b^2 - X1^2 - X2^2"
contact = "X"
"""
#: The same ball in a sphere, and on a turntable.
IN_SPHERE = (("b^2 - X1^2 - X2^2", "(b + r)^2 - X1^2 - X2^2 - X3^2"),)
TURNS = 'contact = "X"\nturning = "vector(0, 0, W)"'
ON_TURNTABLE = (
    ("b^2 - X1^2 - X2^2", "X3"),
    ("cross(omega, c - X)", "cross(omega, c - X) + cross(vector(0, 0, W), X)"),
    ('contact = "X"', TURNS),
)
#: An ellipsoid inside a paraboloid; its surface is to replace.
ELLIPSOID = """
title = "An ellipsoid that rolls in a paraboloid"
routes = ["nonholonomic", "hamel"]
[algebra]
name = "se(3)"
[variables]
Omega = { role = "velocity", block = "rotation", unit = "1/s", default = [1, 2, 3] }
Y = { role = "velocity", block = "translation", unit = "m/s" }
E1 = { role = "advected", representation = "vector", unit = "1", default = [1, 0, 0] }
E2 = { role = "advected", representation = "vector", unit = "1", default = [0, 1, 0] }
E3 = { role = "advected", representation = "vector", unit = "1", default = [0, 0, 1] }
s = { role = "contact", unit = "m", default = [0, 0, "-0.4"] }
X = { role = "contact", unit = "m", default = [0, 0, 0] }
[parameters]
I = { shape = [3], positive = true, default = ["0.05", "0.06", "0.04"], unit = "kg m^2" }
m = { positive = true, default = 1, unit = "kg" }
g = { default = "9.81", unit = "m/s^2" }
a = { shape = [3], positive = true, default = ["0.3", "0.25", "0.4"], unit = "m" }
b = { positive = true, default = 2, unit = "m" }
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2 + m*dot(Y, Y)/2 - m*g*(X3 - dot(E3, s))"
[constraints]
rolling = "Y == cross(s, Omega)"
[rolling]
arm = "-s"
body = "(a2*a3*s1)^2 + (a1*a3*s2)^2 + (a1*a2*s3)^2 - (a1*a2*a3)^2"
point = "s"
surface = "2*b*X3 - X1^2 - X2^2"
contact = "X"
axes = ["E1", "E2", "E3"]
[claims]
conserved = ["energy"]
"""
ON_PLANE = (("2*b*X3 - X1^2 - X2^2", "X3"),)


def rates_at(equations: Equations, state: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The rates of every variable at a state, with the defaults of the parameters, in doubles."""
    return by_variable(equations, values_at(equations, state, "rhs"))


def by_variable(equations: Equations, values: list[float]) -> dict[str, np.ndarray]:
    """Values of the components of the state, by variable."""
    found = dict(zip(equations.setting.state, values, strict=True))
    return {v.name: np.array([found[n] for n in v.components]) for v in equations.spec.state}


def values_at(equations: Equations, state: dict[str, np.ndarray], function: str) -> list[float]:
    """What a kernel function is at a state, from the equations themselves."""
    known = {
        name: float(x)
        for each in equations.spec.parameters
        for name, x in zip(each.components, each.default, strict=True)
    }
    for each in equations.spec.state:
        known |= zip(each.components, np.ravel(state[each.name]).tolist(), strict=True)
    reference = Reference(equations)
    call = {"sqrt": np.sqrt}
    return reference.evaluate(function, known, float, lambda f, *x: float(call[f](*x)))


def turned(axis: np.ndarray) -> np.ndarray:
    """The rotation by a vector (Rodrigues)."""
    angle = np.linalg.norm(axis)
    if angle == 0:
        return np.eye(3)
    x, y, z = axis / angle
    hat = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * hat + (1 - np.cos(angle)) * hat @ hat


def aligned(old: np.ndarray, new: np.ndarray, twist: float) -> np.ndarray:
    """A rotation that takes one unit vector to another, after a twist about it."""
    axis = np.cross(old, new)
    size = np.linalg.norm(axis)
    angle = np.arctan2(size, old @ new)
    return turned(axis / size * angle) @ turned(twist * old)
