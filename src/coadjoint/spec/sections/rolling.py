"""Rolling: the table [rolling], a body that rolls on a plane or a surface without slipping.

Comes in: its keys. Goes out: a `Rolling`, or None. On a plane its attitude and point of contact are
followed by `coadjoint.spec.sections.reconstruction` without being declared.
Read next: `coadjoint.spec.sections.contacts`, then `coadjoint.derive.mechanics.followed`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from coadjoint.algebra.attitudes import turning_places
from coadjoint.spec.core.components import component_names
from coadjoint.spec.core.faults import list_names
from coadjoint.spec.core.formulas import Formula, read_fitting
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading, Table
from coadjoint.spec.sections.algebras import ALGEBRA
from coadjoint.spec.sections.constraints import CONSTRAINTS
from coadjoint.spec.sections.contacts import NEEDS, Contact, read_contact
from coadjoint.spec.sections.variables import SPACE, VARIABLES, position_roles

#: What a rolling body has followed: its attitude, and the point of contact on the plane.
ATTITUDE, CONTACT = "q", ("x", "y")


class RollingPart(Part):
    """A body that rolls on a plane or a surface."""

    arm: str = Field(
        description="from the point of contact to the centre of mass, seen as velocities are"
    )
    normal: str | None = Field(
        None, description="on a plane: the advected vector normal to it, seen from the body"
    )
    surface: str | None = Field(
        None,
        description="on a surface: the function of the point of contact that is 0 on it and "
        "positive where the body is",
    )
    contact: str | None = Field(
        None, description="the point of contact in space, a variable with the role 'contact'"
    )
    body: str | None = Field(
        None,
        description="the function of the point of contact, seen from the body, that is 0 on the "
        "surface of the body and negative inside",
    )
    point: str | None = Field(
        None,
        description="the point of contact seen from the body, a variable with the role 'contact'",
    )
    radius: str | None = Field(None, description="of a ball, in the place of body and point")
    turning: str | None = Field(
        None,
        description="the angular velocity at which a surface turns about the origin, going over "
        "into itself, in axes of space",
    )
    axes: Annotated[list[str], Field(min_length=3, max_length=3)] | None = Field(
        None, description="the advected vectors that are the three axes of space, seen from a body"
    )


@dataclass(frozen=True)
class Rolling:
    """A body that rolls on a plane or a surface without slipping.

    Attributes:
        arm: From the point of contact to the centre of mass, seen as velocities are.
        normal: Name of the advected vector normal to the plane, seen from the body; "" on another
            surface.
        turning: Name of the angular velocity.
        velocity: Name of the velocity of the centre of mass.
        contact: Where the body touches a surface; None on a plane, where that follows.
    """

    arm: Formula
    normal: str
    turning: str
    velocity: str
    contact: Contact | None = None


def read_rolling(reading: Reading, part: RollingPart) -> Rolling:
    """How a body rolls.

    Raises:
        SpecError: There is no body in space with an advected normal under constraints, or a name is
            taken that its attitude and point of contact have; or the surfaces are not declared.
    """
    key = ("rolling",)
    if not CONSTRAINTS.of(reading).constraints:
        problem = "there are no constraints"
        expected = '[constraints] with [rolling], as rolling = "Y == cross(Omega, s)"'
        raise reading.fault(key, problem, "constraints", expected)
    scope = reading.scope("an arm", position_roles(reading), driven=())
    if any(getattr(part, name) is not None for name in NEEDS):
        contact = read_contact(reading, part)
        turning, velocity = _find_ball(reading) or _find_body(reading, key)
        arm = read_fitting(reading.source, (*key, "arm"), part.arm, scope, (3,), contact.place)
        return Rolling(arm=arm, normal="", turning=turning, velocity=velocity, contact=contact)
    if part.normal is None:
        problem, expected = "nothing says what the body rolls on", "normal, or surface and contact"
        raise reading.fault(key, problem, "arm", expected)
    turning, velocity = _find_body(reading, key)
    _check_free(reading, key)
    normals = [v.name for v in VARIABLES.of(reading) if v.role == "advected" and v.shape == (3,)]
    if part.normal not in normals:
        problem = f"there is no advected vector {part.normal!a}"
        raise reading.unknown((*key, "normal"), problem, part.normal, normals)
    arm = read_fitting(reading.source, (*key, "arm"), part.arm, scope, (3,), part.normal)
    return Rolling(arm=arm, normal=part.normal, turning=turning, velocity=velocity)


def _find_ball(reading: Reading) -> tuple[str, str] | None:
    """Angular velocity and velocity of a body whose centre is a coordinate; None of another."""
    variables = VARIABLES.of(reading)
    coordinates = [v.name for v in variables if v.role == "coordinate" and v.shape == (SPACE,)]
    moving = [v.name for v in variables if v.role == "velocity" and v.of in coordinates]
    turning = [v.name for v in variables if v.role == "velocity" and len(v.block) == SPACE]
    if len(coordinates) == len(moving) == len(turning) == 1:
        return turning[0], moving[0]
    return None


def _find_body(reading: Reading, key: KeyPath) -> tuple[str, str]:
    """Angular velocity and velocity of a body as it sees them itself."""
    algebra, invariance = ALGEBRA.of(reading).algebra, ALGEBRA.of(reading).invariance
    blocks = {} if algebra is None else algebra.blocks
    velocities = {v.block: v.name for v in VARIABLES.of(reading) if v.role == "velocity"}
    names = [
        velocities.get(tuple(blocks[label]), "") if label in blocks else ""
        for label in ("rotation", "translation")
    ]
    in_space = algebra is not None and turning_places(algebra) is not None
    if not all(names) or not in_space:
        problem = "there is no velocity of the block rotation and none of translation"
        expected = 'the algebra "se(3)" with a velocity over each of these blocks'
        raise reading.fault(key, problem, list_names(velocities.values()), expected)
    if invariance != "left":
        problem = "velocities are seen from space, and [rolling] sees them from the body"
        expected = 'invariance = "left" with [rolling]'
        raise reading.fault(("algebra", "invariance"), problem, invariance, expected)
    return names[0], names[1]


def _check_free(reading: Reading, key: KeyPath) -> None:
    """Nothing else is called as the attitude and the point of contact are."""
    wanted = {ATTITUDE, *component_names(ATTITUDE, (4,), "quaternion"), *CONTACT}
    owners = {name: str(owner.key[0]) for name, owner in reading.owners.items()}
    for table in ("observables", "symmetries", "momenta", "reconstruction"):  # read later
        owners |= dict.fromkeys(getattr(reading.file, table), table)
    for name in sorted(wanted & owners.keys()):
        what = "the attitude" if name.startswith(ATTITUDE) else "the point of contact"
        raise reading.fault(
            key,
            f"{name!r} is declared in [{owners[name]}], and it is what [rolling] calls {what}",
            name,
            f"other names than {list_names(sorted(wanted))} for what is declared",
            "The attitude and the point of contact are followed without being declared: remove it."
            if owners[name] == "reconstruction"
            else f"Call it '{name}_0'.",
        )


ROLLING = Table[Rolling | None](
    "rolling", RollingPart, "a body that rolls on a plane or a surface", read_rolling
)
