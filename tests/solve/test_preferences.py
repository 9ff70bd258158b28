"""The method that is taken where it is left to us, and wishes for what is kept."""

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError
from coadjoint.systems import bloch, chaplygin_sleigh, heavy_top, kepler, quadrotor, rigid_body

BODY, TOP = [0.5, 0.3, 0.9], [0.4, -0.3, 1.2, 0.6, 0.0, 0.8]
ORBIT, SLEIGH = [1.0, 0.0, 0.0, 0.0, 1.1, 0.2], np.full(chaplygin_sleigh.STATE.size, 0.25)


@pytest.mark.parametrize(
    ("system", "start", "expected"),
    [
        (rigid_body, BODY, "spherical_midpoint"),
        (heavy_top, TOP, "splitting4"),
        (kepler, ORBIT, "splitting4"),
        (chaplygin_sleigh, SLEIGH, "gauss4"),
        (bloch, BODY, "discrete_gradient"),
    ],
)
def test_auto_with_a_step_takes_the_default(system, start, expected):
    """And says why; without a step it follows tolerances, and says nothing."""
    run = system.simulate(start, (0, 1), step=0.125, target="numpy")
    assert run.settings["method"] == expected
    assert run.settings["chosen"]
    assert f"{expected} was taken: " in str(run)
    adaptive = system.simulate(start, (0, 1), target="numpy")
    assert adaptive.settings["method"] in ("taylor", "dop853")
    assert "chosen" not in adaptive.settings


def test_a_method_that_is_named_is_taken():
    """With the same bits as by name of the default."""
    chosen = heavy_top.simulate(TOP, (0, 1), step=0.125, target="numpy")
    named = heavy_top.simulate(TOP, (0, 1), step=0.125, method="splitting4", target="numpy")
    assert np.array_equal(chosen.state, named.state)
    assert "chosen" not in named.settings


def test_energy_and_bracket_are_granted_where_a_method_keeps_both():
    """The exact motion of a free body; of a heavy top there is none, and the theorem is named."""
    run = rigid_body.simulate(BODY, (0, 50), method="energy+poisson", step=0.5, samples=101)
    assert run.settings["method"] == "exact_body"
    assert max(run.drift.values()) < 1e-13
    with pytest.raises(KernelArgumentError, match=r"Ge and J\. E\. Marsden") as caught:
        heavy_top.simulate(TOP, (0, 1), method="energy and poisson", step=0.125)
    for name in ("'gauss4'", "'splitting4'"):
        assert name in str(caught.value)


def test_the_advice_of_the_theorem_is_followed():
    """Each of the methods that it names runs."""
    with pytest.raises(KernelArgumentError) as caught:
        heavy_top.simulate(TOP, (0, 1), method="symplectic+energy", step=0.125)
    for name in caught.value.expected[:3]:
        run = heavy_top.simulate(TOP, (0, 1), method=name, step=0.125, target="numpy")
        assert run.status == "OK"


def test_what_does_not_apply_to_a_run_is_passed_over():
    """Where Python leads the steps there are no methods that keep structure, which is said."""
    options = {
        "step": 0.125,
        "target": "numpy",
        "inputs": lambda t: np.full(quadrotor.INPUTS.size, t),
    }
    run = quadrotor.simulate(np.full(quadrotor.STATE.size, 0.25), (0, 1), **options)
    assert run.settings["method"] == "dop853"
    assert "does not apply: Python leads the steps" in run.settings["chosen"]


@pytest.mark.parametrize(
    ("samples", "expected"),
    [(5, [0, 0.25, 0.5, 0.75, 1]), (4, [0, 0.375, 0.625, 1]), (1001, np.arange(9) / 8), (1, [1])],
)
def test_samples_are_ends_of_steps(samples, expected):
    """The nearest to even ones, no more than there are; the integrals are kept there."""
    run = rigid_body.simulate(BODY, (0, 1), step=0.125, samples=samples, target="numpy")
    assert run.time.tolist() == list(expected)
    assert max(run.drift.values()) < 1e-14


def test_times_that_are_given_stay():
    """Between ends of steps too, where a cubic stands; and RK4 has even ones."""
    times = [0.0, 0.3, 0.7, 1.0]
    run = rigid_body.simulate(BODY, times, step=0.125, target="numpy")
    assert run.time.tolist() == times
    assert max(run.drift.values()) > 1e-9
    even = rigid_body.simulate(BODY, (0, 1), step=0.125, samples=4, method="rk4", target="numpy")
    assert even.time.tolist() == np.linspace(0, 1, 4).tolist()
