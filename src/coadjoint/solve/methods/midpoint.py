"""The implicit midpoint, and its symmetric compositions.

Comes in: rates, and where members are. Goes out: the middle of a step by sweeps, and its chord.
Read next: `coadjoint.solve.methods.lie_poisson`, whose search and compositions it shares.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from coadjoint.lower.compositions import COMPOSITIONS
from coadjoint.solve.methods.lie_poisson import Arc, LiePoisson, Sweep

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from coadjoint.array_types import Array
    from coadjoint.solve.steps import Lanes


def make(functions: Mapping[str, Callable[..., Array]], size: float, order: int) -> Midpoint:
    """The method of an order, from functions of the kernel."""
    return Midpoint(rates=functions["rates"], size=size, order=order)


class Midpoint(LiePoisson):
    """A step along the rates at the middle of its chord.

    Args:
        rates: Rates of lanes, at states some time later.
        size: The step.
        order: 2, or that of a composition: 4 or 6.
    """

    def __init__(
        self, *, rates: Callable[[Lanes, Array, Array], Array], size: float, order: int = 2
    ) -> None:
        self.rates, self.size, self.stages = rates, size, COMPOSITIONS[order]

    def sweep(self, arc: Arc, middle: Array, kept: None) -> Sweep:
        """As `LiePoisson.sweep`."""
        rates = self.rates(arc.lanes, arc.middle, middle)
        following = arc.state + (arc.low + 0.5 * arc.length * rates)
        return Sweep(following, arc.length * rates, False)
