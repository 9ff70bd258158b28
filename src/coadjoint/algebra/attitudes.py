"""Attitudes: the group element itself as a quantity on which the algebra acts.

Comes in: an algebra and the side on which its motions multiply. Goes out: the `Representation` by
which an attitude is advected like anything else: a left-invariant motion ``dg/dt = g xi`` is
``dg/dt = -rho(xi) g`` with ``rho(xi) g = -g xi``, a right-invariant one ``dg/dt = xi g`` has
``rho(xi) g = xi g``. Read next: `coadjoint.derive.mechanics.reconstruction`.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from coadjoint.algebra.families import quaternion_unit
from coadjoint.algebra.lie_algebra import LieAlgebra, SparseMatrix
from coadjoint.algebra.matrices import combination, size
from coadjoint.algebra.representation import Representation, defining, two_sided
from coadjoint.errors import AlgebraError

#: [e1, e2] = e3 and cyclic: so(3), and su(2) in the basis of half the Pauli matrices.
_ROTATIONS = {(0, 1): {2: 1}, (0, 2): {1: -1}, (1, 2): {0: 1}}


def attitude(algebra: LieAlgebra, invariance: str = "left") -> Representation:
    """A matrix of the group, row by row; without a last row that stays ``(0, ..., 0, 1)``.

    For so(n) it has n x n entries; for a left-invariant motion on se(n) they are those of ``[R |
    x]``. From the other side the last row is needed, since x moves by it.

    Raises:
        AlgebraError: The algebra has no matrices.

    >>> from coadjoint.algebra import algebra_by_name
    >>> attitude(algebra_by_name("se(3)")).dimension
    12
    """
    matrices = defining(algebra, "attitude").matrices
    if invariance == "right":
        return two_sided(algebra, "attitude", matrices, ())
    height = size(matrices) - has_fixed_row(algebra)
    return two_sided(algebra, "attitude", (), matrices, height)


def has_fixed_row(algebra: LieAlgebra) -> bool:
    """Whether the last row of every matrix of the algebra is zero, so that the group's is fixed."""
    last = size(algebra.matrices) - 1
    return all(row != last for X in algebra.matrices for row, _ in X)


def turning_places(algebra: LieAlgebra) -> tuple[int, int, int] | None:
    """Where the rotations of space stand in the basis of an algebra; None if it has none.

    >>> from coadjoint.algebra import algebra_by_name
    >>> turning_places(algebra_by_name("se(3)")), turning_places(algebra_by_name("se(2)"))
    ((0, 1, 2), None)
    """
    places = tuple(algebra.blocks.get("rotation", range(algebra.dimension)))
    if len(places) != 3:
        return None
    a, b, c = places
    constants = {
        (places.index(i), places.index(j)): dict(row)
        for (i, j), row in algebra.constants.items()
        if i in places and j in places
    }
    named = {pair: {places[k]: x for k, x in row.items()} for pair, row in _ROTATIONS.items()}
    return (a, b, c) if constants == named else None


def are_rotations(matrices: Sequence[SparseMatrix]) -> bool:
    """Whether matrices turn about the three axes of space: those of ``v -> e_i x v``."""
    axes = ((2, 1), (0, 2), (1, 0))
    return list(map(dict, matrices)) == [{(i, j): 1, (j, i): -1} for i, j in axes]


def quaternion(algebra: LieAlgebra, invariance: str = "left") -> Representation:
    """A unit quaternion: ``dq/dt = q [0, xi]/2``, right-invariant ``dq/dt = [0, xi] q/2``.

    Here xi is the part along the rotations; whatever else the algebra has leaves q alone.

    Raises:
        AlgebraError: The algebra has no rotations, or another bracket reaches them.

    >>> from coadjoint.algebra import algebra_by_name
    >>> list(map(str, quaternion(algebra_by_name("so(3)")).act([0, 0, 2], [1, 0, 0, 0])))  # -q k
    ['0', '0', '0', '-1']
    """
    places = turning_places(algebra)
    if places is None or any(
        k in places
        for pair, row in algebra.constants.items()
        if not set(pair) <= set(places)
        for k in row
    ):
        raise AlgebraError(
            f"{algebra.name} has no unit quaternions; expected so(3) or su(2), a basis with "
            "[e1, e2] = e3 and cyclic, or a block 'rotation' of this kind that no other bracket "
            "reaches. Take the representation 'attitude'.",
            found=algebra.name,
        )
    side = 1 if invariance == "right" else -1
    acting: list[SparseMatrix] = [{} for _ in algebra.basis]
    for axis, place in enumerate(places):
        acting[place] = combination([(Fraction(side, 2), quaternion_unit(axis, side))])
    return Representation(algebra, "quaternion", 4, tuple(acting))
