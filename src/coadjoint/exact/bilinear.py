"""Sums of products of polynomials, put together at once.

Comes in: numbers and pairs of elements. Goes out: the sum of all products. A bracket on so(20) has
6840 products of generators among four hundred: one element for each of them, and for each sum of
two, takes three times as long.
Read next: `coadjoint.algebra.lie_algebra`.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any


def sum_products(terms: Sequence[tuple[Any, Any, Any]]) -> Any:
    """``sum c x y`` over terms ``(c, x, y)``; None unless all are polynomials and numbers."""
    if not terms or not all(
        isinstance(c, int | Fraction) and _is_polynomial(x) and _is_polynomial(y)
        for c, x, y in terms
    ):
        return None
    from sympy.polys.domains import QQ  # plain numbers need no SymPy

    from coadjoint.exact.element import Element

    factors, known = terms[0][1].factors, dict[Any, Any]()
    multiply = factors.ring.monomial_mul
    for c, x, y in terms:
        size = QQ(c.numerator, c.denominator)
        factors.spend(len(x.parts[0].numer) * len(y.parts[0].numer))
        for one, a in x.parts[0].numer.items():
            for other, b in y.parts[0].numer.items():
                place = multiply(one, other)
                known[place] = known.get(place, 0) + size * a * b
    return Element(factors, [(factors.ring.from_dict(known), {})])


def _is_polynomial(value: Any) -> bool:
    """Whether a value is an element without denominators that is not zero."""
    parts: Any = getattr(value, "parts", ())
    return len(parts) == 1 and not parts[0].powers
