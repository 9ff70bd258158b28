"""The target NumPy: formulas over arrays of members.

Read next: ``kernel.py.j2``, and its twin in `coadjoint.render.targets.c`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from coadjoint.lower.program import Program
    from coadjoint.render.targets.body import Body
    from coadjoint.render.targets.numpy.loader import NumpyKernel
    from coadjoint.solve.system import System


class Numpy:
    """The members of `coadjoint.render.targets.protocol.Target`, for NumPy."""

    builds: Mapping[str, str] = {"numpy": ""}
    exact: tuple[str, ...] = ("numpy",)
    kernel = "kernel.py"
    files: Mapping[str, str] = {"kernel.py": "numpy/kernel.py.j2"}
    needs_compiler = False
    is_slow = False
    stops_at_poles = False

    def filters(self) -> Mapping[str, Callable[..., str]]:
        """One filter, for statements."""
        from coadjoint.render.targets.numpy.printer import numpy_assignment

        return {"numpy_assignment": numpy_assignment}

    def read(self, text: str, program: Program, system: str) -> list[Body]:
        """The one branch of a function."""
        from coadjoint.render.targets.numpy.reader import read_numpy

        return [read_numpy(text, program.name, tuple(program.arrays))]

    def load(self, system: System, build: str, reference: Callable[[], Any]) -> NumpyKernel:
        """``kernel.py`` as a module."""
        from coadjoint.render.targets.numpy.loader import NumpyKernel

        return NumpyKernel(system)


TARGET = Numpy()
