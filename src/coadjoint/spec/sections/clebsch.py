"""Clebsch: the table [clebsch], a canonical pair of its own for the route clebsch.

Comes in: the name of a representation. Goes out: the `Representation`, or None.
Read next: `coadjoint.derive.routes.clebsch`.
"""

from __future__ import annotations

from pydantic import Field

from coadjoint.algebra.representation import Representation
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.reading import Reading, Table
from coadjoint.spec.sections.algebras import ALGEBRA
from coadjoint.spec.sections.matrices import representation_of
from coadjoint.spec.sections.representations import REPRESENTATIONS


class ClebschPart(Part):
    """A canonical pair of the route clebsch, beside those of the advected quantities."""

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
