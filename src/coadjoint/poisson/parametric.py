r"""Casimirs whose coefficients contain parameters and pi: their monomials first, then coefficients.

At random numbers in the place of the parameters, and of pi, which is transcendental, the search for
polynomials with rational coefficients gives the monomials of a basis of Casimirs; for almost all
parameters these are the same. The coefficients c of such a Casimir then solve
``sum_m c_m {x_i, m} = 0`` over the field of functions of the parameters, at points of the
coordinates. Roots next to pi take random numbers, too: what rests on a relation between them is not
found. Each result is checked as it stands: ``{x_i, C} = 0`` by the normal form.
Comes in: a structure with polynomial entries. Goes out: Casimirs as elements.
Read next: `coadjoint.poisson.search`.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import islice

from coadjoint.exact import Element, Field
from coadjoint.exact.ansatz import Exponents
from coadjoint.poisson.polynomial_bracket import PolynomialBracket
from coadjoint.poisson.search import polynomial_casimirs
from coadjoint.poisson.structure import PoissonStructure

#: Monomials of one Casimir, at most: coefficients are found by elimination in functions.
MONOMIALS_OF_ONE = 12
#: Equations that are tried for each unknown.
TRIES = 6


def find_constants(structure: PoissonStructure) -> list[str] | None:
    """Parameters and functions of numbers in the entries; None with functions of coordinates."""
    field, entries = structure.field, [e for row in structure.tensor for e in row]
    functions = {name for each in entries for name in field.functions_in(each)}
    if any(field.reach(field[name]) for name in functions):
        return None
    reached = {name for each in entries for name in field.reach(each)}
    return sorted((reached - {*structure.names}) | functions)


def parametric_casimirs(
    structure: PoissonStructure, constants: Sequence[str], degree: int, expected: int
) -> Iterator[Element]:
    """Casimirs up to a degree, none of more than `MONOMIALS_OF_ONE` monomials.

    Args:
        structure: Its entries are polynomials in the coordinates.
        constants: What else they contain; see `find_constants`.
        degree: The largest degree.
        expected: How many independent ones there can be.

    Raises:
        AlgebraError: An entry is not a polynomial in the coordinates.
    """
    field, source = structure.field, random.Random(1)  # noqa: S311 (not for secrets)
    values = {name: field.number(Fraction(source.randint(97, 997), 89)) for name in constants}
    tensor = tuple(tuple(_put(field, e, values) for e in row) for row in structure.tensor)
    at = PoissonStructure(field, structure.names, tensor, structure.name)
    for found in polynomial_casimirs(PolynomialBracket(at), degree, expected):
        monomials = [tuple(each) for each in found.monoms()]
        if len(monomials) > MONOMIALS_OF_ONE:
            continue
        casimir = _fit(structure, monomials, values, source)
        if casimir is not None and structure.is_casimir(casimir):
            yield casimir


def _put(field: Field, element: Element, values: dict[str, Element]) -> Element:
    """An element with numbers in the place of its constants."""
    known = {name: field[name] for name in field.reach(element)} | values
    return field.evaluate(element, known, field.number, field.call)


def _fit(
    structure: PoissonStructure,
    monomials: Sequence[Exponents],
    values: dict[str, Element],
    source: random.Random,
) -> Element | None:
    """The combination of monomials that commutes with everything, its first coefficient 1.

    An equation gives a coefficient whose factor is not zero at the numbers of the first search.
    """
    field, names = structure.field, structure.names
    members = [field.polynomial(names, {each: Fraction(1)}) for each in monomials]
    images = [structure.casimir_defects(each) for each in members]
    rows: dict[int, list[Element]] = {}
    for equation in islice(_list_equations(structure, images, source), TRIES * len(members)):
        if len(rows) == len(members) - 1:
            break
        for pivot, row in rows.items():
            equation = _subtract(equation, pivot, row)
        own = (n for n in range(1, len(members)) if _put(field, equation[n], values) != 0)
        if (place := next(own, None)) is None:
            continue
        reduced = [(x / equation[place]).combine() for x in equation]
        rows = {pivot: _subtract(row, place, reduced) for pivot, row in rows.items()}
        rows[place] = reduced
    if len(rows) < len(members) - 1:
        return None
    return members[0] - field.sum(row[0] * members[n] for n, row in rows.items())


def _subtract(equation: list[Element], pivot: int, row: list[Element]) -> list[Element]:
    """An equation without the unknown that a row gives."""
    factor = equation[pivot]
    if factor == 0:
        return equation
    return [(x - factor * y).combine() for x, y in zip(equation, row, strict=True)]


def _list_equations(
    structure: PoissonStructure, images: Sequence[Sequence[Element]], source: random.Random
) -> Iterator[list[Element]]:
    """``{x_i, m}`` of all monomials m at random points, one i after the other."""
    field = structure.field
    while True:
        point = {name: field.number(source.randint(-9, 9)) for name in structure.names}
        for row in zip(*images, strict=True):
            yield [field.substitute(each, point) for each in row]
