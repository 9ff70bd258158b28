"""Steps that are a sequence of maps: products of flows, and that of Kahan's method.

Comes in: the maps of the generated ``solver.py`` with the part of the step that each takes. Goes
out: where a step of each lane leads. Maps tell what they add to a state; where they keep something
exactly the sum is compensated, so that roundings are those of a rise, and not of a state. The path
within a step is the cubic with the states and the rates of both ends, as that of the classical
method.
Read next: `coadjoint.lower.mapped`, which says what the maps are.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from coadjoint.solve.runge_kutta import follow_cubic
from coadjoint.solve.steps import Attempt, Lanes, Left, add_low, find_fixed_step

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.render.targets.modules import KernelModule

    #: What a time adds to the state of lanes, given their parameters.
    Map = Callable[[Array, Array, Array], Array]
    #: A map, its part of the step, and the rows to which it adds something.
    Part = tuple[Map, float, tuple[int | slice, ...]]


class Maps:
    """A method that is a sequence of maps, with a fixed step.

    Args:
        maps: Each map with its part of the step and the rows that it moves, in the order in which
            they act.
        rates: Rates of lanes, at states some time later, for the path within steps.
        size: The step.
        is_compensated: Whether what rounding takes of the state is kept.
        branches: Whether the rates have branch points: they have to be finite after each step.
    """

    tries_again = halves = False

    def __init__(
        self,
        maps: Sequence[Part],
        rates: Callable[[Lanes, Array, Array], Array],
        size: float,
        *,
        is_compensated: bool,
        branches: bool = False,
    ) -> None:
        self.maps, self.rates, self.size, self.branches = maps, rates, size, branches
        self.is_compensated = is_compensated

    def try_step(self, lanes: Lanes) -> Attempt:
        """As `coadjoint.solve.steps.Method.try_step`."""
        h = find_fixed_step(lanes, self.size)
        end = lanes.state.copy()
        memory = None
        if self.is_compensated and lanes.memory is not None:
            memory = lanes.memory[: len(end)].copy()
        for move, part, rows in self.maps:
            rises = move(end, lanes.parameters, h if part == 1.0 else h * part)
            for row in rows:
                if memory is None:
                    end[row] = end[row] + rises[row]
                else:
                    end[row], memory[row] = add_low(end[row], memory[row], rises[row])
        left = None
        if memory is not None:
            left = Left(memory, np.zeros(h.shape, np.uint64), np.ones(h.shape, bool))
        return follow_cubic(self, lanes, h, end, left=left)


def make_maps(module: KernelModule, method: str) -> list[Part]:
    """The maps of a method, from the text of a solver in NumPy.

    Args:
        module: The text.
        method: One of its ``SCHEDULES``.
    """
    moved = module.value("MOVED")
    return [
        (module.function(f"find_{name}"), part, moved[name])
        for name, part in module.value("SCHEDULES")[method]
    ]
