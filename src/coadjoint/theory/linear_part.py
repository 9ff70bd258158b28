"""The linear part of a group: rotations, isometries of a form, or all invertible matrices.

Comes in: values of free symbols. Goes out: a matrix of the group whose entries are rational in
them, its inverse, and what keeps a given matrix out of the group. Each chart covers a neighbourhood
of 1, so an identity between rational functions that holds in it holds on the connected group.
Read next: `coadjoint.theory.group`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from coadjoint.algebra.matrices import SparseMatrix
from coadjoint.exact.dense import (
    Matrix,
    add,
    commutator,
    identity,
    inverse,
    product,
    scale,
    subtract,
    transpose,
    weighted_sum,
)
from coadjoint.theory.matrix import determinant, resolvent

#: What a matrix of the group must be, as ``(statement, matrix that must be zero)``.
Condition = tuple[str, Matrix]


class LinearPart(Protocol):
    """What a group must know of its linear part; all matrices have the size of the group's."""

    @property
    def symbols(self) -> tuple[str, ...]:
        """Names of the coordinates of the chart, without the element's own prefix."""

    @property
    def blocks(self) -> tuple[int, ...]:
        """The number of the invariant block that each axis belongs to."""

    def point(self, values: Sequence[Any]) -> Matrix:
        """The matrix at the given coordinates."""

    def inverse(self, g: Matrix) -> Matrix:
        """``g^-1`` of a matrix of this part."""

    def conditions(self, g: Matrix) -> Iterator[Condition]:
        """Matrices that vanish if and only if `g` belongs to this part."""


@dataclass(frozen=True)
class Isometries:
    """Linear maps that keep a bilinear form, ``g^T K g = K``: SO(n), SO(p,q), Sp(2n), U(n), SU(n).

    The chart is the Cayley transform ``(1 - X)^-1 (1 + X)`` with X in the algebra. Its derivative
    at 0 is twice the identity. For SU(n) one complex column is multiplied by ``d / conj(d)`` with
    ``d = det(1 - X)``, which has modulus 1 and makes the determinant 1.

    Attributes:
        size: Size of the matrices.
        symbols: Names of the generators.
        generators: Matrices of the algebra.
        form: K, a matrix whose square is 1 or -1, so that its inverse is its transpose.
        structure: J with ``J^2 = -1`` that the group commutes with, where its matrices are complex.
        commuting: What else the group commutes with.
        special: Whether the (complex, where there is a structure) determinant must be 1.
        column: The complex axis that carries the phase of SU(n), as a projection; empty elsewhere.
    """

    size: int
    symbols: tuple[str, ...]
    generators: tuple[SparseMatrix, ...]
    form: Matrix
    structure: Matrix | None = None
    commuting: tuple[Matrix, ...] = ()
    special: bool = False
    column: Matrix = ()

    @property
    def blocks(self) -> tuple[int, ...]:
        """Axes that some generator mixes belong together."""
        block = list(range(self.size))
        for generator in self.generators:
            for r, c in generator:
                a, b = sorted((block[r], block[c]))
                block = [a if n == b else n for n in block]
        return tuple(block)

    def point(self, values: Sequence[Any]) -> Matrix:
        """The Cayley transform.

        Raises:
            ZeroDivisionError: ``1 - X`` is singular.
        """
        one, J = identity(self.size), self.structure
        X = weighted_sum(values, self.generators, self.size)
        adjugate, (a, b) = resolvent(X, J)
        numerator = product(adjugate, add(one, X))
        if J is None or not b:
            return scale(1 / a, numerator)
        # 1 / d = conj(d) / |d|^2, and for the column of SU(n) d / |d|^2; divided once, at the end
        sign = subtract(one, scale(2, self.column)) if self.column else one
        whole = add(scale(a, one), scale(-b, product(J, sign)))
        return scale(1 / (a * a + b * b), product(numerator, whole))

    def inverse(self, g: Matrix) -> Matrix:
        """``K^-1 g^T K``."""
        return product(transpose(self.form), transpose(g), self.form)

    def conditions(self, g: Matrix) -> Iterator[Condition]:
        """``g^T K g = K``, what g commutes with, axes that stay, and its determinant."""
        for J in (self.structure, *self.commuting):
            if J is not None:
                yield "g J - J g, J what the group commutes with", commutator(g, J)
        yield "g^T K g - K", subtract(product(transpose(g), self.form, g), self.form)
        still = set(range(self.size)) - {n for matrix in self.generators for n in sum(matrix, ())}
        yield (
            "g - 1 on the axes that stay",
            tuple(
                tuple(x - int(r == c) if {r, c} & still else 0 for c, x in enumerate(row))
                for r, row in enumerate(g)
            ),
        )
        if self.special:
            real, imaginary = determinant(g, self.structure)
            yield "det g - 1", ((real - 1,),)
            yield "the imaginary part of det g", ((imaginary,),)


@dataclass(frozen=True)
class InvertibleMatrices:
    """GL(n, R) and SL(n, R) on the first n axes.

    The chart is the entries themselves; for SL(n) the last one follows from ``det g = 1``, in which
    it is linear: for n = 2 this is ``[[a, b], [c, (1 + b c) / a]]``.

    Attributes:
        size: Size of the matrices.
        rank: n.
        special: Whether the determinant is 1.
    """

    size: int
    rank: int
    special: bool = False

    @property
    def symbols(self) -> tuple[str, ...]:
        """Entries row by row, counted from 1."""
        names = [f"{r + 1}_{c + 1}" for r in range(self.rank) for c in range(self.rank)]
        return tuple(names[:-1] if self.special else names)

    @property
    def blocks(self) -> tuple[int, ...]:
        """The first n axes belong together."""
        return tuple(max(0, n - self.rank + 1) for n in range(self.size))

    def point(self, values: Sequence[Any]) -> Matrix:
        """The entries, the last one solved for where the determinant is 1.

        Raises:
            ZeroDivisionError: The minor that the last entry is divided by is zero.
        """
        n = self.rank
        if not self.special:
            return self._embed(values)
        # det is affine in the last entry: its slope is the minor of the others
        start = self._embed([*values, 0])
        constant = determinant(start)[0]
        minor = determinant(tuple(row[: n - 1] for row in start[: n - 1]))[0]
        return self._embed([*values, (1 - constant) / minor])

    def _embed(self, entries: Sequence[Any]) -> Matrix:
        """Entries in the upper left block, the unit matrix elsewhere."""
        rows = [list(row) for row in identity(self.size)]
        for place, entry in enumerate(entries):
            rows[place // self.rank][place % self.rank] = entry
        return tuple(map(tuple, rows))

    def inverse(self, g: Matrix) -> Matrix:
        """The adjugate over the determinant."""
        n = self.rank
        block = inverse(tuple(row[:n] for row in g[:n]))
        return self._embed([entry for row in block for entry in row])

    def conditions(self, g: Matrix) -> Iterator[Condition]:
        """The unit matrix outside the block, and the determinant."""
        n = self.rank
        inner = self._embed([entry for row in g[:n] for entry in row[:n]])
        yield "g - 1 outside the upper left block", subtract(g, inner)
        if self.special:
            yield "det g - 1", ((determinant(inner)[0] - 1,),)
