"""Division of a polynomial by several, in the order grevlex: what is left of it.

Comes in: a polynomial and its divisors, of one ring. Goes out: the remainder, term by term that of
`sympy.polys.rings.PolyElement.rem`. SymPy looks for the leading term among all terms after each
step; a heap hands it out, which makes a hundred thousand terms a matter of seconds.
Read next: `coadjoint.prove.ideals`.

Source:
    Cox, Little and O'Shea, Ideals, Varieties, and Algorithms, 4th ed., section 2.3, theorem 3.
"""

from __future__ import annotations

from collections.abc import Sequence
from heapq import heapify, heappop, heappush

from sympy.polys.rings import PolyElement

_Monomial = tuple[int, ...]


def find_remainder(p: PolyElement, divisors: Sequence[PolyElement]) -> PolyElement:
    """What is left of a polynomial; no term of it is a multiple of a leading term of a divisor.

    Each leading term is divided by the first divisor that divides it.

    Args:
        p: Over a field, in a ring with the order grevlex.
        divisors: Not 0.

    >>> from sympy import QQ, grevlex, ring
    >>> _, x, y = ring("x, y", QQ, grevlex)
    >>> find_remainder(x**2 * y + x * y**2 + y**2, [x * y - 1, y**2 - 1])
    x + y + 1
    """
    ring = p.ring
    quo = ring.domain.quo
    known = []
    for divisor in divisors:
        leading, factor = divisor.LT
        support = [(place, e) for place, e in enumerate(leading) if e]
        others = [(m, value) for m, value in divisor.terms() if m != leading]
        known.append((support, leading, factor, others))
    left = dict(p)
    heap = [(_descending(m), m) for m in left]
    heapify(heap)
    rest = ring.zero
    while heap:
        _, monomial = heappop(heap)
        value = left.pop(monomial, None)
        if value is None:  # it was cancelled
            continue
        for support, leading, factor, others in known:
            if all(monomial[place] >= e for place, e in support):
                shift = tuple(a - b for a, b in zip(monomial, leading, strict=True))
                times = quo(value, factor)
                for m, other in others:
                    place = tuple(a + b for a, b in zip(m, shift, strict=True))
                    if place not in left:
                        left[place] = -times * other
                        heappush(heap, (_descending(place), place))
                    elif new := left[place] - times * other:
                        left[place] = new
                    else:
                        del left[place]
                break
        else:
            rest[monomial] = value
    return rest


def _descending(monomial: _Monomial) -> tuple[int, _Monomial]:
    """Smaller for a larger monomial, in the order grevlex."""
    return -sum(monomial), monomial[::-1]
