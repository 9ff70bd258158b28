"""Targets, the protocol: what every language that kernels are written in can do.

Comes in: the name of a target's package. Goes out: a `Target`, which renders, reads back and loads
by the modules ``printer``, ``reader`` and ``loader`` of that package. These load on first use.
Read next: `coadjoint.render.targets.c`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from coadjoint.lower.program import Program
    from coadjoint.render.targets.body import Body
    from coadjoint.solve.arrays import Call
    from coadjoint.solve.system import System


class Kernel(Protocol):
    """A kernel that is loaded.

    Attributes:
        source: SHA-256 of the text that it was made from.
    """

    source: str

    def calls(self, function: str, call: Call) -> Iterator[Callable[[], Any]]:
        """What evaluates all members, called one after the other."""
        ...


@dataclass(frozen=True)
class Target:
    """A language; its package holds templates, printer, reader, loader and reserved words.

    Attributes:
        package: The package, ``__name__`` of its ``__init__.py``.
        builds: What a person may give as ``target=``, with what is to be known of it, or "".
        exact: The builds that have the same bits as those of other targets, as long as nothing
            beyond sqrt is called.
        kernel: The file that is read back and loaded.
        files: All files that are rendered, each with its template.
        needs_compiler: Whether a compiler makes the kernel.
        is_slow: Whether a call takes microseconds for each member, so that fewer are compared.
        stops_at_poles: Whether the language has no quotient by zero and no root of a negative
            number; a System has NaN in every row of such a member.
    """

    package: str
    builds: Mapping[str, str]
    exact: tuple[str, ...]
    kernel: str
    files: Mapping[str, str]
    needs_compiler: bool = False
    is_slow: bool = False
    stops_at_poles: bool = False

    @property
    def filters(self) -> Mapping[str, Callable[..., str]]:
        """The filters of the templates, ``FILTERS`` of its printer."""
        found: Mapping[str, Callable[..., str]] = self._module("printer").FILTERS
        return found

    def read(self, text: str, program: Program, system: str) -> list[Body]:
        """What each branch of the function of a Program does, by ``read`` of its reader.

        Args:
            text: Of the kernel.
            program: The function.
            system: Name of the system.

        Raises:
            CrossCheckError: It is of no form that the template prints.
        """
        found: list[Body] = self._module("reader").read(text, program, system)
        return found

    def load(self, system: System, build: str, reference: Callable[[], Any]) -> Kernel:
        """The kernel of a System, by ``load`` of its loader.

        Args:
            system: Whose kernel it is.
            build: One of ``builds``.
            reference: Loads the NumPy kernel, with which what a compiler made is compared.

        Raises:
            CompilerError: It cannot be compiled.
            CrossCheckError: What was compiled differs from the NumPy kernel.
            OutputError: The file cannot be loaded.
        """
        found: Kernel = self._module("loader").load(system, build, reference)
        return found

    def _module(self, name: str) -> Any:
        """A module of its package."""
        return import_module(f"{self.package}.{name}")
