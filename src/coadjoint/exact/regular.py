"""Regular matrices: proof that determinants are not zero, by elimination with interval bounds.

Comes in: a square matrix of elements. Goes out: a rational point of the domain at which every pivot
excludes zero. Bounds at one point prove that a determinant is not identically zero; no expression
swells, and no prime or rounding has a say.
Read next: `coadjoint.derive.mechanics.legendre`, `coadjoint.prove.equivalence`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import islice

from coadjoint.exact.element import Element
from coadjoint.exact.field import Field
from coadjoint.exact.ranks import certain_rows, on_diagonal
from coadjoint.exact.witness import (
    TRIES,
    UNDEFINED,
    Enclosure,
    Point,
    enclosures,
    points_inside,
)

Matrix = Sequence[Sequence[Element]]


def witness_regular(field: Field, *matrices: Matrix) -> Point | None:
    """A point of the domain at which the determinants of matrices are certainly not zero.

    Returns:
        Values of the symbols in the matrices; None where no point was found, which proves nothing.

    >>> field = Field(["x"], slots=1)
    >>> exp = field.call("exp", field["x"])
    >>> witness_regular(field, [[exp, field.one], [exp**2, exp]])
    >>> witness_regular(field, [[exp, field.one], [field.one, exp]])
    {'x': Fraction(-3, 5)}
    """
    for point, result in _values(field, matrices):
        if all(len(certain_rows(rows)) == len(rows) for rows in result):
            return point
    return None


def certain_minors(field: Field, matrix: Matrix) -> int:
    """How many leading minors of a square matrix, one after the other, are not identically zero.

    >>> field = Field(["x"])
    >>> certain_minors(field, [[field["x"], field.one], [field.one, field.zero]])
    2
    >>> certain_minors(field, [[field.zero, field.one], [field.one, field["x"]]])
    0
    """
    most = 0
    for _, (rows,) in _values(field, [matrix]):
        pivots = certain_rows(rows, on_diagonal)
        count = next((n for n, place in enumerate(pivots) if n != place), len(pivots))
        most = max(most, count)
        if most == len(matrix):
            break
    return most


def _values(
    field: Field, matrices: Sequence[Matrix]
) -> Iterator[tuple[Point, list[list[dict[int, Enclosure]]]]]:
    """Points of the domain with bounds of the entries of matrices."""
    entries = [entry for matrix in matrices for row in matrix for entry in row]
    names = frozenset[str]().union(*map(field.reach, entries))
    for point in islice(points_inside(field, entries), TRIES):
        with suppress(*UNDEFINED):
            values = iter(enclosures(field, entries, point))
            shown = {name: value for name, value in point.items() if name in names}
            yield (
                shown,
                [[{j: next(values) for j in range(len(row))} for row in m] for m in matrices],
            )
