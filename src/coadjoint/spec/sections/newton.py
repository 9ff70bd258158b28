"""Newton: the table [newton], the law of each coordinate, ``mass * acceleration = force``.

Comes in: its keys and the coordinates. Goes out: `Force` records.
Read next: `coadjoint.derive.routes.newton`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from pydantic import Field

from coadjoint.spec.core.formulas import Formula, Scope, misfit, read_fitting
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading, Table
from coadjoint.spec.core.shapes import words
from coadjoint.spec.sections.state import Variable, state_of
from coadjoint.spec.sections.variables import VARIABLES


class NewtonPart(Part):
    """Newton's law of one coordinate: ``mass * acceleration = force``."""

    mass: str = Field("1", description="a scalar, or a matrix that multiplies the acceleration")
    force: str = Field(description="the force, of the shape of the coordinate")


@dataclass(frozen=True)
class Force:
    """Newton's law of one coordinate: ``mass * acceleration = force``."""

    coordinate: str
    mass: Formula
    force: Formula


def read_newton(reading: Reading, parts: Mapping[str, NewtonPart]) -> tuple[Force, ...]:
    """The laws of a spec, in the order of the coordinates.

    Raises:
        SpecError: A coordinate is unknown or has no law, a law has the wrong shape, or the state
            has no velocity of a coordinate.
    """
    variables = VARIABLES.of(reading)
    coordinates = {each.name: each for each in variables if each.role == "coordinate"}
    for name in parts:
        if name not in coordinates:
            problem = f"there is no coordinate {name!a}"
            raise reading.unknown(("newton", name), problem, name, coordinates, is_key=True)
    scope = reading.scope("Newton's law", ("coordinate", "velocity"))
    moving = {each.of for each in state_of(variables) if each.role == "velocity"}
    for name in coordinates:
        _check_law(reading, name, name in parts, name in moving)
    return tuple(
        Force(
            name,
            _read_mass(reading, variable, parts[name].mass, scope),
            _read_force(reading, variable, parts[name].force, scope),
        )
        for name, variable in coordinates.items()
    )


def _check_law(reading: Reading, name: str, given: bool, moving: bool) -> None:
    """Every coordinate has a law, and its velocity is part of the state."""
    if not given:
        problem, expected = f"the coordinate {name!r} has no law", "a law for every coordinate"
        hint = f'Write for instance {name} = {{ force = "-{name}" }}.'
        raise reading.fault(("newton",), problem, name, expected, hint)
    if not moving:
        problem = f"no velocity of {name!r} is part of the state"
        expected = "a velocity of every coordinate, and no momenta"
        hint = _advise_velocity(reading, name)
        raise reading.at_key(("newton", name), problem, name, expected, hint)


def _advise_velocity(reading: Reading, name: str) -> str:
    """How the velocity of a coordinate becomes part of the state."""
    of_it = {v.role: v.name for v in VARIABLES.of(reading) if v.of == name}
    if "momentum" in of_it and "velocity" in of_it:
        return f"Remove the momentum {of_it['momentum']}."
    velocity = of_it.get("momentum") or reading.free_name("v", name)
    return f'Write {velocity} = {{ role = "velocity", of = "{name}" }}.'


def _read_force(reading: Reading, variable: Variable, text: str, scope: Scope) -> Formula:
    """The force, of the shape of its coordinate."""
    key, shape = ("newton", variable.name, "force"), variable.value_shape
    return read_fitting(reading.source, key, text, scope, shape, variable.name)


def _read_mass(reading: Reading, variable: Variable, text: str, scope: Scope) -> Formula:
    """The mass: a scalar, or a matrix with a row for each row of the coordinate."""
    key: KeyPath = ("newton", variable.name, "mass")
    formula = reading.formula(key, text, scope, any_shape=True)
    if formula.shape == ():
        return formula
    expected = "a scalar"
    if variable.value_shape and variable.form in ("", "matrix"):
        size = variable.value_shape[0]
        if formula.shape == (size, size):
            return formula
        expected += f" or {words((size, size))}"
    hint = "Write diag(m) for a mass of each row." if " or " in expected else ""
    raise misfit(reading.source, key, formula, expected, hint)


NEWTON = Table[tuple[Force, ...]](
    "newton",
    NewtonPart,
    "Newton's law, by the names of coordinates",
    read_newton,
    many=True,
    least=1,
    routed=True,
    example='q = { mass = "m", force = "-k*q" }',
)
