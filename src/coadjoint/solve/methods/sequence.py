"""Steps that are a sequence of maps: products of flows, and that of Kahan's method.

Comes in: the maps of the generated ``solver.py`` with the part of the step that each takes. Goes
out: where a step of each lane leads. The path within a step is the cubic with the states and the
rates of both ends, as that of the classical method.
Read next: `coadjoint.lower.mapped`, which says what the maps are.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from coadjoint.solve.runge_kutta import end_where_rates_end
from coadjoint.solve.steps import Attempt, Cubic, Lanes, find_fixed_step

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.render.targets.modules import KernelModule

    Array = NDArray[np.float64]
    #: The state of lanes after a time, given their parameters.
    Map = Callable[[Array, Array, Array], Array]


class Maps:
    """A method that is a sequence of maps, with a fixed step.

    Args:
        maps: Each map with its part of the step, in the order in which they act.
        rates: Rates of lanes, at states some time later, for the path within steps.
        size: The step.
        branches: Whether the rates have branch points: they have to be finite after each step.
    """

    tries_again = halves = False

    def __init__(
        self,
        maps: Sequence[tuple[Map, float]],
        rates: Callable[[Lanes, Array, Array], Array],
        size: float,
        *,
        branches: bool = False,
    ) -> None:
        self.maps, self.rates, self.size, self.branches = maps, rates, size, branches

    def try_step(self, lanes: Lanes) -> Attempt:
        """As `coadjoint.solve.steps.Method.try_step`."""
        h = find_fixed_step(self.size, lanes.end - lanes.time)
        end = lanes.state
        for move, part in self.maps:
            end = move(end, lanes.parameters, h if part == 1.0 else h * part)
        start, none = lanes.state, np.zeros(h.shape)
        path = Cubic(
            h=h,
            start=start,
            end=end,
            first=lambda: self.rates(lanes, none, start),
            last=lambda: self.rates(lanes, h, end),
        )
        return Attempt(
            took=h,
            state=end_where_rates_end(self.rates, lanes, h, end) if self.branches else end,
            accepted=np.ones(h.shape, bool),
            path=path.follow,
            coefficients=path.coefficients,
        )


def make_maps(module: KernelModule, method: str) -> list[tuple[Map, float]]:
    """The maps of a method, from the text of a solver in NumPy.

    Args:
        module: The text.
        method: One of its ``SCHEDULES``.
    """
    return [
        (module.function(f"find_{name}"), part) for name, part in module.value("SCHEDULES")[method]
    ]
