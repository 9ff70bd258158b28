"""The target NumPy, loading: ``kernel.py`` as a module, and calls of it.

Comes in: a System, and checked arrays. Goes out: results in place. It stands in for C where there
is no compiler, and a compiled kernel is compared with it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from coadjoint.errors import OutputError
from coadjoint.render.targets.modules import KernelModule

if TYPE_CHECKING:
    from coadjoint.solve.arrays import Call
    from coadjoint.solve.system import System


def load(system: System, build: str, reference: Callable[[], Any]) -> NumpyKernel:
    """The NumPy kernel of a System."""
    return NumpyKernel(system)


class NumpyKernel(KernelModule):
    """The NumPy kernel of a System."""

    def __init__(self, system: System) -> None:
        super().__init__(system, "kernel.py")

    def calls(self, function: str, call: Call) -> Iterator[Callable[[], Any]]:
        """One call for all members."""
        given = [call.state, call.parameters]
        given += [array for name, array in call.driving.items() if name != "time"]
        named = {"time": call.driving["time"][0, ...]} if "time" in call.driving else {}
        yield partial(self.function(function), *given, out=call.block, **named)

    def values(
        self, function: str, arrays: Sequence[NDArray[Any]], shape: tuple[int, ...]
    ) -> NDArray[Any]:
        """What the kernel computes.

        Raises:
            OutputError: It does not run, or its result has another shape.
        """
        try:
            given, named = list(arrays), {}
            if self.system.TIME:
                named = {"time": given.pop()[0]}
            values = np.asarray(self.function(function)(*given, **named), dtype=np.float64)
        except OutputError:
            raise
        except Exception as error:
            problem = f"does not run: {function}: {type(error).__name__}: {error}"
            raise self.explain_broken(problem) from error
        if values.shape != shape:
            raise self.explain_broken(f"does not run: {function} has the shape {values.shape}")
        return values
