"""Reduction: the table [reduction], a submanifold that the motion keeps.

Comes in: its section, which says what some variables are there. Goes out: a `Submanifold`, or None.
That the motion keeps it is proved later. Read next: `coadjoint.derive.reductions`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Annotated

from pydantic import Field

from coadjoint.spec.core.faults import did_you_mean, list_names
from coadjoint.spec.core.formulas import Declared, Formula, make_scope, read_fitting
from coadjoint.spec.core.parts import Part, name_pattern
from coadjoint.spec.core.reading import Reading, Table
from coadjoint.spec.sections.state import Variable, state_of
from coadjoint.spec.sections.variables import VARIABLES


class ReductionPart(Part):
    """A submanifold that the motion keeps, on which some variables follow from the others."""

    section: Annotated[dict[str, str], Field(min_length=1)] = Field(
        description="what variables, or components of them, are there, as y = 'cross(x, K*x)' or "
        "x3 = '0'; the state is without them",
        json_schema_extra=name_pattern(),
    )
    where: list[str] = Field([], description="functions of all variables that vanish there")


@dataclass(frozen=True)
class Submanifold:
    """A submanifold, on which some variables follow from the others.

    Attributes:
        section: What these variables, or components of variables, are, by name.
        where: Functions of all variables that vanish on the submanifold.
    """

    section: Mapping[str, Formula]
    where: tuple[Formula, ...] = ()


def read_reduction(reading: Reading, part: ReductionPart) -> Submanifold:
    """The declared submanifold.

    Raises:
        SpecError: What is restricted is not a vector or scalar of the state, no variable is left,
            or the spec has a table that a restricted motion cannot have.
    """
    _check_alone(reading)
    variables = state_of(VARIABLES.of(reading))
    known = {variable.name: variable for variable in variables}
    parts = {c: variable for variable in variables for c in variable.components}
    for name in part.section:
        _check_eliminated(reading, name, known, part.section)
    followed = {c for c, each in parts.items() if {c, each.name} & part.section.keys()}
    if parts.keys() <= followed:
        problem, expected = (
            "no variable of the state is left",
            "a section over at least one variable",
        )
        raise reading.fault(("reduction", "section"), problem, list_names(part.section), expected)
    roles = tuple(dict.fromkeys(variable.role for variable in variables))
    own = list_left(variables, part.section)
    left: list[Declared] = [q for q in reading.quantities if q.name not in known]
    left += own
    of_left = make_scope("a section", roles, left)
    scope = reading.scope("a function that vanishes", roles, driven=())
    return Submanifold(
        {
            name: read_fitting(
                reading.source,
                ("reduction", "section", name),
                text,
                of_left,
                known[name].value_shape if name in known else (),
                name,
            )
            for name, text in part.section.items()
        },
        tuple(
            reading.formula(("reduction", "where", place), text, scope, any_shape=True)
            for place, text in enumerate(part.where)
        ),
    )


def _check_alone(reading: Reading) -> None:
    """There is a Hamiltonian, and no other law of motion."""
    file = reading.file
    for name in ("newton", "lagrangian"):
        if getattr(file, name):
            problem = f"there are [{name}] and [reduction], which restricts a motion by its energy"
            expected = "[hamiltonian] alone"
            hint = f"Remove [{name}]." if file.hamiltonian else "Write [hamiltonian] in its place."
            raise reading.fault((name,), problem, name, expected, hint)
    if file.hamiltonian is None:
        problem, expected = "there is no Hamiltonian", "a table [hamiltonian] with [reduction]"
        raise reading.fault(("reduction",), problem, "hamiltonian", expected)


def list_left(variables: Iterable[Variable], section: Mapping[str, object]) -> list[Variable]:
    """The variables that a section leaves, and the components of those of which it gives some."""
    left = list[Variable]()
    for each in variables:
        given = tuple(c for c in each.components if c in section and c != each.name)
        parts = replace(each, given=given).parts
        left += [part for part in parts if part.name not in section and each.name not in section]
    return left


def _check_eliminated(
    reading: Reading, name: str, known: Mapping[str, Variable], section: Mapping[str, str]
) -> None:
    """What the section gives is a variable, a component of one, or an entry of a matrix."""
    parts = {c: variable for variable in known.values() for c in variable.components}
    if name in parts and name not in known and parts[name].name in section:
        problem = f"{name!r} is given twice, alone and as a component of {parts[name].name!r}"
        expected = "each component once"
        raise reading.at_key(("reduction", "section", name), problem, name, expected)
    if (name not in known or known[name].form) and name not in parts:
        kind = "is a matrix kept as a list" if name in known else "is not a variable"
        problem = f"{name!r} {kind}"
        expected = f"one of {list_names(n for n, v in known.items() if not v.form)}"
        hint = did_you_mean(name, (*known, *parts))
        if name in known:
            hint = f"Write its entries one by one, as {known[name].components[0]}."
        raise reading.at_key(("reduction", "section", name), problem, name, expected, hint)


REDUCTION = Table[Submanifold | None](
    "reduction", ReductionPart, "the submanifold to which the motion is restricted", read_reduction
)
