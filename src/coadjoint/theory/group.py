"""A matrix group: generic elements, AD, Ad, ad and their duals, exact in the group element.

Comes in: a `LieAlgebra` with its matrices and the linear part of the group. Goes out: actions that
are computed from those matrices alone. An element of the group is a square matrix of exact values;
a vector of the algebra and a covector of its dual are their coordinates in the basis, with
``mu_i = <mu, e_i>``. Read next: `coadjoint.theory.catalogue`, which lists the groups.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.errors import AlgebraError
from coadjoint.exact import Field, element_text
from coadjoint.exact.dense import Matrix, identity, product, subtract, transpose, weighted_sum
from coadjoint.theory.linear_part import LinearPart
from coadjoint.theory.matrix import (
    coordinate_readers,
    exponential,
    unipotent_inverse,
    unipotent_logarithm,
)

#: Coordinates in the basis of the algebra or in the dual basis.
Vector = tuple[Any, ...]


@dataclass(frozen=True)
class MatrixGroup:
    """A connected group of matrices ``g = exp(n_k e_k) ... exp(n_1 e_1) L``.

    L is a matrix of the linear part and the e_i are nilpotent: ``[[R, v], [0, 1]]`` of SE(3) is
    ``exp(v3 P3) exp(v2 P2) exp(v1 P1)`` times the rotation. Either factor may be missing.

    Attributes:
        name: As books write it, ``SE(3)``.
        algebra: Its Lie algebra, with matrices.
        linear: The linear part; its generators come first in the basis.
        nilpotent: Indices of the nilpotent basis vectors.
        field: Where the entries live.

    >>> from coadjoint.theory import matrix_group
    >>> H = matrix_group("H(1)", elements="h", vectors=["xi"])
    >>> H.element("h")
    ((1, h_A1, h_C), (0, 1, h_B1), (0, 0, 1))
    >>> H.Ad(H.element("h"), H.vector("xi"))
    (xi_A1, xi_B1, h_A1*xi_B1 - h_B1*xi_A1 + xi_C)
    """

    name: str
    algebra: LieAlgebra
    linear: LinearPart
    nilpotent: tuple[int, ...]
    field: Field

    @property
    def size(self) -> int:
        """Rows of the matrices."""
        return len(self.linear.blocks)

    # -- generic elements -----------------------------------------------------------------

    @property
    def symbols(self) -> tuple[str, ...]:
        """Names of the coordinates of an element, without its prefix."""
        return (*self.linear.symbols, *(self.algebra.basis[i] for i in self.nilpotent))

    def element(self, prefix: str) -> Matrix:
        """The generic element in the symbols ``prefix_...`` of the field.

        It runs through a neighbourhood of 1 (in fact a dense set), so that a rational identity
        proved for it holds on the whole connected group.
        """
        return self.point([self.field[f"{prefix}_{symbol}"] for symbol in self.symbols])

    def vector(self, prefix: str) -> Vector:
        """The generic vector or covector in the symbols ``prefix_...``, one for each generator."""
        return tuple(self.field[f"{prefix}_{name}"] for name in self.algebra.basis)

    def point(self, values: Sequence[Any]) -> Matrix:
        """The element with the given coordinates, in the order of `symbols`.

        Raises:
            AlgebraError: Their number is wrong, or the chart has no element there.
        """
        self._check_length(values, self.symbols, "coordinates of an element")
        count = len(self.linear.symbols)
        try:
            g = self.linear.point(values[:count])
        except ZeroDivisionError:
            raise AlgebraError(
                f"{self.name}: the chart has no element at {', '.join(map(str, values[:count]))}; "
                "expected coordinates where its denominator is not 0. Move one of them.",
                found=[str(value) for value in values[:count]],
            ) from None
        for i, value in zip(self.nilpotent, values[count:], strict=True):
            step = weighted_sum([value], [self.algebra.matrices[i]], self.size)
            g = product(exponential(step), g)
        return tuple(self.field.vector(row) for row in g)

    # -- the group ------------------------------------------------------------------------

    def inverse(self, g: Matrix) -> Matrix:
        """``g^-1 = L^-1 u^-1`` with ``g = u L``, by the linear part's own inverse.

        Raises:
            AlgebraError: g is not in the group, where that inverse would be something else.
        """
        self.check_element(g)
        L_inverse = self.linear.inverse(self._linear_part(g))
        if not self.nilpotent:
            return L_inverse
        return product(L_inverse, unipotent_inverse(product(g, L_inverse)))

    def _linear_part(self, g: Matrix) -> Matrix:
        """L of ``g = u L``: the diagonal blocks."""
        block = self.linear.blocks
        return tuple(
            tuple(x if block[r] == block[c] else 0 for c, x in enumerate(row))
            for r, row in enumerate(g)
        )

    def AD(self, g: Matrix, h: Matrix) -> Matrix:
        """``AD_g h = g h g^-1`` (Holm 2011, section 4.2)."""
        return product(g, h, self.inverse(g))

    def Ad(self, g: Matrix, eta: Sequence[Any]) -> Vector:
        """``Ad_g eta = g eta g^-1``.

        Raises:
            AlgebraError: g is not in the group.
        """
        return self.coordinates(product(g, self.matrix(eta), self.inverse(g)))

    def Ad_matrix(self, g: Matrix) -> Matrix:
        """The matrix of ``Ad_g`` in the basis: its column j holds ``Ad_g e_j``."""
        inverse, columns = self.inverse(g), []
        for j in range(self.algebra.dimension):
            unit = weighted_sum([1], [self.algebra.matrices[j]], self.size)
            columns.append(self.coordinates(product(g, unit, inverse)))
        return transpose(tuple(columns))

    def Ad_star(self, g: Matrix, mu: Sequence[Any]) -> Vector:
        """``<Ad*_g mu, eta> = <mu, Ad_g eta>``; the left action on covectors is ``Ad*_(g^-1)``."""
        self._check_length(mu, self.algebra.basis, "components of a covector")
        return tuple(
            self.field.zero + sum(m * a for m, a in zip(mu, column, strict=True))
            for column in transpose(self.Ad_matrix(g))
        )

    def ad(self, xi: Sequence[Any], eta: Sequence[Any]) -> Vector:
        """``ad_xi eta = [xi, eta]``, by the structure constants."""
        return self.field.vector(self.algebra.bracket(xi, eta))

    def ad_star(self, xi: Sequence[Any], mu: Sequence[Any]) -> Vector:
        """``<ad*_xi mu, eta> = <mu, ad_xi eta>``, by the structure constants."""
        return self.field.vector(self.algebra.ad_star(xi, mu))

    # -- matrices and coordinates ---------------------------------------------------------

    def matrix(self, xi: Sequence[Any]) -> Matrix:
        """``xi^i e_i`` as a matrix."""
        self._check_length(xi, self.algebra.basis, "components of a vector")
        return weighted_sum(xi, self.algebra.matrices, self.size)

    def coordinates(self, matrix: Matrix) -> Vector:
        """The ``xi^i`` of a matrix of the algebra.

        Raises:
            AlgebraError: The matrix has the wrong size or is not in the algebra; the message names
                the first entry that differs from that of the nearest combination of the basis.
        """
        self._check_size(matrix)
        xi = [
            self.field.zero + sum(matrix[r][c] * weight for (r, c), weight in reader.items())
            for reader in self._readers
        ]
        left = subtract(matrix, weighted_sum(xi, self.algebra.matrices, self.size))
        self._check_zero(f"is not in {self.algebra.name}", "X - xi^i e_i", left)
        return tuple(xi)

    @cached_property
    def _readers(self) -> list[Any]:
        """Which entries give which coordinate."""
        readers = coordinate_readers(self.algebra.matrices) if self.algebra.matrices else None
        if readers is None or len(readers) != self.algebra.dimension:
            raise AlgebraError(
                f"{self.name}: {self.algebra.name} carries no independent matrices; expected one "
                "for each basis vector. Declare the algebra by matrices.",
                algebra=self.algebra.name,
            )
        return readers

    # -- what belongs to the group --------------------------------------------------------

    def check_element(self, g: Matrix) -> None:
        """Refuse a matrix that is not in the group.

        For SO(p,q) with p, q > 0 the conditions hold on the other component with determinant 1 too.

        Raises:
            AlgebraError: The size is wrong, or a condition fails; the message names the condition,
                the entry and what stands there.
        """
        self._check_size(g)
        L = self._linear_part(g)
        for statement, defect in self.linear.conditions(L):
            self._check_zero(f"is not in {self.name}", statement, defect)
        try:
            u = product(g, self.linear.inverse(L))
        except ZeroDivisionError:
            raise AlgebraError(
                f"{self.name}: the matrix has determinant 0; expected an invertible one.",
                group=self.name,
                found="0",
            ) from None
        if self.nilpotent:
            self._check_unipotent(u)

    def _check_unipotent(self, u: Matrix) -> None:
        """Refuse ``u`` of ``g = u L`` unless its logarithm is in the span of the nilpotent part."""
        reached = self._nilpotent_places
        rest = subtract(u, identity(self.size))
        outside = tuple(
            tuple(0 if (r, c) in reached else x for c, x in enumerate(row))
            for r, row in enumerate(rest)
        )
        self._check_zero(f"is not in {self.name}", "g L^-1 - 1, L its diagonal blocks,", outside)
        n = self.coordinates(unipotent_logarithm(u))
        along = tuple(x for i, x in enumerate(n) if i not in self.nilpotent)
        self._check_zero(f"is not in {self.name}", "log(g L^-1) along the linear part", (along,))

    @cached_property
    def _nilpotent_places(self) -> frozenset[tuple[int, int]]:
        """Where products of nilpotent generators may have entries."""
        places = {place for i in self.nilpotent for place in self.algebra.matrices[i]}
        while True:
            more = {(r, d) for r, c in places for b, d in places if b == c} - places
            if not more:
                return frozenset(places)
            places |= more

    def _check_zero(self, verdict: str, statement: str, defect: Matrix) -> None:
        """Refuse a matrix that should be zero, naming its first entry that is not."""
        for r, row in enumerate(defect):
            for c, value in enumerate(row):
                element = self.field.zero + value
                if not self.field.is_zero(element):
                    result = element_text(self.field, element)
                    raise AlgebraError(
                        f"{self.name}: the matrix {verdict}: entry ({r + 1}, {c + 1}) of "
                        f"{statement} is {result[:200]}; expected 0. Check that entry's sign and "
                        "the order of the basis.",
                        group=self.name,
                        entry=[r + 1, c + 1],
                        found=result,
                    )

    def _check_size(self, matrix: Matrix) -> None:
        sizes = {len(matrix), *map(len, matrix)}
        if sizes != {self.size}:
            result = f"{len(matrix)} x {'/'.join(map(str, sorted(set(map(len, matrix)))))}"
            raise AlgebraError(
                f"{self.name}: the matrix is {result}; expected {self.size} x {self.size}.",
                group=self.name,
                found=result,
                expected=self.size,
            )

    def _check_length(self, values: Sequence[Any], names: Iterable[str], what: str) -> None:
        expected = list(names)
        if len(values) != len(expected):
            raise AlgebraError(
                f"{self.name}: {len(values)} {what}; expected {len(expected)}: "
                f"{', '.join(expected)}.",
                group=self.name,
                found=len(values),
                expected=len(expected),
            )
