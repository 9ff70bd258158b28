"""The target NumPy, loading: ``kernel.py`` as a module, and calls of it.

Comes in: a System, and checked arrays. Goes out: results in place. It stands in for C where there
is not a compiler, and a compiled kernel is compared with it.
Read next: `coadjoint.render.targets.numpy.runner`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from coadjoint.errors import OutputError
from coadjoint.render.targets.modules import KernelModule
from coadjoint.render.targets.numpy.runner import Runner
from coadjoint.render.targets.protocol import Call, Evaluate, Generated

if TYPE_CHECKING:
    from coadjoint.render.targets.protocol import Array, Buffer


def load(system: Generated, build: str, reference: Callable[[], Any]) -> NumpyKernel:
    """The NumPy kernel of a System."""
    return NumpyKernel(system, "kernel.py")


class NumpyKernel(KernelModule):
    """The NumPy kernel of a System."""

    def __init__(self, system: Generated, file: str) -> None:
        super().__init__(system, file)
        self._runners: dict[str, Runner | None] = {}

    def calls(self, function: str, call: Call) -> Iterator[Callable[[], Any]]:
        """One call for all members."""
        given = list(call.given.values())
        members_share = all(each.ndim == 1 for each in given[1:])
        runner = self._runner(function) if members_share and call.members else None
        if runner is None:
            yield partial(self._with_arguments(function, call), out=call.block)
        else:
            block = call.block.reshape(-1, call.members)
            yield partial(runner.run, *given, out=block)

    def evaluate_with(self, function: str, like: Call) -> Evaluate:
        """The function of the file in parts; or itself, which looks at the shapes of arrays."""
        evaluate, known = self.function(function), like.parameters
        driving, runner = tuple(like.driving.values()), self._runner(function)
        if runner is not None:
            return runner.evaluate_with(known, driving)

        def run(members: int, state: Array, parameters: Buffer | None, out: Array) -> None:
            given = known if parameters is None else np.frombuffer(parameters)
            evaluate(state, given, *driving, out=out)

        return run

    def _runner(self, function: str) -> Runner | None:
        """The function in parts, where it is made of formulas alone."""
        if function not in self._runners:
            from coadjoint.render.targets.numpy.arrange import arrange

            self.function(function)  # there is one of this name
            arranged = arrange(self.text, function)
            runner = None if arranged is None else Runner(arranged, self.value("CHUNK"))
            self._runners[function] = runner
        return self._runners[function]

    def values(self, function: str, call: Call) -> NDArray[Any]:
        """What the kernel computes in an array of its own.

        Raises:
            OutputError: It does not run, or its result has another shape.
        """
        try:
            values = np.asarray(self._with_arguments(function, call)(), dtype=np.float64)
        except OutputError:
            raise
        except Exception as error:
            problem = f"does not run: {function}: {type(error).__name__}: {error}"
            raise self.explain_broken(problem) from error
        if values.shape != call.block.shape:
            raise self.explain_broken(f"does not run: {function} has the shape {values.shape}")
        return values

    def _with_arguments(self, function: str, call: Call) -> Callable[..., Any]:
        """A function of the file with all that it reads."""
        given = call.given
        named = {"time": given.pop("time")[0, ...]} if "time" in given else {}
        return partial(self.function(function), *given.values(), **named)
