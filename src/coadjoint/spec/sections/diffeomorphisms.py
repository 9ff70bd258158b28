"""Diffeomorphisms: the table [diffeomorphisms], motions of the circle or the plane itself.

The velocity u of such a motion is a vector field on the circle, with ``ad_u v = v u_s - u v_s``,
and right invariant. In a plane that closes in both directions they are those that keep areas, and a
stream function psi stands for the velocity ``(psi_y, -psi_x)``.
Comes in: its keys. Goes out: a `Diffeomorphisms`.
Read next: `coadjoint.spec.sections.space`.
"""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import Field

from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.reading import Reading, Table


class DiffeomorphismsPart(Part):
    """The group of diffeomorphisms of the circle, or those of a plane that keep areas.

    They stand in the place of an algebra.
    """

    central: str | None = Field(
        None,
        description="central charge: the factor of the cocycle of Virasoro's algebra, the integral "
        "of u_s v_ss",
    )


@dataclass(frozen=True)
class Diffeomorphisms:
    """The group of diffeomorphisms of the circle, or its central extension.

    Attributes:
        central: The factor of the cocycle; None without an extension.
    """

    central: Formula | None = None


def read_diffeomorphisms(reading: Reading, part: DiffeomorphismsPart) -> Diffeomorphisms:
    """The group.

    Raises:
        SpecError: There is no coordinate that it moves.
    """
    if not reading.file.space:
        problem, expected = "there is no circle that they move", "a table [space]"
        hint = 'Write [space] and below it s = { length = "L" }.'
        raise reading.source.fault(("diffeomorphisms",), problem, "diffeomorphisms", expected, hint)
    if part.central is not None and len(reading.file.space) > 1:
        problem, expected = "the maps of a plane have a central charge", "one of a circle"
        key, hint = ("diffeomorphisms", "central"), "Remove central."
        raise reading.source.fault(key, problem, part.central, expected, hint)
    if part.central is None:
        return Diffeomorphisms()
    scope = reading.scope("a central charge", ())
    return Diffeomorphisms(reading.formula(("diffeomorphisms", "central"), part.central, scope))


DIFFEOMORPHISMS = Table[Diffeomorphisms | None](
    "diffeomorphisms",
    DiffeomorphismsPart,
    "the group of diffeomorphisms of the circle, or those of a plane that keep areas, in the place "
    "of an algebra",
    read_diffeomorphisms,
)
