"""Runs keep attitudes rotations, whatever the method, and begin at rotations."""

import re
from collections.abc import Iterator

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.constraints import Constraints
from coadjoint.solve.ensemble import Limits
from coadjoint.solve.system import System, load_texts
from tests.specs import render_claims, spec

#: A body without torque, whose attitude is the state twice.
TEXT = """
title = "A free body by its attitude"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
q = { role = "quaternion" }
R = { role = "attitude" }
Pi = { role = "momentum", default = [1, 2, 3] }
[hamiltonian]
h = "Pi1^2/2 + Pi2^2/4 + Pi3^2/6"
"""
START = {"q": [0.6, 0, 0, 0.8], "R": np.eye(3), "Pi": [1, 2, 3]}


@pytest.fixture(scope="module")
def body() -> Iterator[System]:
    """The system, with its kernel in NumPy alone."""
    with load_texts(render_claims(spec(TEXT)).texts) as system:
        yield system


def defects(run):
    """How far the attitudes of a run are from rotations."""
    R, q = run["R"], run["q"]
    off = np.einsum("ijt,kjt->ikt", R, R) - np.eye(3)[..., np.newaxis]
    return max(np.abs(off).max(), np.abs((q**2).sum(axis=0) - 1).max())


@pytest.mark.parametrize(
    ("options", "most"),
    [
        ({"method": "rk4", "step": 0.1}, 1e-11),  # the square of what one step loses
        ({"method": "rk4", "step": 0.02}, 1e-15),
        ({"method": "scipy:RK23"}, 1e-15),
    ],
)
def test_attitudes_stay_rotations(body, options, most, monkeypatch):
    """To roundings where steps are small, and the same steps alone lose them."""
    again = {"samples": 11, "target": "numpy", **options}
    run = body.simulate(START, (0, 5), **again)
    assert run["R"].shape == (3, 3, 11)
    assert defects(run) < most
    assert run.drift.keys() == {"energy", "q_gram", "R_gram", "Pi_spatial"}
    monkeypatch.setattr(Constraints, "project", lambda self, time, state: state.copy())
    monkeypatch.setattr(Limits, "project", lambda self, lanes, after, state: state)
    assert defects(body.simulate(START, (0, 5), **again)) > 100 * most


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ({"q": [1.5, 0, 0, 0]}, "q_gram, dot(q, q) == 1,"),
        ({"q": [1.5, 0, 0, 0]}, "has q0 = 1: begin there."),
        ({"R": np.diag([1.0, 1, -1])}, "R_det, det(R) == 1, does not hold"),
        ({"R": [[1, 0.5, 0], [0, 1, 0], [0, 0, 1]]}, "R_gram"),
    ],
)
def test_a_start_that_is_no_rotation_is_refused(body, wrong, told):
    """Also a mirror; a start that is near a rotation is told which one."""
    with pytest.raises(KernelArgumentError, match=re.escape(told)):
        body.simulate({**START, **wrong}, (0, 1), target="numpy", method="rk4", step=0.1)


def test_digits_that_were_typed_are_enough(body):
    """A start off by roundings of ten digits is moved onto the rotations."""
    start = {**START, "q": [0.7071067812, 0, 0, 0.7071067812]}
    run = body.simulate(start, (0, 1), samples=2, target="numpy", method="rk4", step=0.02)
    assert defects(run) < 1e-15
