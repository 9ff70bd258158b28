"""Truncation: the table [truncation], a fluid on the sphere by matrices of N rows.

Comes in: its keys. Goes out: nothing by itself: matrices of a few rows are written out as systems
on u(N), and what is known of all others is a `Windows`.
Read next: `coadjoint.spec.truncated`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field

from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.reading import Reading, Table


class TruncationPart(Part):
    """Skew-Hermitian matrices of N rows in the place of functions on the sphere."""

    size: Annotated[int, Field(ge=2)] | None = Field(
        None,
        description="how many rows there are; chosen when the system is loaded if left out, as "
        'coadjoint.load("fluid.toml", sizes={"N": 33})',
    )
    inertia: str = Field(
        description="the momentum over the velocity in each degree of spherical harmonics, a "
        "multiple of l*(l + 1); of N and parameters, as '2*l*(l + 1)/sqrt(N^2 - 1)'"
    )


def read_truncation(reading: Reading, parts: Mapping[str, TruncationPart]) -> None:
    """Nothing: a file with such a table is written out before it is read."""
    assert not parts, "see coadjoint.spec.truncated"


TRUNCATION = Table[None](
    "truncation",
    TruncationPart,
    "a fluid on the sphere by matrices of N rows, as N = { size = 33, "
    'inertia = "2*l*(l + 1)/sqrt(N^2 - 1)" }',
    read_truncation,
    many=True,
    absent=None,
)
