"""Representations of a Lie algebra on a vector space, their duals, and the diamond operator.

Comes in: one matrix per basis vector. Goes out: an immutable `Representation` whose matrices have
been checked to commute like the algebra. Read next: `coadjoint.algebra.products`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations
from typing import Any

from coadjoint.algebra.lie_algebra import LieAlgebra, SparseMatrix, commutator, scaled
from coadjoint.errors import AlgebraError


@dataclass(frozen=True)
class Representation:
    """A linear action ``rho(e_i)`` of an algebra on a space W of advected quantities.

    Attributes:
        algebra: The acting algebra.
        name: ``vector``, ``adjoint``, ``coadjoint`` or the declared name.
        dimension: Dimension of W.
        matrices: ``rho(e_i)`` for each basis vector, sparse and exact.

    Raises:
        AlgebraError: ``rho([e_i, e_j]) != [rho(e_i), rho(e_j)]`` for some pair.
    """

    algebra: LieAlgebra
    name: str
    dimension: int
    matrices: tuple[SparseMatrix, ...]

    def __post_init__(self) -> None:
        for i, j in combinations(range(self.algebra.dimension), 2):
            expected: dict[tuple[int, int], Fraction] = {}
            for k, c in self.algebra.constants.get((i, j), {}).items():
                for place, value in self.matrices[k].items():
                    expected[place] = expected.get(place, Fraction(0)) + c * value
            expected = {place: value for place, value in expected.items() if value != 0}
            if expected != commutator(self.matrices[i], self.matrices[j]):
                a, b = self.algebra.basis[i], self.algebra.basis[j]
                raise AlgebraError(
                    f"representation {self.name!r} of {self.algebra.name}: the matrices of {a} and "
                    f"{b} do not commute like [{a}, {b}]. Check the matrices of {a} and {b}.",
                    pair=[a, b],
                )

    def act(self, xi: Sequence[Any], a: Sequence[Any]) -> tuple[Any, ...]:
        """``rho(xi) a``; for the vector representation of so(3) it is ``xi x a``."""
        result: list[Any] = [0] * self.dimension
        for i, matrix in enumerate(self.matrices):
            for (row, column), value in sorted(matrix.items()):
                result[row] = result[row] + scaled(xi[i] * a[column], value)
        return tuple(result)

    def diamond(self, b: Sequence[Any], a: Sequence[Any]) -> tuple[Any, ...]:
        """The covector ``b <> a`` of g* with ``<b <> a, eta> = -<b, rho(eta) a>``.

        ``b`` is in the dual of W (a derivative by ``a``). For the vector representation of so(3) it
        is ``b x a``, the torque of the heavy top (Holm 2011, section 8.2).
        """
        result: list[Any] = [0] * self.algebra.dimension
        for i, matrix in enumerate(self.matrices):
            for (row, column), value in sorted(matrix.items()):
                result[i] = result[i] - scaled(b[row] * a[column], value)
        return tuple(result)

    def dual(self) -> Representation:
        """The contragredient action on W*: ``rho*(xi) = -rho(xi)^T``."""
        turned = tuple({(c, r): -v for (r, c), v in matrix.items()} for matrix in self.matrices)
        return Representation(self.algebra, f"dual of {self.name}", self.dimension, turned)


def adjoint(algebra: LieAlgebra) -> Representation:
    """``rho(xi) = ad_xi`` on the algebra itself."""
    matrices: list[dict[tuple[int, int], Fraction]] = [{} for _ in algebra.basis]
    for i, j, k, c in algebra.structure():
        matrices[i][k, j] = c
    return Representation(algebra, "adjoint", algebra.dimension, tuple(matrices))


def coadjoint(algebra: LieAlgebra) -> Representation:
    """``rho(xi) = -ad*_xi`` on the dual, the left action that Ad*_{g^-1} generates."""
    dual = adjoint(algebra).dual()
    return Representation(algebra, "coadjoint", dual.dimension, dual.matrices)


def defining(algebra: LieAlgebra) -> Representation:
    """The algebra's own matrices acting on column vectors.

    Raises:
        AlgebraError: The algebra was declared by brackets and has no matrices.
    """
    if not algebra.matrices:
        raise AlgebraError(
            f"{algebra.name} is declared by brackets and has no matrices, so it has no 'vector' "
            "representation. Declare the algebra by matrices, or declare the representation.",
            algebra=algebra.name,
        )
    size = 1 + max(max(place) for matrix in algebra.matrices for place in matrix)
    return Representation(algebra, "vector", size, algebra.matrices)
