"""Polynomials in what moves, with coefficients that depend on parameters alone.

Comes in: nodes. Goes out: sums of terms, in which equal products of names are one term, so that a
term that cancels is gone. A term is a pair of products: names that move, and names of constants.
Read next: `coadjoint.lower.motion`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction

from coadjoint.lower.program import ZERO, Add, Multiply, Negate, Node, Number, Symbol

#: Names in order; a power has its name several times.
Product = tuple[str, ...]
#: The factor of each pair of a product that moves and a product of constants.
Polynomial = Mapping[tuple[Product, Product], Fraction]
#: A polynomial in constants.
Constant = Mapping[Product, Fraction]
#: A product with more terms is not multiplied out.
LONGEST = 60


class TooLongError(Exception):
    """A product has too many terms."""


def scaled(factor: Fraction, constants: Product = ()) -> Polynomial:
    """A number times a product of constants."""
    return {((), constants): factor} if factor else {}


def moving(name: str) -> Polynomial:
    """One thing that moves."""
    return {((name,), ()): Fraction(1)}


def add(*polynomials: Polynomial) -> Polynomial:
    """The sum; what cancels is left out."""
    total = dict[tuple[Product, Product], Fraction]()
    for each in polynomials:
        for term, factor in each.items():
            total[term] = total.get(term, Fraction(0)) + factor
    return {term: factor for term, factor in total.items() if factor}


def multiply(left: Polynomial, right: Polynomial) -> Polynomial:
    """The product.

    Raises:
        TooLongError: It has more than `LONGEST` terms.
    """
    if min(len(left), len(right)) > 1 and len(left) * len(right) > LONGEST:
        raise TooLongError
    return add(
        *(
            {(_joined(a, c), _joined(b, d)): x * y}
            for (a, b), x in left.items()
            for (c, d), y in right.items()
        )
    )


def _joined(left: Product, right: Product) -> Product:
    return tuple(sorted((*left, *right)))


def by_product(polynomial: Polynomial) -> dict[Product, Constant]:
    """The coefficient of each product that moves, and of 1."""
    found = dict[Product, dict[Product, Fraction]]()
    for (product, rest), factor in polynomial.items():
        found.setdefault(product, {})[rest] = factor
    return dict(found)


def is_difference(polynomial: Polynomial) -> bool:
    """Whether this is a difference of like things, a coordinate less a coordinate or a number.

    Multiplied out, its terms lose what they have in common only after they were rounded.
    """
    plain = [
        factor for (product, rest), factor in polynomial.items() if len(product) < 2 and not rest
    ]
    return bool(plain) and min(plain) < 0 < max(plain)


def sum_of(terms: Iterable[tuple[bool, Node]]) -> Node:
    """A sum of terms, each with whether it is subtracted; one that is added comes first."""
    added, *rest = sorted(terms, key=lambda term: term[0]) or [(False, ZERO)]
    total = Negate(added[1]) if added[0] else added[1]
    for is_negative, term in rest:
        total = Add(total, Negate(term) if is_negative else term)
    return total


def product_of(factors: Iterable[Node]) -> Node:
    """A product from left to right."""
    total, *rest = factors
    for factor in rest:
        total = Multiply(total, factor)
    return total


def node_of(value: Constant) -> Node:
    """A constant as it is computed."""
    return sum_of(_terms(value))


def _terms(value: Constant) -> Iterator[tuple[bool, Node]]:
    for names, factor in value.items():
        size = abs(factor)
        numbers = [] if names and size == 1 else [Number(size)]
        yield factor < 0, product_of([*numbers, *map(Symbol, names)])
