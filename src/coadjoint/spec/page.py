"""Page: docs/specs.md, made from its prose and from what the readers of specs say themselves.

Comes in: the prose of docs/specs.in.md, with lines such as ``{{ keys variables }}`` where a table
stands. Goes out: the page. Keys, functions, algebras and representations are those that are read,
so that none is missing and none is told that does not exist. Read next: `coadjoint.spec.schema`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, get_args

from pydantic.fields import FieldInfo

from coadjoint.algebra.catalogue import FAMILIES, MEANINGS, REPRESENTATIONS
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.shapes import FUNCTIONS
from coadjoint.spec.schema import Head, SpecFile
from coadjoint.spec.tables import BY_KEY

NOTICE = "<!-- Made from docs/specs.in.md by `make docs`: edit that file. -->\n"
_MARK = re.compile(r"^\{\{ (\w+)(?: ([\w.]+))? \}\}$|\{\{ (algebras) \}\}", re.MULTILINE)
#: A complete example has a name, to which others are added.
_NAMED = re.compile(r"^```toml \w+$", re.MULTILINE)


def write_page(prose: str) -> str:
    r"""The page that a prose with marks makes.

    >>> print(write_page("# Time\n\n{{ keys time }}").split("\n")[5])
    | `name` | text, `"t"` by default | its name in formulas |
    """

    def expand(mark: re.Match[str]) -> str:
        if mark[1] == "tables":
            return _write_tables(prose)
        return _EXPANSIONS[mark[1] or mark[3]](mark[2] or "")

    return NOTICE + _NAMED.sub("```toml", _MARK.sub(expand, prose))


def list_keys(table: str) -> Mapping[str, FieldInfo]:
    """The keys of a table, as ``algebra.extension``; of the head those above all tables."""
    fields = find_part(table).model_fields
    return {name: each for name, each in fields.items() if table or name in Head.model_fields}


def find_part(table: str) -> type[Part]:
    """The model of the keys of a table, or of one entry of it; `Part` where entries are texts."""
    part: type[Part] = SpecFile
    for name in filter(None, table.split(".")):
        part = next(find_parts(part.model_fields[name].annotation), Part)
    return part


def find_parts(annotation: Any) -> Iterator[type[Part]]:
    """The models that an annotation names."""
    if isinstance(annotation, type) and issubclass(annotation, Part):
        yield annotation
    for inner in get_args(annotation):
        yield from find_parts(inner)


# -- what takes the place of a mark ---------------------------------------------------------------


def _write_tables(prose: str) -> str:
    """All tables in the order of the page, under its titles, each with a link to its place."""
    rows, group, place = [("", "table", "what it says")], "", ""
    example = False
    for line in prose.splitlines():
        mark = _MARK.fullmatch(line)
        if line.startswith("```"):
            example = not example
        elif example:  # where # begins a comment
            continue
        elif line.startswith("# "):
            group = line.removeprefix("# ")
        elif line.startswith("## "):
            place = line.removeprefix("## ").lower().replace(" ", "-").replace("'", "")
        elif mark is not None and mark[2] in BY_KEY:
            link = f"[`{_head_of(mark[2])}`](#{place})"
            rows.append((group, link, BY_KEY[mark[2]].description))
            group = ""  # said once, in its first row
    return _lay_out(rows)


def _head_of(table: str) -> str:
    """How a table is opened: one of named entries by a name, one of plain texts without."""
    named = BY_KEY[table].many and isinstance(BY_KEY[table].part, type)
    whole = named and issubclass(BY_KEY[table].part, Part)
    return f"[{table}.NAME]" if whole else f"[{table}]"


def _write_keys(table: str) -> str:
    """The keys of a table; of a table of plain texts its own row."""
    if table in BY_KEY and not any(find_parts(BY_KEY[table].part)):
        return _lay_out([(f"`[{table}]`", "what it says"), ("`NAME`", BY_KEY[table].description)])
    head = f"`{_head_of(table) if table in BY_KEY else f'[{table}]'}`" if table else "key"
    kinds = _write_kinds(table)
    keys = list_keys(table).items()
    rows = [(f"`{name}`", kinds[name], each.description or "") for name, each in keys]
    return _lay_out([(head, "value", "what it is"), *rows])


def _write_kinds(table: str) -> Mapping[str, str]:
    """What may stand at each key of a table, and what does if it is left out."""
    schema = find_part(table).model_json_schema()
    models, kinds = schema.get("$defs", {}), dict[str, str]()
    if "$ref" in schema:  # a table that may have such a one in it
        schema = models[schema["$ref"].rpartition("/")[2]]
    schema = schema if "properties" in schema else schema["anyOf"][-1]  # or a text alone
    for name, each in schema["properties"].items():
        choices = dict.fromkeys(_name_kinds(each, models))
        kinds[name] = " or ".join(choices)
        if name in schema.get("required", ()):
            kinds[name] += ", required"
        elif isinstance(each.get("default"), str) and each["default"]:
            kinds[name] += f', `"{each["default"]}"` by default'
    return kinds


def _name_kinds(schema: Mapping[str, Any], models: Mapping[str, Any]) -> Iterator[str]:
    """What a JSON Schema accepts, in words."""
    if "$ref" in schema:
        yield from _name_kinds(models[schema["$ref"].rpartition("/")[2]], models)
    for each in schema.get("anyOf", ()):
        yield from _name_kinds(each, models)
    values = [schema["const"]] if "const" in schema else schema.get("enum", ())
    yield from (f'`"{value}"`' for value in values)
    match schema.get("type"):
        case "array":
            yield "list"
        case "object":
            yield "table"
        case "boolean":
            yield "`true` or `false`"
        case "string" if not values:
            yield "text"
        case "number" | "integer":
            yield "number"


def _write_functions(_: str) -> str:
    rows = []
    for name, function in FUNCTIONS.items():
        letters = ("a", "b", "c", "d")[: function.arity] or ("a", "b", "...")
        rows.append((f"`{name}({', '.join(letters)})`", f"{function.meaning}; of {function.takes}"))
    return _join_rows(rows)


def _write_representations(_: str) -> str:
    return _join_rows((f'`"{name}"`', MEANINGS[name]) for name in REPRESENTATIONS)


def _write_algebras(_: str) -> str:
    return ", ".join(family.form for family in FAMILIES)


_EXPANSIONS: Mapping[str, Callable[[str], str]] = {
    "keys": _write_keys,
    "functions": _write_functions,
    "representations": _write_representations,
    "algebras": _write_algebras,
}


def _lay_out(rows: Sequence[tuple[str, ...]]) -> str:
    """A table in Markdown; its first row is the head."""
    return _join_rows([rows[0], ("---",) * len(rows[0]), *rows[1:]])


def _join_rows(rows: Iterable[tuple[str, ...]]) -> str:
    cells = (" | ".join(cell.replace("|", "\\|") for cell in row) for row in rows)
    return "\n".join(f"| {row} |" for row in cells)
