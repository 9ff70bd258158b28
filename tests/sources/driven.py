"""Driven and damped systems typed by hand, for comparison with ours.

Each function takes the components of state and parameters as flat sequences, as those of
`tests.sources.textbook`, which has them by system.
"""

from __future__ import annotations

from typing import Any

from tests.sources.bodies import (
    heavy_top_observables,
    heavy_top_rates,
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


RATES = {
    "heavy_top_damped": damped_top_rates,
    "bloch": bloch_rates,
    "lorenz_gyrostat": lorenz_rates,
}
OBSERVABLES = {
    "heavy_top_damped": lambda x, p: heavy_top_observables(x, p[:8]),
    "bloch": bloch_observables,
    "lorenz_gyrostat": lorenz_observables,
}
TENSORS = {
    "heavy_top_damped": lambda x, p: se3_tensor(x),
    "bloch": lambda x, p: rigid_body_tensor(x),
    "lorenz_gyrostat": lorenz_tensor,
}
STATES = {
    "heavy_top_damped": ("Pi1", "Pi2", "Pi3", "Gamma1", "Gamma2", "Gamma3"),
    "bloch": ("M1", "M2", "M3"),
    "lorenz_gyrostat": ("x", "y", "z"),
}
PARAMETERS = {
    "heavy_top_damped": (
        *("I1", "I2", "I3", "m", "g", "chi1", "chi2", "chi3"),
        *("d1", "d2", "d3", "tau1", "tau2", "tau3"),
    ),
    "bloch": ("omega1", "omega2", "omega3", "T1", "T2", "M0"),
    "lorenz_gyrostat": ("sigma", "r", "b"),
}
