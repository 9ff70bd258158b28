"""Batches by Fourier derivatives: the bits of each alone, endings, events, and what is refused."""

import json
import warnings

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.step_tables import as_json, describe_dense, read_dense
from coadjoint.systems import euler_2d, kdv

N = 32
S = 2 * np.pi * np.arange(N) / N


def line():
    """Fields on a circle, and waves of three sizes."""
    system = kdv.system.resize({"s": N}).with_derivatives("fourier")
    return system, np.stack([a * np.cos(S) for a in (0.1, 0.2, 0.3)], axis=-1)


def plane():
    """A fluid, and waves of three sizes."""
    system, s = euler_2d.system.resize({"x": 8, "y": 8}), 2 * np.pi * np.arange(8) / 8
    w = np.cos(s)[:, None] + np.sin(s + 1) * np.cos(2 * s)[:, None]
    return system, np.stack([a * w.ravel() for a in (0.5, 1.0, 1.5)], axis=-1)


@pytest.mark.parametrize("make", [line, plane])
@pytest.mark.parametrize("options", [{"step": 0.05}, {"rtol": 1e-7}], ids=["midpoint", "scipy"])
def test_each_of_a_batch_has_the_bits_that_it_has_alone(make, options):
    """Steps of one length, and of each; parameters of each, in a batch of two axes."""
    system, states = make()
    names = [name for name in system.PARAMETERS if name.startswith("L")]
    lengths = [2.0, 3.0, 4.0]
    given = dict.fromkeys(names, np.array(lengths)[None])
    run = system.simulate(
        states[:, None], (0, 0.2), samples=3, parameters=given, dense=True, **options
    )
    assert run.state.shape == (*states[:, None].shape, 3)
    assert run.status.tolist() == [["OK"] * 3]
    for n, length in enumerate(lengths):
        alone = system.simulate(
            states[:, n],
            (0, 0.2),
            samples=3,
            parameters=dict.fromkeys(names, length),
            dense=True,
            **options,
        )
        member = run.member(0, n)
        np.testing.assert_array_equal(member.state, alone.state)
        np.testing.assert_array_equal(member["energy"], alone["energy"])
        np.testing.assert_array_equal(run.at(0.13).state[:, 0, n], alone.at(0.13).state)
    assert np.ptp(run["energy"][0, :, 0]) > 0


def test_steps_of_a_batch_are_read_back():
    """From JSON, with the bits of states between samples; of another member they differ."""
    system, states = line()
    run = system.simulate(states, (0, 0.2), samples=2, step=0.05, dense=True)
    kept = run.at(0.13).state
    told = json.dumps(describe_dense(run.dense), default=as_json)
    run.dense = read_dense(json.loads(told))
    np.testing.assert_array_equal(run.at(0.13).state, kept)
    assert not np.allclose(kept[:, 0], kept[:, 1])


def test_each_of_a_batch_ends_as_it_does():
    """The large one has a step that is too long; the others reach the end."""
    system, states = line()
    states = states * [1, 1, 1000]
    run = system.simulate(states, (0, 0.4), step=0.1, samples=5)
    assert run.status.tolist() == ["OK", "OK", "NOT_SOLVED"]
    assert run.message == "1 of 3 trajectories did not reach the end: 1 NOT_SOLVED"
    assert run.time_reached.tolist() == [0.4, 0.4, 0.0]
    assert np.isnan(run.state[:, 2, 1:]).all()
    assert not np.isnan(run.state[:, :2]).any()
    assert run.member(2).status == "NOT_SOLVED"
    assert run.steps.tolist() == [4, 4, 0]
    assert run.sweeps.tolist() == [run.member(n).sweeps for n in range(3)]
    assert run.sweeps.min() > 0
    last = system.simulate(states, (0, 0.4), step=0.1, samples=1)
    np.testing.assert_array_equal(last.final["m[0]"][:2], run.state[0, :2, -1])
    assert last.course.start.state.shape == states.shape


def test_events_of_a_batch_are_those_of_each():
    """Where a wave passes a point, and a run that ends there."""
    system, states = line()
    event = "m[0] == 0.05"
    run = system.simulate(states, (0, 2), step=0.05, events=event)
    assert run.events[event].batch == (3,)
    found = 0
    for n in range(3):
        alone = system.simulate(states[:, n], (0, 2), step=0.05, events=event)
        np.testing.assert_array_equal(run.events[event].of(n).time, alone.events[event].time)
        found += len(alone.events[event])
    assert found == len(run.events[event]) > 0


def test_parameters_of_another_batch_are_refused():
    """With both shapes."""
    system, states = line()
    with pytest.raises(KernelArgumentError, match=r"batch shape \(2,\), the state \(3,\)"):
        system.simulate(states, (0, 1), step=0.1, parameters={"c": [0.1, 0.2]})


def test_a_batch_of_another_system_is_left_to_generated_solvers():
    """Those of SciPy follow one trajectory where there are others."""
    with pytest.raises(KernelArgumentError, match="one trajectory"):
        kdv.system.resize({"s": N}).simulate(line()[1], (0, 1), method="scipy:DOP853")


def test_jumps_of_one_of_a_batch_are_told():
    """As those of one trajectory are."""
    system, states = line()
    states = states + np.array([0, 0, 1.0]) * S[:, None]
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        system.simulate(states, (0, 1e-3), step=1e-3, samples=2)
    assert any("jumps" in str(each.message) for each in told)
