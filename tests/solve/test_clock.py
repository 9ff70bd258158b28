"""Tests of the time after many steps of fixed length, and of what steps leave for the next ones."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from coadjoint.methods import MAPPED, STRUCTURED
from coadjoint.solve.choices import Choice
from coadjoint.solve.ensemble import Ensemble, Inputs
from coadjoint.solve.methods.gauss import Gauss
from coadjoint.solve.methods.lie_poisson import (
    EXACT,
    FEW_ROWS,
    FREE,
    Search,
    Sweep,
    continue_offset,
    keep_offset,
)
from coadjoint.solve.methods.midpoint import Midpoint
from coadjoint.solve.steps import add_low
from coadjoint.systems import rigid_body
from tests.solve.methods.algebras import make_lanes, make_memory

BODY, INERTIA = np.array([0.6, 0.4, 0.7]), {"I": [2.0, 1.0, 2 / 3]}


def make_steps(method: str, target: str, size: float, count: int) -> Ensemble:
    """A free body after so many steps, with no end in sight."""
    order = {**STRUCTURED, **MAPPED}[method].order if method != "rk4" else 4
    choice = Choice(name=method, order=order)
    run = Ensemble(
        state=BODY[:, np.newaxis].copy(),
        parameters=np.array(INERTIA["I"]),
        inputs=Inputs(np.zeros(1), np.zeros((0, 1)), np.zeros((0, 1))),
        has_time=False,
        samples=np.array([1e9]),
        out=None,
        rtol=1e-9,
        atol=1e-9,
        size=size,
        max_steps=10**9,
        remembered=choice.count_memory(3),
        is_implicit=choice.is_structured,
    )
    run.begin(0.0)
    rigid_body.system._solvers.get(choice, target, 1).advance(run, 0, 1, count)
    assert run.steps[0] == count
    return run


@pytest.mark.parametrize(("target", "count"), [("numpy", 300), ("c", 300_000)])
@pytest.mark.parametrize("method", ["rk4", "midpoint", "splitting"])
def test_the_time_after_many_steps_is_rounded_once(method: str, target: str, count: int) -> None:
    """It is the number nearest to n h; a plain sum of so many steps is another one."""
    plain = 0.0
    for _ in range(count):
        plain += 0.1
    run = make_steps(method, target, 0.1, count)
    assert run.time[0] == float(Fraction(0.1) * count) != plain


@pytest.mark.parametrize("method", ["rk4", "midpoint", "spherical_midpoint", "splitting4"])
def test_samples_at_ends_of_steps_are_these_ends(method: str) -> None:
    """After 10^5 steps of 0.05 too, to the bit."""
    h, count = 0.05, 100_000
    times = np.array([0, count // 3, count, count + 1]) * h
    sampled = rigid_body.simulate(BODY, times, INERTIA, method=method, step=h)
    assert sampled.state[:, 2].tobytes() == make_steps(method, "c", h, count).state.tobytes()


def test_low_parts_of_flows_keep_casimirs() -> None:
    """A plain sum of the same flows loses ten times as much of the Casimir in 10^5 steps."""
    found = rigid_body.simulate(
        BODY, (0, 5000), INERTIA, method="splitting", step=0.05, samples=101
    )
    assert found.drift["casimir1"] < 3e-15


def find_rates(lanes: Any, after: Any, x: Any) -> Any:
    """A motion that has no rates where x is more than 2."""
    return np.stack([x[1], -x[0]]) * np.sqrt(np.where(abs(x[0]) < 2, 1.0, np.nan))


@pytest.mark.parametrize("method", [Midpoint(rates=find_rates, size=0.1, order=4),
                                    Gauss(rates=find_rates, size=0.1, order=6)])  # fmt: skip
def test_a_search_that_leads_nowhere_begins_at_the_state(method: Any) -> None:
    """What is kept of the steps before may lead away; the step is found nonetheless."""
    x, h = np.array([[1.0, 1.0], [0.0, 0.0]]), np.array([0.1, 0.1])
    fresh = make_memory(method, x)
    misled = fresh.copy()
    misled[2::6, 1] = 50.0  # of each stage the offset of the first component
    with np.errstate(all="ignore"):
        end, memory, solved, sweeps = method.advance(make_lanes(x), h, x, misled)
    assert solved.all()
    assert end[:, 0].tobytes() == end[:, 1].tobytes()
    assert memory[:4, 0].tobytes() == memory[:4, 1].tobytes()
    assert sweeps[1] > sweeps[0]


def test_searches_begin_where_the_last_ones_lead() -> None:
    """After three steps a search takes fewer sweeps, and leads to the same end to rounding."""

    def move(lanes: Any, after: Any, y: Any) -> Any:
        return np.stack([y[1], -np.sin(y[0])])

    method, x, h = (
        Midpoint(rates=move, size=0.1, order=2),
        np.array([[1.0], [0.0]]),
        np.full(1, 0.1),
    )
    memory, counts = make_memory(method, x), []
    for _ in range(6):
        x, memory, _, sweeps = method.advance(make_lanes(x), h, x, memory)
        counts.append(int(sweeps[0]))
    low = make_memory(method, x)
    low[:2] = memory[:2]
    cold, _, _, most = method.advance(make_lanes(x), h, x, low)
    warm, _, _, least = method.advance(make_lanes(x), h, x, memory)
    assert least[0] <= most[0] - 2
    assert counts[-1] <= counts[0] - 2
    assert abs(cold - warm).max() < 4e-16


def test_the_last_three_offsets_are_kept_and_continued() -> None:
    """The newest one first; from the third one on the next is that of their parabola."""
    kept = np.zeros((3, 1, 1))
    rows, following = [], []
    for value in (2.0, 5.0, 9.0, 14.0):
        kept = keep_offset(kept, np.full((1, 1), value)).reshape(kept.shape)
        rows.append(kept.ravel().tolist())
        following.append(float(continue_offset(kept)[0, 0]))
    assert rows == [[2, 0, 0], [5, 2, 0], [9, 5, 2], [14, 9, 5]]
    assert following[2:] == [14.0, 20.0]


def test_a_compensated_sum_is_that_of_fractions() -> None:
    """Of 2000 numbers of many sizes; a plain sum is off by 16 times as much and more."""
    numbers = np.random.default_rng(1).normal(size=2000) * 2.0 ** np.arange(-40, 0).repeat(50)
    high, low, plain = np.array([1.0]), np.array([0.0]), 1.0
    for each in numbers:
        high, low = add_low(high, low, np.array([each]))
        plain += float(each)
    exact = 1 + sum(map(Fraction, numbers.tolist()), Fraction(0))
    assert abs(Fraction(high[0]) + Fraction(low[0]) - exact) < Fraction(1, 2**56)
    assert abs(Fraction(plain) - exact) > Fraction(1, 2**52)


@pytest.mark.parametrize(("rows", "ends"), [(FEW_ROWS, 7), (FEW_ROWS + 1, 6)])
def test_of_few_rows_every_other_sweep_is_asked(rows: int, ends: int) -> None:
    """The sixth sweep changes nothing for the first time; of few rows the seventh is asked."""
    assert (EXACT - FREE) % 2 == 0, "the last sweep before those that are all asked is asked"
    search = Search(np.zeros((rows, 1)), rows)
    for number in range(EXACT):
        if search.done.all():
            break
        middle = np.full((rows, 1), float(min(number, 4)))
        search.take(number, Sweep(middle, np.zeros((rows, 1))))
    assert search.made.tolist() == [ends]
