"""The kernels of a System: NumPy, exact C and fast C, loaded when first asked for.

Comes in: checked arrays. Goes out: results in place. Without a compiler the NumPy kernel stands in
for C where a user calls it, which is said once. The cross-check loads kernels by `Kernels.load`,
where nothing stands in for anything.
"""

from __future__ import annotations

import hashlib
import math
import warnings
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.build.compiler import HOW_TO_GET_ONE, CompilerWarning, compilers
from coadjoint.build.library import Library, load_library
from coadjoint.errors import CompilerError, CrossCheckError, KernelArgumentError, OutputError

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
            self._numpy_call(function, call)()
            return
        for piece in self._pieces(function, call, target):
            piece()

    def bind(self, function: str, call: Call, target: str) -> Callable[[], None]:
        """The call as a function without arguments."""
        if self._stand_in(target):
            return self._numpy_call(function, call)
        pieces = list(self._pieces(function, call, target))
        return pieces[0] if len(pieces) == 1 else partial(_each, pieces)

    def _numpy_call(self, function: str, call: Call) -> Callable[[], Any]:
        """The call of a function of the NumPy kernel."""
        given = [call.state, call.parameters]
        given += [array for name, array in call.driving.items() if name != "time"]
        named = {"time": call.driving["time"][0, ...]} if "time" in call.driving else {}
        return partial(self._numpy_function(function), *given, out=call.block, **named)

    def _pieces(self, function: str, call: Call, target: str) -> Iterator[Callable[[], None]]:
        """C calls that together evaluate all members."""
        library: Library = self._library(target)
        item = call.state.itemsize
        arrays = (call.state, call.parameters, *call.driving.values(), call.block)
        places = [(array.ctypes.data, array.ndim == 1) for array in arrays[:-1]]
        places.append((call.block.ctypes.data, False))  # that of a scalar has one axis, too
        size = max(1, CHUNK // sum(math.prod(array.shape[:-1]) for array in arrays))
        stride = call.members
        for first in range(0, call.members, size):
            piece = library.bind(
                function,
                min(size, call.members - first),
                *(
                    number
                    for at, shared in places
                    for number in ((at, 0) if shared else (at + first * item, stride))
                ),
            )
            piece.arrays = arrays  # type: ignore[attr-defined]  # they live as long as the call
            yield piece

    # -- loading ----------------------------------------------------------------------------------

    def prepare(self, targets: Sequence[str]) -> None:
        """Compile and load what targets need, side by side: compilers are programs of their own."""
        self._numpy_module()
        with compilers() as pool:
            for done in [pool.submit(self._stand_in, target) for target in targets]:
                done.result()

    def load(self, targets: Sequence[str]) -> dict[str, str]:
        """Load the kernels of targets themselves: what is missing or wrong is an error.

        Returns:
            SHA-256 of the text that each was made from: ``kernel.py`` or ``kernel.c``.

        Raises:
            CompilerError: A kernel cannot be compiled.
            CrossCheckError: A compiled kernel differs from the NumPy kernel.
            OutputError: ``kernel.py`` cannot be loaded.
        """
        for target in targets:
            _check_target(target)
        numpy = self._numpy_module().SOURCE
        with compilers() as pool:
            libraries = [t for t in targets if t != "numpy"]
            loading = {target: pool.submit(self._load, target) for target in libraries}
            found = {target: done.result() for target, done in loading.items()}
        self._loaded |= found
        sources = {target: library.source for target, library in found.items()}
        return {target: sources.get(target, numpy) for target in targets}

    def _stand_in(self, target: str) -> bool:
        """Whether the NumPy kernel answers for a target.

        Raises:
            KernelArgumentError: No such target.
        """
        _check_target(target)
        return target == "numpy" or self._library(target) is None

    def _library(self, target: str) -> Any:
        """The C library of a target, or None, said once, where it cannot be had."""
        if target not in self._loaded:
            try:
                self._loaded[target] = self._load(target)
            except (CompilerError, CrossCheckError) as error:
                self._loaded[target] = None
                if str(error) not in _said:
                    _said.add(str(error))
                    advice = HOW_TO_GET_ONE if isinstance(error, CompilerError) else ""
                    warnings.warn(
                        f"{error} The NumPy kernels are used instead. {advice}".rstrip(),
                        CompilerWarning,
                        stacklevel=7,
                    )
        return self._loaded[target]

    def _load(self, target: str) -> Library:
        """The C library of a target, verified."""
        system, verify = self.system, partial(self._verify, target)
        return load_library(system.folder, system.name, system.id, BUILDS[target], verify)

    def _numpy_function(self, function: str) -> Callable[..., Any]:
        """A function of the NumPy kernel.

        Raises:
            OutputError: The kernel cannot be loaded, lacks the function, or carries another id
                than the System.
        """
        found: Callable[..., Any] | None = getattr(self._numpy_module(), function, None)
        if found is None:
            raise self._broken(f"has no function {function}")
        return found

    def _numpy_module(self) -> ModuleType:
        """``kernel.py``, executed once, with the hash of its text as ``SOURCE``."""
        if "numpy" not in self._loaded:
            path = self.system.folder / "kernel.py"
            module = ModuleType(f"_coadjoint_{self.system.name}_kernel")
            try:
                content = path.read_bytes()
                exec(compile(content, path, "exec"), module.__dict__)  # noqa: S102 (it is a module)
                found = module.ID
            except Exception as error:
                problem = f"cannot be loaded: {type(error).__name__}: {error}"
                raise self._broken(problem) from error
            if found != self.system.id:
                raise self._broken(
                    f"carries the id {found!r}, its system {self.system.id!r}; expected one id",
                    found=found,
                    expected=self.system.id,
                )
            module.SOURCE = hashlib.sha256(content).hexdigest()  # type: ignore[attr-defined]
            self._loaded["numpy"] = module
        loaded: ModuleType = self._loaded["numpy"]
        return loaded

    def _broken(self, problem: str, **parts: Any) -> OutputError:
        """What is wrong with ``kernel.py``."""
        path = str(self.system.folder / "kernel.py")
        return OutputError(f"{path} {problem}. Run `coadjoint regenerate`.", path=path, **parts)

    def _verify(self, target: str, library: Library) -> None:
        """Compare a fresh library with the NumPy kernel at a few points.

        Raises:
            CrossCheckError: They differ.
            OutputError: The NumPy kernel does not run.
        """
        source = np.random.default_rng(0)
        rows, sizes = self.system.rows, [self.system.PARAMETERS.size]
        sizes += [each.size for each in (self.system.INPUTS, self.system.TIME) if each]
        most = self.system.STATE.size + self.system.RECONSTRUCTED.size
        wide = source.uniform(0.5, 2.0, (most, PROBES))
        own = [source.uniform(0.5, 2.0, (size, PROBES)) for size in sizes]
        shared = [array[:, 0].copy() for array in own]
        exact = target == "c" and not self.system.elementary
        for function, shape in self.system.functions.items():
            state = wide[: rows(function).size]
            for others, stride in ((own, PROBES), (shared, 0)):
                expected = self._numpy_values(function, [state, *others], (*shape, PROBES))
                found = np.full((*shape, PROBES), np.pi)
                addresses = [state.ctypes.data, PROBES]
                addresses += [n for array in others for n in (array.ctypes.data, stride)]
                library.function(function)(PROBES, *addresses, found.ctypes.data, PROBES)
                if not _agree(found, expected, exact=exact):
                    raise CrossCheckError(
                        f"a wrong kernel was compiled: {self.system.name}.{function} of the target "
                        f"{target} differs from the NumPy kernel. Set CC to another compiler, or "
                        "run `coadjoint crosscheck` to see whether the files are at fault.",
                        rung=5,
                        system=self.system.name,
                        function=function,
                        target=target,
                    )

    def _numpy_values(
        self, function: str, arrays: Sequence[NDArray[Any]], shape: tuple[int, ...]
    ) -> NDArray[Any]:
        """What the NumPy kernel computes.

        Raises:
            OutputError: It does not run, or its result has another shape.
        """
        try:
            given, named = list(arrays), {}
            if self.system.TIME:
                named = {"time": given.pop()[0]}
            values = np.asarray(self._numpy_function(function)(*given, **named), dtype=np.float64)
        except OutputError:
            raise
        except Exception as error:
            problem = f"does not run: {function}: {type(error).__name__}: {error}"
            raise self._broken(problem) from error
        if values.shape != shape:
            raise self._broken(f"does not run: {function} has the shape {values.shape}")
        return values


def _check_target(target: str) -> None:
    """Refuse what is no target.

    Raises:
        KernelArgumentError: No such target.
    """
    if target not in ("numpy", *BUILDS):
        raise KernelArgumentError(
            f"target is {target!r}; expected 'c', 'numpy' or 'c-fast'.",
            found=target,
            expected=["c", "numpy", "c-fast"],
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
