"""Structured: methods that keep the structure of a motion, as members of a batch take their steps.

Comes in: one of them by its name, and functions of the kernel. Goes out: a step of each lane, what
it leaves for the next one, and how many sweeps it took.
Read next: `coadjoint.solve.methods.lie_poisson`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.methods import STRUCTURED
from coadjoint.solve.runge_kutta import follow_cubic
from coadjoint.solve.steps import Attempt, Lanes, Left, find_fixed_step

if TYPE_CHECKING:
    from collections.abc import Mapping

    from coadjoint.solve.methods.lie_poisson import LiePoisson


class Structured:
    """A method that keeps structure, with steps of one length.

    Args:
        name: One of `STRUCTURED`.
        size: The step.
        functions: ``rates`` and what the method needs, by their names: of lanes, some time after
            where these are, at a state, and what else they take.
        branches: Whether the rates have branch points: they have to be finite after each step.
        newton: Whether Newton's method solves the equations, with ``jacobian`` or ``along``.
    """

    tries_again = halves = False

    def __init__(
        self,
        name: str,
        size: float,
        functions: Mapping[str, Any],
        *,
        branches: bool = False,
        newton: bool = False,
    ) -> None:
        own = STRUCTURED[name]
        make = import_module(f"coadjoint.solve.methods.{own.file}").make
        self.rates, self.size, self.branches = functions["rates"], size, branches
        self.method: LiePoisson = make(functions, size, own.order)
        if newton:
            self.method.jacobian = functions.get("jacobian")
            self.method.along = functions.get("along")
            self.method.bands = functions.get("bands")

    def try_step(self, lanes: Lanes) -> Attempt:
        """As `coadjoint.solve.steps.Method.try_step`."""
        h, start = find_fixed_step(lanes, self.size), lanes.state
        assert lanes.memory is not None
        found, memory, solved, sweeps = self.method.advance(lanes, h, start, lanes.memory)
        end = np.where(solved, found, start)
        left = Left(memory, sweeps, solved)
        return follow_cubic(self, lanes, h, end, accepted=solved, left=left)
