"""Bodies: equations of motion typed by hand from books, for comparison with ours.

Each function takes the components of state and parameters as flat sequences and returns a flat
list, or values by name. `tests.sources.textbook` has them by system.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations
from typing import Any

from tests.sources.components import (
    Vector,
    antisymmetric,
    commutator,
    cross,
    dot,
    hat,
    over,
    pfaffian,
    plus,
    product,
    times,
)

# -- rigid body: Holm (2011), sections 2.4.1 and 2.5.2; Landau and Lifshitz, Mechanics, sec. 36 ---


def rigid_body_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``dPi_1/dt = (1/I3 - 1/I2) Pi2 Pi3`` and cyclic."""
    i1, i2, i3 = parameters
    p1, p2, p3 = state
    return [
        (1 / i3 - 1 / i2) * p2 * p3,
        (1 / i1 - 1 / i3) * p3 * p1,
        (1 / i2 - 1 / i1) * p1 * p2,
    ]


def rigid_body_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, square of the momentum, angular velocity."""
    omega = [p / i for p, i in zip(state, parameters, strict=True)]
    return {
        "energy": dot(state, omega) / 2,
        "casimir1": dot(state, state),
        **{f"Omega{n + 1}": value for n, value in enumerate(omega)},
    }


def rigid_body_tensor(state: Vector) -> list[list[Any]]:
    """``{Pi_i, Pi_j} = -epsilon_ijk Pi_k`` (Holm 2011, section 2.5.2)."""
    return hat(state)


# -- with its attitude as a quaternion: Holm (2011), sections 4.1 to 4.1.3 and 3.2 -----------------


def rigid_body_attitude_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``dq/dt = q [0, Omega]/2``, the product written out, and Euler's equations."""
    q0, q1, q2, q3, *momentum = state
    w1, w2, w3 = over(momentum, parameters)
    return [
        -(q1 * w1 + q2 * w2 + q3 * w3) / 2,
        (q0 * w1 + q2 * w3 - q3 * w2) / 2,
        (q0 * w2 + q3 * w1 - q1 * w3) / 2,
        (q0 * w3 + q1 * w2 - q2 * w1) / 2,
        *rigid_body_rates(momentum, parameters),
    ]


def rigid_body_attitude_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, length of q, angular velocity, and the momentum turned by Euler and Rodrigues."""
    q0, *q, p1, p2, p3 = state
    momentum = [p1, p2, p3]
    omega = over(momentum, parameters)
    turned = plus(
        plus(times(q0 * q0 - dot(q, q), momentum), times(2 * dot(q, momentum), q)),
        times(2 * q0, cross(q, momentum)),
    )
    return {
        "energy": dot(momentum, omega) / 2,
        "casimir1": q0 * q0 + dot(q, q),
        **{f"Omega{n + 1}": value for n, value in enumerate(omega)},
        **{f"Pi_spatial{n + 1}": value for n, value in enumerate(turned)},
    }


def rigid_body_attitude_tensor(state: Vector) -> list[list[Any]]:
    """``{q, Pi_j} = q e_j/2``, ``{Pi_i, Pi_j} = -epsilon_ijk Pi_k``, ``{q, q} = 0``."""
    q0, q1, q2, q3, *momentum = state
    moved = [[-q1, -q2, -q3], [q0, -q3, q2], [q3, q0, -q1], [-q2, q1, q0]]
    half = [[x / 2 for x in row] for row in moved]
    below = zip(zip(*half, strict=True), hat(momentum), strict=True)
    return [
        *([0, 0, 0, 0, *row] for row in half),
        *([*(-x for x in column), *row] for column, row in below),
    ]


# -- heavy top: Holm (2011), sections 8.2 and 8.3.2 ----------------------------------------------


def heavy_top_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``dPi/dt = Pi x Omega + m g Gamma x chi``, ``dGamma/dt = Gamma x Omega``."""
    momentum, gamma = state[:3], state[3:]
    inertia, (m, g), chi = parameters[:3], parameters[3:5], parameters[5:]
    omega = [p / i for p, i in zip(momentum, inertia, strict=True)]
    torque = [m * g * x for x in cross(gamma, chi)]
    return plus(cross(momentum, omega), torque) + cross(gamma, omega)


def heavy_top_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Kinetic and potential energy, the Casimirs, angular velocity."""
    momentum, gamma = state[:3], state[3:]
    inertia, (m, g), chi = parameters[:3], parameters[3:5], parameters[5:]
    omega = [p / i for p, i in zip(momentum, inertia, strict=True)]
    return {
        "energy": dot(momentum, omega) / 2 + m * g * dot(gamma, chi),
        "casimir1": dot(gamma, gamma),
        "casimir2": dot(momentum, gamma),
        **{f"Omega{n + 1}": value for n, value in enumerate(omega)},
    }


def se3_tensor(state: Vector) -> list[list[Any]]:
    """``[[hat mu, hat beta], [hat beta, 0]]`` (Holm 2011, sections 7.1.2 and 8.3.2)."""
    mu, beta = hat(state[:3]), hat(state[3:])
    top = [a + b for a, b in zip(mu, beta, strict=True)]
    return top + [[*row, 0, 0, 0] for row in beta]


# -- Kirchhoff: Holm (2011), section 7.2; Lamb, Hydrodynamics, 6th ed., sec. 124 -----------------


def kirchhoff_velocities(state: Vector, parameters: Vector) -> tuple[list[Any], list[Any]]:
    """``Pi = I Omega + D v``, ``P = D Omega + M v`` solved axis by axis by Cramer's rule."""
    omega, v = [], []
    for n in range(3):
        i, m, d = parameters[n], parameters[3 + n], parameters[6 + n]
        determinant = i * m - d * d
        omega.append((m * state[n] - d * state[3 + n]) / determinant)
        v.append((i * state[3 + n] - d * state[n]) / determinant)
    return omega, v


def kirchhoff_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``dPi/dt = Pi x Omega + P x v``, ``dP/dt = P x Omega``."""
    omega, v = kirchhoff_velocities(state, parameters)
    impulse = state[3:]
    return plus(cross(state[:3], omega), cross(impulse, v)) + cross(impulse, omega)


def kirchhoff_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Kinetic energy, the Casimirs of se(3)*, velocities."""
    omega, v = kirchhoff_velocities(state, parameters)
    return {
        "energy": (dot(state[:3], omega) + dot(state[3:], v)) / 2,
        "casimir1": dot(state[3:], state[3:]),
        "casimir2": dot(state[:3], state[3:]),
        **{f"Omega{n + 1}": value for n, value in enumerate(omega)},
        **{f"v{n + 1}": value for n, value in enumerate(v)},
    }


# -- body in R^4: Holm (2011), appendix C.1.3 ------------------------------------------------------


def so4_ad_star(velocity: Vector, state: Vector) -> list[Any]:
    """``(M x Omega + N x Lambda, N x Omega + M x Lambda)``."""
    (omega, lam), (m, n) = (velocity[:3], velocity[3:]), (state[:3], state[3:])
    return plus(cross(m, omega), cross(n, lam)) + plus(cross(n, omega), cross(m, lam))


def so4_body_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``dM/dt = M x Omega + N x Lambda``, ``dN/dt = N x Omega + M x Lambda``."""
    return so4_ad_star(over(state, parameters), state)


def so4_body_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, the two Casimirs, both angular velocities."""
    velocity = over(state, parameters)
    names = [f"{name}{n}" for name in ("Omega", "Lambda") for n in (1, 2, 3)]
    return {
        "energy": (dot(state[:3], velocity[:3]) + dot(state[3:], velocity[3:])) / 2,
        "casimir1": dot(state[:3], state[:3]) + dot(state[3:], state[3:]),
        "casimir2": dot(state[:3], state[3:]),
        **dict(zip(names, velocity, strict=True)),
    }


# -- Nambu's bracket: Holm (2011), section 2.5.4 ---------------------------------------------------


def nambu_body_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy and square of the momentum."""
    return {
        "energy": dot(state, over(state, parameters)) / 2,
        "casimir1": dot(state, state),
    }


def cylinder(parameters: Vector) -> tuple[Any, Any]:
    """Coefficients of the cylinder ``c - I3 h``: ``1 - I3/I1`` and ``1 - I3/I2``."""
    i1, i2, i3 = parameters
    return 1 - i3 / i1, 1 - i3 / i2


def nambu_pendulum_tensor(state: Vector, parameters: Vector) -> list[list[Any]]:
    """``{x_i, x_j} = -epsilon_ijk dc/dx_k`` for the cylinder."""
    a, b = cylinder(parameters)
    return hat([a * state[0], b * state[1], 0])


def nambu_pendulum_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy and the cylinder."""
    a, b = cylinder(parameters)
    energy = dot(state, over(state, parameters)) / 2
    return {"energy": energy, "casimir1": a * state[0] ** 2 + b * state[1] ** 2}


# -- bodies in R^n: Holm (2011), section 2.4.2 -----------------------------------------------------


def so_n_ad_star(size: int) -> Callable[[Vector, Vector], list[Any]]:
    """``ad*_Omega M = [M, Omega]`` by the pairing ``tr(M^T Omega)/2``: section 2.4.3."""

    def ad_star(velocity: Vector, state: Vector) -> list[Any]:
        found = commutator(antisymmetric(state, size), antisymmetric(velocity, size))
        return [found[i][j] for i, j in combinations(range(size), 2)]

    return ad_star


def so_n_velocity(state: Vector, a: Vector) -> list[Any]:
    """``Omega_ij = M_ij / (a_i + a_j)``."""
    sums = [x + y for x, y in combinations(a, 2)]
    return over(state, sums)


def so_n_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``dM/dt = [M, Omega]``."""
    return so_n_ad_star(len(parameters))(so_n_velocity(state, parameters), state)


def so_n_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """``-tr(M Omega)/4``, the sum of squares, ``tr M^4`` and the Pfaffian for n = 6."""
    size, velocity = len(parameters), so_n_velocity(state, parameters)
    M = antisymmetric(state, size)
    found = {
        "energy": sum(m * w for m, w in zip(state, velocity, strict=True)) / 2,
        "casimir1": sum(m**2 for m in state),
        "casimir2": sum(x**2 for row in product(M, M) for x in row),
    }
    if size == 6:
        found["casimir3"] = pfaffian(M)
    return found
