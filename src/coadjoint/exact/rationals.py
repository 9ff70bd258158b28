"""Rational functions over Q in named generators: numbers, polynomials, their parts and values.

Comes in: names of the symbols, and how many generators are kept free for functions of them. Goes
out: elements, and what they are made of.
Read next: `coadjoint.exact.field`, which gives the free generators a meaning.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from operator import mul, truediv
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeVar

import sympy
from sympy.polys.domains import QQ
from sympy.polys.orderings import lex
from sympy.polys.rings import PolyElement, PolyRing

from coadjoint.exact.denominators import Factors
from coadjoint.exact.dense import total
from coadjoint.exact.element import Element, Quotient
from coadjoint.exact.factors import to_fraction
from coadjoint.exact.residues import residue

if TYPE_CHECKING:
    from coadjoint.exact.numbers import Numbers

Value = TypeVar("Value")


@dataclass(frozen=True)
class Monomial:
    """A rational number times powers of generators, by name and in the order of the field."""

    number: Fraction
    powers: tuple[tuple[str, int], ...]


@dataclass(frozen=True)
class Written:
    """A quotient as it is written: addends of the numerator over powers of divisors."""

    monomials: tuple[Monomial, ...]
    divisors: tuple[tuple[Element, int], ...]


class Rationals:
    """Rational functions over Q in named generators.

    Args:
        names: The symbols, in the order that fixes the normal form.
        slots: How many generators stand behind them, for functions of symbols.
        numbers: The algebraic numbers that coefficients may be; by default they are rational.

    Attributes:
        generators: The symbols and the slots for functions, in the order of the ring.
        zero: The element 0.
        one: The element 1.
    """

    def __init__(
        self, names: Sequence[str], slots: int = 0, numbers: Numbers | None = None
    ) -> None:
        self.names = tuple(names)
        # A spec name cannot begin with an underscore, so a slot cannot meet one.
        self._free = [f"_f{n + 1}" for n in range(slots)]
        domain = QQ if numbers is None else numbers.domain
        self._ring = PolyRing([sympy.Symbol(n) for n in (*names, *self._free)], domain, lex)
        self._factors = Factors(self._ring, len(self._free))
        self._factors.numbers = numbers
        #: A block in which arithmetic ends after so much work: see `Factors.budget`.
        self.budget = self._factors.budget
        self.generators = (*names, *self._free)
        self._position = {name: n for n, name in enumerate(self.generators)}
        self._generators = {
            name: self.from_polynomial(generator)
            for name, generator in zip(self.generators, self._ring.gens, strict=True)
        }
        self.zero = self.from_polynomial(self._ring.zero)
        self.one = self.from_polynomial(self._ring.one)
        self._remembered: dict[PolyElement, tuple[Monomial, ...]] = {}
        self._occurring: dict[PolyElement, frozenset[str]] = {}
        self._residues: dict[int, dict[PolyElement, list[tuple[int, list[str]]]]] = {}

    def __getitem__(self, name: str) -> Element:
        return self._generators[name]

    def from_polynomial(self, p: PolyElement) -> Element:
        """A polynomial of the ring as an element."""
        return Element(self._factors, [(p, {})])

    def number(self, value: Fraction | int) -> Element:
        """A rational number as an element."""
        return self.zero + Fraction(value)

    def ground(self, number: Any) -> Element:
        """A number of the ground domain as an element."""
        return self.from_polynomial(self._ring.ground_new(number))

    def adopt(self, element: Element, names: Mapping[str, str] = MappingProxyType({})) -> Element:
        """An element of another field, function-free, of symbols that this one has too.

        Algebraic numbers and pi become functions of numbers.

        Args:
            element: What to take over.
            names: What some of its symbols are called here.

        Raises:
            KeyError: A symbol that occurs is not known here.
        """
        own = [names.get(str(s), str(s)) for s in element.factors.ring.symbols]

        known = element.factors.numbers

        def move(p: PolyElement) -> Element:
            if known is not None and known is not self._factors.numbers:
                return self._take_numbers(known, own, p)
            return self.from_polynomial(self._ring.from_dict(self._place(own, dict(p))))

        def divide(quotient: Quotient) -> Element:
            factors = element.factors.known
            return reduce(
                truediv,
                (move(factors[n]) ** exponent for n, exponent in quotient.powers.items()),
                move(quotient.numer),
            )

        return self.sum(map(divide, element.parts))

    def _take_numbers(self, known: Numbers, own: Sequence[str], p: PolyElement) -> Element:
        """A polynomial over algebraic numbers, each written by functions of this field."""
        raise AssertionError(f"{p} has algebraic coefficients; expected a field with functions")

    def polynomial(
        self, names: Sequence[str], terms: Mapping[tuple[int, ...], Fraction | int]
    ) -> Element:
        """A polynomial in some symbols, by the exponents of its terms in their order."""
        numbers = {e: QQ(value.numerator, value.denominator) for e, value in terms.items()}
        return self.from_polynomial(self._ring.from_dict(self._place(names, numbers)))

    def _place(self, names: Sequence[str], terms: Mapping[Any, Any]) -> dict[Any, Any]:
        """Terms in some symbols as terms of the ring; only symbols that occur must be known."""
        used = [n for n in range(len(names)) if any(exponents[n] for exponents in terms)]
        places = [self._position[names[n]] for n in used]
        result = {}
        for exponents, number in terms.items():
            powers = [0] * len(self.generators)
            for place, n in zip(places, used, strict=True):
                powers[place] = exponents[n]
            result[tuple(powers)] = number
        return result

    def sum(self, elements: Iterable[Element]) -> Element:
        """The sum of elements, added in pairs: a long sum takes no quadratic time."""
        addends = list(elements)
        return total(addends) if addends else self.zero

    def vector(self, values: Iterable[Element | Fraction | int]) -> tuple[Element, ...]:
        """Values that may still be plain numbers, as elements."""
        return tuple(self.zero + value for value in values)

    def names_in(self, element: Element) -> frozenset[str]:
        """Names of the generators that occur in an element."""
        found = frozenset[str]()
        for quotient in element.parts:
            found |= self._names_of(quotient.numer)
            for factor in quotient.powers:
                found |= self._names_of(self._factors.known[factor])
        return found

    def _names_of(self, p: PolyElement) -> frozenset[str]:
        """The same of a polynomial, remembered."""
        if p not in self._occurring:
            pairs = zip(self.generators, p.degrees(), strict=True)
            self._occurring[p] = frozenset(name for name, degree in pairs if degree > 0)
        return self._occurring[p]

    def _quotient(
        self,
        quotient: Quotient,
        values: Mapping[str, Value],
        number: Callable[[Fraction], Value],
        factors: dict[int, Value],
    ) -> Value:
        """Numerator over the product of the factors."""
        top = self._polynomial(quotient.numer, values, number)
        if not quotient.powers:
            return top
        for factor in quotient.powers:
            if factor not in factors:
                factors[factor] = self._polynomial(self._factors.known[factor], values, number)
        bottom = [factors[n] for n, exponent in quotient.powers.items() for _ in range(exponent)]
        return top / reduce(mul, bottom)  # type: ignore[operator, no-any-return]

    def _polynomial(
        self, p: PolyElement, values: Mapping[str, Value], number: Callable[[Fraction], Value]
    ) -> Value:
        """Sum of coefficient times powers, in the order of the ring."""
        terms: list[Any] = []
        self._factors.spend(len(p))
        for monomial in self._written(p):
            factors = [values[name] for name, power in monomial.powers for _ in range(power)]
            if monomial.number != 1 or not factors:
                factors.insert(0, number(monomial.number))
            terms.append(reduce(mul, factors))
        return total(terms) if terms else number(Fraction(0))

    def _written(self, p: PolyElement) -> tuple[Monomial, ...]:
        """The addends of a polynomial by name, remembered: oracles evaluate at many points."""
        if p not in self._remembered:
            self._remembered[p] = tuple(
                Monomial(
                    to_fraction(coefficient),
                    tuple((self.generators[place], e) for place, e in enumerate(exponents) if e),
                )
                for exponents, coefficient in p.terms()
            )
        return self._remembered[p]

    def _replace(self, element: Element, values: Mapping[str, Element]) -> Element:
        """An element with generators replaced; the others stay together, as they are."""
        places = {self._position[name]: value for name, value in values.items()}
        factors = dict[int, Element]()
        parts = list[Element]()
        for quotient in element.parts:
            top = self._replace_in(quotient.numer, places)
            for n in quotient.powers:
                if n not in factors:
                    factors[n] = self._replace_in(self._factors.known[n], places)
            below = [factors[n] for n, e in quotient.powers.items() for _ in range(e)]
            parts.append(top / reduce(mul, below) if below else top)
        return self.sum(parts)

    def _replace_in(self, p: PolyElement, values: Mapping[int, Element]) -> Element:
        """A polynomial with generators replaced, by their places."""
        self._factors.spend(len(p))
        groups: dict[tuple[tuple[int, int], ...], dict[tuple[int, ...], Any]] = {}
        for exponents, number in p.terms():
            moved = tuple((n, exponents[n]) for n in values if exponents[n])
            rest = list(exponents)
            for n, _ in moved:
                rest[n] = 0
            groups.setdefault(moved, {})[tuple(rest)] = number
        return self.sum(
            reduce(
                mul,
                (values[n] ** e for n, e in moved),
                self.from_polynomial(self._ring.from_dict(g)),
            )
            for moved, g in groups.items()
        )

    # -- values modulo a prime ----------------------------------------------------------

    def evaluate_modulo(
        self, element: Element, values: Mapping[str, int], prime: int, inverses: dict[int, int]
    ) -> int:
        """The value of an element modulo a prime, where each generator has a value given.

        Args:
            element: What to evaluate.
            values: Residues of the generators that occur.
            prime: The prime.
            inverses: Remembers what stands below a bar, for many elements at the same values.

        Raises:
            ZeroDivisionError: What stands below a bar is zero there.
        """
        result = 0
        for quotient in element.parts:
            top = self._modulo(quotient.numer, values, prime)
            for factor, exponent in quotient.powers.items():
                if factor not in inverses:
                    below = self._modulo(self._factors.known[factor], values, prime)
                    if not below:
                        raise ZeroDivisionError(f"division by zero modulo {prime}")
                    inverses[factor] = pow(below, -1, prime)
                for _ in range(exponent):
                    top = top * inverses[factor] % prime
            result += top
        return result % prime

    def _modulo(self, p: PolyElement, values: Mapping[str, int], prime: int) -> int:
        """The value of a polynomial; its terms modulo the prime are remembered."""
        self._factors.spend(len(p))
        known = self._residues.setdefault(prime, {})
        if p not in known:
            known[p] = [
                (residue(each.number, prime).value, [x for x, e in each.powers for _ in range(e)])
                for each in self._written(p)
            ]
        result = 0
        for value, factors in known[p]:
            for name in factors:
                value = value * values[name] % prime
            result += value
        return result % prime

    # -- parts, for signs and relations -------------------------------------------------

    def fraction(self, element: Element) -> tuple[PolyElement, list[tuple[PolyElement, int]]]:
        """Numerator and factors of the denominator, with exponents, of a nonzero quotient."""
        (quotient,) = element.parts
        return quotient.numer, [(self._factors.known[n], e) for n, e in quotient.powers.items()]

    def numerators(self, elements: Iterable[Element]) -> tuple[list[PolyElement], Element]:
        """Numerators over a common denominator, and its reciprocal."""
        quotients = [each.combine().parts for each in elements]
        common: dict[int, int] = {}
        for quotient, *_ in filter(None, quotients):
            for number, exponent in quotient.powers.items():
                common[number] = max(common.get(number, 0), exponent)
        tops = [
            parts[0].over(common, self._factors) if parts else self._ring.zero
            for parts in quotients
        ]
        return tops, Element(self._factors, [(self._ring.one, common)])

    # -- parts, for lowering ------------------------------------------------------------

    def as_number(self, element: Element) -> Fraction | None:
        """The rational number that an element is, or None."""
        if not element.parts:
            return Fraction(0)
        quotient, *others = element.parts
        if others or quotient.powers or not quotient.numer.is_ground:
            return None
        return to_fraction(quotient.numer.LC)

    def quotients(self, element: Element) -> list[Written]:
        """The quotients whose sum the element is, in the order of the field."""
        return [
            Written(
                self._written(quotient.numer),
                tuple(
                    (self.from_polynomial(self._factors.known[n]), exponent)
                    for n, exponent in quotient.powers.items()
                ),
            )
            for quotient in element.parts
        ]

    def terms(self, element: Element) -> tuple[Element, ...]:
        """The addends of the numerators, each over the whole denominator of its quotient."""
        ring = self._ring
        return tuple(
            Element(self._factors, [(ring.from_dict({monomial: coefficient}), quotient.powers)])
            for quotient in element.parts
            for monomial, coefficient in quotient.numer.terms()
        )

    def first_term(self, element: Element) -> Element:
        """The first of the `terms` of an element that is not 0."""
        quotient, p = element.parts[0], element.parts[0].numer
        first = self._ring.from_dict({p.LM: p.LC})
        return Element(self._factors, [(first, quotient.powers)])

    def powers_in(self, term: Element, places: Sequence[int]) -> list[int]:
        """Exponents of some generators in an element of one term, negative below the bar.

        A quotient of two terms is free of these generators only if both have the same.
        """
        (quotient,) = term.parts
        (exponents,) = quotient.numer
        below = {self._factors.places[n]: e for n, e in quotient.powers.items()}
        return [exponents[place] - below.get(place, 0) for place in places]

    def count_terms(self, element: Element) -> int:
        """The number of `terms`, none of which is made."""
        return sum(len(quotient.numer) for quotient in element.parts)

    def partial_fractions(self, element: Element) -> list[Element]:
        """Single quotients whose sum is the element, their addends cancelled; zero alone for zero.

        ``(I2 - I3)/(I2*I3)`` is ``1/I3 - 1/I2``.
        """
        if len(element.parts) == 1 and not element.parts[0].powers:
            return [element]  # a polynomial
        groups: dict[tuple[tuple[int, int], ...], list[Element]] = {}
        for term in self.terms(element):
            key = tuple(sorted(term.parts[0].powers.items()))
            groups.setdefault(key, []).append(term)
        return [self.sum(terms) for terms in groups.values()] or [element]
