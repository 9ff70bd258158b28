"""Simulation: known motions, conserved quantities, labels, and how it stops."""

import json

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError
from coadjoint.systems import chaplygin_sleigh, heavy_top, kirchhoff, rigid_body, toda_lattice
from tests.solve.systems import EMPTYING, POLE, STIFF, build

#: Local errors of 1e-10 per step add up to less than this over the times below.
TOLERANCE = 1e-7


def test_a_symmetric_body_precesses_at_the_known_rate():
    """I1 = I2: (Omega1, Omega2) turns at (I3 - I1)/I1 Omega3 (Landau and Lifshitz, sec. 33)."""
    inertia, start = [2.0, 2.0, 3.0], np.array([0.4, 0.0, 1.5])
    found = rigid_body.simulate(start, (0, 50), {"I": inertia})
    rate = (3.0 - 2.0) / 2.0 * start[2] / 3.0
    assert np.abs(found["Pi1"] - 0.4 * np.cos(rate * found.time)).max() < TOLERANCE
    assert np.abs(found["Pi2"] - 0.4 * np.sin(rate * found.time)).max() < TOLERANCE
    assert np.abs(found["Pi3"] - 1.5).max() < TOLERANCE


def test_a_top_without_spin_is_a_pendulum():
    """Swinging about a fixed axis: the small oscillation has the rate sqrt(m g l / I1)."""
    angle, (m, g, length, inertia) = 1e-4, (2.0, 9.81, 0.5, 3.0)
    # Hanging down: Gamma points against chi; turned by a small angle about the first axis.
    start = [0, 0, 0, 0, np.sin(angle), -np.cos(angle)]
    parameters = {"I": [inertia, inertia, 1.0], "m": m, "g": g, "chi": [0, 0, length]}
    found = heavy_top.simulate(start, (0, 20), parameters, atol=1e-16)
    rate = np.sqrt(m * g * length / inertia)
    assert np.abs(found["Gamma2"] - angle * np.cos(rate * found.time)).max() < angle * 1e-5


def test_a_symmetric_top_precesses_steadily():
    """Slow and fast roots of I1 cos(theta) w^2 - Pi3 w + m g l = 0 (Goldstein, sec. 5.7)."""
    inertia, (m, g, length), theta, momentum = 2.0, (1.0, 9.81, 0.3), 0.6, 12.0
    weight = m * g * length
    for rate in np.roots([inertia * np.cos(theta), -momentum, weight]):
        pi = [0, inertia * rate * np.sin(theta), momentum]
        state = [*pi, 0, np.sin(theta), np.cos(theta)]
        parameters = {"I": [inertia, inertia, 1.0], "m": m, "g": g, "chi": [0, 0, length]}
        found = heavy_top.simulate(state, (0, 5), parameters)
        assert np.abs(found["Gamma3"] - np.cos(theta)).max() < TOLERANCE
        assert np.ptp(found["Gamma1"]) > 1.0


def test_a_body_along_an_axis_of_added_mass_moves_straight():
    """Kirchhoff: translation along a principal axis is steady; across one it is not."""
    steady = kirchhoff.simulate([0, 0, 0, 1, 0, 0], (0, 10))
    assert np.abs(steady.state - steady.state[:, :1]).max() < TOLERANCE
    oblique = kirchhoff.simulate([0, 0, 0, 1, 0.5, 0], (0, 10))
    assert np.ptp(oblique["Pi3"]) > 0.01


@pytest.mark.parametrize(
    ("module", "state"),
    [
        (rigid_body, [1.0, 0.3, -0.8]),
        (heavy_top, [0.3, -0.2, 2.0, 0.6, 0.0, 0.8]),
        (kirchhoff, [0.5, 0.1, -0.4, 1.0, 0.7, 0.2]),
    ],
    ids=lambda value: getattr(getattr(value, "system", None), "name", ""),
)
def test_invariants_drift_no_more_than_the_integrator(module, state):
    """Energy and Casimirs, by an independent formula of the package, stay."""
    found = module.simulate(state, (0, 100))
    assert found.status == "OK"
    assert set(found.drift) >= {"energy", "casimir1"}
    assert max(found.drift.values()) < TOLERANCE
    # The motion is one, and the check can fail: a component of the state is not conserved.
    assert np.ptp(found.state, axis=1).max() > 0.1


def test_targets_follow_the_same_trajectory_bit_by_bit():
    """Exact C and NumPy kernels give the same steps."""
    a, b = (heavy_top.simulate([0, 0.1, 2, 0.6, 0, 0.8], (0, 3), target=t) for t in ("c", "numpy"))
    assert np.array_equal(a.state, b.state)


def test_motion_backwards_returns():
    """Reversing Pi reverses the motion of the free body."""
    there = rigid_body.simulate([1.0, 0.3, -0.8], (0, 10))
    back = rigid_body.simulate(-there.state[:, -1], (0, 10))
    assert np.abs(back.state[:, -1] + there.state[:, 0]).max() < TOLERANCE


def test_a_start_that_is_left_out_is_that_of_the_spec():
    """All of it, or what a mapping does not name; rates at a state need all of it."""
    declared, named = chaplygin_sleigh.STATE.defaults, {"v": 2.0}
    for state, start in ((None, declared), ({}, declared), (named, {**declared, **named})):
        found = chaplygin_sleigh.simulate(state, (0, 0.1), samples=2)
        assert {name: found[name][0] for name in declared} == start
    with pytest.raises(KernelArgumentError, match="state lacks omega; expected a value of each"):
        chaplygin_sleigh.rhs(named)
    with pytest.raises(KernelArgumentError, match="state lacks Pi1, Pi2, Pi3, Gamma1"):
        heavy_top.simulate(None, (0, 1))
    with pytest.raises(KernelArgumentError, match=r"lacks q\[0\], .* and 188 more;") as caught:
        toda_lattice.simulate(None, (0, 1))
    assert len(caught.value.parts["found"]) == 200


@pytest.mark.parametrize(
    "method", ["DOP853", "scipy:RK45", "scipy:Radau", "scipy:BDF", "scipy:LSODA"]
)
def test_methods_of_scipy_agree(method):
    """Implicit ones use the emitted Jacobian."""
    reference = rigid_body.simulate([1.0, 0.3, -0.8], (0, 2)).state[:, -1]
    found = rigid_body.simulate([1.0, 0.3, -0.8], (0, 2), method=method, rtol=1e-8, atol=1e-10)
    assert np.abs(found.state[:, -1] - reference).max() < 1e-5


def test_a_solution_is_read_by_name():
    """Quantities, components, observables, times."""
    times = [0.0, 0.5, 2.0]
    found = heavy_top.simulate({"Pi": [0.1, 0.2, 3.0], "Gamma": [0, 0, 1]}, times, {"m": 2.0})
    assert found["Pi"].shape == (3, 3)
    assert found["Omega"].shape == (3, 3)
    assert found["energy"].shape == found["Gamma3"].shape == (3,)
    assert found.time.tolist() == times
    assert np.array_equal(found["Omega2"], found["Pi2"] * (1 / 2.0))
    with pytest.raises(KernelArgumentError, match="'Gama' is not in this solution"):
        found["Gama"]
    assert "drift of energy" in repr(found)
    assert json.loads(json.dumps(found.summary()))["parameters"]["m"] == 2.0


def test_a_motion_that_leaves_the_numbers_stops_and_says_so():
    """Momenta of 1e160 overflow: no exception, a status, and finite samples only."""
    found = rigid_body.simulate([1e160, 1e160, 1e160], (0, 1))
    assert found.status in ("NONFINITE", "STEP_UNDERFLOW")
    assert found.message
    assert np.isfinite(found.state).all()


@pytest.mark.parametrize(
    ("context", "method", "status", "end"),
    [
        (POLE, "auto", "STEP_UNDERFLOW", 1.0),
        (POLE, "dop853", "STEP_UNDERFLOW", 1.0),
        (POLE, "scipy:DOP853", "STEP_UNDERFLOW", 1.0),
        (POLE, "scipy:BDF", "MAX_STEPS", 1.0),
        (EMPTYING, "dop853", "STEP_UNDERFLOW", 2.0),
        (EMPTYING, "scipy:DOP853", "NONFINITE", 2.0),
        (EMPTYING, "scipy:Radau", "NONFINITE", 2.0),
        (STIFF, "auto", "MAX_STEPS", 0.02),
        (STIFF, "scipy:Radau", "OK", 3.0),
    ],
    ids=lambda value: getattr(value, "name", value),
)
def test_what_cannot_be_followed_ends_with_its_reason(tmp_path, context, method, status, end):
    """A pole, rates that stop being real, stiffness: the samples before it are kept, and right."""
    found = build(context, tmp_path).simulate([1.0], (0, 3), method=method, max_steps=2000)
    assert found.status == status
    assert (found.message == "") == (status == "OK")
    assert end - 0.02 < found.time_reached <= end + 1e-10
    exact = {"pole": 1 / (1 - found.time), "emptying": (1 - found.time / 2) ** 2}
    if context.name in exact:
        assert np.abs(found["y"] / exact[context.name] - 1)[:-3].max() < 1e-4
    assert np.isfinite(found.state).all()
    assert len(found) > 1


def test_rates_that_are_not_finite_at_the_start_are_reported_at_once(tmp_path):
    """One sample, the initial state, and no endless search for a first step."""
    found = build(EMPTYING, tmp_path).simulate([-1.0], (0, 3))
    assert (found.status, found.time_reached, len(found)) == ("NONFINITE", 0.0, 1)
    assert found.state.tolist() == [[-1.0]]


def test_a_solution_keeps_its_own_numbers():
    """Arrays that the caller changes afterwards do not reach into it."""
    start, inertia = np.array([1.0, 0.3, -0.8]), np.array([1.0, 2.0, 3.0])
    found = rigid_body.simulate(start, (0, 1), inertia, samples=3)
    start[:], inertia[:] = 7.0, 7.0
    assert found.state[:, 0].tolist() == [1.0, 0.3, -0.8]
    assert found.parameters.tolist() == [1.0, 2.0, 3.0]


def test_xarray_export_has_names_and_units():
    """Where xarray is installed; otherwise the message has the pip command."""
    found = heavy_top.simulate([0.1, 0.2, 3, 0, 0, 1], (0, 1), samples=5)
    try:
        data = found.to_xarray()
    except KernelArgumentError as error:
        assert "coadjoint[data]" in str(error)  # noqa: PT017
        return
    assert data["Pi"].attrs["units"] == heavy_top.STATE["Pi"].unit
    assert data["energy"].dims == ("time",)
