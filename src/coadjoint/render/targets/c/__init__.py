"""The target C: loops over members that a compiler turns into vector code, in two builds.

Read next: ``kernel.c.j2``, and its twin in `coadjoint.render.targets.numpy`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from coadjoint.lower.program import Program
    from coadjoint.render.targets.body import Body
    from coadjoint.render.targets.c.loader import CKernel
    from coadjoint.solve.system import System


class C:
    """The members of `coadjoint.render.targets.protocol.Target`, for C."""

    builds: Mapping[str, str] = {"c": "", "c-fast": "fused operations: not the same bits"}
    exact: tuple[str, ...] = ("c",)
    kernel = "kernel.c"
    files: Mapping[str, str] = {"kernel.c": "c/kernel.c.j2", "kernel.h": "c/kernel.h.j2"}
    needs_compiler = True
    is_slow = False
    stops_at_poles = False

    def filters(self) -> Mapping[str, Callable[..., str]]:
        """One filter, for statements."""
        from coadjoint.render.targets.c.printer import c_assignment

        return {"c_assignment": c_assignment}

    def read(self, text: str, program: Program, system: str) -> list[Body]:
        """The branches for shared and for separate parameters, or the one without any."""
        from coadjoint.render.targets.c.reader import read_c

        return read_c(text, f"{system}_{program.name}")

    def load(self, system: System, build: str, reference: Callable[[], Any]) -> CKernel:
        """The library of a build, from the cache or compiled and compared."""
        from coadjoint.render.targets.c.loader import load_kernel

        return load_kernel(system, build, reference)


TARGET = C()
