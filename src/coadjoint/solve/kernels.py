"""The kernels of a System, one for each target, loaded when first asked for.

Comes in: checked arrays. Goes out: results in place. Without a compiler the NumPy kernel stands in
for C where a user calls it, which is said once. The cross-check loads kernels by `Kernels.load`,
where nothing stands in for anything.
Read next: `coadjoint.render.targets`, which load them.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.build.compiler import HOW_TO_GET_ONE, CompilerWarning
from coadjoint.build.processes import compilers
from coadjoint.errors import CompilerError, CrossCheckError, KernelArgumentError
from coadjoint.render.targets import BUILDS
from coadjoint.solve.ready import make_ready

if TYPE_CHECKING:
    from coadjoint.render.targets.protocol import Call, Kernel
    from coadjoint.solve.system import System

#: What was said about missing kernels: each message comes once in a process, whatever the system.
_said: set[str] = set()


class Kernels:
    """The kernels of one System."""

    def __init__(self, system: System) -> None:
        self.system = system
        self._loaded: dict[str, Kernel] = {}
        #: Who computes a function for a target; NumPy, where a compiler failed.
        self._chosen: dict[tuple[str, str], Kernel] = {}
        #: The short way to functions, by name and target; of those that were called before.
        self.ready: dict[tuple[str, str], Callable[..., Any]] = {}

    def run(self, function: str, call: Call, target: str) -> None:
        """Evaluate a call into its result."""
        for piece in self._kernel(function, target).calls(function, call):
            piece()

    def make_ready(self, function: str, call: Call, target: str) -> None:
        """Keep the short way to a function, with the inputs of a call that has the defaults."""
        if (function, target) in self.ready or "time" in call.driving:
            return
        quantities, rows = self.system.PARAMETERS, self.system.rows(function).size
        parameters = np.array([quantities.defaults.get(c, np.nan) for c in quantities.components])
        shape = self.system.functions[function]
        like = replace(
            call, state=np.empty((rows, 1)), parameters=parameters, block=np.empty((*shape, 1))
        )
        evaluate = self._kernel(function, target).evaluate_with(function, like)
        self.ready[function, target] = make_ready(shape, rows, quantities, evaluate)

    def bind(self, function: str, call: Call, target: str) -> Callable[[], None]:
        """The call as a function without arguments."""
        pieces = list(self._kernel(function, target).calls(function, call))
        return pieces[0] if len(pieces) == 1 else partial(_call_each, pieces)

    # -- loading ----------------------------------------------------------------------------------

    def prepare(self, targets: Sequence[str]) -> None:
        """Compile and load what targets need, side by side: compilers are programs of their own."""
        for target in targets:
            check_target(target)
        self._numpy()
        with compilers() as pool:
            for done in [pool.submit(self._choose, target) for target in targets]:
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
            check_target(target)
        self._numpy()
        with compilers() as pool:
            loading = {target: pool.submit(self._prepare, target) for target in targets}
            kernels = {target: done.result() for target, done in loading.items()}
        for target, kernel in kernels.items():
            self._chosen |= {(function, target): kernel for function in self.system.functions}
        self.ready.clear()
        return {target: kernel.source for target, kernel in kernels.items()}

    def _kernel(self, function: str, target: str) -> Kernel:
        """Who computes a function for a target.

        Raises:
            KernelArgumentError: No such target.
        """
        if (function, target) not in self._chosen:
            check_target(target)
            self._choose(target, function)
        return self._chosen[function, target]

    def _choose(self, target: str, function: str = "") -> None:
        """Choose who computes a function, or all: NumPy, which is said, where a compiler fails."""
        try:
            kernel = self._prepare(target, function)
        except (CompilerError, CrossCheckError) as error:
            kernel = self._numpy()
            advice = HOW_TO_GET_ONE if isinstance(error, CompilerError) else ""
            say_once(f"{error} The NumPy kernels are used instead. {advice}".rstrip(), depth=7)
        for name in [function] if function else self.system.functions:
            self._chosen[name, target] = kernel

    def _prepare(self, target: str, function: str = "") -> Kernel:
        """The kernel of a target itself, with a function ready to be called, or all of them."""
        if target not in self._loaded:
            self._loaded[target] = self._load(target)
        self._loaded[target].prepare(function)
        return self._loaded[target]

    def find_kernel(self, target: str) -> Kernel:
        """The kernel of a target itself, with all functions ready to be called.

        Raises:
            CompilerError: It cannot be compiled.
            CrossCheckError: It differs from the NumPy kernel.
        """
        return self._prepare(target)

    def find(self, target: str, function: str) -> int:
        """Where a function of a kernel in C stands, which is compiled if need be.

        Raises:
            CompilerError: It cannot be compiled.
            CrossCheckError: It differs from the NumPy kernel.
        """
        return self._prepare(target, function).find(function)

    def _load(self, target: str) -> Kernel:
        """The kernel of a target itself."""
        return BUILDS[target].load(self.system, target, self._numpy)

    def _numpy(self) -> Kernel:
        """The NumPy kernel."""
        if "numpy" not in self._loaded:
            self._loaded["numpy"] = self._load("numpy")
        return self._loaded["numpy"]


def say_once(
    message: str, *, depth: int = 2, category: type[UserWarning] = CompilerWarning
) -> None:
    """Warn that something is not what it could be, unless this process was told so.

    Args:
        message: The warning.
        depth: The frame that is warned, as `warnings.warn` counts.
        category: Its class.
    """
    if message not in _said:
        warnings.warn(message, category, stacklevel=depth)
        _said.add(message)  # not where a filter makes an error of it: the next run is one, too


def check_target(target: str) -> None:
    """Refuse what is not a target.

    Raises:
        KernelArgumentError: No such target.
    """
    if not isinstance(target, str) or target not in BUILDS:
        *others, last = map(repr, BUILDS)
        raise KernelArgumentError(
            f"target is {target!r}; expected {', '.join(others)} or {last}.",
            found=str(target),
            expected=list(BUILDS),
        )


def _call_each(pieces: list[Callable[[], None]]) -> None:
    """One call after the other; signals are heard between them."""
    for piece in pieces:
        piece()
