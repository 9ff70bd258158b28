"""One by one: the trajectories of a batch where Python leads the steps of each.

Comes in: a batch, and what follows one trajectory. Goes out: one Solution of all, with the bits
that each has alone: steps that follow tolerances are of each trajectory, and so is how it ended.
Read next: `coadjoint.solve.simulate`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.arrays import pack_parameters
from coadjoint.solve.course import Course, Start
from coadjoint.solve.dense_output import Dense, join_interpolants
from coadjoint.solve.ensemble import Status, tell_endings
from coadjoint.solve.occurrences import Events, join_occurrences
from coadjoint.solve.solution import Solution

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.array_types import Array
    from coadjoint.solve.request import Request
    from coadjoint.solve.system import System


def simulate_one_by_one(
    system: System, request: Request, follow: Callable[[Request], Solution]
) -> Solution:
    """A batch of trajectories.

    Args:
        system: The System, which nothing drives.
        request: What was asked for, with states ``(n, *batch)``.
        follow: Follows one trajectory.

    Raises:
        KernelArgumentError: Parameters have the shape of another batch.
    """
    batch = request.state.shape[1:]
    parameters = pack_parameters(system, request.parameters).copy()
    _check_batch(system, parameters, batch)
    states = request.state.reshape(len(request.state), -1)
    shared = parameters.ndim == 1
    rows = parameters if shared else parameters.reshape(len(parameters), -1)
    runs = [
        follow(
            replace(
                request,
                state=np.ascontiguousarray(state),
                parameters=parameters if shared else np.ascontiguousarray(rows[:, member]),
            )
        )
        for member, state in enumerate(states.T)
    ]
    samples, codes = [_take_samples(run, request.times) for run in runs], _find_codes(runs, batch)
    return Solution(
        system,
        request.times.copy(),
        np.stack(samples, axis=1).reshape(len(states), *batch, -1),
        parameters,
        "",
        tell_endings(codes),
        course=_join_courses(runs, codes, request),
        events=_join_events(runs, batch),
        dense=_join_dense(runs, request.start),
    )


def _check_batch(system: System, parameters: Array, batch: tuple[int, ...]) -> None:
    """Parameters are of all trajectories, or of each.

    Raises:
        KernelArgumentError: They are of another batch.
    """
    if parameters.shape[1:] in ((), batch):
        return
    raise KernelArgumentError(
        f"parameters of {system.name} have the batch shape {parameters.shape[1:]}, the state "
        f"{batch}; expected the same, or parameters shared by all members.",
        found=list(parameters.shape[1:]),
        expected=list(batch),
    )


def _take_samples(run: Solution, times: Array) -> Array:
    """The states of a trajectory at the times of all, ``(n, T)``; NaN where it did not come."""
    found = np.full((len(run.state), times.size), np.nan)
    count = min(len(run.time), times.size)
    count -= bool(count) and run.time[count - 1] != times[count - 1]  # where it stopped between
    found[:, :count] = run.state[:, :count]
    return found


def _find_codes(runs: Sequence[Solution], batch: tuple[int, ...]) -> NDArray[np.int8]:
    """How each ended."""
    return np.array([Status[run.status] for run in runs], np.int8).reshape(batch)


def _join_courses(runs: Sequence[Solution], codes: NDArray[np.int8], request: Request) -> Course:
    """How all of them went."""
    batch, own = codes.shape, runs[0].course
    start = None
    if own.start is not None:
        start = Start(
            time=request.start, state=request.state.copy(), inputs=own.start.inputs, varies=False
        )
    counted: dict[str, Any] = {
        name: np.array([getattr(run, name) for run in runs], np.uint64).reshape(batch)
        for name in ("steps", "sweeps")
        if getattr(own, name) is not None
    }
    return replace(
        own,
        **counted,
        codes=codes,
        reached=np.array([run.time[-1] for run in runs]).reshape(batch),
        last=np.stack([run.state[:, -1] for run in runs], axis=1).reshape(-1, *batch),
        start=start,
    )


def _join_events(runs: Sequence[Solution], batch: tuple[int, ...]) -> Events:
    """The events of all."""
    names = runs[0].events
    return Events(
        {name: join_occurrences([run.events[name] for run in runs], batch) for name in names}
    )


def _join_dense(runs: Sequence[Solution], start: float) -> Dense | None:
    """The steps of all; None if they were not to be kept."""
    own = [run.dense for run in runs if run.dense is not None]
    return Dense(join_interpolants([each.steps for each in own]), None, start) if own else None
