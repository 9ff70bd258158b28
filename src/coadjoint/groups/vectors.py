"""Group actions, bottom floor: vectors as tuples and matrices as tuples of rows.

Comes in: tuples of anything that adds and multiplies (fractions, floats, complex numbers of this
package, elements of a field). Goes out: the same. NumPy's object arrays would do, at 0.15 s of
import for a dozen three-vectors.
Read next: `coadjoint.groups.maps`.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

#: Components of any kind that adds and multiplies.
Vector = tuple[Any, ...]
#: Rows of equal length.
Matrix = tuple[Vector, ...]


def exact(value: Any) -> Any:
    """The value, integers as fractions, so that a division stays exact."""
    return Fraction(value) if isinstance(value, int) else value


def dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    """``a . b``.

    >>> dot((1, 2, 3), (4, 5, 6))
    32
    """
    products = [x * y for x, y in zip(a, b, strict=True)]
    return sum(products[1:], products[0])


def cross(a: Sequence[Any], b: Sequence[Any]) -> Vector:
    """``a x b`` in R^3.

    >>> cross((1, 0, 0), (0, 1, 0))
    (0, 0, 1)
    """
    a1, a2, a3 = a
    b1, b2, b3 = b
    return (a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1)


def add(a: Sequence[Any], b: Sequence[Any]) -> Vector:
    """``a + b``."""
    return tuple(x + y for x, y in zip(a, b, strict=True))


def subtract(a: Sequence[Any], b: Sequence[Any]) -> Vector:
    """``a - b``."""
    return tuple(x - y for x, y in zip(a, b, strict=True))


def scale(factor: Any, a: Sequence[Any]) -> Vector:
    """``factor * a``."""
    return tuple(factor * x for x in a)


def apply(matrix: Matrix, a: Sequence[Any]) -> Vector:
    """The matrix times a column."""
    return tuple(dot(row, a) for row in matrix)


def transpose(matrix: Matrix) -> Matrix:
    """Rows as columns."""
    return tuple(zip(*matrix, strict=True))


def matmul(a: Matrix, b: Matrix) -> Matrix:
    """The product of two matrices.

    >>> matmul(((0, 1), (0, 0)), ((0, 0), (1, 0)))
    ((1, 0), (0, 0))
    """
    columns = transpose(b)
    return tuple(tuple(dot(row, column) for column in columns) for row in a)


def combine(a: Matrix, b: Matrix, factor: Any = 1) -> Matrix:
    """``a + factor * b``."""
    return tuple(
        tuple(x + factor * y for x, y in zip(left, right, strict=True))
        for left, right in zip(a, b, strict=True)
    )


def commutator(a: Matrix, b: Matrix) -> Matrix:
    """``a b - b a``."""
    return combine(matmul(a, b), matmul(b, a), -1)


def trace(matrix: Matrix) -> Any:
    """The sum of the diagonal."""
    diagonal = [row[n] for n, row in enumerate(matrix)]
    return sum(diagonal[1:], diagonal[0])


def identity(n: int) -> Matrix:
    """The unit matrix of integers, which mix with values of every kind."""
    return tuple(tuple(int(i == j) for j in range(n)) for i in range(n))
