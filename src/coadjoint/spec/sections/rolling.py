"""Rolling: the table [rolling], a body that rolls on a plane without slipping.

Comes in: its keys. Goes out: a `Rolling`, or None. Its attitude and point of contact are followed
by `coadjoint.spec.sections.reconstruction` without being declared.
Read next: `coadjoint.derive.mechanics.followed`.
"""

from __future__ import annotations

from dataclasses import dataclass

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
from coadjoint.spec.sections.variables import VARIABLES, position_roles

#: What a rolling body has followed: its attitude, and the point of contact on the plane.
ATTITUDE, CONTACT = "q", ("x", "y")


class RollingPart(Part):
    """A body that rolls on a plane."""

    arm: str = Field(
        description="from the point of contact to the centre of mass, seen from the body"
    )
    normal: str = Field(description="the advected vector normal to the plane")


@dataclass(frozen=True)
class Rolling:
    """A body that rolls on a plane without slipping, for its height and the trace that it leaves.

    Attributes:
        arm: From the point of contact to the centre of mass, seen from the body.
        normal: Name of the advected vector normal to the plane, seen from the body.
        turning: Name of the angular velocity.
        velocity: Name of the velocity of the centre of mass, seen from the body.
    """

    arm: Formula
    normal: str
    turning: str
    velocity: str


def read_rolling(reading: Reading, part: RollingPart) -> Rolling:
    """How a body rolls.

    Raises:
        SpecError: There is no body in space with an advected normal under constraints, or a name is
            taken that its attitude and point of contact have.
    """
    key = ("rolling",)
    if not CONSTRAINTS.of(reading).constraints:
        problem = "there are no constraints"
        expected = '[constraints] with [rolling], as rolling = "Y == cross(Omega, s)"'
        raise reading.fault(key, problem, "constraints", expected)
    turning, velocity = _find_body(reading, key)
    scope = reading.scope("an arm", position_roles(reading), driven=())
    _check_free(reading, key)
    normals = [v.name for v in VARIABLES.of(reading) if v.role == "advected" and v.shape == (3,)]
    if part.normal not in normals:
        problem = f"there is no advected vector {part.normal!a}"
        raise reading.unknown((*key, "normal"), problem, part.normal, normals)
    arm = read_fitting(reading.source, (*key, "arm"), part.arm, scope, (3,), part.normal)
    return Rolling(arm, part.normal, turning, velocity)


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
    "rolling", RollingPart, "a body that rolls on a plane", read_rolling
)
