r"""The search for Casimirs among polynomials: an exact linear solve, split by gradings.

The family are the monomials, the conditions are ``{x_i, C} = 0`` (`coadjoint.exact.ansatz`). The
gradings of the bracket split the monomials into classes that are solved one by one, those of low
degree first, until as many independent Casimirs are found as there can be.
Comes in: a polynomial bracket and a degree. Goes out: polynomials and quotients of polynomials.
Read next: `coadjoint.poisson.polynomial_bracket`.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Sequence
from functools import reduce
from itertools import islice
from operator import mul

from sympy.polys.orderings import grlex
from sympy.polys.rings import PolyElement

from coadjoint.exact import Element
from coadjoint.exact.ansatz import Exponents, conditions_on, monomials, solve_exactly
from coadjoint.exact.linear import SpanModulo, primes, whole_numbers
from coadjoint.poisson.gradings import Gradings, Weight
from coadjoint.poisson.polynomial_bracket import PolynomialBracket
from coadjoint.poisson.polynomials import Number, primitive, slopes_modulo
from coadjoint.poisson.structure import PoissonStructure

#: Primes modulo which independence is searched for.
PRIMES = 2

#: Monomials of one weight, with the character by which the scaling coordinates act on them.
MonomialClass = tuple[tuple[Number, ...], list[Exponents]]


def polynomial_casimirs(
    bracket: PolynomialBracket, degree: int, expected: int
) -> list[PolyElement]:
    """Independent polynomial Casimirs, by degree and then by the number of their terms.

    Args:
        bracket: The bracket.
        degree: The largest degree of a monomial.
        expected: How many independent ones there can be; the search ends there.
    """
    solutions = (
        solution
        for character, members in monomial_classes(bracket, degree)
        if not any(character)
        for solution in _solutions(bracket, members, bracket.generating)
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
    result = [
        (character, solution)
        for character, members in monomial_classes(bracket, degree)
        for solution in _solutions(bracket, members, others)
    ]
    kept = independent_polynomials((solution for _, solution in result), bracket.size, bracket.size)
    characters = [next(c for c, solution in result if solution is p) for p in kept]
    balance = conditions_on(dict(enumerate(character)) for character in characters)
    bases = [structure.field.polynomial(structure.names, p) for p in kept]
    return [
        reduce(mul, (bases[place] ** power for place, power in whole_numbers(powers).items()))
        for powers in solve_exactly(range(len(bases)), balance)
    ]


def monomial_classes(bracket: PolynomialBracket, degree: int) -> list[MonomialClass]:
    """Monomials up to a degree by their weight, classes of low degree first."""
    gradings = Gradings(bracket.entries, bracket.size)
    classes: dict[Weight, list[Exponents]] = {}
    for exponents in monomials(bracket.size, degree, least=1):
        classes.setdefault(gradings.weight(exponents), []).append(exponents)
    by_degree = sorted(classes.values(), key=lambda members: sum(members[-1]))
    return [(bracket.character(members[0]), members) for members in by_degree]


def _solutions(
    bracket: PolynomialBracket, members: Sequence[Exponents], asked: Sequence[int]
) -> list[PolyElement]:
    """A basis of the polynomials in some monomials that commute with some coordinates.

    It is the reduced echelon form with the largest monomials first, so that what has a low degree
    has no terms of a high one; short ones come first.
    """
    order = sorted(members, key=grlex, reverse=True)
    conditions = conditions_on(
        {(i, product): x for i in asked for product, x in bracket.along(i, monomial).items()}
        for monomial in order
    )
    result = [primitive(terms) for terms in solve_exactly(order, conditions)]
    return sorted(result, key=lambda p: (sum(p.LM), len(p)))


def independent_polynomials(
    solutions: Iterable[PolyElement], size: int, most: int
) -> list[PolyElement]:
    """Those whose gradients are independent of all before them, up to a number.

    A rank at a point modulo a prime is a lower bound, so that independence is proved. What is not
    seen modulo one prime, as of a coefficient that it divides, is seen modulo the other.
    """
    source = random.Random(1)  # noqa: S311 (not for secrets)
    points = {p: [source.randrange(1, p) for _ in range(size)] for p in islice(primes(), PRIMES)}
    spans, kept = [SpanModulo(prime) for prime in points], list[PolyElement]()
    for solution in solutions if most else ():
        raised = [s for s in spans if s.add(slopes_modulo(solution, points[s.prime], s.prime))]
        if not raised:
            continue
        kept, spans = [*kept, solution], raised
        if len(kept) == most:
            break
    return kept
