"""Reconstruction: the table [reconstruction], what follows from the motion and does not act on it.

Comes in: its keys, and how a body rolls. Goes out: one `Reconstructed` for every variable that
follows: the attitude and point of contact of a body that rolls, and those declared.
Read next: `coadjoint.derive.mechanics.followed`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, Literal

from pydantic import Field, model_validator

from coadjoint.algebra.attitudes import turning_places
from coadjoint.spec.core.components import Shape, component_names
from coadjoint.spec.core.formulas import Formula, Scope, read_fitting
from coadjoint.spec.core.names import derived_names
from coadjoint.spec.core.parts import TextPart
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Naming, Reading, Table
from coadjoint.spec.core.values import Length, Numbers, Prose, Unit, read_default
from coadjoint.spec.sections.algebras import ALGEBRA
from coadjoint.spec.sections.rolling import ATTITUDE, CONTACT, ROLLING
from coadjoint.spec.sections.variables import VARIABLES, motion_roles


class ReconstructedPart(TextPart):
    """A variable that follows from the motion and does not act on it."""

    alone = "rate"

    rate: str | None = Field(None, description="its time derivative")
    shape: Annotated[list[Length], Field(max_length=2)] = Field(
        [], description="[] for a scalar, [n] for a vector, [n, m] for a matrix, as its rate has"
    )
    attitude: Literal["quaternion"] | None = Field(
        None, description="'quaternion' for the attitude that the angular velocity turns"
    )
    default: Numbers | None = Field(None, description="where it begins; by default at zero")
    unit: Unit = ""
    doc: Prose = Field("", description="what it is, for documents")

    @model_validator(mode="after")
    def _one_way(self) -> ReconstructedPart:
        if (self.rate is None) == (self.attitude is None):
            raise ValueError("either rate or attitude")
        if self.attitude is not None and self.shape:
            raise ValueError("shape goes with rate, since an attitude has components of its own")
        return self


@dataclass(frozen=True)
class Reconstructed:
    """A variable that follows from the motion and does not act on it.

    Attributes:
        name: As declared.
        rate: Its time derivative; None for an attitude and for a point of contact.
        attitude: ``"quaternion"`` if it is the attitude that the angular velocity turns; else "".
        shape: Shape of its value.
        default: Where it begins, one exact value per component.
        unit: Unit text.
        doc: Free text for documents.
        of_rolling: Whether it is followed for a body that rolls, and not declared.
    """

    name: str
    rate: Formula | None
    attitude: str = ""
    shape: Shape = ()
    default: tuple[Fraction, ...] | None = None
    unit: str = ""
    doc: str = ""
    of_rolling: bool = False

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components, in order."""
        return component_names(self.name, self.shape, self.attitude)


def read_reconstruction(
    reading: Reading, parts: Mapping[str, ReconstructedPart]
) -> tuple[Reconstructed, ...]:
    """The variables that follow from the motion; rates may name all of them.

    Raises:
        SpecError: A default has another shape, or an attitude has nothing that turns it.
    """
    rolling = ROLLING.of(reading)
    first = _follow_rolling() if rolling is not None and rolling.normal else ()
    blank = [
        Reconstructed(name=name, rate=None, attitude=part.attitude or "", shape=_shape(part))
        for name, part in parts.items()
    ]
    scope = reading.scope("a rate", motion_roles(reading), followed_shapes((*first, *blank)))
    return (*first, *(_read_one(reading, name, part, scope) for name, part in parts.items()))


def _follow_rolling() -> tuple[Reconstructed, ...]:
    """Attitude and point of contact of a rolling body."""
    attitude = Reconstructed(
        name=ATTITUDE,
        rate=None,
        attitude="quaternion",
        shape=(4,),
        doc="attitude of the body, a unit quaternion",
        of_rolling=True,
    )
    doc = "of the point of contact on the plane"
    contact = (Reconstructed(name=name, rate=None, doc=doc, of_rolling=True) for name in CONTACT)
    return (attitude, *contact)


def _read_one(reading: Reading, name: str, part: ReconstructedPart, scope: Scope) -> Reconstructed:
    """A declared variable."""
    key: KeyPath = ("reconstruction", name)
    if part.attitude is not None:
        _check_turned(reading, key, name)
    rate = None
    if part.rate is not None:
        at = reading.source.place_of(key, "rate")
        hint = "" if part.shape else "Give its shape, as { rate = ..., shape = [3] }."
        rate = read_fitting(reading.source, at, part.rate, scope, _shape(part), name, hint)
    default = read_default(reading.source, (*key, "default"), part.default, _shape(part))
    if part.attitude is not None and default is not None and not any(default):
        problem = "the quaternion 0 is not an attitude"
        expected = "a quaternion of length 1, such as [1, 0, 0, 0]"
        raise reading.fault((*key, "default"), problem, [0] * len(default), expected)
    return Reconstructed(
        name=name,
        rate=rate,
        attitude=part.attitude or "",
        shape=_shape(part),
        default=default,
        unit=part.unit,
        doc=part.doc,
    )


def _check_turned(reading: Reading, key: KeyPath, name: str) -> None:
    """There is an angular velocity in space, along which the attitude turns."""
    algebra, variables = ALGEBRA.of(reading).algebra, VARIABLES.of(reading)
    spanned = {place for v in variables if v.role == "velocity" for place in v.block}
    places = None if algebra is None else turning_places(algebra)
    if reading.file.reduction is not None:
        raise reading.fault(
            key,
            f"the attitude {name!r} belongs to the algebra of the whole system, and there is "
            "[reduction]",
            name,
            "rates that are functions of what is left",
            'Declare an angle, as theta = "omega", or the attitude in a spec without [reduction].',
        )
    if places is None or not set(places) <= spanned:
        hint = 'Without one, declare an angle: theta = "omega".'
        if algebra is not None and places is not None and not spanned & set(places):
            block = ", ".join(f'"{algebra.basis[place]}"' for place in places)
            free = reading.free_name("Omega")
            hint = f'Write {free} = {{ role = "velocity", block = [{block}] }} in [variables].'
        raise reading.fault(
            key,
            f"nothing turns the attitude {name!r}",
            "no algebra" if algebra is None else algebra.name,
            'a velocity over the rotations of "so(3)" or "se(3)"',
            hint,
        )


def _shape(part: ReconstructedPart) -> Shape:
    return (4,) if part.attitude else tuple(part.shape)


def followed_shapes(followed: Iterable[Reconstructed]) -> dict[str, Shape]:
    """Shapes of what follows and of its components, by the names of claims."""
    shapes: dict[str, Shape] = {}
    for each in followed:
        shapes |= dict.fromkeys(each.components, ()) | {each.name: each.shape}
    return shapes


def _name_all(table: str, followed: Iterable[Reconstructed]) -> Iterator[Naming]:
    """The names of what follows, of its components and of their rates."""
    for each in followed:
        key: KeyPath = ("rolling",) if each.of_rolling else (table, each.name)
        rates = tuple(derived_names(each.components))
        yield Naming(key=key, name=each.name, components=each.components, rates=rates)


RECONSTRUCTION = Table[tuple[Reconstructed, ...]](
    "reconstruction",
    ReconstructedPart,
    "what follows from the motion, as x = 'v'",
    read_reconstruction,
    many=True,
    always=True,  # what follows for a body that rolls is not declared
    names=_name_all,
)
