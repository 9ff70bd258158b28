"""Bodies that roll as text, and systems of such texts without what regenerating them proves."""

from __future__ import annotations

from functools import cache

from coadjoint.derive import Equations, derive
from coadjoint.lower.lowering import lower
from coadjoint.prove.declaration import kernel_context
from coadjoint.render.kernels import render_system
from coadjoint.solve.folders import load_folder
from coadjoint.solve.system import System
from tests.constrained import SLEIGH
from tests.specs import spec
from tests.trees_of_files import folder_until_exit

#: A ball whose centre of mass is at chi; s, from the contact to there, is an expression to replace.
BALL = """
title = "A ball"
routes = ["nonholonomic"]
[algebra]
name = "se(3)"
[variables]
Omega = { role = "velocity", block = "rotation", unit = "1/s" }
Y = { role = "velocity", block = "translation", unit = "m/s" }
Gamma = { role = "advected", representation = "vector" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
m = { positive = true, default = 1 }
r = { default = 1, unit = "m" }
g = { default = 2 }
chi = { shape = [3], default = ["0.1", "0.2", "0.3"], unit = "m" }
[definitions]
s = "r*Gamma + chi"
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2 + m*dot(Y, Y)/2 - m*g*dot(Gamma, chi)"
[constraints]
rolling = "Y == cross(Omega, s)"
[rolling]
arm = "s"
normal = "Gamma"
[claims]
conserved = ["energy"]
"""
#: A disk on its rim: the change of the ball's text.
DISK = (
    ("r*Gamma + chi", "r/sqrt(Gamma1^2 + Gamma2^2)*vector(Gamma1, Gamma2, 0)"),
    ("dot(Gamma, chi)", "r*sqrt(Gamma1^2 + Gamma2^2)"),
)
#: Where the blade is on the plane.
FOLLOWED_SLEIGH = (
    SLEIGH
    + """
[reconstruction]
theta = "omega"
x = { rate = "v*cos(theta)", unit = "m" }
y = { rate = "v*sin(theta)", unit = "m", default = 3 }
"""
)


@cache
def derived(text: str, *changes: tuple[str, str]) -> Equations:
    """The equations of a text with some pieces replaced."""
    return derive(spec(text, *changes))


@cache
def built(text: str, *changes: tuple[str, str]) -> System:
    """The System of a text, in a folder of its own."""
    equations = derived(text, *changes)
    folder = folder_until_exit() / "sample"
    folder.mkdir()
    for name, content in render_system(kernel_context(equations, lower(equations))).items():
        (folder / name).write_text(content)
    return load_folder(folder)
