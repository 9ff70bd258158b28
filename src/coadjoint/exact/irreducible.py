"""Irreducible factors of polynomials, in a time that does not depend on random choices.

SymPy lifts factors from random points, and takes minutes where these are badly chosen; polynomials
of mechanics are linear or quadratic in some symbol, and then their factors follow from coefficients
and a discriminant.
Comes in: polynomials of SymPy, or elements. Goes out: their factors, each once.
Read next: `coadjoint.exact.factors`, which keeps exponents and numbers;
`coadjoint.prove.ideals`, which splits relations.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import reduce
from itertools import combinations
from typing import Any

from sympy.polys.rings import PolyElement

from coadjoint.exact.denominators import remove_factor
from coadjoint.exact.element import Element, numerator, split_by_powers
from coadjoint.exact.factors import common_divisor, in_own_symbols, rational_root, to_fraction
from coadjoint.exact.field import Field

#: Symbols that are eliminated at a time by the relations of functions, to find factors.
ELIMINATED = 2
#: Addends of a polynomial that is factored; larger ones may take minutes.
FACTORED = 400


def all_factors(field: Field, element: Element) -> Iterator[Element]:
    """The irreducible factors of a numerator that is not too long.

    Modulo the relations of functions one form of it may have factors where another has none:
    ``x^2 - y^2 c^2`` has two, ``x^2 - y^2 + y^2 s^2`` has one.
    """
    top = numerator(element)
    if len(top) > FACTORED:
        return
    forms = filter(lambda form: len(form) <= FACTORED, _other_forms(field, top))
    split = (list(_irreducible(form)) for form in (top, *forms))
    whole = next(split)
    result = whole if len(whole) > 1 else next((f for f in split if len(f) > 1), whole)
    for names, factor in result:
        part = field.normal(field.polynomial(names, dict(factor)))
        yield from all_factors(field, part) if len(result) > 1 else (part,)


def _other_forms(field: Field, top: PolyElement) -> Iterator[PolyElement]:
    """A numerator with other symbols eliminated by the relations of its functions."""
    present = top.degrees()
    places = {str(symbol): n for n, symbol in enumerate(top.ring.symbols)}
    choices = [
        (place, power, value)
        for relation in _relations_in(field, top, places)
        for place, power, value in _eliminations(relation)
        if present[place] >= power
    ]
    for count in range(1, min(len(choices), ELIMINATED) + 1):
        for chosen in combinations(choices, count):
            yield reduce(_eliminate, chosen, top)


def _relations_in(
    field: Field, top: PolyElement, places: Mapping[str, int]
) -> Iterator[PolyElement]:
    """``s^2 + c^2 - 1``, and ``h^2 - u`` of ``h = sqrt(u)``, where a numerator has them."""
    present, gens = top.degrees(), top.ring.gens
    for known in field.adjoined.values():
        own = places[known.generator]
        if known.function in ("sin", "sinh"):
            other, side = places[known.partner], 1 if known.function == "sin" else -1
            if present[own] > 0 or present[other] > 0:
                yield gens[own] ** 2 * side + gens[other] ** 2 - 1
        if known.function == "sqrt" and present[own] > 0 and known.argument != 0:
            (argument,) = known.argument.combine().parts
            if not argument.powers:
                yield gens[own] ** 2 - argument.numer


def find_factors(field: Field, element: Element, known: Sequence[Element] = ()) -> list[Element]:
    """The irreducible factors of the numerator of an element, without numbers and repetition.

    Known ones are divided out first: to find factors of many terms takes far longer.

    >>> field = Field(["x", "y"])
    >>> x, y = field["x"], field["y"]
    >>> find_factors(field, (x**2 - y**2) ** 3 / x)
    [x - y, x + y]
    >>> find_factors(field, (x**2 - y**2) ** 3 / x, [x + y, x - 2])
    [x + y, x - y]
    """
    if element == 0:
        return []
    rest, result = numerator(element), list[Element]()
    for divisor in (p for p in map(numerator, known) if not p.is_ground):
        count, rest = remove_factor(rest, divisor)
        result += [field.from_polynomial(divisor)] * bool(count)
    return [*result, *(field.polynomial(names, dict(f)) for names, f in _irreducible(rest))]


def _irreducible(polynomial: PolyElement) -> Iterator[tuple[list[str], PolyElement]]:
    """The irreducible factors, with the names of their symbols: of those that occur alone."""
    if polynomial.is_ground:
        return
    (small,), places = in_own_symbols(polynomial)
    names = [str(polynomial.ring.symbols[n]) for n in places]
    for factor in factors_of(small):
        yield names, factor


#: A symbol by its place, a power of it, and what that is.
Elimination = tuple[int, int, PolyElement]


def _eliminations(relation: PolyElement) -> Iterator[Elimination]:
    """The symbols x of which a relation has ``x`` or ``x^2`` alone, times a number: the root last.

    >>> from sympy import QQ, ring
    >>> _, x, h = ring("x, h", QQ)
    >>> list(_eliminations(h**2 - x**2 - 1))
    [(0, 2, h**2 - 1), (1, 2, x**2 + 1)]
    """
    for place, degree in enumerate(relation.degrees()):
        parts = split_by_powers(relation, place)
        if degree in (1, 2) and len(parts) - (0 in parts) == 1 and parts[degree].is_ground:
            yield place, degree, -parts.get(0, relation.ring.zero) / parts[degree].LC


def _eliminate(polynomial: PolyElement, elimination: Elimination) -> PolyElement:
    """A polynomial with a power of a symbol replaced."""
    place, degree, value = elimination
    symbol, result = polynomial.ring.gens[place], polynomial.ring.zero
    for power, part in split_by_powers(polynomial, place).items():
        result += part * symbol ** (power % degree) * value ** (power // degree)
    return result


def factors_of(polynomial: PolyElement) -> list[PolyElement]:
    """The irreducible factors of a polynomial with whole coefficients, each once.

    >>> from sympy import QQ, ring
    >>> _, x, y = ring("x, y", QQ)
    >>> factors_of(x**2 * (x - y) * (x + y) / 2)
    [x, x - y, x + y]
    """
    result = list[PolyElement]()
    for factor in _factors_of(polynomial):
        whole = factor.primitive()[1]
        whole = -whole if whole.LC < 0 else whole
        result += [whole] if whole not in result else []
    return sorted(result, key=_place_of)


def _place_of(factor: PolyElement) -> tuple[Any, ...]:
    """What sorts factors: symbols by themselves come first, in their order."""
    if len(factor) == 1:
        return 0, tuple(-degree for degree in factor.degrees())
    return 1, len(factor.to_dense()), factor.to_dense()


def _factors_of(polynomial: PolyElement) -> Iterator[PolyElement]:
    r"""The irreducible factors of a polynomial, in a time that does not depend on random choices.

    One that is linear in a symbol has no factors but those of all its coefficients. Of a quadratic
    one the discriminant is a square if it has others: ``4 A p = (2 A x + B - D) (2 A x + B + D)``.
    SymPy lifts factors from random points, and takes minutes where these are badly chosen.
    """
    degrees = [(degree, n) for n, degree in enumerate(polynomial.degrees()) if degree > 0]
    if not degrees:
        return
    degree, place = min(degrees)
    if degree > 2:
        yield from (factor for factor, _ in polynomial.factor_list()[1])
        return
    content, own = _part_content(polynomial, place)
    yield from _factors_of(content)
    if degree == 1:
        yield own
        return
    symbol, parts = polynomial.ring.gens[place], split_by_powers(own, place)
    a, b, c = (parts.get(power, polynomial.ring.zero) for power in (2, 1, 0))
    root = _square_root(b**2 - 4 * a * c)
    if root is None:
        yield own
        return
    yield _part_content(2 * a * symbol + b - root, place)[1]
    yield _part_content(2 * a * symbol + b + root, place)[1]


def _part_content(polynomial: PolyElement, place: int) -> tuple[PolyElement, PolyElement]:
    """The greatest factor without a symbol, and the rest."""
    content = polynomial.ring.zero
    for part in split_by_powers(polynomial, place).values():
        content = common_divisor(content, part)
    return content, polynomial.exquo(content)


def _square_root(polynomial: PolyElement) -> PolyElement | None:
    """The polynomial whose square is a given one; None if there is none."""
    if not polynomial:
        return polynomial
    number, parts = polynomial.sqf_list()
    whole = rational_root(to_fraction(number))
    if whole is None or any(power % 2 for _, power in parts):
        return None
    root = polynomial.ring.one * polynomial.ring.domain(whole.numerator, whole.denominator)
    for part, power in parts:
        root *= part ** (power // 2)
    return root
