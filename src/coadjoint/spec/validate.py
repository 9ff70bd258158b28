"""Validate: a TOML text to a checked file, with every fault of its form at its line.

Comes in: a `Source`. Goes out: the checked tables, or one error that lists all faults.
Read next: `coadjoint.spec.sections.structure`.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from types import MappingProxyType, NoneType
from typing import Annotated, Any, get_args, get_origin

from pydantic import ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from coadjoint import limits
from coadjoint.errors import CoadjointError, LimitError, SpecError
from coadjoint.spec.core.decimals import read_float
from coadjoint.spec.core.faults import did_you_mean, find_near, list_names
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.positions import KeyPath, Span
from coadjoint.spec.core.source import Source, join_faults, show_value
from coadjoint.spec.kinds import VARIATIONAL
from coadjoint.spec.schema import Head, SpecFile

#: Faults that one message shows at the most; each takes three rows of a screen.
MOST_FAULTS = 6
_KINDS = MappingProxyType(
    {
        "model_type": "a table",
        "dict_type": "a table",
        "string_type": "text in quotes",
        "list_type": "a list in square brackets",
        "bool_type": "true or false",
        "int_type": "an integer",
    }
)
_HOW_TO_WRITE: Mapping[str | int, str] = MappingProxyType(
    {
        "title": 'Write title = "..." at the top.',
        "algebra": 'Write algebra = "so(3)".',
        "variables": 'Write [variables] and below it Pi = { role = "momentum" }.',
        "role": 'Write { role = "momentum" }.',
        "l": 'Write for instance l = "dot(Omega, diag(I)*Omega)/2".',
        "h": 'Write for instance h = "dot(Pi, inverse(diag(I))*Pi)/2".',
        "expression": 'Write { expression = "..." }.',
        "matrices": "Write matrices = { e1 = [[0, 1], [0, 0]] }.",
    }
)
_LIMIT = re.compile(r"\(([A-Z]+_[A-Z]+)\)")
_TOML_PLACE = re.compile(r" \(at (?:line (\d+), column (\d+)|end of document)\)$")


def validate(source: Source) -> Head:
    """The tables of a spec, each key known and each value of its kind.

    Raises:
        SpecError: The text is no TOML, or a key or value is not what a spec may have.
        LimitError: Tables nest too deep, or a number is too long.
    """
    document = _parse(source)
    try:
        return SpecFile.model_validate(document)
    except ValidationError as error:
        details = _drop_echoes(error.errors(include_url=False))
        groups = _join_kinds(document, details)
        faults = [_fault(source, document, *group) for group in groups[:MOST_FAULTS]]
        raise join_faults(faults, len(groups) - len(faults)) from None


# -- TOML -----------------------------------------------------------------------------------------


def _parse(source: Source) -> dict[str, Any]:
    """The tables of a TOML text."""
    if source.positions.too_deep is not None:
        raise _too_deep(source, source.positions.too_deep)
    try:
        return tomllib.loads(source.text, parse_float=read_float)
    except tomllib.TOMLDecodeError as error:
        raise _toml_fault(source, error) from None
    except RecursionError:
        raise _too_deep(source, 0) from None
    except ValueError:  # Python refuses to read integers beyond 4300 digits
        long = re.search(r"\d[\d_]{4000,}", source.text)
        span = long.span() if long else (0, 0)
        shown = source.text[span[0] : span[0] + 40]
        problem = "an integer has too many digits"
        raise source.too_many((), problem, shown, "INTEGER_DIGITS", at=span) from None


def _too_deep(source: Source, at: int) -> CoadjointError:
    problem, shown = "tables or arrays nest too deep", source.text[at : at + 20]
    return source.too_many((), problem, shown, "SPEC_NESTING", at=(at, at + 1))


def _toml_fault(source: Source, error: tomllib.TOMLDecodeError) -> CoadjointError:
    """What tomllib refuses, at its place; a doubled key where it stands the second time."""
    if source.positions.doubled is not None:
        key, span = source.positions.doubled
        first = source.line(source.positions.key(key))
        problem, expected = f"{show_value(key[-1])} is declared twice", "one declaration"
        hint = f"The first is in line {first}."
        return source.fault(key, problem, str(key[-1]), expected, hint, at=span)
    place = _TOML_PLACE.search(str(error))
    span = _span(source, place)
    problem = _TOML_PLACE.sub("", str(error))
    problem = f"not TOML: {problem[:1].lower()}{problem[1:]}"
    hint = "Text stands in quotes, a table in one line in { }."
    return source.fault((), problem, source.text[span[0] : span[1]], hint=hint, at=span)


def _span(source: Source, place: re.Match[str] | None) -> Span:
    """The offset that a message of tomllib means."""
    if place is None or place[1] is None:
        return max(0, len(source.text.rstrip()) - 1), len(source.text)
    lines = source.text.split("\n")
    start = sum(len(line) + 1 for line in lines[: int(place[1]) - 1]) + int(place[2]) - 1
    return start, start + 1


# -- keys and values ------------------------------------------------------------------------------


def _join_kinds(
    document: dict[str, Any], details: list[ErrorDetails]
) -> list[tuple[ErrorDetails, ...]]:
    """Faults, those of one value together, which none of the kinds fits that it may have."""
    groups: dict[KeyPath, list[ErrorDetails]] = {}
    for detail in details:
        path = tuple(detail["loc"])
        is_of_value = detail["type"] not in ("missing", "extra_forbidden")
        groups.setdefault(_find_present(path, document) if is_of_value else path, []).append(detail)
    return [tuple(group) for group in groups.values()]


def _fault(
    source: Source, document: dict[str, Any], detail: ErrorDetails, *others: ErrorDetails
) -> CoadjointError:
    """One fault that pydantic found, in our words; others of the same value say what else fits."""
    path, kind = tuple(detail["loc"]), detail["type"]
    present = _find_present(path, document)
    if kind == "missing":
        problem = f"the key {path[-1]!r} is missing"
        expected = _keys(path)[str(path[-1])].description or ""
        hint = _advise_routes(document) if path == ("routes",) else _HOW_TO_WRITE.get(path[-1], "")
        return source.at_key(present, problem, str(path[-1]), expected, hint)
    if kind == "extra_forbidden":
        return _unknown_key(source, path)
    given, kinds = detail["input"], [_describe_expected(each) for each in (detail, *others)]
    if present[:-1] == ("constraints",):  # one key there is no equation
        kinds = [_KINDS["bool_type" if present[-1] == VARIATIONAL else "string_type"]]
    expected = " or ".join(dict.fromkeys(kinds))
    literal = kind == "literal_error" and isinstance(given, str)
    limit = next(iter(_LIMIT.findall(expected)), "")
    return source.fault(
        present,
        f"found {show_value(given)}",
        given,
        expected,
        did_you_mean(given, re.findall("'([^']+)'", expected), _advise_order(present, given))
        if literal
        else _advise(present, given),
        kind=LimitError if limit else SpecError,
        limit=limit,
    )


def _advise_order(path: KeyPath, given: str) -> str:
    """How Fourier derivatives are chosen, which differences of no order are."""
    if path[:1] != ("space",) or path[-1] != "order" or "fourier" not in given.casefold():
        return ""
    return (
        'Leave order out, and choose them when the system is loaded: derivatives="fourier", or '
        "--derivatives fourier."
    )


def _advise(path: KeyPath, given: Any) -> str:
    """What to write in the place of a list of texts in a table of named ones."""
    if path[:-1] != ("constraints",) or not isinstance(given, list):
        return ""
    return f"Write each equation under a name of its own, as {path[-1]}1 and {path[-1]}2."


def _advise_routes(document: Mapping[str, Any]) -> str:
    """How routes are written, by the tables that are there."""
    ways = {
        "constraints": '"nonholonomic"',
        "newton": '"newton"',
        "poisson": '"poisson"',
        "algebra": '"euler-poincare", "lie-poisson"'
        if "lagrangian" in document
        else '"lie-poisson"',
        "lagrangian": '"euler-lagrange"',
    }
    names = next((way for table, way in ways.items() if table in document), '"canonical"')
    return f"Write routes = [{names}] at the top."


def _drop_echoes(details: list[ErrorDetails]) -> list[ErrorDetails]:
    """Faults without the missing keys that a misspelt key next to them was meant to be."""
    meant = set()
    for detail in details:
        *table, key = detail["loc"]
        if detail["type"] == "extra_forbidden":
            meant |= {(*table, near) for near in find_near(str(key), _keys(detail["loc"]))}
    return [d for d in details if d["type"] != "missing" or tuple(d["loc"]) not in meant]


def _keys(path: KeyPath) -> Mapping[str, FieldInfo]:
    """The keys of the table that a path leads into."""
    kind: Any = SpecFile
    for key in path[:-1]:
        is_table = isinstance(kind, type) and issubclass(kind, Part)
        # A table leads to its key, a list of tables or a table of named ones to its entries.
        kind = _plain_kind(kind.model_fields[key].annotation if is_table else get_args(kind)[-1])
    fields: Mapping[str, FieldInfo] = kind.model_fields
    return fields


def _plain_kind(annotation: Any) -> Any:
    """An annotation without None and without what `Annotated` adds."""
    if NoneType in get_args(annotation):
        annotation = get_args(annotation)[0]
    return get_args(annotation)[0] if get_origin(annotation) is Annotated else annotation


def _unknown_key(source: Source, path: KeyPath) -> CoadjointError:
    known = _keys(path)
    problem = f"unknown key {show_value(path[-1])}"
    expected = f"one of {list_names(known, most=len(known))}"
    hint = did_you_mean(str(path[-1]), known)
    if not hint and path[:1] == ("time",):
        hint = f'Write name = "{path[-1]}".'
    return source.at_key(path, problem, str(path[-1]), expected, hint)


def _find_present(path: KeyPath, document: Any) -> KeyPath:
    """The part of a path that the document has."""
    for length, part in enumerate(path):
        try:
            document = document[part]
        except (KeyError, IndexError, TypeError):
            return path[:length]
    return path


def _describe_expected(detail: ErrorDetails) -> str:
    """What would have been accepted, from the words of pydantic or our own."""
    if detail["type"] in _KINDS:
        return _KINDS[detail["type"]]
    message = detail["msg"].removeprefix("Value error, ")
    if detail["type"] == "string_too_long":
        limit = "TITLE_CHARACTERS" if detail["loc"][-1] == "title" else "UNIT_CHARACTERS"
        return f"at most {getattr(limits, limit)} characters ({limit})"
    message = re.sub(r" after validation, not \d+$", "", message)
    return re.sub(r"^\w+ should (?:be|have) (?:a valid )?", "", message)
