"""Polynomials with rational coefficients as plain dictionaries, for searches over many monomials.

Comes in: elements of a field. Goes out: `Polynomial`, and elements again. An exponent tuple has one
place for each coordinate. The searches multiply and differentiate thousands of small polynomials,
for which an `Element` does too much bookkeeping.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from coadjoint.errors import AlgebraError
from coadjoint.exact import Element, Field
from coadjoint.exact.ansatz import Exponents
from coadjoint.exact.linear import exact, whole_numbers

Number = int | Fraction


@dataclass(frozen=True)
class Polynomial:
    """A polynomial in n coordinates.

    Attributes:
        terms: Coefficients by exponents, zeros left out.
    """

    terms: Mapping[Exponents, Number]

    def __add__(self, other: Polynomial) -> Polynomial:
        terms = dict(self.terms)
        for exponents, value in other.terms.items():
            terms[exponents] = terms.get(exponents, 0) + value
        return Polynomial({e: value for e, value in terms.items() if value})

    def __mul__(self, other: Polynomial) -> Polynomial:
        terms: dict[Exponents, Number] = {}
        for a, x in self.terms.items():
            for b, y in other.terms.items():
                product = tuple(map(int.__add__, a, b))
                terms[product] = terms.get(product, 0) + x * y
        return Polynomial({e: exact(value) for e, value in terms.items() if value})

    def __truediv__(self, other: Polynomial) -> Polynomial:
        ((exponents, value),) = other.terms.items() if len(other.terms) == 1 else [((1,), 0)]
        if any(exponents):
            raise AlgebraError(
                "a quotient of polynomials stands where a polynomial was expected; "
                "multiply by the denominator.",
            )
        return Polynomial({e: exact(Fraction(x) / value) for e, x in self.terms.items()})

    def slopes_modulo(self, point: Sequence[int], prime: int) -> dict[int, int]:
        """The gradient at a point without zeros, modulo a prime: nonzero entries by place.

        The coefficients must be integers, as those of `primitive` are.
        """
        inverses = [pow(x, -1, prime) for x in point]
        slopes: dict[int, int] = {}
        for exponents, number in self.terms.items():
            present = [(n, e) for n, e in enumerate(exponents) if e]
            value = int(number)
            for n, e in present:
                value = value * point[n] ** e % prime
            for n, e in present:
                slopes[n] = (slopes.get(n, 0) + value * e * inverses[n]) % prime
        return {n: value for n, value in slopes.items() if value}

    @property
    def degree(self) -> int:
        """The largest degree of a term; 0 for the zero polynomial."""
        return max(map(sum, self.terms), default=0)

    def primitive(self) -> Polynomial:
        """The multiple with coprime integer coefficients whose leading one is positive.

        The leading term is the last by degree, then by exponents, as `monomial_order` sorts.
        """
        leads = self.terms[max(self.terms, key=monomial_order)]
        whole = whole_numbers(self.terms)
        return Polynomial({e: value if leads > 0 else -value for e, value in whole.items()})

    def element(self, field: Field, names: Sequence[str]) -> Element:
        """The polynomial in named symbols of a field."""
        return field.polynomial(names, self.terms)


def monomial_order(exponents: Exponents) -> tuple[int, Exponents]:
    """By degree, then as the coordinates stand: the first one leads."""
    return sum(exponents), exponents


def constant(value: Number, size: int) -> Polynomial:
    """A number as a polynomial in so many coordinates."""
    return Polynomial({(0,) * size: exact(value)} if value else {})


def coordinate(place: int, size: int) -> Polynomial:
    """One coordinate as a polynomial."""
    return Polynomial({tuple(int(n == place) for n in range(size)): 1})


def read_polynomial(field: Field, element: Element, names: Sequence[str]) -> Polynomial:
    """An element as a polynomial in some symbols.

    Raises:
        AlgebraError: It holds another symbol, a function, or a quotient.
    """
    size = len(names)
    other = sorted(field.reach(element) - set(names))
    if other:
        raise AlgebraError(
            f"{other[0]!r} is no coordinate; a search for polynomials needs rational coefficients. "
            "Put numbers for the parameters.",
            found=other[0],
        )
    symbols = {name: coordinate(place, size) for place, name in enumerate(names)}
    return field.evaluate(element, symbols, lambda value: constant(value, size), _no_call)


def _no_call(function: str, argument: Polynomial) -> Polynomial:
    raise AlgebraError(
        f"the function {function!r} is no polynomial; a search needs polynomials.", found=function
    )
