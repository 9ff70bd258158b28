r"""Casimirs of matrix algebras: invariants of the matrix that stands for a covector.

Where the trace form ``tr(X Y)`` of an algebra of matrices is nondegenerate, a covector mu is the
matrix M with ``tr(M e_i) = mu_i``, and the coadjoint motion conjugates M: coefficients of its
characteristic polynomial and traces of its powers are Casimirs. For so(p, q) the coefficients are
sums of squares of Pfaffians, and for an even number of axes the Pfaffian itself is one.
Comes in: an algebra with matrices and its Lie-Poisson bracket. Goes out: polynomials, each proved
to be a Casimir. Read next: `coadjoint.poisson.casimirs`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cache
from itertools import combinations
from math import comb, lcm, prod
from typing import Any

from sympy.polys.rings import PolyElement

from coadjoint.algebra import LieAlgebra
from coadjoint.algebra.matrices import commutator, product, size
from coadjoint.errors import AlgebraError
from coadjoint.exact.dense import total
from coadjoint.exact.linear import Span, add_multiple, nullspace
from coadjoint.limits import INVARIANT_TERMS
from coadjoint.poisson.polynomial_bracket import PolynomialBracket
from coadjoint.poisson.polynomials import primitive, ring_of

Matrix = Mapping[tuple[int, int], PolyElement]


def has_trace_form(algebra: LieAlgebra) -> bool:
    """Whether the algebra has matrices of numbers with a nondegenerate trace form."""
    entries = (x for matrix in algebra.matrices for x in matrix.values())
    if not algebra.matrices or not all(isinstance(x, int | Fraction) for x in entries):
        return False
    return not nullspace(_gram(algebra), algebra.dimension)


def matrix_invariants(algebra: LieAlgebra, bracket: PolynomialBracket) -> list[PolyElement]:
    """Casimirs from the matrix dual to a covector, by degree; some may depend on others.

    Those that would take more than `INVARIANT_TERMS` products of terms are left out.

    Args:
        algebra: An algebra with matrices.
        bracket: Its Lie-Poisson bracket, of either sign, by which each one is proved.

    Raises:
        AlgebraError: There are no matrices, or a vector is orthogonal to all under the trace form.
    """
    dual, signs = dual_matrix(algebra), _orthogonal_signs(algebra, size(algebra.matrices))
    invariants = _traces(dual, algebra) if signs is None else _pfaffians(dual, signs)
    result = [primitive(p) for p in invariants if p and not p.is_ground]
    for p in result:
        assert bracket.is_casimir(p), p
    return sorted(result, key=lambda p: (sum(p.LM), len(p)))


def dual_matrix(algebra: LieAlgebra) -> dict[tuple[int, int], PolyElement]:
    """A multiple of M, in the span of the algebra with ``tr(M e_i) = mu_i``: one that is whole.

    Raises:
        AlgebraError: The trace form is degenerate; the message shows a vector orthogonal to all.
    """
    n, gram = algebra.dimension, _gram(algebra) if algebra.matrices else []
    null = nullspace(gram, n)
    if null:
        vector = " + ".join(f"({c}) {algebra.basis[k]}" for k, c in null[0].items())
        raise AlgebraError(
            f"{algebra.name}: the trace form is degenerate: tr(X Y) = 0 for X = {vector} and every "
            "Y (an algebra without matrices has none). Search for polynomials instead.",
            algebra=algebra.name,
            vector={algebra.basis[k]: str(c) for k, c in null[0].items()},
        )
    span = Span(gram)  # unit vectors in the rows of the Gram matrix: its inverse, column by column
    entries: dict[tuple[int, int], dict[int, Any]] = {}
    for i in range(n):
        for k, c in (span.coordinates({i: 1}) or {}).items():
            for place, value in algebra.matrices[k].items():
                add_multiple(entries.setdefault(place, {}), c, {i: value})
    common = lcm(*(x.denominator for row in entries.values() for x in row.values()))
    gens = ring_of(n).gens
    return {
        place: total([gens[i] * int(common * x) for i, x in row.items()])
        for place, row in entries.items()
        if row
    }


def _gram(algebra: LieAlgebra) -> list[dict[int, Any]]:
    """``tr(e_i e_j)`` by rows."""
    return [
        {
            j: sum(x * b.get((c, r), 0) for (r, c), x in a.items())
            for j, b in enumerate(algebra.matrices)
        }
        for a in algebra.matrices
    ]


# -- traces ---------------------------------------------------------------------------------------


def _traces(dual: Matrix, algebra: LieAlgebra) -> Iterator[PolyElement]:
    """``tr M^k``, and ``tr i M^k`` where the matrices are complex ones written as real ones.

    Skew-Hermitian matrices have imaginary traces of odd powers, which only the second form sees.
    """
    rows = size(algebra.matrices)
    half, one = rows // 2, ring_of(algebra.dimension).one
    unit = {(r + half, r): 1 for r in range(half)} | {(r, r + half): -1 for r in range(half)}
    is_complex = rows % 2 == 0 and not any(commutator(unit, m) for m in algebra.matrices)
    powers: list[Matrix] = [{(r, r): one for r in range(rows)}, dual]
    for k in range(1, (half if is_complex else rows) + 1):
        if len(powers) <= (k + 1) // 2:
            powers.append(product(powers[-1], dual))
        # two halves, so that no entry of M^k itself is ever multiplied out
        left, right = powers[k // 2], powers[k - k // 2]
        if _products(left, right) > INVARIANT_TERMS:
            return
        yield _trace(left, right)
        if is_complex:
            yield _trace(product(unit, left), right)


def _products(a: Matrix, b: Matrix) -> int:
    """How many products of terms the trace of a product of matrices takes."""
    return sum(len(p) * len(b[c, r]) for (r, c), p in a.items() if (c, r) in b)


def _trace(a: Matrix, b: Matrix) -> PolyElement:
    """``tr(a b)``."""
    return total([p * b[c, r] for (r, c), p in a.items() if (c, r) in b])


# -- Pfaffians ------------------------------------------------------------------------------------


def _orthogonal_signs(algebra: LieAlgebra, size: int) -> list[int] | None:
    """Signs K with ``K X`` antisymmetric for all matrices of an so(p, q), else None."""
    signs = [1] + [0] * (size - 1)
    for matrix in algebra.matrices:
        for (r, c), x in matrix.items():
            if r == 0 and c and matrix.get((c, r)) in (x, -x):
                signs[c] = -1 if matrix[c, r] == x else 1
    fits = all(
        signs[r] * x == -signs[c] * matrix.get((c, r), 0) != 0
        for matrix in algebra.matrices
        for (r, c), x in matrix.items()
    )
    return signs if fits and algebra.dimension == size * (size - 1) // 2 else None


def _pfaffians(dual: Matrix, signs: Sequence[int]) -> Iterator[PolyElement]:
    """Coefficients of det(lambda - M): sums of squares of Pfaffians of K M; the Pfaffian last.

    A Pfaffian of 2m rows has 1 * 3 * ... * (2m - 1) terms.
    """
    size = len(signs)

    @cache
    def pfaffian(rows: tuple[int, ...]) -> PolyElement:
        if not rows:
            return 1
        first, rest = rows[0], rows[1:]
        terms = [
            dual[first, k] * pfaffian(rest[:n] + rest[n + 1 :]) * (signs[first] * (-1) ** n)
            for n, k in enumerate(rest)
        ]
        return total(terms)

    for half in range(1, (size + 1) // 2):
        squares = []
        if comb(size, 2 * half) * prod(range(1, 2 * half, 2)) ** 2 > INVARIANT_TERMS:
            break
        for rows in combinations(range(size), 2 * half):
            p = pfaffian(rows)
            negative = sum(signs[r] < 0 for r in rows) % 2
            squares.append(p * p * (-1) ** negative)
        yield total(squares)
    if size % 2 == 0 and prod(range(1, size, 2)) <= INVARIANT_TERMS:
        yield pfaffian(tuple(range(size)))
