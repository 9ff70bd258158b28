"""Constraints: the table [constraints], equations between velocities.

Comes in: its keys. Goes out: `Constraint` records. Which velocities they give is found before there
are variables, in `coadjoint.spec.sections.solved`.
Read next: `coadjoint.derive.mechanics.distribution`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from coadjoint.spec.core.components import Shape, component_names
from coadjoint.spec.core.definitions import define, shapes_of, signature
from coadjoint.spec.core.formulas import DRIVING, Declared, Formula, Scope, make_scope
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Naming, Reading, Table
from coadjoint.spec.core.relations import EQUATION, read_relation
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


def reaction_shapes(constraints: Sequence[Constraint]) -> dict[str, Shape]:
    """Shapes of the multipliers, whole and by component."""
    names = {each.reaction: each.shape for each in constraints}
    return {name: () for each in constraints for name in each.reactions} | names


def read_constraints(reading: Reading, texts: Mapping[str, str]) -> tuple[Constraint, ...]:
    """The constraints in declared order.

    Raises:
        SpecError: One is not an equation between velocities, or rests on a reaction.
    """
    source, file = reading.source, reading.file
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
    return tuple(constraints)


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


def _name_all(table: str, constraints: Sequence[Constraint]) -> Iterator[Naming]:
    """The names of constraints and of their multipliers."""
    for each in constraints:
        key: KeyPath = (table, each.name)
        why = (
            f"The multiplier of the constraint {each.name} is {each.reaction}: rename one of them."
        )
        yield Naming(key=key, name=each.name, components=each.components)
        yield Naming(key=key, name=each.reaction, components=each.reactions, why=why)


CONSTRAINTS = Table[tuple[Constraint, ...]](
    "constraints",
    str,
    "equations between velocities, as rolling = 'Y == cross(Omega, s)'",
    read_constraints,
    many=True,
    least=1,
    names=_name_all,
    acts=True,
)
