"""Choices: a generated method, its order and what it integrates.

Comes in: a relative tolerance. Goes out: a `Choice`, which says what is compiled.
Read next: `coadjoint.solve.solvers`.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, log
from typing import Final

from coadjoint.build.compiler import Source
from coadjoint.solver_kinds import SOLVER, SolverKind

#: Methods that are generated.
GENERATED: Final = ("taylor", "dop853", "rk4")
#: The least and the greatest order of the method of Taylor.
ORDERS: Final = (4, 40)


def choose_order(rtol: float) -> int:
    """The order of the method of Taylor that a relative tolerance asks for.

    Three more than that of Jorba and Zou, who count operations of sums alone: measured best, see
    docs/decisions/solver-speed.md.

    >>> choose_order(1e-10), choose_order(2e-16), choose_order(1e-2)
    (16, 23, 7)
    """
    return min(max(ORDERS[0], ceil(4.0 - log(rtol) / 2.0)), ORDERS[1])


@dataclass(frozen=True)
class Choice:
    """A method of integration.

    Attributes:
        name: One of `GENERATED`.
        order: Of the method.
        few: Whether it is for members that fill no more than half of the longest vectors.
        kind: What it integrates.
    """

    name: str
    order: int
    few: bool = False
    kind: SolverKind = SOLVER

    @property
    def source(self) -> Source:
        """What its object is compiled from, with what chooses it there."""
        chosen = f"-DORDER={self.order}" if self.name == "taylor" else f"-D{self.name.upper()}"
        defines = (chosen, "-DFEW") if self.few else (chosen,)
        return Source(self.kind.stem, defines, is_loops=False)

    @property
    def degree(self) -> int:
        """Of the polynomials that are recorded of its steps."""
        return {"dop853": 7, "rk4": 3}.get(self.name, self.order)

    def __str__(self) -> str:
        return self.name
