"""Followed: what a motion turns and carries along without being acted on, read from its tables.

Comes in: the validated tables [rolling] and [reconstruction]. Goes out: a `Rolling`, and one
`Reconstructed` for every variable that follows: those declared, and the attitude and point of
contact of a body that rolls. Read next: `coadjoint.derive.mechanics.followed`.
"""

from __future__ import annotations

from collections.abc import Sequence

from coadjoint.algebra.attitudes import turning_places
from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.errors import CoadjointError
from coadjoint.spec.core.faults import did_you_mean, listed
from coadjoint.spec.core.formulas import DRIVING, Quantity, Scope, make_scope, read_formula
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.shapes import words
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.units import Unit, parse_unit, unit_of, unit_text
from coadjoint.spec.model import Definition, Shape, Variable
from coadjoint.spec.schema import SpecFile
from coadjoint.spec.sections.constrained import Reconstructed, Rolling
from coadjoint.spec.sections.constrained_schema import ReconstructedPart
from coadjoint.spec.sections.quantities import Parameter
from coadjoint.spec.sections.structure import read_default

#: What a rolling body has followed: its attitude, and the point of contact on the plane.
ATTITUDE, CONTACT = "q", ("x", "y")


class FollowedReader:
    """The tables [rolling] and [reconstruction].

    Args:
        source: The text of the spec.
        file: Its tables.
        algebra: What the velocities are along, or None.
        variables: All variables.
        quantities: Variables, parameters and definitions.
    """

    def __init__(
        self,
        source: Source,
        file: SpecFile,
        algebra: LieAlgebra | None,
        variables: Sequence[Variable],
        quantities: Sequence[Quantity],
    ) -> None:
        self.source, self.file, self.algebra = source, file, algebra
        self.variables, self.quantities = variables, quantities

    # -- a body that rolls ----------------------------------------------------------------

    def rolling(self) -> Rolling | None:
        """How a body rolls.

        Raises:
            SpecError: There is no body in space with an advected normal under constraints, or a
                name is taken that its attitude and point of contact have.
        """
        part, key = self.file.rolling, ("rolling",)
        if part is None:
            return None
        if self.file.constraints is None:
            raise self.source.fault(
                key,
                "there are no constraints",
                found="constraints",
                expected='[constraints] beside [rolling], as rolling = "Y == cross(Omega, s)"',
            )
        turning, velocity = self._body(key)
        self._check_free(key)
        normals = [v.name for v in self.variables if v.role == "advected" and v.shape == (3,)]
        if part.normal not in normals:
            raise self.source.fault(
                (*key, "normal"),
                f"there is no advected vector {part.normal!a}",
                found=part.normal,
                expected=f"one of {listed(normals)}",
                hint=did_you_mean(part.normal, normals),
            )
        roles = [each.role for each in self.variables if each.role != "velocity"]
        scope = make_scope("an arm", tuple(dict.fromkeys(roles)), self.quantities)
        arm = read_formula(self.source, (*key, "arm"), part.arm, scope, any_shape=True)
        if arm.shape != (3,):
            raise self.source.fault(
                (*key, "arm"),
                f"the arm is {words(arm.shape)}",
                found=words(arm.shape),
                expected="a 3-vector",
            )
        return Rolling(arm, part.normal, turning, velocity)

    def _body(self, key: KeyPath) -> tuple[str, str]:
        """Angular velocity and velocity of a body as it sees them itself."""
        blocks = {} if self.algebra is None else self.algebra.blocks
        velocities = {v.block: v.name for v in self.variables if v.role == "velocity"}
        names = [
            velocities.get(tuple(blocks[label]), "") if label in blocks else ""
            for label in ("rotation", "translation")
        ]
        in_space = self.algebra is not None and turning_places(self.algebra) is not None
        if not all(names) or not in_space:
            raise self.source.fault(
                key,
                "there is no velocity of the block rotation and none of translation",
                found=listed(velocities.values()),
                expected='the algebra "se(3)" with a velocity over each of these blocks',
            )
        if self.file.algebra is not None and self.file.algebra.invariance != "left":
            raise self.source.fault(
                ("algebra", "invariance"),
                "velocities are seen from space, and [rolling] sees them from the body",
                found=self.file.algebra.invariance,
                expected='invariance = "left" beside [rolling]',
            )
        return names[0], names[1]

    def _check_free(self, key: KeyPath) -> None:
        """Nothing else is called as the attitude and the point of contact are."""
        followed = self._of_rolling("1")
        wanted = {name for each in followed for name in (each.name, *each.components)}
        file = self.file
        tables: dict[str, set[str]] = {
            "variables": set(file.variables),
            "parameters": set(file.parameters),
            "inputs": set(file.inputs),
            "definitions": {name.split("(")[0].strip() for name in file.definitions},
            "observables": set(file.observables),
            "symmetries": set(file.symmetries),
            "momenta": set(file.momenta),
            "reconstruction": set(file.reconstruction),
        }
        for each in self.quantities:
            if not isinstance(each, Definition):
                table = "variables" if isinstance(each, Variable) else f"{each.role}s"
                tables.setdefault(table, set()).update(each.components)
        for table, names in tables.items():
            for name in sorted(names & wanted):
                raise self.source.fault(
                    key,
                    f"{name!r} is declared in [{table}], and it is what [rolling] calls "
                    f"{'the attitude' if name.startswith(ATTITUDE) else 'the point of contact'}",
                    found=name,
                    expected=f"other names than {listed(sorted(wanted))} for what is declared",
                    hint="The attitude and the point of contact are followed without being "
                    "declared." if table == "reconstruction" else f"Call it '{name}_0'.",
                )  # fmt: skip

    # -- what follows ---------------------------------------------------------------------

    def followed(self, rolling: Rolling | None) -> tuple[Reconstructed, ...]:
        """The variables that follow from the motion; rates may name all of them.

        Raises:
            SpecError: A default has another shape, or an attitude has nothing that turns it.
        """
        unit = "1"
        if rolling is not None:
            unit = unit_text(unit_of(rolling.arm.tree, self._units()))
        first = () if rolling is None else self._of_rolling(unit)
        parts = self.file.reconstruction
        shapes: dict[str, Shape] = {name: () for each in first for name in each.components}
        shapes |= {each.name: each.shape for each in first}
        for name, part in parts.items():
            record = Reconstructed(name, None, part.attitude or "", _shape(part))
            shapes |= dict.fromkeys(record.components, ()) | {name: record.shape}
        roles = tuple(dict.fromkeys(("velocity", *(each.role for each in self.variables))))
        scope = make_scope("a rate", roles, self.quantities, shapes, driven=DRIVING)
        return (*first, *(self._reconstructed(name, part, scope) for name, part in parts.items()))

    def _units(self) -> dict[str, Unit | None]:
        declared = [each for each in self.quantities if isinstance(each, Variable | Parameter)]
        return {
            n: parse_unit(each.unit) for each in declared for n in (each.name, *each.components)
        }

    def _of_rolling(self, unit: str) -> tuple[Reconstructed, ...]:
        """Attitude and point of contact of a rolling body."""
        attitude = Reconstructed(
            ATTITUDE,
            None,
            "quaternion",
            (4,),
            doc="attitude of the body, a unit quaternion",
            of_rolling=True,
        )
        doc = "of the point of contact on the plane"
        contact = (
            Reconstructed(name, None, unit=unit, doc=doc, of_rolling=True) for name in CONTACT
        )
        return (attitude, *contact)

    def _reconstructed(self, name: str, part: ReconstructedPart, scope: Scope) -> Reconstructed:
        key: KeyPath = ("reconstruction", name)
        if part.attitude is not None:
            self._check_turned(key, name)
        rate = None
        if part.rate is not None:
            inner = (*key, "rate")
            at = inner if inner in self.source.positions.values else key
            rate = read_formula(self.source, at, part.rate, scope)
        default = read_default(self.source, (*key, "default"), part.default, _shape(part))
        if part.attitude is not None and default is not None and not any(default):
            raise self.source.fault(
                (*key, "default"),
                "the quaternion 0 is no attitude",
                found=[0] * len(default),
                expected="a quaternion of length 1, such as [1, 0, 0, 0]",
            )
        return Reconstructed(
            name, rate, part.attitude or "", _shape(part), default, part.unit, part.doc
        )

    def _check_turned(self, key: KeyPath, name: str) -> None:
        """There is an angular velocity in space, along which the attitude turns."""
        spanned = {place for v in self.variables if v.role == "velocity" for place in v.block}
        places = None if self.algebra is None else turning_places(self.algebra)
        if places is None or not set(places) <= spanned:
            raise self._not_turned(key, name)

    def _not_turned(self, key: KeyPath, name: str) -> CoadjointError:
        algebra = "no algebra" if self.algebra is None else self.algebra.name
        return self.source.fault(
            key,
            f"nothing turns the attitude {name!r}",
            found=algebra,
            expected='a velocity over the rotations of "so(3)" or "se(3)"',
            hint='Without one, declare an angle: theta = "omega".',
        )


def _shape(part: ReconstructedPart) -> Shape:
    return (4,) if part.attitude else ()
