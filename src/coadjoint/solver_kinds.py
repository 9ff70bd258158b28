"""Kinds of solvers: those of the state, and those of the state with what is reconstructed below it.

Comes in: nothing. Goes out: the names of their files and functions, which render, crosscheck and
solve share.
Read next: `coadjoint.render.solvers`.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class SolverKind:
    """One kind of solvers.

    Attributes:
        stem: The name of its files without their endings.
        rates: The functions of the kernel whose rows, one below the other, are its rates. The first
            argument of the last one is what it integrates.
    """

    stem: str
    rates: tuple[str, ...]

    @property
    def files(self) -> tuple[str, str, str]:
        """Its files: C, its header, and the twin in NumPy."""
        return f"{self.stem}.c", f"{self.stem}.h", f"{self.stem}.py"

    @property
    def advance(self) -> str:
        """Its function in C, without the name of the system."""
        return "advance" if self == SOLVER else f"{self.stem}_advance"

    def prefix(self, system: str) -> str:
        """What its names in C begin with.

        >>> SOLVER.prefix("disk"), RECONSTRUCTION.prefix("disk")
        ('disk', 'disk_reconstruction')
        """
        return system if self == SOLVER else f"{system}_{self.stem}"


#: Of the state alone.
SOLVER: Final = SolverKind("solver", ("rhs",))
#: Of the state with what is reconstructed.
RECONSTRUCTION: Final = SolverKind("reconstruction", ("rhs", "reconstruction"))
KINDS: Final = (SOLVER, RECONSTRUCTION)
#: The files of all kinds.
FILES: Final = tuple(file for kind in KINDS for file in kind.files)


def list_kinds(functions: Collection[str]) -> tuple[SolverKind, ...]:
    """The kinds of solvers that a system has.

    Args:
        functions: The names of its functions.
    """
    return tuple(kind for kind in KINDS if set(kind.rates) <= set(functions))
