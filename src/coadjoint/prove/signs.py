"""Signs: polynomials that vanish nowhere, by what is declared of their symbols.

Comes in: the region that is assumed of a field. Goes out: whether a polynomial vanishes nowhere in
it. The answer "no" means that no reason was found. A polynomial has no zero where all its addends
have one sign, once each symbol is measured from its bound, ``q = 3 + q'`` for ``q > 3``; and
neither have the factors of what is declared to be positive.
Read next: `coadjoint.prove.ideals`, which drops such factors.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cached_property

from coadjoint.exact import Element, Field
from coadjoint.exact.element import remove_factor

#: Symbols of a quadratic form that is written as a sum of squares.
SQUARES = 12


class Signs:
    """What is known of signs.

    Args:
        field: With its region.
    """

    def __init__(self, field: Field) -> None:
        self.field = field

    def is_nonzero(self, element: Element, given: Sequence[Element] = ()) -> bool:
        """Whether a polynomial is known to vanish nowhere; some others are given not to."""
        known = self._positive
        return (
            self._has_sign(element)
            or self.is_factor(element, (*given, *known))
            or any(self._exceeds(element, each) for each in known)
        )

    def _exceeds(self, element: Element, other: Element) -> bool:
        """Whether an element is a multiple of a positive one, and more of the same sign.

        ``x^2 + y^2`` is ``(x^2 + y^2 - 1) + 1``.
        """
        (own,), (known,) = element.combined().parts, other.combined().parts
        if known.powers:
            return False
        ratio = own.numer.get(known.numer.LM, 0) / known.numer.LC
        if not ratio:
            return False
        number = Fraction(int(ratio.numerator), int(ratio.denominator))
        sign = self._sign(self.field.normal(element - other * number))
        return sign is not None and sign * number >= 0

    def is_factor(self, element: Element, others: Sequence[Element]) -> bool:
        """Whether an element is a factor of the numerator of one of some others."""
        (own,) = element.combined().parts
        parts = (quotient for other in others for quotient in other.combined().parts)
        return any(remove_factor(whole.numer, own.numer, 1)[0] > 0 for whole in parts)

    @cached_property
    def _positive(self) -> tuple[Element, ...]:
        """What is declared to be positive."""
        known = (*self.field.region.conditions, *self.field.region.bounds)
        return tuple(each.element for each in known if each.strict)

    @cached_property
    def _bounds(self) -> dict[str, tuple[int, Fraction]]:
        """Bounds of symbols: the side on which they lie, and the bound."""
        found = {name: (1, Fraction(0)) for name in self.field.positive}
        for name, side, bound in self._linear_bounds():
            known = found.get(name)
            if known is None or (known[0] == side == 1 and bound > known[1]):
                found[name] = side, bound
        return found

    def _linear_bounds(self) -> Iterator[tuple[str, int, Fraction]]:
        """``q > 3`` and ``q < 3`` among the strict conditions."""
        for value in self._positive:
            names = sorted(self.field.reach(value))
            if len(names) != 1 or not self.field.function_free(value):
                continue
            slope = self.field.as_number(self.field.derivative(value, names[0]))
            if slope:
                rest = self.field.substitute(value, {names[0]: self.field.zero})
                start = self.field.as_number(rest)
                assert start is not None, value
                yield names[0], 1 if slope > 0 else -1, -start / slope

    def _has_sign(self, element: Element) -> bool:
        """Whether all addends have one sign, and one of them vanishes nowhere."""
        moved = self._from_bounds(element)
        return self._sign(element) not in (None, 0) and any(
            all(self._is_positive(name, element) for name in powers)
            for _, powers in self._addends(moved)
        )

    def _sign(self, element: Element) -> int | None:
        """The sign that all addends have where they do not vanish; 0 of zero, None if none."""
        moved = self._from_bounds(element)
        if any(part.powers for part in moved.parts):
            return None
        addends = self._addends(moved)
        signs = {1 if number > 0 else -1 for number, _ in addends}
        powers = [each for _, part in addends for each in part.items()]
        if len(signs) > 1 or not all(
            e % 2 == 0 or self._is_positive(name, element) for name, e in powers
        ):
            return None
        return signs.pop() if signs else 0

    def _addends(self, element: Element) -> list[tuple[Fraction, dict[str, int]]]:
        """The addends of a polynomial: numbers, and powers by name."""
        written = self.field.quotients(element)
        return [(each.number, dict(each.powers)) for part in written for each in part.monomials]

    def _from_bounds(self, element: Element) -> Element:
        """An element with each symbol measured from its bound: ``3 + q`` for ``q > 3``."""
        moved = {
            name: self.field.number(bound) + side * self.field[name]
            for name, (side, bound) in self._bounds.items()
            if (side != 1 or bound) and not self._is_called(element, name)
        }
        return self.field.substitute(element, moved)

    def _is_called(self, element: Element, name: str) -> bool:
        """Whether a function of a symbol occurs."""
        called = self.field.functions_in(element)
        return any(name in self.field.reach(self.field.adjoined[g].argument) for g in called)

    def _is_positive(self, name: str, element: Element) -> bool:
        """Whether a symbol, as it is measured in an element, or a function is positive."""
        known = self.field.adjoined.get(name)
        if known is not None:
            return known.function == "exp" or (
                known.function == "sqrt" and self.is_nonzero(known.argument)
            )
        side, bound = self._bounds.get(name, (0, Fraction(0)))
        if self._is_called(element, name):  # it is not measured from its bound
            return side == 1 and bound >= 0
        return side != 0

    def argument(self, element: Element) -> Element | None:
        """The argument of an element that is a square root."""
        for known in self.field.adjoined.values():
            if known.function == "sqrt" and element == self.field[known.generator]:
                return known.argument
        return None

    def squares(self, element: Element) -> list[Element]:
        """What vanishes together where a sum of squares does; nothing where it is none.

        Addends of one sign, as in ``x^4 + a*y^2`` for positive a, or those of a quadratic form:
        ``x^2 + x*y + y^2`` is ``(x + y/2)^2 + 3*y^2/4``. Of one with a constant of the same sign,
        which vanishes nowhere, that is 1.
        """
        addends = self.field.terms(element)
        if len(addends) > 1 and self._from_bounds(element) == element and self._sign(element):
            return list(addends)
        return self._completed_squares(element)

    def _completed_squares(self, element: Element) -> list[Element]:
        """The linear polynomials whose squares a definite quadratic one is the sum of."""
        field, names = self.field, sorted(self.field.reach(element), key=self.field.names.index)
        if not 0 < len(names) <= SQUARES or not field.function_free(element):
            return []
        if field.normal(element).combined().parts[0].powers:
            return []
        rest, found, sign = element, list[Element](), 0
        for name in names:
            slope = field.derivative(rest, name)
            curve = field.as_number(field.derivative(slope, name))
            if curve is None:
                return []
            if curve == 0:
                if field.normal(slope) != 0:
                    return []
                continue
            if sign * curve < 0:
                return []
            sign = 1 if curve > 0 else -1
            found.append(slope)
            rest = field.normal(rest - slope**2 / (2 * curve))
        number = field.as_number(rest)
        if number is None or not found or number * sign < 0:
            return []
        return [field.one] if number else found if len(found) > 1 else []
