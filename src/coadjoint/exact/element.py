"""Elements of the field: a polynomial over a product of powers of known factors.

Comes in: polynomials of one SymPy ring over Q. Goes out: exact ``+ - * /`` whose result is zero
just when its numerator is. Denominators of mechanics are products of few factors (moments of
inertia, small determinants), so they are kept as such and cancelled by trial division: no
polynomial gcd is ever taken. With SymPy's `FracField`, which takes one at each step, the energy of
the Kirchhoff vehicle took 5.6 s; this way it takes a tenth.
Read next: `coadjoint.exact.field`.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from functools import reduce
from operator import le, mul, sub
from typing import Any

from sympy.polys.domains import QQ
from sympy.polys.rings import PolyElement, PolyRing


class Factors:
    """The polynomials that occur in denominators, numbered in the order of first use."""

    def __init__(self, ring: PolyRing) -> None:
        self.ring = ring
        self.known: list[PolyElement] = []

    def split(self, p: PolyElement) -> tuple[Any, dict[int, int]]:
        """``p = constant * product of known factors``, registering what is new.

        Powers of single generators are split off, then factors seen before; what is left becomes a
        new factor, whole: it need not be irreducible.
        """
        powers: dict[int, int] = {}
        for generator in self.ring.gens:
            count, p = remove_factor(p, generator)
            if count:
                powers[self._number(generator)] = count
        for number, factor in enumerate(self.known):
            count, p = remove_factor(p, factor)
            if count:
                powers[number] = powers.get(number, 0) + count
        constant = p.LC
        if not p.is_ground:
            powers[self._number(p.monic())] = 1
        return constant, powers

    def product(self, powers: Mapping[int, int]) -> PolyElement:
        """The product of powers of known factors."""
        return reduce(mul, (self.known[n] ** e for n, e in sorted(powers.items())), self.ring.one)

    def _number(self, factor: PolyElement) -> int:
        if factor not in self.known:
            self.known.append(factor)
        return self.known.index(factor)


def remove_factor(
    p: PolyElement, factor: PolyElement, most: int = 10**6
) -> tuple[int, PolyElement]:
    """How often, up to a number of times, a factor divides a nonzero polynomial; what is left."""
    count = 0
    while count < most and (quotient := _quotient(p, factor)) is not None:
        count, p = count + 1, quotient
    return count, p


def _quotient(p: PolyElement, factor: PolyElement) -> PolyElement | None:
    """``p / factor`` if the division is exact, else None, mostly found at the first look.

    Nearly every trial fails, and SymPy's `div` would go on to a remainder that nobody wants: this
    loop gives up at the first term that the factor does not divide.
    """
    if len(factor) == 1:
        if not all(_divides(factor.LM, monomial) for monomial in p):
            return None
        return p.quo_term((factor.LM, factor.LC))
    if not (_divides(factor.LM, max(p)) and _divides(min(factor), min(p))):
        return None
    quotient, rest = p.ring.zero, p
    while rest:
        lead = max(rest)
        if not _divides(factor.LM, lead):
            return None
        step = tuple(map(sub, lead, factor.LM)), rest[lead] / factor.LC
        quotient[step[0]] = step[1]
        rest = rest - factor.mul_term(step)
    return quotient


def _divides(a: tuple[int, ...], b: tuple[int, ...]) -> bool:
    """Whether one monomial divides another; in the order lex, tuples compare as monomials do."""
    return all(map(le, a, b))


class Element:
    """An exact rational function; make one through a `Field`, then use ``+ - * / **``.

    Attributes:
        numer: The numerator, a polynomial over Q.
        powers: Exponents of the factors of the denominator, by their number; none divides `numer`.
    """

    __slots__ = ("factors", "numer", "powers")

    def __init__(self, factors: Factors, numer: PolyElement, powers: Mapping[int, int]) -> None:
        self.factors = factors
        kept = {}
        for number, exponent in powers.items() if numer else ():
            count, numer = remove_factor(numer, factors.known[number], exponent)
            if exponent > count:
                kept[number] = exponent - count
        self.numer = numer
        self.powers = kept

    @property
    def denom(self) -> PolyElement:
        """The denominator, multiplied out."""
        return self.factors.product(self.powers)

    def _coerce(self, other: object) -> Element | None:
        """A number as an element; None for what does not belong here."""
        if isinstance(other, Element):
            return other
        if isinstance(other, int | Fraction):
            exact = Fraction(other)
            ground = QQ(exact.numerator, exact.denominator)
            return Element(self.factors, self.factors.ring.ground_new(ground), {})
        return None

    def __add__(self, other: object) -> Element:
        right = self._coerce(other)
        if right is None:
            return NotImplemented
        if self.powers == right.powers:
            return Element(self.factors, self.numer + right.numer, self.powers)
        numbers = sorted(self.powers.keys() | right.powers.keys())
        common = {n: max(self.powers.get(n, 0), right.powers.get(n, 0)) for n in numbers}
        return Element(self.factors, self._over(common) + right._over(common), common)

    def _over(self, common: Mapping[int, int]) -> PolyElement:
        """The numerator over a common denominator."""
        missing = {n: e - self.powers.get(n, 0) for n, e in common.items()}
        missing = {n: e for n, e in missing.items() if e}
        return self.numer * self.factors.product(missing) if missing else self.numer

    def __mul__(self, other: object) -> Element:
        right = self._coerce(other)
        if right is None:
            return NotImplemented
        numbers = sorted(self.powers.keys() | right.powers.keys())
        powers = {n: self.powers.get(n, 0) + right.powers.get(n, 0) for n in numbers}
        return Element(self.factors, self.numer * right.numer, powers)

    def inverse(self) -> Element:
        """``1 / self``.

        Raises:
            ZeroDivisionError: The element is zero.
        """
        if not self.numer:
            raise ZeroDivisionError("the inverse of the zero element")
        constant, powers = self.factors.split(self.numer)
        return Element(self.factors, self.denom * (QQ(1) / constant), powers)

    def __neg__(self) -> Element:
        return Element(self.factors, -self.numer, self.powers)

    def __pos__(self) -> Element:
        return self

    def __sub__(self, other: object) -> Element:
        right = self._coerce(other)
        return NotImplemented if right is None else self + (-right)

    def __rsub__(self, other: object) -> Element:
        left = self._coerce(other)
        return NotImplemented if left is None else left - self

    def __truediv__(self, other: object) -> Element:
        right = self._coerce(other)
        return NotImplemented if right is None else self * right.inverse()

    def __rtruediv__(self, other: object) -> Element:
        left = self._coerce(other)
        return NotImplemented if left is None else left * self.inverse()

    __radd__ = __add__
    __rmul__ = __mul__

    def __pow__(self, exponent: int) -> Element:
        if exponent < 0:
            return self.inverse() ** -exponent
        powers = {n: e * exponent for n, e in self.powers.items()} if exponent else {}
        return Element(self.factors, self.numer**exponent, powers)

    def __eq__(self, other: object) -> bool:
        right = self._coerce(other)
        return NotImplemented if right is None else not (self - right).numer

    def __hash__(self) -> int:
        # Equal elements may be written over different factors, so only numbers share a hash.
        return hash(self.numer) if not self.powers else 0

    def __bool__(self) -> bool:
        return bool(self.numer)

    def diff(self, generator: PolyElement) -> Element:
        """Partial derivative by a generator of the ring, by the quotient rule on the factors."""
        result = Element(self.factors, self.numer.diff(generator), self.powers)
        for number, exponent in self.powers.items():
            slope = self.factors.known[number].diff(generator)
            if slope:
                powers = {**self.powers, number: self.powers[number] + 1}
                result += Element(self.factors, self.numer * slope * -exponent, powers)
        return result

    def _sympy_(self) -> Any:
        """What SymPy makes of the element: numerator over the product of factors."""
        result = self.numer.as_expr()
        for number, exponent in sorted(self.powers.items()):
            result = result / self.factors.known[number].as_expr() ** exponent
        return result

    def __repr__(self) -> str:
        return str(self._sympy_())
