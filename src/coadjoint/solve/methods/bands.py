"""Newton's method for the steps of systems of equal members whose neighbours are coupled, in NumPy.

As `coadjoint.solve.methods.krylov`, with the matrix ``1 - F'(m)`` itself, which has bands: a member
is coupled to those at most `reach` further. One vector probes all members that are further apart
than twice that, so that a few probes give all of it, however many members there are. Members of a
ring are taken in the order 0, N-1, 1, N-2, ..., in which neighbours are two places apart at most.
The linear equations are solved by elimination with the largest pivots (G. H. Golub and C. F. Van
Loan, Matrix Computations (2013), 4.3.2), whose work is linear in the number of members and which no
stiffness makes longer.
Comes in: a sweep, and what its slopes make of a vector. Goes out: a better middle of the step.
Read next: `coadjoint.solve.methods.lie_poisson`, whose search takes it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from coadjoint.array_types import Array


@dataclass(frozen=True)
class Bands:
    """Which members are coupled.

    Attributes:
        members: How many there are, N.
        reach: How far from a member those are that its rates read, at the most.
        wraps: Whether the last one is followed by the first one.
    """

    members: int
    reach: int
    wraps: bool

    @property
    def width(self) -> int:
        """How many places further a neighbour is at the most."""
        return self.reach * (2 if self.wraps else 1)

    def place(self, member: int) -> int:
        """The place of a member among unknowns.

        >>> [Bands(5, 1, wraps=True).place(i) for i in range(5)]
        [0, 2, 4, 3, 1]
        """
        if not self.wraps:
            return member
        return min(2 * member, 2 * (self.members - 1 - member) + 1)

    def colour(self, member: int) -> int:
        """Which probe a member belongs to: those of one probe have no neighbour in common."""
        apart = 2 * self.reach + 1
        whole = self.members - self.members % apart
        return member % apart if member < whole else apart + member - whole

    @property
    def colours(self) -> int:
        """How many probes there are, of each component."""
        return 1 + max(self.colour(i) for i in range(self.members))

    def neighbours(self, member: int) -> list[int]:
        """The members that the rates of one read."""
        near = range(member - self.reach, member + self.reach + 1)
        if self.wraps:
            return [j % self.members for j in near]
        return [j for j in near if 0 <= j < self.members]


def improve(
    middle: Array, following: Array, slopes: Callable[[Array], Array], bands: Bands
) -> Array:
    """Where Newton's method leads from a middle.

    Args:
        middle: m, ``(d*N, L)``, each component of all members.
        following: F(m).
        slopes: F'(m) times a vector.
        bands: Which members are coupled.
    """
    count, lanes = bands.members, middle.shape[1]
    parts = len(middle) // count
    band = bands.width * parts + parts - 1
    matrix = np.zeros((len(middle), 3 * band + 1, lanes))
    order = [bands.place(i) * parts + a for a in range(parts) for i in range(count)]
    for colour in range(bands.colours):
        own = [i for i in range(count) if bands.colour(i) == colour]
        for part in range(parts):
            vector = np.zeros(middle.shape)
            vector[[part * count + i for i in own]] = 1.0
            found = slopes(vector)
            for j in own:
                column = order[part * count + j]
                for i in bands.neighbours(j):
                    for a in range(parts):
                        row, entry = order[a * count + i], -found[a * count + i]
                        matrix[row, column - row + band] = entry + 1.0 if row == column else entry
    rest = np.zeros(middle.shape)
    rest[order] = following - middle
    return np.asarray(middle + solve(matrix, rest, band)[order])


def solve(matrix: Array, known: Array, band: int) -> Array:
    """The solution of linear equations with bands, of each lane.

    Args:
        matrix: Row i has its columns from ``i - band`` on, ``(n, 3*band + 1, L)``; those beyond
            ``i + band`` are zero. It is changed.
        known: The right side, ``(n, L)``; it is changed as well.
        band: How far entries are from the diagonal, at the most.

    >>> rows = np.array([[0.0, 0.0, 1.0, 0.0], [1.0, 1.0, 0.0, 0.0]])[:, :, np.newaxis]
    >>> solve(rows, np.array([[4.0], [5.0]]), 1).ravel()
    array([1., 4.])
    """
    size, lanes = len(known), np.arange(known.shape[1])
    for j in range(size):
        last, wide = min(j + band, size - 1), min(2 * band, size - 1 - j) + 1
        pivot, top = np.zeros(len(lanes), int), np.abs(matrix[j, band])
        for i in range(j + 1, last + 1):
            value = np.abs(matrix[i, j - i + band])
            larger = value > top
            pivot, top = np.where(larger, i - j, pivot), np.where(larger, value, top)
        across = np.arange(wide)[:, np.newaxis]
        other = matrix[j + pivot, band - pivot + across, lanes]
        matrix[j + pivot, band - pivot + across, lanes] = matrix[j, band : band + wide]
        matrix[j, band : band + wide] = other
        right = known[j + pivot, lanes]
        known[j + pivot, lanes] = known[j]
        known[j] = right
        for i in range(j + 1, last + 1):
            first = j - i + band
            factor = matrix[i, first] / matrix[j, band]
            matrix[i, first + 1 : first + wide] -= factor * matrix[j, band + 1 : band + wide]
            known[i] -= factor * known[j]
    for i in reversed(range(size)):
        for k in range(i + 1, min(i + 2 * band, size - 1) + 1):
            known[i] -= matrix[i, k - i + band] * known[k]
        known[i] /= matrix[i, band]
    return known
