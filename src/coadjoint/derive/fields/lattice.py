r"""Lattices: differences of functions of points, and an exact field of a point and its neighbours.

Comes in: functions of whole numbers, in any arithmetic. Goes out: their differences, and the
variation of sums over an endless grid, which decides what is kept by all rings at once.
Read next: `coadjoint.derive.fields.grid`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from coadjoint.derive.fields.stencils import stencil
from coadjoint.exact import Element, Field

#: A function of the points of a grid, in whatever arithmetic.
Lattice = Callable[[int], Any]
#: A term ``left * D_k * right`` of an operator at the points of a grid.
LatticeTerm = tuple[Lattice, int, Lattice]


@dataclass(frozen=True)
class Calculus:
    """Differences in an arithmetic.

    Attributes:
        order: Of the differences.
        inverse: One over the spacing, ``N/L``.
        number: How the arithmetic makes numbers.
        tidy: What becomes of differences of two values.
    """

    order: int
    inverse: Any
    number: Callable[[Fraction], Any]
    tidy: Callable[[Any], Any] = lambda value: value

    def differentiate(self, f: Lattice, derivative: int) -> Lattice:
        """``D_k f``."""
        if not derivative:
            return f
        known = stencil(derivative, self.order)
        scale, sign = self.inverse**derivative, -1 if derivative % 2 else 1

        def at(i: int) -> Any:
            total = self.number(known[0]) * scale * f(i) if 0 in known else self.number(Fraction(0))
            for r, c in known.items():
                if r > 0:
                    total += self.number(c) * scale * self.tidy(f(i + r) + f(i - r) * sign)
            return total

        return at

    def compose(
        self,
        operator: Sequence[Sequence[Iterable[LatticeTerm]]],
        slopes: Sequence[Lattice],
    ) -> list[Lattice]:
        """What an operator makes of slopes, each term ``left * D_k(right * slope)``."""

        def row(entries: Sequence[Iterable[LatticeTerm]]) -> Lattice:
            parts = [
                (left, self.differentiate(_multiply(right, slope), order))
                for entry, slope in zip(entries, slopes, strict=True)
                for left, order, right in entry
            ]
            zero = self.number(Fraction(0))
            return lambda i: sum((left(i) * moved(i) for left, moved in parts), zero)

        return [row(entries) for entries in operator]

    def vary(self, slopes: Sequence[Lattice]) -> Lattice:
        """``sum (-1)^k D_k`` of the derivatives of a density by a field and its derivatives."""
        parts = [
            self.differentiate(f, k) if k % 2 == 0 else _negate(self.differentiate(f, k))
            for k, f in enumerate(slopes)
        ]
        return lambda i: sum((f(i) for f in parts), self.number(Fraction(0)))


def _multiply(f: Lattice, g: Lattice) -> Lattice:
    return lambda i: f(i) * g(i)


def _negate(f: Lattice) -> Lattice:
    return lambda i: -f(i)


@dataclass(frozen=True)
class LatticeField:
    """An exact field with symbols for a point and its neighbours.

    Attributes:
        field: The field.
        components: Of the fields.
        reach: How far neighbours have symbols.
    """

    field: Field
    components: tuple[str, ...]
    reach: int

    def shift(self, element: Element, places: int) -> Element:
        """What an expression is so many points further."""
        reached = self.field.reach(element)
        new = {
            name_at(c, r): self.field[name_at(c, r + places)]
            for c in self.components
            for r in range(-self.reach, self.reach + 1)
            if name_at(c, r) in reached
        }
        return self.field.substitute(element, new)

    def vary(self, element: Element) -> dict[str, Element]:
        """Derivatives of the sum of an expression over all points of an endless grid.

        They vanish if and only if the expression is a difference ``(E - 1) g`` and a constant, E
        being the shift, so that its sum over a circle is N times the constant (Kupershmidt 1985,
        Discrete Lax Equations and Differential-Difference Calculus).
        """
        found = dict[str, Element]()
        for c in self.components:
            parts = [
                self.shift(self.field.derivative(element, name_at(c, r)), -r)
                for r in range(-self.reach, self.reach + 1)
                if name_at(c, r) in self.field.reach(element)
            ]
            found[c] = self.field.sum(parts)
        return found

    def still(self, element: Element) -> Element:
        """An expression where all points have the same fields: the constant of `vary`.

        Raises:
            ZeroDivisionError: It has no value there.
        """
        field, reached = self.field, self.field.reach(element)
        same = {
            name: field[c]
            for c in self.components
            for r in range(-self.reach, self.reach + 1)
            if (name := name_at(c, r)) in reached
        }
        return field.substitute(element, same)


def name_at(component: str, place: int) -> str:
    """What a component is called so many points away.

    >>> name_at("Pi1", 0), name_at("Pi1", -2), name_at("Pi1", 1)
    ('Pi1', 'Pi1[-2]', 'Pi1[+1]')
    """
    return f"{component}[{place:+d}]" if place else component
