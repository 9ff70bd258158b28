"""Gradings of a polynomial Poisson bracket, which split a search into many small ones.

Comes in: the entries of a tensor as polynomials. Goes out: the weight of each coordinate in every
grading by integers and by parity. With weights w and a shift s such that every term of
``{x_i, x_j}`` has the weight ``w_i + w_j + s``, the parts of a Casimir of different weight are
Casimirs by themselves. For so(n) these are the reflections of axes, for the Galilei algebra also
its scalings of length and time, and for a linear bracket the degree is one of them.
Read next: `coadjoint.poisson.casimirs`.
"""

from __future__ import annotations

from collections.abc import Mapping
from operator import mul

from coadjoint.exact.ansatz import Exponents
from coadjoint.exact.linear import nullspace, nullspace_modulo, whole_numbers
from coadjoint.poisson.polynomials import Terms

#: The nonzero entries ``{x_i, x_j}``, both orders of i and j.
Entries = Mapping[tuple[int, int], Terms]
#: Weights of a coordinate or a monomial: integers, then parities as the bits of one integer.
Weight = tuple[tuple[int, ...], int]


class Gradings:
    """All gradings of a bracket.

    Args:
        entries: The tensor.
        size: Number of coordinates.
    """

    def __init__(self, entries: Entries, size: int) -> None:
        relations = _relations(entries, size)
        integral = [whole_numbers(vector) for vector in nullspace(relations, size + 1)]
        parities = nullspace_modulo(relations, size + 1, 2)
        self._integral = [[vector.get(i, 0) for i in range(size)] for vector in integral]
        self._parity = [
            sum(1 << n for n, vector in enumerate(parities) if i in vector) for i in range(size)
        ]

    def weight(self, exponents: Exponents) -> Weight:
        """The weight of a monomial."""
        parity = 0
        for place, exponent in enumerate(exponents):
            parity ^= self._parity[place] * (exponent % 2)
        weights = (sum(map(mul, exponents, along)) for along in self._integral)
        return tuple(weights), parity


def _relations(entries: Entries, size: int) -> list[dict[int, int]]:
    """``w_i + w_j + s - sum_k e_k w_k = 0`` for each term of each entry; s is the last unknown."""
    result = set()
    for (i, j), entry in entries.items():
        for exponents in entry:
            row = [-e for e in exponents] + [1]
            row[i] += 1
            row[j] += 1
            result.add(tuple(row))
    return [{k: value for k, value in enumerate(row) if value} for row in sorted(result)]
