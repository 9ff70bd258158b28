"""Held: what is known of members whose function is as good as zero, until they leave or end.

Comes in: places that may turn out to be a crossing or a touch. Goes out: the same, in memory and as
the arrays of a checkpoint.
Read next: `coadjoint.solve.crossings`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.array_types import Array

    Arrays = dict[str, NDArray[np.generic]]


class Point(NamedTuple):
    """A place that may turn out to be a crossing or a touch."""

    time: float
    state: Array


@dataclass
class Held:
    """What is known of a member whose function is within the band.

    Attributes:
        root: Where it changed its sign first; None if it did not.
        touch: Where it came closest, or farthest beyond.
        least: The value there, positive on the side from which it came.
        turned: Whether it has gone away from there.
        ends: Whether it would reach zero next, within the tolerance of the time.
        clear: Whether the last value is more than rounding.
    """

    root: Point | None
    touch: Point
    least: float
    turned: bool
    ends: bool
    clear: bool


def save_held(held: Mapping[int, Held]) -> Arrays:
    """What is held of members, as arrays by name."""
    known = [each.root or each.touch for each in held.values()]
    touches = [each.touch for each in held.values()]
    return {
        "member": np.array(list(held), np.intp),
        "rooted": np.array([each.root is not None for each in held.values()], bool),
        "root_time": np.array([point.time for point in known]),
        "root_state": np.array([point.state for point in known]),
        "touch_time": np.array([point.time for point in touches]),
        "touch_state": np.array([point.state for point in touches]),
        "least": np.array([each.least for each in held.values()]),
        "flags": np.array([(h.turned, h.ends, h.clear) for h in held.values()], bool),
    }


def restore_held(arrays: Mapping[str, NDArray[np.generic]]) -> dict[int, Held]:
    """What `save_held` saved."""
    rows = {name: array.tolist() for name, array in arrays.items() if not name.endswith("state")}
    found = {}
    for n, member in enumerate(rows["member"]):
        root = Point(rows["root_time"][n], np.array(arrays["root_state"][n], np.float64))
        turned, ends, clear = rows["flags"][n]
        found[member] = Held(
            root=root if rows["rooted"][n] else None,
            touch=Point(rows["touch_time"][n], np.array(arrays["touch_state"][n], np.float64)),
            least=rows["least"][n],
            turned=turned,
            ends=ends,
            clear=clear,
        )
    return found
