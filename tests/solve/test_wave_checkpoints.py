"""Checkpoints of fields by Fourier derivatives: a run goes on with the bits of an unbroken one."""

import json

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError
from coadjoint.solve import wave_checkpoints
from coadjoint.solve.wave_gauss import WaveGauss
from coadjoint.systems import euler_2d, kdv, spin_chain

METHODS = {
    "midpoint": {"method": "midpoint", "step": 0.01},
    "gauss4": {"method": "gauss4", "step": 0.02},
    "gauss6": {"method": "gauss6", "step": 0.03},
    "DOP853": {"method": "scipy:DOP853", "rtol": 1e-13, "atol": 1e-14},
    "RK45": {"method": "scipy:RK45", "rtol": 1e-9, "atol": 1e-10},
}


class StoppedError(Exception):
    """What ends a run in its middle, as a signal would."""


def field(name):
    """A system by Fourier derivatives and the state where it begins."""
    if name == "kdv":
        w = 2 * np.pi * np.arange(24) / 24
        return kdv.system.resize({"s": 24}).with_derivatives("fourier"), np.cos(w) / 3
    if name == "spin_chain":
        w, one = 2 * np.pi * np.arange(16) / 16, np.ones(16)
        fields = [np.cos(w), np.sin(w) / 2, one, one / 5, np.sin(w) / 2, one / 10]
        return spin_chain.system.resize({"s": 16}).with_derivatives("fourier"), np.ravel(fields)
    x, y = np.meshgrid(*[2 * np.pi * np.arange(8) / 8] * 2, indexing="ij")
    w = np.cos(x) + np.sin(y) / 2 + np.cos(x + y) / 3
    return euler_2d.system.resize({"x": 8, "y": 8}), w.ravel()


def break_off(monkeypatch, path, count, run):
    """Write a file after every step, and stop a run once so many are written."""
    write, written = wave_checkpoints.WaveCheckpoint._write, []

    def spoiled(self, arrays):
        write(self, arrays)
        self.seconds = -1.0
        written.append(arrays["time"])
        if len(written) == count:
            raise StoppedError

    with monkeypatch.context() as patch:
        patch.setattr(wave_checkpoints.WaveCheckpoint, "_write", spoiled)
        patch.setattr("coadjoint.solve.checkpoints.SECONDS", -1.0)
        with pytest.raises(StoppedError):
            run()
    assert path.exists()
    return float(written[-1])


@pytest.mark.parametrize("name", ["kdv", "spin_chain", "euler_2d"])
@pytest.mark.parametrize("method", METHODS)
def test_a_run_that_is_broken_off_goes_on_with_the_same_bits(monkeypatch, tmp_path, name, method):
    """Twice: what rounding left out, the next step, samples, and counts are those of one run."""
    (system, state), path = field(name), tmp_path / "run.npz"
    run = {"samples": 7, **METHODS[method]}
    end = 0.5 if "step" in run else 2.0
    whole = system.simulate(state, (0, end), **run)
    assert whole.status == "OK"
    went, call = [], lambda: system.simulate(state, (0, end), checkpoint=path, **run)
    for _ in range(2):
        went.append(break_off(monkeypatch, path, 3, call))
    assert 0 < went[0] < went[1] < end
    found = system.simulate(state, (0, end), checkpoint=path, **run)
    assert found.state.tobytes() == whole.state.tobytes()
    assert found.time.tobytes() == whole.time.tobytes()
    assert (found.status, found.steps, found.sweeps) == (whole.status, whole.steps, whole.sweeps)


def test_what_stands_in_the_file_is_what_goes_on(monkeypatch, tmp_path):
    """The check above can fail: without what rounding left out the end has other bits."""
    (system, state), path = field("kdv"), tmp_path / "run.npz"
    run = {"samples": 2, **METHODS["midpoint"]}
    whole = system.simulate(state, (0, 0.5), **run)
    call = lambda: system.simulate(state, (0, 0.5), checkpoint=path, **run)  # noqa: E731
    break_off(monkeypatch, path, 5, call)
    with np.load(path) as file:
        arrays = dict(file)
    assert arrays["left_out"].any()
    with path.open("wb") as file:
        np.savez(file, **arrays | {"left_out": 0 * arrays["left_out"]})
    assert call().state.tobytes() != whole.state.tobytes()


def test_a_finished_run_is_not_computed_again(monkeypatch, tmp_path):
    """It stands in the file, in the form of all checkpoints; another run is refused."""
    (system, state), path = field("kdv"), tmp_path / "run.npz"
    given = {"samples": 3, "checkpoint": path, **METHODS["gauss4"]}
    first = system.simulate(state, (0, 0.2), **given)
    with np.load(path) as file:
        head = json.loads(str(file["head"]))
    assert head["form"] == 3
    assert (head["asked"]["system"], head["asked"]["derivatives"]) == ("kdv", "fourier")
    monkeypatch.setattr(WaveGauss, "_step_impl", None)
    again = system.simulate(state, (0, 0.2), **given)
    assert again.state.tobytes() == first.state.tobytes()
    assert (again.steps, again.sweeps) == (first.steps, first.sweeps)
    for changes, named in (
        ({"step": 0.01}, "its step is 0.02, and that of this run is 0.01"),
        ({"parameters": {"c": 0.1}}, "its parameters has the hash"),
        ({"samples": 4}, "its samples has the hash"),
    ):
        with pytest.raises(KernelArgumentError, match="checkpoint of another run") as error:
            system.simulate(state, (0, 0.2), **given | changes)
        assert named in str(error.value)


@pytest.mark.parametrize("name", ["state", "time", "out", "counts", "next", "left_out"])
def test_a_file_without_all_of_it_is_refused(tmp_path, name):
    """A missing array and one of another shape."""
    (system, state), path = field("kdv"), tmp_path / "run.npz"
    call = lambda: system.simulate(  # noqa: E731
        state, (0, 0.2), samples=3, checkpoint=path, **METHODS["midpoint"]
    )
    call()
    with np.load(path) as file:
        arrays = dict(file)
    for spoiled in (
        {each: array for each, array in arrays.items() if each != name},
        arrays | {name: np.zeros((2, 5))},
    ):
        with path.open("wb") as file:
            np.savez(file, **spoiled)
        with pytest.raises(KernelArgumentError, match=f"can be read: its {name} has the shape"):
            call()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"method": "scipy:BDF"}, "'scipy:BDF', of which SciPy keeps earlier steps, of kdv"),
        ({"dense": True}, "events or dense output of kdv stands in none.*Leave them out"),
        ({"events": "m[0] = 0.1"}, "events or dense output"),
        ({"state": np.zeros((24, 2))}, "a batch of kdv .*file of its own"),
    ],
    ids=["BDF", "dense", "events", "batch"],
)
def test_what_stands_in_no_checkpoint_is_refused(tmp_path, options, message):
    """With the reason, before any work; the advice is followed."""
    (system, state), path = field("kdv"), tmp_path / "run.npz"
    given = {"state": state, "t": (0, 0.1), "samples": 2, "checkpoint": path}
    with pytest.raises(KernelArgumentError, match=message):
        system.simulate(**given | options)
    assert not path.exists()
    assert system.simulate(**given).status == "OK"
