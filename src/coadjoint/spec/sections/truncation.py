"""Truncation: the table [truncation], a fluid on a surface by matrices of N rows.

Comes in: its keys. Goes out: nothing by itself: matrices of a few rows are written out as systems
on u(N), and what is known of all others is a `Windows`.
Read next: `coadjoint.spec.truncated`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import Field

from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.reading import Reading, Table


class TruncationPart(Part):
    """Skew-Hermitian matrices of N rows in the place of functions on a surface."""

    size: Annotated[int, Field(ge=2)] | None = Field(
        None,
        description="how many rows there are; chosen when the system is loaded if left out, as "
        'coadjoint.load("fluid.toml", sizes={"N": 33})',
    )
    surface: Literal["sphere", "torus"] = Field(
        "sphere",
        description="on what the functions are: the unit sphere, or a plane that closes in both "
        "directions after 2 pi, where N is odd",
    )
    inertia: str = Field(
        description="the momentum over the velocity. On the sphere in each degree of spherical "
        "harmonics, a multiple of l*(l + 1); of N and parameters, as '2*l*(l + 1)/sqrt(N^2 - 1)'. "
        "On the torus of each wave, a multiple of k1^2 + k2^2, as '4*pi*(k1^2 + k2^2)/N'"
    )


def read_truncation(reading: Reading, parts: Mapping[str, TruncationPart]) -> None:
    """Nothing: a file with such a table is written out before it is read."""
    assert not parts, "see coadjoint.spec.truncated"


TRUNCATION = Table[None](
    "truncation",
    TruncationPart,
    "a fluid on the sphere or torus by matrices of N rows, as N = { size = 33, "
    'inertia = "2*l*(l + 1)/sqrt(N^2 - 1)" }',
    read_truncation,
    many=True,
    absent=None,
)
