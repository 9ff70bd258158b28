"""Dissipation: the table [dissipation], Rayleigh's function of the velocities.

Comes in: its key R. Goes out: a `Formula`, whose force is ``-dR/dxi``.
Read next: `coadjoint.spec.sections.relaxation`.
"""

from __future__ import annotations

from pydantic import Field

from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading, Table
from coadjoint.spec.core.tree import walk
from coadjoint.spec.sections.forces import check_whole
from coadjoint.spec.sections.variables import VARIABLES, motion_roles


class DissipationPart(Part):
    """Dissipation by a function of the velocities."""

    R: str = Field(description="Rayleigh's function; the force is -dR/dxi")


def read_dissipation(reading: Reading, part: DissipationPart) -> Formula:
    """Rayleigh's function.

    Raises:
        SpecError: It is no formula of velocities, or the motion is restricted.
    """
    check_whole(reading, "dissipation")
    key: KeyPath = ("dissipation", "R")
    formula = reading.formula(key, part.R, reading.scope("a dissipation", motion_roles(reading)))
    velocities = [each for each in VARIABLES.of(reading) if each.role == "velocity"]
    known = {name for each in velocities for name in (each.name, *each.components)}
    if not known & {getattr(node, "name", "") for node in walk(formula.tree)}:
        raise reading.source.fault(
            key,
            "Rayleigh's function names no velocity",
            found=part.R,
            expected="a function of velocities, whose force is -dR/dxi",
            hint="Declare velocities, or write what acts along a momentum in [forces].",
        )
    return formula


DISSIPATION = Table[Formula | None](
    "dissipation", DissipationPart, "dissipation by a function R", read_dissipation, acts=True
)
