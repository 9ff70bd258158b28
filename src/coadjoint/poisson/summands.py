"""Direct summands of a Poisson structure: sets of coordinates that commute with all others.

Comes in: a Poisson structure, or an algebra for its dual. Goes out: its summands. Where
``{x_i, x_j} = 0`` for i and j in different sets, and the brackets within a set depend on the
coordinates of that set alone, the structure is the product of its parts: ranks add up, and the
Casimirs of the parts together are as many as the whole has near almost every point.
Read next: `coadjoint.poisson.casimirs`.
"""

from __future__ import annotations

from collections.abc import Sequence
from types import MappingProxyType
from typing import Any

from sympy.utilities.iterables import connected_components

from coadjoint.algebra import LieAlgebra
from coadjoint.algebra.matrices import SparseMatrix, take_image
from coadjoint.poisson.structure import PoissonStructure


def summands(structure: PoissonStructure) -> list[tuple[int, ...]]:
    """Places of the coordinates of each direct summand, in order.

    Coordinates belong together if their bracket is not zero, and so do those that occur in it.

    >>> from coadjoint.algebra import algebra_by_name, direct_sum
    >>> from coadjoint.exact import Field
    >>> from coadjoint.poisson import lie_poisson
    >>> algebra = direct_sum([algebra_by_name("so(3)"), algebra_by_name("aff(1)")])
    >>> summands(lie_poisson(algebra, Field(algebra.basis), algebra.basis))
    [(0, 1, 2), (3, 4)]
    """
    place = {name: n for n, name in enumerate(structure.names)}
    reached: dict[int, list[int]] = {}  # by object: a Lie-Poisson tensor repeats few objects often
    linked: list[tuple[int, int]] = []
    for i, row in enumerate(structure.tensor):
        for j, entry in enumerate(row[:i]):
            if entry:
                if id(entry) not in reached:
                    names = structure.field.reach(entry) & place.keys()
                    reached[id(entry)] = [place[name] for name in names]
                linked += [(i, other) for other in (j, *reached[id(entry)])]
    parts = connected_components((range(structure.dimension), linked))
    return sorted(tuple(sorted(part)) for part in parts)


def restrict_structure(structure: PoissonStructure, places: Sequence[int]) -> PoissonStructure:
    """The structure of a summand, on its own coordinates."""
    if len(places) == structure.dimension:
        return structure
    names = tuple(structure.names[n] for n in places)
    tensor = tuple(tuple(structure.tensor[i][j] for j in places) for i in places)
    return PoissonStructure(structure.field, names, tensor, structure.label)


def restrict_algebra(algebra: LieAlgebra, places: Sequence[int]) -> LieAlgebra:
    """A summand of an algebra, with the rows and columns of matrices that it acts on.

    Args:
        algebra: The whole.
        places: Of the basis vectors of the summand, in the order that its basis is to have.
    """
    number = {place: n for n, place in enumerate(places)}
    constants: dict[tuple[int, int], dict[int, Any]] = {}
    for (i, j), row in algebra.constants.items():
        if i in number:
            a, b = number[i], number[j]
            turned = {number[k]: c if a < b else -c for k, c in row.items()}
            constants[min(a, b), max(a, b)] = turned
    basis = tuple(algebra.basis[n] for n in places)
    matrices = [algebra.matrices[n] for n in places] if algebra.matrices else []
    ordered = {pair: dict(sorted(row.items())) for pair, row in sorted(constants.items())}
    return take_image(
        algebra,
        basis=basis,
        constants=MappingProxyType(ordered),
        blocks={},
        matrices=_trim(matrices),
        elements=(),
    )


def _trim(matrices: Sequence[SparseMatrix]) -> tuple[SparseMatrix, ...]:
    """Matrices without the rows and columns that are zero in all of them."""
    acted = sorted({n for matrix in matrices for place in matrix for n in place})
    number = {place: n for n, place in enumerate(acted)}
    return tuple(
        {(number[r], number[c]): value for (r, c), value in matrix.items()} for matrix in matrices
    )
