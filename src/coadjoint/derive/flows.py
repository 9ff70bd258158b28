"""Flows in closed form: motions by functions of coordinates that commute.

Comes in: an affine Poisson tensor and a function f of coordinates x_i whose brackets with one
another are zero. These coordinates stay along its motion ``x' = sum_i (df/dx_i) A_i x``, with
constant matrices ``A_i x = {x, x_i}`` that commute by the Jacobi identity. So the motion over a
time h is the product of ``exp(h (df/dx_i) A_i)``: kicks and drifts where A_i is nilpotent,
rotations where a block of it satisfies ``A^3 = -k^2 A``.

A rotation by an angle a takes ``t = tan(a/2)`` and ``s = 2t/(1 + t^2) = sin(a)``, and no function:
``exp = 1 + (s/k) A + (s t/k^2) A^2``. Where df/dx_i depends on x_i alone, t is the polynomial of
order 8 of the tangent: the flow is exactly that of another function of x_i, whose difference from f
is of order h^8. So it is a Poisson map for every h, and targets have the same bits. Otherwise only
the exact angle gives a Poisson map, and functions are called; so they are for frequencies of one
coordinate that are not equal or one and its double, as of a vector and a quaternion.

Each flow is proved: its derivative by its angles and by the time is the motion, and it begins at
the identity. Goes out: the state after a time h as elements.
Read next: `coadjoint.derive.splittings`, which takes an energy apart into such functions.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from math import isqrt
from typing import Any, Final

from coadjoint.algebra import LieAlgebra
from coadjoint.derive.setting import STEP
from coadjoint.errors import DerivationError
from coadjoint.exact import Element, Field, element_text

#: A sparse square matrix, row by row; the last row and column are those of the number 1.
_Matrix = Mapping[int, Mapping[int, Any]]
Vector = tuple[Element, ...]
#: Of ``tan y``, those of y, y^3, y^5 and y^7.
TANGENT: Final = (Fraction(1), Fraction(1, 3), Fraction(2, 15), Fraction(17, 315))


class NoFlowError(Exception):
    """No flow in closed form is known; the text says why."""


def list_symbols(size: int) -> tuple[str, ...]:
    """What a field needs for the flows of so many coordinates."""
    rotations = (f"_{name}{n + 1}" for n in range(size) for name in ("half", "tan", "sin"))
    return (STEP, *rotations)


@dataclass(frozen=True)
class Rotation:
    """A block of a matrix that turns.

    Attributes:
        half: Name of half its angle.
        tangent: Name of the tangent of that.
        sine: Name of the sine of the angle.
        angle: Half the angle after a time `STEP`.
        sign: 1 for a rotation, -1 for a hyperbolic one.
        is_rational: Whether the tangent is a polynomial of half the angle.
        doubled: Of a block that turns twice as fast, the tangent that it follows from; else "".
    """

    half: str
    tangent: str
    sine: str
    angle: Element
    sign: int
    is_rational: bool
    doubled: str = ""


@dataclass(frozen=True)
class Flow:
    """Where a motion leads in a time `STEP`.

    Attributes:
        values: The state there, in names of the state and of the rotations.
        rotations: What these names are.
    """

    values: Vector
    rotations: tuple[Rotation, ...] = field(default=())

    def define(self, own: Field) -> Iterator[tuple[str, Element]]:
        """The names of the rotations in the order in which they can be computed."""
        for each in self.rotations:
            half, tangent = own[each.half], own[each.tangent]
            yield each.half, each.angle
            if each.doubled:
                slow = own[each.doubled]
                yield each.tangent, slow * 2 / (own.one - slow**2)
            elif each.is_rational:
                powers = (half ** (2 * n + 1) * c for n, c in enumerate(TANGENT))
                yield each.tangent, own.sum(powers)
            elif each.sign > 0:
                yield each.tangent, own.call("sin", half) / own.call("cos", half)
            else:
                yield each.tangent, own.call("tanh", half)
            yield each.sine, tangent * 2 / (own.one + tangent**2 * each.sign)


class Flows:
    """Flows of functions on an affine Poisson structure.

    Args:
        field: Has the names of `list_symbols`, and room for functions.
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

    def follow(self, function: Element) -> Flow:
        """The flow of a function, proved.

        Raises:
            NoFlowError: The coordinates of the function do not commute, or move the others by a
                matrix whose exponential is not known here.
        """
        field = self.field
        names = [name for name in self.state if name in field.reach(function)]
        values = [field[name] for name in self.state]
        rotations: list[Rotation] = []
        for name, slope in zip(names, field.gradient(function, names), strict=True):
            i = self.state.index(name)
            for other in names:
                if not self.commute(i, self.state.index(other)):
                    raise NoFlowError(
                        f"{element_text(field, function)} depends on {name} and {other}, whose "
                        "bracket is not 0"
                    )
            is_rational = not field.reach(slope) & {*self.state} - {name}
            values = self._turn(values, i, slope, rotations, is_rational=is_rational)
        flow = Flow(tuple(map(field.normal, values)), tuple(rotations))
        self.check(function, flow)
        return flow

    def check(self, function: Element, flow: Flow) -> None:
        """Prove a flow: its derivative by the time, with ``d tan(a/2) = (1 + tan^2) da/2``.

        Raises:
            DerivationError: Its derivative is not the motion where it leads, or it does not begin
                at the identity; the message names the component.
        """
        field, there = self.field, dict(zip(self.state, flow.values, strict=True))
        sines = {name: value for name, value in flow.define(field) if name.startswith("_sin")}
        begin = {STEP: field.zero} | {each.tangent: field.zero for each in flow.rotations}
        for name, value, rate in zip(self.state, flow.values, self.motion(function), strict=True):
            closed = field.substitute(value, sines)
            moved = field.derivative(closed, STEP)
            for each in flow.rotations:
                faster = field.one + field[each.tangent] ** 2 * each.sign
                speed = field.derivative(each.angle, STEP) * faster
                moved = moved + field.derivative(closed, each.tangent) * speed
            expected = field.substitute(field.substitute(rate, there), sines)
            start = field.substitute(closed, begin) - field[name]
            for what, gap in (("at the start", start), ("in its rate", moved - expected)):
                if not field.is_zero(gap):
                    raise DerivationError(
                        f"the flow of {element_text(field, function)} is wrong {what}: {name} is "
                        f"off by {element_text(field, field.normal(gap))}; expected 0. This is a "
                        "fault of coadjoint, please report it.",
                        found=name,
                    )

    def _turn(
        self,
        values: Sequence[Element],
        i: int,
        slope: Element,
        rotations: list[Rotation],
        *,
        is_rational: bool,
    ) -> list[Element]:
        """``exp(h slope A_i)`` applied to values, block by block of the matrix."""
        field, known, result = self.field, (*values, self.field.one), list(values)
        turns: dict[tuple[Fraction, int], Rotation] = {}
        blocks = self._find_blocks(i)
        speeds = [k for _, k, _ in blocks if k]
        # angles have to agree to the last bit: a polynomial of each would not
        is_rational &= all(k in (speeds[0], 2 * speeds[0]) for k in speeds)
        is_rational &= all(sign > 0 for _, _, sign in blocks)
        for matrix, k, sign in blocks:
            time, square = field[STEP] * slope, _multiply(matrix, matrix)
            odd, even = time, time**2 * Fraction(1, 2)
            if k:
                if (k, sign) not in turns:
                    names = [f"_{name}{len(rotations) + 1}" for name in ("half", "tan", "sin")]
                    turns[k, sign] = Rotation(
                        half=names[0],
                        tangent=names[1],
                        sine=names[2],
                        angle=time * (k / 2),
                        sign=sign,
                        is_rational=is_rational,
                        doubled=turns[speeds[0], 1].tangent
                        if is_rational and k > speeds[0]
                        else "",
                    )
                    rotations.append(turns[k, sign])
                turn = turns[k, sign]
                sine = field[turn.sine]
                odd, even = sine * (1 / k), sine * field[turn.tangent] * (1 / k**2)
            for part, power in ((odd, matrix), (even, square)):
                for row, entry in _apply(power, known).items():
                    result[row] = result[row] + part * entry
        return result

    def _find_blocks(self, i: int) -> list[tuple[_Matrix, Fraction, int]]:
        """Blocks of a matrix with their frequencies, 0 for kicks, and signs: slow ones first."""
        found = []
        for matrix in _blocks(self.generators[i], len(self.state)):
            cube = _multiply(_multiply(matrix, matrix), matrix)
            found.append(
                (matrix, *(self._find_frequency(i, matrix, cube) if cube else (Fraction(0), 1)))
            )
        return sorted(found, key=lambda block: block[1])

    def _find_frequency(self, i: int, matrix: _Matrix, cube: _Matrix) -> tuple[Fraction, int]:
        """The k > 0 of ``A^3 = -k^2 A`` or ``A^3 = k^2 A``, with the sign 1 or -1."""
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
            raise NoFlowError(
                f"the motion by {self.state[i]} is no translation and turns by no single rational "
                "frequency: the cube of a block of its matrix is not a multiple of the block"
            )
        return k, 1 if ratio < 0 else -1


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
