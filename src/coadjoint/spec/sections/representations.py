"""Representations: the table [representations], linear actions of the algebra.

Comes in: tables of matrices over the basis, or blocks that act on matrices. Goes out: exact
`Representation` records that have been checked to commute like the algebra.
Read next: `coadjoint.spec.sections.variables`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field

from coadjoint.algebra.catalogue import REPRESENTATIONS as KNOWN
from coadjoint.algebra.lie_algebra import LieAlgebra, SparseMatrix
from coadjoint.algebra.matrices import without_zero_places
from coadjoint.algebra.representation import Representation, two_sided
from coadjoint.spec.core.faults import list_names
from coadjoint.spec.core.names import NAME
from coadjoint.spec.core.parts import Part, name_pattern
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading, Table
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.values import Block, Matrix
from coadjoint.spec.sections.algebras import ALGEBRA, scalars_of
from coadjoint.spec.sections.matrices import (
    block_places,
    by_matrices,
    point_at_faults,
    representation_of,
)


class RepresentationPart(Part):
    """A linear action of the algebra on advected quantities: by matrices, or on matrices."""

    matrices: Annotated[dict[str, Matrix], Field(min_length=1)] | None = Field(
        None,
        description="a matrix for each name of the basis; those left out act as zero",
        json_schema_extra=name_pattern(),
    )
    left: Block | None = Field(
        None, description="the block whose matrices L act as A -> L A on matrices A, row by row"
    )
    right: Block | None = Field(
        None, description="the block whose matrices R act as A -> -A R on matrices A, row by row"
    )


def read_representations(
    reading: Reading, parts: Mapping[str, RepresentationPart]
) -> dict[str, Representation]:
    """The declared representations by name.

    Raises:
        AlgebraError: The matrices do not commute like the algebra.
        SpecError: A name is taken or unknown, or a matrix has the wrong size.
    """
    source, algebra = reading.source, ALGEBRA.of(reading).algebra
    if algebra is None:
        return {}
    representations, scalars = {}, scalars_of(reading)
    for name, part in parts.items():
        key: KeyPath = ("representations", name)
        if not NAME.fullmatch(name) or name in KNOWN:
            problem = f"{name!a} cannot name a representation"
            expected = f"a name other than {', '.join(KNOWN)}, which every algebra has"
            raise source.at_key(key, problem, name, expected)
        if part.matrices is None:
            representations[name] = _on_matrices(source, key, algebra, name, part)
        elif part.left is None and part.right is None:
            inner = (*key, "matrices")
            representations[name] = by_matrices(
                source, inner, algebra, name, part.matrices, scalars
            )
        else:
            side = "right" if part.left is None else "left"
            problem = f"the representation {name!r} has both matrices and {side!r}"
            expected = "either matrices over the basis, or blocks that act from left and right"
            raise source.fault((*key, side), problem, side, expected)
    return representations


def _on_matrices(
    source: Source, key: KeyPath, algebra: LieAlgebra, name: str, part: RepresentationPart
) -> Representation:
    """``A -> L A - A R`` with the matrices of two blocks, either of which may be missing."""
    if part.left is None and part.right is None:
        problem = f"the representation {name!r} says nothing of how the algebra acts"
        expected = "matrices, or a block of the algebra as left or right"
        hint = f'Write for instance right = "{next(iter((*algebra.blocks, *algebra.basis)))}".'
        raise source.at_key(key, problem, name, expected, hint)
    left, right = (
        _own_matrices(source, (*key, side), algebra, block)
        for side, block in (("left", part.left), ("right", part.right))
    )
    with point_at_faults(source, key):
        return two_sided(algebra, name, left, right)


def _own_matrices(
    source: Source, key: KeyPath, algebra: LieAlgebra, block: str | list[str] | None
) -> tuple[SparseMatrix, ...]:
    """The algebra's matrices where a block acts, zero for the rest; none without a block."""
    if block is None:
        return ()
    places = block_places(source, key, block, algebra)
    acting = [m if i in places else {} for i, m in enumerate(algebra.matrices)]
    if not any(acting):
        named = list_names(algebra.basis[i] for i in places)
        problem = f"{algebra.name} has no matrices for {named}"
        expected = "a block of an algebra that is given by matrices, such as so(3)"
        raise source.fault(key, problem, named, expected)
    return without_zero_places(acting)


REPRESENTATIONS = Table[dict[str, Representation]](
    "representations",
    RepresentationPart,
    "declared representations",
    read_representations,
    many=True,
    absent={},
)


class ClebschPart(Part):
    """A canonical pair of the route clebsch, in addition to those of the advected quantities."""

    representation: str = Field(description="how the algebra acts on it, such as 'adjoint'")


def read_clebsch(reading: Reading, part: ClebschPart) -> Representation | None:
    """How the algebra acts on the pair; None where there is no algebra."""
    algebra = ALGEBRA.of(reading).algebra
    if algebra is None:
        return None
    at, declared = ("clebsch", "representation"), REPRESENTATIONS.of(reading)
    return representation_of(reading.source, at, algebra, part.representation, declared)


CLEBSCH = Table[Representation | None](
    "clebsch",
    ClebschPart,
    "a canonical pair of its own for the route clebsch",
    read_clebsch,
    routed=True,
)
