"""Factors: elements as products of powers, and what signs of such products follow from others.

Comes in: polynomials and numbers. Goes out: their factors with exponents; for signs, rows over the
field of two elements. Read next: `coadjoint.exact.relations`, which takes square roots of products.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from math import isqrt
from typing import Any

from sympy import factorint
from sympy.polys.rings import PolyElement, PolyRing

#: Largest polynomial that is factored: terms and degree.
LARGEST_FACTORED = 40
LARGEST_DEGREE = 16
#: Polynomials whose factors are remembered.
REMEMBERED = 1000
#: Primes up to here are split off numbers.
PRIMES = 1000
#: A factor: a prime, -1, or a monic polynomial.
Factor = Any
#: Exponents of factors, none of them 0.
Powers = dict[Factor, int]
#: Factors the signs of which have a product that is known, and whether that is negative.
SignRow = tuple[frozenset[Factor], int]


def in_own_symbols(*polynomials: PolyElement) -> tuple[list[PolyElement], list[int]]:
    """Polynomials in a ring of the symbols that they have, and the places of these.

    SymPy takes time for each symbol of a ring, also for those that do not occur.
    """
    degrees = zip(*(p.degrees() for p in polynomials), strict=True)
    places = [n for n, each in enumerate(degrees) if max(each) > 0]
    whole = polynomials[0].ring
    own = PolyRing([whole.symbols[n] for n in places], whole.domain, whole.order)
    return [
        own.from_dict({tuple(e[n] for n in places): x for e, x in p.items()}) for p in polynomials
    ], places


def in_ring(ring: PolyRing, p: PolyElement, places: Sequence[int]) -> PolyElement:
    """A polynomial in a larger ring, where its symbols have the given places."""
    terms = {}
    for exponents, value in p.items():
        whole = [0] * ring.ngens
        for place, exponent in zip(places, exponents, strict=True):
            whole[place] = exponent
        terms[tuple(whole)] = value
    return ring.from_dict(terms)


def common_divisor(p: PolyElement, q: PolyElement) -> PolyElement:
    """The greatest common divisor of two polynomials.

    >>> from sympy import QQ, ring
    >>> _, x, y, z = ring("x, y, z", QQ)
    >>> common_divisor(x**2 - z**2, 2 * x - 2 * z)
    x - z
    """
    if not p or not q:
        return p.gcd(q)
    (a, b), places = in_own_symbols(p, q)
    return in_ring(p.ring, a.gcd(b), places) if places else p.gcd(q)


def factors_of(p: PolyElement) -> tuple[Any, list[tuple[PolyElement, int]]]:
    """A nonzero polynomial as a rational number times powers of monic factors.

    Large ones stay whole: to factor them could take long.
    """
    least = tuple(map(min, zip(*p, strict=True)))
    gens = [(gen, e) for gen, e in zip(p.ring.gens, least, strict=True) if e]
    p = p.quo_term((least, p.ring.domain.one))
    small = len(p) <= LARGEST_FACTORED and max(map(sum, p)) <= LARGEST_DEGREE
    content, result = p.ring.domain.one, [(p, 1)]
    if small and len(p) > 1:
        (own,), places = in_own_symbols(p)
        content, parts = _factor_list(own)
        result = [(in_ring(p.ring, factor, places), exponent) for factor, exponent in parts]
    for factor, exponent in result:
        content *= factor.LC**exponent
    return content, [*gens, *((f.monic(), e) for f, e in result if not f.is_ground)]


@lru_cache(REMEMBERED)
def _factor_list(p: PolyElement) -> tuple[Any, list[tuple[PolyElement, int]]]:
    """The factors of a polynomial, remembered: the same functions occur in many elements."""
    content, factors = p.factor_list()
    return content, factors


def to_fraction(number: Any) -> Fraction:
    """A rational number of SymPy's domains as one of Python."""
    return Fraction(int(number.numerator), int(number.denominator))


def rational_root(value: Fraction) -> Fraction | None:
    """The square root of the square of a rational number; None for other numbers."""
    if value < 0:
        return None
    root = Fraction(isqrt(value.numerator), isqrt(value.denominator))
    return root if root**2 == value else None


def number_factors(number: Fraction) -> Powers:
    """A rational number as powers of -1, of small primes and of what is left of the rest."""
    vector: Powers = {-1: 1} if number < 0 else {}
    for whole, power in ((abs(number.numerator), 1), (number.denominator, -1)):
        for factor, exponent in factorint(
            whole, limit=PRIMES, use_rho=False, use_pm1=False
        ).items():
            root = isqrt(factor)
            base, count = (root, 2 * exponent) if root**2 == factor else (factor, exponent)
            if base > 1:
                vector = multiply(vector, {int(base): count * power})
    return vector


def odd_factors(vector: Powers) -> frozenset[Factor]:
    """The factors with odd exponents."""
    return frozenset(f for f, e in vector.items() if e % 2)


def multiply(a: Powers, b: Mapping[Factor, int]) -> Powers:
    """The product of two products of powers."""
    result = dict(a)
    for factor, exponent in b.items():
        result[factor] = result.get(factor, 0) + exponent
    return {f: e for f, e in result.items() if e}


def eliminate_signs(
    rows: Iterable[SignRow], wanted: Sequence[Factor]
) -> list[tuple[Factor, frozenset[Factor], int]]:
    """Rows each with a factor that no other row has, one that is not wanted where there is one."""
    result: list[tuple[Factor, frozenset[Factor], int]] = []
    for factors, number in rows:
        left, negative = reduce_signs(factors, result)
        negative ^= number
        if not left:
            continue
        pivot = min(left, key=lambda f: (f in wanted, str(f)))
        result = [
            (p, row ^ left, n ^ negative) if pivot in row else (p, row, n) for p, row, n in result
        ]
        result.append((pivot, left, negative))
    return result


def reduce_signs(
    factors: frozenset[Factor], rows: Sequence[tuple[Factor, frozenset[Factor], int]]
) -> tuple[frozenset[Factor], int]:
    """A product of signs by rows that are 1 or -1, each with the factor that it removes."""
    number = 0
    for pivot, row, negative in rows:
        if pivot in factors:
            factors, number = factors ^ row, number ^ negative
    return factors, number
