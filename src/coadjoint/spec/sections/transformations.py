"""Transformations: the table [transformations], maps that keep the motion.

Comes in: its keys. Goes out: `Transformation` records, whose formulas fit the variables and
observables that they change. Whether what they say is true is proved later.
Read next: `coadjoint.prove.symmetries`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from coadjoint.spec.core.formulas import Formula, read_fitting
from coadjoint.spec.core.parts import Accept, ClaimPart, Part, name_pattern
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading, Table
from coadjoint.spec.sections.symmetries import read_move, shapes_in_claims
from coadjoint.spec.sections.variables import state_roles


class TransformationPart(Part):
    """A map of the state that takes the motion to itself, or to its reverse."""

    map: Annotated[dict[str, str], Field(min_length=1)] = Field(
        description="what variables become; those left out stay", json_schema_extra=name_pattern()
    )
    reverses_time: bool = Field(False, description="whether it takes the motion to its reverse")
    exchanges: dict[str, ClaimPart] = Field(
        {},
        description="what observables and momentum maps become, as J_L = 'J_R'",
        json_schema_extra=name_pattern(),
    )
    accept: Accept = None


@dataclass(frozen=True)
class Transformation:
    """A map of the state that keeps the motion.

    Attributes:
        name: As declared.
        map: What variables become; those left out stay.
        reverses_time: Whether the motion becomes its reverse.
        exchanges: What observables and momentum maps become.
    """

    name: str
    map: Mapping[str, Formula]
    reverses_time: bool
    exchanges: Mapping[str, Formula]


def read_transformations(
    reading: Reading, parts: Mapping[str, TransformationPart]
) -> tuple[Transformation, ...]:
    """The declared maps, in order.

    Raises:
        SpecError: A formula does not fit what it stands for.
    """
    return tuple(
        Transformation(
            name,
            {
                variable: read_move(
                    reading, ("transformations", name, "map", variable), variable, text, "a map", {}
                )
                for variable, text in part.map.items()
            },
            part.reverses_time,
            {
                observable: _read_exchange(reading, name, observable, each.claim)
                for observable, each in part.exchanges.items()
            },
        )
        for name, part in parts.items()
    )


def _read_exchange(reading: Reading, name: str, observable: str, text: str) -> Formula:
    """What an observable or momentum map becomes."""
    key: KeyPath = ("transformations", name, "exchanges", observable)
    named = shapes_in_claims(reading)
    if observable not in named:
        problem = f"{observable!a} is neither an observable nor a momentum map"
        raise reading.unknown(key, problem, observable, named, is_key=True)
    scope = reading.scope("an observable", state_roles(reading), named)
    at, shape = reading.source.place_of(key, "claim"), named[observable]
    return read_fitting(reading.source, at, text, scope, shape, observable)


TRANSFORMATIONS = Table[tuple[Transformation, ...]](
    "transformations",
    TransformationPart,
    "maps that keep the motion, by name",
    read_transformations,
    many=True,
)
