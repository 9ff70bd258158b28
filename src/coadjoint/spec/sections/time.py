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
    unit: Unit = ""
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
    unit: str = ""
    doc: str = ""

    @property
    def components(self) -> tuple[str, ...]:
        """Its name."""
        return (self.name,)


def read_time(reading: Reading, part: TimePart) -> Time:
    """The time."""
    return Time(part.name, part.unit, part.doc)


def _name_time(table: str, time: Time | None) -> list[Naming]:
    """Its name; it may be ``t``, which is reserved since solutions call the time so."""
    return [] if time is None else [Naming(key=(table, "name"), name=time.name, allowed="t")]


TIME = Table[Time | None](
    "time",
    TimePart,
    "the time, where formulas name it",
    read_time,
    quantities=True,
    names=_name_time,
)
