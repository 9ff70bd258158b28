"""Momenta: the table [momenta], momenta along sections of the constraint distribution.

Comes in: fields that the constraints allow, by their components. Goes out: `Section` records.
Read next: `coadjoint.derive.mechanics.constrained`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.core.parts import Part, name_pattern
from coadjoint.spec.core.reading import Reading, Table, name_each
from coadjoint.spec.core.values import Prose, Unit
from coadjoint.spec.sections.forces import read_along
from coadjoint.spec.sections.variables import VARIABLES, position_roles


class SectionPart(Part):
    """The momentum along a section of the constraint distribution."""

    section: Annotated[dict[str, str], Field(min_length=1)] = Field(
        description="components of the section, as Omega = 's', by the names of the velocities "
        "that no constraint gives; those left out are zero",
        json_schema_extra=name_pattern(),
    )
    unit: Unit = ""
    doc: Prose = Field("", description="what it is, for documents")


@dataclass(frozen=True)
class Section:
    """A section of the constraint distribution, whose momentum is emitted.

    Attributes:
        name: Of the momentum ``<dl/dxi, section>``.
        section: Its component along each independent velocity, by the name of that; the others are
            zero.
        unit: Unit of the momentum.
        doc: Free text for documents.
    """

    name: str
    section: Mapping[str, Formula]
    unit: str = ""
    doc: str = ""

    @property
    def shape(self) -> Shape:
        """A momentum along a section is a scalar."""
        return ()

    @property
    def components(self) -> tuple[str, ...]:
        """Its name."""
        return (self.name,)


def read_sections(reading: Reading, parts: Mapping[str, SectionPart]) -> tuple[Section, ...]:
    """The declared sections, each a formula for every velocity that it names.

    Raises:
        SpecError: There is no Lagrangian, no such velocity that nothing gives, or a shape differs.
    """
    if reading.file.lagrangian is None or reading.file.poisson is not None:
        problem = "there is [momenta] without a Lagrangian, or with a declared bracket"
        expected = "[lagrangian] alone, whose derivatives by the velocities are the momenta"
        hint = "Name the momentum in [observables], and claim it in claims.conserved."
        raise reading.fault(("momenta",), problem, "momenta", expected, hint)
    scope = reading.scope("a section", position_roles(reading), driven=())
    velocities = [
        part for each in VARIABLES.of(reading) if each.role == "velocity" for part in each.parts
    ]
    independent = {each.name: each for each in velocities if each.independent is not False}
    return tuple(
        Section(
            name,
            {
                velocity: read_along(
                    reading, ("momenta", name, "section", velocity), text, scope, independent
                )
                for velocity, text in part.section.items()
            },
            part.unit,
            part.doc,
        )
        for name, part in parts.items()
    )


MOMENTA = Table[tuple[Section, ...]](
    "momenta",
    SectionPart,
    "momenta along sections of the constraint distribution, by name",
    read_sections,
    many=True,
    attribute="sections",
    names=name_each,
)
