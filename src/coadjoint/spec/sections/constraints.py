"""Constraints: the table [constraints], equations between velocities.

Comes in: its keys. Goes out: `Constraint` records. Which velocities they give is found before there
are variables, in `coadjoint.spec.sections.solved`.
Read next: `coadjoint.derive.mechanics.distribution`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import Field

from coadjoint.spec.core.components import Shape, component_names
from coadjoint.spec.core.definitions import define, shapes_of, signature
from coadjoint.spec.core.formulas import DRIVING, Declared, Formula, Scope, make_scope
from coadjoint.spec.core.parts import name_pattern
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Naming, Reading, Table
from coadjoint.spec.core.relations import EQUATION, read_relation
from coadjoint.spec.core.source import show_value
from coadjoint.spec.kinds import VARIATIONAL, is_variational
from coadjoint.spec.sections.inputs import INPUTS
from coadjoint.spec.sections.parameters import PARAMETERS
from coadjoint.spec.sections.solved import (
    find_definitions_with_reactions,
    find_names,
    find_solved_velocities,
    reaction_name,
)
from coadjoint.spec.sections.time import TIME
from coadjoint.spec.sections.variables import VARIABLES, motion_roles


@dataclass(frozen=True)
class Constraint:
    """An equation between velocities, ``left == right``, linear or affine in them.

    Attributes:
        name: As declared; its multiplier is emitted as ``NAME_reaction``.
        left: One side.
        right: The other side, of the same shape.
        solves: The velocity that it gives, if one side is that velocity alone; else "".
        sign: 1 if that velocity is the left side, -1 if it is the right one.
    """

    name: str
    left: Formula
    right: Formula
    solves: str = ""
    sign: int = 1

    @property
    def shape(self) -> Shape:
        """Shape of both sides."""
        return self.left.shape

    @property
    def components(self) -> tuple[str, ...]:
        """Names of its scalar equations."""
        return component_names(self.name, self.shape)

    @property
    def reaction(self) -> str:
        """Name of its multiplier."""
        return reaction_name(self.name)

    @property
    def reactions(self) -> tuple[str, ...]:
        """Names of the components of its multiplier."""
        return component_names(self.reaction, self.shape)

    @property
    def in_one_line(self) -> str:
        """The equation without its line breaks."""
        return self.left.in_one_line


@dataclass(frozen=True)
class Constraints:
    """The record of the table.

    Attributes:
        constraints: Those that are imposed after the variation, by Lagrange and d'Alembert.
        variational: Those that are imposed before it, on the motions that are compared.
    """

    constraints: tuple[Constraint, ...] = ()
    variational: tuple[Constraint, ...] = ()


def list_reactions(reading: Reading) -> dict[str, Shape]:
    """Shapes of the multipliers that formulas may name, whole and by component."""
    constraints = CONSTRAINTS.of(reading).constraints
    names = {each.reaction: each.shape for each in constraints}
    return {name: () for each in constraints for name in each.reactions} | names


def read_constraints(reading: Reading, given: Mapping[str, str | bool]) -> Constraints:
    """The constraints in declared order.

    Raises:
        SpecError: One is not an equation between velocities, or rests on a reaction.
    """
    source, file = reading.source, reading.file
    texts = _check_kinds(reading, given)
    solved = {
        name: (velocity, sign)
        for velocity, (name, sign) in (find_solved_velocities(file) or {}).items()
    }
    scope, constraints = _scope(reading), []
    for name, text in texts.items():
        _check_names_no_reaction(reading, ("constraints", name), text)
        left, _, right = read_relation(source, ("constraints", name), text, EQUATION, scope)
        solves, sign = solved.get(name, ("", 1))
        constraints.append(Constraint(name=name, left=left, right=right, solves=solves, sign=sign))
    if is_variational(file):
        return Constraints(variational=tuple(constraints))
    return Constraints(constraints=tuple(constraints))


def _check_kinds(reading: Reading, given: Mapping[str, str | bool]) -> dict[str, str]:
    """The equations by name: texts, at least one; `VARIATIONAL` alone is true or false."""
    texts = {name: text for name, text in given.items() if isinstance(text, str)}
    for name, value in given.items():
        if (name in texts) is (name == VARIATIONAL):
            expected = "an equation such as 'Y == cross(Omega, s)'"
            expected = "true or false" if name == VARIATIONAL else expected
            key: KeyPath = ("constraints", name)
            raise reading.fault(key, f"found {show_value(value)}", value, expected)
    if not texts:
        expected = "at least one equation between velocities"
        problem = "[constraints] has no constraint"
        raise reading.fault(("constraints",), problem, "constraints", expected)
    return texts


def _scope(reading: Reading) -> Scope:
    """What constraints may name: definitions among it, but those that name reactions.

    The shapes of reactions, which these need, follow from the constraints.
    """
    kind, roles, file = "a constraint", motion_roles(reading), reading.file
    later = find_definitions_with_reactions(file)
    if not later:
        return reading.scope(kind, roles)
    given: list[Declared] = [*VARIABLES.of(reading), *PARAMETERS.of(reading), *INPUTS.of(reading)]
    given += filter(None, [TIME.of(reading)])
    texts = {key: text for key, text in file.definitions.items() if key not in later}
    plain = define(reading.source, texts, shapes_of(given))
    return make_scope(kind, roles, [*given, *plain], driven=DRIVING)


def _check_names_no_reaction(reading: Reading, key: KeyPath, text: str) -> None:
    """A constraint rests on no definition that names a reaction."""
    names = find_names(reading.file, text.split("=="))
    for definition in sorted(find_definitions_with_reactions(reading.file)):
        name = signature(definition)[0]
        if name in names:
            problem = f"the constraint rests on {name}, which names a reaction"
            expected = "an equation between velocities, which no reaction enters"
            hint = f"Write {name} without reactions, or use it in [forces] alone."
            raise reading.fault(key, problem, name, expected, hint)


def _name_all(table: str, record: Constraints) -> Iterator[Naming]:
    """The names of constraints, and of the multipliers that are reactions."""
    for each in record.variational:
        yield Naming(key=(table, each.name), name=each.name, components=each.components)
    for each in record.constraints:
        key: KeyPath = (table, each.name)
        why = (
            f"The multiplier of the constraint {each.name} is {each.reaction}: rename one of them."
        )
        yield Naming(key=key, name=each.name, components=each.components)
        yield Naming(key=key, name=each.reaction, components=each.reactions, why=why)


_ABOUT = (
    "equations between velocities, as rolling = 'Y == cross(Omega, s)'; variational = true imposes "
    "them before the variation, on the motions that are compared, and not after it"
)
_KINDS: dict[str, Any] = {
    "properties": {VARIATIONAL: {"type": "boolean"}},
}
CONSTRAINTS = Table[Constraints](
    "constraints",
    str,
    _ABOUT,
    read_constraints,
    many=True,
    field=(
        Annotated[dict[str, str | bool], Field(min_length=1)] | None,
        Field(None, description=_ABOUT, json_schema_extra={**name_pattern(), **_KINDS}),
    ),
    absent=Constraints(),
    attribute=None,
    names=_name_all,
    acts=True,
)
