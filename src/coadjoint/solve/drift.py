"""Drift: how much a motion changes what it should conserve.

Comes in: a Solution. Goes out: the largest relative change of each conserved observable, of one
trajectory or of each of a batch.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.solve.solution import Solution


def find_drift(solution: Solution) -> dict[str, Any]:
    """Largest change of each conserved observable, relative to its largest size.

    That of what `begins_small` is the change itself: its ratio to its own roundings would be 1.
    """
    axes, drifts = len(solution.batch), dict[str, Any]()
    for name in solution.conserved:
        change, values = solution.change(name), solution[name]
        if begins_small(solution, name):
            moved = _find_size(change, axes)
            drifts[name] = moved if axes else float(moved)
            continue
        sizes = np.concatenate([solution.first(name), values], axis=-1)
        drifts[name] = _compare_each(change, sizes, axes) if axes else _compare(change, sizes)
    return drifts


def list_conserved(solution: Solution) -> tuple[str, ...]:
    """Names of the observables that the motion conserves; some only if inputs are constant."""
    inputs, start = solution.inputs, solution.course.start
    steady = inputs is None or inputs.ndim == 1 or bool((inputs == inputs[..., :1]).all())
    if start is not None:
        steady = not start.varies
    quantities = solution.system.OBSERVABLES.values()
    return tuple(q.name for q in quantities if q.conserved and (steady or not q.while_constant))


def find_attitude_drift(solution: Solution) -> dict[str, float]:
    """Largest ``| |q|^2 - 1 |`` of each attitude that was reconstructed."""
    if solution.reconstructed is None:
        return {}
    turning = (q for q in solution.system.RECONSTRUCTED.values() if q.is_quaternion)
    return {
        q.name: float(np.nanmax(np.abs((solution[q.name] ** 2).sum(axis=0) - 1))) for q in turning
    }


def tell_drift(solution: Solution, name: str, component: str = "") -> str:
    """The drift of an observable, or of one of its components, as text; of a batch the largest.

    That of a component is relative to the largest component of the whole, since it may be 0 itself.
    A change that is larger than the value at the start is told as it is, since its ratio to values
    says nothing: that of what begins at 0 is 1.

    Args:
        solution: The run.
        name: Of a conserved observable.
        component: Of it; by default all of them, of which the largest drift is told.
    """
    axes, start = len(solution.batch), solution.first(name)
    moved = _find_size(solution.change(component or name), axes)
    if begins_small(solution, name, component):
        return f"{np.max(moved):.1e} absolute"
    if component in ("", name):
        return f"{float(np.max(solution.drift[name])):.1e}"
    size = _find_size(np.concatenate([start, solution[name]], axis=-1), axes)
    parts = np.divide(moved, size, out=np.zeros(np.shape(moved)), where=size > 0)
    return f"{float(np.max(parts)):.1e}"


def begins_small(solution: Solution, name: str, component: str = "") -> bool:
    """Whether an observable, or a component, changes by more than the observable is at the start.

    Of a batch, in one trajectory at least.
    """
    axes = len(solution.batch)
    moved = _find_size(solution.change(component or name), axes)
    return bool(np.any(moved > _find_size(solution.first(name), axes)))


def list_owners(solution: Solution) -> dict[str, str]:
    """The conserved observable that each component is of, by the name of the component."""
    kept = (solution.system.OBSERVABLES[name] for name in solution.drift)
    return {component: each.name for each in kept for component in each.components}


def describe_drift(solution: Solution) -> list[str]:
    """A line for each conserved observable and attitude; of a batch the largest drift."""
    most = " up to" if solution.batch else ""
    lines = [f"  drift of {name}:{most} {tell_drift(solution, name)}" for name in solution.drift]
    turning = solution.attitude_drift.items()
    return lines + [f"  |{name}|^2 - 1: {value:.1e}" for name, value in turning]


def _compare(change: Array, values: Array) -> float:
    """Largest change over largest size."""
    size = float(np.abs(values).max())
    with np.errstate(invalid="ignore"):
        return float(np.abs(change).max() / size) if size else 0.0


def _compare_each(change: Array, values: Array, axes: int) -> Array:
    """Largest change over largest size, of each trajectory of a batch of so many axes.

    NaN, where a trajectory did not come, is left out; the first sample of each is a number.
    """
    most, size = _find_size(change, axes), _find_size(values, axes)
    return np.asarray(np.divide(most, size, out=np.zeros(np.shape(most)), where=size > 0))


def _find_size(values: Array, axes: int) -> Array:
    """The largest number in size at all times, of each trajectory of a batch of so many axes."""
    lead = tuple(range(values.ndim - axes - 1))
    return np.asarray(np.fmax.reduce(np.abs(values), axis=-1, initial=0.0).max(axis=lead))
