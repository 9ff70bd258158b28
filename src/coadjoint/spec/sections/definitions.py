"""Definitions: the table [definitions], short names for expressions.

Comes in: keys such as ``u`` and ``V(s, d)`` with their expressions. Goes out: `Definition` records
whose own trees hold no definition any more. Read next: `coadjoint.spec.core.definitions`, which
puts them into other formulas.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.definitions import Definition, expand, functions
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.faults import ExpressionError, did_you_mean
from coadjoint.spec.core.formulas import Quantity
from coadjoint.spec.core.names import refusal
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Naming, Reading, Table
from coadjoint.spec.core.shapes import shape_of
from coadjoint.spec.core.sizes import check_size
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.tree import Index, Name, Node, walk
from coadjoint.spec.core.values import DEFINITION_PATTERN
from coadjoint.spec.sections.inputs import INPUTS
from coadjoint.spec.sections.parameters import PARAMETERS
from coadjoint.spec.sections.time import TIME
from coadjoint.spec.sections.variables import VARIABLES

_KEY = re.compile(DEFINITION_PATTERN, re.ASCII)


def signature(key: str) -> tuple[str, tuple[str, ...]]:
    """The name and the arguments in a key of [definitions].

    >>> signature("V(s, d)"), signature("u")
    (('V', ('s', 'd')), ('u', ()))
    """
    name, _, rest = key.partition("(")
    return name.strip(), tuple(part.strip() for part in rest.rstrip(") ").split(",") if rest)


def read_definitions(reading: Reading, texts: Mapping[str, str]) -> tuple[Definition, ...]:
    """The definitions in order; each may use those before it.

    Raises:
        SpecError: A key or an expression is none, or a name in it is unknown.
        LimitError: With the earlier definitions put in, an expression is too large.
    """
    source = reading.source
    given: list[Quantity] = [*VARIABLES.of(reading), *PARAMETERS.of(reading), *INPUTS.of(reading)]
    shapes: dict[str, Shape] = {}
    for text in texts:
        reading.declare(Naming(("definitions", text), _checked_name(source, text)))
    for quantity in (*given, *filter(None, [TIME.of(reading)])):
        shapes |= {**dict.fromkeys(quantity.components, ()), quantity.name: quantity.value_shape}
    known: dict[str, Definition] = {}
    for text, expression in texts.items():
        key: KeyPath = ("definitions", text)
        name, arguments = signature(text)
        _check_arguments(source, key, arguments, [*shapes, *map(_name, texts)])
        try:
            tree = expand(read_expression(expression, functions(known)), known, source.spent)
            shape = _shape(tree, shapes, arguments, [_name(later) for later in texts])
        except ExpressionError as error:
            raise source.expression_fault(key, error) from None
        known[name] = Definition(name, arguments, expression, tree, shape)
    return tuple(known.values())


def _checked_name(source: Source, text: str) -> str:
    """The name in a key of [definitions]."""
    if not _KEY.fullmatch(text):
        key: KeyPath = ("definitions", text)
        raise source.fault(
            key,
            f"{text!a} cannot be defined",
            found=text,
            expected='a name, or a name with arguments in quotes, such as "V(s, d)"',
            at=source.positions.key(key),
        )
    return _name(text)


def _name(key: str) -> str:
    return signature(key)[0]


def _check_arguments(
    source: Source, key: KeyPath, arguments: Sequence[str], taken: Sequence[str]
) -> None:
    """Arguments have names of their own."""
    for place, argument in enumerate(arguments):
        if argument in taken or argument in arguments[:place]:
            problem, expected = f"the argument {argument!r} has a name that is taken", "a free name"
            hint = "A variable or parameter need not be an argument."
        elif (refused := refusal(argument)) is not None:
            problem, expected, hint = refused
        else:
            continue
        at = source.positions.key(key)
        raise source.fault(key, problem, found=argument, expected=expected, hint=hint, at=at)


def _shape(
    tree: Node, shapes: Mapping[str, Shape], arguments: Sequence[str], defined: Sequence[str]
) -> Shape | None:
    """The shape of a definition; None with arguments, whose shapes only a call has."""
    for node in walk(tree):
        if isinstance(node, (Name, Index)) and node.name not in (*shapes, *arguments):
            later = node.name in defined
            raise ExpressionError(
                f"{node.name!r} is {'defined no earlier' if later else 'not declared'}",
                node.start,
                node.end,
                found=node.name,
                expected="variables, parameters, arguments and earlier definitions",
                hint="" if later else did_you_mean(node.name, (*shapes, *arguments, *defined)),
            )
    if arguments:
        return None
    check_size(tree, shapes)
    return shape_of(tree, shapes)


DEFINITIONS = Table[tuple[Definition, ...]](
    "definitions",
    str,
    "short names for expressions, such as u = 'A*b' and 'V(s, d)' = 's^2 - d'",
    read_definitions,
    many=True,
    pattern=DEFINITION_PATTERN,
    quantities=True,
)
