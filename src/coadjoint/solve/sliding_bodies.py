"""Bodies that slide on a plane without an attitude in what is integrated: how they lie and move.

Part of the state are the vertical Gamma seen from the body, with the rate ``Gamma x Omega``, and
the velocities Omega and Y; an observable is the velocity ``v = Y - Omega x s`` of the point at the
contact, and ``Gamma . v = 0``. The attitude and the place of the centre of mass follow from samples
of Omega and Y. Comes in: a `Solution`. Goes out: a `Sliding`.
Read next: `coadjoint.solve.rolling_bodies`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import permutations
from typing import TYPE_CHECKING, Final

import numpy as np

from coadjoint.errors import CoadjointError
from coadjoint.solve.arms import ROUNDED, Arms, list_vectors
from coadjoint.solve.reconstruct import turn_upright

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.solve.solution import Solution

#: Largest part of a velocity of the contact, over the largest velocity, that leaves the plane:
#: motions keep constraints to their tolerances.
LIFTED: Final = 1e-6
#: Largest angle by which a vertical leaves its own between two samples: more are needed there.
TURNED: Final = 1e-3


@dataclass(frozen=True)
class Sliding:
    """A body that slides.

    Attributes:
        arms: What tells of its arms.
        turned: From axes of the body to those of space, ``(3, 3, T)``; e_z is the vertical.
        contact: On the plane, ``(3, T)``, the third component 0; the centre begins above 0.
        unit: Of lengths; "" where the spec does not tell.
    """

    arms: Arms
    turned: Array
    contact: Array
    unit: str


def follow_sliding(solution: Solution) -> Sliding | None:
    """How a body that slides moves in space; None where there is none, or samples are too few."""
    for arms in _list_arms(solution):
        if not _slides(solution, arms):
            continue
        found = arms.find(solution, solution[arms.vertical])
        turned = None if found is None else _follow_attitude(solution, arms)
        if found is None or turned is None:
            return None
        velocity = np.einsum("jkt,kt->jt", turned, solution[arms.sliding])
        contact = _add_up(solution.time, velocity) - np.einsum("jkt,kt->jt", turned, found)
        contact[2] = 0.0
        own = solution.system.STATE[arms.sliding].unit
        unit = own.removesuffix(f"/{solution.unit('time')}")
        return Sliding(arms=arms, turned=turned, contact=contact, unit="" if unit == own else unit)
    return None


def _list_arms(solution: Solution) -> Iterator[Arms]:
    """Variables that may be those of a sliding body: one turns as a vertical does."""
    system = solution.system
    own, seen = list_vectors(system.STATE), list_vectors(system.OBSERVABLES)
    if len(own) < 3 or not seen or "constraint_residual" not in system.functions:
        return
    try:
        rates = np.asarray(solution.evaluate("rhs", np.asarray(solution.state)))
    except (CoadjointError, TypeError, ValueError):
        return  # it asks for inputs
    for vertical, turning, sliding in permutations(own, 3):
        slope = np.cross(solution[vertical], solution[turning], axis=0)
        gap = np.abs(rates[system.STATE.rows(vertical)] - slope).max()
        if gap <= ROUNDED * max(np.abs(slope).max(), 1e-300):
            yield from (Arms(vertical, turning, moving, sliding) for moving in seen)


def _slides(solution: Solution, arms: Arms) -> bool:
    """Whether an observable is ``Y - Omega x s`` at any velocities, and stays on the plane."""
    vertical = solution[arms.vertical]
    found = arms.find(solution, vertical)
    if found is None:
        return False
    turning, sliding = np.random.default_rng(0).uniform(-1, 1, (2, *vertical.shape))
    value = arms.move(solution, vertical, turning, sliding)
    expected = sliding - np.cross(turning, found, axis=0)
    if value is None or not np.abs(value - expected).max() <= ROUNDED * np.abs(expected).max():
        return False
    turned = np.cross(solution[arms.turning], found, axis=0)
    lifted = (vertical * (solution[arms.sliding] - turned)).sum(axis=0)
    largest = max(np.abs(solution[arms.sliding]).max(), np.abs(turned).max())
    return bool(np.abs(lifted).max() <= LIFTED * largest)


def _follow_attitude(solution: Solution, arms: Arms) -> Array | None:
    """Attitudes with the vertical upright, by Magnus's formula of order 4 between samples."""
    from scipy.interpolate import CubicHermiteSpline
    from scipy.spatial.transform import Rotation

    time, turning = np.asarray(solution.time), solution[arms.turning]
    rates = np.asarray(solution.evaluate("rhs", np.asarray(solution.state)))
    spline = CubicHermiteSpline(
        time, turning, rates[solution.system.STATE.rows(arms.turning)], axis=-1
    )
    steps = np.diff(time)
    # Gauss's two points of each interval; in body axes angles are multiplied from the right
    first, second = (spline(time[:-1] + (0.5 + sign * np.sqrt(3) / 6) * steps) for sign in (-1, 1))
    angles = steps / 2 * (first + second)
    angles += np.sqrt(3) / 12 * steps**2 * np.cross(first, second, axis=0)
    verticals = solution[arms.vertical] / np.linalg.norm(solution[arms.vertical], axis=0)
    start = turn_upright(verticals[:, 0])
    pose = Rotation.from_quat(np.roll(start, -1))
    poses = [pose.as_matrix()]
    for turn, vertical in zip(Rotation.from_rotvec(angles.T), verticals.T[1:], strict=True):
        pose = pose * turn
        shown = pose.apply(vertical)
        if not np.linalg.norm(shown - [0, 0, 1]) <= TURNED:
            return None
        pose = Rotation.from_quat(np.roll(turn_upright(shown), -1)) * pose
        poses.append(pose.as_matrix())
    return np.moveaxis(np.array(poses), 0, -1)


def _add_up(time: Array, velocity: Array) -> Array:
    """A path from 0 with a velocity that is known at samples."""
    from scipy.interpolate import CubicSpline

    path: Array = CubicSpline(time, velocity, axis=-1).antiderivative()(time)
    return path
