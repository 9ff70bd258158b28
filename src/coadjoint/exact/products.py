"""Roots and logarithms of products: what of them is independent, with signs as they follow.

Comes in: elements of a ring. Goes out: their roots and logarithms, with as few new generators as
the factors of the elements allow. ``sqrt(a)*sqrt(b) = sqrt(a*b)`` where both sides are real,
``sqrt(a^2) = |a|``, ``log(a*b) = log|a| + log|b|``.
Read next: `coadjoint.exact.relations`, which rewrites the functions of a field so.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from operator import mul

from coadjoint.exact.element import Element, numerator
from coadjoint.exact.factors import (
    Factor,
    Powers,
    SignRow,
    eliminate_signs,
    factors_of,
    multiply,
    number_factors,
    odd_factors,
    reduce_signs,
    to_fraction,
)
from coadjoint.exact.field import Field
from coadjoint.exact.signs import sign_of_sum


@dataclass(frozen=True)
class Radical:
    """A function whose square is a product of others.

    Attributes:
        value: The function.
        square: Its square.
        signed: Whether it may be negative, as a sine; a root is not.
    """

    value: Element
    square: Powers
    signed: bool = False


class Products:
    """A ring with generators for roots, signs and logarithms, which are made as they are needed.

    Args:
        ring: The field of the symbols and of the generators.
        free: The generators that may be used.
        exponent_of: The argument of the exponential that a factor is; None for other factors.
    """

    def __init__(
        self, ring: Field, free: Iterable[str], exponent_of: Callable[[Factor], Element | None]
    ) -> None:
        self.ring, self._free, self._exponent_of = ring, list(free), exponent_of
        self._positive = set(ring.positive)
        self._squares: dict[str, Element] = {}
        self._minimal: dict[str, Sequence[Fraction]] = {}
        self._radicals: list[Radical] = []
        self._signs: dict[Factor, Element] = {}
        self._logarithms: dict[Factor, Element] = {}
        self._rows: list[SignRow] = []

    def new(self, *, positive: bool = False, square: Element | None = None) -> Element:
        """A new generator.

        Raises:
            OverflowError: There are more factors than the ring has room for.
        """
        if not self._free:
            raise OverflowError("no generator left")
        name = self._free.pop(0)
        if positive:
            self._positive.add(name)
        if square is not None:
            self._squares[name] = square
        return self.ring[name]

    def circle(self) -> tuple[Element, Element]:
        """Cosine and sine of a new angle."""
        cosine = self.new()
        sine = self.new(square=1 - cosine**2)
        self._radicals.append(Radical(sine, self.factor(1 - cosine**2), signed=True))
        return cosine, sine

    def algebraic(self, minimal: Sequence[Fraction]) -> Element:
        """A new generator that is a root of a monic polynomial, the highest power first."""
        result = self.new()
        (name,) = self.ring.names_in(result)
        self._minimal[name] = minimal
        return result

    def know_root(self, root: Element, radicand: Element) -> None:
        """Take an element, which is not negative, for the root of a positive one."""
        square = self.factor(radicand)
        self._radicals.append(Radical(root, square))

    def normalize(self, element: Element, values: Mapping[str, Element] | None = None) -> Element:
        """An element with squares replaced, and signs that are known."""
        if values:
            element = self.ring.substitute(element, values)
        for name in reversed(self._squares):
            element = self.ring.reduce_squares(element.combine(), name, self._squares[name])
        for name, coefficients in self._minimal.items():
            element = self.ring.reduce_modulo(element.combine(), name, coefficients)
        return element.combine()

    def derive_signs(self) -> dict[str, Element]:
        """The signs of factors by others, as all that is positive together says."""
        rows = eliminate_signs(self._rows, list(self._signs))
        result = {}
        for factor, generator in self._signs.items():
            left, number = reduce_signs(frozenset([factor]), rows)
            if left != {factor} and left <= self._signs.keys():
                value = reduce(mul, (self._signs[f] for f in left), self.ring.one)
                result[str(generator)] = value * (-1) ** number
        return result

    # -- roots ----------------------------------------------------------------------------

    def root(self, radicand: Element) -> Element:
        """The square root of an element."""
        if radicand == 0:
            return radicand
        vector = self.factor(radicand)
        self.note_positive(vector)
        odd, members = self._reduce_by_radicals(odd_factors(vector))
        if odd:
            return self._new_root(vector)
        for radical in members:
            vector = multiply(vector, radical.square)
        whole = self._absolute({f: e // 2 for f, e in vector.items()})
        for radical in members:
            value = radical.value
            if radical.signed:
                value = value * self._sign_of({numerator(value): 1})
            whole = whole * value / self._multiply(radical.square)
        return self.normalize(whole)

    def _new_root(self, vector: Powers) -> Element:
        """A root that no others give: its square factors come out, the rest is a generator."""
        inner = dict.fromkeys(odd_factors(vector), 1)
        outer = self._absolute({f: e // 2 for f, e in vector.items()})
        root = self.new(positive=True, square=self._multiply(inner))
        self._radicals.append(Radical(root, inner))
        return self.normalize(outer * root)

    def _reduce_by_radicals(
        self, odd: frozenset[Factor]
    ) -> tuple[frozenset[Factor], list[Radical]]:
        """What is left of a product of factors modulo squares and radicands, and which of these."""
        rows: list[tuple[Factor, frozenset[Factor], frozenset[int]]] = []
        for n, radical in enumerate(self._radicals):
            rest, used = odd_factors(radical.square), frozenset([n])
            for pivot, row, members in rows:
                if pivot in rest:
                    rest, used = rest ^ row, used ^ members
            if rest:
                rows.append((min(rest, key=str), rest, used))
        chosen = frozenset[int]()
        for pivot, row, members in rows:
            if pivot in odd:
                odd, chosen = odd ^ row, chosen ^ members
        return odd, [self._radicals[n] for n in sorted(chosen)]

    def _absolute(self, vector: Powers) -> Element:
        """The absolute value of a product of powers of factors."""
        positive = {f: e for f, e in vector.items() if f != -1}
        return self._multiply(positive) * self._sign_of(positive)

    def sign_of(self, element: Element) -> Element:
        """The sign of an element other than 0."""
        return self.normalize(self._sign_of(self.factor(element)))

    def _sign_of(self, vector: Powers) -> Element:
        """The sign of a product: a number, or a product of generators of square 1."""
        rest, number = self._plain_signs(odd_factors(vector))
        signs = [self._sign_generator(f) for f in sorted(rest, key=str)]
        return reduce(mul, signs, self.ring.number((-1) ** number))

    def _sign_generator(self, factor: Factor) -> Element:
        """The sign of a factor."""
        if factor not in self._signs:
            self._signs[factor] = self.new(square=self.ring.one)
        return self._signs[factor]

    def _plain_signs(self, factors: frozenset[Factor]) -> tuple[frozenset[Factor], int]:
        """The factors without a sign of their own, and how many others are negative."""
        left, number = frozenset[Factor](), 0
        signs = {numerator(sign): factor for factor, sign in self._signs.items()}
        for factor in factors:
            result = self._own_sign(factor)
            number += result < 0
            if not result:
                left ^= {signs.get(factor, factor)}  # a sign has that of its factor
        return left, number % 2

    def _own_sign(self, factor: Factor) -> int:
        """The sign of a factor that its terms show; of one that may be 0, its other values'."""
        if isinstance(factor, int):
            return 1 if factor > 0 else -1
        generators = self.ring.generators
        return sign_of_sum(factor, lambda n: 2 * (generators[n] in self._positive), strict=False)

    def note_positive(self, vector: Powers) -> None:
        """Remember that a product of powers of factors is positive."""
        left, number = self._plain_signs(odd_factors(vector))
        if left:
            self._rows.append((left, number))

    # -- logarithms -----------------------------------------------------------------------

    def logarithm(self, argument: Element) -> Element:
        """The sum of the logarithms of the absolute values of factors."""
        if argument == 0:
            raise ZeroDivisionError("the logarithm of 0")
        vector = self.factor(argument)
        self.note_positive(vector)
        parts = [self._logarithm_of(f) * e for f, e in vector.items()]
        return self.normalize(self.ring.sum(parts))

    def _logarithm_of(self, factor: Factor) -> Element:
        """The logarithm of the absolute value of a factor."""
        if factor == -1 or factor in map(numerator, self._signs.values()):
            return self.ring.zero
        if (exponent := self._exponent_of(factor)) is not None:
            return exponent
        for radical in self._radicals:
            if factor == numerator(radical.value) and not radical.signed:
                parts = [self._logarithm_of(f) * e for f, e in radical.square.items()]
                return self.ring.sum(parts) / 2
            *others, last = sorted(radical.square, key=str)
            if radical.signed and factor == last:  # log|1 - cos| = 2 log|sin| - log|1 + cos|
                sine = self._logarithm_of(numerator(radical.value))
                return 2 * sine - self.ring.sum(map(self._logarithm_of, others))
        if factor not in self._logarithms:
            self._logarithms[factor] = self.new()
        return self._logarithms[factor]

    # -- factors --------------------------------------------------------------------------

    def factor(self, element: Element) -> Powers:
        """A nonzero element as powers of factors."""
        top, bottom = self.ring.fraction(element.combine())
        vector: Powers = {}
        for p, power in [(top, 1), *((p, -e) for p, e in bottom)]:
            content, factors = factors_of(p)
            numbers = number_factors(to_fraction(content))
            vector = multiply(vector, {f: e * power for f, e in numbers.items()})
            vector = multiply(vector, {f: e * power for f, e in factors})
        return vector

    def _multiply(self, vector: Powers) -> Element:
        """The product of powers of factors."""
        return product(
            self.ring,
            (
                (self.ring.number(f) if isinstance(f, int) else self.ring.from_polynomial(f), e)
                for f, e in vector.items()
            ),
        )


def product(ring: Field, powers: Iterable[tuple[Element, int]]) -> Element:
    """The product of powers."""
    return reduce(mul, (base**e for base, e in powers if e), ring.one)
