"""Representations of a Lie algebra on a vector space, their duals, and the diamond operator.

Comes in: one matrix per basis vector. Goes out: an immutable `Representation` whose matrices have
been checked to commute like the algebra. Read next: `coadjoint.algebra.products`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import Any

from coadjoint.algebra.lie_algebra import LieAlgebra, multiply_constant, wrong_commutators
from coadjoint.algebra.matrices import (
    Matrix,
    SparseMatrix,
    convert_entries,
    entries_text,
    kronecker,
    size,
    take_image,
)
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
        for i, j, result, expected in wrong_commutators(self.algebra, self.matrices):
            a, b = self.algebra.basis[i], self.algebra.basis[j]
            raise AlgebraError(
                f"representation {self.name!r} of {self.algebra.name}: the matrices of {a} and "
                f"{b} do not commute like [{a}, {b}]: rho({a}) rho({b}) - rho({b}) rho({a}) "
                f"has the entries {entries_text(result) or 'none'}; expected "
                f"{entries_text(expected) or 'none'}. Check the matrices of {a} and {b}.",
                pair=[a, b],
                found=entries_text(result),
                expected=entries_text(expected),
            )

    def act(self, xi: Sequence[Any], a: Sequence[Any]) -> tuple[Any, ...]:
        """``rho(xi) a``; for the vector representation of so(3) it is ``xi x a``."""
        result: list[Any] = [0] * self.dimension
        for i, matrix in enumerate(self.matrices):
            for (row, column), value in sorted(matrix.items()):
                result[row] = result[row] + multiply_constant(xi[i] * a[column], value)
        return tuple(result)

    def diamond(self, b: Sequence[Any], a: Sequence[Any]) -> tuple[Any, ...]:
        """The covector ``b <> a`` of g* with ``<b <> a, eta> = -<b, rho(eta) a>``.

        ``b`` is in the dual of W (a derivative by ``a``). For the vector representation of so(3) it
        is ``b x a``, the torque of the heavy top (Holm 2011, section 8.2).
        """
        result: list[Any] = [0] * self.algebra.dimension
        for i, matrix in enumerate(self.matrices):
            for (row, column), value in sorted(matrix.items()):
                result[i] = result[i] - multiply_constant(b[row] * a[column], value)
        return tuple(result)

    def over(
        self, convert: Callable[[Any], Any], algebra: LieAlgebra | None = None
    ) -> Representation:
        """The same representation with entries that hold parameters converted; rationals stay.

        Args:
            convert: As in `LieAlgebra.over`.
            algebra: The converted algebra, where it is at hand already.

        Raises:
            AlgebraError: It is another one, and the matrices do not represent it.
        """
        matrices = tuple(convert_entries(matrix, convert) for matrix in self.matrices)
        image = self.algebra.over(convert)
        if algebra is not None and algebra.constants != image.constants:
            return Representation(algebra, self.name, self.dimension, matrices)
        return take_image(self, algebra=algebra or image, matrices=matrices)

    def dual(self, name: str = "") -> Representation:
        """The contragredient action on W*: ``rho*(xi) = -rho(xi)^T``."""
        turned = tuple({(c, r): -v for (r, c), v in matrix.items()} for matrix in self.matrices)
        title = name or f"dual of {self.name}"
        return Representation(self.algebra, title, self.dimension, turned)


def adjoint(algebra: LieAlgebra) -> Representation:
    """``rho(xi) = ad_xi`` on the algebra itself."""
    matrices: list[Matrix] = [{} for _ in algebra.basis]
    for i, j, k, c in algebra.structure():
        matrices[i][k, j] = c
    return Representation(algebra, "adjoint", algebra.dimension, tuple(matrices))


def coadjoint(algebra: LieAlgebra) -> Representation:
    """``rho(xi) = -ad*_xi`` on the dual, the left action that Ad*_{g^-1} generates."""
    return adjoint(algebra).dual("coadjoint")


def trivial(algebra: LieAlgebra) -> Representation:
    """``rho = 0`` on R."""
    return Representation(algebra, "trivial", 1, ({},) * algebra.dimension)


def defining(algebra: LieAlgebra, name: str = "vector") -> Representation:
    """The algebra's own matrices acting on column vectors.

    Raises:
        AlgebraError: The algebra was declared by brackets and has no matrices.
    """
    if not algebra.matrices:
        declared = "a bracket of matrices" if algebra.elements else "brackets"
        raise AlgebraError(
            f"{algebra.name} is declared by {declared} and has no matrices, so it has no {name!r} "
            "representation. Declare the algebra by matrices, or declare the representation.",
            algebra=algebra.name,
        )
    return Representation(algebra, name, size(algebra.matrices), algebra.matrices)


def columns(algebra: LieAlgebra) -> Representation:
    """``A -> X A`` on n x n matrices A, row by row: n copies of the defining representation."""
    return two_sided(algebra, "columns", defining(algebra, "columns").matrices, ())


def rows(algebra: LieAlgebra) -> Representation:
    """``A -> -A X`` on n x n matrices A, row by row: the dual action on each row.

    The attitude of a left-invariant system moves so: ``dA/dt = -rho(xi) A = A xi``.
    """
    return two_sided(algebra, "rows", (), defining(algebra, "rows").matrices)


def two_sided(
    algebra: LieAlgebra,
    name: str,
    left: Sequence[SparseMatrix],
    right: Sequence[SparseMatrix],
    height: int = 0,
) -> Representation:
    """``A -> L A - A R`` on matrices A, row by row: how ``A = A1^-1 A2`` sees both bodies turn.

    Args:
        algebra: The acting algebra.
        name: Name of the representation.
        left: L of each basis vector, or none: A is square then.
        right: R of each basis vector, or none.
        height: Rows of A where there is no L; by default as many as R has.

    >>> from coadjoint.algebra import algebra_by_name
    >>> turn = algebra_by_name("so(2)").matrices
    >>> two_sided(algebra_by_name("so(2)"), "both", turn, turn).act([1], [1, 0, 0, 1])
    (0, 0, 0, 0)
    """
    height, width = height or size(left or right), size(right or left)
    ones = {n: {(i, i): 1 for i in range(n)} for n in (height, width)}
    matrices: list[Matrix] = [{} for _ in algebra.basis]
    for matrix, L in zip(matrices, left, strict=False):
        matrix.update(kronecker(L, ones[width], width))
    for matrix, R in zip(matrices, right, strict=False):
        turned = {(c, r): -value for (r, c), value in R.items()}
        for place, value in kronecker(ones[height], turned, width).items():
            matrix[place] = matrix.get(place, 0) + value
    clean = tuple({place: v for place, v in matrix.items() if v != 0} for matrix in matrices)
    return Representation(algebra, name, height * width, clean)


def symmetric(algebra: LieAlgebra) -> Representation:
    """``S -> X S + S X^T`` on symmetric matrices, components ``S_ij``, i <= j, row by row.

    ``Ad_A`` of the group acts as ``S -> A S A^T``.
    """
    vectors = defining(algebra, "symmetric")
    places = list(combinations_with_replacement(range(vectors.dimension), 2))
    number = {place: n for n, place in enumerate(places)}
    matrices: list[Matrix] = []
    for X in vectors.matrices:
        moved: Matrix = {}
        for (row, middle), x in X.items():
            for other in range(vectors.dimension):
                # (X S)_(row, other) has the term x S_(middle, other); X S + (X S)^T on the
                # diagonal is twice that.
                at = (
                    number[min(row, other), max(row, other)],
                    number[min(middle, other), max(middle, other)],
                )
                moved[at] = moved.get(at, 0) + (2 * x if row == other else x)
        matrices.append({at: x for at, x in moved.items() if x != 0})
    return Representation(algebra, "symmetric", len(places), tuple(matrices))
