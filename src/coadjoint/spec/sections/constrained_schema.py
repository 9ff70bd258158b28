"""Schema of the tables of a constrained motion: their keys, and of what kind they are.

Comes in: nothing. Goes out: models that `coadjoint.spec.schema` puts together.
Read next: `coadjoint.spec.sections.constraints`, which reads what they hold.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field, model_validator

from coadjoint.spec.core.values import Numbers, Prose, Unit
from coadjoint.spec.sections.algebra_schema import Part, also_text, named


class DissipationPart(Part):
    """Dissipation by a function of the velocities."""

    R: str = Field(description="Rayleigh's function; the force is -dR/dxi")


#: What is enough for a claim, if not a proof.
Accept = Annotated[
    Literal["numerical"] | None,
    Field(
        description="'numerical' if values at random points are enough for this claim; by default "
        "it must be proved"
    ),
]


class DoubleBracketPart(Part):
    """Dissipation along the symplectic leaves: Casimirs are kept, the energy falls."""

    G: str = Field(description="symmetric, positive semidefinite: a number, or a matrix")
    accept: Accept = None


class MetriplecticPart(Part):
    """Dissipation along level sets of the energy: it is kept, the entropy S grows."""

    S: str = Field(description="the entropy, a Casimir")
    G: str = Field(description="symmetric, positive semidefinite, with G dh = 0")
    accept: Accept = None


class RollingPart(Part):
    """A body that rolls on a plane."""

    arm: str = Field(
        description="from the point of contact to the centre of mass, seen from the body"
    )
    normal: str = Field(description="the advected vector normal to the plane")


class ReconstructedPart(Part):
    """A variable that follows from the motion and does not act on it."""

    model_config = ConfigDict(json_schema_extra=also_text)

    rate: str | None = Field(None, description="its time derivative")
    attitude: Literal["quaternion"] | None = Field(
        None, description="'quaternion' for the attitude that the angular velocity turns"
    )
    default: Numbers | None = Field(None, description="where it begins; by default at zero")
    unit: Unit = Field("1", description="unit, such as 'm'; '1' if dimensionless")
    doc: Prose = Field("", description="what it is, for documents")

    @model_validator(mode="before")
    @classmethod
    def _from_text(cls, value: object) -> object:
        return {"rate": value} if isinstance(value, str) else value

    @model_validator(mode="after")
    def _one_way(self) -> ReconstructedPart:
        if (self.rate is None) == (self.attitude is None):
            raise ValueError("either rate or attitude")
        return self


class SectionPart(Part):
    """The momentum along a section of the constraint distribution."""

    section: Annotated[dict[str, str], Field(min_length=1)] = Field(
        description="components of the section, as Omega = 's', by the names of the velocities "
        "that no constraint gives; those left out are zero",
        json_schema_extra=named(),
    )
    unit: Unit = Field("1", description="unit of the momentum; '1' if dimensionless")
    doc: Prose = Field("", description="what it is, for documents")
