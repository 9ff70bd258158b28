"""Solutions of each kind, which files must keep to the last bit."""

from __future__ import annotations

import math
from functools import cache, partial

import numpy as np

from coadjoint.solve.course import Course
from coadjoint.solve.ensemble import Status
from coadjoint.solve.events import Event
from coadjoint.solve.request import EXPLICIT, IMPLICIT
from coadjoint.solve.solution import Solution
from coadjoint.systems import kapitza_top, rigid_body
from tests.driven_specs import POINT
from tests.rolling import FOLLOWED_SLEIGH, built

SOURCE = np.random.default_rng(7)


def find_states(record, steps, after):
    """States within recorded steps, ``(n, M)``, some times after these began, by Horner."""
    path = record.path[steps]
    total = path[:, :, record.degree].T
    for k in range(record.degree - 1, -1, -1):
        total = total * after + path[:, :, k].T
    return total


def check_same(found, solution):
    """Two solutions are equal to the last bit, with all that is known about them."""
    for name in ("time", "state", "parameters", "reconstructed", "inputs"):
        ours, theirs = getattr(solution, name), getattr(found, name)
        assert (ours is None) == (theirs is None), name
        if ours is not None:
            assert ours.shape == theirs.shape, name
            assert ours.tobytes() == theirs.tobytes(), name
    for name in ("steps", "rejected", "time_reached"):
        assert np.array_equal(getattr(found, name), getattr(solution, name)), name
    assert repr(found.final) == repr(solution.final)
    assert repr(found.drift) == repr(solution.drift)
    system = solution.system
    followed = () if solution.reconstructed is None else system.RECONSTRUCTED.components
    for name in (*system.STATE.components, *followed):
        assert np.array_equal(found.first(name), solution.first(name))
    check_same_events(found.events, solution.events)
    check_same_steps(found, solution)
    for name in ("system", "status", "message", "settings"):
        assert np.array_equal(getattr(solution, name), getattr(found, name)), name


def check_same_events(found, events):
    """The events of two solutions are equal to the last bit."""
    assert list(found) == list(events)
    for name, each in events.items():
        assert (found[name].event, found[name].batch) == (each.event, each.batch)
        for part in ("member", "time", "direction", "state", "parameters", "inputs", "undefined"):
            ours, theirs = getattr(each, part), getattr(found[name], part)
            assert (ours is None) == (theirs is None), part
            if ours is not None:
                assert ours.shape == theirs.shape, part
                assert ours.tobytes() == theirs.tobytes(), part


def check_same_steps(found, solution):
    """The dense outputs of two solutions are equal to the last bit."""
    assert (found.dense is None) == (solution.dense is None)
    if solution.dense is None:
        return
    last = float(np.max(solution.time_reached))
    times = np.linspace(solution.dense.start, last, 23)
    one, other = found.at(times), solution.at(times)
    for name in ("state", "inputs", "reconstructed"):
        ours, theirs = getattr(other, name), getattr(one, name)
        assert (ours is None) == (theirs is None), name
        assert ours is None or ours.tobytes() == theirs.tobytes(), name
    assert one.course.start.time == other.course.start.time
    assert type(found.dense.signal) is type(solution.dense.signal)


@cache
def turn_bodies(batch=()):
    """A body, or some, with events: some that occur, one that never does, one undefined later."""
    state = np.random.default_rng(6).normal(size=(3, *batch))
    asked = ["Pi2", Event("sqrt(Pi1/norm(Pi) + 1) == 1", terminal=3, name="third"), "Pi1 == 99"]
    return rigid_body.simulate(state, (0, 30), samples=4, target="numpy", events=asked)


def made(batch=(), **changes):
    """A solution with numbers that have all their digits, and some that are none."""
    state = SOURCE.normal(size=(3, *batch, 4)) * 1e-3
    state[1, ..., -1] = np.nan
    state[2, ..., -1] = -np.inf
    status = changes.pop("status", np.full(batch, "MAX_STEPS"))
    codes = np.array([Status[name] for name in np.ravel(status)], np.int8).reshape(batch)
    given = {
        "system": rigid_body.system,
        "time": np.array([0.0, 0.1, 1 / 3, math.pi]),
        "state": state,
        "parameters": SOURCE.uniform(1, 2, size=(3, *batch)),
        "status": str(status) if not batch else "",
        "message": 'it "stopped",\nhere # so',
        "course": Course(method="dop853", order=8, rtol=1e-10, atol=1e-12, step=None, codes=codes),
    }
    return Solution(**(given | changes))


@cache
def follow_sleigh(samples=7, **options):
    """A sleigh with its place."""
    return built(FOLLOWED_SLEIGH).simulate(
        [1, 1], (0, 2), samples=samples, target="numpy", reconstruct=True, **options
    )


#: Methods whose steps are kept; those of SciPy have interpolants of their own.
DENSE = ("taylor", "dop853", *(f"scipy:{name}" for name in (*EXPLICIT, *IMPLICIT)))


@cache
def turn_densely(method, batch=()):
    """A body, or some, with their steps; one ends at an event."""
    state = np.random.default_rng(6).normal(size=(3, *batch))
    asked = Event("Pi2", terminal=2, name="end")
    return rigid_body.simulate(state, (0, 3), samples=3, target="numpy", events=asked,
                               dense=True, method=method, rtol=1e-5, atol=1e-7)  # fmt: skip


def drive_point(inputs, **options):
    """A point that is pushed."""
    run = {"samples": 6, "target": "numpy", **options}
    return built(POINT).simulate([0.3, 0.1], (0, 1), None, inputs, **run)


def sample_point(form="linear", **options):
    """A point that is pushed by samples."""
    times = np.array([0.0, 0.5, 1.0])
    return drive_point((times, {"f": [1, 3, 2], "k": np.ones((2, 3))}, form), **options)


hold_point = partial(sample_point, "previous")


def drive_nowhere(**options):
    """A body whose rates are not finite at its start: it makes no step."""
    return rigid_body.simulate([1e200, 1e200, 1e200], (0, 1), target="numpy", **options)


@cache
def shake_top():
    """A top whose motion depends on time."""
    start = [1, 2, 3, 0, 0.6, 0.8]
    return kapitza_top.simulate(start, (0, 0.2), samples=5, target="numpy")


def drive_members(force=None, **options):
    """Three pushed points, the last of which leaves the finite numbers between two samples."""
    times = np.array([0.0, 0.5, 1.0])
    state = np.array([[0.3, 0.1, 1e308], [0.1, 0.2, 1e308]])
    inputs = times, {"f": [1, 3, 2], "k": np.ones((2, 3))}, "linear"
    inputs = inputs if force is None else {"f": force}
    return built(POINT).simulate(state, (0, 1), None, inputs, target="numpy", **options)


#: One solution of each kind.
RUNS = {
    "one": made,
    "reconstructed": follow_sleigh,
    "the end of what is reconstructed": partial(follow_sleigh, 1),
    "time": shake_top,
    "constant inputs": partial(drive_point, {"f": 1 / 3}),
    "sampled inputs": sample_point,
    "one sample": partial(made, time=np.zeros(1), state=np.ones((3, 1))),
    "events": turn_bodies,
    "events of members": partial(turn_bodies, (2, 3)),
    **{f"steps of {each}": partial(turn_densely, each) for each in DENSE},
    "steps of members": partial(turn_densely, "taylor", (2, 3)),
    "steps with sampled inputs": partial(sample_point, dense=True),
    "steps with held inputs": partial(hold_point, dense=True),
    "steps with inputs of each": partial(drive_members, [1, 1 / 3, 2], samples=3, dense=True),
    "steps of what is reconstructed": partial(follow_sleigh, 7, dense=True),
    "no steps": partial(drive_nowhere, dense=True),
    "batch": partial(made, (5,)),
    "batch of two axes": partial(made, (3, 2)),
    "members on their way": partial(drive_members, samples=4),
    "the end of members": partial(drive_members, samples=1),
    "members with constant inputs": partial(drive_members, 1 / 3, samples=3),
    "members with inputs of each": partial(drive_members, [1, 1 / 3, 2], samples=3),
}
