"""Noise on coadjoint orbits: what methods keep on each path, and their orders."""

import math

import numpy as np
import pytest

from coadjoint import pipeline
from coadjoint.errors import KernelArgumentError
from coadjoint.methods import Sphere
from coadjoint.solve.folders import load_texts
from coadjoint.solve.steps import Lanes
from coadjoint.solve.stochastic import CoadjointMean, Midpoint, Orbits, SphericalMidpoint
from coadjoint.spec.reader import read_spec_text
from coadjoint.systems import stochastic_rigid_body as body

#: Noise about two axes of the body and of the vertical, which do not commute.
HEAVY = """
title = "A heavy top with noise"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
Pi = { role = "momentum", default = [0.4, -0.3, 1.2] }
Gamma = { role = "advected", representation = "vector", default = [0.6, 0, 0.8] }
[hamiltonian]
h = "Pi1^2/2 + Pi2^2/4 + Pi3^2/6 + Gamma1/5 + Gamma3"
[noise]
dW1 = "Pi1/5"
dW2 = "3*Pi2/10"
dW3 = "Gamma3/4"
[claims]
casimirs = ["dot(Gamma, Gamma)", "dot(Pi, Gamma)"]
conserved = ["dot(Gamma, Gamma)", "dot(Pi, Gamma)"]
"""
START = np.array([0.4, -0.3, 1.2, 0.6, 0.0, 0.8])


@pytest.fixture(scope="module")
def top():
    """A heavy top with noise."""
    with load_texts(pipeline.render(read_spec_text(HEAVY, "top.toml")).texts) as system:
        yield system


@pytest.mark.parametrize("target", ["numpy", "c"])
def test_casimirs_are_kept_on_each_path(top, target):
    """Of a top, and of a body on one sphere, by implicit methods; by Heun's method they are not."""
    members = np.repeat(START[:, np.newaxis], 9, axis=1)
    given = {"step": 0.0625, "samples": 33, "seed": 3, "target": target}
    others = ("spherical_midpoint", "midpoint", "heun")
    for system, start, methods in (
        (top, members, ("coadjoint_mean", *others)),
        (body, members[:3], others),
    ):
        drifts = {}
        for method in methods:
            run = system.simulate(start, (0, 6), method=method, **given)
            assert (run.status == "OK").all()
            own = [run.drift[name] for name in run.drift if name.startswith("casimir")]
            assert len(own) == len(start) // 3
            drifts[method] = np.max(own)
            assert np.ptp(run.state[0, :, -1]) > 0.1  # paths differ
        assert drifts.get("coadjoint_mean", 0.0) < 1e-13
        assert drifts["spherical_midpoint"] < 1e-13
        assert drifts["midpoint"] < 1e-12
        assert drifts["heun"] > 1e-6


#: A cubic Casimir, that of sl(3): what no method for quadratic integrals keeps.
CUBIC = """
title = "A motion on sl(3,R) with noise"
routes = ["lie-poisson"]
[algebra]
name = "sl(3,R)"
[variables]
mu = { role = "momentum" }
[hamiltonian]
h = "(mu1^2 + 2*mu2^2 + mu3^2 + 3*mu4^2 + mu5^2 + mu6^2 + 2*mu7^2 + mu8^2)/2 + mu1^3/9 + mu3*mu4"
[noise]
dW1 = "mu1/5 + mu4/7"
dW2 = "mu2*mu8/4"
"""


def test_casimirs_of_an_algebra_without_spheres():
    """Coefficients of the characteristic polynomial of sl(3), from the matrix by NumPy's own."""
    rendered = pipeline.render(read_spec_text(CUBIC, "motion.toml"))
    basis = np.zeros((8, 3, 3))
    for place, matrix in enumerate(rendered.equations.setting.algebra.matrices):
        for entry, value in matrix.items():
            basis[place][entry] = float(value)
    dual = np.linalg.inv(np.einsum("aij,bji->ab", basis, basis))

    def list_casimirs(mu):
        whole = np.einsum("an,ab,bij->nij", mu, dual, basis)
        return np.array([np.trace(whole @ whole, axis1=1, axis2=2), np.linalg.det(whole)])

    start = 0.4 * np.random.default_rng(2).normal(size=(8, 5))
    drifts = {}
    with load_texts(rendered.texts) as motion:
        for method in ("coadjoint_mean", "midpoint"):
            run = motion.simulate(start, (0, 2), method=method, step=1 / 32, seed=3, target="numpy")
            assert (run.status == "OK").all()
            assert np.ptp(run.state[0, :, -1]) > 0.1
            drifts[method] = np.abs(list_casimirs(run.state[..., -1]) - list_casimirs(start)).max()
    assert drifts["coadjoint_mean"] < 1e-14
    assert drifts["midpoint"] > 1e-7
    with load_texts(rendered.texts) as motion:  # the default is what keeps the cubic one
        run = motion.simulate(start, (0, 2), step=1 / 32, seed=3, target="numpy")
    assert run.settings["method"] == "coadjoint_mean"
    assert "bracket is linear" in run.settings["chosen"]
    assert np.abs(list_casimirs(run.state[..., -1]) - list_casimirs(start)).max() < 1e-14


@pytest.mark.parametrize("method", ["coadjoint_mean", "spherical_midpoint"])
def test_bits_are_those_of_the_twin(top, method):
    """Whatever the company."""
    start = np.random.default_rng(0).normal(size=(6, 11))
    given = {"method": method, "step": 0.125, "samples": 5, "seed": 4}
    one = top.simulate(start, (0, 2), target="numpy", **given)
    other = top.simulate(start, (0, 2), target="c", threads=2, **given)
    np.testing.assert_array_equal(one.state, other.state)
    assert one.settings["keeps"].startswith("Casimirs")
    midpoint = top.simulate(start, (0, 2), target="c", **(given | {"method": "midpoint"}))
    assert np.abs(midpoint.state - one.state).max() > 1e-6


def test_a_step_is_a_poisson_map(top):
    """``D J(x) D^T = J(y)`` by differences, with the same noise; the midpoint is none."""
    eps, n = 1e-5, 6
    columns = START[:, np.newaxis]
    states = np.concatenate([columns + eps * np.eye(n), columns - eps * np.eye(n), columns], axis=1)

    def tensor(x):
        hat = [
            np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]]) for v in (x[:3], x[3:])
        ]
        return np.block([[hat[0], hat[1]], [hat[1], np.zeros((3, 3))]])

    def find_defect(kind):
        end = step_once(kind, states, 0.25)
        slope = (end[:, :n] - end[:, n:-1]) / (2 * eps)
        return np.abs(slope @ tensor(START) @ slope.T - tensor(end[:, -1])).max()

    assert find_defect(SphericalMidpoint) < 1e-8
    assert find_defect(CoadjointMean) < 1e-8
    assert find_defect(Midpoint) > 1e-5


def test_a_motion_without_spheres_refuses_it():
    """With what it expects."""
    text = HEAVY.replace('name = "so(3)"', 'name = "sl(2,R)"').split("[variables]")[0]
    text += """
[variables]
mu = { role = "momentum", default = [0.4, -0.3, 1.2] }
[hamiltonian]
h = "mu1^2/2 + mu2^2/4 + mu3^2/6"
[noise]
dW1 = "mu1/5"
"""
    texts = pipeline.render(read_spec_text(text, "plane.toml")).texts
    refused = pytest.raises(KernelArgumentError, match=r"product of so\(3\) and se\(3\)")
    with load_texts(texts) as system, refused:
        system.simulate(START[:3], (0, 1), method="spherical_midpoint", step=0.1, seed=1)


# -- the strong order, with rates by hand ---------------------------------------------------------

INERTIA = np.array([1.0, 2.0, 3.0])[:, np.newaxis]
WEIGHT = np.array([0.2, 0.0, 1.0])[:, np.newaxis]


def move(x, along_Pi, along_Gamma):
    """``{x, h}`` on se(3)*, left invariant: Pi x dh/dPi + Gamma x dh/dGamma, Gamma x dh/dPi."""
    Pi, Gamma = x[:3], x[3:]
    both = cross(Pi, along_Pi) + cross(Gamma, along_Gamma)
    return np.concatenate([both, cross(Gamma, along_Pi)])


def cross(a, b):
    """``a x b`` of members; that of NumPy takes most of a step of few of them."""
    (a1, a2, a3), (b1, b2, b3) = a, b
    return np.stack([a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1])


def rates(lanes, after, x):
    """Of the top above."""
    return move(x, x[:3] / INERTIA, np.broadcast_to(WEIGHT, x[3:].shape))


def fields(lanes, after, x):
    """Of its processes."""
    zero = np.zeros(x[:3].shape)
    axes = [np.broadcast_to(np.eye(3)[:, [k]], zero.shape) for k in range(3)]
    noise = [(0.2 * axes[0], zero), (0.3 * axes[1], zero), (zero, 0.25 * axes[2])]
    return np.stack([move(x, *each) for each in noise], axis=1)


def turn(x, vector):
    """The bracket with a vector."""
    return move(x, vector[:3], vector[3:])


def gradient(lanes, after, x):
    """Of the energy of the top above."""
    return np.concatenate([x[:3] / INERTIA, np.broadcast_to(WEIGHT, x[3:].shape)])


def slopes(lanes, after, x):
    """Of the Hamiltonians of its processes."""
    found = np.zeros((6, 3, x.shape[1]))
    found[0, 0], found[1, 1], found[5, 2] = 0.2, 0.3, 0.25
    return found


def make_lanes(x, n):
    """Members at step n."""
    members = x.shape[1]
    none = np.zeros((0, members))
    return Lanes(
        state=x,
        time=np.zeros(members),
        end=np.full(members, math.inf),
        step=np.zeros(members),
        parameters=np.zeros(0),
        driving=none,
        slopes=none,
        member=np.arange(members, dtype=np.uint64),
        steps=np.full(members, n, np.uint64),
    )


def make_method(kind, h, increments):
    """A method that takes given increments, ``(w, steps, N)``."""

    class Given(kind):
        def find_noise(self, lanes, h, process):
            return increments[process, int(lanes.steps[0])] / h

    spheres = (Sphere((3, 4, 5), (0, 1, 2)),)
    orbits = Orbits(gradient=gradient, slopes=slopes, bracket=lambda lanes, after, x, v: turn(x, v))
    given = {"rates": rates, "fields": fields, "spheres": spheres, "orbits": orbits}
    return Given(**given, size=h, seed=0, bound=math.inf)


def step_once(kind, states, h):
    """One step of all states with the same noise."""
    noise = np.array([0.3, -0.2, 0.4])[:, np.newaxis, np.newaxis]
    increments = np.broadcast_to(noise, (3, 1, states.shape[1]))
    attempt = make_method(kind, h, increments).try_step(make_lanes(states, 0))
    assert attempt.accepted.all()
    return attempt.state


def find_strong_order(kind, chosen, members, finest, least, scale):
    """The slope of the mean error at t = 1 against the step, over three octaves."""
    counts = least * 2 ** np.arange(4)
    source = np.random.default_rng(5)
    fine = np.zeros((3, finest, members))
    fine[chosen] = scale * source.normal(size=(len(chosen), finest, members)) / math.sqrt(finest)

    def follow(increments):
        x, steps = np.repeat(START[:, np.newaxis], members, axis=1), increments.shape[1]
        method = make_method(kind, 1.0 / steps, increments)
        for n in range(steps):
            attempt = method.try_step(make_lanes(x, n))
            assert attempt.accepted.all()
            x = attempt.state
        return x

    exact = follow(fine)
    errors = [
        np.linalg.norm(
            follow(fine.reshape(3, steps, -1, members).sum(axis=2)) - exact, axis=0
        ).mean()
        for steps in counts.tolist()
    ]
    return np.polyfit(np.log2(counts), -np.log2(errors), 1)[0]


@pytest.mark.parametrize("kind", [SphericalMidpoint, CoadjointMean])
@pytest.mark.parametrize(("chosen", "order"), [([0, 1, 2], 0.5), ([1], 1.0)])
def test_the_strong_order_of_a_top(kind, chosen, order):
    """Half where processes do not commute, 1 for one of them."""
    found = find_strong_order(kind, chosen, 100, 256, 4, 3.0)
    assert abs(found - order) < 0.2


@pytest.mark.campaign
@pytest.mark.parametrize("kind", [SphericalMidpoint, CoadjointMean, Midpoint])
@pytest.mark.parametrize(("chosen", "order"), [([0, 1, 2], 0.5), ([1], 1.0)])
def test_the_strong_order_of_a_top_to_a_tenth(kind, chosen, order):
    """With more paths and a finer reference."""
    assert abs(find_strong_order(kind, chosen, 1000, 4096, 16, 3.0) - order) < 0.1
