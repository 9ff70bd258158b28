"""A finite-dimensional Lie algebra as sparse exact structure constants, with ad and ad*.

Comes in: a bracket table or a basis of matrices. Goes out: an immutable `LieAlgebra` that has
passed the Jacobi identity, which is arithmetic on the constants and nothing else.
Read next: `coadjoint.algebra.representation`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import combinations
from types import MappingProxyType
from typing import Any

from coadjoint.algebra.linear import solve_exactly
from coadjoint.errors import AlgebraError, LimitError
from coadjoint.limits import GENERATORS

#: [e_i, e_j] = sum of value * e_k over the items k: value; pairs with i < j only, zeros left out.
Constants = Mapping[tuple[int, int], Mapping[int, Fraction]]
#: A matrix as nonzero entries {(row, column): value}.
SparseMatrix = Mapping[tuple[int, int], Fraction]


def scaled(value: Any, factor: Fraction) -> Any:
    """``factor * value`` for values that know integers but not fractions, such as floats."""
    if factor.denominator == 1:
        return value * factor.numerator
    if isinstance(value, int):
        return value * factor
    return value * factor.numerator / factor.denominator


@dataclass(frozen=True)
class LieAlgebra:
    """A Lie algebra with a basis: ``[e_i, e_j] = c_ij^k e_k``.

    Vectors of the algebra and covectors of its dual are plain sequences of ``dimension`` values of
    any kind that adds and multiplies.

    Attributes:
        name: As books write it, ``so(3)``, or the name of the spec that declared it.
        basis: Names of the basis vectors.
        constants: ``{(i, j): {k: c_ij^k}}`` for i < j, exact, zeros left out.
        blocks: Named runs of the basis, e.g. ``rotation`` and ``translation`` of se(3).
        matrices: A matrix for each basis vector where a matrix form is known, else empty.

    Raises:
        AlgebraError: The constants violate the Jacobi identity; the message names the triple.
    """

    name: str
    basis: tuple[str, ...]
    constants: Constants
    blocks: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    matrices: tuple[SparseMatrix, ...] = ()

    def __post_init__(self) -> None:
        frozen = {
            pair: MappingProxyType({k: c for k, c in sorted(row.items()) if c != 0})
            for pair, row in sorted(self.constants.items())
        }
        kept = {pair: row for pair, row in frozen.items() if row}
        object.__setattr__(self, "constants", MappingProxyType(kept))
        object.__setattr__(self, "blocks", MappingProxyType(dict(self.blocks)))
        if self.dimension > GENERATORS:
            raise LimitError(
                f"{self.name} has {self.dimension} generators; expected at most {GENERATORS} "
                "(GENERATORS). Declare a smaller algebra.",
                found=self.dimension,
                limit=GENERATORS,
            )
        violation = self.jacobi_violation()
        if violation is not None:
            raise AlgebraError(self._jacobi_message(*violation), triple=list(violation[0]))

    @property
    def dimension(self) -> int:
        """Number of basis vectors."""
        return len(self.basis)

    def structure(self) -> Iterator[tuple[int, int, int, Fraction]]:
        """Every nonzero ``(i, j, k, c_ij^k)``, both orders of i and j, sorted."""
        for (i, j), row in self.constants.items():
            for k, c in row.items():
                yield i, j, k, c
                yield j, i, k, -c

    def bracket(self, xi: Sequence[Any], eta: Sequence[Any]) -> tuple[Any, ...]:
        """``[xi, eta]^k = c_ij^k xi^i eta^j``."""
        result: list[Any] = [0] * self.dimension
        for i, j, k, c in self.structure():
            result[k] = result[k] + scaled(xi[i] * eta[j], c)
        return tuple(result)

    def ad(self, xi: Sequence[Any]) -> tuple[tuple[Any, ...], ...]:
        """Matrix of ``eta -> [xi, eta]``: entry ``[k][j] = c_ij^k xi^i``."""
        matrix: list[list[Any]] = [[0] * self.dimension for _ in self.basis]
        for i, j, k, c in self.structure():
            matrix[k][j] = matrix[k][j] + scaled(xi[i], c)
        return tuple(map(tuple, matrix))

    def ad_star(self, xi: Sequence[Any], mu: Sequence[Any]) -> tuple[Any, ...]:
        """``<ad*_xi mu, eta> = <mu, [xi, eta]>``, so ``(ad*_xi mu)_j = c_ij^k xi^i mu_k``.

        On so(3) this is ``mu x xi`` (Holm 2011, section 5.1.3).
        """
        result: list[Any] = [0] * self.dimension
        for i, j, k, c in self.structure():
            result[j] = result[j] + scaled(xi[i] * mu[k], c)
        return tuple(result)

    def lie_poisson_tensor(self, mu: Sequence[Any]) -> tuple[tuple[Any, ...], ...]:
        """Minus Lie-Poisson tensor ``{mu_i, mu_j} = -c_ij^k mu_k`` (left-invariant systems)."""
        matrix: list[list[Any]] = [[0] * self.dimension for _ in self.basis]
        for i, j, k, c in self.structure():
            matrix[i][j] = matrix[i][j] - scaled(mu[k], c)
        return tuple(map(tuple, matrix))

    def jacobi_violation(self) -> tuple[tuple[int, int, int], dict[int, Fraction]] | None:
        """The first i < j < k with ``[e_i, [e_j, e_k]] + cyclic != 0`` and that sum, or None.

        Only brackets that are there are visited: the time goes with the nonzero constants, not with
        the cube of the dimension.
        """
        acting: dict[int, list[tuple[int, int, Fraction]]] = {}
        for a, m, n, constant in self.structure():
            acting.setdefault(m, []).append((a, n, constant))  # [e_a, e_m] = constant e_n + ...
        defects: dict[tuple[int, int, int], dict[int, Fraction]] = {}
        for (b, c), row in self.constants.items():
            for m, inner in row.items():
                for a, n, outer in acting.get(m, []):
                    if a in (b, c):
                        continue  # a triple with two equal members satisfies the identity
                    triple = (min(a, b), a + b + c - min(a, b) - max(a, c), max(a, c))
                    defect = defects.setdefault(triple, {})
                    # [e_j, [e_k, e_i]] has the pair the other way round
                    sign = -1 if b < a < c else 1
                    defect[n] = defect.get(n, Fraction(0)) + sign * inner * outer
        for triple, sums in sorted(defects.items()):
            left = {n: value for n, value in sums.items() if value != 0}
            if left:
                return triple, left
        return None

    def _jacobi_message(self, triple: tuple[int, int, int], defect: dict[int, Fraction]) -> str:
        a, b, c = (self.basis[i] for i in triple)
        total = " + ".join(f"({value}) {self.basis[k]}" for k, value in sorted(defect.items()))
        return (
            f"{self.name}: the brackets violate the Jacobi identity: "
            f"[{a}, [{b}, {c}]] + cyclic = {total}; expected 0. "
            f"Check the signs of the brackets between {a}, {b} and {c}."
        )


def from_brackets(
    name: str,
    basis: Sequence[str],
    brackets: Mapping[tuple[int, int], Mapping[int, Fraction | int]],
    blocks: Mapping[str, tuple[int, ...]] | None = None,
    matrices: tuple[SparseMatrix, ...] = (),
) -> LieAlgebra:
    """A Lie algebra from the brackets of its basis, each pair given once in either order.

    Args:
        name: Name for messages and documents.
        basis: Names of the basis vectors.
        brackets: ``{(i, j): {k: c_ij^k}}``; pairs left out commute.
        blocks: Named runs of the basis.
        matrices: A faithful matrix form, if there is one.

    Raises:
        AlgebraError: A pair is given twice or a bracket ``[e_i, e_i]`` is not zero, or the Jacobi
            identity fails.
    """
    constants: dict[tuple[int, int], dict[int, Fraction]] = {}
    for (i, j), row in brackets.items():
        if i == j:
            raise AlgebraError(
                f"{name}: [{basis[i]}, {basis[i]}] is declared; a bracket with itself is zero. "
                "Remove it.",
                pair=[basis[i], basis[j]],
            )
        pair, sign = ((i, j), 1) if i < j else ((j, i), -1)
        if pair in constants:
            raise AlgebraError(
                f"{name}: the bracket of {basis[i]} and {basis[j]} is declared twice; "
                "expected once, in either order.",
                pair=[basis[i], basis[j]],
            )
        constants[pair] = {k: sign * Fraction(c) for k, c in row.items()}
    return LieAlgebra(name, tuple(basis), constants, blocks or {}, matrices)


def from_matrices(
    name: str,
    basis: Sequence[str],
    matrices: Sequence[SparseMatrix],
    blocks: Mapping[str, tuple[int, ...]] | None = None,
) -> LieAlgebra:
    """The Lie algebra spanned by matrices under the commutator, by an exact linear solve.

    Raises:
        AlgebraError: The matrices are linearly dependent, or a commutator leaves their span.
    """
    pairs = list(combinations(range(len(basis)), 2))
    products = [commutator(matrices[i], matrices[j]) for i, j in pairs]
    solved = solve_exactly(matrices, products)
    if solved is None:
        raise AlgebraError(
            f"{name}: the matrices of the basis are linearly dependent; expected a basis. "
            "Remove the redundant ones.",
            basis=list(basis),
        )
    brackets = {}
    for (i, j), product, coordinates in zip(pairs, products, solved, strict=True):
        if coordinates is None:
            raise AlgebraError(
                f"{name}: the commutator of {basis[i]} and {basis[j]} is not in the span of the "
                f"basis; it has the entries {_entries(product)}. Add what is missing to the "
                "basis.",
                pair=[basis[i], basis[j]],
            )
        brackets[i, j] = {k: c for k, c in enumerate(coordinates) if c != 0}
    return from_brackets(name, basis, brackets, blocks, tuple(dict(m) for m in matrices))


def commutator(a: SparseMatrix, b: SparseMatrix) -> dict[tuple[int, int], Fraction]:
    """``a b - b a`` of sparse matrices."""
    result: dict[tuple[int, int], Fraction] = {}
    for left, right, sign in ((a, b, 1), (b, a, -1)):
        for (row, middle), x in left.items():
            for (other, column), y in right.items():
                if middle == other:
                    value = result.get((row, column), Fraction(0)) + sign * x * y
                    result[row, column] = value
    return {place: value for place, value in result.items() if value != 0}


def _entries(matrix: SparseMatrix) -> str:
    """Nonzero entries for a message, places counted from 1."""
    return ", ".join(f"({r + 1}, {c + 1}): {value}" for (r, c), value in sorted(matrix.items()))
