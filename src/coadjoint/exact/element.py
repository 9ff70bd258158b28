"""Elements of the field: sums of quotients, each over a product of powers of known factors.

Comes in: polynomials of one SymPy ring over Q. Goes out: exact ``+ - * /`` with a decidable zero.
Denominators of mechanics are products of few factors (moments of inertia, small determinants), so
they are kept as such and cancelled by trial division: no polynomial gcd is ever taken. With SymPy's
`FracField`, which takes one at each step, the energy of the Kirchhoff vehicle took 5.6 s; this way
it takes a tenth. Quotients over different factors stay apart: the energy of the free body in eight
dimensions has the 28 denominators ``a_i + a_j``, and their product would have millions of terms.
Read next: `coadjoint.exact.field`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from operator import add, itemgetter, mul
from typing import Any

from sympy.polys.domains import QQ
from sympy.polys.rings import PolyElement

from coadjoint.exact.denominators import Factors
from coadjoint.exact.polynomials import multiply

#: Numbers of the factors, other than single symbols, in the denominator of a quotient.
Support = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Quotient:
    """A nonzero polynomial over a product of powers of factors.

    Attributes:
        numer: The numerator, a polynomial over Q.
        powers: Exponents of the factors of the denominator, by their number; none divides `numer`.
    """

    numer: PolyElement
    powers: Mapping[int, int]

    def over(self, common: Mapping[int, int], factors: Factors) -> PolyElement:
        """The numerator over a common denominator."""
        if common == self.powers:
            return self.numer
        missing = {n: e - self.powers.get(n, 0) for n, e in common.items()}
        missing = {n: e for n, e in missing.items() if e}
        if not missing:
            return self.numer
        product = factors.product(missing)
        factors.spend(len(self.numer) * len(product))
        return multiply(self.numer, product)

    def order(self) -> tuple[Any, ...]:
        """Where it stands in a sum: by its leading monomial, the greatest first."""
        return (*(-exponent for exponent in self.numer.LM), *sorted(self.powers.items()))


class Element:
    """An exact rational function; make one through a `Field`, then use ``+ - * / **``."""

    __slots__ = ("_parts", "_sorted", "factors")

    def __init__(
        self, factors: Factors, quotients: Iterable[tuple[PolyElement, Mapping[int, int]]]
    ) -> None:
        self.factors = factors
        self._parts: dict[Support, Quotient] = {}
        self._sorted: tuple[Quotient, ...] | None = None
        for numer, powers in quotients:
            self._insert(numer, powers)

    def _with(self, parts: Mapping[Support, Quotient]) -> Element:
        """An element of quotients from which everything is cancelled."""
        result = Element(self.factors, [])
        result._parts = dict(parts)
        return result

    def _scale(self, number: Any) -> Element:
        """The element times a nonzero number."""
        return self._with(
            {s: Quotient(q.numer.mul_ground(number), q.powers) for s, q in self._parts.items()}
        )

    def _insert(self, numer: PolyElement, powers: Mapping[int, int]) -> None:
        """Add a quotient: to the one with the same factors, or as a further one."""
        while numer:
            kept, support = {}, []
            for number, exponent in powers.items():
                count, numer = self.factors.remove(numer, number, exponent)
                if exponent > count:
                    kept[number] = exponent - count
                    if not self.factors.monomial[number]:
                        support.append(number)
            new, other = Quotient(numer, kept), self._parts.pop(tuple(sorted(support)), None)
            if other is None:
                self._parts[tuple(sorted(support))] = new
                return
            numer, powers = self._sum([new, other])

    def _sum(self, quotients: Collection[Quotient]) -> tuple[PolyElement, dict[int, int]]:
        """Numerator and denominator of a nonempty sum over the common denominator."""
        common: dict[int, int] = {}
        for quotient in quotients:
            for number, exponent in quotient.powers.items():
                common[number] = max(common.get(number, 0), exponent)
        return reduce(add, (quotient.over(common, self.factors) for quotient in quotients)), common

    @property
    def parts(self) -> tuple[Quotient, ...]:
        """The quotients whose sum the element is, in the order of the ring."""
        if self._sorted is None:
            several = len(self._parts) > 1
            parts = self._parts.values()
            self._sorted = tuple(sorted(parts, key=Quotient.order) if several else parts)
        return self._sorted

    @property
    def is_polynomial(self) -> bool:
        """Whether there are no denominators, so that equal elements have equal hashes."""
        return not any(quotient.powers for quotient in self._parts.values())

    def combine(self) -> Element:
        """The same element as a single quotient, or zero."""
        if len(self._parts) < 2:
            return self
        numer, powers = self._sum(self._parts.values())
        return Element(self.factors, [(numer, powers)])

    def _coerce(self, other: object) -> Element | None:
        """A number as an element; None for what does not belong here."""
        if isinstance(other, Element):
            return other
        if isinstance(other, int | Fraction):
            ground = QQ(other.numerator, other.denominator)
            return Element(self.factors, [(self.factors.ring.ground_new(ground), {})])
        return None

    def _pairs(self) -> list[tuple[PolyElement, Mapping[int, int]]]:
        return [(quotient.numer, quotient.powers) for quotient in self._parts.values()]

    def _terms(self) -> int:
        """How many terms its numerators have."""
        return sum(len(quotient.numer) for quotient in self._parts.values())

    def __add__(self, other: object) -> Element:
        right = self._coerce(other)
        if right is None:
            return NotImplemented
        result = self._with(self._parts)
        for support, quotient in right._parts.items():
            if support in result._parts:
                result._insert(quotient.numer, quotient.powers)
            else:  # cancelled already
                result._parts[support] = quotient
        return result

    def __mul__(self, other: object) -> Element:
        if isinstance(other, int | Fraction) and other:
            return self._scale(QQ(other.numerator, other.denominator))
        right = self._coerce(other)
        if right is None:
            return NotImplemented
        self.factors.spend(self._terms() * right._terms())
        return Element(
            self.factors,
            [
                (
                    multiply(a, b),
                    {n: p.get(n, 0) + q.get(n, 0) for n in sorted(p.keys() | q.keys())},
                )
                for a, p in self._pairs()
                for b, q in right._pairs()
            ],
        )

    def inverse(self) -> Element:
        """``1 / self``.

        Raises:
            ZeroDivisionError: The element is zero, also by what the field knows of its functions.
        """
        whole = self.combine()
        if not whole._parts or self.factors.is_hidden_zero(whole):
            raise ZeroDivisionError("the inverse of the zero element")
        (quotient,) = whole._parts.values()
        constant, powers = self.factors.split(quotient.numer)
        denom = self.factors.product(quotient.powers)
        one = self.factors.ring.domain.one
        return Element(self.factors, [(denom * (one / constant), powers)])

    def __neg__(self) -> Element:
        return self._with({s: Quotient(-q.numer, q.powers) for s, q in self._parts.items()})

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
        if len(self._parts) == 1 and exponent:
            (quotient,) = self._parts.values()
            powers = {n: e * exponent for n, e in quotient.powers.items()}
            return Element(self.factors, [(quotient.numer**exponent, powers)])
        one = Element(self.factors, [(self.factors.ring.one, {})])
        return reduce(mul, [self] * exponent, one)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, int) and other == 0:
            return not self
        right = self._coerce(other)
        if right is None:
            return NotImplemented
        if self._parts == right._parts:
            return True
        return not self._is_over(right) and not (self - right)

    def _is_over(self, other: Element) -> bool:
        """Whether two elements are single quotients over one denominator: numerators decide."""
        own, others = self._parts.values(), other._parts.values()
        return [q.powers for q in own] == [q.powers for q in others] and len(own) == 1

    def __hash__(self) -> int:
        # Equal elements may be written over different factors, so only polynomials share a hash.
        (quotient, *others) = self._parts.values() or [Quotient(self.factors.ring.zero, {})]
        return hash(quotient.numer) if not quotient.powers and not others else 0

    def __bool__(self) -> bool:
        """Whether the element is not zero: exact.

        Symbols that no denominator has are independent of the denominators, so the coefficients of
        their monomials vanish one by one: common denominators stay small.
        """
        if len(self._parts) < 2:
            return bool(self._parts)
        inside = {place for part in self._parts.values() for place in self._places(part.powers)}
        outside = [n for n in range(self.factors.ring.ngens) if n not in inside]
        # Two more places, so that there is a tuple whatever is outside.
        outer = itemgetter(slice(0), slice(0), *outside)
        coefficients: dict[Any, list[Quotient]] = {}
        for part in self._parts.values():
            terms: dict[Any, dict[tuple[int, ...], Any]] = {}
            for monomial, number in part.numer.items():
                terms.setdefault(outer(monomial), {})[monomial] = number
            for key, inner in terms.items():
                quotient = Quotient(self.factors.ring.from_dict(inner), part.powers)
                coefficients.setdefault(key, []).append(quotient)
        if any(len(quotients) == 1 for quotients in coefficients.values()):
            return True
        return any(bool(self._sum(quotients)[0]) for quotients in coefficients.values())

    def _places(self, numbers: Iterable[int]) -> Iterator[int]:
        """Places of the generators that occur in factors."""
        for number in numbers:
            for monomial in self.factors.known[number]:
                yield from (place for place, exponent in enumerate(monomial) if exponent)

    def diff(self, place: int) -> Element:
        """Partial derivative by the generator at a place, by the quotient rule on the factors."""
        quotients: list[tuple[PolyElement, Mapping[int, int]]] = []
        for numer, powers in self._pairs():
            self.factors.spend(len(numer) * (1 + len(powers)))
            if any(monomial[place] for monomial in numer):
                quotients.append((numer.diff(place), powers))
            for number, exponent in powers.items():
                slope = self.factors.slope(number, place)
                if slope:
                    self.factors.spend(len(numer) * len(slope))
                    raised = {**powers, number: exponent + 1}
                    quotients.append((numer * slope * -exponent, raised))
        return Element(self.factors, quotients)

    def _sympy_(self) -> Any:
        """What SymPy makes of the element: a sum of numerators over products of factors."""
        return reduce(
            add, map(self._quotient_as_expr, self.parts), self.factors.ring.zero.as_expr()
        )

    def _quotient_as_expr(self, quotient: Quotient) -> Any:
        result = self._as_expr(quotient.numer)
        for number, exponent in sorted(quotient.powers.items()):
            result = result / self._as_expr(self.factors.known[number]) ** exponent
        return result

    def _as_expr(self, p: PolyElement) -> Any:
        """A polynomial as an expression; algebraic numbers as they were written."""
        numbers = self.factors.numbers
        if numbers is None:
            return p.as_expr()
        unit = p.ring.domain.one
        return reduce(
            add,
            (numbers.text_symbols(c) * p.ring.term_new(m, unit).as_expr() for m, c in p.terms()),
        )

    def __repr__(self) -> str:
        return str(self._sympy_())


def numerator(element: Element) -> PolyElement:
    """The numerator of a nonzero element."""
    (quotient,) = element.combine().parts
    return quotient.numer


def split_by_powers(p: PolyElement, place: int) -> dict[int, PolyElement]:
    """The coefficients of the powers of a generator, in the order in which they occur."""
    result: dict[int, dict[tuple[int, ...], Any]] = {}
    for exponents, value in p.terms():
        rest = (*exponents[:place], 0, *exponents[place + 1 :])
        result.setdefault(exponents[place], {})[rest] = value
    return {power: p.ring.from_dict(terms) for power, terms in result.items()}
