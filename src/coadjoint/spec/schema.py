"""Schema: which keys a spec has, and of what kind, before anything is looked up or parsed.

Comes in: the tables that tomllib read. Goes out: a frozen `SpecFile`, or every fault of the file at
once. The same models give the JSON Schema by which editors complete and check a spec.
Read next: `coadjoint.spec.reader`.
"""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    PlainValidator,
    WithJsonSchema,
    model_validator,
)

from coadjoint.limits import STATE_COMPONENTS, TITLE_CHARACTERS, UNIT_CHARACTERS
from coadjoint.spec.decimals import NUMBER_SCHEMA, read_number

_NAME_PATTERN = "^[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*$"
# Printed in comments of generated code: no text that opens or closes one.
_UNIT = re.compile(r"(?!.*(?:\*/|/\*|//))[A-Za-z0-9 ^/*.()-]+", re.ASCII)
_LICENSE = re.compile(r"[A-Za-z0-9.+-]+(?: (?:AND|OR|WITH) [A-Za-z0-9.+-]+)*", re.ASCII)
_BRACKET_PATTERN = r"^\[ *[A-Za-z]\w* *, *[A-Za-z]\w* *\]$"


def _is_printable(text: str) -> str:
    if not text.isprintable():
        raise ValueError("one line of printable text")
    return text


def _is_prose(text: str) -> str:
    if not all(line.isprintable() for line in text.replace("\t", " ").split("\n")):
        raise ValueError("printable text, in one line or several")
    return text


def _is_unit(text: str) -> str:
    if not _UNIT.fullmatch(text):
        raise ValueError("letters, digits, space and ^ / * . ( ) -, as in 'kg m^2/s'")
    return text


def _is_license(text: str) -> str:
    if text and not _LICENSE.fullmatch(text):
        raise ValueError("an SPDX expression such as 'BSD-3-Clause'")
    return text


def _is_unique(names: list[str]) -> list[str]:
    if len(set(names)) != len(names):
        raise ValueError("no entry twice")
    return names


def _number(value: object) -> Fraction:
    try:
        return read_number(value)
    except ValueError as error:
        raise ValueError(f"an exact number such as 2, 0.5 or '1/3'; this one {error}") from None


def _numbers(value: object) -> Any:
    """A number, or lists of numbers, nested at most twice."""
    if isinstance(value, list):
        return [
            [_number(entry) for entry in part] if isinstance(part, list) else _number(part)
            for part in value
        ]
    return _number(value)


def _block(value: object) -> str | list[str]:
    names = [value] if isinstance(value, str) else value
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names) or not names:
        raise ValueError("the name of a block, or a list of names of the algebra's basis")
    return value if isinstance(value, str) else list(names)


def _no_titles(schema: dict[str, Any]) -> None:
    """Drop the titles that pydantic makes of key names; they say nothing."""
    for part in (schema, *schema.get("properties", {}).values()):
        part.pop("title", None)


_NUMBER_OR_LISTS: dict[str, Any] = {
    "anyOf": [
        *NUMBER_SCHEMA["anyOf"],
        {
            "type": "array",
            "items": {
                "anyOf": [
                    *NUMBER_SCHEMA["anyOf"],
                    {"type": "array", "items": NUMBER_SCHEMA},
                ]
            },
        },
    ]
}
_TEXTS: dict[str, Any] = {
    "anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}, "minItems": 1}]
}

Number = Annotated[Fraction, PlainValidator(_number), WithJsonSchema(NUMBER_SCHEMA)]
Numbers = Annotated[Any, PlainValidator(_numbers), WithJsonSchema(_NUMBER_OR_LISTS)]
Block = Annotated[str | list[str], PlainValidator(_block), WithJsonSchema(_TEXTS)]
Matrix = list[list[Number]]
Prose = Annotated[str, AfterValidator(_is_prose)]
Unit = Annotated[str, Field(max_length=UNIT_CHARACTERS), AfterValidator(_is_unit)]
Names = Annotated[list[str], Field(min_length=1), AfterValidator(_is_unique)]
Length = Annotated[int, Field(ge=1, le=STATE_COMPONENTS)]


def _named(pattern: str = _NAME_PATTERN) -> dict[str, Any]:
    """What a JSON Schema says about the keys of a table of names."""
    return {"propertyNames": {"pattern": pattern}}


class Part(BaseModel):
    """A table of a spec: unknown keys are refused, nothing is converted."""

    model_config = ConfigDict(
        extra="forbid", strict=True, frozen=True, json_schema_extra=_no_titles
    )


class AlgebraPart(Part):
    """The Lie algebra of the velocities: by name, by brackets, or by matrices."""

    name: str | None = Field(None, description="an algebra by name, such as 'so(3)' or 'se(3)'")
    basis: Names | None = Field(None, description="names of the basis, in order")
    brackets: dict[str, str] | None = Field(
        None,
        description="brackets such as '[e1, e2]' = 'e3', each pair once; the others are 0",
        json_schema_extra=_named(_BRACKET_PATTERN),
    )
    matrices: dict[str, Matrix] | None = Field(
        None, description="a matrix for each name of the basis", json_schema_extra=_named()
    )
    invariance: Literal["left", "right"] = Field(
        "left", description="'left' (body frame, the default) or 'right' (space frame)"
    )
    blocks: dict[str, Names] | None = Field(
        None, description="named parts of the basis", json_schema_extra=_named()
    )

    @model_validator(mode="after")
    def _one_way(self) -> AlgebraPart:
        ways = [w for w in ("name", "brackets", "matrices") if getattr(self, w) is not None]
        if len(ways) != 1:
            raise ValueError("exactly one of name, brackets and matrices")
        if self.brackets is not None and self.basis is None:
            raise ValueError("a basis beside the brackets, as basis = ['e1', 'e2', 'e3']")
        if self.name is not None and (self.basis is not None or self.blocks is not None):
            raise ValueError("no basis and no blocks beside a name, which has its own")
        return self


class RepresentationPart(Part):
    """A linear action of the algebra on advected quantities."""

    matrices: dict[str, Matrix] = Field(
        min_length=1,
        description="a matrix for each name of the basis; those left out act as zero",
        json_schema_extra=_named(),
    )


class VariablePart(Part):
    """A velocity, a momentum or an advected quantity."""

    role: Literal["velocity", "momentum", "advected"] = Field(
        description="'velocity', 'momentum' or 'advected'"
    )
    block: Block | None = Field(
        None, description="the block of the algebra that it spans; by default all of it"
    )
    representation: str | None = Field(
        None,
        description="how the algebra acts on an advected quantity: 'vector', 'adjoint', "
        "'coadjoint' or a declared one",
    )
    unit: Unit = Field("1", description="unit, such as 'kg m^2/s'; '1' if dimensionless")
    doc: Prose = Field("", description="what it is, for documents")


class ParameterPart(Part):
    """A constant of the system."""

    shape: Annotated[list[Length], Field(max_length=2)] = Field(
        [], description="[] for a scalar, [n] for a vector, [n, m] for a matrix"
    )
    positive: bool = Field(False, description="whether every component is positive")
    default: Numbers | None = Field(
        None, description="exact default: a number for all components, or nested lists of them"
    )
    unit: Unit = Field("1", description="unit, such as 'kg m^2'; '1' if dimensionless")
    doc: Prose = Field("", description="what it is, for documents")


class LagrangianPart(Part):
    """The reduced Lagrangian."""

    l: str = Field(description="l of velocities, advected quantities and parameters")  # noqa: E741


class HamiltonianPart(Part):
    """The reduced Hamiltonian."""

    h: str = Field(description="h of momenta, advected quantities and parameters")


def _also_text(schema: dict[str, Any]) -> None:
    """An observable may be its expression alone."""
    _no_titles(schema)
    table = dict(schema)
    schema.clear()
    schema["anyOf"] = [{"type": "string"}, table]


class ObservablePart(Part):
    """A scalar emitted beside the dynamics."""

    model_config = ConfigDict(json_schema_extra=_also_text)

    expression: str = Field(description="a scalar of variables and parameters")
    unit: Unit = Field("1", description="unit, such as 'kg m^2/s'; '1' if dimensionless")
    doc: Prose = Field("", description="what it is, for documents")

    @model_validator(mode="before")
    @classmethod
    def _from_text(cls, value: object) -> object:
        return {"expression": value} if isinstance(value, str) else value


class ClaimsPart(Part):
    """What is claimed of the motion and proved at every regeneration."""

    casimirs: list[str] = Field(
        [], description="Casimirs of the bracket: scalars of momenta and advected quantities"
    )
    conserved: list[str] = Field(
        [], description="integrals of the motion; 'energy' and observables have their names here"
    )


def _no_claims() -> ClaimsPart:
    return ClaimsPart(casimirs=[], conserved=[])


class SpecFile(Part):
    """A declared system: its algebra, its variables and parameters, its energy."""

    title: Annotated[str, Field(max_length=TITLE_CHARACTERS), AfterValidator(_is_printable)] = (
        Field(description="the system's name as a book has it")
    )
    source: Prose = Field("", description="where the equations can be looked up")
    description: Prose = Field("", description="free text for documents")
    license: Annotated[str, Field(max_length=UNIT_CHARACTERS), AfterValidator(_is_license)] = Field(
        "", description="SPDX expression of the licence of this file and of what is generated"
    )
    routes: Annotated[
        list[Literal["euler-poincare", "lie-poisson"]],
        Field(min_length=1),
        AfterValidator(_is_unique),
    ] = Field(description="routes to derive by; the first is emitted, the others proved equal")
    algebra: AlgebraPart = Field(description="the Lie algebra of the velocities")
    representations: dict[str, RepresentationPart] = Field(
        {}, description="declared representations", json_schema_extra=_named()
    )
    variables: dict[str, VariablePart] = Field(
        min_length=1, description="the variables by name", json_schema_extra=_named()
    )
    parameters: dict[str, ParameterPart] = Field(
        {}, description="the parameters by name", json_schema_extra=_named()
    )
    lagrangian: LagrangianPart | None = Field(None, description="the reduced Lagrangian")
    hamiltonian: HamiltonianPart | None = Field(None, description="the reduced Hamiltonian")
    observables: dict[str, ObservablePart] = Field(
        {}, description="scalars emitted beside the dynamics", json_schema_extra=_named()
    )
    claims: ClaimsPart = Field(
        default_factory=_no_claims, description="what is proved of the motion"
    )


def json_schema() -> dict[str, Any]:
    """The JSON Schema of a spec, for editors; ``#:schema`` in a spec's first line names it."""
    schema = _without_null(SpecFile.model_json_schema())
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "coadjoint spec"}
    return {**head, **schema}


def _without_null(schema: Any) -> Any:
    """A schema without the null that pydantic allows for optional keys; TOML has none."""
    if isinstance(schema, list):
        return [_without_null(part) for part in schema if part != {"type": "null"}]
    if not isinstance(schema, dict):
        return schema
    kept = {k: _without_null(v) for k, v in schema.items() if (k, v) != ("default", None)}
    if len(kept.get("anyOf", "  ")) == 1:
        kept |= kept.pop("anyOf")[0]
    return kept
