"""Definitions: the table [definitions], short names for expressions.

Comes in: keys such as ``u`` and ``V(s, d)`` with their expressions. Goes out: `Definition` records
whose own trees hold no definition any more. Read next: `coadjoint.spec.core.definitions`, which
puts them into other formulas.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from coadjoint.spec.core.definitions import Definition, define, shapes_of, signature
from coadjoint.spec.core.formulas import Declared
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Naming, Reading, Table
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.values import DEFINITION_PATTERN
from coadjoint.spec.sections.constraints import list_reactions
from coadjoint.spec.sections.inputs import INPUTS
from coadjoint.spec.sections.parameters import PARAMETERS
from coadjoint.spec.sections.solved import find_definitions_with_reactions
from coadjoint.spec.sections.time import TIME
from coadjoint.spec.sections.variables import VARIABLES

_KEY = re.compile(DEFINITION_PATTERN, re.ASCII)


def read_definitions(reading: Reading, texts: Mapping[str, str]) -> tuple[Definition, ...]:
    """The definitions in order; each may use those before it.

    Raises:
        SpecError: A key or an expression is none, or a name in it is unknown.
        LimitError: With the earlier definitions expanded, an expression is too large.
    """
    for text in texts:
        reading.declare(Naming(key=("definitions", text), name=_read_name(reading.source, text)))
    given: list[Declared] = [*VARIABLES.of(reading), *PARAMETERS.of(reading), *INPUTS.of(reading)]
    shapes = shapes_of([*given, *filter(None, [TIME.of(reading)])])
    if find_definitions_with_reactions(reading.file):
        shapes |= list_reactions(reading)
    return define(reading.source, texts, shapes)


def _read_name(source: Source, text: str) -> str:
    """The name in a key of [definitions]."""
    if not _KEY.fullmatch(text):
        key: KeyPath = ("definitions", text)
        problem = f"{text!a} cannot be defined"
        expected = 'a name, or a name with arguments in quotes, such as "V(s, d)"'
        raise source.at_key(key, problem, text, expected)
    return signature(text)[0]


DEFINITIONS = Table[tuple[Definition, ...]](
    "definitions",
    str,
    "short names for expressions, such as u = 'A*b' and 'V(s, d)' = 's^2 - d'",
    read_definitions,
    many=True,
    pattern=DEFINITION_PATTERN,
    quantities=True,
)
