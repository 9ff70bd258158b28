"""Checkpoints: a run that was killed goes on with the same bits, and no other run does."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from coadjoint.build.compiler import CompilerWarning
from coadjoint.errors import KernelArgumentError, OutputError
from coadjoint.solve import checkpoints
from coadjoint.solve.checkpoints import Checkpoint
from coadjoint.solve.ensemble import Status
from coadjoint.systems import heavy_top, rigid_body
from tests.driven_specs import PENDULUM, rendered
from tests.driven_specs import build as build_driven
from tests.kernels import COMPILER
from tests.solve.broken_off import go
from tests.solve.systems import pendulum

pytestmark = pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
ROOT = Path(__file__).parents[2]
STATE = [1.0, 0.3, -0.8]


def kill(name, path, place, count, threads):
    """Start a run and have it killed; what it has written stays."""
    words = (name, str(path), place, str(count), str(threads))
    command = (sys.executable, "-P", "-m", "tests.solve.broken_off", *words)
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, env=environment) as child:
        if place == "computing":
            assert child.stdout.readline() == b"waits\n"
            child.kill()
        assert child.wait() == -signal.SIGKILL


def check_same(found, expected):
    """Two solutions have the same bits, with the statistics of every member."""
    for name in ("time", "state", "parameters"):
        assert getattr(found, name).tobytes() == getattr(expected, name).tobytes(), name
    for name in ("steps", "rejected", "time_reached", "status"):
        assert np.array_equal(getattr(found, name), getattr(expected, name)), name
    assert found.message == expected.message
    assert (found.reconstructed is None) == (expected.reconstructed is None)
    for name in ["reconstructed"] * (expected.reconstructed is not None):
        one, other = (np.asarray(getattr(each, name)) for each in (found, expected))
        assert one.tobytes() == other.tobytes(), name
    check_same_events(found, expected)
    assert found.drift.keys() == expected.drift.keys()
    for name, drift in expected.drift.items():
        assert np.array_equal(found.drift[name], drift)


def check_same_events(found, expected):
    """The same events at the same times, and the same steps for dense output."""
    assert found.events.keys() == expected.events.keys()
    for name, events in expected.events.items():
        for array in ("time", "member", "direction", "state", "undefined"):
            one, other = (getattr(each, array) for each in (found.events[name], events))
            assert one.tobytes() == other.tobytes(), (name, array)
    assert (found.dense is None) == (expected.dense is None)
    if expected.dense is not None:
        for array in ("member", "start", "size", "path"):
            one, other = (getattr(each.dense.steps, array) for each in (found, expected))
            assert one.tobytes() == other.tobytes(), array


@pytest.mark.parametrize(
    ("name", "place", "count", "threads"),
    [
        ("taylor", "writing", 3, 1),
        ("taylor", "computing", 1, 2),
        ("dop853 in threads", "writing", 2, 3),
        ("rk4", "computing", 4, 1),
        ("midpoint", "computing", 2, 2),
        ("numpy", "writing", 5, 1),
        ("events", "computing", 3, 2),
        ("one with events", "writing", 4, 1),
        ("path", "computing", 2, 2),
    ],
)
def test_a_killed_run_goes_on_with_the_same_bits(tmp_path, name, place, count, threads):
    """SIGKILL while it computes, and between writing a file and putting it in its place."""
    path = tmp_path / "run.npz"
    kill(name, path, place, count, threads)
    with np.load(path) as file:
        steps, status = file["steps"].copy(), file["status"].copy()
    assert steps.sum() > 0  # it goes on, and does not begin anew
    assert (status == Status.GOES_ON).any()
    if (name, threads) == ("taylor", 1):  # a second time, from there
        kill(name, path, place, count, threads)
        with np.load(path) as file:
            assert file["steps"].sum() > steps.sum()
    check_same(go(name, path), go(name))


def test_what_stands_in_the_file_is_what_goes_on(tmp_path):
    """The check above can fail: one bit of the file makes another end."""
    path = tmp_path / "run.npz"
    kill("rk4", path, "computing", 1, 1)
    with np.load(path) as file:
        arrays = dict(file)
    arrays["state"][2] = np.nextafter(arrays["state"][2], 9)
    with path.open("wb") as file:
        np.savez(file, **arrays)
    assert not np.array_equal(go("rk4", path).state, go("rk4").state)


def test_a_finished_run_is_not_computed_again(tmp_path, monkeypatch):
    """The file of a run at its end is the run, with members that have failed."""
    path = tmp_path / "end.npz"
    state = np.array([[0.5, 1e200, 1.0], [0.2, 1e200, 0.0], [1.0, 1.0, 0.0]])
    first = rigid_body.simulate(state, (0, 3), samples=5, checkpoint=path)
    assert first.status[[0, 2]].tolist() == ["OK", "OK"]
    assert first.status[1] != "OK"
    assert set(tmp_path.iterdir()) == {path}
    monkeypatch.setattr(Checkpoint, "write", None)
    check_same(rigid_body.simulate(state, (0, 3), samples=5, checkpoint=str(path)), first)


@pytest.mark.parametrize(
    ("changes", "offending"),
    [
        ({"system": heavy_top, "state": [1.0] * 6}, "its system is 'rigid_body'"),
        ({"parameters": {"I": [1, 2, 4]}}, "its parameters has the hash"),
        ({"rtol": 1e-6}, "its order is "),
        ({"rtol": 2e-10}, "its rtol is 1e-10, and that of this run is 2e-10"),
        ({"atol": 1e-9}, "its atol is 1e-12"),
        ({"method": "dop853"}, "its method is 'taylor', and that of this run is 'dop853'"),
        ({"target": "numpy"}, "its target is 'c'"),
        ({"step": 0.1}, "is 'spherical_midpoint'"),
        ({"max_steps": 7}, "its max_steps is 1000000"),
        ({"state": [1.0, 0.3, -0.7]}, "its initial state has the hash"),
        ({"t": (0, 2)}, "its samples has the hash"),
        ({"t": (-1, 1)}, "its start is 0.0, and that of this run is -1.0"),
        ({"samples": 1}, "its samples has the hash"),
        ({"dense": True}, "its dense is False, and that of this run is True"),
        ({"events": "Pi1 == 0"}, 'its events is [], and that of this run is ["Event(formula='),
    ],
    ids=str,
)
def test_a_checkpoint_of_another_run_is_refused(tmp_path, changes, offending):
    """What differs is named, and the file stays as it is."""
    path = tmp_path / "run.npz"
    given = {"state": STATE, "t": (0, 1), "samples": 3, "checkpoint": path}
    rigid_body.simulate(**given)
    before = path.read_bytes()
    system = changes.pop("system", rigid_body)
    with pytest.raises(KernelArgumentError, match="is the checkpoint of another run") as caught:
        system.simulate(**given | changes)
    assert offending in str(caught.value)
    assert path.read_bytes() == before


def test_inputs_belong_to_a_run(tmp_path):
    """Another torque is another run."""
    path = tmp_path / "run.npz"
    driven = build_driven(rendered(PENDULUM, name="driven").texts, tmp_path / "driven")
    driven.simulate([0.3, 0.0], (0, 1), None, {"u": 1.0}, checkpoint=path)
    with pytest.raises(KernelArgumentError, match="its inputs has the hash"):
        driven.simulate([0.3, 0.0], (0, 1), None, {"u": 2.0}, checkpoint=path)


@pytest.mark.parametrize(
    "content",
    [b"", b"hello", b"PK\x03\x04 broken", b"\x93NUMPY\x01\x00", b"\x80\x04K\x01."],
    ids=["empty", "text", "zip", "npy", "pickle"],
)
def test_what_is_no_checkpoint_is_refused(tmp_path, content):
    """Nothing is computed, nothing is overwritten."""
    path = tmp_path / "run.npz"
    path.write_bytes(content)
    with pytest.raises(KernelArgumentError, match="is no checkpoint that can be read"):
        rigid_body.simulate(STATE, (0, 1), checkpoint=path)
    assert path.read_bytes() == content


@pytest.mark.parametrize("name", ["state", "steps", "head"])
def test_a_checkpoint_without_all_of_it_is_refused(tmp_path, name):
    """A missing array, one of another shape, and a byte that has changed."""
    path, call = tmp_path / "run.npz", lambda: rigid_body.simulate(STATE, (0, 1), checkpoint=path)
    call()
    with np.load(path) as file:
        arrays = dict(file)
    for spoiled in (
        {each: array for each, array in arrays.items() if each != name},
        arrays | {name: np.zeros(5)},
    ):
        with path.open("wb") as file:
            np.savez(file, **spoiled)
        with pytest.raises(KernelArgumentError, match="is no checkpoint that can be read"):
            call()
    with path.open("wb") as file:
        np.savez(file, **arrays)
    content = bytearray(path.read_bytes())
    content[content.index(arrays["state"].tobytes())] ^= 1
    path.write_bytes(content)
    with pytest.raises(KernelArgumentError, match="Bad CRC-32"):
        call()


def test_a_place_that_cannot_hold_a_checkpoint_is_refused_first(tmp_path, monkeypatch):
    """A missing folder, a folder, a pipe, no path; nothing is computed."""
    monkeypatch.setattr(Checkpoint, "resume", None)
    os.mkfifo(tmp_path / "pipe")
    for path, message in (
        (tmp_path / "missing" / "a.npz", "is not a folder"),
        (tmp_path, "it is a folder"),
        ("/dev/null", "no file that can be read again"),
        (tmp_path / "pipe", "no file that can be read again"),
        (3, "expected the path of a file"),
    ):
        with pytest.raises((KernelArgumentError, OutputError), match=message):
            rigid_body.simulate(STATE, (0, 1), checkpoint=path)


def test_scipy_keeps_no_checkpoint(tmp_path):
    """The message has the reason, where a generated solver does not apply."""
    path = tmp_path / "run.npz"
    with pytest.raises(KernelArgumentError, match="method 'scipy:Radau' of SciPy keeps none"):
        rigid_body.simulate(STATE, (0, 1), method="scipy:Radau", checkpoint=path)
    with pytest.raises(KernelArgumentError, match="does not apply here: they are written for"):
        rigid_body.simulate(STATE, (0, 1), target="python", checkpoint=path)
    assert not path.exists()


def test_another_build_goes_on_and_says_so(tmp_path):
    """Where bits depend on it: with sin and cos. Where they do not, nothing is said."""
    path = tmp_path / "run.npz"
    system = pendulum(tmp_path)
    system.simulate([1.0, 0.5], (0, 1), checkpoint=path)
    with np.load(path) as file:
        arrays = dict(file)
    head = json.loads(str(arrays["head"]))
    assert len(head["build"]) == 64
    arrays["head"] = np.array(json.dumps(head | {"build": "another"}))
    with path.open("wb") as file:
        np.savez(file, **arrays)
    with pytest.warns(CompilerWarning, match="was written by another build of the solver"):
        system.simulate([1.0, 0.5], (0, 1), checkpoint=path)
    rigid_body.simulate(STATE, (0, 1), checkpoint=tmp_path / "exact.npz")
    with np.load(tmp_path / "exact.npz") as file:
        assert json.loads(str(file["head"]))["build"] == ""


def test_writing_takes_a_small_part_of_the_time(tmp_path, monkeypatch):
    """Where a file takes a second to write, the next comes after twenty."""
    ticks = iter([100.0, 101.0])
    checkpoint = Checkpoint.__new__(Checkpoint)
    checkpoint.path, checkpoint._asked, checkpoint._build = tmp_path / "a.npz", {}, ""
    checkpoint._recording = None
    monkeypatch.setattr(checkpoints.time, "monotonic", lambda: next(ticks))
    monkeypatch.setattr(checkpoints, "_arrays", lambda _: {})
    checkpoint.write(None)
    assert checkpoint.seconds == pytest.approx(20)
