"""Tests of `simulate` with methods on coadjoint orbits, on shipped systems."""

from __future__ import annotations

from importlib import import_module

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError
from coadjoint.systems import heavy_top

METHODS = ("coadjoint_mean", "spherical_midpoint")


@pytest.fixture(scope="module")
def top():
    """A heavy top of three moments, its centre of mass off every axis."""
    return heavy_top.system


PARAMETERS = {"I": [1.0, 2.0, 3.0], "m": 1.0, "g": 0.7, "chi": [0.3, 0.0, 1.0]}
START = [1.0, 0.5, 1.2, 0.6, 0.0, 0.8]


def move(top, method, step, end=2.0, **given):
    """The state after some time."""
    found = top.simulate(START, (0, end), method=method, step=step, parameters=PARAMETERS, **given)
    assert found.status == "OK", found.message
    return found


@pytest.mark.parametrize("order", [2, 4, 6])
@pytest.mark.parametrize("method", METHODS)
def test_errors_fall_as_the_order_says(top, method, order):
    """Against the method of Taylor, within 0.1 of the order."""
    name = f"{method}{'' if order == 2 else order}"
    exact = top.simulate(START, (0, 2.0), parameters=PARAMETERS, rtol=1e-15, atol=1e-16).state[
        :, -1
    ]
    size = 0.4 if order == 6 else 0.1
    errors = [abs(move(top, name, h).state[:, -1] - exact).max() for h in (size / 2, size / 4)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.15 if order == 6 else 0.1)


@pytest.mark.parametrize("method", METHODS)
def test_a_heavy_top_keeps_its_casimirs(top, method):
    """Over 2e4 steps to rounding, and the energy within a bound that does not grow."""
    found = move(top, method, 0.05, 1000.0, samples=2001)
    pi, gamma = found["Pi"], found["Gamma"]
    for values in ((gamma**2).sum(axis=0), (pi * gamma).sum(axis=0)):
        assert abs(values - values[0]).max() < 3e-14
    gaps = abs(found["energy"] - found["energy"][0])
    assert 1e-6 < gaps[:1000].max() < 1e-2
    assert gaps[1000:].max() < 1.5 * gaps[:1000].max()


@pytest.mark.parametrize("method", METHODS)
def test_numpy_has_the_same_bits(top, method):
    """As the compiled solver, for many members and any length of calls."""
    states = np.random.default_rng(1).normal(size=(6, 13))
    one, other = (
        top.simulate(states, (0, 1), method=method, step=0.03, samples=7, target=target)
        for target in ("c", "numpy")
    )
    assert one.state.tobytes() == other.state.tobytes()


def test_too_long_steps_are_refused(top):
    """The equation of a step has no solution that is found; shorter steps, as advised, have one."""
    for method in METHODS:
        found = top.simulate([300.0, 200.0, 100.0, 0.6, 0.0, 0.8], (0, 2), method=method, step=0.5)
        assert found.status == "NOT_SOLVED"
        assert "take shorter steps" in found.message
        found = top.simulate(
            [300.0, 200.0, 100.0, 0.6, 0.0, 0.8], (0, 2), method=method, step=0.0005
        )
        assert found.status == "OK"


@pytest.mark.parametrize(
    ("system", "method", "why"),
    [
        ("heavy_top_damped", "coadjoint_mean", "bracket with its energy alone"),
        ("so5_body", "spherical_midpoint", "product of so\\(3\\) and se\\(3\\)"),
    ],
)
def test_other_systems_are_refused_with_the_reason(system, method, why):
    """The message says what the method expects."""
    system = import_module(f"coadjoint.systems.{system}").system
    with pytest.raises(KernelArgumentError, match=why):
        system.simulate(np.ones(system.STATE.size), (0, 1), method=method, step=0.1)
