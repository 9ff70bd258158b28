"""Flows in closed form: motions by functions of coordinates that commute.

Comes in: an affine Poisson tensor and a function of coordinates x_i whose brackets with one another
are zero. These coordinates stay along its motion, ``x' = sum_i (df/dx_i) A_i x`` with constant
matrices ``A_i x = {x, x_i}``, which commute by the Jacobi identity. So the motion over a time h is
the product of ``exp(h (df/dx_i) A_i)``: kicks and drifts where A_i is nilpotent, rotations by sine
and cosine where ``A_i^3 = -k^2 A_i``. Each flow is proved: its derivative by h is the motion, and at
h = 0 it is the identity. Goes out: the state after a time h as elements.
Read next: `coadjoint.derive.splittings`, which takes an energy apart into such functions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from math import isqrt
from typing import Any

from coadjoint.algebra import LieAlgebra
from coadjoint.derive.setting import STEP
from coadjoint.errors import DerivationError
from coadjoint.exact import Element, Field, element_text

#: A sparse square matrix, row by row; the last row and column are those of the number 1.
_Matrix = Mapping[int, Mapping[int, Any]]
Vector = tuple[Element, ...]


class NoFlow(Exception):
    """No flow in closed form is known; the text says why."""


class Flows:
    """Flows of functions on an affine Poisson structure.

    Args:
        field: Has the symbol `STEP` and room for functions.
        state: Names of the coordinates.
        algebra: The brackets of the coordinates, and of the number 1 as one more of them where
            these have constant terms.
    """

    def __init__(self, field: Field, state: tuple[str, ...], algebra: LieAlgebra) -> None:
        self.field, self.state, self.algebra = field, state, algebra

    @cached_property
    def generators(self) -> tuple[_Matrix, ...]:
        """The matrix of ``x -> {x, x_i}`` for each coordinate."""
        result: list[dict[int, dict[int, Any]]] = [{} for _ in self.state]
        for (i, j), row in self.algebra.constants.items():
            if i < len(result) and j < len(result):
                result[j][i] = dict(row)
                result[i][j] = {k: -c for k, c in row.items()}
        return tuple(result)

    def commute(self, i: int, j: int) -> bool:
        """Whether two coordinates have the bracket 0."""
        return (min(i, j), max(i, j)) not in self.algebra.constants

    def is_kick(self, i: int, others: Sequence[int]) -> bool:
        """Whether motions by these coordinates are straight, also one after the other."""
        own = self.generators
        return not any(_multiply(own[i], own[j]) or _multiply(own[j], own[i]) for j in others)

    def rotates(self, i: int) -> bool:
        """Whether the motion by a coordinate needs sine and cosine."""
        square = _multiply(self.generators[i], self.generators[i])
        return bool(_multiply(square, self.generators[i]))

    def motion(self, function: Element) -> Vector:
        """``x' = {x, f}``."""
        field, slopes = self.field, self.field.gradient(function, self.state)
        values = (*field.vector(field[name] for name in self.state), field.one)
        total = [field.zero] * len(self.state)
        for slope, matrix in zip(slopes, self.generators, strict=True):
            if slope:
                for row, entry in _apply(matrix, values).items():
                    total[row] = total[row] + slope * entry
        return field.vector(total)

    def follow(self, function: Element) -> Vector:
        """The state after a time `STEP` of the motion by a function, proved.

        Raises:
            NoFlow: The coordinates of the function do not commute, or move the others by a matrix
                whose exponential is not known here.
        """
        field = self.field
        here = [i for i, name in enumerate(self.state) if name in field.reach(function)]
        for n, i in enumerate(here):
            for j in here[:n]:
                if not self.commute(i, j):
                    raise NoFlow(
                        f"{element_text(field, function)} depends on {self.state[j]} and "
                        f"{self.state[i]}, whose bracket is not zero"
                    )
        values = [field[name] for name in self.state]
        for i, slope in zip(
            here, field.gradient(function, [self.state[i] for i in here]), strict=True
        ):
            values = self._turn(values, i, field[STEP] * slope)
        flow = tuple(map(field.normal, values))
        self.check(function, flow)
        return flow

    def check(self, function: Element, flow: Vector) -> None:
        """Prove a flow.

        Raises:
            DerivationError: Its derivative is not the motion where it leads, or it does not begin
                at the identity; the message names the component.
        """
        field, there = self.field, dict(zip(self.state, flow, strict=True))
        for name, value, rate in zip(self.state, flow, self.motion(function), strict=True):
            start = field.substitute(value, {STEP: field.zero})
            moves = field.derivative(value, STEP) - field.substitute(rate, there)
            for what, gap in (("at the start", start - field[name]), ("in its rate", moves)):
                if not field.is_zero(gap):
                    raise DerivationError(
                        f"the flow of {element_text(field, function)} is wrong {what}: {name} is "
                        f"off by {element_text(field, field.normal(gap))}; expected 0.",
                        found=name,
                    )

    def _turn(self, values: Sequence[Element], i: int, time: Element) -> list[Element]:
        """``exp(time A_i)`` applied to values, block by block of the matrix."""
        field, known, result = self.field, (*values, self.field.one), list(values)
        for matrix in _blocks(self.generators[i], len(self.state)):
            square = _multiply(matrix, matrix)
            odd, even = time, time * time * Fraction(1, 2)
            if cube := _multiply(square, matrix):
                k, sine, cosine = self._find_frequency(i, matrix, cube)
                odd = field.call(sine, time * k) * (1 / k)
                even = (field.call(cosine, time * k) - field.one) * (1 / k**2)
                even = even if sine == "sinh" else -even
            for part, power in ((odd, matrix), (even, square)):
                for row, entry in _apply(power, known).items():
                    result[row] = result[row] + part * entry
        return result

    def _find_frequency(self, i: int, matrix: _Matrix, cube: _Matrix) -> tuple[Fraction, str, str]:
        """The k > 0 of ``A^3 = -k^2 A`` or ``A^3 = k^2 A``, with the functions that these need."""
        ratio: Any = None
        for row, entries in matrix.items():
            for column, entry in entries.items():
                if ratio is None:
                    ratio = cube.get(row, {}).get(column, 0) * (Fraction(1) / entry)
        rest = {(r, c) for a in (cube, matrix) for r in a for c in a[r]}
        fits = isinstance(ratio, int | Fraction) and all(
            cube.get(r, {}).get(c, 0) - ratio * matrix.get(r, {}).get(c, 0) == 0 for r, c in rest
        )
        square = abs(Fraction(ratio)) if fits else Fraction(0)
        k = Fraction(isqrt(square.numerator), isqrt(square.denominator))
        if not k or k * k != square:
            raise NoFlow(
                f"the motion by {self.state[i]} is no translation and turns by no single rational "
                "frequency: the cube of a block of its matrix is not a multiple of the block"
            )
        return (k, "sin", "cos") if ratio < 0 else (k, "sinh", "cosh")


def _blocks(matrix: _Matrix, size: int) -> list[_Matrix]:
    """A matrix as a sum of matrices that have none of so many coordinates in common."""
    groups: list[set[int]] = []
    for row, entries in matrix.items():
        joined = {row, *(n for n in entries if n < size)}
        apart = [group for group in groups if not group & joined]
        joined = joined.union(*(group for group in groups if group & joined))
        groups = [*apart, joined]
    return [{row: matrix[row] for row in sorted(group) if row in matrix} for group in groups]


def _multiply(a: _Matrix, b: _Matrix) -> dict[int, dict[int, Any]]:
    """The product of two matrices, without its zeros."""
    result: dict[int, dict[int, Any]] = {}
    for row, entries in a.items():
        sums: dict[int, Any] = {}
        for middle, left in entries.items():
            for column, right in b.get(middle, {}).items():
                sums[column] = sums.get(column, 0) + left * right
        if kept := {column: value for column, value in sums.items() if value != 0}:
            result[row] = kept
    return result


def _apply(matrix: _Matrix, values: Sequence[Element]) -> dict[int, Element]:
    """A matrix times a vector, by rows."""
    result = {}
    for row, entries in matrix.items():
        (first, *others) = (values[column] * value for column, value in entries.items())
        result[row] = sum(others, first)
    return result
