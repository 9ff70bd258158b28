"""Signs that hold at every point of a domain, from declared signs and sums of positive terms.

Comes in: an element, in a field that knows which symbols and elements are positive. Goes out: its
sign where it is certain. Where none is, the element may have any sign: nothing is guessed. A sum
has a sign if its terms have one, also once each symbol is measured from its bound, ``3 + q`` for
``q > 3``; so has a multiple of what is positive, and more.
Read next: `coadjoint.exact.relations`, `coadjoint.prove.ideals`, which drops factors that vanish
nowhere.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property
from typing import Any

from sympy.polys.rings import PolyElement

from coadjoint.elementary import ELEMENTARY
from coadjoint.exact.denominators import remove_factor
from coadjoint.exact.element import Element
from coadjoint.exact.factors import factors_of
from coadjoint.exact.field import Field
from coadjoint.exact.region import Condition

#: Terms of the largest sum in which terms are paired.
LARGEST_SUM = 100
#: Symbols of a quadratic form that is written as a sum of squares.
SQUARES = 12
#: What is known of a generator, by its place in the ring: 2 if it is positive, 1 if it is not
#: negative, 0 otherwise.
KnownSign = Callable[[int], int]


def sign_of_sum(p: PolyElement, known: KnownSign, *, strict: bool) -> int:
    """The sign of a sum of positive or of negative terms; 0 if it is none.

    A term without a sign of its own is made up for by two that have one, ``2*a*b`` by
    ``a^2 + b^2``: a mean of positive numbers is not less than their geometric one.

    Args:
        p: Not zero.
        known: Signs of generators; of one that has none, even powers are not negative.
        strict: Whether the sum may nowhere be 0: one term at least is a product of positive ones.
    """
    for side in (1, -1):
        left = _pair_off({e: side * c for e, c in p.terms()}, known)
        if left is None:
            continue
        if not strict or any(
            all(known(n) == 2 for n, e in enumerate(exponents) if e) for exponents in left
        ):
            return side
    return 0


def _pair_off(terms: dict[tuple[int, ...], Any], known: KnownSign) -> set[tuple[int, ...]] | None:
    """The positive terms that are left when each of the others has its pair; None without one."""
    positive = {
        e: c
        for e, c in terms.items()
        if c > 0 and all(known(n) for n, power in enumerate(e) if power % 2)
    }
    others = {e: c for e, c in terms.items() if e not in positive}
    if others and len(terms) > LARGEST_SUM:
        return None
    for mean, number in others.items():
        for first in list(positive):
            second = tuple(2 * m - e for m, e in zip(mean, first, strict=True))
            pair = positive.get(first, 0) * positive.get(second, 0)
            if first != second and 4 * pair >= number**2:
                del positive[first], positive[second]
                break
        else:
            return None
    return set(positive)


def sign(field: Field, element: Element, *, strict: bool = True) -> int:
    """The sign of an element wherever it is defined and the conditions of its field hold.

    Args:
        field: What knows the signs.
        element: Any element.
        strict: Whether it may nowhere be 0. Otherwise the sign is that of all its other values.

    Returns:
        1 or -1, or 0 where no sign is certain.

    >>> field = Field(["m", "q", "v"], slots=1, positive=["m"])
    >>> m, q, v = (field[name] for name in "mqv")
    >>> sign(field, m + q**2), sign(field, m * q**2), sign(field, m * q**2, strict=False)
    (1, 0, 1)
    >>> sign(field, m + m * field.call("sin", q) ** 2), sign(field, m - q**2)
    (1, 0)
    >>> sign(field, 2 * m + m * field.call("cos", q)), sign(field, m + m * field.call("cos", q))
    (1, 0)
    """
    whole = field.normal(element)
    if whole == 0:
        return 0
    return Signs(field, strict=strict).of(whole.combine())


class Signs:
    """What a field knows of signs.

    Args:
        field: The field.
        strict: Whether values may nowhere be 0.
        more: What holds in addition to the conditions of the field.
    """

    def __init__(self, field: Field, *, strict: bool, more: Sequence[Condition] = ()) -> None:
        self.field, self.strict, self._more = field, strict, more
        self._of_names: dict[str, int] = {}
        self._given = list(self._conditions())  # each with whether it may nowhere be 0

    def of(self, element: Element) -> int:
        """The sign of a nonzero element that is one quotient."""
        top, bottom = self.field.fraction(element)
        result = self._of_polynomial(top)
        for factor, exponent in bottom:  # nowhere 0 where the element is defined
            if exponent % 2:
                result *= Signs(self.field, strict=False)._of_polynomial(factor)
        return result

    def is_nonzero(self, element: Element, given: Sequence[Element] = ()) -> bool:
        """Whether a numerator is known to vanish nowhere, without a search for its factors.

        Args:
            element: Not zero.
            given: What vanishes nowhere.
        """
        positive = (p for p, strict in self._given if strict)
        whole = element.combine()
        top, _ = self.field.fraction(whole)
        others = (*map(self.field.from_polynomial, positive), *given)
        return bool(self._plain(top)) or is_factor(self.field, whole, others)

    def known(self, place: int) -> int:
        """What is known of the sign of a generator, as `sign_of_sum` asks."""
        name = self.field.generators[place]
        if name not in self._of_names:
            self._of_names[name] = self._of_generator(name)
        return self._of_names[name]

    def _of_generator(self, name: str) -> int:
        known = self.field.adjoined.get(name)
        if known is None:
            side, bound = self._bounds.get(name, (0, 0))
            return 2 * (side == 1 and bound >= 0)
        if known.function == "sqrt":
            argument = self.field.normal(known.argument)
            signs = Signs(self.field, strict=True, more=self._more)
            return 1 + (argument != 0 and signs.of(argument.combine()) == 1)
        return 2 * ELEMENTARY[known.function].is_positive

    def _conditions(self) -> Iterator[tuple[PolyElement, bool]]:
        """What the conditions of the field say is positive: monic, or minus a monic one."""
        for condition in (*self.field.region.conditions, *self._more):
            element = self.field.normal(condition.element).combine()
            if element == 0:
                continue
            top, bottom = self.field.fraction(element)
            if not bottom and not top.is_ground:
                yield (top.monic() if top.LC > 0 else -top.monic()), condition.strict

    def _of_polynomial(self, p: PolyElement) -> int:
        """The sign of a nonzero polynomial: of the whole, else the product of its factors'."""
        result = self._plain(p)
        if result:
            return result
        content, factors = factors_of(p)
        result = 1 if content > 0 else -1
        for factor, exponent in factors:
            if exponent % 2 or self.strict:
                single = self._plain(factor)
                result *= single if exponent % 2 else abs(single)
        return result

    def _plain(self, p: PolyElement) -> int:
        """The sign of a polynomial that conditions or its terms give."""
        for given, strict in self._given:
            if result := self._exceeds(p, given, strict=strict):
                return result
        for each, known in self._forms(p):
            if result := sign_of_sum(each, known, strict=self.strict):
                return result
        low, high = (self._bound(p, side) for side in (-1, 1))
        for bound, wanted in ((low, 1), (high, -1)):
            if bound and sign_of_sum(bound, self.known, strict=self.strict) == wanted:
                return wanted
        return 0

    def _exceeds(self, p: PolyElement, given: PolyElement, *, strict: bool) -> int:
        """The sign of a multiple of what is given, and more: ``q - 2`` is ``(q - 3) + 1``."""
        needed = self.strict and not strict  # then what is more keeps the whole from 0
        for exponents, number in given.terms():
            ratio = p.get(exponents, 0) / number
            if not ratio:
                continue
            rest, side = p - ratio * given, 1 if ratio > 0 else -1
            if rest and sign_of_sum(rest, self.known, strict=needed) == side:
                return side
            if not rest:
                return 0 if needed else side
        return 0

    def _bound(self, p: PolyElement, side: int) -> PolyElement:
        """A polynomial with sines and the like at their worst: ``2 + cos`` is at least ``2 - 1``.

        It bounds the given one from one side where what they multiply is not negative. Else that
        has no sign, and what a pair makes up for is its size: ``a*b*(1 + cos)`` may be ``2*a*b``.
        """
        known = self.field.adjoined.items()
        swinging = {name for name, f in known if ELEMENTARY[f.function].is_bounded}
        circular = [n for n, name in enumerate(self.field.generators) if name in swinging]
        fixed, swing = dict[tuple[int, ...], Any](), dict[tuple[int, ...], Any]()
        for exponents, number in p.terms():
            rest = tuple(0 if n in circular else e for n, e in enumerate(exponents))
            if rest == exponents:
                fixed[rest] = number
            else:
                swing[rest] = swing.get(rest, 0) + abs(number)
        terms = dict(fixed)
        for rest, most in swing.items():
            signed = all(self.known(n) for n, power in enumerate(rest) if power % 2)
            own = fixed.get(rest, 0)
            terms[rest] = own + side * most if signed else side * (abs(own) + most)
        return p.ring.from_dict({rest: number for rest, number in terms.items() if number})

    def _forms(self, p: PolyElement) -> Iterator[tuple[PolyElement, KnownSign]]:
        """A polynomial in several forms, each with what is known of its generators.

        It is taken as it is, with squares of cosines written by those of sines, and with each
        symbol measured from its bound: ``3 + q`` for ``q > 3``.
        """
        yield p, self.known
        swapped = self.field.write_in_sines(p)
        if swapped != p:
            yield swapped, self.known
        moved, measured = p, list[int]()
        for place, (side, bound) in self._measures(p):
            generator = p.ring.gens[place]
            moved = moved.compose(generator, bound + side * generator)
            measured.append(place)
        if moved != p:
            yield moved, lambda place: 2 if place in measured else self.known(place)

    def _measures(self, p: PolyElement) -> Iterator[tuple[int, tuple[int, Any]]]:
        """The bounds other than ``q > 0`` of the symbols of a polynomial outside of functions."""
        names = {name for name, d in zip(self.field.generators, p.degrees(), strict=True) if d > 0}
        called = [self.field.reach(self.field[name]) for name in names & self.field.adjoined.keys()]
        for name in names.difference(*called) & self._bounds.keys():
            if self._bounds[name] != (1, 0):
                yield self.field.generators.index(name), self._bounds[name]

    @cached_property
    def _bounds(self) -> dict[str, tuple[int, Any]]:
        """Bounds of symbols: the side on which they lie, and the bound: ``q > 3``, ``q < 3``."""
        result: dict[str, tuple[int, Any]] = dict.fromkeys(self.field.positive, (1, 0))
        for given, strict in self._given:
            places = [n for n, degree in enumerate(given.degrees()) if degree > 0]
            name = self.field.generators[places[0]]
            if not strict or len(places) > 1 or max(given.degrees()) > 1:
                continue
            if name not in self.field.adjoined:
                slope, side = given.LC, 1 if given.LC > 0 else -1
                bound = -given.get(given.ring.zero_monom, 0) / slope
                known = result.get(name)
                if known is None or (known[0] == side == 1 and bound > known[1]):
                    result[name] = side, bound
        return result

    # -- sums of squares ------------------------------------------------------------------

    def squares(self, element: Element) -> list[Element]:
        """What vanishes together where a sum of squares does; nothing where it is none.

        Addends of one sign, as in ``x^4 + a*y^2`` for positive a, or those of a quadratic form:
        ``x^2 + x*y + y^2`` is ``(x + y/2)^2 + 3*y^2/4``. Of one with a constant of the same sign,
        which vanishes nowhere, that is 1.
        """
        addends = self.field.terms(element)
        if len(addends) > 1 and self._has_addends_of_one_sign(element):
            return list(addends)
        return complete_squares(self.field, element)

    def _has_addends_of_one_sign(self, element: Element) -> bool:
        """Whether no addend of a polynomial is negative, or none positive."""
        if len(element.parts) != 1 or element.parts[0].powers:
            return False
        top, _ = self.field.fraction(element)
        return len({number > 0 for number in top.values()}) == 1 and all(
            self.known(n) for exponents in top for n, e in enumerate(exponents) if e % 2
        )


def is_factor(field: Field, element: Element, others: Iterable[Element]) -> bool:
    """Whether a numerator is a factor of one of those of some others."""
    own, _ = field.fraction(element.combine())
    tops = (field.fraction(part)[0] for part in map(Element.combine, others) if part.parts)
    return any(remove_factor(top, own, 1)[0] > 0 for top in tops)


def complete_squares(field: Field, element: Element) -> list[Element]:
    """The linear polynomials whose squares a definite quadratic one is the sum of."""
    names = sorted(field.reach(element), key=field.names.index)
    if not 0 < len(names) <= SQUARES or not field.is_function_free(element):
        return []
    if field.normal(element).combine().parts[0].powers:
        return []
    rest, result, sign = element, list[Element](), 0
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
        result.append(slope)
        rest = field.normal(rest - slope**2 / (2 * curve))
    number = field.as_number(rest)
    if number is None or not result or number * sign < 0:
        return []
    return [field.one] if number else result if len(result) > 1 else []
