r"""su(N) in the basis of spherical harmonics: matrices in the place of functions on the sphere.

With the spin matrices of N rows, :math:`[S_a, S_b] = i \epsilon_{abc} S_c`, Hermitian matrices of
the harmonics of degree l and order m are sums of :math:`T_{lm}` and its adjoint, where

.. math:: T_{ll} = S_+^l, \qquad T_{l,m-1} = [T_{lm}, S_-], \qquad
    \sum_a [S_a, [S_a, T_{lm}]] = l (l + 1)\, T_{lm} .

The degrees 1 to N - 1 are all of su(N). As N grows, :math:`[\cdot, \cdot]/(i \hbar)` with
:math:`\hbar = 2/\sqrt{N^2 - 1}` tends to :math:`\{f, g\} = x \cdot \nabla f \times \nabla g` on
the unit sphere, with an error of :math:`O(N^{-2})` between fixed harmonics.

Rows are scaled so that :math:`S_\pm` have whole entries: ``S_+`` has 1, 2, ... above the diagonal
and ``S_-`` has N - 1, N - 2, ... below. So all matrices are rational; with weights of the rows
that have square roots they are Hermitian.
Comes in: N. Goes out: generators for `coadjoint.algebra.catalogue`.

Source:
    Hoppe and Yau, Communications in Mathematical Physics 195 (1998) 67; Modin and Viviani, Journal
    of Fluid Mechanics 884 (2020) A22.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from math import gcd, pi, sqrt

from coadjoint.algebra.lie_algebra import LieAlgebra, from_matrices
from coadjoint.algebra.matrices import (
    Matrix,
    SparseMatrix,
    combination,
    commutator,
    product,
    realify,
)


def spin_matrices(n: int) -> tuple[Matrix, Matrix, Matrix]:
    """``S_+``, ``S_-`` and ``S_z`` of n rows, in the scale with whole entries.

    >>> spin_matrices(2)
    ({(0, 1): 1}, {(1, 0): 1}, {(0, 0): Fraction(1, 2), (1, 1): Fraction(-1, 2)})
    """
    rows = list(pairwise(range(n)))
    up: Matrix = {(i, j): j for i, j in rows}
    down: Matrix = {(j, i): n - j for i, j in rows}
    levels = ((i, Fraction(n - 1, 2) - i) for i in range(n))
    return up, down, {(i, i): level for i, level in levels if level}


def harmonics(n: int) -> LieAlgebra:
    """I times Hermitian matrices: degree by degree C_l0, C_l1, S_l1, ..., C_ll, S_ll.

    C_lm and S_lm are harmonics with the cosine and with the sine of m times the longitude.
    """
    basis, matrices = zip(*_generators(n), strict=True)
    degrees = {f"degree_{d}": tuple(range(d * d - 1, d * (d + 2))) for d in range(1, n)}
    return from_matrices(f"harmonics({n})", basis, matrices, degrees)


def find_entries(n: int, parts: Sequence[float]) -> list[list[float]]:
    r"""The real matrix X of :math:`(X - X^T)/2 + \mathrm{i} (X + X^T)/2` for some harmonics.

    It stands for the function with the parts of C_l0, C_l1, S_l1, ..., C_ll, S_ll, degree by degree
    from 1 on: real harmonics with the mean square 1 over 4 pi, positive near the pole where the
    longitude is 0, or pi/(2 m) for the sine of m times it.

    Args:
        n: Rows of the matrix.
        parts: As many as there are; degrees behind them have none.
    """
    whole = [[0.0] * n for _ in range(n)]
    for degree in range(1, n):
        own = [*parts[degree * degree - 1 : degree * (degree + 2)]]
        if not any(own):
            continue
        own += [0.0] * (2 * degree + 1 - len(own))
        for order, diagonal in enumerate(list_towers(n, degree)):
            cosine, sine = own[2 * order - 1 : 2 * order + 1] if order else (own[0], 0.0)
            for i, x in enumerate(diagonal):
                share = x / sqrt(2) if order else x
                whole[i][i + order] += share * (cosine + sine)
                if order:
                    whole[i + order][i] += share * (cosine - sine)
    return whole


def list_towers(n: int, degree: int) -> list[list[float]]:
    """The diagonals of T_lm above the main one by m from 0 on, with tr T_lm T_lm^T = n/(4 pi)."""
    c = [sqrt((i + 1) * (n - 1 - i)) for i in range(n - 1)]  # of S_+, the transpose of S_-
    own, towers = [1.0] * (n - degree), list[list[float]]()
    for k in range(degree):  # a power of S_+, whose size would leave the range of numbers
        own = [x * c[i + k] / n for i, x in enumerate(own)]
    for order in range(degree, -1, -1):
        size = sqrt(sum(x * x for x in own) * 4 * pi / n)
        own = [x / size for x in own]
        towers.append(own)
        if order:  # [T, S_-], at (i, i + order - 1)
            before = [0.0, *(a * b for a, b in zip(c, own, strict=False))]
            after = [*(a * b for a, b in zip(own, c[order - 1 :], strict=True)), 0.0]
            own = [a - b for a, b in zip(after, before, strict=True)]
    return towers[::-1]


def _generators(n: int) -> Iterator[tuple[str, Matrix]]:
    up, down, _ = spin_matrices(n)
    T: SparseMatrix
    U: SparseMatrix
    for degree in range(1, n):
        T, U = up, down
        for _ in range(degree - 1):
            T, U = product(T, up), product(down, U)
        towers = [(degree, T, U)]
        for order in range(degree - 1, -1, -1):
            T, U = commutator(T, down), commutator(up, U)  # U is the adjoint of T
            towers.append((order, T, U))
        for order, T, U in reversed(towers):
            whole, turned = combination([(1, T), (1, U)]), combination([(1, T), (-1, U)])
            factor = Fraction(1, gcd(*whole.values()))
            yield f"C{degree}_{order}", realify({}, combination([(factor, whole)]), n)
            if order:  # i times -i (T - U)
                yield f"S{degree}_{order}", realify(combination([(factor, turned)]), {}, n)
