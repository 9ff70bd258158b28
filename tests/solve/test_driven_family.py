"""Equal members that name the time: one text for every number of them, steps that know the time."""

import numpy as np
import pytest

from coadjoint import pipeline
from coadjoint.crosscheck import families as ladder
from coadjoint.crosscheck.families import crosscheck_family
from coadjoint.errors import CrossCheckError
from coadjoint.solve.choices import Choice
from coadjoint.solve.family_steps import FamilyTwin
from coadjoint.solve.family_steps import load as load_steps
from coadjoint.solve.folders import load_texts
from coadjoint.spec.reader import read_spec_text
from tests.families import DRIVEN, VORTICES, render, write_driven

TIMES = np.linspace(0.0, 10.0, 6)
RK4, TAYLOR, MIDPOINT = Choice("rk4", 4), Choice("taylor", 6), Choice("midpoint4", 4)
RUNS = [("rk4", 0.01, 1e-9), ("dop853", None, 1e-9), ("taylor", None, 1e-9)]


@pytest.fixture(scope="module")
def driven():
    """Oscillators in a row."""
    with load_texts(render(DRIVEN, "driven").texts) as system:
        yield system


def find_motion(t, k=1.0, F=0.3, w=2.0):
    """Of each of them, alike, from rest: a forced oscillator, since no spring between is pulled."""
    return F / (k - w**2) * (np.cos(w * t) - np.cos(np.sqrt(k) * t))


def run(system, method, step):
    """From rest."""
    n = system.size
    given = {"q": np.zeros(n), "p": np.zeros(n)}
    return system.simulate(given, TIMES, method=method, step=step)


@pytest.mark.parametrize("size", [2, 5, 43])
@pytest.mark.parametrize(("method", "step", "close"), RUNS)
def test_all_move_as_one(driven, method, step, close, size):
    """The closed form of one oscillator."""
    motion = run(driven.resize({"i": size}), method, step)
    assert np.abs(motion["q"] - find_motion(TIMES)).max() < close


@pytest.mark.parametrize("lost", [1, 2, 3])
def test_a_stage_without_its_time_is_seen(driven, monkeypatch, lost):
    """The second, third or fourth stage of RK4 at the time at which the step began."""
    honest, calls = FamilyTwin._drive, []

    def forget(self, lanes, after):
        calls.append(0)
        late = (len(calls) - 1) % 4 == lost
        return honest(self, lanes, 0.0 * after if late else after)

    monkeypatch.setattr(FamilyTwin, "_drive", forget)
    given = {"q": np.zeros(5), "p": np.zeros(5)}
    run = {"method": "rk4", "step": 0.01, "samples": 1, "target": "numpy"}
    motion = driven.resize({"i": 5}).simulate(given, (0, 10), **run)
    assert len(calls) >= 4000
    assert np.abs(motion["q"][:, -1] - find_motion(10.0)).max() > 1e-5


def test_five_members_move_as_those_that_are_written_out(driven):
    """Rates and energies, each trajectory at a time of its own, and a run of unlike members."""
    five, source = driven.resize({"i": 5}), np.random.default_rng(5)
    state, time = source.normal(size=(10, 9)), source.normal(size=9)
    with load_texts(pipeline.render(read_spec_text(write_driven(5), "whole.toml")).texts) as whole:
        for name in ("rhs", "energy"):
            for target in ("c", "numpy", "python", "c-fast"):
                found = five.evaluate(name, state, time=time, target=target)
                expected = whole.evaluate(name, state, time=time, target="numpy")
                np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13)
        start = {"q": state[:5, 0], "p": state[5:, 0]}
        found = five.simulate(start, TIMES, rtol=1e-11)
        own = {f"{n}_{k}": start[n][k] for n in "qp" for k in range(5)}
        expected = whole.simulate(own, TIMES, rtol=1e-11)
        for k in range(5):
            np.testing.assert_allclose(found["q"][k], expected[f"q_{k}"], rtol=0, atol=1e-9)


def test_trajectories_have_times_of_their_own(driven):
    """A batch has the bits of its trajectories, and a time that all share may be one number."""
    system, source = driven.resize({"i": 17}), np.random.default_rng(17)
    state, time = source.normal(size=(34, 9)), source.normal(size=9)
    for target in ("c", "numpy"):
        both = system.rhs(state, time=time, target=target)
        for n in range(9):
            one = system.rhs(state[:, n].copy(), time=time[n], target=target)
            assert np.array_equal(both[:, n], one)
        alike = system.rhs(state, time=0.5, target=target)
        assert np.array_equal(alike, system.rhs(state, time=np.full(9, 0.5), target=target))
        assert not np.array_equal(alike, both)


def test_series_know_the_time(driven):
    """They are what ``auto`` takes, as for members that no time drives."""
    motion = run(driven, "auto", None)
    assert (motion.method, motion.status) == ("taylor", "OK")
    assert repr(driven).endswith("; time t>")


@pytest.mark.parametrize("method", ["rk4", "dop853", "taylor", "midpoint4"])
def test_steps_of_trajectories_are_those_of_the_twin(driven, method):
    """Nine at a time, begun at another time than 0; steps that nobody records are made in C."""
    system, source = driven.resize({"i": 3}), np.random.default_rng(3)
    given = source.normal(size=(6, 9)), np.linspace(0.25, 3.0, 4)
    step = 0.0625 if method in ("rk4", "midpoint4") else None
    found, expected = (
        system.simulate(*given, method=method, step=step, target=target)
        for target in ("c", "numpy")
    )
    np.testing.assert_allclose(found["q"], expected["q"], rtol=0, atol=1e-12)
    assert np.array_equal(found.steps, expected.steps)


def test_a_run_with_events_and_between_samples(driven):
    """Steps that are recorded know the time, too."""
    motion = driven.resize({"i": 3}).simulate(
        {"q": np.zeros(3), "p": np.zeros(3)}, (0, 10), events=["q[1] = 0.05"], dense=True
    )
    times = motion.events["q[1] = 0.05"].time
    assert len(times) > 2
    np.testing.assert_allclose(find_motion(times), 0.05, atol=1e-7)
    np.testing.assert_allclose(motion.at(TIMES)["q"][2], find_motion(TIMES), atol=1e-7)


MOVING = "(2 + cos(t))*log((x[i] - x[j])^2 + (y[i] - y[j])^2)"
#: How a text loses the time of a trajectory.
SPOILED = [
    ("kernel.c", "_run.timed = time_stride && !_single", "_run.timed = time_stride && 0"),
    ("kernel.py", "time.reshape(1, -1)", "0.0 * time.reshape(1, -1)"),
    ("kernel_python.py", "time = [time]", "time = [0.5 * time]"),
]
#: How steps lose it, and by which method that is seen.
SPOILED_STEPS = [
    ("solver.c", "+ after[l] * run->slopes[n + l]", "+ 0.0 * after[l]", RK4),
    ("solver.c", "- 1, l, time, 1.0", "- 1, l, 0.5 * time, 1.0", RK4),
    ("solver.c", "to[1][w] = run->slopes[place]", "to[1][w] = 0.0", TAYLOR),
    ("solver.py", "driving[:, k] = ", "driving[:, k] = (1 - k) * ", TAYLOR),
    ("solver.c", "begun[l] + 0.5 * search.length[l]", "begun[l]", MIDPOINT),
    ("solver.c", "begun[l] = begun[l] +", "begun[l] = 0.0 * begun[l] +", MIDPOINT),
]


@pytest.mark.parametrize(("file", "old", "new", "choice"), SPOILED_STEPS)
def test_steps_that_lose_the_time_differ_from_those_of_the_twin(file, old, new, choice):
    """In C or in NumPy, whose texts are two."""
    texts = dict(render(DRIVEN, "driven").texts)
    assert old in texts[file]
    texts[file] = texts[file].replace(old, new)
    with load_texts(texts) as system, pytest.raises(CrossCheckError, match="differs from its"):
        load_steps(system, choice, "c")


def test_the_ladder_passes_for_pairs_at_a_time():
    """Sums over partners have a factor that depends on time: 50 digits, then bits."""
    old = "log((x[i] - x[j])^2 + (y[i] - y[j])^2)"
    text = VORTICES.replace("[hamiltonian]", '[time]\nname = "t"\n[hamiltonian]')
    text = text.split("[claims]")[0].replace(old, MOVING)
    assert MOVING in text
    report = pipeline.verify(pipeline.render(read_spec_text(text, "moving.toml")))
    assert set(report.rungs.values()) == {"passed"}
    assert all(each.points > 20 for each in report.figures["rhs"].values())


@pytest.mark.parametrize(("file", "old", "new"), SPOILED)
def test_the_ladder_sees_a_time_that_is_lost(monkeypatch, file, old, new):
    """Also where the template itself loses it."""
    rendered = render(DRIVEN, "driven")
    own, texts = rendered.family, dict(rendered.texts)
    assert old in texts[file]
    texts[file] = texts[file].replace(old, new)
    monkeypatch.setattr(ladder, "POINTS", 2)
    with load_texts(texts) as system, pytest.raises(CrossCheckError):
        crosscheck_family(own, texts, system, printed=texts)
