"""Equations of motion typed by hand from books, in any arithmetic, for comparison with ours.

This is the only place where the cross products of these systems are written out. Each function
takes the components of state and parameters as flat sequences and returns a flat list.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

Vector = Sequence[Any]


def cross(a: Vector, b: Vector) -> list[Any]:
    """``a x b`` in components."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a: Vector, b: Vector) -> Any:
    """``a . b`` in components."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def plus(a: Vector, b: Vector) -> list[Any]:
    """``a + b`` in components."""
    return [x + y for x, y in zip(a, b, strict=True)]


def hat(a: Vector) -> list[list[Any]]:
    """``hat(a) b = a x b``."""
    return [[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]]


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


RATES = {
    "rigid_body": rigid_body_rates,
    "heavy_top": heavy_top_rates,
    "kirchhoff": kirchhoff_rates,
}
OBSERVABLES = {
    "rigid_body": rigid_body_observables,
    "heavy_top": heavy_top_observables,
    "kirchhoff": kirchhoff_observables,
}
TENSORS = {
    "rigid_body": rigid_body_tensor,
    "heavy_top": se3_tensor,
    "kirchhoff": se3_tensor,
}
STATES = {
    "rigid_body": ("Pi1", "Pi2", "Pi3"),
    "heavy_top": ("Pi1", "Pi2", "Pi3", "Gamma1", "Gamma2", "Gamma3"),
    "kirchhoff": ("Pi1", "Pi2", "Pi3", "P1", "P2", "P3"),
}
PARAMETERS = {
    "rigid_body": ("I1", "I2", "I3"),
    "heavy_top": ("I1", "I2", "I3", "m", "g", "chi1", "chi2", "chi3"),
    "kirchhoff": ("I1", "I2", "I3", "M1", "M2", "M3", "D1", "D2", "D3"),
}
