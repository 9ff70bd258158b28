"""Time: the table [time], which gives the time a name in formulas.

Comes in: its keys. Goes out: a `Time`, or None where no formula may name it.
Read next: `coadjoint.spec.sections.inputs`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from pydantic import Field

from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.reading import Naming, Reading, Table
from coadjoint.spec.core.values import Prose, Unit


class TimePart(Part):
    """The time, for formulas that name it."""

    name: str = Field("t", description="its name in formulas")
    unit: Unit = Field("s", description="unit; '1' if dimensionless")
    doc: Prose = Field("", description="what it is, for documents")


@dataclass(frozen=True)
class Time:
    """The time, where formulas name it: a scalar argument of every kernel.

    Attributes:
        name: As declared, e.g. ``t``.
        unit: Unit text.
        doc: Free text for documents.
    """

    role: ClassVar[str] = "time"
    shape: ClassVar[Shape] = ()
    value_shape: ClassVar[Shape] = ()
    default: ClassVar[None] = None

    name: str
    unit: str = "s"
    doc: str = ""

    @property
    def components(self) -> tuple[str, ...]:
        """Its name."""
        return (self.name,)


def read_time(reading: Reading) -> Time | None:
    """The time, if it is declared."""
    part = reading.file.time
    return None if part is None else Time(part.name, part.unit, part.doc)


#: Solutions call the time ``t``, so it may have this reserved name.
TIME = Table[Time | None](
    key="time",
    kind=TimePart | None,
    field=Field(None, description="the time, where formulas name it"),
    read=read_time,
    quantities=lambda time: () if time is None else (time,),
    names=lambda time: (
        [] if time is None else [Naming(("time", "name"), time.name, time.components, allowed="t")]
    ),
)
