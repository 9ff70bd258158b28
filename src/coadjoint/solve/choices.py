"""Choices: a generated method, its order and what it integrates.

Comes in: what a run asks for. Goes out: a `Choice`, which says what is compiled.
Read next: `coadjoint.solve.solvers`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from coadjoint.build.compiler import Source
from coadjoint.solver_kinds import SOLVER, SolverKind

#: Methods that are a sequence of maps, with their orders; only some systems have the maps.
ORDERS: Final = {"splitting": 2, "splitting4": 4, "splitting6": 6, "kahan": 2}
MAPPED: Final = tuple(ORDERS)
#: Methods that are generated.
GENERATED: Final = ("taylor", "dop853", "rk4", *MAPPED)
#: Those of systems with noise.
NOISY: Final = ("heun", "midpoint")


@dataclass(frozen=True)
class Choice:
    """A method of integration.

    Attributes:
        name: One of `GENERATED` or `NOISY`.
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
        return {"dop853": 7, "rk4": 3, **dict.fromkeys(MAPPED, 3), "heun": 1, "midpoint": 1}.get(
            self.name, self.order
        )

    def __str__(self) -> str:
        return self.name
