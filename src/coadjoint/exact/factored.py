r"""Factored: a symmetric system ``A x = b`` by the loop that kernels have, in any arithmetic.

With ones on the diagonal of L, :math:`A = L D L^T` where the leading minors do not vanish. Column
by column, what a column takes from the rest is subtracted from every entry to the right of it:

.. math:: w_i = a_{ij}, \quad l_{ij} = w_i / d_j, \quad a_{ik} := a_{ik} - w_i l_{kj}
    \qquad (i \ge k > j),

so that an entry has the same operations in the same order in every language, whatever is computed
side by side. Then ``L y = b`` from the first row on, ``D z = y`` and ``L^T x = z`` from the last.
Entries stand on and below the diagonal, row by row; L and D take their places.
Comes in: entries, in any arithmetic that has ``+ * /`` and unary ``-``. Goes out: what solves.
Read next: `coadjoint.lower.program`, whose nodes are these two steps.

Source:
    Golub and Van Loan, Matrix Computations, 4th ed., sec. 4.1.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isqrt
from typing import Any, Protocol


class Factored(Protocol):
    """L and D of a matrix."""

    def __getitem__(self, place: int) -> Any:
        """An entry of L below the diagonal, or of D on it."""

    def solve(self, known: Sequence[Any]) -> list[Any]:
        """The x of ``A x = b``."""


def place_of(row: int, column: int) -> int:
    """Where an entry on or below the diagonal stands.

    >>> [place_of(row, column) for row in range(3) for column in range(row + 1)]
    [0, 1, 2, 3, 4, 5]
    """
    return row * (row + 1) // 2 + column


def row_of(place: int) -> int:
    """The row of an entry by its place.

    >>> [row_of(place) for place in range(6)]
    [0, 1, 1, 2, 2, 2]
    """
    return (isqrt(8 * place + 1) - 1) // 2


def rows_of(entries: int) -> int:
    """How many rows have so many entries on and below the diagonal.

    >>> [rows_of(n) for n in (1, 3, 6, 10)]
    [1, 2, 3, 4]
    """
    return isqrt(2 * entries)


def factor(entries: Sequence[Any]) -> Factored:
    """L and D; an arithmetic that knows a better way than the loop has a method ``factor``."""
    own = getattr(type(entries[0]), "factor", None)
    factored: Factored = Loop(entries) if own is None else own(entries)
    return factored


class Loop:
    """The loop itself.

    Args:
        entries: Of A, on and below the diagonal, row by row.

    >>> from fractions import Fraction
    >>> Loop([Fraction(2), Fraction(1), Fraction(3)]).solve([Fraction(3), Fraction(4)])
    [Fraction(1, 1), Fraction(1, 1)]
    """

    def __init__(self, entries: Sequence[Any]) -> None:
        self._size = rows_of(len(entries))
        self._rows = [[entries[place_of(i, j)] for j in range(i + 1)] for i in range(self._size)]
        for j in range(self._size):
            self._eliminate(j)

    def _eliminate(self, j: int) -> None:
        """Column j of L, and what it takes from the rest."""
        pivot, after = self._rows[j][j], range(j + 1, self._size)
        column = {i: self._rows[i][j] for i in after}
        for i in after:
            self._rows[i][j] = column[i] / pivot
        for i in after:
            row = self._rows[i]
            for k in range(j + 1, i + 1):
                row[k] = row[k] + -(column[i] * self._rows[k][j])

    def __getitem__(self, place: int) -> Any:
        row = row_of(place)
        return self._rows[row][place - place_of(row, 0)]

    def solve(self, known: Sequence[Any]) -> list[Any]:
        """The x of ``A x = b``."""
        x = list(known)
        for i, row in enumerate(self._rows):
            for j in range(i):
                x[i] = x[i] + -(row[j] * x[j])
        x = [y / row[-1] for y, row in zip(x, self._rows, strict=True)]
        for k in reversed(range(self._size)):
            for i in range(k):
                x[i] = x[i] + -(self._rows[k][i] * x[k])
        return x


def count_factor(size: int) -> dict[str, int]:
    """Operations of `factor` by kind."""
    below = size * (size - 1) // 2
    products = (size - 1) * size * (size + 1) // 6
    return {"add": products, "multiply": products, "divide": below}


def count_solve(size: int) -> dict[str, int]:
    """Operations of a solution by kind."""
    return {"add": size * (size - 1), "multiply": size * (size - 1), "divide": size}
