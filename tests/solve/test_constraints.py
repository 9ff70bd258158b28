"""Runs stay on the constraints that are kept, begin there, and drift without the projection."""

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.constraints import Constraints
from coadjoint.solve.driving import Driving
from coadjoint.solve.ensemble import Limits
from coadjoint.systems import chaplygin_sleigh, knife_edge_cvt, snakeboard, suslov, veselova
from tests.constrained import PENDULUM
from tests.solve.domains import built

#: A few roundings of a sum of products.
ROUNDING = 1e-15
KEPT = {"suslov": suslov, "veselova": veselova, "snakeboard": snakeboard, "blade": knife_edge_cvt}
#: Where runs begin, their parameters and how long they are.
RUNS = {
    "suslov": ({"Omega": [1, 2, -5 / 3]}, {"a": [1, 2, 3]}, 100),
    "veselova": ({"Omega": [1, 2, -0.75], "Gamma": [0.6, 0, 0.8]}, None, 100),
    "snakeboard": (
        {"v1": -0.06 / np.tan(0.4), "v2": 0, "omega": 0.3, "psi": 0, "phi": 0.4}
        | {"vpsi": 2, "vphi": 0.01},
        None,
        100,
    ),
    "blade": ({"xi": 0.5, "x": 1, "z": 0, "vxi": 1, "vx": 0, "vz": 0}, {"eps": 0.1}, 100),
}
#: Without the projection they come this far off.
DRIFT = {"suslov": 5e-15, "veselova": 1e-11, "snakeboard": 1e-13, "blade": 1e-11}


def run(name, method="auto", **options):
    """A run, and its largest residual in units of the largest component."""
    state, parameters, end = RUNS[name]
    system = KEPT[name]
    found = system.simulate(state, (0, end), parameters, method=method, **options)
    assert found.status == "OK"
    residual = np.abs(system.constraint_residual(found.state, parameters)).max()
    return found, residual / np.abs(found.state).max()


@pytest.fixture
def unprojected(monkeypatch):
    """Runs as they are without the projection."""
    monkeypatch.setattr(Constraints, "project", lambda self, time, state: state.copy())
    monkeypatch.setattr(Limits, "project", lambda self, lanes, after, state: state)


@pytest.mark.parametrize("method", ["auto", "dop853", "scipy:DOP853"])
@pytest.mark.parametrize("name", RUNS)
def test_a_long_run_stays_on_its_constraints(name, method):
    """The residual of every sample is a rounding, and the energy drifts no more than without."""
    found, residual = run(name, method)
    assert residual < ROUNDING
    assert np.ptp(found.state, axis=1).max() > 0.1
    assert found.drift["energy"] < 1e-8


@pytest.mark.parametrize(
    "options", [{"method": "scipy:DOP853"}, {"target": "numpy", "rtol": 1e-6}], ids=str
)
@pytest.mark.parametrize("name", RUNS)
@pytest.mark.usefixtures("unprojected")
def test_without_the_projection_it_drifts(name, options):
    """The same run loses its constraints step by step."""
    assert run(name, **options)[1] > DRIFT[name]


@pytest.mark.parametrize(
    "method", ["scipy:RK45", "scipy:RK23", "scipy:Radau", "scipy:BDF", "scipy:LSODA"]
)
def test_all_methods_give_samples_on_the_constraints(method):
    """Also those that remember steps, and in the middle of steps."""
    found, residual = run("blade", method, rtol=1e-4, samples=301)
    assert residual < ROUNDING
    assert len(found) == 301


def test_one_step_methods_go_on_from_the_projected_state():
    """Seen from the solver: after each step its own state is on the constraints, and so its rate.

    Of BDF only the samples are.
    """
    system, seen = veselova.system, {}

    class Watched(Constraints):
        def move_onto(self, solver):
            state = super().move_onto(solver)
            seen.setdefault(type(solver).__name__, []).append((solver.y.copy(), solver))
            return state

    for method in ("scipy:DOP853", "scipy:Radau", "scipy:BDF"):
        seen.clear()
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("coadjoint.solve.scipy_steps.Constraints", Watched)
            run("veselova", method, rtol=1e-5)
        states = np.array([state for state, _ in seen[method.removeprefix("scipy:")]]).T
        residual = np.abs(system.constraint_residual(np.ascontiguousarray(states))).max()
        assert bool(residual < ROUNDING) is (method != "scipy:BDF")
        solver = seen[method.removeprefix("scipy:")][-1][1]
        if method != "scipy:BDF":
            assert np.array_equal(solver.f, system.rhs(solver.y))


@pytest.mark.parametrize("name", KEPT)
def test_a_projection_is_idempotent_and_the_same_in_both_languages(name):
    """To roundings; C and NumPy agree to the last bit, or nearly with functions."""
    system = KEPT[name]
    states = np.random.default_rng(3).normal(size=(system.system.STATE.size, 57))
    once = system.projection(states)
    twice = system.projection(once)
    assert np.abs(system.constraint_residual(states)).max() > 0.1
    size = np.abs(once).max(axis=0)
    assert (np.abs(system.constraint_residual(once)) <= 1e-13 * size).all()
    assert (np.abs(twice - once) <= 1e-12 * size).all()
    other = system.projection(states, target="numpy")
    if system.system.elementary:
        np.testing.assert_allclose(other, once, rtol=0, atol=1e-13 * size.max())
    else:
        np.testing.assert_array_equal(other, once)


def test_systems_that_keep_nothing_have_no_projection():
    """The sleigh's constraint gives a velocity; a run of it is what the solver makes of it."""
    assert "projection" not in chaplygin_sleigh.system.functions
    system = chaplygin_sleigh.system
    assert not Constraints(system, system.pack(), "c", Driving(system, None, 0.0, 1.0)).any


@pytest.mark.parametrize("name", KEPT)
def test_declared_starts_are_on_the_constraints(name):
    """With the declared parameters, to the last bit or a rounding."""
    system = KEPT[name].system
    state = [x for q in system.STATE.values() for x in (q.default or [0.0] * len(q.components))]
    assert np.abs(system.constraint_residual(state)).max() < ROUNDING
    assert np.array_equal(system.simulate(state, (0, 1e-3)).state[:, 0], state)


@pytest.mark.parametrize(
    ("name", "change", "offending", "nearest"),
    [
        ("suslov", {"Omega": [1, 2, 3]}, "wheels, dot(a, Omega) == 0, does not hold", "is 14;"),
        ("veselova", {"Gamma": [0, 0, 1]}, "twistless, dot(Gamma, Omega) == 0", "Omega3 = 0:"),
        ("blade", {"xi": 0, "vz": 0.25}, "left minus right is 0.25; expected 0", "vz = 0:"),
        ("snakeboard", {"phi": 0, "v2": 0.5}, "front, sin(phi)*v1 + cos(phi)*", "v2 = 0"),
        ("veselova", {"Omega": [1, 2, -0.75001]}, "left minus right is -8e-06", "Omega3 = -0.75"),
    ],
)
def test_a_start_off_the_constraints_is_refused(name, change, offending, nearest):
    """With the constraint, its residual and the nearest state, which is accepted."""
    state, parameters, _ = RUNS[name]
    with pytest.raises(KernelArgumentError) as caught:
        KEPT[name].simulate({**state, **change}, (0, 1), parameters)
    assert offending in str(caught.value)
    assert nearest in str(caught.value)
    assert "System.projection" in str(caught.value)
    allowed = KEPT[name].projection({**state, **change}, parameters)
    assert KEPT[name].simulate(allowed, (0, 1e-3), parameters).status == "OK"


@pytest.mark.parametrize("error", [1e-11, -1e-17])
def test_a_start_off_by_roundings_is_moved(error):
    """A component that is 0 has the roundings of its fellows."""
    state = {"Omega": [1, 2, error], "Gamma": [0, 0, 1]}
    found = veselova.simulate(state, (0, 1))
    assert found.state[:2, 0].tolist() == [1, 2]
    assert abs(found.state[2, 0]) < 1e-26
    slow = {"Omega": [0, 0, error], "Gamma": [0, 0, 1]}
    if abs(error) < 1e-12:  # what the run takes for nothing
        assert veselova.simulate(slow, (0, 1e-3)).state[2, 0] > error
    else:
        with pytest.raises(KernelArgumentError, match="twistless"):
            veselova.simulate(slow, (0, 1e-3))
        assert veselova.simulate(slow, (0, 1e-3), atol=1e-9).status == "OK"


def test_an_affine_constraint_is_kept_too():
    """A rod that grows, x u + y v = g: to roundings, and begins as it must."""
    system = built(PENDULUM, ('"x*u + y*v == 0"', '"x*u + y*v == g"'))
    found = system.simulate([1, 0, 1, 2], (0, 20), target="numpy")
    residual = system.constraint_residual(found.state, target="numpy")
    assert np.abs(residual).max() < ROUNDING * np.abs(found.state).max() ** 2
    length = np.sum(found.state[:2] ** 2, axis=0)
    np.testing.assert_allclose(length, 1 + 2 * found.time, rtol=1e-8)
    with pytest.raises(KernelArgumentError, match="left minus right is -1; expected 0"):
        system.simulate([1, 0, 0, 2], (0, 1), target="numpy")


def test_where_constraints_depend_on_each_other_a_run_ends_with_numbers():
    """The wheels come to lie across at phi = pi/2: the end is finite and on the constraints."""
    state = RUNS["snakeboard"][0] | {"vphi": 0.5}
    found = snakeboard.simulate(state, (0, 10))
    assert found.status == "DOMAIN"
    assert np.isfinite(found.state).all()
    assert np.abs(snakeboard.constraint_residual(found.state)).max() < ROUNDING
    assert np.abs(found.state[:3, -1]).max() < 1


def test_what_is_reconstructed_stays_where_it_is():
    """The projection moves the state alone; the path is that of the run."""
    found = snakeboard.simulate(RUNS["snakeboard"][0], (0, 5), reconstruct=True)
    speed = np.gradient(found["theta"], found.time)
    np.testing.assert_allclose(speed[1:-1], found["omega"][1:-1], atol=1e-4)
    assert np.abs(snakeboard.constraint_residual(found.state)).max() < ROUNDING
