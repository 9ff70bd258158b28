"""Group actions: hat, breve and tilde, which write so(3), su(2) and their duals as R^3.

Comes in: three-vectors, or matrices of the algebras and their duals. Goes out: the other form. The
factors one half in the pairings and the factor 2 of the tilde map are settled here:

    hat      ``hat(a) b = a x b``,         ``[hat a, hat b] = hat(a x b)``
    tilde    ``tilde(q) = -i q . sigma``,  ``[tilde p, tilde q] = 2 tilde(p x q)``
    su2      ``-(i/2) q . sigma``,         ``[su2 p, su2 q] = su2(p x q)``

Read next: `coadjoint.groups.quaternions`.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from coadjoint.errors import AlgebraError
from coadjoint.exact.dense import Matrix, Vector, product, trace, transpose
from coadjoint.groups.complex_numbers import Complex, I

HALF = Fraction(1, 2)

#: The Pauli matrices: ``sigma_a sigma_b = delta_ab + i epsilon_abc sigma_c``.
PAULI: tuple[Matrix, ...] = (
    ((Complex(0), Complex(1)), (Complex(1), Complex(0))),
    ((Complex(0), -I), (I, Complex(0))),
    ((Complex(1), Complex(0)), (Complex(0), Complex(-1))),
)


# -- so(3) ----------------------------------------------------------------------------------------


def unhat(matrix: Matrix) -> Vector:
    """The three-vector of an antisymmetric matrix; the inverse of `hat`.

    Raises:
        AlgebraError: The matrix is not antisymmetric; the message names the entries.
    """
    for i in range(3):
        for j in range(i + 1):
            if matrix[i][j] + matrix[j][i] != 0:
                raise AlgebraError(
                    f"the matrix is not in so(3): entries ({i + 1}, {j + 1}) and ({j + 1}, "
                    f"{i + 1}) are {matrix[i][j]} and {matrix[j][i]}; expected opposite values. "
                    "For a covector, given up to symmetric matrices, use breve.",
                    entry=[i + 1, j + 1],
                    found=str(matrix[i][j]),
                )
    return (matrix[2][1], matrix[0][2], matrix[1][0])


def pairing_so3(mu: Matrix, xi: Matrix) -> Any:
    """``<mu, xi> = tr(mu^T xi) / 2``, so that ``<hat a, hat b> = a . b``."""
    return HALF * trace(product(transpose(mu), xi))


def breve(mu: Matrix) -> Vector:
    """The three-vector of a covector of so(3).

    ``<mu, hat a> = breve(mu) . a`` for every a defines it. A covector of so(3) is a matrix up to
    symmetric ones, so any 3 x 3 matrix may come in.

    Source:
        Holm (2011), Geometric Mechanics II, section 5.1.3.
    """
    return tuple(HALF * (mu[k][j] - mu[j][k]) for j, k in ((1, 2), (2, 0), (0, 1)))


# -- su(2) ----------------------------------------------------------------------------------------


def tilde(q: Sequence[Any]) -> Matrix:
    """``-i q . sigma``; the product is ``p~ q~ = -(p . q) + (p x q)~``.

    Source:
        Holm (2011), Geometric Mechanics II, section 3.2.2.
    """
    q1, q2, q3 = q
    zero = 0 * q1
    return (
        (Complex(zero, -q3), Complex(-q2, -q1)),
        (Complex(q2, -q1), Complex(zero, q3)),
    )


def untilde(matrix: Matrix) -> Vector:
    """The three-vector of a traceless skew-Hermitian 2 x 2 matrix; the inverse of `tilde`.

    Raises:
        AlgebraError: The matrix is not in su(2); the message shows what differs.
    """
    vector = (-matrix[1][0].im, matrix[1][0].re, -matrix[0][0].im)
    for row, expected in zip(matrix, tilde(vector), strict=True):
        for result, wanted in zip(row, expected, strict=True):
            if result != wanted:
                raise AlgebraError(
                    f"the matrix is not in su(2): it has the entry {result} where {wanted} would "
                    "make it traceless and skew-Hermitian. For a covector, use dual_tilde.",
                    found=str(result),
                    expected=str(wanted),
                )
    return vector


def su2(q: Sequence[Any]) -> Matrix:
    """``-(i/2) q . sigma``, the isomorphism of R^3 with the cross product to su(2)."""
    return tilde(tuple(HALF * component for component in q))


def pairing_su2(mu: Matrix, xi: Matrix) -> Any:
    """``<mu, xi> = -tr(mu xi) / 2`` (real part), so that ``<p~, q~> = p . q``."""
    return -HALF * trace(product(mu, xi)).re


def dual_tilde(mu: Matrix) -> Vector:
    """The three-vector of a covector of su(2).

    ``<mu, tilde q> = dual_tilde(mu) . q`` for every q defines it.

    Source:
        Holm (2011), Geometric Mechanics II, section 3.2.4.
    """
    axes = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    return tuple(pairing_su2(mu, tilde(axis)) for axis in axes)
