"""Waves in a plane: rates, energy and observables of a field by kernels at points.

Comes in: a `TorusSystem`. Goes out: its kernels, between transforms of SciPy, and a check of where
its runs begin.
Read next: `coadjoint.solve.simulate`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.render.targets.protocol import Call, Kernel
from coadjoint.solve.formulas import Formula
from coadjoint.solve.kernels import Kernels
from coadjoint.solve.spectral import require_mean_zero

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.array_types import Array
    from coadjoint.solve.torus import TorusSystem

    Factors = Mapping[tuple[int, int], Array]

#: The part of a field that waves beyond K may be where they are 0 but for rounding.
ROUNDING: Final = 1e-9


class TorusKernels(Kernels):
    """Kernels at points, with transforms around them."""

    system: TorusSystem

    def _load(self, target: str) -> Kernel:
        return TorusKernel(self.system, self.system.points.find_kernel(target))


class TorusKernel(Kernel):
    """Rates, energy and observables of a field by those at points."""

    def __init__(self, system: TorusSystem, points: Kernel) -> None:
        self.source, self._points, self._torus = points.source, points, system.around
        self._sizes, self._shared = system.counts, list(system.PARAMETERS.components)
        (self._name,) = system.own_state
        scope = dict.fromkeys(self._shared, ())
        self._factors = {
            u: {place: Formula(text, scope, "a factor") for place, text in factors.items()}
            for u, (_, factors) in self._torus.solved.items()
        }

    def prepare(self, function: str = "") -> None:
        """Compile what is needed at the points."""
        self._points.prepare(function)

    def calls(self, function: str, call: Call) -> Iterator[Callable[[], Any]]:
        """One call for all trajectories."""
        yield partial(self._evaluate, function, call)

    def _evaluate(self, function: str, call: Call) -> None:
        """A function of all trajectories at once."""
        members = call.members
        rows = call.parameters.reshape(len(self._shared), -1)
        given = {
            name: np.broadcast_to(row, (members,))
            for name, row in zip(self._shared, rows, strict=True)
        }
        with np.errstate(all="ignore"):
            waves = PlaneWaves(self._sizes, *(given[name] for name in self._torus.lengths))
            field = call.state.reshape(*self._sizes, members)
            series = {self._name: waves.transform(field)}
            for u, (m, _) in self._torus.solved.items():
                parts = {
                    place: np.broadcast_to(formula.evaluate(given)[0], (members,))
                    for place, formula in self._factors[u].items()
                }
                series[u] = waves.solve(series[m], parts)
            shown = [waves.show(series[of], i, j) for of, i, j in self._torus.derivatives.values()]
            state = waves.show(series[self._name]).reshape(-1, members)
            known = [each.reshape(-1, members) for each in (*given.values(), *shown)]
            inner = replace(call, state=state, parameters=np.concatenate(known))
            if function == "rhs":
                inner = replace(inner, block=np.empty_like(state))
            for piece in self._points.calls(function, inner):
                piece()
            if function == "rhs":
                moved = waves.transform(inner.block.reshape(*self._sizes, members))
                call.block[...] = waves.show(moved).reshape(call.block.shape)


class PlaneWaves:
    """The waves in a plane.

    Args:
        sizes: How many points it has along both coordinates.
        lengths: How long it is, a number for each trajectory.
    """

    def __init__(self, sizes: tuple[int, ...], *lengths: Array) -> None:
        self.counts = sizes
        whole = [np.fft.fftfreq(sizes[0], 1 / sizes[0]), np.fft.rfftfreq(sizes[1], 1 / sizes[1])]
        kept = [np.abs(own) <= (n - 1) // 3 for own, n in zip(whole, sizes, strict=True)]
        self._kept = (kept[0][:, np.newaxis] & kept[1])[..., np.newaxis]
        self._x = 2j * np.pi * whole[0][:, np.newaxis, np.newaxis] / lengths[0]
        self._y = 2j * np.pi * whole[1][:, np.newaxis] / lengths[1]

    def transform(self, values: Array) -> NDArray[np.complex128]:
        """The waves of values ``(N_x, N_y, trajectories)`` that are kept."""
        from scipy import fft

        return np.where(self._kept, fft.rfftn(values, axes=(0, 1)), 0)

    def show(self, waves: NDArray[np.complex128], i: int = 0, j: int = 0) -> Array:
        """The values of a derivative at the points."""
        from scipy import fft

        found: Array = fft.irfftn(waves * self._x**i * self._y**j, s=self.counts, axes=(0, 1))
        return np.ascontiguousarray(found)

    def solve(self, right: NDArray[np.complex128], factors: Factors) -> NDArray[np.complex128]:
        """U with ``sum a_ij D_x^i D_y^j u = right``; the mean is 0 where A takes constants to 0."""
        symbol = np.zeros(right.shape)
        for (i, j), a in factors.items():
            symbol += (a * self._x**i * self._y**j).real
        if (0, 0) not in factors:
            symbol[0, 0] = np.inf
        return right / symbol


def check_plane(system: TorusSystem, state: Array) -> None:
    """The field at the beginning has a mean of 0 where w = A psi has, and no waves that stay.

    Raises:
        KernelArgumentError: It has.
    """
    field = state.reshape(*system.counts, -1)
    largest = np.max(np.abs(field), axis=(0, 1))
    for u, (m, factors) in system.around.solved.items():
        if (0, 0) not in factors:
            require_mean_zero(system, u, m, field.reshape(-1, field.shape[-1]))
    one = np.ones(field.shape[-1])
    waves = PlaneWaves(system.counts, one, one)
    rest = np.max(np.abs(field - waves.show(waves.transform(field))), axis=(0, 1))
    if (rest > ROUNDING * largest).any():
        most = " and ".join(str((n - 1) // 3) for n in system.counts)
        raise KernelArgumentError(
            f"the field of {system.name} has waves beyond {most} at the beginning, up to "
            f"{float(np.max(rest)):.3g}, which {' x '.join(map(str, system.counts))} points do not "
            "move; expected longer ones alone. Take more points, or leave these waves out.",
            found=float(np.max(rest)),
            expected=0.0,
        )
