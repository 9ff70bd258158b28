"""Parts: the base of all models of tables, with what several of them have in common.

Comes in: tables as tomllib read them. Goes out: frozen, checked parts of a `SpecFile`.
Read next: `coadjoint.spec.core.values`, then `coadjoint.spec.core.reading`.
"""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from coadjoint.spec.core.values import NAME_PATTERN, Length, Numbers, Prose, Unit


def no_titles(schema: dict[str, Any]) -> None:
    """Drop the titles that pydantic makes of key names; they say nothing."""
    for part in (schema, *schema.get("properties", {}).values()):
        part.pop("title", None)


def name_pattern(pattern: str = NAME_PATTERN) -> dict[str, Any]:
    """What a JSON Schema says about the keys of a table of names."""
    return {"propertyNames": {"pattern": pattern}}


class Part(BaseModel):
    """A table of a spec: unknown keys are refused, nothing is converted."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, json_schema_extra=no_titles)


def or_alone(kind: str, schema: dict[str, Any]) -> None:
    """The table may be a single value of a JSON kind alone."""
    no_titles(schema)
    table = dict(schema)
    schema.clear()
    schema["anyOf"] = [{"type": kind}, table]


class TextPart(Part):
    """A table that may be a text alone, which then stands at its key `alone`."""

    model_config = ConfigDict(json_schema_extra=partial(or_alone, "string"))
    alone: ClassVar[str]
    alone_kind: ClassVar[type] = str

    @model_validator(mode="before")
    @classmethod
    def _from_value(cls, value: object) -> object:
        return {cls.alone: value} if isinstance(value, cls.alone_kind) else value


class ArgumentPart(Part):
    """What a user gives to the kernels by components."""

    shape: Annotated[list[Length], Field(max_length=2)] = Field(
        [], description="[] for a scalar, [n] for a vector, [n, m] for a matrix"
    )
    default: Numbers | None = Field(
        None, description="exact default: a number for all components, or nested lists of them"
    )
    unit: Unit = Field("1", description="unit, such as 'kg m^2'; '1' if dimensionless")
    doc: Prose = Field("", description="what it is, for documents")


#: What is enough for a claim, if not a proof.
Accept = Annotated[
    Literal["numerical"] | None,
    Field(
        description="'numerical' if values at random points are enough for this claim; by default "
        "it must be proved"
    ),
]


class ClaimPart(TextPart):
    """A claim: its expression, or a table that also says what is enough for it."""

    alone = "claim"

    claim: str = Field(description="what is claimed")
    accept: Accept = None
