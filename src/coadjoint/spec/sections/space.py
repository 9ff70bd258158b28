"""Space: the table [space], the coordinate along which variables are fields, or two of a plane.

Comes in: its keys, and the variables. Goes out: a `Space` with the derivatives that formulas may
name: with a coordinate s, those of ``Xi`` are ``Xi_s``, ``Xi_ss`` and so on.
Read next: `coadjoint.derive.fields.jets`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import prod
from pathlib import Path
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from coadjoint.families import Index
from coadjoint.sizes import check_declared_memory
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.faults import did_you_mean, list_names
from coadjoint.spec.core.formulas import MOST_DERIVATIVES, Formula, read_fitting
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.reading import Naming, Reading, Table
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.values import Unit
from coadjoint.spec.sections.parameters import PARAMETERS
from coadjoint.spec.sections.state import Variable, state_of
from coadjoint.spec.sections.variables import VARIABLES

#: Tables that a spec of fields may have, next to [space] and [profiles].
TABLES = (
    "space",
    "profiles",
    "algebra",
    "diffeomorphisms",
    "variables",
    "parameters",
    "definitions",
    "lagrangian",
    "hamiltonian",
    "lax",
    "observables",
    "claims",
)
_HEAD = ("title", "source", "description", "license", "routes")
#: Roles of fields.
_ROLES = ("velocity", "momentum", "strain", "advected")


class SpacePart(Part):
    """A coordinate along which variables are fields: around a circle, or between two ends."""

    length: str = Field(description="the parameter that is the length of the circle or line")
    size: Annotated[int, Field(ge=1)] | None = Field(
        None,
        description="how many points there are; chosen when the system is loaded if left out, as "
        'coadjoint.load("chain.toml", sizes={"s": 512})',
    )
    order: Literal[2, 4, 6, 8] = Field(
        4, description="order of the central differences: 2, 4 (the default), 6 or 8"
    )
    ends: Literal["periodic", "free", "clamped"] = Field(
        "periodic",
        description='"periodic" (the default), a circle; or "free" or "clamped" ends of a strand, '
        "with order = 2 or 4",
    )
    derivatives: Annotated[int, Field(ge=1, le=MOST_DERIVATIVES)] = Field(
        1,
        description="the highest derivative along the coordinate that formulas name: 1 (the "
        "default) to 4",
    )
    unit: Unit = ""


@dataclass(frozen=True)
class Jet:
    """A derivative of a field along space, such as ``Xi_s``.

    Attributes:
        of: The field.
        order: How often it is differentiated along the coordinate.
        coordinate: The name of the coordinate.
        second: That of the second one in a plane; "" on a line.
        across: How often it is differentiated along that one.
    """

    default: ClassVar[None] = None

    of: Variable
    order: int
    coordinate: str
    second: str = ""
    across: int = 0

    @property
    def name(self) -> str:
        """``Xi_ss``."""
        return self._name(self.of.name)

    @property
    def components(self) -> tuple[str, ...]:
        """``Xi1_ss`` and so on."""
        return tuple(map(self._name, self.of.components))

    def _name(self, name: str) -> str:
        return jet_name(name, self.coordinate, self.order, self.second, across=self.across)

    @property
    def role(self) -> str:
        """That of the field."""
        return self.of.role

    @property
    def shape(self) -> Shape:
        """That of the field."""
        return self.of.shape

    @property
    def form(self) -> str:
        """That of the field."""
        return self.of.form

    @property
    def value_shape(self) -> Shape:
        """Shape in formulas."""
        return self.of.value_shape


def jet_name(name: str, coordinate: str, order: int, second: str = "", *, across: int = 0) -> str:
    """What a derivative along space is called.

    >>> jet_name("Xi1", "s", 2), jet_name("u", "s", 0), jet_name("w", "x", 2, "y", across=1)
    ('Xi1_ss', 'u', 'w_xxy')
    """
    word = coordinate * order + second * across
    return f"{name}_{word}" if word else name


@dataclass(frozen=True)
class Space:
    """The coordinate along which variables are fields.

    Attributes:
        name: As declared, e.g. ``s``; it also counts the points.
        length: The parameter that is the length of the circle.
        size: How many points there are, or None.
        order: Order of the central differences.
        ends: ``periodic``, or ``free`` or ``clamped`` ends.
        derivatives: The highest derivative that formulas name.
        jets: The derivatives that formulas may name.
        unit: Unit of the coordinate.
        across: The second coordinate of a plane; None on a line.
    """

    name: str
    length: str
    size: int | None
    order: int
    ends: str
    derivatives: int
    jets: tuple[Jet, ...]
    unit: str = ""
    across: Space | None = None

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The names of all coordinates."""
        return (self.name,) if self.across is None else (self.name, self.across.name)

    @property
    def index(self) -> Index:
        """What counts the points."""
        periodic = not self.has_ends
        return Index(name=self.name, size=self.size, periodic=periodic, from_zero=True)

    @property
    def has_ends(self) -> bool:
        """Whether it is no circle."""
        return self.ends != "periodic"


def read_space(reading: Reading, parts: Mapping[str, SpacePart]) -> Space:
    """The coordinate.

    Raises:
        SpecError: There are several, the length is no scalar parameter, a derivative has a name of
            another kind of coordinate, or a table or a role does not go with fields.
    """
    (name, part), *more = parts.items()
    _check_plane(reading, parts)
    _check_tables(reading)
    _check_ends(reading, name, part)
    for each, own in parts.items():
        _check_length(reading, each, own)
    _check_sizes(reading, parts)
    order = max(each.derivatives for each in parts.values())
    jets = tuple(_list_jets(reading, order, *parts))
    across = _make(*more[0], order, ()) if more else None
    return replace(_make(name, part, order, jets), across=across)


def _make(name: str, part: SpacePart, derivatives: int, jets: tuple[Jet, ...]) -> Space:
    """One coordinate."""
    return Space(
        name=name,
        length=part.length,
        size=part.size,
        order=part.order,
        ends=part.ends,
        derivatives=derivatives,
        jets=jets,
        unit=part.unit,
    )


def _list_jets(reading: Reading, most: int, name: str, second: str = "") -> Iterator[Jet]:
    """The derivatives of all fields up to an order."""
    fields = state_of(VARIABLES.of(reading))
    velocities = (each for each in VARIABLES.of(reading) if each not in fields)
    for each in (*fields, *velocities):
        for order in range(1, most + 1):
            for across in range(order + 1 if second else 1):
                yield Jet(
                    of=each,
                    order=order - across,
                    coordinate=name,
                    second=second,
                    across=across,
                )


def _check_plane(reading: Reading, parts: Mapping[str, SpacePart]) -> None:
    """There is a line, or a plane that closes in both directions and is moved by its maps.

    Raises:
        SpecError: There are more coordinates, or two of something else.
    """
    _, *more = parts.items()
    if len(parts) > 2:
        problem, found = f"there are {len(parts)} coordinates of space", list_names(parts)
        raise reading.at_key(
            ("space", more[1][0]), problem, found, "one, or two of a plane", "Remove the others."
        )
    if more and reading.file.diffeomorphisms is None:
        problem, found = "there are two coordinates of space, and no maps move them", more[0][0]
        expected = "a plane with [diffeomorphisms], or one coordinate"
        hint = f"Remove {more[0][0]}, or write [diffeomorphisms]."
        raise reading.at_key(("space", more[0][0]), problem, found, expected, hint)
    for long in (each for each in parts if more and len(each) > 1):
        problem = f"the coordinate {long!r} of a plane has {len(long)} letters"
        hint = "Write x and y, so that w_xxy is a derivative."
        raise reading.at_key(("space", long), problem, long, "one letter", hint)
    for each, part in parts.items() if more else ():
        for key, default in (("ends", "periodic"), ("order", 4)):
            if getattr(part, key) != default:
                problem = f"a plane has {key} = {getattr(part, key)!r}"
                expected, hint = "Fourier derivatives around both circles", f"Remove {key}."
                found = str(getattr(part, key))
                raise reading.source.fault(("space", each, key), problem, found, expected, hint)


def _check_tables(reading: Reading) -> None:
    """Nothing is declared that no field has."""
    file, source = reading.file, reading.source
    for table in type(file).model_fields:
        if table not in (*TABLES, *_HEAD) and getattr(file, table) not in (None, {}):
            problem, expected = f"there are tables [space] and [{table}]", "one of them"
            raise source.fault((table,), problem, table, expected, f"Remove [{table}].")
    for place, claim in enumerate(file.claims.conserved):
        if claim.where:
            problem, expected = "a density is claimed to be conserved on a level set", "everywhere"
            key = ("claims", "conserved", place, "where")
            raise source.fault(key, problem, claim.where[0], expected, "Remove where.")
    strains = [name for name, part in file.variables.items() if part.role == "strain"]
    if len(strains) > 1:
        problem, expected = f"there are {len(strains)} strains", "one, along the whole algebra"
        raise source.fault(("variables", strains[1], "role"), problem, strains[1], expected)
    for name, part in file.variables.items():
        if part.role not in _ROLES:
            problem = f"the {part.role} {name!r} is a field"
            expected = f"one of the roles {list_names(_ROLES)}"
            raise source.fault(("variables", name, "role"), problem, part.role, expected)


def _check_ends(reading: Reading, name: str, part: SpacePart) -> None:
    """Ends are those of a strand, with differences that have closures, and keep the energy alone.

    Raises:
        SpecError: They are not.
    """
    file, source = reading.file, reading.source
    if part.ends == "periodic":
        return
    if part.order not in (2, 4):
        problem = f"differences at {part.ends} ends have the order {part.order}"
        hint = "Write order = 4."
        raise source.fault(("space", name, "order"), problem, part.order, "2 or 4", hint)
    if not any(each.role == "strain" for each in file.variables.values()):
        problem = f"there are {part.ends} ends, and no strain"
        expected, hint = "the ends of a strand", 'Write ends = "periodic".'
        raise source.fault(("space", name, "ends"), problem, part.ends, expected, hint)
    for place, claim in enumerate(file.claims.conserved):
        if claim.claim != "energy":
            problem = f"there are {part.ends} ends, through which other densities flow"
            key = ("claims", "conserved", place)
            raise source.fault(key, problem, claim.claim, "the energy alone", "Remove it.")
    if file.claims.casimirs:
        problem, expected = f"there are {part.ends} ends, and Casimirs are claimed", "none"
        raise source.fault(("claims", "casimirs"), problem, "casimirs", expected, "Remove them.")


def _check_sizes(reading: Reading, parts: Mapping[str, SpacePart]) -> None:
    """So many points fit into memory.

    Raises:
        ResourceError: They do not.
    """
    points = prod(part.size or 1 for part in parts.values())
    rows = points * sum(len(each.components) for each in state_of(VARIABLES.of(reading)))
    check_declared_memory(Path(reading.source.path).stem, " and ".join(parts), rows)


def _check_length(reading: Reading, name: str, part: SpacePart) -> None:
    """The length is a scalar parameter that is positive."""
    key = ("space", name, "length")
    known = {each.name: each for each in PARAMETERS.of(reading)}
    if part.length not in known:
        problem = f"there is no parameter {part.length!a}"
        hint = did_you_mean(part.length, known) or (
            f"Write [parameters] and below it {part.length} = {{ positive = true, default = 1 }}."
        )
        raise reading.fault(key, problem, part.length, "a parameter of one component", hint)
    if known[part.length].shape or not known[part.length].positive:
        problem = f"the length {part.length!r} may be negative, or is no scalar"
        hint = f"Write {part.length} = {{ positive = true, default = 1 }} in [parameters]."
        raise reading.fault(key, problem, part.length, "a positive scalar parameter", hint)


def _name_all(table: str, space: Space | None) -> Iterator[Naming]:
    """The names of the coordinate and of all derivatives."""
    if space is None:
        return
    why = "It is the name of a derivative along space; rename the other."
    for name in space.coordinates:
        yield Naming(key=(table, name), name=name)
    for each in space.jets:
        yield Naming(key=(table, space.name), name=each.name, components=each.components, why=why)


SPACE = Table[Space | None](
    "space",
    SpacePart,
    'the coordinate along which variables are fields, as s = { length = "L" }, or two of a plane',
    read_space,
    many=True,
    absent=None,
    quantities=lambda space: () if space is None else space.jets,
    names=_name_all,
    example='s = { length = "L" }',
)


def read_profiles(reading: Reading, texts: Mapping[str, str]) -> Mapping[str, Formula]:
    """The fields at the beginning, as functions of the coordinate.

    Raises:
        SpecError: There is no space, or no such field, or the shapes differ.
    """
    space, source = SPACE.of(reading), reading.source
    if space is None:
        problem, expected = "there is a table [profiles] without [space]", "fields"
        raise source.fault(("profiles",), problem, "profiles", expected, "Remove [profiles].")
    fields = {each.name: each for each in state_of(VARIABLES.of(reading))}
    scope = reading.scope("a profile", (), space.coordinates)
    read = dict[str, Formula]()
    for name, text in texts.items():
        if name not in fields:
            problem = f"there is no field {name!a}"
            raise reading.unknown(("profiles", name), problem, name, fields)
        shape = fields[name].shape
        hint = "Write vector(a, b, c) for the components." if shape else ""
        read[name] = read_fitting(source, ("profiles", name), text, scope, shape, name, hint)
    _check_defaults(source, read, PARAMETERS.of(reading))
    return read


def _check_defaults(source: Source, read: Mapping[str, Formula], parameters: object) -> None:
    """Profiles are computed at the defaults of parameters, so that there have to be some."""
    assert isinstance(parameters, tuple)
    for each in parameters if read else ():
        if each.default is None:
            problem = f"the parameter {each.name!r} has no default, and there are profiles"
            key = ("parameters", each.name)
            raise source.at_key(key, problem, each.name, "a default for each parameter")


PROFILES = Table[Mapping[str, Formula]](
    "profiles",
    str,
    "the fields at the beginning, as functions of the coordinate of space",
    read_profiles,
    many=True,
    absent={},
)
