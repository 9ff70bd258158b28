"""Runs keep attitudes rotations, whatever the method, and begin at rotations."""

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.constraints import Constraints
from coadjoint.solve.ensemble import Limits
from coadjoint.solve.folders import load_texts
from coadjoint.solve.normals import draw_normals
from coadjoint.solve.system import System
from tests.specs import render_claims, spec
from tests.turning import LEVEL, SHAKEN

Array = NDArray[np.float64]

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


@pytest.fixture(scope="module")
def bound() -> Iterator[System]:
    """A body that does not turn about the vertical."""
    with load_texts(render_claims(spec(LEVEL)).texts) as system:
        yield system


def turn(rate: Array, by: Any) -> Array:
    """Rodrigues' matrices of turns about a vector, by its length times numbers."""
    length = np.linalg.norm(rate)
    x, y, z = rate / length
    hat = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.multiply.outer(length * np.asarray(by), np.ones((3, 3)))
    return np.eye(3) + np.sin(angle) * hat + (1 - np.cos(angle)) * (hat @ hat)


@pytest.mark.parametrize(
    ("options", "most"),
    [
        ({"method": "rk4", "step": 0.02}, 1e-6),
        ({"method": "taylor"}, 1e-10),
        ({"method": "scipy:DOP853", "rtol": 1e-8}, 1e-6),
    ],
    ids=["rk4", "taylor", "scipy"],
)
def test_attitudes_stay_rotations_under_constraints(bound, options, most, monkeypatch):
    """A ball among such bodies turns about one horizontal axis: its constraint does no work."""
    Omega = np.array([1.0, 2, 0])
    start, ball = {"R": np.eye(3), "Omega": Omega}, {"I": [1, 1, 1]}
    again = {"samples": 6, "target": "numpy", **options}
    run = bound.simulate(start, (0, 5), ball, **again)
    assert np.abs(np.moveaxis(run["R"], 2, 0) - turn(Omega, run.time)).max() < most
    run = bound.simulate(start, (0, 5), **again)
    kept = np.abs(bound.constraint_residual(run.state, run.parameters)).max()
    assert kept < 4e-15
    told = "after each step and at each sample, onto "
    told += "dot(transpose(R)*vector(0, 0, 1), Omega) == 0, R*transpose(R) == 1, det(R) == 1"
    assert run.settings["projection"] == told
    monkeypatch.setattr(Constraints, "project", lambda self, time, state: state.copy())
    monkeypatch.setattr(Limits, "project", lambda self, lanes, after, state: state)
    run = bound.simulate(start, (0, 5), **again)
    assert np.abs(bound.constraint_residual(run.state, run.parameters)).max() > 100 * kept


def test_methods_with_a_memory_are_moved_at_samples_alone(bound):
    """And say so."""
    start = {"R": np.eye(3), "Omega": [1.0, 2, 0]}
    run = bound.simulate(start, (0, 1), samples=3, target="numpy", method="scipy:LSODA")
    assert run.settings["projection"].startswith("at each sample, onto dot(")
    assert np.abs(bound.constraint_residual(run.state, run.parameters)).max() < 4e-15


def test_neither_move_undoes_the_other(bound):
    """A state far from rotations is on the constraint of the rotations to which it was moved."""
    source = np.random.default_rng(1)
    R = np.moveaxis(turn(np.array([0.3, -0.5, 0.7]), np.arange(1.0, 9)), 0, -1)
    state = np.concatenate(
        [(R + 0.01 * source.normal(size=R.shape)).reshape(9, 8), np.ones((3, 8))]
    )
    moved = bound.projection(state, target="numpy")
    rows = dict(
        zip(bound.certificate["constraints"], bound.constraint_residual(moved), strict=True)
    )
    assert np.abs(rows.pop("level")).max() < 1e-15
    before = np.abs(bound.constraint_residual(state)[1:]).max()
    assert 1e-6 < np.abs([*rows.values()]).max() < 4 * before**2


@pytest.fixture(scope="module")
def shaken() -> Iterator[System]:
    """A ball that is turned about its third axis at random."""
    with load_texts(render_claims(spec(SHAKEN)).texts) as system:
        yield system


SHAKES = {"R": np.eye(3), "Pi": [1.0, 2, 3]}


@pytest.mark.parametrize(("method", "most"), [("heun", 1e-6), ("midpoint", 2e-15)])
def test_attitudes_stay_rotations_with_noise(shaken, method, most, monkeypatch):
    """Heun's method alone loses them; the midpoint keeps them to roundings by its own update."""
    again = {"samples": 11, "target": "numpy", "method": method, "step": 0.02, "seed": 1}
    run = shaken.simulate(SHAKES, (0, 4), **again)
    assert run.drift["R_gram"] < most
    told = "after each step and at each sample, onto R*transpose(R) == 1, det(R) == 1"
    assert run.settings["projection"] == told
    own = "linear integrals" if method == "heun" else "linear and quadratic integrals"
    assert run.settings["keeps"].startswith(own)
    monkeypatch.setattr(Limits, "project", lambda self, lanes, after, state: state)
    alone = shaken.simulate(SHAKES, (0, 4), **again).drift["R_gram"]
    assert alone > 100 * most if method == "heun" else alone < 1e-13


@pytest.mark.parametrize("method", ["heun", "midpoint"])
def test_moving_back_leaves_the_strong_order(shaken, method):
    """R = exp(t hat(Pi0)) turned by s W(t) about its third axis: one process, so the order is 1."""
    members, errors = 200, []
    start = np.repeat(np.append(np.eye(3), [1.0, 2, 3])[:, None], members, axis=1)
    for count in (16, 64):
        run = shaken.simulate(
            start, (0, 1), samples=1, target="numpy", method=method, step=1 / count, seed=5
        )
        places = np.indices((members, count)).astype(np.uint64).reshape(2, -1)
        normals = draw_normals(5, *places, 0).reshape(members, count)
        W = normals.sum(axis=1) / np.sqrt(count)
        exact = turn(np.array([1.0, 2, 3]), 1.0) @ turn(np.array([0.0, 0, 1]), 0.5 * W)
        errors.append(np.abs(np.moveaxis(run["R"][..., -1], 2, 0) - exact).mean())
    assert np.log2(errors[0] / errors[1]) / 2 > 0.9
