"""Targets, the protocol: what every language that kernels are written in can do.

Comes in: the name of a target's package. Goes out: a `Target`, which renders, reads back and loads
by the modules ``printer``, ``reader`` and ``loader`` of that package. These load on first use.
Read next: `coadjoint.render.targets.c`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from array import array

    from numpy.typing import NDArray

    from coadjoint.lower.program import Program
    from coadjoint.render.targets.body import Body

    Array = NDArray[Any]
    Buffer = array[float]


class Generated(Protocol):
    """What a loader reads of a System."""

    name: str
    folder: Path
    id: str
    functions: Mapping[str, tuple[int, ...]]
    levels: Mapping[tuple[str, str], int]

    @property
    def fixed(self) -> Mapping[str, NDArray[Any]]:
        """Arrays that every function takes beyond these, by name."""
        ...

    @property
    def probed(self) -> Generated:
        """What fresh objects are compared with; of few members where texts are those of any."""
        ...

    @property
    def stretched(self) -> Mapping[int, float]:
        """By the rows of parameters, what they are multiplied by where fresh objects are probed."""
        ...

    def list_called(self, function: str) -> Sequence[str]:
        """What a function calls beyond ``+ - * / sqrt``, or what others do."""
        ...

    def sizes(self, function: str) -> Mapping[str, int]:
        """How many rows each array has that a function takes."""
        ...


@dataclass(frozen=True)
class Call:
    """One evaluation of a function, its arrays checked: float64, C-contiguous, component first.

    Attributes:
        state: ``(n, members)``.
        parameters: ``(k,)`` shared or ``(k, members)``.
        block: Where the result goes: its shape for one member followed by ``members``.
        driving: Inputs and time by name, in the form of parameters, as far as the system has them.
    """

    state: Array
    parameters: Array
    block: Array
    driving: Mapping[str, Array] = field(default_factory=dict)

    @property
    def members(self) -> int:
        """Number of members."""
        return int(self.state.shape[1])

    @property
    def given(self) -> dict[str, Array]:
        """What is read, by name, in the order in which kernels take it."""
        return {"state": self.state, "parameters": self.parameters, **self.driving}


#: Members of one call that is not taken apart into pieces.
FEW = 1024
#: Evaluates some members at a state, with packed parameters or None for known ones, into a result.
Evaluate = Callable[[int, "Array", "Buffer | None", "Array"], None]


class Kernel:
    """A kernel that is loaded.

    Attributes:
        source: SHA-256 of the text that it was made from.
    """

    source: str

    def prepare(self, function: str = "") -> None:
        """Make ready what is called next: a function, or all of them.

        Raises:
            CompilerError: It cannot be compiled.
            CrossCheckError: What was compiled differs from the NumPy kernel.
        """

    def find(self, function: str) -> int:
        """The address of a function that is ready to be called from C."""
        raise NotImplementedError

    def calls(self, function: str, call: Call) -> Iterator[Callable[[], Any]]:
        """What evaluates all members, called one after the other."""
        raise NotImplementedError

    def evaluate_with(self, function: str, like: Call) -> Evaluate:
        """A function evaluated with the inputs of a call, which members share, and its parameters.

        It takes the number of members, their state, other parameters or None, and the result:
        writable, C-contiguous arrays of float64 that are not empty, at most `FEW` members.
        """
        from numpy import frombuffer

        driving, shape = like.driving, like.block.shape[:-1]

        def evaluate(members: int, state: Array, parameters: Buffer | None, out: Array) -> None:
            given = like.parameters if parameters is None else frombuffer(parameters)
            call = Call(state.reshape(-1, members), given, out.reshape(*shape, members), driving)
            for piece in self.calls(function, call):
                piece()

        return evaluate


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
        filters: Mapping[str, Callable[..., str]] = self._module("printer").FILTERS
        return filters

    def read(self, text: str, program: Program, system: str) -> list[Body]:
        """What each branch of the function of a Program does, by ``read`` of its reader.

        Args:
            text: Of the kernel.
            program: The function.
            system: Name of the system.

        Raises:
            CrossCheckError: It is of no form that the template prints.
        """
        bodies: list[Body] = self._module("reader").read(text, program, system)
        return bodies

    def load(self, system: Generated, build: str, reference: Callable[[], Any]) -> Kernel:
        """The kernel of a System, by ``load`` of its loader; it compiles nothing yet.

        Args:
            system: Whose kernel it is.
            build: One of ``builds``.
            reference: Loads the NumPy kernel, with which what a compiler made is compared.

        Raises:
            OutputError: The file cannot be loaded.
        """
        kernel: Kernel = self._module("loader").load(system, build, reference)
        return kernel

    def _module(self, name: str) -> Any:
        """A module of its package."""
        return import_module(f"{self.package}.{name}")
