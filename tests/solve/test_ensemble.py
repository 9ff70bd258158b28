"""Steps that solvers record: polynomials of the motion, the same from everybody; and early ends."""

from types import SimpleNamespace

import numpy as np
import pytest

from coadjoint.solve.choices import Choice
from coadjoint.solve.ensemble import Ensemble, Inputs, Status
from coadjoint.solve.limits import Limits
from coadjoint.solve.march import march
from coadjoint.solve.solvers import load
from coadjoint.solve.step_records import ROOM, Record
from coadjoint.solve.steps import Attempt
from coadjoint.solve.twins import NumpyStepper
from coadjoint.systems import rigid_body
from tests.kernels import COMPILER
from tests.solve.runs import find_states

pytestmark = pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
CHOICES = [
    Choice(name="taylor", order=9),
    Choice(name="dop853", order=8),
    Choice(name="rk4", order=4),
]
MEMBERS = 21
SAMPLES = np.linspace(0, 3, 31)


def begin(choice, samples=SAMPLES):
    """Free bodies at the start of a run."""
    source = np.random.default_rng(5)
    run = Ensemble(
        state=source.normal(size=(3, MEMBERS)),
        parameters=np.array([1.0, 2.0, 3.0]),
        inputs=Inputs(np.array([0.0]), np.zeros((0, 1)), np.zeros((0, 1))),
        has_time=False,
        samples=samples,
        out=np.full((3, MEMBERS, samples.size), np.nan),
        rtol=1e-8,
        atol=1e-10,
        size=0.05 if choice.name == "rk4" else 0.0,
        max_steps=1000,
    )
    run.begin(float(samples[0]))
    return run


def stepper(choice, target="c"):
    """A solver of the free body."""
    system = rigid_body.system
    return NumpyStepper(system, choice) if target == "numpy" else load(system, choice, target)


def record_all(choice, target, room=10000, work=1000):
    """A run to its end, and its steps, those of each member together."""
    run, record, kept = begin(choice), Record.make(3, choice.degree, room), []
    solver = stepper(choice, target)
    for _ in range(100000):
        on = solver.advance(run, 0, MEMBERS, work, record)
        kept.append(record.rows[: record.count].copy())
        record.clear()
        if not on:
            break
    rows = np.concatenate(kept)
    order = np.argsort(rows[:, 0], kind="stable")
    return run, Record(rows[order], choice.degree, len(rows))


def check_paths(run, record):
    """The polynomials give the samples, join each other, and begin with the rates."""
    for member in range(MEMBERS):
        steps = np.flatnonzero(record.member == member)
        begun, length, path = (getattr(record, n)[steps] for n in ("begun", "length", "path"))
        assert record.rows[steps, 1].tolist() == list(range(1, len(steps) + 1))
        assert len(steps) == run.steps[member] > 2
        assert (begun[1:] == (begun + length)[:-1]).all()
        ends = find_states(record, steps, length)
        joined = np.column_stack([path[1:, :, 0].T, run.state[:, member]])
        assert np.abs(ends - joined).max() < 1e-14
        rates = rigid_body.rhs(np.ascontiguousarray(path[:, :, 0].T), run.parameters)
        assert np.abs(rates - path[:, :, 1].T).max() < 1e-13
        where = np.searchsorted(begun, run.samples, side="right") - 1
        found = find_states(record, steps[where], run.samples - begun[where])
        assert np.abs(found - run.out[:, member]).max() < 1e-14


@pytest.mark.parametrize("target", ["c", "numpy"])
@pytest.mark.parametrize("choice", CHOICES, ids=str)
def test_recorded_steps_are_the_path(choice, target):
    """Of each method, as samples have it; these are compared with elliptic functions elsewhere."""
    check_paths(*record_all(choice, target))


@pytest.mark.parametrize("place", [(5, 3), (40, 4), (7, 5), (9, 6), (12, -1)])
def test_a_spoiled_record_is_seen(place):
    """One number of one step: its start, its length, or any coefficient."""
    run, record = record_all(CHOICES[1], "c")
    record.rows[place] += 1e-6
    record.rows[place] *= 1 + 1e-3
    with pytest.raises(AssertionError):
        check_paths(run, record)


@pytest.mark.parametrize("choice", CHOICES, ids=str)
def test_everybody_records_the_same_steps(choice):
    """C and NumPy to the bit, in calls that end for lack of room or of work."""
    run, expected = record_all(choice, "c")
    for target, room, work in (("numpy", 10000, 50), ("c", ROOM, 1000), ("numpy", 9, 7)):
        other, found = record_all(choice, target, room, work)
        assert np.array_equal(found.rows, expected.rows)
        assert np.array_equal(other.state, run.state)
        assert np.array_equal(other.out, run.out)
    assert np.isfinite(expected.rows).all()


@pytest.mark.parametrize("target", ["c", "numpy"])
def test_a_member_stops_within_a_step(target):
    """Its later samples and steps are taken back; its neighbours and its earlier ones stay."""
    choice = CHOICES[0]
    free, _ = record_all(choice, "c")
    run, when = begin(choice), 1.234

    def watch(record):
        chosen = np.isin(record.member, (2, 17)) & (record.begun < when)
        chosen &= when <= record.begun + record.length
        for step in np.flatnonzero(chosen):
            after = when - record.begun[step]
            run.stop(
                record, step, after, find_states(record, np.array([step]), np.array([after]))[:, 0]
            )

    march(stepper(choice, target), run, 0.0, 2, watch=SimpleNamespace(look=watch, terms=None))
    assert (run.status == Status.EVENT).nonzero()[0].tolist() == [2, 17]
    assert (run.status == Status.OK).sum() == MEMBERS - 2
    others = np.delete(np.arange(MEMBERS), (2, 17))
    assert np.array_equal(run.out[:, others], free.out[:, others])
    end, _ = begin_at_end(choice, when)
    for member in (2, 17):
        assert np.array_equal(run.out[:, member, :13], free.out[:, member, :13])
        assert np.isnan(run.out[:, member, 13:]).all()
        assert (run.time[member], run.next[member]) == (when, 13)
        assert run.steps[member] == end.steps[member] < free.steps[member]
        assert np.abs(run.state[:, member] - end.state[:, member]).max() < 1e-13


class Broken:
    """A step whose end is known, and whose path is not a number."""

    tries_again = halves = False

    def try_step(self, lanes):
        """The end of the step."""
        h = lanes.end - lanes.time
        return Attempt(
            took=h,
            state=lanes.state,
            accepted=np.ones(h.shape, bool),
            path=lambda after: np.full(lanes.state.shape, np.nan),
            coefficients=lambda: np.zeros((3, 1, h.size)),
        )


@pytest.mark.parametrize("has_domain", [True, False])
def test_a_sample_at_the_end_that_is_outside_ends_a_run_there(has_domain):
    """As in C: the path tells whether a state is inside, though the end itself would be."""
    run = begin(CHOICES[1], np.array([0.0, 3.0]))
    inside = Limits(domain=lambda lanes, after, state: 1 + 0 * state[:1], strict=(True,))
    run.advance(Broken(), 1, limits=inside if has_domain else Limits())
    assert set(run.status) == {Status.DOMAIN if has_domain else Status.OK}
    assert (run.time == (0.0 if has_domain else 3.0)).all()


def begin_at_end(choice, end):
    """A run that ends earlier."""
    run = begin(choice, np.array([0.0, end]))
    return run, stepper(choice).advance(run, 0, MEMBERS, 10000)


class Rounds:
    """A checkpoint that wants to be written at once, and notes the steps of each member then."""

    seconds = 0.0

    def __init__(self):
        self.steps = []

    def write(self, run):
        """Note them."""
        self.steps.append(run.steps.copy())


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_every_round_takes_all_members_on_whatever_the_load(threads, monkeypatch):
    """Each slice makes one call before a checkpoint, though its thread may begin late or early."""
    monkeypatch.setattr(NumpyStepper, "first_work", 7)
    choice, checkpoint = Choice(name="rk4", order=4), Rounds()
    run = begin(choice)
    march(stepper(choice, "numpy"), run, 0.0, threads, checkpoint=checkpoint)
    for count, steps in enumerate(checkpoint.steps, 1):
        assert (steps == min(7 * count, 60)).all()
    assert len(checkpoint.steps) == 9
    assert (run.status == Status.OK).all()
