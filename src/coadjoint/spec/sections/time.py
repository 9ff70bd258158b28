"""Time: the table [time], which gives the time a name in formulas, or says what is in its place.

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
    """The independent variable, for formulas that name it, or where it is not the time."""

    name: str = Field("t", description="its name in formulas")
    unit: Unit = ""
    label: Prose = Field(
        "",
        description="what it is where it is not the time, such as an arc length; no formula has to "
        "name it then",
    )
    doc: Prose = Field("", description="what it is, for documents")


@dataclass(frozen=True)
class Time:
    """The independent variable: where formulas name it, a scalar argument of every kernel.

    Attributes:
        name: As declared, e.g. ``t``.
        unit: Unit text.
        label: What it is, for axes of pictures and documents.
        doc: Free text for documents.
    """

    role: ClassVar[str] = "time"
    shape: ClassVar[Shape] = ()
    value_shape: ClassVar[Shape] = ()
    default: ClassVar[None] = None

    name: str
    unit: str = ""
    label: str = "time"
    doc: str = ""

    @property
    def components(self) -> tuple[str, ...]:
        """Its name."""
        return (self.name,)


def read_time(reading: Reading, part: TimePart) -> Time:
    """The time."""
    return Time(part.name, part.unit, part.label or Time.label, part.doc)


def _name_time(table: str, time: Time | None) -> list[Naming]:
    """Its name; it may be ``t``, which is reserved since solutions call the time so."""
    return [] if time is None else [Naming(key=(table, "name"), name=time.name, allowed="t")]


TIME = Table[Time | None](
    "time",
    TimePart,
    "the time, where formulas name it, or what is in its place",
    read_time,
    quantities=True,
    names=_name_time,
)
