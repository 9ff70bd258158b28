"""Parts: the base of all models of tables, with what several of them have in common.

Comes in: tables as tomllib read them. Goes out: frozen, checked parts of a `SpecFile`.
Read next: `coadjoint.spec.core.values`, then `coadjoint.spec.core.reading`.
"""

from __future__ import annotations

from functools import partial
from math import prod
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from coadjoint.spec.core.components import matrix_size
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.values import (
    NAME_PATTERN,
    Numbers,
    Prose,
    Side,
    Unit,
    misfit_form,
    read_default,
)


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

    shape: Annotated[list[Side], Field(max_length=2)] = Field(
        [],
        description="[] for a scalar, [3] for a vector, [3, 2] for a matrix; a side may be the "
        "number of members, as ['n'] or ['2n', 'n+1'] with [index] i = { count = 'n' }",
    )
    form: Literal["antisymmetric", "symmetric"] | None = Field(
        None,
        description="the square matrix that it is in formulas: its components are the entries "
        "above the diagonal, or those with the diagonal, row by row",
    )
    default: Numbers | None = Field(
        None, description="exact default: a number for all components, or nested lists of them"
    )
    unit: Unit = ""
    doc: Prose = Field("", description="what it is, for documents")


def read_argument(source: Source, key: KeyPath, part: ArgumentPart) -> dict[str, Any]:
    """What the records of parameters and inputs share, by the names of their fields.

    Raises:
        SpecError: The components fill no matrix of the form, or a default has another shape.
    """
    shape, form = tuple(part.shape), part.form or ""
    if form:
        shape = shape or (1,)
        if len(shape) > 1 or matrix_size(shape[0], form) is None:
            raise misfit_form(source, (*key, "form"), prod(shape), form)
    default = read_default(source, (*key, "default"), part.default, shape)
    given = {"name": key[-1], "shape": shape, "default": default, "form": form}
    return given | {"unit": part.unit, "doc": part.doc}


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
