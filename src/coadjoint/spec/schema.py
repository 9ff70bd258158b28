"""Schema: which keys a spec has, and of what kind, before anything is looked up or parsed.

Comes in: the keys of each table. Goes out: the model `SpecFile`, which checks a whole file at once
and gives the JSON Schema by which editors complete and check a spec.
Read next: `coadjoint.spec.validate`.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, Field, create_model

from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.reading import Table
from coadjoint.spec.core.values import License, Prose, Title, is_unique
from coadjoint.spec.routes import ROUTES
from coadjoint.spec.tables import TABLES

if TYPE_CHECKING:
    RouteName = str
else:
    RouteName = Literal[tuple(ROUTES)]


class Head(Part):
    """The keys above the tables."""

    title: Title = Field(description="the system's name as a book has it")
    source: Prose = Field("", description="where the equations can be looked up")
    description: Prose = Field("", description="free text for documents")
    license: License = Field(
        "", description="SPDX expression of the licence of this file and of what is generated"
    )
    routes: Annotated[list[RouteName], Field(min_length=1), AfterValidator(is_unique)] = Field(
        description="routes to derive by; the first is emitted, the others proved equal"
    )


def compose(tables: Iterable[Table[Any]]) -> type[Head]:
    """The model of a whole file, with a key for each table."""
    keys: dict[str, Any] = {table.key: table.typed_field for table in tables}
    about = "A declared system: its algebra, its variables and parameters, its energy."
    return create_model("SpecFile", __base__=Head, __doc__=about, **keys)


#: A declared system.
SpecFile = compose(TABLES)


def json_schema() -> dict[str, Any]:
    """The JSON Schema of a spec, for editors; ``#:schema`` in a spec's first line names it."""
    schema = _drop_null(SpecFile.model_json_schema())
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "coadjoint spec"}
    return {**head, **schema}


def _drop_null(schema: Any) -> Any:
    """A schema without the null that pydantic allows for optional keys; TOML has none."""
    if isinstance(schema, list):
        return [_drop_null(part) for part in schema if part != {"type": "null"}]
    if not isinstance(schema, dict):
        return schema
    kept = {k: _drop_null(v) for k, v in schema.items() if (k, v) != ("default", None)}
    if len(kept.get("anyOf", "  ")) == 1:
        kept |= kept.pop("anyOf")[0]
    return kept
