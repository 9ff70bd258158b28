"""Classical nonholonomic motions typed by hand, for comparison with ours.

Every constraint ``A xi = 0`` is differentiated once, and the multipliers follow from
``p' - F = A^T lambda``: the formulas hold beside the constraint, too. Each function takes the
components of state and parameters as flat sequences and returns a flat list, or values by name;
`tests.sources.textbook` has them by system.
"""

from __future__ import annotations

from typing import Any

from tests.sources.components import Vector, cross, dot, plus, times
from tests.sources.points import circular, named

# -- bodies with a forbidden axis: Suslov (1946), Veselov and Veselova (1988) ----------------------


def symmetric(entries: Vector) -> list[Vector]:
    """The matrix with the entries 11, 12, 13, 22, 23, 33."""
    a, b, c, d, e, f = entries
    return [[a, b, c], [b, d, e], [c, e, f]]


def on(matrix: list[Vector], vector: Vector) -> list[Any]:
    """A matrix times a vector."""
    return [dot(row, vector) for row in matrix]


def inverse_on(matrix: list[Vector], vector: Vector) -> list[Any]:
    """``M^-1 v`` of a symmetric matrix: its rows' cross products over the determinant."""
    one, two, three = matrix
    determinant = dot(one, cross(two, three))
    adjugate = [cross(two, three), cross(three, one), cross(one, two)]
    return [value / determinant for value in on(adjugate, vector)]


def axis_forbidden(
    inertia: list[Vector], Omega: Vector, axis: Vector, carried: Any
) -> tuple[list[Any], Any]:
    """``I Omega' = I Omega x Omega + lambda n`` with ``n . Omega' = carried``: Omega', lambda."""
    free = inverse_on(inertia, cross(on(inertia, Omega), Omega))
    along = inverse_on(inertia, axis)
    multiplier = (carried - dot(axis, free)) / dot(axis, along)
    return plus(free, times(multiplier, along)), multiplier


def suslov_motion(state: Vector, parameters: Vector) -> tuple[list[Any], Any]:
    """The axis is fixed in the body."""
    return axis_forbidden(symmetric(parameters[:6]), state, parameters[6:], 0)


def suslov_rates(state: Vector, parameters: Vector) -> list[Any]:
    """Suslov's equations."""
    return suslov_motion(state, parameters)[0]


def suslov_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Kinetic energy, the torque that holds the body, and momentum."""
    momentum = on(symmetric(parameters[:6]), state)
    return {
        "energy": dot(state, momentum) / 2,
        "wheels_reaction": suslov_motion(state, parameters)[1],
        **named("Omega_momentum", momentum),
    }


def diagonal(entries: Vector) -> list[Vector]:
    """The diagonal matrix with these entries."""
    return [[entries[0], 0, 0], [0, entries[1], 0], [0, 0, entries[2]]]


def veselova_motion(state: Vector, parameters: Vector) -> tuple[list[Any], Any]:
    """The axis is fixed in space: ``(Gamma . Omega)' = Gamma . Omega'``, since Gamma' _|_ Omega."""
    return axis_forbidden(diagonal(parameters), state[:3], state[3:], 0)


def veselova_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``Gamma' = Gamma x Omega``."""
    return [*veselova_motion(state, parameters)[0], *cross(state[3:], state[:3])]


def veselova_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Kinetic energy, the torque, ``I Omega`` and ``I Omega x Gamma``."""
    momentum = on(diagonal(parameters), state[:3])
    return {
        "energy": dot(momentum, state[:3]) / 2,
        "twistless_reaction": veselova_motion(state, parameters)[1],
        **named("Omega_momentum", momentum),
        **named("K", cross(momentum, state[3:])),
    }


# -- Chaplygin's sleigh: Bloch (2003), section 1.7 -------------------------------------------------


def sleigh_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``v' = a omega^2``, ``(I + m a^2) omega' = -m a v omega``."""
    (v, omega), (m, inertia, a) = state, parameters
    return [a * omega**2, -m * a * v * omega / (inertia + m * a**2)]


def sleigh_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Kinetic energy, the force across the blade, mass times acceleration there, and momenta."""
    (v, omega), (m, inertia, a) = state, parameters
    across = a * sleigh_rates(state, parameters)[1] + v * omega
    return {
        "energy": (m * v**2 + (inertia + m * a**2) * omega**2) / 2,
        "u": 0 * v,
        "blade_reaction": m * across,
        "v_momentum": m * v,
        "omega_momentum": (inertia + m * a**2) * omega,
    }


def sleigh_tensor(state: Vector, parameters: Vector) -> list[list[Any]]:
    """``{p_v, p_omega} = <p, P2> = m a omega``, since ``[P1, J] = -P2``."""
    bracket = parameters[0] * parameters[2] * state[1]
    return [[0, bracket], [-bracket, 0]]


# -- vertical disk: Bloch (2003), section 1.4 ------------------------------------------------------


def upright_rates(state: Vector, parameters: Vector) -> list[Any]:
    """Rolling and turning at constant rates, ``(x, y)' = r theta' (cos phi, sin phi)``."""
    _, phi, _, _, rolling, turning = state
    r = parameters[1]
    x, y = (r * rolling * circular(f, phi) for f in ("cos", "sin"))
    return [rolling, turning, x, y, 0 * rolling, 0 * turning]


def upright_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, momenta, velocities, and the force that bends the path, ``m v phi'`` across it."""
    _, _, _, _, rolling, turning = state
    m, r, inertia, about = parameters
    vx, vy = upright_rates(state, parameters)[2:4]
    momentum = (inertia + m * r**2) * rolling
    return {
        "energy": (momentum * rolling + about * turning**2) / 2,
        "vx": vx,
        "vy": vy,
        "rolling_x_reaction": -m * turning * vy,
        "rolling_y_reaction": m * turning * vx,
        "vtheta_momentum": momentum,
        "vphi_momentum": about * turning,
    }


def upright_tensor(state: Vector, parameters: Vector) -> list[list[Any]]:
    """``{q, p_theta} = (1, 0, r cos phi, r sin phi)`` and ``{phi, p_phi} = 1``.

    ``{p_theta, p_phi} = -<p, [D_theta, D_phi]>`` vanishes: the bracket of the fields is across the
    path, and the momentum along it.
    """
    r = parameters[1]
    x, y = (r * circular(f, state[1]) for f in ("cos", "sin"))
    return [
        [0, 0, 0, 0, 1, 0],
        [0, 0, 0, 0, 0, 1],
        [0, 0, 0, 0, x, 0],
        [0, 0, 0, 0, y, 0],
        [-1, 0, -x, -y, 0, 0],
        [0, -1, 0, 0, 0, 0],
    ]


# -- snakeboard: Bloch, Krishnaprasad, Marsden and Murray (1996), section 8.4 ----------------------


def snakeboard_motion(state: Vector, parameters: Vector) -> tuple[list[Any], Any, Any]:
    """Accelerations of v1, v2, omega and psi, then the multipliers of back and front.

    The sum of the constraints is ``2 cos(phi) v2 = 0``; half their difference, front less back, is
    ``sin(phi) v1 + l cos(phi) omega = 0`` and has the multiplier ``front - back``.
    """
    (v1, v2, omega, _, phi, _, turning), (m, J, _, J1, l) = state, parameters  # noqa: E741
    s, c = circular("sin", phi), circular("cos", phi)
    board = J + 2 * J1  # the rotor turns freely: (J + J0 + 2 J1) omega' + J0 psi'' is this omega'
    carried = -turning * (c * v1 - l * s * omega)
    pull = (carried - s * omega * v2) / (s**2 / m + l**2 * c**2 / board)
    along, turned = omega * v2 + pull * s / m, pull * l * c / board
    across = turning * s * v2 / c
    hold = m * (across + omega * v1) / c
    return [along, across, turned, -turned], (hold - pull) / 2, (hold + pull) / 2


def snakeboard_rates(state: Vector, parameters: Vector) -> list[Any]:
    """The rotor goes the other way than the board, and the wheels turn freely."""
    (along, across, turned, rotor), _, _ = snakeboard_motion(state, parameters)
    return [along, across, turned, *state[5:], rotor, 0 * rotor]


def snakeboard_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, forces on the wheels, momenta, and ``<dl/dxi, (-2 l cos^2 phi, 0, sin 2 phi)>``."""
    (v1, v2, omega, _, phi, rotor, turning), (m, J, J0, J1, l) = state, parameters  # noqa: E741
    s, c = circular("sin", phi), circular("cos", phi)
    _, back, front = snakeboard_motion(state, parameters)
    board = (J + 2 * J1) * omega
    free = J0 * (omega + rotor)
    kinetic = m * (v1**2 + v2**2) + board * omega + free * (omega + rotor) + 2 * J1 * turning**2
    return {
        "energy": kinetic / 2,
        "back_reaction": back,
        "front_reaction": front,
        "p": -2 * l * c**2 * m * v1 + 2 * s * c * (board + free),
        "v1_momentum": m * v1,
        "v2_momentum": m * v2,
        "omega_momentum": board + free,
        "vpsi_momentum": free,
        "vphi_momentum": 2 * J1 * turning,
    }


# -- a blade between oscillators: after Modin and Verdier (2020) -----------------------------------


def blade_motion(state: Vector, parameters: Vector) -> tuple[list[Any], Any]:
    """``(x, z)'' = F + lambda n`` with ``n = (-sin xi, cos xi)``; the driver does not feel it."""
    (xi, x, z, turning, vx, vz), (k, eps, kx, kz, g) = state, parameters
    s, c = circular("sin", xi), circular("cos", xi)
    fx, fz = g - kx * x, -kz * z
    multiplier = turning * (c * vx + s * vz) - (c * fz - s * fx)
    driven = -k * s - eps * (2 * c**2 - 1)
    return [driven, fx - multiplier * s, fz + multiplier * c], multiplier


def blade_rates(state: Vector, parameters: Vector) -> list[Any]:
    """Velocities and accelerations."""
    return [*state[3:], *blade_motion(state, parameters)[0]]


def blade_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy of the whole and of the driver, the force across the blade, and momenta."""
    (xi, x, z, turning, vx, vz), (k, eps, kx, kz, g) = state, parameters
    s, c = circular("sin", xi), circular("cos", xi)
    driver = turning**2 / 2 - k * c + eps * s * c
    rest = (vx**2 + vz**2 + kx * x**2 + kz * z**2) / 2 - g * x
    return {
        "energy": driver + rest,
        "driver": driver,
        "blade_reaction": blade_motion(state, parameters)[1],
        "vxi_momentum": turning,
        "vx_momentum": vx,
        "vz_momentum": vz,
    }


def allowed(name: str, point: dict[str, Any]) -> dict[str, Any]:
    """A point moved to where its velocities obey the constraints that are kept."""
    if name in ("suslov", "veselova"):
        n1, n2, n3 = (point[f"{'a' if name == 'suslov' else 'Gamma'}{i}"] for i in (1, 2, 3))
        return point | {"Omega3": -(n1 * point["Omega1"] + n2 * point["Omega2"]) / n3}
    if name == "double_spherical_pendulum":
        for n in (1, 2):
            x, y, z = (point[f"gamma{n}_{i}"] for i in (1, 2, 3))
            point = point | {f"v{n}_3": -(x * point[f"v{n}_1"] + y * point[f"v{n}_2"]) / z}
        return point
    if name == "snakeboard":
        s, c = circular("sin", point["phi"]), circular("cos", point["phi"])
        return point | {"v1": -point["l"] * point["omega"] * c / s, "v2": 0 * s}
    if name == "knife_edge_cvt":
        s, c = circular("sin", point["xi"]), circular("cos", point["xi"])
        return point | {"vz": point["vx"] * s / c}
    return point


RATES = {
    "suslov": suslov_rates,
    "veselova": veselova_rates,
    "chaplygin_sleigh": sleigh_rates,
    "rolling_disk_vertical": upright_rates,
    "snakeboard": snakeboard_rates,
    "knife_edge_cvt": blade_rates,
}
OBSERVABLES = {
    "suslov": suslov_observables,
    "veselova": veselova_observables,
    "chaplygin_sleigh": sleigh_observables,
    "rolling_disk_vertical": upright_observables,
    "snakeboard": snakeboard_observables,
    "knife_edge_cvt": blade_observables,
}
#: State and parameters, as declared.
STATES = {
    "suslov": ("Omega1", "Omega2", "Omega3"),
    "veselova": ("Omega1", "Omega2", "Omega3", "Gamma1", "Gamma2", "Gamma3"),
    "chaplygin_sleigh": ("v", "omega"),
    "rolling_disk_vertical": ("theta", "phi", "x", "y", "vtheta", "vphi"),
    "snakeboard": ("v1", "v2", "omega", "psi", "phi", "vpsi", "vphi"),
    "knife_edge_cvt": ("xi", "x", "z", "vxi", "vx", "vz"),
}
PARAMETERS = {
    "suslov": ("I11", "I12", "I13", "I22", "I23", "I33", "a1", "a2", "a3"),
    "veselova": ("I1", "I2", "I3"),
    "chaplygin_sleigh": ("m", "I", "a"),
    "rolling_disk_vertical": ("m", "r", "I", "J"),
    "snakeboard": ("m", "J", "J0", "J1", "l"),
    "knife_edge_cvt": ("k", "eps", "kx", "kz", "g"),
}
#: Brackets of the state, velocities standing for their momenta, where no constraint is kept.
TENSORS = {"chaplygin_sleigh": sleigh_tensor, "rolling_disk_vertical": upright_tensor}
#: With sines and cosines of the state, typed to 80 digits.
CONFIGURATIONS = ("rolling_disk_vertical", "snakeboard", "knife_edge_cvt")
#: Whose rates are quotients in the state.
QUOTIENTS = ("veselova",)
