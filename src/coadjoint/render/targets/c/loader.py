"""The target C, loading: libraries of each build, and calls of them.

Comes in: a System, and checked arrays. Goes out: results in place. What is called first is compiled
first, and by itself. A fresh library is compared with the NumPy kernel before it is used.
Read next: `coadjoint.build.library`.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from coadjoint.build.library import Library, find_library, load_library
from coadjoint.build.source import KERNEL, one_function
from coadjoint.errors import CrossCheckError
from coadjoint.render.targets.protocol import Call, Evaluate, Generated, Kernel

if TYPE_CHECKING:
    from coadjoint.render.targets.numpy.loader import NumpyKernel
    from coadjoint.render.targets.protocol import Array, Buffer

#: The flags of each build, by the name that compilers know them under.
FLAGS: Final = {"c": "exact", "c-fast": "fast"}
#: Numbers that one call of a C function reads and writes. At 2 to 20 ns each it ends within a tenth
#: of a second, so that Ctrl-C is heard; some microseconds for each call do not show.
CHUNK = 1 << 22
#: Points at which a fresh library is compared with the NumPy kernel: once so few and odd that the
#: last of them fill no vector register, once so many that results are aligned to such registers.
PROBES = (17, 72)
#: Largest relative difference of a fresh library where bits are not promised: fused operations and
#: other libraries' functions differ by roundings, a wrong kernel by much more.
ROUNDINGS = 1e-9


class CKernel(Kernel):
    """A C kernel of a System: one object for each function that was asked for, or one for all.

    Args:
        system: Whose kernel it is.
        build: ``"c"`` or ``"c-fast"``.
        reference: Loads the NumPy kernel.
    """

    def __init__(self, system: Generated, build: str, reference: Callable[[], NumpyKernel]) -> None:
        self.source = ""
        self._system, self._build, self._reference = system, build, reference
        self._libraries: dict[str, Library] = {}

    def prepare(self, function: str = "") -> None:
        """Compile and load a function alone, unless it is there, or all functions as one object."""
        if function and function in self._libraries:
            return
        system, flags = self._system, FLAGS[self._build]
        given = (system.folder, system.name, system.id, flags)
        kernel, alone = (kind.at(system.levels, flags) for kind in (KERNEL, one_function(function)))
        whole = (
            find_library(*given, kernel)
            if function
            else load_library(*given, self._verify(), kernel)
        )
        if whole is not None:
            self._libraries, self.source = dict.fromkeys(system.functions, whole), whole.source
        else:
            verify = self._verify(function)
            self._libraries[function] = load_library(*given, verify, alone)

    def _verify(self, function: str = "") -> Callable[[Library], None]:
        """What compares a function of a fresh library with NumPy, or all of them."""
        functions = [function] if function else list(self._system.functions)
        return partial(_verify, self._system, self._build, self._reference, functions)

    def find(self, function: str) -> int:
        """The address of a function of its object."""
        return self._libraries[function].find(function)

    def calls(self, function: str, call: Call) -> Iterator[Callable[[], None]]:
        """C calls that together evaluate all members."""
        return _calls(self._libraries[function], function, call)

    def evaluate_with(self, function: str, like: Call) -> Evaluate:
        """One C call, in which no array is looked at but for where it is."""
        bound = self._libraries[function].bind_at(function, like.members, *_places(like, 0))
        place, byref = ctypes.c_double.from_buffer, ctypes.byref

        def evaluate(members: int, state: Array, parameters: Buffer | None, out: Array) -> None:
            given = None if parameters is None else byref(place(parameters))
            bound(members, byref(place(state)), given, byref(place(out)))  # type: ignore[arg-type]

        evaluate.arrays = like  # type: ignore[attr-defined]  # they live as long as the function
        return evaluate


def _calls(library: Library, function: str, call: Call) -> Iterator[Callable[[], Any]]:
    """The calls of a function of a library."""
    arrays = (*call.given.values(), call.block)
    size = max(1, CHUNK // sum(math.prod(array.shape[:-1]) for array in arrays))
    for first in range(0, call.members, size):
        members = min(size, call.members - first)
        piece = library.bind(function, members, *_places(call, first))
        piece.arrays = arrays  # type: ignore[attr-defined]  # they live as long as the call
        yield piece


def _places(call: Call, first: int) -> Iterator[int]:
    """Where each array of a call begins for a member, and its stride: 0 if members share it."""
    for array in call.given.values():
        shared = array.ndim == 1
        yield array.ctypes.data + (0 if shared else first * array.itemsize)
        yield 0 if shared else call.members
    yield call.block.ctypes.data + first * call.block.itemsize
    yield call.members


def load(system: Generated, build: str, reference: Callable[[], NumpyKernel]) -> CKernel:
    """The C kernel of a build, of which nothing is compiled yet."""
    return CKernel(system, build, reference)


def _verify(
    system: Generated,
    build: str,
    reference: Callable[[], NumpyKernel],
    functions: Sequence[str],
    library: Library,
) -> None:
    """Compare functions of a fresh library with the NumPy kernel at a few points.

    The first of them is also computed alone: kernels of many equal members group these otherwise
    than trajectories.

    Raises:
        CrossCheckError: They differ.
        OutputError: The NumPy kernel does not run.
    """
    for function, call in _probes(system.probed, functions):
        expected = reference().values(function, call)
        alone = _take_first(call)
        for piece in (*_calls(library, function, call), *_calls(library, function, alone)):
            piece()
        found = np.concatenate([call.block, alone.block], axis=-1)
        expected = np.concatenate([expected, expected[..., :1]], axis=-1)
        exact = build == "c" and not system.list_called(function)
        if not _agree(found, expected, exact=exact):
            raise CrossCheckError(
                f"a wrong kernel was compiled: {system.name}.{function} of the target "
                f"{build} differs from the NumPy kernel. Set CC to another compiler, or "
                "run `coadjoint crosscheck` to see whether the files are at fault.",
                rung=5,
                system=system.name,
                function=function,
                target=build,
            )


def _probes(system: Generated, functions: Sequence[str]) -> Iterator[tuple[str, Call]]:
    """Points for each function: parameters and inputs of each member, then shared ones."""
    source = np.random.default_rng(0)
    for function in functions:
        shape = system.functions[function]
        sizes = system.sizes(function).items()
        for members in PROBES:
            own = {name: source.uniform(0.5, 2.0, (size, members)) for name, size in sizes}
            for row, factor in system.stretched.items():
                own["parameters"][row] *= factor
            state = own.pop("state")
            for given in (own, {name: array[:, 0].copy() for name, array in own.items()}):
                block, (parameters, *_) = _unaligned((*shape, members)), given.values()
                driving = {name: array for name, array in given.items() if name != "parameters"}
                driving |= system.fixed
                yield function, Call(state, parameters, block, driving)


def _take_first(call: Call) -> Call:
    """The first member of a call."""

    def take(array: NDArray[Any]) -> NDArray[Any]:
        return array[:, :1].copy() if array.ndim > 1 else array

    driving = {name: take(array) for name, array in call.driving.items()}
    block = np.full((*call.block.shape[:-1], 1), np.pi)
    return Call(take(call.state), take(call.parameters), block, driving)


def _unaligned(shape: tuple[int, ...]) -> NDArray[Any]:
    """A result that begins three numbers before a multiple of 64 bytes."""
    size = math.prod(shape)
    room = np.full(size + 8, np.pi)
    first = (5 - room.ctypes.data // room.itemsize) % 8
    return room[first : first + size].reshape(shape)


def _agree(values: NDArray[Any], expected: NDArray[Any], *, exact: bool) -> bool:
    """Whether two results are equal, or equal but for roundings; NaN equals NaN."""
    if exact:
        return np.array_equal(values, expected, equal_nan=True)
    with np.errstate(all="ignore"):
        size = np.abs(expected[np.isfinite(expected)]).max(initial=0.0)
        close = np.abs(values - expected) <= ROUNDINGS * size
        same = (values == expected) | (np.isnan(values) & np.isnan(expected))
    return bool((close | same).all())
