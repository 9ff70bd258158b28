"""Lattices: arguments of functions as integer combinations of a basis.

Comes in: elements, as vectors with rational entries. Goes out: the Hermite basis of all their
integer combinations, and the integer coordinates of each in it. The basis depends on the set of
vectors alone, not on their order.
Read next: `coadjoint.exact.relations`, where the elements are arguments of exponentials and sines.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import lcm

from coadjoint.exact.element import Element
from coadjoint.exact.factors import to_fraction
from coadjoint.exact.field import Field
from coadjoint.exact.linear import Span

Row = tuple[Fraction, ...]


def lattice_basis(vectors: Sequence[Sequence[Fraction]]) -> list[Row]:
    """The Hermite basis: each vector has its first entry, positive, where those after it have 0.

    >>> [[int(x) for x in row] for row in lattice_basis([(Fraction(1), Fraction(1)),
    ...     (Fraction(1), Fraction(-1))])]
    [[1, 1], [0, 2]]
    """
    scale = lcm(*(x.denominator for row in vectors for x in row))
    pending = [[int(x * scale) for x in row] for row in vectors]
    basis: list[list[int]] = []
    for column in range(len(pending[0]) if pending else 0):
        meeting = [row for row in pending if row[column]]
        pending = [row for row in pending if not row[column]]
        while len(meeting) > 1:
            least = min(meeting, key=lambda row: abs(row[column]))
            others = [_reduce(row, least, column) for row in meeting if row is not least]
            pending += [row for row in others if not row[column]]
            meeting = [least, *(row for row in others if row[column])]
        for row in meeting:
            pivot = row if row[column] > 0 else [-x for x in row]
            basis = [*(_reduce(above, pivot, column) for above in basis), pivot]
    return [tuple(Fraction(x, scale) for x in row) for row in basis]


def _reduce(row: Sequence[int], by: Sequence[int], column: int) -> list[int]:
    """A row minus the multiple of another that leaves the least entry, not negative, there."""
    count = (row[column] - row[column] % abs(by[column])) // by[column]
    return [a - count * b for a, b in zip(row, by, strict=True)]


def coordinates(
    vectors: Sequence[Sequence[Fraction]], basis: Sequence[Row]
) -> list[dict[int, int]]:
    """The integers other than 0 that multiply the vectors of a basis, for each of some vectors.

    >>> basis = lattice_basis([(Fraction(1, 2), Fraction(0)), (Fraction(3), Fraction(2))])
    >>> coordinates([(Fraction(1), Fraction(4))], basis)
    [{0: 2, 1: 2}]
    """
    span = Span(dict(enumerate(row)) for row in basis)
    whole = [span.coordinates(dict(enumerate(vector))) for vector in vectors]
    assert None not in whole, (vectors, basis)
    return [row for row in whole if row is not None]


class Lattice:
    """Arguments of functions as integer combinations of a basis.

    Args:
        field: Where they live.
        arguments: What to combine.
        halved: Whether halves of them are wanted, too.

    Attributes:
        vectors: Coordinates of the arguments over the rational numbers.
        basis: Elements whose integer combinations the arguments are.
        rows: The integers for each argument.
    """

    def __init__(self, field: Field, arguments: Sequence[Element], *, halved: bool = False) -> None:
        tops, below = field.numerators(map(field.normal, arguments))
        monomials = sorted({monomial for p in tops for monomial in p}, reverse=True)
        self.vectors = [tuple(to_fraction(p.get(m, 0)) for m in monomials) for p in tops]
        wanted = [tuple(x / 2 for x in v) for v in self.vectors] if halved else self.vectors
        result = lattice_basis(wanted) if wanted else []
        places = range(len(result))
        self.rows = [[row.get(n, 0) for n in places] for row in coordinates(self.vectors, result)]
        self.basis = [
            below * field.polynomial(field.generators, dict(zip(monomials, row, strict=True)))
            for row in result
        ]
