"""Points between samples: for paths of pictures that would have corners where a motion is fast.

Comes in: a `Solution` and paths that are drawn of it. Goes out: the same motion at more times.
Read next: `coadjoint.solve.paths`, which finds them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from coadjoint.array_types import Array
    from coadjoint.solve.solution import Solution

#: Least angle of a corner, radians, and of its sides, over the extent of all paths.
CORNER, SIDE = 0.15, 0.005
#: The most turning and the most length between points that are kept.
TURN, PART = 0.04, 0.01


def has_corners(paths: Array) -> bool:
    """Whether straight lines through points ``(paths, d, T)`` have corners that are seen.

    >>> t = np.linspace(0, 2 * np.pi, 13)
    >>> circle = np.stack([np.cos(t), np.sin(t)])[None]
    >>> has_corners(circle), has_corners(circle[..., :2])
    (True, False)
    """
    turning, length = _measure(paths)
    seen = length > SIDE
    return bool((seen[:, 1:] & seen[:, :-1] & (turning > CORNER)).any())


def add_times(solution: Solution, find_drawn: Callable[[Solution], Array]) -> Solution:
    """The same motion at more times where what is drawn of it turns or goes far.

    Args:
        solution: The motion.
        find_drawn: Paths of a solution, ``(paths, d, T)``.
    """
    from coadjoint.solve.paths import Path

    path = Path(solution)
    turning, length = _measure(find_drawn(path.take()))
    done = np.cumsum((length / PART)[:, 1:] + turning / TURN, axis=1)  # (paths, T - 2)
    passed = (np.diff(np.floor(done), axis=1, prepend=0.0) > 0).any(axis=0)
    return path.take(np.concatenate([[True], passed, [True]]))


def _measure(paths: Array) -> tuple[Array, Array]:
    """Angles between pieces, ``(paths, T - 2)``, and lengths of pieces over the extent of all."""
    steps = np.diff(paths, axis=-1)
    length = np.linalg.norm(steps, axis=1)  # (paths, T - 1)
    both = length[:, 1:] * length[:, :-1]
    cosine = (steps[..., 1:] * steps[..., :-1]).sum(axis=1) / np.where(both > 0, both, 1.0)
    turning = np.where(both > 0, np.arccos(np.clip(cosine, -1.0, 1.0)), 0.0)
    return turning, length / (float(np.ptp(paths, axis=(0, 2)).max()) or 1.0)
