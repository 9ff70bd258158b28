"""Lie algebras by name, with the blocks, matrices and representations that books give them.

Comes in: a name as a spec writes it. Goes out: a `LieAlgebra` and its named representations.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from difflib import get_close_matches
from fractions import Fraction
from functools import cache
from types import MappingProxyType

from coadjoint.algebra.lie_algebra import LieAlgebra, SparseMatrix, from_matrices
from coadjoint.algebra.representation import Representation, adjoint, coadjoint, defining
from coadjoint.errors import AlgebraError


def _hat(axis: int) -> dict[tuple[int, int], Fraction]:
    """``hat(e_axis)_ij = -epsilon_ijk``, so that ``hat(a) b = a x b`` (Holm 2011, 2.1.1)."""
    j, k = (axis + 1) % 3, (axis + 2) % 3
    return {(k, j): Fraction(1), (j, k): Fraction(-1)}


@cache
def so3() -> LieAlgebra:
    """Rotations of R^3, spanned by the hat matrices: ``[J_i, J_j] = epsilon_ijk J_k``."""
    matrices = [_hat(axis) for axis in range(3)]
    return from_matrices("so(3)", ("J1", "J2", "J3"), matrices, {"rotation": (0, 1, 2)})


@cache
def se3() -> LieAlgebra:
    """Rigid motions of R^3 by 4 x 4 matrices ``[[hat xi, alpha], [0, 0]]`` (Holm 2011, 1.6)."""
    matrices: list[SparseMatrix] = [_hat(axis) for axis in range(3)]
    matrices += [{(axis, 3): Fraction(1)} for axis in range(3)]
    basis = ("J1", "J2", "J3", "P1", "P2", "P3")
    blocks = {"rotation": (0, 1, 2), "translation": (3, 4, 5)}
    return from_matrices("se(3)", basis, matrices, blocks)


CATALOGUE: Mapping[str, Callable[[], LieAlgebra]] = MappingProxyType({"so(3)": so3, "se(3)": se3})


def algebra_by_name(name: str) -> LieAlgebra:
    """The algebra that a spec names.

    Raises:
        AlgebraError: No algebra of that name; the message lists what there is.

    >>> algebra_by_name("se(3)").blocks["translation"]
    (3, 4, 5)
    """
    if name in CATALOGUE:
        return CATALOGUE[name]()
    near = get_close_matches(name, CATALOGUE, n=1)
    hint = f"Did you mean {near[0]!r}?" if near else "Declare it by brackets or matrices."
    raise AlgebraError(
        f"no algebra is called {name!r}; expected one of {', '.join(CATALOGUE)}. {hint}", found=name
    )


def representation_by_name(algebra: LieAlgebra, name: str) -> Representation:
    """A representation that every algebra has, by the name a spec uses.

    ``vector`` is the action of the rotation block on R^3 for so(3) and se(3) (translations act as
    zero), and the defining matrices for an algebra declared by matrices.

    Raises:
        AlgebraError: No such representation.
    """
    match name:
        case "vector" if algebra.name in CATALOGUE and "rotation" in algebra.blocks:
            turning = dict(zip(algebra.blocks["rotation"], map(_hat, range(3)), strict=True))
            matrices = tuple(turning.get(i, {}) for i in range(algebra.dimension))
            return Representation(algebra, "vector", 3, matrices)
        case "vector":
            return defining(algebra)
        case "adjoint":
            return adjoint(algebra)
        case "coadjoint":
            return coadjoint(algebra)
    raise AlgebraError(
        f"{algebra.name} has no representation {name!r}; expected 'vector', 'adjoint', "
        "'coadjoint' or one declared under [representations].",
        found=name,
    )
