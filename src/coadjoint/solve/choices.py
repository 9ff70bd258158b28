"""Choices: a generated method, its order and what it integrates.

Comes in: what a run asks for. Goes out: a `Choice`, which says what is compiled.
Read next: `coadjoint.solve.solvers`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from coadjoint.build.source import Source
from coadjoint.methods import MAPPED, STRUCTURED
from coadjoint.solver_kinds import SOLVER, SolverKind

#: Methods that are generated.
GENERATED: Final = ("taylor", "dop853", "rk4")


@dataclass(frozen=True)
class Choice:
    """A method of integration.

    Attributes:
        name: One of `GENERATED`, `NOISY`, `STRUCTURED` or `MAPPED`.
        order: Of the method.
        few: Whether it is for members that fill no more than half of the longest vectors.
        kind: What it integrates.
        is_noisy: Whether Wiener processes move the state.
        newton: Whether Newton's method solves the equations of its steps.
    """

    name: str
    order: int
    few: bool = False
    kind: SolverKind = SOLVER
    is_noisy: bool = False
    newton: bool = False

    @property
    def source(self) -> Source:
        """What its object is compiled from, with what chooses it there."""
        chosen = f"-DORDER={self.order}" if self.name == "taylor" else f"-D{self.name.upper()}"
        marks = {"-DFEW": self.few, "-DNEWTON": self.newton}
        defines = (chosen, *(mark for mark, is_set in marks.items() if is_set))
        return Source(self.kind.stem, defines, is_loops=False)

    @property
    def degree(self) -> int:
        """Of the polynomials that are recorded of its steps."""
        if self.is_noisy:
            return 1
        fixed = dict.fromkeys((*STRUCTURED, *MAPPED), 3) | {"dop853": 7, "rk4": 3}
        return fixed.get(self.name, self.order)

    def count_memory(self, rows: int, *, searches: bool = True) -> int:
        """How many numbers a step of so many rows leaves for the next one besides the state.

        Args:
            rows: Those of the state.
            searches: Whether it leaves where it was searched for; of equal members it does not.
        """
        known = {**STRUCTURED, **MAPPED}.get(self.name)
        if not searches:
            return rows if self.is_structured or self.name in MAPPED else 0
        return 0 if known is None or self.is_noisy else known.count_memory(rows)

    @property
    def is_implicit(self) -> bool:
        """Whether the equation of a step is solved for by sweeps, which are counted."""
        return self.is_structured or (self.is_noisy and self.name in STRUCTURED)

    @property
    def is_structured(self) -> bool:
        """Whether its steps are those of a method that keeps structure."""
        return self.name in STRUCTURED and not self.is_noisy

    @property
    def sweeps_alike(self) -> bool:
        """Whether NumPy and C make as many sweeps: single steps of C have as many as most take."""
        if not self.is_structured or self.newton:
            return True
        method = STRUCTURED[self.name]
        return method.file != "gauss" and method.stages > 1

    def __str__(self) -> str:
        return f"{self.name} with Newton's method" if self.newton else self.name
