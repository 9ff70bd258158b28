"""Sparse exact matrices: the few operations that algebras and their representations need.

A matrix is the dictionary of its nonzero entries. Comes in and goes out: such dictionaries.
Read next: `coadjoint.algebra.lie_algebra`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import copy
from fractions import Fraction
from typing import Any, TypeVar

from coadjoint.exact.linear import add_multiple, exact

#: A matrix as nonzero entries {(row, column): value}.
SparseMatrix = Mapping[tuple[int, int], Any]
Place = TypeVar("Place")
Image = TypeVar("Image")
Matrix = dict[tuple[int, int], Any]


def unit(row: int, column: int, value: Any = 1) -> Matrix:
    """The matrix with a single entry."""
    return {(row, column): value}


def combination(terms: Iterable[tuple[Any, SparseMatrix]]) -> Matrix:
    """The sum of multiples of matrices."""
    result: Matrix = {}
    for factor, matrix in terms:
        add_multiple(result, factor, matrix)
    return result


def product(a: SparseMatrix, b: SparseMatrix) -> Matrix:
    """``a b``."""
    rows: dict[int, list[tuple[int, Any]]] = {}
    for (r, c), y in b.items():
        rows.setdefault(r, []).append((c, y))
    result: Matrix = {}
    for (row, middle), x in a.items():
        for column, y in rows.get(middle, ()):
            result[row, column] = result.get((row, column), 0) + x * y
    return {place: exact(value) for place, value in result.items() if value != 0}


def commutator(a: SparseMatrix, b: SparseMatrix) -> Matrix:
    """``a b - b a``."""
    result = product(a, b)
    add_multiple(result, -1, product(b, a))
    return result


def convert_entries(row: Mapping[Place, Any], convert: Callable[[Any], Any]) -> dict[Place, Any]:
    """A sparse row or matrix whose entries with parameters are converted; rationals stay."""
    converted = {
        at: value if isinstance(value, int | Fraction) else exact(convert(value))
        for at, value in row.items()
    }
    return {at: value for at, value in converted.items() if value != 0}


def take_image(record: Image, **parts: Any) -> Image:
    """An algebra or representation with some attributes replaced, its laws not checked again.

    For images under homomorphisms of fields, and for direct summands, in which laws that hold
    still hold. A field with functions may not see that they do: only its normal form decides.
    """
    result = copy(record)
    for name, value in parts.items():
        object.__setattr__(result, name, value)
    return result


def pair(a: SparseMatrix, b: SparseMatrix) -> Any:
    """``tr(a^T b)``."""
    return sum(value * b[place] for place, value in a.items() if place in b)


def transpose(a: SparseMatrix) -> Matrix:
    """Rows and columns exchanged."""
    return {(c, r): value for (r, c), value in a.items()}


def size(matrices: Iterable[SparseMatrix]) -> int:
    """The least number of rows and columns that holds all entries."""
    return 1 + max((max(place) for matrix in matrices for place in matrix), default=-1)


def without_zero_places(matrices: Sequence[SparseMatrix]) -> tuple[Matrix, ...]:
    """The matrices without the places whose rows and columns are zero in all of them.

    >>> without_zero_places([{(2, 4): 1}, {(4, 2): -1}])
    ({(0, 1): 1}, {(1, 0): -1})
    """
    used = sorted({place for matrix in matrices for at in matrix for place in at})
    number = {old: new for new, old in enumerate(used)}
    return tuple({(number[r], number[c]): x for (r, c), x in m.items()} for m in matrices)


def shift(a: SparseMatrix, rows: int, columns: int) -> Matrix:
    """The matrix as a block that begins further down and to the right."""
    return {(r + rows, c + columns): value for (r, c), value in a.items()}


def kronecker(a: SparseMatrix, b: SparseMatrix, width: int) -> Matrix:
    """``a (x) b`` for b of ``width`` rows and columns."""
    return {
        (r * width + s, c * width + d): x * y for (r, c), x in a.items() for (s, d), y in b.items()
    }


def realify(real: SparseMatrix, imaginary: SparseMatrix, width: int) -> Matrix:
    """``A + iB`` as the real matrix ``[[A, -B], [B, A]]``, for A and B of ``width`` rows."""
    turned = {place: -value for place, value in imaginary.items()}
    return {
        **shift(real, 0, 0),
        **shift(real, width, width),
        **shift(turned, 0, width),
        **shift(imaginary, width, 0),
    }


def block_diagonal(parts: Sequence[Sequence[SparseMatrix]]) -> tuple[Matrix, ...]:
    """Block-diagonal matrices, one for each place of the (equally long) parts."""
    result: list[Matrix] = [{} for _ in parts[0]]
    start = 0
    for part in parts:
        for whole, block in zip(result, part, strict=True):
            whole.update(shift(block, start, start))
        start += size(part)
    return tuple(result)


def entries_text(matrix: SparseMatrix) -> str:
    """Nonzero entries for a message, places counted from 1."""
    return ", ".join(f"({r + 1}, {c + 1}): {value}" for (r, c), value in sorted(matrix.items()))
