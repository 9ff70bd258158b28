r"""The search for Casimirs among polynomials: an exact linear solve, split by gradings.

The unknowns are the coefficients of the monomials, the equations are ``{x_i, C} = 0``. The
gradings of the bracket split the monomials into classes that are solved one by one, those of low
degree first, until as many independent Casimirs are found as there can be.
Comes in: a polynomial bracket and a degree. Goes out: polynomials and quotients of polynomials.
Read next: `coadjoint.poisson.polynomial_bracket`.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Sequence
from fractions import Fraction
from functools import reduce
from itertools import combinations_with_replacement, islice
from math import lcm
from operator import mul

from coadjoint.algebra.linear import nullspace, primes, rank_modulo
from coadjoint.exact import Element
from coadjoint.poisson.gradings import Gradings, Weight
from coadjoint.poisson.polynomial_bracket import PolynomialBracket
from coadjoint.poisson.polynomials import Exponents, Number, Polynomial, monomial_order
from coadjoint.poisson.structure import PoissonStructure

#: Primes modulo which independence is looked for.
PRIMES = 2

#: Monomials of one weight, with the character by which the scaling coordinates act on them.
MonomialClass = tuple[tuple[Number, ...], list[Exponents]]


def polynomial_casimirs(bracket: PolynomialBracket, degree: int, expected: int) -> list[Polynomial]:
    """Independent polynomial Casimirs, by degree and then by the number of their terms.

    Args:
        bracket: The bracket.
        degree: The largest degree of a monomial.
        expected: How many independent ones there can be; the search ends there.
    """
    solutions = (
        solution
        for character, monomials in monomial_classes(bracket, degree)
        if not any(character)
        for solution in _solutions(bracket, monomials, bracket.generating)
    )
    return independent_polynomials(solutions, bracket.size, expected)


def quotients(
    structure: PoissonStructure, bracket: PolynomialBracket, degree: int
) -> list[Element]:
    """Products of powers of semi-invariants p, ``{x_i, p} = chi_i p``, whose characters cancel.

    The characters are those of coordinates that scale all others: the algebra
    ``[e1, e2] = e2, [e1, e3] = e3`` has the semi-invariants e2 and e3, hence the Casimir e2/e3.
    """
    if not bracket.scalings:
        return []
    others = [i for i in range(bracket.size) if i not in bracket.scalings]
    found = [
        (character, solution)
        for character, monomials in monomial_classes(bracket, degree)
        for solution in _solutions(bracket, monomials, others)
    ]
    kept = independent_polynomials((solution for _, solution in found), bracket.size, bracket.size)
    characters = [next(c for c, solution in found if solution is p) for p in kept]
    balance = [
        {place: c[n] for place, c in enumerate(characters) if c[n]}
        for n in range(len(bracket.scalings))
    ]
    bases = [p.element(structure.field, structure.names) for p in kept]
    return [
        reduce(mul, (bases[place] ** power for place, power in _whole(powers).items()))
        for powers in nullspace(balance, len(bases))
    ]


def monomial_classes(bracket: PolynomialBracket, degree: int) -> list[MonomialClass]:
    """Monomials up to a degree by their weight, classes of low degree first."""
    gradings = Gradings(bracket.entries, bracket.size)
    classes: dict[Weight, list[Exponents]] = {}
    for d in range(1, degree + 1):
        for factors in combinations_with_replacement(range(bracket.size), d):
            exponents = [0] * bracket.size
            for i in factors:
                exponents[i] += 1
            classes.setdefault(gradings.weight(factors), []).append(tuple(exponents))
    by_degree = sorted(classes.values(), key=lambda monomials: sum(monomials[-1]))
    return [(bracket.character(monomials[0]), monomials) for monomials in by_degree]


def _solutions(
    bracket: PolynomialBracket, monomials: Sequence[Exponents], asked: Sequence[int]
) -> list[Polynomial]:
    """A basis of the polynomials in some monomials that commute with some coordinates.

    It is the reduced echelon form with the largest monomials first, so that what has a low degree
    has no terms of a high one; short ones come first.
    """
    order = sorted(monomials, key=monomial_order, reverse=True)
    rows: dict[tuple[int, Exponents], dict[int, Number]] = {}
    for column, monomial in enumerate(order):
        for i in asked:
            for product, value in bracket.along(i, monomial).items():
                rows.setdefault((i, product), {})[column] = value
    found = [
        Polynomial({order[column]: value for column, value in vector.items()}).primitive()
        for vector in nullspace(rows.values(), len(order))
    ]
    return sorted(found, key=lambda p: (p.degree, len(p.terms)))


def independent_polynomials(
    solutions: Iterable[Polynomial], size: int, most: int
) -> list[Polynomial]:
    """Those whose gradients are independent of all before them, up to a number.

    A rank at a point modulo a prime is a lower bound, so that independence is proved. What is not
    seen modulo one prime, as of a coefficient that it divides, is seen modulo the other.
    """
    source = random.Random(1)  # noqa: S311 (not for secrets)
    points = {p: [source.randrange(1, p) for _ in range(size)] for p in islice(primes(), PRIMES)}
    slopes: dict[int, list[dict[int, int]]] = {prime: [] for prime in points}
    kept: list[Polynomial] = []
    for solution in solutions if most else ():
        for prime, point in points.items():
            rows = [*slopes[prime], solution.slopes_modulo(point, prime)]
            if rank_modulo(rows, prime) == len(rows):
                break
        else:
            continue
        kept.append(solution)
        for other, point in points.items():
            slopes[other].append(solution.slopes_modulo(point, other))
        if len(kept) == most:
            break
    return kept


def _whole(vector: dict[int, Fraction]) -> dict[int, int]:
    """A rational vector scaled to integers."""
    scale = lcm(*(value.denominator for value in vector.values()))
    return {place: int(value * scale) for place, value in vector.items()}
