"""Observables of what is reconstructed: emitted, proved to be conserved, and shown in solutions."""

import numpy as np
import pytest

from coadjoint.derive import derive
from coadjoint.errors import KernelArgumentError, SpecError
from coadjoint.lower.check import check_inverse
from coadjoint.lower.lowering import lower
from coadjoint.prove import Verdict
from coadjoint.prove.declaration import kernel_context
from tests.kernels import COMPILER
from tests.solve.systems import build
from tests.specs import prove_claims, spec

#: A sleigh whose mass is over the blade: it turns about a fixed centre.
SLEIGH = """
title = "A sleigh, seen from the plane"
routes = ["nonholonomic"]
[algebra]
name = "se(2)"
[variables]
omega = { role = "velocity", block = "rotation", unit = "1/s", default = 1 }
v     = { role = "velocity", block = ["P1"], unit = "m/s", default = 2 }
u     = { role = "velocity", block = ["P2"], unit = "m/s" }
[parameters]
l = { positive = true, default = 1, unit = "m" }
m = { positive = true, default = 1, unit = "kg" }
[lagrangian]
l = "m*(v^2 + u^2 + (l*omega)^2)/2"
[constraints]
blade = "u == 0"
[reconstruction]
theta = "omega"
x = { rate = "v*cos(theta)", default = 1, unit = "m" }
y = { rate = "v*sin(theta)", unit = "m" }
[domain]
turning = "omega > 0"
[observables]
far = { expression = "sqrt(x^2 + y^2)", unit = "m" }
spin = "omega"
centre = { expression = "vector(x - v*sin(theta)/omega, y + v*cos(theta)/omega)", unit = "m" }
[claims]
conserved = ["energy", "centre"]
"""


def test_they_are_no_observables_of_the_state():
    """A function of their own has them, and is undone exactly; claims may name them."""
    equations = derive(spec(SLEIGH))
    assert "far" not in equations.observables
    assert "spin" in equations.observables
    programs = lower(equations)
    own = programs["reconstructed_observables"]
    assert [output.label for output in own.outputs] == ["far", "centre1", "centre2"]
    assert own.state == ("omega", "v", "theta", "x", "y")
    check_inverse(equations, own)
    assert prove_claims(spec(SLEIGH)).holds
    wrong = prove_claims(spec(SLEIGH, ('"energy", "centre"', '"far"'))).claims
    assert [c.verdict for c in wrong if c.statement == "far is conserved"] == [Verdict.REFUTED]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("[claims]", '[claims]\ncasimirs = ["far"]'), "far"),
        (('"sqrt(x^2 + y^2)"', '"x*y"'), r"the value has the unit m.2; expected m"),
        (('"u == 0"', '"u == far"'), "far"),
    ],
)
def test_where_they_may_not_stand_they_are_refused(change, message):
    """In Casimirs and constraints; and their units are checked."""
    with pytest.raises(SpecError, match=message):
        spec(SLEIGH, change)


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
def test_a_solution_has_them_where_it_reconstructs(tmp_path):
    """From (1, 0) about (1, 2) with the radius 2, in NumPy and in C with the same bits."""
    equations = derive(spec(SLEIGH))
    sleigh = build(kernel_context(equations, lower(equations), 0), tmp_path)
    runs = [
        sleigh.simulate([1, 2], (0, 3), reconstruct=True, samples=7, target=target)
        for target in ("c", "numpy")
    ]
    for run in runs:
        x, y = 1 + 2 * np.sin(run.time), 2 - 2 * np.cos(run.time)
        assert run["far"] == pytest.approx(np.hypot(x, y), abs=1e-9)
        assert run["centre"] == pytest.approx(np.array([[1] * 7, [2] * 7]), abs=1e-9)
        assert run.unit("far") == "m"
    rows = np.concatenate([runs[0].state, runs[0].reconstructed])
    found = [sleigh.reconstructed_observables(rows, target=each) for each in ("c", "numpy")]
    assert found[0][0].tobytes() == found[1][0].tobytes()  # of + * sqrt alone
    with pytest.raises(KernelArgumentError, match="reconstruct=True for theta, x, y, far, centre"):
        sleigh.simulate([1, 2], (0, 3))["far"]
