"""The target Python, loading: ``kernel_python.py`` as a module, and a loop over members.

Comes in: a System, and checked arrays. Goes out: results in place. Python raises an error where C
has an infinity or NaN: at a quotient by zero, the root of a negative number, an exponential that is
too large. A member where it does is NaN in every row, so that the others have their values.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.render.targets.modules import KernelModule
from coadjoint.render.targets.protocol import Call, Generated

if TYPE_CHECKING:
    from numpy.typing import NDArray


def load(system: Generated, build: str, reference: Callable[[], Any]) -> PythonKernel:
    """The plain Python kernel of a System."""
    return PythonKernel(system, "kernel_python.py")


class PythonKernel(KernelModule):
    """The plain Python kernel of a System."""

    def calls(self, function: str, call: Call) -> Iterator[Callable[[], Any]]:
        """One call for all members."""
        yield partial(_evaluate, self.function(function), call)


def _evaluate(function: Callable[..., Any], call: Call) -> None:
    """Evaluate all members, one after the other."""
    given = {name: _by_member(array, call.members) for name, array in call.given.items()}
    times = given.pop("time", None)
    for member in range(call.members):
        named = {} if times is None else {"time": next(times)[0]}
        try:
            values = function(*map(next, given.values()), **named)
        except (ArithmeticError, ValueError):
            values = np.nan
        call.block[..., member] = values


def _by_member(array: NDArray[Any], members: int) -> Iterator[list[float]]:
    """The numbers of each member, one list after the other."""
    if array.ndim == 1:
        shared = array.tolist()
        return (shared for _ in range(members))
    return (column.tolist() for column in array.T)
