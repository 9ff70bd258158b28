"""Driven and damped systems typed by hand, for comparison with ours.

Each function takes the components of state and parameters as flat sequences, as those of
`tests.sources.textbook`, which has them by system. Inputs and time follow the parameters.
"""

from __future__ import annotations

from typing import Any

from tests.sources.bodies import (
    heavy_top_observables,
    heavy_top_rates,
    rigid_body_attitude_observables,
    rigid_body_attitude_tensor,
    rigid_body_observables,
    rigid_body_rates,
    rigid_body_tensor,
    se3_tensor,
)
from tests.sources.components import Vector, cross, dot, minus, over, plus, times
from tests.sources.coupled import vehicle_tensor
from tests.sources.orbits import orbit_observables, orbit_rates, orbit_tensor
from tests.sources.points import circular


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


def relaxing_body_rates(L: Vector, parameters: Vector) -> list[Any]:
    """``dL/dt = L x omega + alpha omega x (L x omega)``.

    M. Materassi and P. J. Morrison, Cybernetics and Physics 7 (2018) 78: the torque is
    ``alpha (|omega|^2 L - (omega . L) omega)``, with half the square of L as the entropy.
    """
    inertia, alpha = parameters[:3], parameters[3]
    omega = [p / i for p, i in zip(L, inertia, strict=True)]
    turned = cross(L, omega)
    return [a + alpha * b for a, b in zip(turned, cross(omega, turned), strict=True)]


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


def quadrotor_rates(x: Vector, given: Vector) -> list[Any]:
    """``J dOmega/dt + Omega x J Omega = M``, ``m dv/dt = m g e3 - f R e3`` (Lee and others 2010).

    In body axes: v = R P/m, and the vertical e3, down, is R Gamma.
    """
    Pi, P, down = x[:3], x[3:6], x[6:9]
    inertia, (m, g, f), M = given[:3], given[3:6], given[6:]
    omega = over(Pi, inertia)
    force = [*times(m * g, down[:2]), m * g * down[2] - f]
    return [
        *plus(cross(Pi, omega), M),
        *plus(cross(P, omega), force),
        *cross(down, omega),
        dot(down, P) / m,
    ]


def quadrotor_observables(x: Vector, given: Vector) -> dict[str, Any]:
    """The energy with the height -x3, and the two Casimirs."""
    Pi, P, down = x[:3], x[3:6], x[6:9]
    inertia, (m, g) = given[:3], given[3:5]
    omega, aside = over(Pi, inertia), cross(P, down)
    return {
        "energy": dot(Pi, omega) / 2 + dot(P, P) / (2 * m) - m * g * x[9],
        "casimir1": dot(down, down),
        "casimir2": dot(aside, aside),
        **{f"Omega{n + 1}": value for n, value in enumerate(omega)},
        **{f"v{n + 1}": value / m for n, value in enumerate(P)},
    }


def quadrotor_tensor(x: Vector) -> list[list[Any]]:
    """As of the underwater vehicle, and ``{z, P} = Gamma`` of the depth z."""
    down = [0, 0, 0, *x[6:9], 0, 0, 0]
    rows = [[*row, -edge] for row, edge in zip(vehicle_tensor(x[:9]), down, strict=True)]
    return [*rows, [*down, 0]]


def wheels_rates(x: Vector, given: Vector) -> list[Any]:
    """``dPi/dt = Pi x Omega`` whatever the motors do, ``dL/dt = u``, ``I Omega = Pi - L``."""
    q0, q1, q2, q3, *momenta = x
    Pi, inertia, u = momenta[:3], given[:3], given[6:]
    w1, w2, w3 = omega = over(minus(Pi, momenta[3:]), inertia)
    return [
        -(q1 * w1 + q2 * w2 + q3 * w3) / 2,
        (q0 * w1 + q2 * w3 - q3 * w2) / 2,
        (q0 * w2 + q3 * w1 - q1 * w3) / 2,
        (q0 * w3 + q1 * w2 - q2 * w1) / 2,
        *cross(Pi, omega),
        *u,
    ]


def wheels_observables(x: Vector, given: Vector) -> dict[str, Any]:
    """Kinetic energy of body and wheels; the momentum turned by Euler and Rodrigues."""
    Pi, L = x[4:7], x[7:]
    inertia, J = given[:3], given[3:6]
    omega, whole = over(minus(Pi, L), inertia), over(L, J)
    seen = rigid_body_attitude_observables(x[:7], inertia)
    return {
        "energy": dot(minus(Pi, L), omega) / 2 + dot(L, whole) / 2,
        "casimir1": seen["casimir1"],
        **{f"casimir2_{n + 1}": value for n, value in enumerate(L)},
        **{f"Omega{n + 1}": value for n, value in enumerate(omega)},
        **{f"w{n + 1}": value for n, value in enumerate(minus(whole, omega))},
        **{name: value for name, value in seen.items() if name.startswith("Pi_spatial")},
    }


def wheels_tensor(x: Vector) -> list[list[Any]]:
    """As of a body with its attitude; the momenta of the wheels commute with everything."""
    rows = [[*row, 0, 0, 0] for row in rigid_body_attitude_tensor(x[:7])]
    return [*rows, *([0] * 10 for _ in range(3))]


def satellite_rates(x: Vector, given: Vector) -> list[Any]:
    """``dPi/dt = Pi x Omega + 3 n^2 gamma x I gamma``, ``Pi = I Omega`` (Hughes 1986).

    Normal and radius turn with the orbit: ``omega = Omega - n beta``.
    """
    Pi, beta, gamma = x[:3], x[3:6], x[6:]
    inertia, n = given[:3], given[3]
    omega = over(Pi, inertia)
    torque = cross(gamma, [i * a for i, a in zip(inertia, gamma, strict=True)])
    turning = minus(omega, times(n, beta))
    return [
        *plus(cross(Pi, omega), times(3 * n**2, torque)),
        *cross(beta, turning),
        *cross(gamma, turning),
    ]


def satellite_observables(x: Vector, given: Vector) -> dict[str, Any]:
    """The energy, which is Jacobi's integral, three Casimirs, and the velocity."""
    Pi, beta, gamma = x[:3], x[3:6], x[6:]
    inertia, n = given[:3], given[3]
    omega = minus(over(Pi, inertia), times(n, beta))

    def moment(a: Vector) -> Any:
        return sum(i * each**2 for i, each in zip(inertia, a, strict=True))

    jacobi = moment(omega) / 2 + 3 * n**2 * moment(gamma) / 2 - n**2 * moment(beta) / 2
    return {
        "energy": jacobi,
        "casimir1": dot(beta, beta),
        "casimir2": dot(gamma, gamma),
        "casimir3": dot(beta, gamma),
        **{f"omega{n + 1}": value for n, value in enumerate(omega)},
        "jacobi": jacobi,
    }


def shaken(given: Vector) -> list[Any]:
    """Parameters of a heavy top that feels gravity and the acceleration of its pivot."""
    *top, a, w, t = given
    top[4] -= a * w**2 * circular("cos", w * t)
    return top


RATES = {
    "quadrotor": quadrotor_rates,
    "spacecraft_wheels": wheels_rates,
    "gravity_gradient_satellite": satellite_rates,
    "orbiting_body": orbit_rates,
    "kapitza_top": lambda x, p: heavy_top_rates(x, shaken(p)),
    "double_bracket_body": falling_body_rates,
    "metriplectic_body": relaxing_body_rates,
    "stochastic_rigid_body": lambda x, p: rigid_body_rates(x, p[:3]),  # Stratonovich's drift
    "landau_lifshitz_gilbert": gilbert_rates,
    "heavy_top_damped": damped_top_rates,
    "bloch": bloch_rates,
    "lorenz_gyrostat": lorenz_rates,
}
OBSERVABLES = {
    "quadrotor": quadrotor_observables,
    "spacecraft_wheels": wheels_observables,
    "gravity_gradient_satellite": satellite_observables,
    "orbiting_body": orbit_observables,
    "kapitza_top": lambda x, p: heavy_top_observables(x, shaken(p)),
    "double_bracket_body": lambda x, p: rigid_body_observables(x, p[:3]),
    "metriplectic_body": lambda x, p: rigid_body_observables(x, p[:3]),
    "stochastic_rigid_body": lambda x, p: rigid_body_observables(x, p[:3]),
    "landau_lifshitz_gilbert": gilbert_observables,
    "heavy_top_damped": lambda x, p: heavy_top_observables(x, p[:8]),
    "bloch": bloch_observables,
    "lorenz_gyrostat": lorenz_observables,
}
TENSORS = {
    "quadrotor": lambda x, p: quadrotor_tensor(x),
    "spacecraft_wheels": lambda x, p: wheels_tensor(x),
    "gravity_gradient_satellite": lambda x, p: vehicle_tensor(x),
    "orbiting_body": lambda x, p: orbit_tensor(x),
    "kapitza_top": lambda x, p: se3_tensor(x),
    "double_bracket_body": lambda x, p: rigid_body_tensor(x),
    "metriplectic_body": lambda x, p: rigid_body_tensor(x),
    "stochastic_rigid_body": lambda x, p: rigid_body_tensor(x),
    "landau_lifshitz_gilbert": lambda x, p: rigid_body_tensor(x),
    "heavy_top_damped": lambda x, p: se3_tensor(x),
    "bloch": lambda x, p: rigid_body_tensor(x),
    "lorenz_gyrostat": lorenz_tensor,
}
STATES = {
    "quadrotor": (
        *("Pi1", "Pi2", "Pi3", "P1", "P2", "P3"),
        *("Gamma1", "Gamma2", "Gamma3", "Gamma4"),
    ),
    "spacecraft_wheels": ("q0", "q1", "q2", "q3", "Pi1", "Pi2", "Pi3", "L1", "L2", "L3"),
    "gravity_gradient_satellite": (
        *("Pi1", "Pi2", "Pi3", "beta1", "beta2", "beta3"),
        *("gamma1", "gamma2", "gamma3"),
    ),
    "orbiting_body": (
        *("Pi1", "Pi2", "Pi3", "P1", "P2", "P3", "g11", "g12", "g13", "g14"),
        *("g21", "g22", "g23", "g24", "g31", "g32", "g33", "g34"),
    ),
    "kapitza_top": ("Pi1", "Pi2", "Pi3", "Gamma1", "Gamma2", "Gamma3"),
    "double_bracket_body": ("Pi1", "Pi2", "Pi3"),
    "metriplectic_body": ("Pi1", "Pi2", "Pi3"),
    "stochastic_rigid_body": ("Pi1", "Pi2", "Pi3"),
    "landau_lifshitz_gilbert": ("m1", "m2", "m3"),
    "heavy_top_damped": ("Pi1", "Pi2", "Pi3", "Gamma1", "Gamma2", "Gamma3"),
    "bloch": ("M1", "M2", "M3"),
    "lorenz_gyrostat": ("x", "y", "z"),
}
PARAMETERS = {
    "quadrotor": ("J1", "J2", "J3", "m", "g"),
    "spacecraft_wheels": ("I1", "I2", "I3", "J1", "J2", "J3"),
    "gravity_gradient_satellite": ("I1", "I2", "I3", "n"),
    "orbiting_body": ("I1", "I2", "I3", "m", "mu"),
    "kapitza_top": ("I1", "I2", "I3", "m", "g", "chi1", "chi2", "chi3", "a", "w"),
    "double_bracket_body": ("I1", "I2", "I3", "alpha"),
    "metriplectic_body": ("I1", "I2", "I3", "alpha"),
    "stochastic_rigid_body": ("I1", "I2", "I3", "sigma1", "sigma2", "sigma3"),
    "landau_lifshitz_gilbert": ("gamma", "alpha", "B1", "B2", "B3", "K"),
    "heavy_top_damped": (
        *("I1", "I2", "I3", "m", "g", "chi1", "chi2", "chi3"),
        *("d1", "d2", "d3", "tau1", "tau2", "tau3"),
    ),
    "bloch": ("omega1", "omega2", "omega3", "T1", "T2", "M0"),
    "lorenz_gyrostat": ("sigma", "r", "b"),
}
#: Inputs, and time.
DRIVING = {
    "quadrotor": ("f", "M1", "M2", "M3"),
    "spacecraft_wheels": ("u1", "u2", "u3"),
    "kapitza_top": ("t",),
}
