"""The target Python: one member at a time, of numbers and `math` alone, to be read and pasted.

Read next: ``kernel_python.py.j2``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from coadjoint.lower.program import Program
    from coadjoint.render.targets.body import Body
    from coadjoint.render.targets.python.loader import PythonKernel
    from coadjoint.solve.system import System


class Python:
    """The members of `coadjoint.render.targets.protocol.Target`, for Python without NumPy."""

    builds: Mapping[str, str] = {"python": "no NumPy, one member after the other: slow"}
    exact: tuple[str, ...] = ("python",)
    kernel = "kernel_python.py"
    files: Mapping[str, str] = {"kernel_python.py": "python/kernel_python.py.j2"}
    needs_compiler = False
    is_slow = True
    stops_at_poles = True

    def filters(self) -> Mapping[str, Callable[..., str]]:
        """One filter, for statements."""
        from coadjoint.render.targets.python.printer import plain_assignment

        return {"plain_assignment": plain_assignment}

    def read(self, text: str, program: Program, system: str) -> list[Body]:
        """The one branch of a function."""
        from coadjoint.render.targets.python.reader import read_plain

        return [read_plain(text, program)]

    def load(self, system: System, build: str, reference: Callable[[], Any]) -> PythonKernel:
        """``kernel_python.py`` as a module."""
        from coadjoint.render.targets.python.loader import PythonKernel

        return PythonKernel(system)


TARGET = Python()
