r"""Turning: how an attitude in the state moves, and what stays of it.

A rotation matrix moves by :math:`\dot R = R\hat\Omega`, a unit quaternion by
:math:`\dot q = \tfrac12 q\,[0, \Omega]` and the position of a body by :math:`\dot x = R v`. In a
right-invariant system :math:`\dot R = \hat\omega R` and :math:`\dot q = \tfrac12 [0, \omega]\, q`.
Then :math:`R R^T`, from the right :math:`R^T R`, and :math:`|q|^2` stay what they are. These laws
are written out by products of matrices and of quaternions. No representation is used, so that the
rates of the routes can be compared with them.
Comes in: a Setting with attitudes. Goes out: rates by name, and the products that stay.
Read next: `coadjoint.prove.attitudes`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

from coadjoint.algebra import algebra_by_name
from coadjoint.algebra.attitudes import are_rotations
from coadjoint.algebra.matrices import without_zero_places
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element
from coadjoint.exact.dense import (
    Matrix,
    apply,
    determinant,
    dot,
    hat,
    identity,
    product,
    scale,
    transpose,
)
from coadjoint.groups.quaternions import Quaternion
from coadjoint.spec.core.components import kept_places
from coadjoint.spec.model import Variable
from coadjoint.spec.spatial import describe_gram, describe_rotation, turning_rows


def gram(setting: Setting, variable: Variable) -> tuple[Element, ...]:
    """``R R^T``, from the right ``R^T R``, above its diagonal and with it; or ``|q|^2``."""
    square = gram_matrix(setting, variable)
    return tuple(square[i][j] for i, j in kept_places(len(square), "symmetric"))


def gram_matrix(setting: Setting, variable: Variable) -> Matrix:
    """The same as a matrix, which of a quaternion has one row."""
    if variable.turning == "quaternion":
        q = setting.elements(variable.components)
        return ((dot(q, q),),)
    R = _turning_part(setting, variable)
    R = R if setting.sign == 1 else transpose(R)
    return product(R, transpose(R))


def rotation_relations(
    setting: Setting, variable: Variable
) -> list[tuple[str, tuple[Element, ...]]]:
    """What is zero where an attitude is a rotation and a quaternion has length 1, with its text."""
    product_text, values = describe_gram(setting.spec, variable), gram(setting, variable)
    if variable.turning == "quaternion":
        return [(f"{product_text} = 1", (values[0] - 1,))]
    R = _turning_part(setting, variable)
    ones = [int(i == j) for i, j in kept_places(len(R), "symmetric")]
    unit = tuple(value - one for value, one in zip(values, ones, strict=True))
    name = describe_rotation(variable)
    return [(f"{product_text} = 1", unit), (f"det({name}) = 1", (determinant(R) - 1,))]


def turned_back(setting: Setting) -> dict[str, Element]:
    """Attitudes moved back to rotations: one of Newton's steps to the nearest one.

    ``q (3 - |q|^2)/2``, and for matrices ``(3 - R R^T) R/2``, which is ``R (3 - R^T R)/2``. With D
    for ``R R^T - 1`` before, it is ``D^2 (D - 3)/4`` after.
    """
    moved = dict[str, Element]()
    for variable in setting.spec.turning:
        elements = setting.elements(variable.components)
        moved |= zip(variable.components, step_back(variable, elements), strict=True)
    return moved


def step_back(variable: Variable, entries: Sequence[Any]) -> list[Any]:
    """One of Newton's steps, of entries of any kind; the position of a pose stays."""
    if variable.turning == "quaternion":
        return list(scale((3 - dot(entries, entries)) / 2, tuple(entries)))
    (rows, columns), moved = variable.shape, list(entries)
    R: Matrix = tuple(tuple(entries[i * columns : i * columns + rows]) for i in range(rows))
    turned = product(product(R, transpose(R)), R)
    for i, (row, cubed) in enumerate(zip(R, turned, strict=True)):
        for j, (x, y) in enumerate(zip(row, cubed, strict=True)):
            moved[i * columns + j] = (3 * x - y) / 2
    return moved


def turning_residuals(setting: Setting) -> list[tuple[str, Element]]:
    """What is zero where attitudes are rotations, by the names of the rows."""
    rows: list[tuple[str, Element]] = []
    for variable in setting.spec.turning:
        relations = rotation_relations(setting, variable)
        values = [value for _, parts in relations for value in parts]
        rows += zip(turning_rows(setting.spec, variable), values, strict=True)
    return rows


def rational_rotation(variable: Variable) -> dict[str, Fraction]:
    """A rotation in general position: turns in planes through neighbouring axes, one by one."""
    if variable.turning == "quaternion":
        entries: Sequence[Fraction] = [Fraction(n, 9) for n in (2, 4, -5, 6)]
        return dict(zip(variable.components, entries, strict=True))
    rows, columns = variable.shape
    R: Matrix = identity(rows)
    for n in range(2 * rows - 3):  # (m^2 - 1, 2m) are sides of a right-angled triangle
        m, i = n + 2, n % (rows - 1)
        c, s = Fraction(m * m - 1, m * m + 1), Fraction(2 * m, m * m + 1)
        turn = [list(row) for row in identity(rows)]
        turn[i][i], turn[i][i + 1], turn[i + 1][i], turn[i + 1][i + 1] = c, -s, s, c
        R = product(R, tuple(map(tuple, turn)))
    return {
        variable.components[i * columns + j]: Fraction(R[i][j])
        for i in range(rows)
        for j in range(rows)
    }


def kinematics(setting: Setting) -> Iterator[tuple[str, dict[str, Element]]]:
    """The law of each attitude in space as a book writes it, and the rates by it."""
    for variable in setting.spec.having_role("advected"):
        axes = _axes(variable) if variable.turning else ()
        if axes:
            yield _law(setting, variable, axes)


def _law(
    setting: Setting, variable: Variable, axes: Sequence[int]
) -> tuple[str, dict[str, Element]]:
    """The text of the law and the rates of the components."""
    turn, shift = axes[:3], axes[3:]
    velocities = _velocities(setting)
    omega = tuple(velocities[i] for i in turn)
    w, name, left = _name_velocity(setting, turn), variable.name, setting.sign == 1
    if variable.turning == "quaternion":
        q, pure = Quaternion(*setting.elements(variable.components)), Quaternion.pure(omega)
        whole = f"(0, {w.strip('()')})"
        text = f"qmul({name}, {whole})/2" if left else f"qmul({whole}, {name})/2"
        moved = (q * pure if left else pure * q).components
        rates = [x / 2 for x in moved]
    else:
        R, spin = _turning_part(setting, variable), hat(omega)
        rows = product(R, spin) if left else product(spin, R)
        text = f"{name}*hat({w})" if left else f"hat({w})*{name}"
        if shift:
            v = tuple(velocities[i] for i in shift)
            rows = tuple((*row, x) for row, x in zip(rows, apply(R, v), strict=True))
            text = f"R*[hat({w}), {_name_velocity(setting, shift)}] with {name} = [R, x]"
        rates = [x for row in rows for x in row]
    return f"d{name}/dt = {text}", dict(zip(variable.components, rates, strict=True))


def _axes(variable: Variable) -> tuple[int, ...]:
    """Where the basis has the turns about three axes, and the shifts along them; else empty."""
    action = variable.representation
    assert action is not None, variable.name
    algebra = action.algebra
    places = tuple(i for i, matrix in enumerate(action.matrices) if matrix)
    if variable.turning == "quaternion":
        return places
    if variable.turning == "pose":
        own = without_zero_places([algebra.matrices[i] for i in places])
        return places if own == algebra_by_name("se(3)").matrices else ()
    return (
        places if are_rotations(without_zero_places([algebra.matrices[i] for i in places])) else ()
    )


def _turning_part(setting: Setting, variable: Variable) -> Matrix:
    """The rotation matrix, which is all of an attitude but one column of a pose."""
    R: Matrix = setting.values[variable.name]
    return tuple(row[: len(R)] for row in R)


def _velocities(setting: Setting) -> Sequence[Element]:
    """The velocity along each vector of the basis, ``dh/dmu`` where none is declared."""
    if setting.velocities:
        return setting.elements(setting.velocities)
    return setting.field.gradient(setting.hamiltonian, setting.momenta)


def _name_velocity(setting: Setting, places: Sequence[int]) -> str:
    """What the velocity along some vectors of the basis is called."""
    for each in setting.spec.having_role("velocity"):
        if each.block == tuple(places):
            return each.name
    names = setting.velocities or [f"dh/d{name}" for name in setting.momenta]
    return f"({', '.join(names[i] for i in places)})"
