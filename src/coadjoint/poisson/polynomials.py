"""Polynomials in the coordinates of a bracket, for searches over many monomials.

Comes in: elements of a field, or coefficients by exponents. Goes out: SymPy's sparse polynomials
with whole coefficients, ordered by degree and then as the coordinates stand. The searches multiply
and differentiate thousands of small ones, for which an `Element` does too much bookkeeping.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cache

from sympy.polys.domains import ZZ
from sympy.polys.orderings import grlex
from sympy.polys.rings import PolyElement, PolyRing

from coadjoint.errors import AlgebraError
from coadjoint.exact import Element, Field
from coadjoint.exact.ansatz import Exponents
from coadjoint.exact.linear import exact, whole_numbers

Number = int | Fraction
#: Coefficients by exponents, which have one place for each coordinate; zeros left out.
Terms = Mapping[Exponents, Number]


@cache
def ring_of(size: int) -> PolyRing:
    """The polynomials with whole coefficients in so many coordinates."""
    return PolyRing([f"x{n + 1}" for n in range(size)], ZZ, grlex)


def primitive(terms: Terms) -> PolyElement:
    """The multiple of a nonzero polynomial with coprime whole coefficients, the first positive."""
    p = ring_of(len(next(iter(terms)))).from_dict(whole_numbers(terms))
    return p if p.LC > 0 else -p


def slopes_modulo(p: PolyElement, point: Sequence[int], prime: int) -> dict[int, int]:
    """The gradient at a point without zeros, modulo a prime: nonzero entries by place."""
    inverses = [pow(x, -1, prime) for x in point]
    slopes: dict[int, int] = {}
    for exponents, number in p.items():
        present = [(n, e) for n, e in enumerate(exponents) if e]
        value = int(number)
        for n, e in present:
            value = value * point[n] ** e % prime
        for n, e in present:
            slopes[n] = (slopes.get(n, 0) + value * e * inverses[n]) % prime
    return {n: value for n, value in slopes.items() if value}


def read_terms(field: Field, element: Element, names: Sequence[str]) -> dict[Exponents, Number]:
    """The coefficients of a polynomial in some symbols.

    Raises:
        AlgebraError: It holds another symbol, a function, or a quotient.
    """
    other = sorted(field.reach(element) - set(names))
    if other:
        raise AlgebraError(
            f"{other[0]!r} is not a coordinate; a search for polynomials needs rational "
            "coefficients. Replace the parameters by numbers.",
            found=other[0],
        )
    for generator in sorted(field.functions_in(element)):
        function = field.adjoined[generator].function
        raise AlgebraError(
            f"the function {function!r} is not a polynomial; a search needs polynomials.",
            found=function,
        )
    terms: dict[Exponents, Number] = {}
    for written in field.quotients(element):
        if written.divisors:
            raise AlgebraError(
                "a quotient of polynomials stands where a polynomial was expected; "
                "multiply by the denominator.",
            )
        for monomial in written.monomials:
            powers = dict(monomial.powers)
            terms[tuple(powers.get(name, 0) for name in names)] = exact(monomial.number)
    return terms
