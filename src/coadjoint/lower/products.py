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
    while True:
        counts: Counter[Pair] = Counter()
        for product in current:
            counts.update(_pairs(product))
        # max takes the first of the most frequent: insertion order, so the result is the same
        # in every run.
        best = max(counts, key=counts.__getitem__, default=None)
        if best is None or counts[best] < 2:
            break
        name = new_name(len(pairs) + 1)
        pairs[name] = best
        current = [_replace(product, best, name) for product in current]
    shared = dict(zip(dict.fromkeys(products), map(tuple, current), strict=True))
    return [shared[product] for product in products], pairs


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
