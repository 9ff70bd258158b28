"""Coupled motions: two bodies with a joint, a vehicle with two centres; typed by hand from books.

Functions as in `tests.sources.bodies`.
"""

from __future__ import annotations

from typing import Any

from tests.sources.components import Vector, cross, dot, hat, over, plus, product, times, turned

# -- two coupled bodies: Holm (2011), appendix C.5 -------------------------------------------------


def mass_matrix(A: list[Any], parameters: Vector) -> list[list[Any]]:
    """``[[I1 - e hat(d1)^2, e hat(d1) A hat(d2)], [its transpose, I2 - e hat(d2)^2]]``."""
    i1, i2, d1, d2 = (list(parameters[n : n + 3]) for n in (0, 3, 6, 9))
    epsilon = parameters[12]
    coupling = product(product(hat(d1), A), hat(d2))
    blocks = []
    for inertia, d in ((i1, d1), (i2, d2)):
        square = product(hat(d), hat(d))
        blocks.append(
            [[(r == c) * inertia[r] - epsilon * square[r][c] for c in range(3)] for r in range(3)]
        )
    across = [[epsilon * x for x in row] for row in coupling]
    top = [[*a, *b] for a, b in zip(blocks[0], across, strict=True)]
    return top + [[*a, *b] for a, b in zip(turned(across), blocks[1], strict=True)]


def eliminated(matrix: list[list[Any]], known: Vector) -> list[Any]:
    """The solution of linear equations by elimination with the largest pivot."""
    rows = [[*row, b] for row, b in zip(matrix, known, strict=True)]
    for column in range(len(rows)):
        best = max(range(column, len(rows)), key=lambda n: abs(rows[n][column]))
        rows[column], rows[best] = rows[best], rows[column]
        pivot = [x / rows[column][column] for x in rows[column]]
        rows = [
            pivot if n == column else [x - row[column] * y for x, y in zip(row, pivot, strict=True)]
            for n, row in enumerate(rows)
        ]
    return [row[-1] for row in rows]


def coupled_parts(state: Vector, parameters: Vector) -> tuple[Any, ...]:
    """Momenta, the rows of A, and velocities solved from ``Pi = M(A) Omega``."""
    A = [list(state[n : n + 3]) for n in (6, 9, 12)]
    omega = eliminated(mass_matrix(A, parameters), state[:6])
    return list(state[:3]), list(state[3:6]), A, omega[:3], omega[3:]


def coupled_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``dPi1/dt = Pi1 x Omega1 + tau``, ``dA/dt = -hat(Omega1) A + A hat(Omega2)``.

    The book's torque on the second body, ``-A^T tau``, is for rotations A. With w = Omega x d,
    ``tau = e (A w2) x w1``, and for any matrix A it is ``-e w2 x (A^T w1)``.
    """
    pi1, pi2, A, omega1, omega2 = coupled_parts(state, parameters)
    d1, d2, epsilon = list(parameters[6:9]), list(parameters[9:12]), parameters[12]
    w1, w2 = cross(omega1, d1), cross(omega2, d2)
    tau = [epsilon * x for x in cross([dot(row, w2) for row in A], w1)]
    back = [-epsilon * x for x in cross(w2, [dot(row, w1) for row in turned(A)])]
    left, right = product(hat(omega1), A), product(A, hat(omega2))
    dA = [b - a for x, y in zip(left, right, strict=True) for a, b in zip(x, y, strict=True)]
    return plus(cross(pi1, omega1), tau) + plus(cross(pi2, omega2), back) + dA


def book_rates(state: Vector, parameters: Vector, sign: int = 1) -> list[Any]:
    """The same with ``-A^T tau`` as printed; ``sign`` turns tau around."""
    pi1, pi2, A, omega1, omega2 = coupled_parts(state, parameters)
    d1, d2, epsilon = list(parameters[6:9]), list(parameters[9:12]), parameters[12]
    turning = [dot(row, cross(omega2, d2)) for row in A]
    tau = [sign * epsilon * x for x in cross(turning, cross(omega1, d1))]
    back = [-dot(column, tau) for column in turned(A)]
    rest = coupled_rates(state, parameters)[6:]
    return plus(cross(pi1, omega1), tau) + plus(cross(pi2, omega2), back) + rest


def coupled_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Kinetic energy; tr G, det A and tr G^2 with G = A^T A; velocities; ``Pi1 + A Pi2``."""
    pi1, pi2, A, omega1, omega2 = coupled_parts(state, parameters)
    gram = product(turned(A), A)
    total = [p + dot(row, pi2) for p, row in zip(pi1, A, strict=True)]
    named = {"Omega1": omega1, "Omega2": omega2}
    return {
        "energy": (dot(pi1, omega1) + dot(pi2, omega2)) / 2,
        "casimir1": sum(gram[n][n] for n in range(3)),
        "casimir2": dot(A[0], cross(A[1], A[2])),
        "casimir3": sum(x * x for row in gram for x in row),
        **{f"{name}_{n + 1}": v for name, values in named.items() for n, v in enumerate(values)},
        **{f"total{n + 1}": x for n, x in enumerate(total)},
    }


def coupled_tensor(state: Vector) -> list[list[Any]]:
    """``{Pi1, Pi1} = hat(Pi1)``, ``{Pi2, Pi2} = hat(Pi2)``, A turned by e_i from two sides."""
    A = [list(state[n : n + 3]) for n in (6, 9, 12)]
    units = [[int(n == k) for n in range(3)] for k in range(3)]
    sides = [[[-x for x in row] for row in product(hat(e), A)] for e in units]
    sides += [product(A, hat(e)) for e in units]
    # dA/dt = {A, h} for h = Pi . e is the column of e
    columns = [[x for row in side for x in row] for side in sides]
    tensor: list[list[Any]] = [[0] * 15 for _ in range(15)]
    for k in range(3):
        tensor[k][:3], tensor[3 + k][3:6] = hat(state[:3])[k], hat(state[3:6])[k]
    for k, column in enumerate(columns):
        for n, x in enumerate(column):
            tensor[6 + n][k], tensor[k][6 + n] = x, -x
    return tensor


# -- vehicle with noncoincident centres: Holm (2011), section 7.2 ----------------------------------


def vehicle_velocities(state: Vector, parameters: Vector) -> tuple[list[Any], list[Any]]:
    """``Omega = I^-1 Pi``, ``v = M^-1 P``."""
    return over(state[:3], parameters[:3]), over(state[3:6], parameters[3:6])


def vehicle_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``Pi x Omega + P x v + m g Gamma x chi``, ``P x Omega``, ``Gamma x Omega``."""
    omega, v = vehicle_velocities(state, parameters)
    pi, impulse, gamma = (list(state[n : n + 3]) for n in (0, 3, 6))
    m, g, chi = parameters[6], parameters[7], list(parameters[8:])
    torque = plus(cross(impulse, v), times(m * g, cross(gamma, chi)))
    return plus(cross(pi, omega), torque) + cross(impulse, omega) + cross(gamma, omega)


def vehicle_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, the Casimirs ``P.P``, ``P.Gamma`` and ``Gamma.Gamma``, velocities."""
    omega, v = vehicle_velocities(state, parameters)
    pi, impulse, gamma = (list(state[n : n + 3]) for n in (0, 3, 6))
    weight = parameters[6] * parameters[7] * dot(gamma, list(parameters[8:]))
    return {
        "energy": (dot(pi, omega) + dot(impulse, v)) / 2 + weight,
        "casimir1": dot(impulse, impulse),
        "casimir2": dot(impulse, gamma),
        "casimir3": dot(gamma, gamma),
        **{f"Omega{n + 1}": value for n, value in enumerate(omega)},
        **{f"v{n + 1}": value for n, value in enumerate(v)},
    }


def vehicle_tensor(state: Vector) -> list[list[Any]]:
    """``[[hat Pi, hat P, hat Gamma], [hat P, 0, 0], [hat Gamma, 0, 0]]``."""
    pi, impulse, gamma = (hat(state[n : n + 3]) for n in (0, 3, 6))
    top = [[*a, *b, *c] for a, b, c in zip(pi, impulse, gamma, strict=True)]
    return top + [[*row, 0, 0, 0, 0, 0, 0] for row in (*impulse, *gamma)]
