"""The isospectral midpoint, for motions of matrices, in NumPy.

A motion ``W' = [B, W]`` of matrices, B and W in an algebra of matrices that satisfy
``A S + S A^* = 0``. With X in the middle a step goes from ``(1 - h B/2) X (1 + h B/2)`` to
``(1 + h B/2) X (1 - h B/2)``, B that of X: K. Modin and M. Viviani, Foundations of Computational
Mathematics 20 (2020) 889. It is a Poisson map on the dual of such an algebra and keeps the
spectrum of W. In the coordinates of the state it is ``x + h J(X) xi`` where
``X = x + h/2 J(X) xi + (h/2 B) X (h/2 B)``; the last product is a function of the kernel, which on
su(n) and sl(n) is that of a larger algebra (`coadjoint.derive.sandwich`).
What is reconstructed, with rates that are linear in it, moves by Cayley's transform of the same
element: by the midpoint, with the state held at X. Where it is a matrix that the matrices of the
algebra multiply, a momentum in space stays.
Read next: `coadjoint.solve.methods.lie_poisson`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.solve.methods.lie_poisson import Arc, Bracket, Gradient, LiePoisson, Sweep

if TYPE_CHECKING:
    from collections.abc import Mapping

    from coadjoint.array_types import Array


def make(functions: Mapping[str, Any], size: float, order: int) -> IsospectralMidpoint:
    """The method of an order, from functions of the kernel."""
    return IsospectralMidpoint(
        gradient=functions["gradient"],
        bracket=functions["bracket"],
        sandwich=functions["sandwich"],
        known=functions.get("known"),
        size=size,
        order=order,
    )


class IsospectralMidpoint(LiePoisson):
    """A step by Cayley's transform of one element of the algebra.

    Args:
        gradient: As of `LiePoisson`.
        bracket: Likewise.
        sandwich: The product ``B(vector) W(state) B(vector)`` in the coordinates of the state.
        size: As of `LiePoisson`.
        known: Rows above what is reconstructed; None for all.
        order: Likewise.
    """

    def __init__(
        self,
        *,
        gradient: Gradient,
        bracket: Bracket,
        sandwich: Bracket,
        size: float,
        known: int | None = None,
        order: int = 2,
    ) -> None:
        super().__init__(gradient=gradient, bracket=bracket, size=size, order=order)
        self.sandwich, self.known = sandwich, known

    def sweep(self, arc: Arc, middle: Array, kept: None) -> Sweep:
        """As `LiePoisson.sweep`."""
        lanes, after, half = arc.lanes, arc.middle, 0.5 * arc.length
        xi = self.gradient(lanes, after, middle)
        rates, both = self.bracket(lanes, after, middle, xi), np.zeros(middle.shape)
        known = slice(None) if self.known is None else slice(self.known)
        both[known] = self.sandwich(lanes, after, middle[known], half * xi[known])
        return Sweep(arc.state + (arc.low + (half * rates + both)), arc.length * rates)
