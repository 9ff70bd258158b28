"""The kernels of a System: NumPy, exact C and fast C, loaded when first asked for.

Comes in: checked arrays. Goes out: results in place. Without a compiler the NumPy kernel stands in
for C, which is said once.
"""

from __future__ import annotations

import ctypes
import sys
import warnings
from collections.abc import Callable
from functools import partial
from importlib.util import module_from_spec, spec_from_file_location
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.build.compiler import HOW_TO_GET_ONE
from coadjoint.build.library import Library, load_library
from coadjoint.errors import CompilerError, KernelArgumentError, OutputError

if TYPE_CHECKING:
    from coadjoint.solve.arrays import Call
    from coadjoint.solve.system import System

#: Build of the C library by target.
BUILDS = {"c": "exact", "c-fast": "fast"}
#: Members in one call of a C function: at most some tenths of a second, so that Ctrl-C is heard.
CHUNK = 1 << 20
#: Points at which a fresh library is compared with the NumPy kernel.
PROBES = 17
#: Largest relative difference of a fresh library where bits are not promised: fused operations and
#: other libraries' functions differ by roundings, a wrong kernel by much more.
ROUNDINGS = 1e-9


class CompilerWarning(UserWarning):
    """There is no usable compiler; the NumPy kernels are used instead."""


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
        for first in range(0, call.members, CHUNK):
            self._c_call(function, call, target, first, min(CHUNK, call.members - first))()

    def bind(self, function: str, call: Call, target: str) -> Callable[[], None]:
        """The call as a function without arguments."""
        if self._stand_in(target):
            return partial(self._numpy_function(function), call.state, call.parameters, call.block)
        bound = self._c_call(function, call, target, 0, call.members)
        return bound

    def _c_call(
        self, function: str, call: Call, target: str, first: int, count: int
    ) -> Callable[[], None]:
        """A C call for some of the members, its arguments converted once."""
        item = np.dtype(np.float64).itemsize
        shared = call.parameters.ndim == 1
        arguments = (
            ctypes.c_size_t(count),
            ctypes.c_void_p(call.state.ctypes.data + first * item),
            ctypes.c_size_t(call.members),
            ctypes.c_void_p(call.parameters.ctypes.data + (0 if shared else first * item)),
            ctypes.c_size_t(0 if shared else call.members),
            ctypes.c_void_p(call.block.ctypes.data + first * item),
            ctypes.c_size_t(call.members),
        )
        bound = partial(self._library(target).function(function), *arguments)
        bound.arrays = (call.state, call.parameters, call.block)  # type: ignore[attr-defined]
        return bound

    # -- loading --------------------------------------------------------------------------------------

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
                warnings.warn(
                    f"{error} The NumPy kernels are used instead. {HOW_TO_GET_ONE}",
                    CompilerWarning,
                    stacklevel=6,
                )
                self._loaded[target] = None
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
        if module.ID != self.system.id:
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
        state = source.uniform(0.5, 2.0, (self.system.STATE.size, PROBES))
        parameters = source.uniform(0.5, 2.0, (self.system.PARAMETERS.size, PROBES))
        exact = target == "c" and not self.system.elementary
        for function, shape in self.system.functions.items():
            expected = self._numpy_function(function)(state, parameters)
            found = np.full((*shape, PROBES), np.nan)
            addresses = (state.ctypes.data, PROBES, parameters.ctypes.data, PROBES)
            library.function(function)(PROBES, *addresses, found.ctypes.data, PROBES)
            size = np.abs(expected).max(initial=0.0)
            with np.errstate(all="ignore"):
                close = np.abs(found - expected) <= ROUNDINGS * size
            if not (np.array_equal(found, expected, equal_nan=True) if exact else close.all()):
                raise CompilerError(
                    f"the compiler made a wrong kernel: {self.system.name}.{function} differs from "
                    "the NumPy kernel. Set CC to another compiler.",
                    found=function,
                )
