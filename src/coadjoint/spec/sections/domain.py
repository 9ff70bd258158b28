"""Domain: the table [domain], inequalities that bound where the system is defined.

Comes in: its keys. Goes out: `Condition` records of scalars.
Read next: `coadjoint.spec.sections.rolling`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.core.names import refusal
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading, Table
from coadjoint.spec.core.relations import INEQUALITIES, read_relation
from coadjoint.spec.core.shapes import words
from coadjoint.spec.sections.constraints import list_reactions
from coadjoint.spec.sections.variables import motion_roles


@dataclass(frozen=True)
class Condition:
    """An inequality that bounds where a system is defined.

    Attributes:
        name: As declared.
        left: One side, a scalar.
        sign: ``>``, ``>=``, ``<`` or ``<=``.
        right: The other side.
    """

    name: str
    left: Formula
    sign: str
    right: Formula

    @property
    def in_one_line(self) -> str:
        """The inequality without its line breaks."""
        return self.left.in_one_line


def read_domain(reading: Reading, texts: Mapping[str, str]) -> tuple[Condition, ...]:
    """The declared inequalities, which may name reactions: a body leaves the plane.

    Raises:
        SpecError: One is not an inequality between scalars, or has a reserved name.
    """
    reactions = list_reactions(reading)
    scope = reading.scope("a condition", motion_roles(reading), reactions)
    conditions = []
    for name, text in texts.items():
        key: KeyPath = ("domain", name)
        refused = refusal(name)  # a label of rows alone: a variable may have the same name
        if refused is not None:
            problem, expected, hint = refused
            raise reading.at_key(key, problem, name, expected, hint)
        left, sign, right = read_relation(reading.source, key, text, INEQUALITIES, scope)
        if left.shape:
            raise reading.fault(key, f"both sides are {words(left.shape)}", text, "two scalars")
        conditions.append(Condition(name, left, sign, right))
    return tuple(conditions)


DOMAIN = Table[tuple[Condition, ...]](
    "domain", str, "where the system is defined, as tilted = 'Gamma3^2 < 1'", read_domain, many=True
)
