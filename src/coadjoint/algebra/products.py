"""Products of Lie algebras; so far the semidirect product with a representation.

Comes in: an algebra and a representation. Goes out: a new `LieAlgebra`, checked like any other.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from coadjoint.algebra.lie_algebra import LieAlgebra, from_brackets
from coadjoint.algebra.representation import Representation


def semidirect_product(
    algebra: LieAlgebra,
    representations: Sequence[tuple[str, Representation]],
    name: str = "",
) -> LieAlgebra:
    """``g (s) V``: ``[(xi, u), (eta, w)] = ([xi, eta], rho(xi) w - rho(eta) u)``.

    Args:
        algebra: g.
        representations: Pairs (prefix of the new basis names, representation on V); several give
            the product with their direct sum.
        name: Name of the product; by default ``g (s) R^n``.
    """
    basis, blocks = list(algebra.basis), dict(algebra.blocks)
    brackets: dict[tuple[int, int], dict[int, Fraction]] = {
        pair: dict(row) for pair, row in algebra.constants.items()
    }
    for prefix, representation in representations:
        start = len(basis)
        basis += [f"{prefix}{n + 1}" for n in range(representation.dimension)]
        blocks[prefix] = tuple(range(start, len(basis)))
        for i, matrix in enumerate(representation.matrices):
            for (row, column), value in matrix.items():
                brackets.setdefault((i, start + column), {})[start + row] = value
    extra = len(basis) - algebra.dimension
    return from_brackets(name or f"{algebra.name} (s) R^{extra}", basis, brackets, blocks)
