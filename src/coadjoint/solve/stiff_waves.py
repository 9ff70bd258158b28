r"""Stiff waves: the linear part of fields by Fourier derivatives, wave by wave.

About constant fields, the means of those at hand, a wave :math:`\hat u_n e^{i \kappa_n s}` moves by
:math:`\dot{\hat u}_n = L(\kappa_n) \hat u_n`, with a matrix L for several fields: what their rates
have of the first degree, with all derivatives, how short the waves may be. The equation of the
stages of an implicit method, :math:`Z = h (A \otimes 1) f(x_0 + Z)`, is then solved by sweeps

.. math:: Z \leftarrow Z + (1 - h A \otimes L)^{-1} \big(h (A \otimes 1) f(x_0 + Z) - Z\big),

with a matrix of s n rows for s stages of n fields for each wave. They come together where the rest
of f is small over a step, however stiff L is. The equation that they solve has no L in it.
Comes in: a `SpectralSystem` and parameters. Goes out: what takes a residual to a correction.
Read next: `coadjoint.solve.wave_gauss`.

Source:
    Kennedy and Carpenter, Applied Numerical Mathematics 44 (2003) 139, have what is stiff and
    linear implicit alone; here the whole equation is, and L directs its sweeps.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.solve.formulas import Formula
from coadjoint.solve.spectral import SpectralSystem, Waves

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.array_types import Array
    from coadjoint.solve.system import System

    Matrices = NDArray[np.complex128]
    Correct = Callable[[Array], Array]


def find_stiff_waves(system: System, parameters: Array) -> StiffWaves | None:
    """The linear part of a motion by Fourier derivatives; None where there is none.

    In a plane there is none: rates are products of two derivatives, which vanish with both.
    """
    if not isinstance(system, SpectralSystem) or not system.own.slopes:
        return None
    return StiffWaves(system, parameters)


class StiffWaves:
    """The linear part of fields on a circle.

    Args:
        system: The fields.
        parameters: ``(k,)``.
    """

    def __init__(self, system: SpectralSystem, parameters: Array) -> None:
        self._own, self._names, self._size = system.own, system.own_state, system.size
        names = list(system.PARAMETERS.components)
        self._given = {
            name: np.array([value]) for name, value in zip(names, parameters, strict=True)
        }
        self._waves = Waves(self._size, self._given[self._own.length])
        scope = dict.fromkeys([*names, *self._names, *self._own.solved], ())
        self._slopes = {
            of: {name: Formula(text, scope, "a slope") for name, text in slopes.items()}
            for of, slopes in self._own.slopes.items()
        }
        self._factors = {
            u: {k: Formula(text, scope, "a factor") for k, text in factors.items()}
            for u, (_, factors) in self._own.solved.items()
        }

    def find_matrices(self, state: Array) -> Matrices:
        """L about the means of fields: ``(waves, fields, fields)``.

        Args:
            state: ``(n,)``.
        """
        means = state.reshape(len(self._names), self._size).mean(axis=1)
        values = self._given | {
            name: np.array([mean]) for name, mean in zip(self._names, means, strict=True)
        }
        count = self._size // 2 + 1
        unit = np.eye(len(self._names), dtype=complex)
        moved = {
            name: np.broadcast_to(own, (count, len(own)))
            for name, own in zip(self._names, unit, strict=True)
        }
        for u, (m, _) in self._own.solved.items():
            inverse = self._waves.invert(
                {k: factor.evaluate(values)[0] for k, factor in self._factors[u].items()}
            )
            values[u], moved[u] = values[m] * inverse[0], moved[m] * inverse
        for name in self._own.products:
            moved[name] = self._combine(name, values, moved)
        return np.stack([self._combine(name, values, moved) for name in self._names], axis=1)

    def _combine(
        self, name: str, values: Mapping[str, Array], moved: Mapping[str, Any]
    ) -> Matrices:
        """How a rate or product of waves moves with those of fields, ``(waves, fields)``."""
        shape = (self._size // 2 + 1, len(self._names))
        found = np.zeros(shape, dtype=complex)
        for symbol, formula in self._slopes.get(name, {}).items():
            of, order = self._own.derivatives.get(symbol, (symbol, 0))
            found += formula.evaluate(values)[0] * self._waves.find_symbol(order) * moved[of]
        return found

    def direct(self, state: Array, scaled: Array) -> Correct:
        """What takes residuals to corrections: the inverse of ``1 - h A x L``, or nothing.

        Args:
            state: ``(n,)``; L is taken about its means.
            scaled: h A of a method with s stages, ``(s, s)``.
        """
        stages, fields = len(scaled), len(self._names)
        with np.errstate(all="ignore"):
            matrices = self.find_matrices(state)
        if not np.isfinite(matrices).all():
            return _leave
        try:
            whole = np.einsum("ij,wab->wiajb", scaled, matrices)
            rows = stages * fields
            inverse = np.linalg.inv(np.eye(rows) - whole.reshape(-1, rows, rows))
        except np.linalg.LinAlgError:
            return _leave

        def correct(residual: Array) -> Array:
            from scipy import fft

            waves = fft.rfft(residual.reshape(rows, self._size), axis=1)
            solved = np.einsum("wab,bw->aw", inverse, waves)
            found: Array = fft.irfft(solved, n=self._size, axis=1).reshape(residual.shape)
            return found

        return correct


def _leave(residual: Array) -> Array:
    """Plain sweeps."""
    return residual
