"""Small specs that declare their own algebra, and the error that a changed one gives."""

import pytest

from coadjoint.errors import SpecError
from tests.specs import spec

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


def refused(*changes, text=BY_BRACKETS, kind=SpecError):
    """The error that a changed spec gives."""
    with pytest.raises(kind) as caught:
        spec(text, *changes)
    return caught.value
