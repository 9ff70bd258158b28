"""Newton: the declared law of each coordinate, ``mass * acceleration = force``.

Comes in: the validated table [newton] and the variables. Goes out: `Force` records whose formulas
have been parsed in the scope of coordinates, velocities and parameters; none of them knows time.
Read next: `coadjoint.derive.routes.newton`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from coadjoint.errors import CoadjointError
from coadjoint.spec.core.faults import did_you_mean, listed
from coadjoint.spec.core.formulas import DRIVING, Quantity, Scope, make_scope, read_formula
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.shapes import words
from coadjoint.spec.core.source import Source
from coadjoint.spec.model import Force, Formula, Variable, state_of
from coadjoint.spec.schema import NewtonPart


def read_newton(
    source: Source,
    parts: Mapping[str, NewtonPart],
    variables: Sequence[Variable],
    quantities: Sequence[Quantity],
) -> tuple[Force, ...]:
    """The laws of a spec, in the order of the coordinates.

    Args:
        source: The text of the spec.
        parts: The table [newton].
        variables: All variables.
        quantities: Variables, parameters and definitions.

    Raises:
        SpecError: A coordinate is unknown or has no law, a law has the wrong shape, or the state
            has no velocity of a coordinate.
    """
    coordinates = {each.name: each for each in variables if each.role == "coordinate"}
    for name in parts:
        if name not in coordinates:
            raise source.fault(
                ("newton", name),
                f"there is no coordinate {name!a}",
                found=name,
                expected=f"one of {listed(coordinates)}" if coordinates else "a coordinate",
                hint=did_you_mean(name, coordinates),
                at=source.positions.key(("newton", name)),
            )
    scope = make_scope("Newton's law", ("coordinate", "velocity"), quantities, driven=DRIVING)
    moving = {each.of for each in state_of(variables) if each.role == "velocity"}
    for name in coordinates:
        _check_law(source, name, name in parts, name in moving)
    return tuple(
        Force(
            name,
            _mass(source, variable, parts[name].mass, scope),
            _force(source, variable, parts[name].force, scope),
        )
        for name, variable in coordinates.items()
    )


def _check_law(source: Source, name: str, given: bool, moving: bool) -> None:
    """Every coordinate has a law, and its velocity is part of the state."""
    if not given:
        raise source.fault(
            ("newton",),
            f"the coordinate {name!r} has no law",
            found=name,
            expected="a law for every coordinate",
            hint=f'Write for instance {name} = {{ mass = "m", force = "..." }}.',
        )
    if not moving:
        raise source.fault(
            ("newton", name),
            f"no velocity of {name!r} is part of the state",
            found=name,
            expected="a velocity of every coordinate, and no momenta beside them",
            hint=f'Write v = {{ role = "velocity", of = "{name}" }}.',
            at=source.positions.key(("newton", name)),
        )


def _force(source: Source, variable: Variable, text: str, scope: Scope) -> Formula:
    """The force, of the shape of its coordinate."""
    key: KeyPath = ("newton", variable.name, "force")
    formula = read_formula(source, key, text, scope, any_shape=True)
    if formula.shape != variable.value_shape:
        expected = f"{words(variable.value_shape)}, as {variable.name} is"
        raise _misfit(source, key, formula, expected)
    return formula


def _mass(source: Source, variable: Variable, text: str, scope: Scope) -> Formula:
    """The mass: a scalar, or a matrix with a row for each row of the coordinate."""
    key: KeyPath = ("newton", variable.name, "mass")
    formula = read_formula(source, key, text, scope, any_shape=True)
    if formula.shape == ():
        return formula
    expected = "a scalar"
    if variable.value_shape and variable.form in ("", "matrix"):
        size = variable.value_shape[0]
        if formula.shape == (size, size):
            return formula
        expected += f" or {words((size, size))}"
    raise _misfit(source, key, formula, expected)


def _misfit(source: Source, key: KeyPath, formula: Formula, expected: str) -> CoadjointError:
    found = words(formula.shape)
    hint = "Write diag(m) for a mass of each row." if key[-1] == "mass" else ""
    return source.fault(key, f"the value is {found}", found=found, expected=expected, hint=hint)
