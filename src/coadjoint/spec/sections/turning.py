"""Turning: attitudes, quaternions and poses, group elements that are part of the state.

Comes in: the keys of a variable with such a role. Goes out: the advected quantity that it is, its
shape, and where it begins. An attitude is a rotation matrix R, a pose is ``[R, x]`` with the
position x, and a quaternion has length 1.
Read next: `coadjoint.spec.sections.variables`.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import isqrt
from types import MappingProxyType
from typing import Any

from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.algebra.representation import Representation
from coadjoint.exact.dense import Matrix, determinant, dot, identity, product, transpose
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.values import read_default

#: Roles of the group element itself, each with the representation by which it is advected.
TURNING = MappingProxyType({"attitude": "attitude", "quaternion": "quaternion", "pose": "attitude"})
#: How far a default may be from a rotation: entries are decimals of some digits.
NEAR = Fraction(1, 10**6)
_EXPECTED = {
    "attitude": "an algebra of rotations, such as so(3), or a block of rotations",
    "quaternion": "a quaternion of length 1, such as [1, 0, 0, 0]",
    "pose": "an algebra of rotations and translations in body axes, such as se(3)",
}
_ROTATION = "a matrix with orthonormal rows and determinant 1"


def advect(part: Any, algebra: LieAlgebra) -> Any:
    """The keys of the advected quantity that an attitude, a quaternion or a pose is.

    An attitude is that of the block of rotations, where the algebra has one.
    """
    block = part.block
    if block is None and part.role == "attitude" and "rotation" in algebra.blocks:
        own = algebra.blocks["rotation"]
        block = "rotation" if len(own) < algebra.dimension else None
    return part.model_copy(
        update={"role": "advected", "representation": TURNING[part.role], "block": block}
    )


def find_shape(
    source: Source, key: KeyPath, role: str, action: Representation, invariance: str
) -> Shape:
    """``(4,)`` of a quaternion, ``(n, n)`` of an attitude, ``(n, n + 1)`` of a pose.

    Raises:
        SpecError: The matrices of the algebra are not those of rotations, or of rigid motions.
    """
    if role == "quaternion":
        return (4,)
    rows = isqrt(action.dimension)
    columns = rows + (role == "pose")
    turns = all(
        matrix.get((j, i), 0) == -value
        for matrix in action.matrices
        for (i, j), value in matrix.items()
        if role == "attitude" or (i + 1) % columns  # x is moved along R, and turns nothing
    )
    mirrored = role == "pose" and invariance == "right"
    if rows * columns != action.dimension or not turns or mirrored:
        problem = f"{action.algebra.name} has no {role}, found {key[1]!r}"
        hint = 'For another group write role = "advected" and representation = "attitude".'
        raise source.at_key((*key, "role"), problem, role, _EXPECTED[role], hint)
    return (rows, columns)


def read_rotation(
    source: Source, key: KeyPath, value: object, shape: Shape, *, role: str
) -> tuple[Fraction, ...]:
    """Where it begins: the identity, or what is declared.

    Raises:
        SpecError: That is no rotation.
    """
    declared = read_default(source, key, value, shape)
    if declared is None:
        ones = identity(shape[0])
        rows = (
            ((1, 0, 0, 0),)
            if role == "quaternion"
            else ((*row, *([0] * (shape[1] - shape[0]))) for row in ones)
        )
        return tuple(Fraction(x) for row in rows for x in row)
    if not _is_rotation(role, shape, declared):
        problem = f"the default of {str(key[-2])!r} is no rotation"
        expected = _EXPECTED[role] if role == "quaternion" else _ROTATION
        hint = "Leave it out to begin at the identity."
        raise source.fault(key, problem, str(value), expected, hint)
    return declared


def _is_rotation(role: str, shape: Shape, entries: Sequence[Fraction]) -> bool:
    """Whether rows are orthonormal and right-handed, or a quaternion has length 1."""
    if role == "quaternion":
        return abs(dot(entries, entries) - 1) < NEAR
    rows, columns = shape
    R: Matrix = tuple(tuple(entries[i * columns : i * columns + rows]) for i in range(rows))
    defects = (
        x - y
        for row, ones in zip(product(R, transpose(R)), identity(rows), strict=True)
        for x, y in zip(row, ones, strict=True)
    )
    return all(abs(x) < NEAR for x in defects) and determinant(R) > 0
