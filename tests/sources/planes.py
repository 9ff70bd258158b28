r"""Veselova's problem on so(4) typed by hand: Fedorov and Jovanovic (2004), for n = 4.

All is in matrices of four dimensions. Gamma moves by :math:`\dot\Gamma = -\Omega \Gamma`, and the
body turns only in planes with Gamma, so :math:`\Omega = (\Gamma \dot\Gamma^T - \dot\Gamma \Gamma^T)
/|\Gamma|^2`. The rates of Gamma are combinations of Hopf's three fields on the sphere,
:math:`\dot\Gamma = F_k \Gamma U_k`; the torque :math:`\dot M - [M, \Omega]` of the constraint does
no work in these planes.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations
from typing import Any

from tests.sources.components import Vector, commutator, minus, plus, times
from tests.sources.points import named

Square = list[list[Any]]

#: Hopf's fields, of unit length on the unit sphere, across it and across each other.
FIELDS = (
    ((0, 1, 0, 0), (-1, 0, 0, 0), (0, 0, 0, -1), (0, 0, 1, 0)),
    ((0, 0, 1, 0), (0, 0, 0, 1), (-1, 0, 0, 0), (0, -1, 0, 0)),
    ((0, 0, 0, 1), (0, 0, -1, 0), (0, 1, 0, 0), (-1, 0, 0, 0)),
)
HALF = Fraction(1, 2)
#: The turns V1, V2, V3: half along a plane of the first axis, half along the plane across it.
ACROSS: tuple[dict[tuple[int, int], Fraction], ...] = (
    {(0, 1): HALF, (2, 3): HALF},
    {(0, 2): HALF, (1, 3): -HALF},
    {(0, 3): HALF, (1, 2): HALF},
)
PAIRS = tuple(combinations(range(4), 2))


def inner(a: Vector, b: Vector) -> Any:
    """The scalar product."""
    return sum(x * y for x, y in zip(a, b, strict=True))


def on(matrix: Any, vector: Vector) -> list[Any]:
    """A matrix times a vector."""
    return [inner(row, vector) for row in matrix]


def wedge(a: Vector, b: Vector) -> Square:
    """``a b^T - b a^T``."""
    return [[x * v - y * u for u, v in zip(a, b, strict=True)] for x, y in zip(a, b, strict=True)]


def scaled(factor: Any, matrix: Any) -> Square:
    """A multiple of a matrix."""
    return [times(factor, row) for row in matrix]


def added(*matrices: Any) -> Square:
    """A sum of matrices."""
    rows = zip(*matrices, strict=True)
    return [[sum(entries) for entries in zip(*each, strict=True)] for each in rows]


def pair(a: Any, b: Any) -> Any:
    """The sum over i < j of products of entries."""
    return sum(a[i][j] * b[i][j] for i, j in PAIRS)


def solve(matrix: Square, known: Vector) -> list[Any]:
    """Three unknowns by Cramer's rule."""

    def det(m: Any) -> Any:
        (a, b, c), (d, e, f), (g, h, i) = m
        return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)

    columns = list(zip(*matrix, strict=True))
    whole = det(columns)
    return [det([*columns[:n], known, *columns[n + 1 :]]) / whole for n in range(3)]


class Planes:
    """A body with the direction Gamma.

    Args:
        state: U, Gamma and another direction a.
        parameters: Moments of inertia, of the planes of the first axis and of those across.
    """

    def __init__(self, state: Vector, parameters: Vector) -> None:
        self.u, self.gamma, self.a = state[:3], state[3:7], state[7:]
        x1, x2, x3, y1, y2, y3 = parameters
        self.inertia = ((0, x1, x2, x3), (x1, 0, y3, y2), (x2, y3, 0, y1), (x3, y2, y1, 0))
        self.share = 1 / Fraction(inner(self.gamma, self.gamma))
        self.moved = self.move(self.gamma)
        self.turns = [self.turn(on(field, self.gamma)) for field in FIELDS]
        self.omega = self.turn(self.moved)
        self.momentum = self.carry(self.omega)

    def move(self, vector: Vector) -> list[Any]:
        """``F_k v U_k``."""
        parts = [times(u, on(field, vector)) for u, field in zip(self.u, FIELDS, strict=True)]
        return plus(plus(parts[0], parts[1]), parts[2])

    def turn(self, moved: Vector) -> Square:
        """The turn by which Gamma moves."""
        return scaled(self.share, wedge(self.gamma, moved))

    def carry(self, omega: Any) -> Square:
        """``M_ij = J_ij Omega_ij``."""
        rows = zip(self.inertia, omega, strict=True)
        return [[j * x for j, x in zip(*row, strict=True)] for row in rows]

    def turning(self, moved: Vector) -> list[Square]:
        """How the three turns change as Gamma moves."""
        return [
            scaled(
                self.share,
                added(
                    wedge(moved, on(field, self.gamma)),
                    wedge(self.gamma, on(field, moved)),
                ),
            )
            for field in FIELDS
        ]

    def gained(self, omega_dot: Any) -> Square:
        """``dM/dt - [M, Omega]``, the torque of the constraint."""
        gone = commutator(self.momentum, self.omega)
        return added(self.carry(omega_dot), scaled(-1, gone))

    def accelerate(self) -> tuple[list[Any], Square]:
        """``dU/dt`` and the torque, which does no work in the planes with Gamma."""
        drift = added(
            *(scaled(u, w) for u, w in zip(self.u, self.turning(self.moved), strict=True))
        )
        matrix = [[pair(self.carry(b), a) for b in self.turns] for a in self.turns]
        known = [-pair(self.gained(drift), a) for a in self.turns]
        rates = solve(matrix, known)
        own = added(*(scaled(x, w) for x, w in zip(rates, self.turns, strict=True)))
        return rates, self.gained(added(own, drift))


def planes_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``d(Gamma, a)/dt = -Omega (Gamma, a)``."""
    body = Planes(state, parameters)
    return [*body.accelerate()[0], *body.moved, *times(-1, on(body.omega, body.a))]


def planes_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, y - x, the torque along it, momenta, and a . M Gamma."""
    body = Planes(state, parameters)
    torque = body.accelerate()[1]
    omega = body.omega
    x = [-omega[0][k] for k in (1, 2, 3)]
    y = [omega[2][3], -omega[1][3], omega[1][2]]
    return {
        "energy": pair(body.momentum, omega) / 2,
        **named("V", minus(y, x)),
        **named(
            "planes_reaction",
            [sum(torque[i][j] * x for (i, j), x in turn.items()) for turn in ACROSS],
        ),
        **named("U_momentum", [pair(body.momentum, turn) for turn in body.turns]),
        "m": inner(body.a, on(body.momentum, body.gamma)),
    }


def planes_tensor(state: Vector, parameters: Vector) -> list[list[Any]]:
    """``{z, M_k} = -W_k z``; ``{M_i, M_j} = -<M, [W_i, W_j] + D_i W_j - D_j W_i>``."""
    body = Planes(state, parameters)
    moved = [body.turning(on(field, body.gamma)) for field in FIELDS]
    top = [
        [
            -pair(
                body.momentum,
                added(
                    commutator(body.turns[i], body.turns[j]), moved[i][j], scaled(-1, moved[j][i])
                ),
            )
            for j in range(3)
        ]
        for i in range(3)
    ]
    carried = [
        [*times(-1, on(turn, body.gamma)), *times(-1, on(turn, body.a))] for turn in body.turns
    ]
    rows = [[*row, *times(-1, column)] for row, column in zip(top, carried, strict=True)]
    return [*rows, *([*column, *[0] * 8] for column in zip(*carried, strict=True))]


STATE = (
    *(f"U{n}" for n in (1, 2, 3)),
    *(f"Gamma{n}" for n in (1, 2, 3, 4)),
    *(f"a{n}" for n in (1, 2, 3, 4)),
)
PARAMETERS = (*(f"Jx{n}" for n in (1, 2, 3)), *(f"Jy{n}" for n in (1, 2, 3)))
