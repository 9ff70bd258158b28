"""Small specs that declare their own algebra, and the error that a changed one gives."""

from functools import partial

from tests import specs

BY_BRACKETS = """
title = "Heisenberg"
routes = ["lie-poisson"]
[algebra]
basis = ["e1", "e2", "e3"]
brackets = { "[e1, e2]" = "e3" }
blocks = { plane = ["e1", "e2"], centre = ["e3"] }
[representations.shift]
matrices = { e1 = [[0, 1], [0, 0]] }
[variables]
p = { role = "momentum", block = "plane" }
c = { role = "momentum", block = "centre" }
a = { role = "advected", representation = "shift" }
[hamiltonian]
h = "dot(p, p)/2 + c*a[1]"
"""
BY_MATRICES = """
title = "Rotations"
routes = ["lie-poisson"]
[algebra.matrices]
J1 = [[0, 0, 0], [0, 0, -1], [0, 1, 0]]
J2 = [[0, 0, 1], [0, 0, 0], [-1, 0, 0]]
J3 = [[0, -1, 0], [1, 0, 0], [0, 0, 0]]
[variables]
Pi = { role = "momentum" }
Gamma = { role = "advected", representation = "vector" }
[hamiltonian]
h = "dot(Pi, Pi)/2 + Gamma1"
"""


#: The error that a changed spec gives.
refused = partial(specs.refused, text=BY_BRACKETS)


def check_shown(error, key, found, said):
    """A misfit is named with its key, what was found and what would fit, and has a caret."""
    assert (error.key, error.found) == (key, found)
    assert said in str(error)
    assert str(error).endswith("^")
