"""Indices: the table [index], which counts the equal members of a system.

Comes in: its keys. Goes out: an `Index`, whose size may be left to the one who loads the system.
Read next: `coadjoint.spec.windows`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field

from coadjoint.families import Index
from coadjoint.spec.core.faults import list_names
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.reading import Reading, Table
from coadjoint.spec.core.values import NAME_PATTERN


class IndexPart(Part):
    """An index that counts equal members."""

    size: Annotated[int, Field(ge=1)] | None = Field(
        None,
        description="how many members there are; chosen when the system is loaded if left out, as "
        'coadjoint.load("chain.toml", sizes={"i": 1000})',
    )
    periodic: bool = Field(
        False,
        description="whether the last member is followed by the first; an open chain, the default, "
        "has two ends",
    )
    first: Annotated[int, Field(ge=0, le=1)] = Field(
        0, description="the number of the first member in formulas: 0, or 1 as in most books"
    )
    count: Annotated[str, Field(pattern=NAME_PATTERN)] | None = Field(
        None, description="what formulas call the number of members, as 'n'"
    )
    written_out: bool = Field(
        False,
        description="whether all members are written out for the loaded size, as an ordinary "
        "system, although a generic member tells the equations of all",
    )


def read_indices(reading: Reading, parts: Mapping[str, IndexPart]) -> tuple[Index, ...]:
    """The index, of which a spec has one.

    Raises:
        SpecError: There are several.
    """
    if len(parts) > 1:
        problem, second = f"there are {len(parts)} indices", list(parts)[1]
        raise reading.at_key(
            ("index", second),
            problem,
            list_names(parts),
            "one index",
            f"Remove {second}; a sum over pairs has a second index without a declaration.",
        )
    return tuple(make_index(name, part, part.size) for name, part in parts.items())


def make_index(name: str, part: IndexPart, size: int | None) -> Index:
    """An index of so many members."""
    return Index(
        name=name, size=size, periodic=part.periodic, first=part.first, count=part.count or ""
    )


INDEX = Table[tuple[Index, ...]](
    "index",
    IndexPart,
    "the index that counts equal members, as i = { size = 100 }",
    read_indices,
    many=True,
)
