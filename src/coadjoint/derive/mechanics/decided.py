r"""Values decided in the exact field before the kernel computes them.

A value that is identically zero costs a kernel operations, and rounding turns it into ``1.9e-17``.
Whether an intermediate vanishes shows only when the definitions on which it rests are substituted:
:math:`b_1 k_1 + b_2 k_2` with :math:`b = (r \cos\phi, r \sin\phi)`. To substitute all would be
too much for six coupled velocities. So each value is first evaluated at two points modulo a prime,
whose parameters agree: a value that is not zero there is not zero, and one that differs there
depends on the state. The exact normal form is taken only of what is left, and it alone decides.
Comes in: definitions in the order of the kernel. Goes out: the same with zeros, numbers and values
of the parameters alone in the place of what is identically equal to them.
Read next: `coadjoint.derive.mechanics.solver` and `coadjoint.derive.mechanics.constrained`, which
ask.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from copy import copy
from math import prod

from coadjoint.exact import Element, Field
from coadjoint.exact.residues import Residue, call_modulo, draw, residue

#: Points modulo the prime, with the same parameters.
POINTS = 2
#: Choices of points, until one has no pole and a value of each square root.
TRIES = 40
#: Terms to which a closed form may grow, as estimated before it is written out.
TERMS = 20_000


class Decided:
    """Definitions, with what is known of each exactly.

    Args:
        field: Where all names are symbols.
        members: Names whose values depend on the member: the state.

    >>> field = Field(["x", "a", "_b1"])
    >>> x, a = field["x"], field["a"]
    >>> decided = Decided(field, ["x"])
    >>> decided.define("_b1", a * x)
    a*x
    >>> decided.value(field["_b1"] / a - x), decided.value(field["_b1"] * a - x)
    (0, _b1*a - x)
    """

    def __init__(self, field: Field, members: Iterable[str]) -> None:
        self.field = field
        self.numbers: dict[str, Element] = {}
        self._members = set(members)
        self._first = frozenset(self._members)
        self._definitions: dict[str, Element] = {}
        self._closed: dict[str, Element | None] = {}
        self._tries = 0
        self._points: list[dict[str, Residue]] | None = self._draw_points()

    def define(self, name: str, element: Element) -> Element:
        """Note a definition, and return the value that the kernel should compute for it."""
        value = self.value(element)
        self._definitions[name] = value
        if self.field.as_number(value) is not None:
            self.numbers[name] = value
        if self.moves(value):
            self._members.add(name)
        self._extend(name, value)
        return value

    def list_computed(self, lines: Iterable[tuple[str, Element]]) -> list[tuple[str, Element]]:
        """Definitions as the kernel computes them; intermediates that are zero are left out."""
        noted = [(name, self.define(name, value)) for name, value in lines]
        return [(name, value) for name, value in noted if value != 0 or not name.startswith("_")]

    def copy(self) -> Decided:
        """The same, to which further definitions may be added."""
        twin = copy(self)
        twin.numbers, twin._members = {**self.numbers}, {*self._members}
        twin._definitions, twin._closed = {**self._definitions}, {**self._closed}
        twin._points = None if self._points is None else [{**at} for at in self._points]
        return twin

    def value(self, element: Element) -> Element:
        """The element, or what it is identically equal to: zero, or a value of parameters alone."""
        element = self.field.substitute(element, self.numbers)
        if self.field.as_number(element) is not None:
            return element
        values = self._values(element)
        moves = self.moves(element)
        if not values or (any(x.value for x in values) and not (moves and len({*values}) == 1)):
            return element
        closed = self.close(element)
        if closed is None or self.field.reach(closed) & self._first:
            return element
        return closed if moves or closed == 0 else element

    def is_zero(self, element: Element) -> bool:
        """Whether an element is zero once its definitions are substituted."""
        return bool(self.value(element) == 0)

    def close(self, element: Element) -> Element | None:
        """The normal form with all definitions substituted; None where it is too long."""
        inner = {}
        for name in self.field.reach(element) & self._definitions.keys():
            if name not in self._closed:
                self._closed[name] = self.close(self._definitions[name])
            value = self._closed[name]
            if value is None:
                return None
            inner[name] = value
        sizes = {name: _size(self.field, value, {}) for name, value in inner.items()}
        if _size(self.field, element, sizes) > TERMS:
            return None
        return self.field.normal(self.field.substitute(element, inner))

    def moves(self, element: Element) -> bool:
        """Whether an element depends on the member, through definitions too."""
        return bool(self.field.reach(element) & self._members)

    # -- points modulo a prime --------------------------------------------------------------

    def _draw_points(self) -> list[dict[str, Residue]]:
        """Points at which every name has a value, the parameters the same ones."""
        self._tries += 1
        return [
            {name: draw(f"{self._tries} {name} {self._own(name, n)}") for name in self.field.names}
            for n in range(POINTS)
        ]

    def _own(self, name: str, place: int) -> int:
        return place if name in self._first else 0

    def _values(self, element: Element) -> list[Residue]:
        """Values at the points; none where no points were found."""
        while self._points is not None:
            try:
                return [
                    self.field.evaluate(element, at, residue, call_modulo) for at in self._points
                ]
            except ZeroDivisionError:
                self._redraw()
        return []

    def _extend(self, name: str, value: Element) -> None:
        """Give a definition its value at the points."""
        for at, residue_there in zip(self._points or (), self._values(value), strict=False):
            at[name] = residue_there

    def _redraw(self) -> None:
        """Other points, with the values of the definitions; None where there were too many."""
        while self._tries < TRIES:
            points = self._draw_points()
            try:
                for at in points:
                    for name, value in self._definitions.items():
                        at[name] = self.field.evaluate(value, at, residue, call_modulo)
            except ZeroDivisionError:
                continue
            self._points = points
            return
        self._points = None


# -- sizes ----------------------------------------------------------------------------------------


def _size(field: Field, element: Element, sizes: Mapping[str, int]) -> int:
    """Terms of the numerators times those of the denominators, once names of some sizes are in."""
    return sum(
        sum(
            prod(sizes.get(name, 1) ** power for name, power in monomial.powers)
            for monomial in written.monomials
        )
        * prod(_size(field, divisor, sizes) ** power for divisor, power in written.divisors)
        for written in field.quotients(element)
    )
