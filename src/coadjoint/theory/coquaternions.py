"""Coquaternions, and the matrices that quaternions and coquaternions are the same as.

Comes in: four components of anything that adds and multiplies. Goes out: products, and matrices of
2 x 2 complex or 4 x 4 real entries.
Read next: `coadjoint.theory.rotations`.
"""

from __future__ import annotations

from coadjoint.exact.dense import Matrix, transpose
from coadjoint.groups.complex_numbers import Complex
from coadjoint.groups.quaternions import Hypercomplex, Quaternion


def left_matrix(q: Hypercomplex) -> Matrix:
    """The 4 x 4 matrix of ``r -> q r`` in the basis 1, i, j, k."""
    return transpose(tuple((q * unit).components for unit in q.units()))


def right_matrix(q: Hypercomplex) -> Matrix:
    """The 4 x 4 matrix of ``r -> r q`` in the basis 1, i, j, k."""
    return transpose(tuple((unit * q).components for unit in q.units()))


def pauli(q: Quaternion) -> Matrix:
    """The 2 x 2 complex matrix ``q0 - i q . sigma``; unit ones make SU(2).

    Source:
        Holm (2011), section 3.1.1.
    """
    w, x, y, z = q.components
    return ((Complex(w, -z), Complex(-y, -x)), (Complex(y, -x), Complex(w, z)))


class Coquaternion(Hypercomplex):
    """A split quaternion ``w + x i + y j + z k`` with ``-i^2 = j^2 = k^2 = 1``.

    Source:
        Holm (2011), Geometric Mechanics II, section 3.2.7.

    >>> one, i, j, k = Coquaternion.units()
    >>> i * j == k, j * k == -i, k * i == j
    (True, True, True)
    """

    square = 1

    def real_matrix(self) -> Matrix:
        """The real 2 x 2 matrix whose determinant is the norm; norm 1 makes SL(2, R)."""
        w, x, y, z = self.components
        return ((w - z, y - x), (x + y, w + z))

    def complex_matrix(self) -> Matrix:
        """``[[u, v], [v*, u*]]`` with u = w + x i and v = y + z i; norm 1 makes SU(1, 1)."""
        u, v = Complex(self.w, self.x), Complex(self.y, self.z)
        return ((u, v), (v.conjugate, u.conjugate))
