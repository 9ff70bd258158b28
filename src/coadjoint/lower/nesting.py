"""Nesting: sums of products with common factors in front of sums, as Horner's scheme has them.

Comes in: signed products. Goes out: the same sum with the factor that most terms have in front of
these, and so on within: ``k2*w1*w2 + k3*w1*w3 - k1*w2^2`` becomes ``w1*(k2*w2 + k3*w3) - k1*w2^2``.
Read next: `coadjoint.lower.lowering`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import reduce
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


def list_products(addends: Sum) -> Iterator[Product]:
    """The products that are left of a sum."""
    for each in addends:
        if isinstance(each, Nest):
            yield each.lead
            yield from list_products(each.inner)
        else:
            yield each.product
