"""What is conserved of a motion together with what is reconstructed from it: seen from space."""

import numpy as np
import pytest

from coadjoint.errors import SpecError
from coadjoint.pipeline import render
from coadjoint.prove import Verdict
from coadjoint.solve.folders import load_texts
from tests.kernels import COMPILER
from tests.specs import spec, verdicts_of

BODY = """
title = "A body seen from space"
routes = ["lie-poisson", "euler-poincare"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
Pi = { role = "momentum" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2"
[hamiltonian]
h = "dot(Pi, inverse(diag(I))*Pi)/2"
[reconstruction]
q = { attitude = "quaternion" }
R = { rate = "R*hat(Omega)", shape = [3, 3], default = [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }
x = { rate = "rotate(q, Omega)", shape = [3], default = [1, 2, 3] }
u = { rate = "vector(x1, x2, x3, Omega1)", shape = [4] }
[claims]
conserved = ["rotate(q, Pi)", "R*Pi", "R*transpose(R)", "dot(q, q)"]
"""
CLAIMS = ("rotate(q, Pi)", "R*Pi", "R*transpose(R)", "dot(q, q)")
#: A constant torque in body axes.
TORQUE = ("[reconstruction]", '[forces]\nOmega = "vector(0, 0, 1)"\n[reconstruction]')
#: Chaplygin's sleigh-like knife edge: velocities as the state, and its attitude as a matrix.
EDGE = """
title = "A body that cannot turn about one axis"
routes = ["nonholonomic"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2"
[constraints]
axis = "Omega1 == 0"
[reconstruction]
R = { rate = "R*hat(Omega)", shape = [3, 3], default = [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }
[claims]
conserved = ["R*transpose(R)"]
"""


def test_the_momentum_seen_from_space_is_proved_to_be_conserved():
    """By the quaternion, which may have any length, and by the matrix."""
    found = verdicts_of(BODY)
    assert set(found.values()) == {Verdict.PROVED}
    assert sum(f"{claim} is conserved" in found for claim in CLAIMS) == 4


@pytest.mark.parametrize(
    ("change", "refuted"),
    [
        (TORQUE, {"rotate(q, Pi)", "R*Pi"}),
        (('rate = "R*hat(Omega)"', 'rate = "hat(Omega)*R"'), {"R*Pi", "R*transpose(R)"}),
        (('"dot(q, q)"]', '"dot(q, q)", "x"]'), {"x"}),
        (('"dot(q, q)"]', '"dot(q, q)", "dot(Pi, x)"]'), {"dot(Pi, x)"}),
    ],
)
def test_wrong_laws_are_refuted(change, refuted):
    """A torque, a matrix that turns from the other side, what moves: each with a point."""
    found = verdicts_of(BODY, change)
    assert {s.removesuffix(" is conserved") for s, v in found.items() if v is Verdict.REFUTED} == (
        refuted
    )


def test_it_is_proved_of_constrained_motions():
    """Of velocities as the state; from the other side of space it fails."""
    assert verdicts_of(EDGE)["R*transpose(R) is conserved"] is Verdict.PROVED
    spoiled = verdicts_of(EDGE, ('rate = "R*hat(Omega)"', 'rate = "2*R*hat(Omega) + R"'))
    assert spoiled["R*transpose(R) is conserved"] is Verdict.REFUTED


@pytest.mark.parametrize("target", ["numpy", *(["c"] if COMPILER else [])])
def test_vectors_and_matrices_are_solved_for(target):
    """R is the matrix of q; both turn Pi to where it began; dx/dt is the momentum's velocity."""
    with load_texts(render(spec(BODY)).texts) as body:
        run = body.simulate([1.0, 2, 0.5], (0, 3), reconstruct=True, samples=7, target=target)
        R, q, Pi = run["R"], run["q"], run["Pi"]
        assert R.shape == (3, 3, 7)
        assert run["x"].shape == (3, 7)
        assert run["u"].shape == (4, 7)
        seen = np.einsum("ijt,jt->it", R, Pi)
        assert np.abs(seen - seen[:, :1]).max() < 1e-8
        s, v = q[0], q[1:]
        turned = Pi + 2 * np.cross(v, np.cross(v, Pi, axis=0) + s * Pi, axis=0)
        assert np.abs(turned - seen).max() < 1e-8
        assert np.abs(run["x"][:, 0] - [1, 2, 3]).max() == 0
        assert set(run.attitude_drift) == {"q"}
        given = body.simulate([1.0, 2, 0.5], (0, 1), reconstruct={"R": 2 * np.eye(3)}, samples=2)
        assert np.array_equal(given["R"][..., 0], 2 * np.eye(3))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            (", shape = [3], default", ", default"),
            r"Give its shape, as \{ rate = \.\.\., shape = \[3\] \}",
        ),
        ((", shape = [3], default", ", shape = [2], default"), "as 'x' is"),
        (('{ attitude = "quaternion" }', '{ attitude = "quaternion", shape = [4] }'), "shape goes"),
        (('"vector(x1, x2, x3, Omega1)"', '"x"'), "as 'u' is"),
    ],
)
def test_shapes_that_do_not_fit_are_refused(change, said):
    """With the place and the fix."""
    with pytest.raises(SpecError, match=said):
        spec(BODY, change)
