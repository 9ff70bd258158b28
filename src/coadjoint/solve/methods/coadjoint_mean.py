"""The coadjoint-mean method, for motions on the dual of any Lie algebra, in NumPy.

With ``A(xi) mu = J(mu) xi``, the coadjoint action, a step of length h is ``exp(h A(xi)) mu`` where
``xi = dH(phi(h A(xi)) mu)`` and ``phi(z) = (exp(z) - 1)/z``. So xi is the gradient at the mean of
mu along the arc of the step. For quadratic and other energies with a Lagrangian this is the
reduced discrete Hamilton-Pontryagin integrator of N. Bou-Rabee and J. E. Marsden, Foundations of
Computational Mathematics 9 (2009) 197, with tau = exp, written on the dual of the algebra alone.
What is reconstructed moves by ``g' = g xi``: where its rates are linear in it, the exponential of
those at the mean of mu moves it by the same xi, and a momentum in space stays.
Read next: `coadjoint.solve.methods.spherical_midpoint`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.solve.methods.lie_poisson import Arc, LiePoisson, Sweep
from coadjoint.solve.steps import add_low, larger

if TYPE_CHECKING:
    from collections.abc import Mapping

    from coadjoint.array_types import Array, Mask

#: Terms of the series of phi, at the most.
TERMS: Final = 40
#: The part of the largest component at which a term is the last one.
LEAST: Final = 2.0**-58
#: Parts in which an arc is followed, at the most.
PARTS: Final = 16.0


def make(functions: Mapping[str, Any], size: float, order: int) -> CoadjointMean:
    """The method of an order, from functions of the kernel."""
    gradient, bracket = functions["gradient"], functions["bracket"]
    method = CoadjointMean(gradient=gradient, bracket=bracket, size=size, order=order)
    method.known = functions.get("known")
    return method


class CoadjointMean(LiePoisson):
    """A step by the exponential of one element of the algebra.

    Attributes:
        known: Rows above what is reconstructed, which the same element moves; None for all.
    """

    known: int | None = None

    def prepare(self, arc: Arc, middle: Array) -> list[Array]:
        """As `LiePoisson.prepare`: in how many parts the arc of a step is followed."""
        return [np.ones(arc.length.shape)]

    def sweep(self, arc: Arc, middle: Array, kept: list[Array]) -> Sweep:
        """As `LiePoisson.sweep`: the mean of the arc, and its chord."""
        xi = self.gradient(arc.lanes, arc.middle, middle)
        (parts,) = kept
        mean, chord, grew = self._follow(arc, xi, parts)
        more = grew & (parts < PARTS)
        kept[0] = np.where(more, 2.0 * parts, parts)
        return Sweep(mean, chord, more)

    def linearise(self, arc: Arc, middle: Array, following: Array, kept: list[Array]) -> Array:
        """As `LiePoisson.linearise`; the middle enters a sweep through xi alone.

        So the part of the rates with xi in its place is left out.
        """
        half = 0.5 * arc.length
        slopes = self.find_slopes(arc, arc.middle, half, middle)
        xi = self.gradient(arc.lanes, arc.middle, middle)
        for k, unit in enumerate(np.eye(len(middle))[: self.known]):
            every = np.repeat(unit[:, np.newaxis], middle.shape[1], axis=1)
            slopes[:, k] -= half * self.bracket(arc.lanes, arc.middle, every, xi)
        return slopes

    def _follow(self, arc: Arc, xi: Array, parts: Array) -> tuple[Array, Array, Mask]:
        """The mean of the arc of an element from a state on, its chord, and where terms grew."""
        start, length = arc.state, arc.length / parts
        point, mean, chord = start, np.zeros(start.shape), np.zeros(start.shape)
        grew = np.zeros(length.shape, bool)
        for part in range(int(parts.max())):
            inside = part < parts
            turn, rest, more = self._find_rest(arc, xi, point, length)
            rest = rest + arc.low
            rise = length * (turn + self.bracket(arc.lanes, arc.middle, rest, xi))
            mean = np.where(inside, mean + (point + rest), mean)
            chord = np.where(inside, chord + rise, chord)
            grew |= inside & more
            point = start + chord
        return mean / parts, chord, grew

    def _find_rest(
        self, arc: Arc, xi: Array, point: Array, length: Array
    ) -> tuple[Array, Array, Mask]:
        """The action on a point, its mean along an arc minus itself, and where terms grow.

        The mean itself is rounded too coarsely: with it the Casimirs of the heavy top would drift
        by 6e-19 a step. Terms less than roundings of a plain sum would be lost, all with their
        signs: with turns of an eighth of a circle that was 1e-17 a step.
        """
        turn = self.bracket(arc.lanes, arc.middle, point, xi)
        term, first = length * 0.5 * turn, _find_top(point)
        rest, lost = np.zeros(point.shape), np.zeros(point.shape)
        done, grew = np.zeros(length.shape, bool), np.zeros(length.shape, bool)
        for k in range(3, TERMS + 3):
            top = _find_top(term)
            total, rounded = add_low(rest, lost, term)
            rest, lost = np.where(done, rest, total), np.where(done, lost, rounded)
            grew |= ~done & (top > first)
            done |= top <= LEAST * first
            if done.all():
                break
            # 1/k times it would have roundings of one sign
            term = length * self.bracket(arc.lanes, arc.middle, term, xi) / float(k)
        return turn, rest + lost, grew | ~done


def _find_top(rows: Array) -> Array:
    """The size of the largest component."""
    top = np.abs(rows[0])
    for row in rows[1:]:
        top = larger(np.abs(row), top)
    return np.asarray(top)
