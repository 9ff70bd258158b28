"""Values: what may stand at the keys of a spec, for the validator and for editors.

Comes in: single values as tomllib read them. Goes out: annotated types that check them; numbers
become exact fractions. Read next: `coadjoint.spec.schema`, which puts them into tables.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import AfterValidator, Field, PlainValidator, WithJsonSchema

from coadjoint.errors import CoadjointError
from coadjoint.limits import STATE_COMPONENTS, TITLE_CHARACTERS, UNIT_CHARACTERS
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.constants import read_constant
from coadjoint.spec.core.decimals import is_number_text, read_number
from coadjoint.spec.core.faults import list_names
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.source import Source

NAME_PATTERN = "^[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*$"
# Printed in comments of generated code: no text that opens or closes one.
_UNIT = re.compile(r"(?!.*(?:\*/|/\*|//))[A-Za-z0-9 ^/*.(),-]+", re.ASCII)
_LICENSE = re.compile(r"[A-Za-z0-9.+-]+(?: (?:AND|OR|WITH) [A-Za-z0-9.+-]+)*", re.ASCII)
#: Keys such as ``[e1, e2]`` of a bracket in an algebra, ``{X1, X2}`` of one of functions.
#: A size that the number of members gives: ``n``, ``2n``, ``n+1``.
COUNTED_PATTERN = r"(?:(\d{1,3}) ?\*? ?)?([A-Za-z]\w*)( ?[-+] ?\d{1,3})?"
BRACKET_PATTERN = r"^\[ *([A-Za-z]\w*) *, *([A-Za-z]\w*) *\]$"
#: Keys such as ``u`` and ``V(s, d)`` of definitions.
DEFINITION_PATTERN = r"^[A-Za-z]\w*( *\( *[A-Za-z]\w*( *, *[A-Za-z]\w*)* *\))?$"
POISSON_PATTERN = r"^\{ *([A-Za-z]\w*) *, *([A-Za-z]\w*) *\}$"


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
        raise ValueError("letters, digits, space and ^ / * . ( ) , -, as in 'kg m^2/s'")
    return text


def _is_license(text: str) -> str:
    if text and not _LICENSE.fullmatch(text):
        raise ValueError("an SPDX expression such as 'BSD-3-Clause'")
    return text


def is_unique(names: list[str]) -> list[str]:
    """The names, if they differ."""
    if len(set(names)) != len(names):
        raise ValueError("no entry twice")
    return names


def _number(value: object) -> Fraction:
    try:
        return read_number(value)
    except ValueError as error:
        raise ValueError(f"an exact number such as 2, 0.5 or '1/3'; this one {error}") from None


def _constant(value: object) -> Fraction:
    """A number, or a text that is a formula of numbers."""
    if not isinstance(value, str) or is_number_text(value):
        return _number(value)
    try:
        return read_constant(value)
    except ValueError as error:
        problem = f"an exact number such as 2, '1/3' or 'sqrt(2)/2'; this one {error}"
        raise ValueError(problem) from None


def _entry(value: object) -> Fraction | str:
    """A number, or a text that a later step reads as a formula of the parameters."""
    if isinstance(value, str) and not is_number_text(value):
        return value
    return _number(value)


#: How deep the lists of a default may be nested: matrices, one for each of equal members.
_NESTED = 3


def _numbers(value: object, depth: int = _NESTED) -> Any:
    """A number, or lists of numbers."""
    if isinstance(value, list) and depth:
        return [_numbers(part, depth - 1) for part in value]
    return _constant(value)


def _block(value: object) -> str | list[str]:
    names = [value] if isinstance(value, str) else value
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names) or not names:
        raise ValueError("the name of a block, or a list of names of the algebra's basis")
    return value if isinstance(value, str) else list(names)


_NUMBER_OR_TEXT: dict[str, Any] = {"anyOf": [{"type": "number"}, {"type": "string"}]}


def _describe_lists(depth: int) -> dict[str, Any]:
    """The schema of a number, or of lists that are nested so deep."""
    if not depth:
        return _NUMBER_OR_TEXT
    inner = {"type": "array", "items": _describe_lists(depth - 1)}
    return {"anyOf": [*_NUMBER_OR_TEXT["anyOf"], inner]}


_TEXTS: dict[str, Any] = {
    "anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}, "minItems": 1}]
}

Number = Annotated[Any, PlainValidator(_number), WithJsonSchema(_NUMBER_OR_TEXT)]
Entry = Annotated[Any, PlainValidator(_entry), WithJsonSchema(_NUMBER_OR_TEXT)]
Numbers = Annotated[Any, PlainValidator(_numbers), WithJsonSchema(_describe_lists(_NESTED))]
Block = Annotated[str | list[str], PlainValidator(_block), WithJsonSchema(_TEXTS)]
Matrix = list[list[Entry]]
Prose = Annotated[str, AfterValidator(_is_prose)]
_ABOUT_UNIT = (
    "unit, such as 'kg m^2/s', or '1, m' for components with units of their own; '1' if it has "
    "none; inferred if left out"
)
Unit = Annotated[
    str, Field(max_length=UNIT_CHARACTERS, description=_ABOUT_UNIT), AfterValidator(_is_unit)
]
Names = Annotated[list[str], Field(min_length=1), AfterValidator(is_unique)]
Length = Annotated[int, Field(ge=1, le=STATE_COMPONENTS)]
if TYPE_CHECKING:
    Side = int  # `coadjoint.spec.counted` puts numbers for names before anything is read
else:
    Side = Length | Annotated[str, Field(pattern=f"^{COUNTED_PATTERN}$")]
Title = Annotated[str, Field(max_length=TITLE_CHARACTERS), AfterValidator(_is_printable)]
License = Annotated[str, Field(max_length=UNIT_CHARACTERS), AfterValidator(_is_license)]


def read_default(
    source: Source, key: KeyPath, value: object, shape: Shape
) -> tuple[Fraction, ...] | None:
    """The declared default, one number for each component; None if there is none."""
    spread = None if value is None else _spread(value, shape)
    if spread is None and value is not None:
        written = source.positions.written(key)
        problem = f"the default of {str(written[-2])!r} does not have its shape {list(shape)}"
        expected = "one number for all components, or " * bool(shape) + _shape_words(shape)
        if written != key:
            expected += "; or a list with one such entry for each member"
        raise source.fault(key, problem, _shape_text(value), expected)
    return spread


def _spread(value: object, shape: Shape) -> tuple[Fraction, ...] | None:
    """One number for each component, row by row; None if the shape does not fit."""
    if not isinstance(value, list):
        assert isinstance(value, Fraction), value
        count = 1
        for length in shape:
            count *= length
        return (value,) * count
    if not shape or len(value) != shape[0]:
        return None
    if len(shape) == 1:
        return None if any(isinstance(entry, list) for entry in value) else tuple(value)
    rows = [_spread(row, shape[1:]) for row in value if isinstance(row, list)]
    whole = [row for row in rows if row is not None]
    return tuple(x for row in whole for x in row) if len(whole) == shape[0] else None


def _shape_words(shape: Shape) -> str:
    if not shape:
        return "a single number"
    counts = [f"{shape[0]} numbers"] if len(shape) == 1 else [f"{shape[0]} lists of {shape[1]}"]
    return f"a list of {counts[0]}"


def _shape_text(value: object) -> str:
    """The lengths of nested lists, for a message."""
    if not isinstance(value, list):
        return "a number"
    inner = {len(row) if isinstance(row, list) else 1 for row in value}
    return f"a list of {len(value)}" + (
        f" lists of {list_names(map(str, inner))}" if inner != {1} else ""
    )


#: What says how many components the entries of a table have.
_SIZED = {
    "variables": "block, representation or shape",
    "parameters": "shape",
    "inputs": "shape",
    "symmetries": "algebra",
}


def misfit_form(
    source: Source, key: KeyPath, count: int, form: str, along: Sequence[str] = ()
) -> CoadjointError:
    """A number of components that no matrix of a form keeps.

    Args:
        source: The spec.
        key: Where the form stands.
        count: How many components there are.
        form: The form.
        along: The elements of a basis that the components belong to, if to any.
    """
    counts = {"antisymmetric": "n(n - 1)/2", "symmetric": "n(n + 1)/2", "matrix": "n^2"}
    problem = f"{count} components fill no matrix of the form {form!r}"
    expected = f"{counts[form]} components for an n by n matrix"
    hint = f"Remove form, or choose another {_SIZED[str(key[0])]}."
    if along:
        hint += f" Without form, {key[1]}[1] to {key[1]}[{count}] are along {', '.join(along)}."
    return source.fault(key, problem, count, expected, hint)
