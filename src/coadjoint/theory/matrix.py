"""Matrices for the groups: products, powers, adjugates and coordinates over any exact values.

Comes in: tuples of rows whose entries are exact field elements, with plain 0 and 1 where the
structure of a group puts them. Goes out: the same. No general inverse is taken where a group knows
its own. Read next: `coadjoint.theory.linear_part`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from typing import Any

from coadjoint.algebra.matrices import SparseMatrix
from coadjoint.exact.dense import Matrix, add, identity, product, scale, subtract, trace
from coadjoint.exact.linear import Span

#: A number ``a + b J``, J being a complex structure that commutes with the matrices at hand.
Complex = tuple[Any, Any]


# -- adjugates by traces ----------------------------------------------------------------------


def resolvent(a: Matrix, J: Matrix | None = None) -> tuple[Matrix, Complex]:
    """``adj(1 - a)`` and ``det(1 - a)``, so that ``(1 - a)^-1`` is their quotient.

    Args:
        a: A matrix.
        J: A complex structure, ``J^2 = -1``, that commutes with `a`: adjugate and determinant are
            then those of the complex matrix of half the size.
    """
    steps = list(_faddeev_leverrier(a, J))
    determinant = 1 + sum(c[0] for _, c in steps), sum(c[1] for _, c in steps)
    return reduce(add, (M for M, _ in steps)), determinant


def determinant(a: Matrix, J: Matrix | None = None) -> Complex:
    """``det a``, as a complex number where a complex structure is given."""
    *_, (_, c) = steps = list(_faddeev_leverrier(a, J))
    return _scale(c, -1 if len(steps) % 2 else 1)


def _scale(c: Complex, factor: int) -> Complex:
    """A complex number times an integer."""
    return factor * c[0], factor * c[1]


def _faddeev_leverrier(a: Matrix, J: Matrix | None) -> Iterator[tuple[Matrix, Complex]]:
    """Pairs ``M_k, c_(n-k)`` with ``adj(s - a) = sum s^(n-k) M_k``, ``det(s - a) = sum s^j c_j``.

    ``M_1 = 1``, ``c_(n-k) = -tr(a M_k) / k``, ``M_(k+1) = a M_k + c_(n-k)``. It divides by integers
    only, so polynomials stay polynomials; elimination would fill the denominators with minors.
    """
    size = len(a)
    one, M = identity(size), identity(size)
    for k in range(1, (size if J is None else size // 2) + 1):
        aM = product(a, M)
        c: Complex = (trace(aM) * Fraction(-1, k), 0)
        shift = scale(c[0], one)
        if J is not None:  # the complex trace is half of tr(aM) - J tr(J aM)
            c = (c[0] * Fraction(1, 2), trace(product(J, aM)) * Fraction(1, 2 * k))
            shift = complex_multiple(c, J)
        yield M, c
        M = add(aM, shift)


def complex_multiple(c: Complex, J: Matrix) -> Matrix:
    """The matrix ``a + b J`` of the number ``c = (a, b)``."""
    return add(scale(c[0], identity(len(J))), scale(c[1], J))


# -- nilpotent matrices -----------------------------------------------------------------------


def exponential(nilpotent: Matrix) -> Matrix:
    """``exp`` of a nilpotent matrix, a polynomial in it."""
    return _series(nilpotent, lambda k, term: scale(Fraction(1, k), term))


def unipotent_inverse(u: Matrix) -> Matrix:
    """``u^-1 = sum (1 - u)^k``, which ends because ``1 - u`` is nilpotent."""
    return _series(subtract(identity(len(u)), u), lambda _, term: term)


def unipotent_logarithm(u: Matrix) -> Matrix:
    """``log u = sum -(1 - u)^k / k``, which ends because ``1 - u`` is nilpotent."""
    one = identity(len(u))
    # 1 + n + n^2/2 + n^3/3 + ..., each term from the one before
    series = _series(subtract(one, u), lambda k, term: scale(Fraction(max(k - 1, 1), k), term))
    return subtract(one, series)


def _series(nilpotent: Matrix, scale: Any) -> Matrix:
    """``1 + n + ...``, each term the scaled product of the one before with the nilpotent n."""
    total = term = identity(len(nilpotent))
    for k in range(1, len(nilpotent)):
        term = scale(k, product(term, nilpotent))
        total = add(total, term)
    return total


# -- coordinates ------------------------------------------------------------------------------


def coordinate_readers(
    matrices: Sequence[SparseMatrix],
) -> list[Mapping[tuple[int, int], Any]] | None:
    """For each matrix of a basis the weights of entries that give its coordinate.

    Entries where few basis matrices meet are read first, so most coordinates are one entry.

    Returns:
        ``r_i`` with ``sum over places of r_i e_j = delta_ij``, or None if the matrices are linearly
        dependent.

    >>> coordinate_readers([{(0, 1): 1, (1, 0): -1}, {(0, 0): 2}])
    [{(0, 1): 1}, {(0, 0): Fraction(1, 2)}]
    """
    meeting: dict[tuple[int, int], dict[int, Any]] = {}
    for i, matrix in enumerate(matrices):
        for place, value in matrix.items():
            meeting.setdefault(place, {})[i] = value
    places = sorted(meeting, key=lambda place: (len(meeting[place]), place))
    span = Span(meeting[place] for place in places)
    if span.rank < len(matrices):
        return None
    weights = [span.coordinates({i: 1}) or {} for i in range(len(matrices))]
    return [{places[number]: value for number, value in row.items()} for row in weights]
