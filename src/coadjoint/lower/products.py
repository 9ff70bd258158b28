"""Shared factors of products, found before anything is multiplied out.

Comes in: products as lists of factor names. Goes out: the same products over new names, each of
which stands for a pair that occurred more than once: ``m g chi1, m g chi2`` become ``p chi1,
p chi2`` with ``p = m g``, and ``x^4`` becomes ``(x x)(x x)``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

#: Factor names in the order in which they are multiplied.
Product = tuple[str, ...]
Pair = tuple[str, str]


def share_pairs(
    products: list[Product], new_name: Callable[[int], str]
) -> tuple[list[Product], dict[str, Pair]]:
    """Replace the most frequent pair of factors until none occurs twice.

    Args:
        products: What is to be multiplied; equal products count once.
        new_name: Name of the n-th pair.

    Returns:
        The products over old and new names, in the same order, and what the new names stand for.
    """
    current = [list(product) for product in dict.fromkeys(products)]
    pairs: dict[str, Pair] = {}
    counts = _Counts(current)
    while (best := counts.most_frequent()) is not None:
        name = new_name(len(pairs) + 1)
        pairs[name] = best
        counts.replace(best, name)
    shared = dict(zip(dict.fromkeys(products), map(tuple, current), strict=True))
    return [shared[product] for product in products], pairs


class _Counts:
    """How often each pair occurs, kept while products change: each round counts what changed anew.

    Args:
        products: Which are changed in place.
    """

    def __init__(self, products: list[list[str]]) -> None:
        self._products = products
        self._total: Counter[Pair] = Counter()
        self._places: dict[Pair, set[int]] = {}
        for place in range(len(products)):
            self._count(place)

    def most_frequent(self) -> Pair | None:
        """The pair that occurs most often, and first among equals; None if none occurs twice."""
        most = max(self._total.values(), default=0)
        if most < 2:
            return None
        tied = [pair for pair, count in self._total.items() if count == most]
        first = min(min(self._places[pair]) for pair in tied)
        candidates = {pair for pair in tied if first in self._places[pair]}
        return next(pair for pair in _pairs(self._products[first]) if pair in candidates)

    def replace(self, pair: Pair, name: str) -> None:
        """A new name for a pair, wherever it stands."""
        for place in sorted(self._places[pair]):
            for each, count in _pairs(self._products[place]).items():
                self._places[each].discard(place)
                self._total[each] -= count
                if not self._total[each]:
                    del self._total[each], self._places[each]
            self._products[place] = _replace(self._products[place], pair, name)
            self._count(place)

    def _count(self, place: int) -> None:
        """Add the pairs of one product."""
        pairs = _pairs(self._products[place])
        self._total.update(pairs)
        for each in pairs:
            self._places.setdefault(each, set()).add(place)


def _pairs(product: list[str]) -> Counter[Pair]:
    """How often each pair of factors can be taken from a product at once."""
    powers = Counter(product)
    counts: Counter[Pair] = Counter()
    names = list(powers)
    for n, a in enumerate(names):
        if powers[a] > 1:
            counts[a, a] = powers[a] // 2
        for b in names[n + 1 :]:
            counts[a, b] = min(powers[a], powers[b])
    return counts


def _replace(product: list[str], pair: Pair, name: str) -> list[str]:
    """A product with a pair replaced as often as it occurs, the new name where the first stood."""
    times = _pairs(product).get(pair, 0)
    result = list(product)
    for _ in range(times):
        place = result.index(pair[0])
        result[place] = name
        result.remove(pair[1])
    return result
