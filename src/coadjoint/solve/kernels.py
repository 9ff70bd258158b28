"""The kernels of a System: NumPy, exact C and fast C, loaded when first asked for.

Comes in: checked arrays. Goes out: results in place. Without a compiler the NumPy kernel stands in
for C, which is said once.
"""

from __future__ import annotations

import math
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from importlib.util import module_from_spec, spec_from_file_location
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.build.compiler import HOW_TO_GET_ONE, CompilerWarning
from coadjoint.build.library import Library, load_library
from coadjoint.errors import CompilerError, KernelArgumentError, OutputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.arrays import Call
    from coadjoint.solve.system import System

#: Build of the C library by target.
BUILDS = {"c": "exact", "c-fast": "fast"}
#: Numbers that one call of a C function reads and writes. At 2 to 20 ns each it ends within a tenth
#: of a second, so that Ctrl-C is heard; some microseconds for each call do not show.
CHUNK = 1 << 22
#: Points at which a fresh library is compared with the NumPy kernel: odd, so that the last of them
#: fill no vector register.
PROBES = 17
#: Largest relative difference of a fresh library where bits are not promised: fused operations and
#: other libraries' functions differ by roundings, a wrong kernel by much more.
ROUNDINGS = 1e-9


#: What was said about missing kernels: each message comes once in a process, whatever the system.
_said: set[str] = set()


class Kernels:
    """The kernels of one System."""

    def __init__(self, system: System) -> None:
        self.system = system
        self._loaded: dict[str, Any] = {}

    def run(self, function: str, call: Call, target: str) -> None:
        """Evaluate a call into its result."""
        if self._stand_in(target):
            self._numpy_function(function)(call.state, call.parameters, call.block)
            return
        for piece in self._pieces(function, call, target):
            piece()

    def bind(self, function: str, call: Call, target: str) -> Callable[[], None]:
        """The call as a function without arguments."""
        if self._stand_in(target):
            return partial(self._numpy_function(function), call.state, call.parameters, call.block)
        pieces = list(self._pieces(function, call, target))
        return pieces[0] if len(pieces) == 1 else partial(_each, pieces)

    def _pieces(self, function: str, call: Call, target: str) -> Iterator[Callable[[], None]]:
        """C calls that together evaluate all members."""
        library: Library = self._library(target)
        item = call.state.itemsize
        shared = call.parameters.ndim == 1
        arrays = (call.state, call.parameters, call.block)
        state, parameters, block = (array.ctypes.data for array in arrays)
        size = max(1, CHUNK // sum(math.prod(array.shape[:-1]) for array in arrays))
        stride = call.members
        for first in range(0, call.members, size):
            piece = library.bind(
                function,
                min(size, call.members - first),
                state + first * item,
                stride,
                parameters if shared else parameters + first * item,
                0 if shared else stride,
                block + first * item,
                stride,
            )
            piece.arrays = arrays  # type: ignore[attr-defined]  # they live as long as the call
            yield piece

    # -- loading ----------------------------------------------------------------------------------

    def prepare(self, targets: Sequence[str]) -> None:
        """Compile and load what targets need, side by side: compilers are programs of their own."""
        if "numpy" not in self._loaded:
            self._loaded["numpy"] = self._numpy_module()
        with ThreadPoolExecutor() as pool:
            for done in [pool.submit(self._stand_in, target) for target in targets]:
                done.result()

    def _stand_in(self, target: str) -> bool:
        """Whether the NumPy kernel answers for a target.

        Raises:
            KernelArgumentError: No such target.
        """
        if target == "numpy":
            return True
        if target not in BUILDS:
            raise KernelArgumentError(
                f"target is {target!r}; expected 'c', 'numpy' or 'c-fast'.",
                found=target,
                expected=["c", "numpy", "c-fast"],
            )
        return self._library(target) is None

    def _library(self, target: str) -> Any:
        """The C library of a target, or None, said once, where it cannot be had."""
        if target not in self._loaded:
            system = self.system
            verify = partial(self._verify, target)
            try:
                self._loaded[target] = load_library(
                    system.folder, system.name, system.id, BUILDS[target], verify
                )
            except CompilerError as error:
                self._loaded[target] = None
                if str(error) not in _said:
                    _said.add(str(error))
                    warnings.warn(
                        f"{error} The NumPy kernels are used instead. {HOW_TO_GET_ONE}",
                        CompilerWarning,
                        stacklevel=6,
                    )
        return self._loaded[target]

    def _numpy_function(self, function: str) -> Callable[..., Any]:
        """A function of the NumPy kernel.

        Raises:
            OutputError: The kernel carries another id than the System.
        """
        if "numpy" not in self._loaded:
            self._loaded["numpy"] = self._numpy_module()
        found: Callable[..., Any] = getattr(self._loaded["numpy"], function)
        return found

    def _numpy_module(self) -> Any:
        path = self.system.folder / "kernel.py"
        spec = spec_from_file_location(f"_coadjoint_{self.system.name}_kernel", path)
        assert spec is not None
        assert spec.loader is not None
        module = module_from_spec(spec)
        before, sys.dont_write_bytecode = sys.dont_write_bytecode, True
        try:
            spec.loader.exec_module(module)
        finally:
            sys.dont_write_bytecode = before
        if module.ID != self.system.id:  # noqa: SIM300 (not a constant: the id of another file)
            raise OutputError(
                f"{path} carries the id {module.ID!r}, its system {self.system.id!r}; expected one "
                "id. Run `coadjoint regenerate`.",
                path=str(path),
                found=module.ID,
                expected=self.system.id,
            )
        return module

    def _verify(self, target: str, library: Library) -> None:
        """Compare a fresh library with the NumPy kernel at a few points.

        Raises:
            CompilerError: They differ.
        """
        source = np.random.default_rng(0)
        inputs = self.system.inputs
        wide = source.uniform(0.5, 2.0, (inputs("reconstruction").size, PROBES))
        own = source.uniform(0.5, 2.0, (self.system.PARAMETERS.size, PROBES))
        exact = target == "c" and not self.system.elementary
        for function, shape in self.system.functions.items():
            state = wide[: inputs(function).size]
            for parameters, stride in ((own, PROBES), (own[:, 0].copy(), 0)):
                expected = self._numpy_function(function)(state, parameters)
                found = np.full((*shape, PROBES), np.pi)
                addresses = (state.ctypes.data, PROBES, parameters.ctypes.data, stride)
                library.function(function)(PROBES, *addresses, found.ctypes.data, PROBES)
                if not _agree(found, expected, exact=exact):
                    raise CompilerError(
                        f"the compiler made a wrong kernel: {self.system.name}.{function} differs "
                        "from the NumPy kernel. Set CC to another compiler.",
                        found=function,
                    )


def _each(pieces: list[Callable[[], None]]) -> None:
    """One call after the other; signals are heard between them."""
    for piece in pieces:
        piece()


def _agree(found: NDArray[Any], expected: NDArray[Any], *, exact: bool) -> bool:
    """Whether two results are equal, or equal but for roundings; NaN equals NaN."""
    if exact:
        return np.array_equal(found, expected, equal_nan=True)
    with np.errstate(all="ignore"):
        size = np.abs(expected[np.isfinite(expected)]).max(initial=0.0)
        close = np.abs(found - expected) <= ROUNDINGS * size
        same = (found == expected) | (np.isnan(found) & np.isnan(expected))
    return bool((close | same).all())
