"""Projected discrete gradients of metriplectic motions: energies and entropies of any degree."""

import math
from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from coadjoint import pipeline
from coadjoint.build.compiler import CompilerWarning
from coadjoint.derive import derive
from coadjoint.errors import KernelArgumentError
from coadjoint.lower.lowering import lower
from coadjoint.lower.orbits import is_metriplectic
from coadjoint.lower.program import Negate
from coadjoint.prove.methods import _judge_metriplectic
from coadjoint.solve import kernels
from coadjoint.solve.folders import load_folder, load_texts
from coadjoint.solve.methods.metriplectic_gradient import MetriplecticGradient, project
from coadjoint.spec.reader import read_spec_text
from tests.kernels import COMPILER
from tests.prove.test_methods import judge
from tests.solve.methods.algebras import make_lanes
from tests.solve.test_balance import HAMILTONIAN

#: G is that of P. J. Morrison, Physica D 18 (1986) 410, section 4; neither function is quadratic.
BODY = HAMILTONIAN.replace("{more}", " + Pi[1]^4/4").replace(
    "[claims]",
    """[definitions]
w = "vector(Pi1 + Pi1^3, Pi2/2, Pi3/3)"
[metriplectic]
S = "dot(Pi, Pi)^2/4"
G = "(dot(w, w)*hat(w)^0 - outer(w, w))/5"
[claims]""",
)
BODY = BODY.replace('casimirs = ["dot(Pi, Pi)"]', "")
#: Friction takes ``p^2/5`` of the motion, which is what the bath gains: ``T ds/dt``, T = exp(s).
HEATING = """
title = "A mass on a spring of the third degree, whose friction heats a bath"
routes = ["poisson"]
[variables]
q = { role = "coordinate" }
p = { role = "coordinate" }
s = { role = "coordinate" }
[poisson]
canonical = [["q", "p"]]
[hamiltonian]
h = "p^2/2 + q^4/4 + exp(s)"
[metriplectic]
S = "s"
G = "outer(vector(0, exp(s), -p), vector(0, 1, -p/exp(s)))/5"
accept = "numerical"
"""
START, STEP = [0.9, 0.4, 0.5], 0.25
METHOD = "metriplectic_gradient"


@pytest.fixture(scope="module")
def body():
    """A body whose energy and entropy are of degree 4."""
    with load_texts(pipeline.render(read_spec_text(BODY, "body.toml")).texts) as system:
        yield system


def follow(system, method=METHOD, target="numpy", span=20.0, step=STEP, samples=81, **given):
    """A run from the start."""
    run = system.simulate(
        START, (0, span), method=method, step=step, samples=samples, target=target, **given
    )
    assert run.status == "OK"
    return run


def slopes(x):
    """Gradients of both functions by hand."""
    return np.array([x[0] + x[0] ** 3, x[1] / 2, x[2] / 3]), (x**2).sum(0) * x


def relax(x, v):
    """``G(x) v`` by hand."""
    w = slopes(x)[0]
    return ((w * w).sum(0) * v - w * (w * v).sum(0)) / 5


def test_the_functions_are_those_by_hand(body):
    """Entropy, its gradient, and the matrix times a vector."""
    x, v = np.random.default_rng(1).normal(size=(2, 3, 5))
    np.testing.assert_allclose(body.entropy(x), (x**2).sum(0) ** 2 / 4, rtol=1e-14)
    np.testing.assert_allclose(body.entropy_gradient(x), slopes(x)[1], rtol=1e-14)
    np.testing.assert_allclose(body.metric_vector(x, v), relax(x, v), rtol=0, atol=1e-13)
    np.testing.assert_allclose(body.bracket_vector(x, v), np.cross(x, v, axis=0), atol=1e-15)


@pytest.mark.parametrize("target", ["numpy", pytest.param("c", marks=pytest.mark.skipif(
    not COMPILER, reason="no C compiler on this machine"))])  # fmt: skip
def test_energy_stays_and_entropy_grows(body, target):
    """Over 1000 steps, to rounding; methods of Gauss move the energy."""
    run = follow(body, target=target, span=250.0, samples=1001)
    gained = np.diff(body.entropy(run.state))
    assert run.drift["energy"] < 1e-15
    assert gained.min() > -2e-15
    assert (gained[:40] > 1e-6).all()
    assert follow(body, "gauss4", target).drift["energy"] > 1e-8
    assert follow(body, "midpoint", target).drift["energy"] > 1e-5


def test_entropy_gains_what_the_projected_gradients_say(body):
    """``S1 - S0 = h (Q s).G(m) (Q s)``, g and s by another quadrature, which is exact here."""
    run = follow(body)
    x, y = run.state[:, :-1], run.state[:, 1:]
    nodes, weights = np.polynomial.legendre.leggauss(8)
    points = [x + (node + 1) / 2 * (y - x) for node in nodes]
    g, s = (
        sum(weight / 2 * slopes(each)[place] for weight, each in zip(weights, points, strict=True))
        for place in (0, 1)
    )
    left = s - g * (g * s).sum(0) / (g * g).sum(0)
    given = STEP * (left * relax((x + y) / 2, left)).sum(0)
    gained = np.diff(body.entropy(run.state))
    assert np.abs(gained - given).max() < 1e-14
    unprojected = STEP * (s * relax((x + y) / 2, s)).sum(0)
    assert np.abs(gained - unprojected).max() > 1e-5


def test_the_default_and_what_is_said(body):
    """It is the default; other discrete gradients say why they are none."""
    methods = {each.name: each for each in body.METHODS}
    own = methods[METHOD]
    assert own.rank == 1
    assert own.exactly == ("energy",)
    assert "the entropy, which never falls" in own.decides
    assert follow(body, "auto").settings["method"] == METHOD
    with pytest.raises(KernelArgumentError, match="Poisson or almost-Poisson tensor"):
        follow(body, "discrete_gradient")
    unsure = SimpleNamespace(is_moved=False, integrals=(), is_semidefinite=False)
    assert "the entropy may fall" in _judge_metriplectic(unsure, None, {}).decides
    moved = SimpleNamespace(
        is_moved=True, is_semidefinite=True, integrals=(SimpleNamespace(name="energy"),)
    )
    found = _judge_metriplectic(moved, None, {})
    assert (found.exactly, found.laws) == ((), ())


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
def test_c_and_numpy_have_the_same_bits(body):
    """Of all states at samples, by sweeps and by Newton's method, which takes fewer."""
    sweeps = []
    for newton in (False, True):
        one, other = (follow(body, target=target, newton=newton) for target in ("c", "numpy"))
        assert np.array_equal(one.state, other.state)
        assert one.sweeps == other.sweeps
        sweeps.append(one.sweeps)
    assert sweeps[1] < sweeps[0]


def test_the_order_is_two(body):
    """By the gaps of runs with halved steps."""
    ends = [follow(body, span=2.0, step=STEP / 2**k, samples=1).state[:, -1] for k in range(4)]
    gaps = [np.abs(a - b).max() for a, b in pairwise(ends)]
    assert all(1.9 < math.log2(a / b) < 2.1 for a, b in pairwise(gaps))


def test_a_step_is_undone_by_one_back(body):
    """The method is symmetric: forth and back is the start, to rounding."""

    def values(lanes, after, x):
        return np.array([body.energy(x), body.entropy(x)])

    def gradients(lanes, after, x):
        return np.concatenate([body.energy_gradient(x), body.entropy_gradient(x)])

    method = MetriplecticGradient(
        values=values,
        gradients=gradients,
        bracket=lambda lanes, after, x, v: body.bracket_vector(x, v),
        metric=lambda lanes, after, x, v: body.metric_vector(x, v),
        size=STEP,
    )
    ends, low = [np.array(START)[:, np.newaxis]], np.zeros((3, 1))
    for h in (STEP, -STEP):
        x, _, solved, _ = method.advance(make_lanes(ends[-1]), np.full(1, h), ends[-1], low)
        assert solved.all()
        ends.append(x)
    assert np.abs(ends[1] - ends[0]).max() > 0.05
    assert np.abs(ends[2] - ends[0]).max() < 1e-15


def test_friction_heats_a_bath():
    """The entropy is a coordinate, and the energy has an exponential of it."""
    with load_texts(pipeline.render(read_spec_text(HEATING, "heating.toml")).texts) as system:
        given = {"step": STEP, "samples": 401, "target": "numpy"}
        run = system.simulate([1.5, 0.4, -1.0], (0, 100), **given)
        assert run.settings["method"] == METHOD
        assert run.drift["energy"] < 2e-15
        assert (np.diff(run.state[2]) > 0).all()
        other = system.simulate([1.5, 0.4, -1.0], (0, 100), method="gauss4", **given)
        assert other.drift["energy"] > 1e-5


@pytest.mark.parametrize("name", ["bracket_vector", "metric_vector", "entropy_gradient", "rhs"])
def test_a_spoiled_function_is_refused(name):
    """With a wrong sign the motion is another one, or a condition of degeneracy does not hold."""
    programs = {**lower(derive(read_spec_text(BODY, "body.toml")))}
    assert is_metriplectic(programs)
    own = programs[name]
    first, *others = own.outputs
    wrong = replace(own, outputs=(replace(first, value=Negate(first.value)), *others))
    assert not is_metriplectic(programs | {name: wrong})


def test_what_is_refused_says_why():
    """Gradients of the energy alone; and a motion with a force, which the step would leave out."""
    _, methods = judge(read_spec_text(BODY, "body.toml"))
    assert methods[METHOD].applies
    for name in ("discrete_gradient", "average_gradient"):
        assert not methods[name].applies
        assert "metriplectic_gradient projects G along that" in methods[name].decides
    text = BODY.replace("[metriplectic]", '[forces]\nPi = "vector(1, 0, 0)"\n[metriplectic]')
    _, methods = judge(read_spec_text(text, "body.toml"))
    assert "P dh + G dS alone" in methods[METHOD].decides
    assert not {each for each in ("discrete_gradient", METHOD) if methods[each].applies}


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
def test_spoiled_text_is_caught(tmp_path, monkeypatch):
    """A projection along the other gradient has other bits than NumPy."""
    monkeypatch.setattr(kernels, "_said", set())
    for name, text in pipeline.render(read_spec_text(BODY, "body.toml")).texts.items():
        if name == "solver.c":
            assert "project(rows, g, relaxed)" in text
            text = text.replace("project(rows, g, relaxed)", "project(rows, s, relaxed)")
        (tmp_path / name).write_text(text)
    with pytest.warns(CompilerWarning, match="differs from its NumPy twin"):
        follow(load_folder(tmp_path), target="c")


def test_what_is_left_is_orthogonal():
    """And a vector stays whole along none."""
    one, other = np.random.default_rng(3).normal(size=(2, 4, 9))
    assert np.abs((project(one, other) * other).sum(0)).max() < 1e-14
    assert np.array_equal(project(one, np.zeros((4, 9))), one)
