"""Newton's method for the steps of systems of equal members, by Krylov spaces, in NumPy.

As `coadjoint.solve.methods.newton`, for so many unknowns that their matrix is not formed: d with
``(1 - F'(m)) d = F(m) - m`` is the vector of the Krylov space of the right side that leaves the
least rest, by GMRES (Y. Saad and M. H. Schultz, SIAM Journal on Scientific and Statistical
Computing 7 (1986) 856). It asks for F' times a vector alone, which costs as much as a sweep: linear
in the number of members where neighbours are coupled. A rest of `LEAST` is left: sweeps follow.
Comes in: a sweep, and what its slopes make of a vector. Goes out: a better middle of the step.
Read next: `coadjoint.solve.methods.newton`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from coadjoint.array_types import Array

#: Vectors of a Krylov space, at the most.
MOST: Final = 40
#: The part of the right side that is left.
LEAST: Final = 2.0**-14
#: Sums of which a product of two vectors is made: the first has every eighth number, and so on.
SUMS: Final = 8


def improve(middle: Array, following: Array, slopes: Callable[[Array], Array]) -> Array:
    """Where Newton's method leads from a middle.

    Args:
        middle: m, ``(k, N)``.
        following: F(m).
        slopes: F'(m) times a vector.
    """
    rest = following - middle
    size = np.sqrt(multiply(rest, rest))
    on, used = size > 0.0, np.zeros(size.shape, int)
    basis, right, bound = [rest / np.where(on, size, 1.0)], [size], LEAST * size
    columns: list[list[Array]] = []
    turns: list[tuple[Array, Array]] = []
    for k in range(MOST):
        if not on.any():
            break
        vector = basis[k] - slopes(basis[k])
        column = []
        for each in basis:
            part = multiply(vector, each)
            vector = vector - part * each
            column.append(part)
        last = np.sqrt(multiply(vector, vector))
        basis.append(vector / np.where(last > 0.0, last, 1.0))
        for i, (c, s) in enumerate(turns):
            upper, lower = column[i], column[i + 1]
            column[i], column[i + 1] = c * upper + s * lower, c * lower - s * upper
        pivot = np.sqrt(column[k] * column[k] + last * last)
        c, s = column[k] / pivot, last / pivot
        column[k] = pivot
        right[k:] = [c * right[k], -(s * right[k])]
        turns.append((c, s))
        columns.append(column)
        used = np.where(on, k + 1, used)
        on = on & (np.abs(right[k + 1]) > bound)
    return middle + _combine(basis, columns, right, used)


def _combine(
    basis: list[Array], columns: list[list[Array]], right: list[Array], used: NDArray[np.int_]
) -> Array:
    """The vector of the space by back substitution; each lane has so many vectors."""
    parts: dict[int, Array] = {}
    for j in reversed(range(len(columns))):
        part = right[j]
        for i in range(j + 1, len(columns)):
            part = np.where(i < used, part - columns[i][j] * parts[i], part)
        parts[j] = part / columns[j][j]
    found = np.zeros(basis[0].shape)
    for j in range(len(columns)):
        found = np.where(j < used, found + parts[j] * basis[j], found)
    return found


def multiply(one: Array, other: Array) -> Array:
    """The products of vectors of all lanes, in the order in which C adds them up.

    >>> multiply(np.array([[3.0], [4.0]]), np.array([[1.0], [2.0]]))
    array([11.])
    """
    rows, lanes = one.shape
    terms = np.zeros((-(-rows // SUMS) * SUMS, lanes))
    terms[:rows] = one * other
    sums = np.cumsum(terms.reshape(-1, SUMS, lanes), axis=0)[-1]
    return np.asarray(np.cumsum(sums, axis=0)[-1])
