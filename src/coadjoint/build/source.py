"""Sources: what an object is compiled from, and how much it is optimised.

Comes in: the name of a C file, and what is compiled of it. Goes out: a `Source`.
Read next: `coadjoint.build.compiler`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Source:
    """What an object is compiled from.

    Attributes:
        stem: Name of the C file and of its header without their endings.
        defines: Options that choose what is compiled of it, such as ``-DRK4``.
        is_loops: Whether it is long straight loops over members, which need fewer passes of GCC.
        level: How much is optimised, where the environment asks for no less: 3 for what users run;
            for what is run for some steps alone 0, or 1, from where on products and sums are fused.
    """

    stem: str = "kernel"
    defines: tuple[str, ...] = ()
    is_loops: bool = True
    level: int = 3

    @property
    def files(self) -> tuple[str, str]:
        """Its files: the one that is compiled, and the header that this reads."""
        return f"{self.stem}.c", f"{self.stem}.h"

    def at(self, levels: Mapping[tuple[str, str], int], build: str) -> Source:
        """The same, optimised less where levels by stem and build say so."""
        return replace(self, level=levels.get((self.stem, build), self.level))

    def label(self, name: str) -> str:
        """The symbol of the id that its object carries, for the name of a system."""
        return f"{name}_id" if self.stem == KERNEL.stem else f"{name}_{self.stem}_id"


KERNEL = Source()


def one_function(name: str) -> Source:
    """One function of a kernel, which is compiled sooner than all of them."""
    return Source(defines=("-DCOADJOINT_ONLY", f"-DCOADJOINT_ONLY_{name.upper()}"))
