"""Driven and damped systems typed by hand, for comparison with ours.

Each function takes the components of state and parameters as flat sequences, as those of
`tests.sources.textbook`, which has them by system.
"""

from __future__ import annotations

from typing import Any

from tests.sources.bodies import (
    heavy_top_observables,
    heavy_top_rates,
    rigid_body_observables,
    rigid_body_tensor,
    se3_tensor,
)
from tests.sources.components import Vector, cross, dot


def damped_top_rates(x: Vector, parameters: Vector) -> list[Any]:
    """Newton and Euler: the torques of gravity, of friction -D Omega, and of a motor."""
    inertia, (d, tau) = parameters[:3], (parameters[8:11], parameters[11:14])
    free = heavy_top_rates(x, parameters[:8])
    torque = [t - k * p / i for t, k, p, i in zip(tau, d, x[:3], inertia, strict=True)]
    return [*(a + b for a, b in zip(free[:3], torque, strict=True)), *free[3:]]


def bloch_rates(M: Vector, parameters: Vector) -> list[Any]:
    """``dM/dt = M x omega - (M1/T2, M2/T2, (M3 - M0)/T1)`` (Bloch 1946)."""
    omega, (T1, T2, M0) = parameters[:3], parameters[3:]
    relaxed = (M[0] / T2, M[1] / T2, (M[2] - M0) / T1)
    return [a - b for a, b in zip(cross(M, omega), relaxed, strict=True)]


def lorenz_rates(state: Vector, parameters: Vector) -> list[Any]:
    """Lorenz (1963): ``sigma (y - x), r x - y - x z, x y - b z``."""
    (x, y, z), (sigma, r, b) = state, parameters
    return [sigma * (y - x), r * x - y - x * z, x * y - b * z]


def bloch_observables(M: Vector, parameters: Vector) -> dict[str, Any]:
    """The energy in the field, and the Casimir."""
    return {"energy": dot(parameters[:3], M), "casimir1": dot(M, M)}


def lorenz_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """The Hamiltonian of the gyrostat without damping, and its other integral."""
    (x, y, z), (sigma, r, _) = state, parameters
    return {"energy": x * x / 2 - sigma * z, "casimir1": (y * y + z * z) / 2 - r * z}


def lorenz_tensor(state: Vector, parameters: Vector) -> list[list[Any]]:
    """``{x_i, x_j} = eps_ijk dc/dx_k`` with ``c = (y^2 + z^2)/2 - r z``: dx/dt = dh x dc."""
    _, y, z = state
    s = z - parameters[1]  # dc/dx = 0
    return [[0, s, -y], [-s, 0, 0], [y, 0, 0]]


def falling_body_rates(Pi: Vector, parameters: Vector) -> list[Any]:
    """``dPi/dt = Pi x Omega + alpha Pi x (Pi x Omega)``."""
    inertia, alpha = parameters[:3], parameters[3]
    turned = cross(Pi, [p / i for p, i in zip(Pi, inertia, strict=True)])
    return [a + alpha * b for a, b in zip(turned, cross(Pi, turned), strict=True)]


def gilbert_rates(m: Vector, parameters: Vector) -> list[Any]:
    """``dm/dt`` from Gilbert's implicit form, ``(1 - alpha m x) dm/dt = -gamma m x B``, solved.

    With F = -gamma m x B the solution is ``(F + alpha m x F + alpha^2 (m . F) m)/(1 + alpha^2)``
    for unit m, and m . F = 0.
    """
    gamma, alpha, *B, K = parameters
    field = [B[0], B[1], B[2] + K * m[2]]
    F = [-gamma * x for x in cross(m, field)]
    return [(a + alpha * b) / (1 + alpha**2) for a, b in zip(F, cross(m, F), strict=True)]


def gilbert_observables(m: Vector, parameters: Vector) -> dict[str, Any]:
    """The energy as it stands in the bracket, and the square of the length."""
    gamma, alpha, *B, K = parameters
    whole = dot(m, B) + K * m[2] * m[2] / 2
    share = -gamma / (1 + alpha**2)
    return {
        "energy": share * whole,
        "casimir1": dot(m, m),
        "omega1": share * B[0],
        "omega2": share * B[1],
        "omega3": share * (B[2] + K * m[2]),
    }


RATES = {
    "double_bracket_body": falling_body_rates,
    "landau_lifshitz_gilbert": gilbert_rates,
    "heavy_top_damped": damped_top_rates,
    "bloch": bloch_rates,
    "lorenz_gyrostat": lorenz_rates,
}
OBSERVABLES = {
    "double_bracket_body": lambda x, p: rigid_body_observables(x, p[:3]),
    "landau_lifshitz_gilbert": gilbert_observables,
    "heavy_top_damped": lambda x, p: heavy_top_observables(x, p[:8]),
    "bloch": bloch_observables,
    "lorenz_gyrostat": lorenz_observables,
}
TENSORS = {
    "double_bracket_body": lambda x, p: rigid_body_tensor(x),
    "landau_lifshitz_gilbert": lambda x, p: rigid_body_tensor(x),
    "heavy_top_damped": lambda x, p: se3_tensor(x),
    "bloch": lambda x, p: rigid_body_tensor(x),
    "lorenz_gyrostat": lorenz_tensor,
}
STATES = {
    "double_bracket_body": ("Pi1", "Pi2", "Pi3"),
    "landau_lifshitz_gilbert": ("m1", "m2", "m3"),
    "heavy_top_damped": ("Pi1", "Pi2", "Pi3", "Gamma1", "Gamma2", "Gamma3"),
    "bloch": ("M1", "M2", "M3"),
    "lorenz_gyrostat": ("x", "y", "z"),
}
PARAMETERS = {
    "double_bracket_body": ("I1", "I2", "I3", "alpha"),
    "landau_lifshitz_gilbert": ("gamma", "alpha", "B1", "B2", "B3", "K"),
    "heavy_top_damped": (
        *("I1", "I2", "I3", "m", "g", "chi1", "chi2", "chi3"),
        *("d1", "d2", "d3", "tau1", "tau2", "tau3"),
    ),
    "bloch": ("omega1", "omega2", "omega3", "T1", "T2", "M0"),
    "lorenz_gyrostat": ("sigma", "r", "b"),
}
