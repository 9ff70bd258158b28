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
from math import comb, prod

from coadjoint.algebra import LieAlgebra
from coadjoint.errors import AlgebraError
from coadjoint.exact.linear import Span, nullspace
from coadjoint.limits import INVARIANT_TERMS
from coadjoint.poisson.polynomial_bracket import PolynomialBracket
from coadjoint.poisson.polynomials import Polynomial, constant, coordinate

Matrix = Mapping[tuple[int, int], Polynomial]


def has_trace_form(algebra: LieAlgebra) -> bool:
    """Whether the algebra has matrices of numbers with a nondegenerate trace form."""
    entries = (x for matrix in algebra.matrices for x in matrix.values())
    if not algebra.matrices or not all(isinstance(x, int | Fraction) for x in entries):
        return False
    return not nullspace(_gram(algebra), algebra.dimension)


def matrix_invariants(algebra: LieAlgebra, bracket: PolynomialBracket) -> list[Polynomial]:
    """Casimirs from the matrix dual to a covector, by degree; some may depend on others.

    Those that would take more than `INVARIANT_TERMS` products of terms are left out.

    Args:
        algebra: An algebra with matrices.
        bracket: Its Lie-Poisson bracket, of either sign, by which each one is proved.

    Raises:
        AlgebraError: There are no matrices, or a vector is orthogonal to all under the trace form.
    """
    dual, size = dual_matrix(algebra), _size(algebra)
    signs = _orthogonal_signs(algebra, size)
    result = _traces(dual, size, algebra) if signs is None else _pfaffians(dual, signs)
    primitive = [p.primitive() for p in result if p.degree > 0]
    for p in primitive:
        assert bracket.is_casimir(p), p
    return sorted(primitive, key=lambda p: (p.degree, len(p.terms)))


def dual_matrix(algebra: LieAlgebra) -> dict[tuple[int, int], Polynomial]:
    """The matrix M in the span of the algebra with ``tr(M e_i) = mu_i``.

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
    entries: dict[tuple[int, int], Polynomial] = {}
    for i in range(n):
        for k, c in (span.coordinates({i: 1}) or {}).items():
            for place, value in algebra.matrices[k].items():
                old = entries.get(place, Polynomial({}))
                entries[place] = old + coordinate(i, n) * constant(Fraction(c * value), n)
    return {place: p for place, p in entries.items() if p.terms}


def _gram(algebra: LieAlgebra) -> list[dict[int, Fraction]]:
    """``tr(e_i e_j)``, sparse rows."""
    rows: list[dict[int, Fraction]] = []
    for a in algebra.matrices:
        products = {
            j: sum((x * b.get((c, r), 0) for (r, c), x in a.items()), Fraction(0))
            for j, b in enumerate(algebra.matrices)
        }
        rows.append({j: value for j, value in products.items() if value})
    return rows


def _size(algebra: LieAlgebra) -> int:
    return 1 + max(max(place) for matrix in algebra.matrices for place in matrix)


# -- traces ---------------------------------------------------------------------------------------


def _traces(dual: Matrix, size: int, algebra: LieAlgebra) -> Iterator[Polynomial]:
    """``tr M^k``, and ``tr i M^k`` where the matrices are complex ones written as real ones.

    Skew-Hermitian matrices have imaginary traces of odd powers, which only the second form sees.
    """
    half, n = size // 2, algebra.dimension
    unit = {(r + half, r): 1 for r in range(half)} | {(r, r + half): -1 for r in range(half)}
    is_complex = size % 2 == 0 and all(_commute(unit, m) for m in algebra.matrices)
    identity: Matrix = {(r, r): constant(1, n) for r in range(size)}
    imaginary: Matrix = {place: constant(x, n) for place, x in unit.items()}
    powers = [identity, dual]
    for k in range(1, (half if is_complex else size) + 1):
        if len(powers) <= (k + 1) // 2:
            powers.append(_product(powers[-1], dual))
        # two halves, so that no entry of M^k itself is ever multiplied out
        left, right = powers[k // 2], powers[k - k // 2]
        if _products(left, right) > INVARIANT_TERMS:
            return
        yield _trace(left, right)
        if is_complex:
            yield _trace(_product(imaginary, left), right)


def _products(a: Matrix, b: Matrix) -> int:
    """How many products of terms the trace of a product of matrices takes."""
    return sum(len(p.terms) * len(b[c, r].terms) for (r, c), p in a.items() if (c, r) in b)


def _trace(a: Matrix, b: Matrix) -> Polynomial:
    """``tr(a b)``."""
    return _sum([p * b[c, r] for (r, c), p in a.items() if (c, r) in b])


def _commute(a: Mapping[tuple[int, int], int], b: Mapping[tuple[int, int], Fraction]) -> bool:
    """``a b = b a`` for a matrix with one entry in each row and column."""
    row_of = {c: (r, x) for (r, c), x in a.items()}
    moved = {(row_of[r][0], c): row_of[r][1] * x for (r, c), x in b.items()}
    column_of = {r: (c, x) for (r, c), x in a.items()}
    return moved == {(r, column_of[c][0]): column_of[c][1] * x for (r, c), x in b.items()}


def _product(a: Matrix, b: Matrix) -> Matrix:
    """The product of sparse matrices of polynomials."""
    parts: dict[tuple[int, int], list[Polynomial]] = {}
    for (r, m), x in a.items():
        for (k, c), y in b.items():
            if m == k:
                parts.setdefault((r, c), []).append(x * y)
    return {place: _sum(terms) for place, terms in parts.items()}


def _sum(parts: Sequence[Polynomial]) -> Polynomial:
    terms: dict[tuple[int, ...], int | Fraction] = {}
    for part in parts:
        for exponents, value in part.terms.items():
            terms[exponents] = terms.get(exponents, 0) + value
    return Polynomial({e: value for e, value in terms.items() if value})


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


def _pfaffians(dual: Matrix, signs: Sequence[int]) -> Iterator[Polynomial]:
    """Coefficients of det(lambda - M): sums of squares of Pfaffians of K M; the Pfaffian last.

    A Pfaffian of 2m rows has 1 * 3 * ... * (2m - 1) terms.
    """
    size = len(signs)

    @cache
    def pfaffian(rows: tuple[int, ...]) -> Polynomial:
        first, rest = rows[0], rows[1:]
        if len(rest) == 1:
            return entry(first, rest[0])
        terms = [
            entry(first, k) * pfaffian(rest[:n] + rest[n + 1 :]) * sign[n % 2]
            for n, k in enumerate(rest)
        ]
        return _sum(terms)

    def entry(r: int, c: int) -> Polynomial:
        return dual[r, c] * sign[signs[r] < 0]

    n = len(next(iter(next(iter(dual.values())).terms)))
    sign = constant(1, n), constant(-1, n)
    for half in range(1, (size + 1) // 2):
        squares = []
        if comb(size, 2 * half) * prod(range(1, 2 * half, 2)) ** 2 > INVARIANT_TERMS:
            break
        for rows in combinations(range(size), 2 * half):
            p = pfaffian(rows)
            negative = sum(signs[r] < 0 for r in rows) % 2
            squares.append(p * p * sign[negative])
        yield _sum(squares)
    if size % 2 == 0 and prod(range(1, size, 2)) <= INVARIANT_TERMS:
        yield pfaffian(tuple(range(size)))
