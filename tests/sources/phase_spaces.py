"""Canonical motions with symmetries: equations typed by hand from books, for comparison with ours.

Each function takes the components of state and parameters as flat sequences and returns a flat
list, or values by name. `tests.sources.textbook` has them by system.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations_with_replacement
from typing import Any

from tests.sources.components import Vector, cross, plus, product, times, turned

Matrix = list[list[Any]]


def symmetric(entries: Vector, size: int) -> Matrix:
    """The matrix with the given entries on and above its diagonal."""
    rows: Matrix = [[None] * size for _ in range(size)]
    for (i, j), entry in zip(upper_places(size), entries, strict=True):
        rows[i][j] = rows[j][i] = entry
    return rows


def upper_places(size: int) -> list[tuple[int, int]]:
    """Rows and columns on and above the diagonal."""
    return list(combinations_with_replacement(range(size), 2))


def flat(rows: Sequence[Vector]) -> list[Any]:
    """The entries row by row."""
    return [x for row in rows for x in row]


def trace(rows: Sequence[Vector]) -> Any:
    """The sum of the diagonal."""
    return sum(row[n] for n, row in enumerate(rows))


def applied(rows: Sequence[Vector], vector: Vector) -> list[Any]:
    """A matrix times a column."""
    return [sum(x * y for x, y in zip(row, vector, strict=True)) for row in rows]


def paired(weights: Sequence[Any]) -> Matrix:
    """``{q_a, p_a} = w_a``, positions first."""
    n = len(weights)
    rows: Matrix = [[0] * (2 * n) for _ in range(2 * n)]
    for a, weight in enumerate(weights):
        rows[a][n + a], rows[n + a][a] = weight, -weight
    return rows


# -- positive symmetric matrices: Holm (2011), appendix C.3.1 --------------------------------------


def spd_parts(state: Vector, size: int) -> tuple[Matrix, Matrix, Vector, Vector]:
    """S, P, q, p."""
    kept = size * (size + 1) // 2
    S, P = symmetric(state[:kept], size), symmetric(state[kept : 2 * kept], size)
    return S, P, state[2 * kept : 2 * kept + size], state[2 * kept + size :]


def spd_rates(size: int) -> Callable[[Vector, Vector], list[Any]]:
    """``dS/dt = SPS``, ``dP/dt = -(PSP + p p^T/2)``, ``dq/dt = Sp``, ``dp/dt = 0``."""

    def rates(state: Vector, parameters: Vector) -> list[Any]:
        S, P, _, p = spd_parts(state, size)
        moved, turned_back = product(product(S, P), S), product(product(P, S), P)
        return [
            *(moved[i][j] for i, j in upper_places(size)),
            *(-turned_back[i][j] - p[i] * p[j] / 2 for i, j in upper_places(size)),
            *applied(S, p),
            *[0] * size,
        ]

    return rates


def spd_observables(size: int) -> Callable[[Vector, Vector], dict[str, Any]]:
    """``tr(PSPS)/2 + p.Sp/2`` and ``J = 2 P S + p q^T``."""

    def found(state: Vector, parameters: Vector) -> dict[str, Any]:
        S, P, q, p = spd_parts(state, size)
        PS = product(P, S)
        kinetic = sum(x * y for x, y in zip(p, applied(S, p), strict=True))
        J = {
            f"J{i + 1}{j + 1}": 2 * PS[i][j] + p[i] * q[j] for i in range(size) for j in range(size)
        }
        return {"energy": trace(product(PS, PS)) / 2 + kinetic / 2, **J}

    return found


def spd_tensor(size: int) -> Matrix:
    """``{S_ij, P_kl} = (d_ik d_jl + d_il d_jk)/2``: 1/2 beside the diagonal; ``{q_i, p_j} = d_ij``.

    In the order S, P, q, p of the state.
    """
    kept = size * (size + 1) // 2
    n = kept + size
    halves = paired([1] * n)
    for a, (i, j) in enumerate(upper_places(size)):
        if i != j:
            halves[a][n + a], halves[n + a][a] = 0.5, -0.5
    # positions S, q and momenta P, p as they stand in the state
    order = [*range(kept), *range(n, n + kept), *range(kept, n), *range(n + kept, 2 * n)]
    return [[halves[i][j] for j in order] for i in order]


# -- ellipsoidal motions: Holm (2011), appendix C.3.2 ----------------------------------------------


def cofactors(Q: Sequence[Vector]) -> Matrix:
    """``det(Q) Q^-T``: rows are cross products of the other two rows."""
    return [cross(Q[1], Q[2]), cross(Q[2], Q[0]), cross(Q[0], Q[1])]


def ellipsoid_parts(state: Vector) -> tuple[Matrix, Matrix]:
    """Q and P."""
    return (
        [list(state[n : n + 3]) for n in (0, 3, 6)],
        [list(state[n : n + 3]) for n in (9, 12, 15)],
    )


def ellipsoid_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``dQ/dt = P``, ``dP/dt = -(2 V_1 Q + V_2 det(Q) Q^-T)`` for ``V = k s/2 + b/d``."""
    (Q, P), (k, b) = ellipsoid_parts(state), parameters
    cofactor = cofactors(Q)
    d = sum(x * y for x, y in zip(Q[0], cofactor[0], strict=True))
    slope = -b / d**2
    return [*flat(P), *plus(times(-k, flat(Q)), times(-slope, flat(cofactor)))]


def ellipsoid_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy; J_L = sum of column(Q) x column(P); J_R = sum of row(P) x row(Q)."""
    (Q, P), (k, b) = ellipsoid_parts(state), parameters
    d = sum(x * y for x, y in zip(Q[0], cofactors(Q)[0], strict=True))
    left, right = [0, 0, 0], [0, 0, 0]
    for q, p in zip(turned(Q), turned(P), strict=True):
        left = plus(left, cross(q, p))
    for q, p in zip(Q, P, strict=True):
        right = plus(right, cross(p, q))
    squares = sum(x**2 for x in flat(P)), sum(x**2 for x in flat(Q))
    return {
        "energy": squares[0] / 2 + k * squares[1] / 2 + b / d,
        **{f"J_L{n + 1}": x for n, x in enumerate(left)},
        **{f"J_R{n + 1}": x for n, x in enumerate(right)},
    }


# -- oscillators on C^3: Holm (2011), appendix C.2 -------------------------------------------------


def oscillator_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``h = sum w_j |a_j|^2/2 + c (q1 q2 + p1 p2) + k |q x p|^2/2`` by Hamilton's equations."""
    (q, p), (w, c, k) = (state[:3], state[3:]), (parameters[:3], parameters[3], parameters[4])
    L = cross(q, p)
    coupled = [c * p[1], c * p[0], 0], [-c * q[1], -c * q[0], 0]
    free = [x * y for x, y in zip(w, p, strict=True)], [-x * y for x, y in zip(w, q, strict=True)]
    # d|L|^2/2 = L . (dq x p + q x dp)
    spun = times(k, cross(L, q)), times(k, cross(L, p))
    return plus(plus(free[0], coupled[0]), spun[0]) + plus(plus(free[1], coupled[1]), spun[1])


def oscillator_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Re Q, Im Q of ``Q_jk = a_j a_k^*``, ``q x p``, tr Q, and Q along the basis of u(3)."""
    (q, p), (w, c, k) = (state[:3], state[3:]), (parameters[:3], parameters[3], parameters[4])
    R = [[q[i] * q[j] + p[i] * p[j] for j in range(3)] for i in range(3)]
    N = [[p[i] * q[j] - q[i] * p[j] for j in range(3)] for i in range(3)]
    L = cross(q, p)
    off = [(0, 1), (0, 2), (1, 2)]
    diagonal = [R[n][n] for n in range(3)]
    J = [*(N[i][j] for i, j in off), *(-R[i][j] for i, j in off), *(-x / 2 for x in diagonal)]
    places = [(i, j) for i in range(3) for j in range(3)]
    kinetic = sum(x * y for x, y in zip(w, diagonal, strict=True)) / 2
    return {
        "energy": kinetic + c * R[0][1] + k * sum(x**2 for x in L) / 2,
        **{f"R{i + 1}{j + 1}": R[i][j] for i, j in places},
        **{f"N{i + 1}{j + 1}": N[i][j] for i, j in places},
        **{f"L{n + 1}": x for n, x in enumerate(L)},
        "n0": sum(diagonal),
        **{f"J{n + 1}": x for n, x in enumerate(J)},
    }
