"""Exact linear solves over the rationals for sparse matrices given as dictionaries.

Small and used only to find structure constants; SciPy has no exact solver and SymPy must stay out
of everything the spec reader imports.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from fractions import Fraction


def solve_exactly(
    vectors: Sequence[Mapping[tuple[int, int], Fraction]],
    targets: Sequence[Mapping[tuple[int, int], Fraction]],
) -> list[list[Fraction] | None] | None:
    """Coordinates of each target in independent ``vectors``, by one elimination for all.

    Returns:
        For each target one coefficient per vector, or None if they do not span it; None for all if
        the vectors are dependent.
    """
    rows: dict[Hashable, dict[int, Fraction]] = {}
    for column, vector in enumerate([*vectors, *targets]):
        for place, value in vector.items():
            rows.setdefault(place, {})[column] = Fraction(value)
    pending, n = [row for _, row in sorted(rows.items())], len(vectors)
    pivots: list[dict[int, Fraction]] = []
    for column in range(n):
        pivot = next((row for row in pending if row.get(column)), None)
        if pivot is None:
            return None
        pending = [row for row in pending if row is not pivot]
        pivot = {j: value / pivot[column] for j, value in pivot.items()}
        pending = [_eliminate(row, pivot, column) for row in pending]
        pivots = [_eliminate(row, pivot, column) for row in pivots] + [pivot]
    outside = {column for row in pending for column in row}
    return [
        None if column in outside else [row.get(column, Fraction(0)) for row in pivots]
        for column in range(n, n + len(targets))
    ]


def _eliminate(
    row: dict[int, Fraction], pivot: dict[int, Fraction], column: int
) -> dict[int, Fraction]:
    """``row`` minus the multiple of ``pivot`` that clears ``column``."""
    factor = row.get(column)
    if not factor:
        return row
    columns = row.keys() | pivot.keys()
    new = {j: row.get(j, Fraction(0)) - factor * pivot.get(j, Fraction(0)) for j in columns}
    return {j: value for j, value in new.items() if value != 0}
