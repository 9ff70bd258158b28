"""Newton's method for the equation of an implicit step, in NumPy.

The middle m of a step is where a sweep F leads to itself, ``m = F(m)``. Sweeps alone converge where
F contracts: with stiff forces that asks for steps much shorter than the motion needs. Newton's
method goes from m to ``m + d`` with ``(1 - F'(m)) d = F(m) - m``. The slopes F' follow from the
Jacobian of the rates that is generated with them. They are exact for the midpoint, the methods of
Gauss and the spherical midpoint; of other methods they are those of the leading order in the step,
so that the search converges linearly there, by a factor of that order. E. Hairer and G. Wanner,
Solving Ordinary Differential Equations II (1996), IV.8.
Comes in: a sweep and the slopes of a method. Goes out: a better middle of the step.
Read next: `coadjoint.solve.methods.lie_poisson`, whose search takes it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from coadjoint.array_types import Array


def improve(middle: Array, following: Array, slopes: Array) -> Array:
    """Where Newton's method leads from a middle.

    Args:
        middle: m, ``(k, N)``.
        following: F(m).
        slopes: F'(m), ``(k, k, N)``.

    >>> m = np.array([[2.0]])  # of x = 3 - x
    >>> improve(m, 3.0 - m, np.array([[[-1.0]]]))
    array([[1.5]])
    """
    matrix = np.eye(len(middle))[:, :, np.newaxis] - slopes
    return middle + solve(matrix, following - middle)


def solve(matrix: Array, known: Array) -> Array:
    """The solution of linear equations of each lane, by elimination with the largest pivots.

    Args:
        matrix: ``(k, k, N)``; it is changed.
        known: The right side, ``(k, N)``; it is changed as well.

    >>> solve(np.array([[[0.0], [2.0]], [[1.0], [1.0]]]), np.array([[4.0], [5.0]])).ravel()
    array([3., 2.])
    """
    size = len(known)
    for j in range(size):
        sizes = np.abs(matrix[j:, j])
        is_ordered = not (sizes[1:] > sizes[0]).any()  # as in most steps, whose slopes are small
        for i in range(size if is_ordered else j + 1, size):
            swap = np.abs(matrix[i, j]) > np.abs(matrix[j, j])
            if not swap.any():
                continue
            for rows in (matrix[:, j:], known):
                rows[j], rows[i] = (
                    np.where(swap, rows[i], rows[j]),
                    np.where(swap, rows[j], rows[i]),
                )
        factors = matrix[j + 1 :, j] / matrix[j, j]
        matrix[j + 1 :, j + 1 :] -= factors[:, np.newaxis] * matrix[j, j + 1 :]
        known[j + 1 :] -= factors * known[j]
    for i in reversed(range(size)):
        for product in matrix[i, i + 1 :] * known[i + 1 :]:  # in the order of the text in C
            known[i] -= product
        known[i] /= matrix[i, i]
    return known
