"""The spherical midpoint, for motions on products of spheres and tangent spheres, in NumPy.

A step is ``W = w + h X(r (w + W)/|w + W|)`` in each factor, X the field of the motion and r the
length of w: R. I. McLachlan, K. Modin and O. Verdier, Physical Review E 89 (2014) 061301, and
Mathematics of Computation 86 (2017) 2325. On the dual of so(3) it is a Poisson map, keeps each
``|w|`` and, where there is one factor and the energy is quadratic, the energy.
A factor of the dual of se(3), momentum Pi and vector Gamma, is one of dual numbers
``Gamma + e Pi`` with ``e^2 = 0``; lengths and quotients are those of dual numbers. It keeps
``|Gamma|^2`` and ``Pi . Gamma``. It is a Poisson map as the limit of one: with ``e^2 = d^2`` in
place of 0 the factor is two spheres, ``Gamma + d Pi`` and ``Gamma - d Pi``, each with a multiple of
the bracket of so(3), so that the step is the one above.
What is reconstructed turns by the element of the same step (`coadjoint.lower.carriers`), so that a
momentum in space stays to rounding.
Read next: `coadjoint.solve.methods.isospectral_midpoint`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.lower.compositions import COMPOSITIONS
from coadjoint.methods import Carrier, Sphere
from coadjoint.solve.methods.lie_poisson import Arc, Gradient, LiePoisson, Sweep

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from coadjoint.array_types import Array, Mask
    from coadjoint.solve.steps import Lanes

#: How far Newton's factor is from 1 at the most where its equation is solved.
NEAR: Final = 2.0**-20
#: By how much it may be from 1 by roundings alone.
ROUNDINGS: Final = 2.0**-50


def make(functions: Mapping[str, Any], size: float, order: int) -> SphericalMidpoint:
    """The method of an order, from functions of the kernel and the rows of spheres."""
    return SphericalMidpoint(
        field=functions["field"],
        size=size,
        spheres=tuple(Sphere(*each) for each in functions["spheres"]),
        carriers=tuple(Carrier(*each) for each in functions.get("carriers", ())),
        gradient=functions.get("gradient"),
        order=order,
    )


class SphericalMidpoint(LiePoisson):
    """A step through the middle of an arc of each sphere.

    Args:
        field: The bracket with the energy, some time after that of the lanes.
        size: As of `LiePoisson`.
        spheres: The factors; rows in none are moved by the midpoint. Of a family of equal members a
            row is a slice, of one component of all members.
        carriers: What turns with them, below the state.
        gradient: The derivative of the energy, where something does.
        order: As of `LiePoisson`.
    """

    def __init__(
        self,
        *,
        field: Callable[[Lanes, Array, Array], Array],
        size: float,
        spheres: tuple[Sphere, ...],
        carriers: tuple[Carrier, ...] = (),
        gradient: Gradient | None = None,
        order: int = 2,
    ) -> None:
        self.field, self.size, self.stages = field, size, COMPOSITIONS[order]
        self.spheres, self.carriers, self.find_element = spheres, carriers, gradient
        self.holds = any(each.tangent for each in spheres)

    def prepare(self, arc: Arc, middle: Array) -> list[Scale]:
        """As `LiePoisson.prepare`: of each sphere the quotient of lengths."""
        return [Scale(arc.state, middle - arc.state, each) for each in self.spheres]

    def confirm(self, kept: list[Scale]) -> Mask | bool:
        """As `LiePoisson.confirm`: quotients are roots, and positive."""
        roots = np.concatenate([np.atleast_2d(each.is_root()) for each in kept])
        return np.asarray(roots.all(axis=0))

    def sweep(self, arc: Arc, middle: Array, kept: list[Scale]) -> Sweep:
        """As `LiePoisson.sweep`."""
        rates = self.field(arc.lanes, arc.middle, middle)
        chord = arc.low + 0.5 * arc.length * rates
        following, moves = arc.state + chord, np.zeros(arc.length.shape, bool)
        for each in kept:
            moves = moves | each.apply(arc.state, chord, following)
        rise = arc.length * rates
        for own in self.carriers:
            stretch = arc.length * kept[own.sphere].scale
            if own.is_half:
                stretch = self._halve(arc, middle, own, stretch)
            for row in own.rows:
                rise[row] = stretch * rates[row]
                following[row] = arc.state[row] + (arc.low[row] + 0.5 * rise[row])
        return Sweep(following, rise, moves)

    def _halve(self, arc: Arc, middle: Array, carrier: Carrier, stretch: Array) -> Array:
        """The length by which Cayley's transform turns a quaternion by half of an angle."""
        assert self.find_element is not None, "what is carried has an element"
        xi = self.find_element(arc.lanes, arc.middle, middle)
        a, b, c = (xi[row] for row in self.spheres[carrier.sphere].turning)
        square = 0.25 * stretch * stretch * (carrier.square * (a * a + b * b + c * c))
        return np.asarray(2.0 * stretch / (1.0 + np.sqrt(1.0 + square)))

    def linearise(self, arc: Arc, middle: Array, following: Array, kept: list[Scale]) -> Array:
        """As `LiePoisson.linearise`, exact."""
        slopes = self.find_slopes(arc, arc.middle, 0.5 * arc.length, middle)
        for column in slopes.swapaxes(0, 1):
            for each in kept:
                each.turn(following, column)
        return slopes

    def apply_slopes(
        self, arc: Arc, middle: Array, following: Array, kept: list[Scale], vector: Array
    ) -> Array:
        """As `LiePoisson.apply_slopes`."""
        change = super().apply_slopes(arc, middle, following, kept, vector)
        for each in kept:
            each.turn(following, change)
        return change


class Scale:
    """The quotient of the lengths of a vector and of the half of a sum, on its way to be solved.

    It is the root s of ``s^2 |c|^2 = |w|^2`` in dual numbers; each sweep makes one step of
    Newton's method for it, ``s (3 - s^2 |c|^2/|w|^2)/2``, which divides nothing. Where that changes
    it by a rounding it stays: it need not be closer, and each such change would lengthen what the
    step adds, with a direction from before it. Of a free body that was 1e-21 of the Casimir in
    each step, of one sign.

    Args:
        state: w, where the step begins.
        offset: How far the middle of the step is from it, about; by it the quotient begins.
        sphere: Whose it is.
    """

    def __init__(self, state: Array, offset: Array, sphere: Sphere) -> None:
        self.sphere = sphere
        square, mixed = _measure(state, sphere)
        square = _or_tangent(square, state, sphere)
        # half the inverse of the square; of a vector that is 0, anything will do
        self.half = 0.5 / np.where(square > 0.0, square, 1.0)
        self.slant = -4.0 * self.half * self.half * mixed
        far, _ = _measure(offset, sphere)
        self.scale, self.slope = 1.0 + self.half * far, np.zeros(square.shape)
        self.rest, self.empty = np.ones(square.shape), square == 0.0

    def is_root(self) -> Mask:
        """Where the quotient is solved: 0 and negative numbers are roots too."""
        return np.asarray(self.empty | ((np.abs(self.rest - 1.0) < NEAR) & (self.scale > 0.0)))

    def apply(self, start: Array, rise: Array, state: Array) -> Mask:
        """Improve the quotient and multiply rows of a state, a start with a rise, by it.

        What this adds is added to the rise, so that a middle is rounded once. Where it was
        rounded twice, a free body lost 5e-22 of its energy and of its Casimir in each step.

        Returns:
            Where the quotient changed; nowhere of dual numbers, whose slopes roundings go on to
            change, so that lanes are held that are done.
        """
        square, mixed = _measure(state, self.sphere)
        square = _or_tangent(square, state, self.sphere)
        both = self.scale * self.scale
        part = self.half * square
        self.rest = rest = 1.5 - part * both
        stays = np.abs(rest - 1.0) <= ROUNDINGS
        if self.sphere.tangent:
            tilt = 2.0 * self.half * mixed
            lean = (self.slant * square + tilt) * both
            lean = lean + 2.0 * part * self.scale * self.slope
            slope = self.slope * rest - self.scale * lean
            still = stays & (np.abs(lean) <= ROUNDINGS * np.abs(tilt))
            self.slope = np.where(still, self.slope, slope)
        self.scale = np.where(stays, self.scale, self.scale * rest)
        beyond = self.scale - 1.0
        for row, tangent in self.sphere.pairs:
            more = beyond * state[tangent] + self.slope * state[row]
            state[tangent] = start[tangent] + (rise[tangent] + more)
        for row in self.sphere.rows:
            state[row] = start[row] + (rise[row] + beyond * state[row])
        moves = ~np.atleast_2d(stays | (rest == 1.5)).all(axis=0)  # which it is of the vector 0
        return np.asarray(moves & np.array(not self.sphere.tangent))

    def turn(self, found: Array, change: Array) -> None:
        """How rows that were multiplied change with what was multiplied, in the place of that.

        With ``m = s c`` and ``s^2 |c|^2 = |w|^2`` it is ``dm = s (dc - m (m.dc)/|w|^2)``, of dual
        numbers too.
        """
        rows, tangent, twice = self.sphere.rows, self.sphere.tangent, 2.0 * self.half
        along = _multiply(found, rows, change, rows)
        if tangent:
            dual = _multiply(found, rows, change, tangent)
            dual = dual + _multiply(found, tangent, change, rows)
            dual = twice * dual + 2.0 * self.slant * along
        along = twice * along
        for row, other in self.sphere.pairs:
            change[other] = change[other] - found[other] * along - found[row] * dual
        for row in rows:
            change[row] = change[row] - found[row] * along
        for row, other in self.sphere.pairs:
            change[other] = self.scale * change[other] + self.slope * change[row]
        for row in rows:
            change[row] = self.scale * change[row]


def _multiply(one: Array, rows: Any, other: Array, columns: Any) -> Array:
    """The product of two vectors, each by its rows."""
    a, b, c = (one[row] * other[column] for row, column in zip(rows, columns, strict=True))
    return np.asarray(a + b + c)


def _measure(state: Array, sphere: Sphere) -> tuple[Array, Array]:
    """The square of a length and, of a tangent, the product with it."""
    a, b, c = (state[row] for row in sphere.rows)
    square = a * a + b * b + c * c
    if not sphere.tangent:
        return square, np.zeros(square.shape)
    d, e, f = (state[row] for row in sphere.tangent)
    return square, a * d + b * e + c * f


def _or_tangent(square: Array, state: Array, sphere: Sphere) -> Array:
    """The square of a length; of a vector that is 0, whose orbit is a sphere, of its tangent."""
    if not sphere.tangent:
        return square
    d, e, f = (state[row] for row in sphere.tangent)
    return np.where(square == 0.0, d * d + e * e + f * f, square)
