"""Forces: the table [forces], what acts in addition to the energy.

Comes in: formulas by the names of what they act along. Goes out: a `Formula` for each.
Read next: `coadjoint.spec.sections.relaxation`.
"""

from __future__ import annotations

from collections.abc import Mapping

from pydantic import Field

from coadjoint.errors import CoadjointError
from coadjoint.spec.core.faults import did_you_mean, list_names
from coadjoint.spec.core.formulas import ROLES, Formula, Scope, misfit, read_fitting
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading, Table
from coadjoint.spec.core.shapes import words
from coadjoint.spec.core.tree import walk
from coadjoint.spec.sections.constraints import list_reactions
from coadjoint.spec.sections.state import Variable, state_of
from coadjoint.spec.sections.variables import VARIABLES, motion_roles


def read_forces(reading: Reading, texts: Mapping[str, str]) -> dict[str, Formula]:
    """The declared forces by what they act along.

    Raises:
        SpecError: There is no such variable, a momentum is named whose velocity has a Lagrangian,
            or the force has another shape.
    """
    reactions = list_reactions(reading)  # which friction is proportional to
    scope = reading.scope("a force", motion_roles(reading), reactions)
    forced = _find_forced(reading)
    return {
        name: read_along(reading, ("forces", name), text, scope, forced, as_matrix=True)
        for name, text in texts.items()
    }


def _find_forced(reading: Reading) -> Mapping[str, Variable]:
    """What forces may act along: velocities, and what only a Hamiltonian moves.

    With a Lagrangian a force along a velocity says what it does; with a Hamiltonian momenta and the
    coordinates of a declared bracket may have no velocities.
    """
    moving = {each.name: each for each in _list_moving(reading)}
    if reading.file.lagrangian is not None:
        return moving
    roles = {"momentum"} | ({"coordinate"} if reading.file.poisson is not None else set())
    return moving | {each.name: each for each in VARIABLES.of(reading) if each.role in roles}


def _list_moving(reading: Reading) -> list[Variable]:
    """The velocities on which forces work.

    Those in a state that a Hamiltonian moves have no mass, by which a force would be divided.
    """
    variables = VARIABLES.of(reading)
    massless = [] if reading.file.lagrangian is not None else state_of(variables)
    return [each for each in variables if each.role == "velocity" and each not in massless]


def read_along(
    reading: Reading,
    key: KeyPath,
    text: str,
    scope: Scope,
    velocities: Mapping[str, Variable],
    *,
    as_matrix: bool = False,
) -> Formula:
    """A formula with a value for each component of the velocity that its key names.

    Args:
        reading: The spec.
        key: Of the formula; its last part is the name.
        text: The formula.
        scope: The names that it may use.
        velocities: What it may be along, by name.
        as_matrix: Whether along a matrix it may be a matrix, too.
    """
    name = str(key[-1])
    if name not in velocities:
        raise _no_velocity(reading, key, name, velocities)
    along = velocities[name]
    if not along.form:
        return read_fitting(reading.source, key, text, scope, along.shape, name)
    formula = reading.formula(key, text, scope, any_shape=True)
    if formula.shape not in (along.shape, *([along.value_shape] if as_matrix else [])):
        names = list_names(along.components)
        expected = f"{words(along.shape)}, along the components {names} of the matrix {name!r}"
        expected += f", or {words(along.value_shape)}" * as_matrix
        expected += f" that is {along.form}" * (as_matrix and along.form != "matrix")
        zeros = ", ".join(["0"] * (len(along.components) - 1))
        hint = f"Write vector({along.components[0]}, {zeros}) for one along {along.components[0]}."
        raise misfit(reading.source, key, formula, expected, hint if zeros else "")
    return formula


FORCES = Table[dict[str, Formula]](
    "forces",
    str,
    "forces in addition to the energy, by the names of the velocities they work on",
    read_forces,
    many=True,
    absent={},
    acts=True,
)


class DissipationPart(Part):
    """Dissipation by a function of the velocities."""

    R: str = Field(description="Rayleigh's function; the force is -dR/dxi")


def _no_velocity(
    reading: Reading, key: KeyPath, name: str, velocities: Mapping[str, Variable]
) -> CoadjointError:
    """An error for a force along something that forces do not act along."""
    roles = {each.role for each in velocities.values()} or {"velocity"}
    what = "velocity" if roles == {"velocity"} else "variable"
    problem, hint = f"there is no such {what} as {name!a}", did_you_mean(name, velocities)
    declared = {each.name: each for each in VARIABLES.of(reading)}
    if name in declared:
        own = declared[name]
        problem = f"{name!r} is {ROLES[own.role]}"
        near = [v for v, each in velocities.items() if (each.block, each.of) == (own.block, own.of)]
        hint = f"Write {(near or list(velocities))[0]} in its place." if velocities else ""
        if own.role == "velocity":
            problem, hint = _say_massless(own)
    expected = f"one of {list_names(velocities)}" if velocities else "a declared velocity"
    return reading.at_key(key, problem, name, expected, hint or f"Remove {name}.")


def _say_massless(velocity: Variable) -> tuple[str, str]:
    """Why no force acts along a velocity of the state that a Hamiltonian moves, and what to do."""
    name = velocity.name
    hint = f'Write {name} = {{ role = "coordinate" }} in [variables], and in [forces] what is added'
    problem = f"a Hamiltonian moves the velocity {name!r}, and says no mass to divide a force by"
    return problem, f"{hint} to its rate."


def _names_of(variable: Variable) -> set[str]:
    return {variable.name, *variable.components}


def read_dissipation(reading: Reading, part: DissipationPart) -> Formula:
    """Rayleigh's function.

    Raises:
        SpecError: It is not a formula of velocities.
    """
    key: KeyPath = ("dissipation", "R")
    reactions = list_reactions(reading)
    scope = reading.scope("a dissipation", motion_roles(reading), reactions)
    formula = reading.formula(key, part.R, scope)
    velocities = _list_moving(reading)
    named = {getattr(node, "name", "") for node in walk(formula.tree)}
    for each in VARIABLES.of(reading):
        if each.role == "velocity" and each not in velocities and named & _names_of(each):
            problem, hint = _say_massless(each)
            raise reading.fault(key, problem, each.name, "velocities with a mass", hint)
    if not named & {name for each in velocities for name in _names_of(each)}:
        raise reading.fault(
            key,
            "Rayleigh's function names no velocity",
            part.R,
            "a function of velocities, whose force is -dR/dxi",
            f"Name {list_names(v.name for v in velocities)} in it, or remove [dissipation]."
            if velocities
            else "Write what acts along a momentum in [forces].",
        )
    return formula


DISSIPATION = Table[Formula | None](
    "dissipation", DissipationPart, "dissipation by a function R", read_dissipation, acts=True
)
