"""Nesting: sums of products with common factors in front of sums, as Horner's scheme has them.

Comes in: signed products. Goes out: the same sum with the factor that most terms have in front of
these, and so on within: ``k2*w1*w2 + k3*w1*w3 - k1*w2^2`` becomes ``w1*(k2*w2 + k3*w3) - k1*w2^2``.
Sums within that lack one addend of a common sum are completed where what is added is zero in all:
of ``(k . w) w - (w . w) k`` each component lacks ``k_i w_i`` in the one and ``w_i^2`` in the other.
Read next: `coadjoint.lower.lowering`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import combinations
from operator import and_
from typing import Final

from coadjoint.lower.products import Product

#: Which of the factors that as many terms have goes in front: the first one, or the last one.
ORDERS: Final = (1, -1)
#: What begins the name of a coefficient, which is a factor like those that move.
COEFFICIENT: Final = "@"


@dataclass(frozen=True)
class Term:
    """A signed product."""

    sign: int
    product: Product

    def without(self, factors: Product) -> Term:
        """The product without some of its factors."""
        rest = list(self.product)
        for factor in factors:
            rest.remove(factor)
        return Term(self.sign, tuple(rest))


@dataclass(frozen=True)
class Nest:
    """A product in front of a sum."""

    lead: Product
    inner: Sum


#: Addends in order.
Sum = tuple[Term | Nest, ...]
#: Outputs that must have a sum in common before it is completed.
SHARED: Final = 3
#: The place, the lead and the addends of a sum in a sum.
_Flat = tuple[int, Product, frozenset[Term]]
#: Whole sums by their places.
_Wholes = dict[int, frozenset[Term]]


def nest(terms: Sequence[Term], order: int) -> Sum:
    """A sum with its common factors in front.

    Args:
        terms: The addends.
        order: One of `ORDERS`.

    >>> terms = [Term(1, ("x", "y")), Term(-1, ("x", "z")), Term(1, ("y",))]
    >>> nest(terms, 1)[0].lead, nest(terms, -1)[0].lead
    (('x',), ('y',))
    """
    counts = Counter[str]()
    for term in terms:
        counts.update(dict.fromkeys(term.product, 1))
    best = max([*counts][::order], key=counts.__getitem__, default=None)
    if best is None or counts[best] == 1:
        return tuple(terms)
    having = [term for term in terms if best in term.product]
    others = [term for term in terms if best not in term.product]
    common = reduce(and_, (Counter(term.product) for term in having))
    lead = tuple(
        factor for factor in dict.fromkeys(having[0].product) for _ in range(common[factor])
    )
    inner = [term.without(lead) for term in having]
    return (Nest(lead, nest(inner, order)), *nest(others, order))


def complete(sums: Sequence[Sum]) -> list[Sum]:
    """Sums in which pairs of sums behind leads become those of two others, or more.

    Both get the addend that they lack, and its two products with the leads cancel.

    Args:
        sums: Of all outputs, as `nest` leaves them.
    """
    flat = [[*_flat_nests(addends)] for addends in sums]
    inner = dict.fromkeys(terms for nests in flat for _, _, terms in nests)
    pairs = combinations(inner, 2)
    wholes = dict.fromkeys(a | b for a, b in pairs if len(a) == len(b) == len(a & b) + 1)
    found = {n: each for n, nests in enumerate(flat) if (each := _completion(nests, wholes))}
    while rare := [n for n, each in found.items() if _is_rare(each, found.values())]:
        found = {n: each for n, each in found.items() if n not in rare}
    order = dict[Term, int]()
    for terms in inner:
        for term in sorted(terms, key=lambda each: (each.product, each.sign)):
            order.setdefault(term, len(order))
    return [_replace(addends, found.get(n, {}), order) for n, addends in enumerate(sums)]


def _flat_nests(addends: Sum) -> Iterator[_Flat]:
    """The nests of two different products or more, without nests in them."""
    for place, each in enumerate(addends):
        if isinstance(each, Nest):
            terms = frozenset(term for term in each.inner if isinstance(term, Term))
            if len(terms) == len(each.inner) > 1:
                yield place, each.lead, terms


def _completion(nests: Sequence[_Flat], wholes: Iterable[frozenset[Term]]) -> _Wholes:
    """Two places with the whole sums that may stand there; nothing where there are none."""
    lacking = [
        (place, lead, whole, next(iter(whole - terms)))
        for whole in wholes
        for place, lead, terms in nests
        if terms < whole and len(terms) == len(whole) - 1
    ]
    for (m, lead, whole, a), (n, other, second, b) in combinations(lacking, 2):
        same = sorted((*lead, *a.product)) == sorted((*other, *b.product))
        if m != n and a.sign == -b.sign and same:
            return {m: whole, n: second}
    return {}


def _is_rare(own: _Wholes, found: Collection[_Wholes]) -> bool:
    """Whether one of the whole sums would not be that of three outputs."""
    return any(sum(whole in each.values() for each in found) < SHARED for whole in own.values())


def _replace(addends: Sum, wholes: _Wholes, order: Mapping[Term, int]) -> Sum:
    """A sum with whole sums in some places, their addends in order."""
    replaced = list(addends)
    for place, whole in wholes.items():
        each = replaced[place]
        assert isinstance(each, Nest), "flat nests have these places"
        terms: list[Term] = sorted(whole, key=order.__getitem__)
        replaced[place] = Nest(each.lead, tuple(terms))
    return tuple(replaced)


def list_products(addends: Sum) -> Iterator[Product]:
    """The products that are left of a sum."""
    for each in addends:
        if isinstance(each, Nest):
            yield each.lead
            yield from list_products(each.inner)
        else:
            yield each.product
