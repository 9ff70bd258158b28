"""The target C, loading: a library for each build, and calls of it.

Comes in: a System, and checked arrays. Goes out: results in place. A fresh library is compared with
the NumPy kernel before it is used.
Read next: `coadjoint.build.library`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from coadjoint.build.library import Library, load_library
from coadjoint.errors import CrossCheckError

if TYPE_CHECKING:
    from coadjoint.render.targets.numpy.loader import NumpyKernel
    from coadjoint.solve.arrays import Call
    from coadjoint.solve.system import System

#: The flags of each build, by the name that compilers know them under.
FLAGS: Final = {"c": "exact", "c-fast": "fast"}
#: Numbers that one call of a C function reads and writes. At 2 to 20 ns each it ends within a tenth
#: of a second, so that Ctrl-C is heard; some microseconds for each call do not show.
CHUNK = 1 << 22
#: Points at which a fresh library is compared with the NumPy kernel: odd, so that the last of them
#: fill no vector register.
PROBES = 17
#: Largest relative difference of a fresh library where bits are not promised: fused operations and
#: other libraries' functions differ by roundings, a wrong kernel by much more.
ROUNDINGS = 1e-9


class CKernel:
    """A C kernel of a System.

    Attributes:
        source: SHA-256 of the ``kernel.c`` that it was compiled from.
    """

    def __init__(self, library: Library) -> None:
        self._library = library
        self.source = library.source

    def calls(self, function: str, call: Call) -> Iterator[Callable[[], None]]:
        """C calls that together evaluate all members."""
        item = call.state.itemsize
        arrays = (call.state, call.parameters, *call.driving.values(), call.block)
        places = [(array.ctypes.data, array.ndim == 1) for array in arrays[:-1]]
        places.append((call.block.ctypes.data, False))  # that of a scalar has one axis, too
        size = max(1, CHUNK // sum(math.prod(array.shape[:-1]) for array in arrays))
        stride = call.members
        for first in range(0, call.members, size):
            piece = self._library.bind(
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


def load(system: System, build: str, reference: Callable[[], NumpyKernel]) -> CKernel:
    """The C kernel of a build, verified."""
    verify = partial(_verify, system, build, reference)
    return CKernel(load_library(system.folder, system.name, system.id, FLAGS[build], verify))


def _verify(
    system: System, build: str, reference: Callable[[], NumpyKernel], library: Library
) -> None:
    """Compare a fresh library with the NumPy kernel at a few points.

    Raises:
        CrossCheckError: They differ.
        OutputError: The NumPy kernel does not run.
    """
    source = np.random.default_rng(0)
    sizes = [system.PARAMETERS.size]
    sizes += [each.size for each in (system.INPUTS, system.TIME) if each]
    most = system.STATE.size + system.RECONSTRUCTED.size
    wide = source.uniform(0.5, 2.0, (most, PROBES))
    own = [source.uniform(0.5, 2.0, (size, PROBES)) for size in sizes]
    shared = [array[:, 0].copy() for array in own]
    exact = build == "c" and not system.elementary
    for function, shape in system.functions.items():
        state = wide[: system.rows(function).size]
        for others, stride in ((own, PROBES), (shared, 0)):
            expected = reference().values(function, [state, *others], (*shape, PROBES))
            found = np.full((*shape, PROBES), np.pi)
            addresses = [state.ctypes.data, PROBES]
            addresses += [n for array in others for n in (array.ctypes.data, stride)]
            library.function(function)(PROBES, *addresses, found.ctypes.data, PROBES)
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


def _agree(found: NDArray[Any], expected: NDArray[Any], *, exact: bool) -> bool:
    """Whether two results are equal, or equal but for roundings; NaN equals NaN."""
    if exact:
        return np.array_equal(found, expected, equal_nan=True)
    with np.errstate(all="ignore"):
        size = np.abs(expected[np.isfinite(expected)]).max(initial=0.0)
        close = np.abs(found - expected) <= ROUNDINGS * size
        same = (found == expected) | (np.isnan(found) & np.isnan(expected))
    return bool((close | same).all())
