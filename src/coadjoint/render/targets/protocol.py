"""Targets, the protocol: what every language that kernels are written in can do.

Comes in: nothing. Goes out: the two protocols that rendering, cross-checks and Systems speak to.
Read next: `coadjoint.render.targets.c`, the target with the most to say.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
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


class Target(Protocol):
    """A language; its folder holds templates, printer, reader, loader and reserved words.

    Attributes:
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

    builds: Mapping[str, str]
    exact: tuple[str, ...]
    kernel: str
    files: Mapping[str, str]
    needs_compiler: bool
    is_slow: bool
    stops_at_poles: bool

    def filters(self) -> Mapping[str, Callable[..., str]]:
        """The filters of the templates, by a name of which the target is a part."""
        ...

    def read(self, text: str, program: Program, system: str) -> list[Body]:
        """What each branch of the function of a Program does, from the text of the kernel.

        Raises:
            CrossCheckError: It is of no form that the template prints.
        """
        ...

    def load(self, system: System, build: str, reference: Callable[[], Any]) -> Kernel:
        """The kernel of a System.

        Args:
            system: Whose kernel it is.
            build: One of ``builds``.
            reference: Loads the NumPy kernel, with which what a compiler made is compared.

        Raises:
            CompilerError: It cannot be compiled.
            CrossCheckError: What was compiled differs from the NumPy kernel.
            OutputError: The file cannot be loaded.
        """
        ...
