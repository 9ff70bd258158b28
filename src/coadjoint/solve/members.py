"""Members: one trajectory of a batch, as a Solution of its own.

Comes in: a Solution with a batch, and a place in it. Goes out: the Solution of that member, as long
as it came, with the sample where it stopped.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.array_types import Array
    from coadjoint.solve.solution import Solution


def take_member(solution: Solution, place: tuple[int, ...]) -> Solution:
    """One trajectory of a batch.

    Raises:
        KernelArgumentError: There is no such member.
    """
    _check_place(solution.batch, place)
    course = solution.course.take(place)
    at: Any = (slice(None), *place)
    time, states = solution.time, _stack(solution.state, solution.reconstructed)[at]
    n = len(solution.state)
    end = float(time[-1] if course.reached is None else course.reached)
    reached = ~np.isnan(states[0]) & (time <= end)
    times, states = time[reached], states[:, reached]
    inputs = _take_inputs(solution.inputs, at, reached)
    if course.last is not None and (not times.size or times[-1] < end):
        last = _stack(course.last, course.below)
        times, states = np.append(times, end), np.column_stack([states, last])
        if inputs is not None and course.driven is not None:
            inputs = np.column_stack([inputs, course.driven])
    shared = solution.parameters.ndim == 1
    return type(solution)(
        solution.system,
        times,
        states[:n],
        solution.parameters if shared else solution.parameters[at],
        course.status,
        "" if course.status == "OK" else f"it stopped at {solution.system.clock[0]} = {end:.6g}",
        states[n:] if len(states) > n else None,
        inputs,
        course=course,
        events=solution.events.of(*place),
        dense=None if solution.dense is None else solution.dense.take(place, solution.batch),
    )


def _stack(states: Array, below: Array | None) -> Array:
    """States with what is reconstructed below them."""
    return states if below is None else np.concatenate([states, below])


def _check_place(batch: tuple[int, ...], place: tuple[int, ...]) -> None:
    """A place is within a batch.

    Raises:
        KernelArgumentError: It is not.
    """
    good = len(place) == len(batch) > 0
    if not good or not all(-n <= p < n for p, n in zip(place, batch, strict=True)):
        raise KernelArgumentError(
            f"member {place} is not in a batch of the shape {batch}; expected "
            f"{len(batch)} numbers within it."
            if batch
            else "this solution is one trajectory.",
            found=list(place),
            expected=list(batch),
        )


def _take_inputs(inputs: Array | None, at: Any, reached: NDArray[np.bool_]) -> Array | None:
    """The inputs of a member, at the samples that it reached if they change."""
    if inputs is None or inputs.ndim == 1:
        return inputs
    rows: Array = inputs[at][:, 0] if inputs.ndim > 2 else inputs[:, reached]
    return rows
