"""Waves, charges and tops of Hamiltonian mechanics typed by hand, for comparison with ours.

Each function takes the components of state and parameters as flat sequences and returns a flat
list, or values by name; `tests.sources.textbook` has them by system.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from tests.sources.bodies import se3_tensor
from tests.sources.classical import inverse_on
from tests.sources.components import Vector, cross, dot, hat, minus, plus, times
from tests.sources.phase_spaces import paired
from tests.sources.points import length, named

# -- three waves: Alber, Luther, Marsden and Robbins (1998) ----------------------------------------


def times_complex(a: Vector, b: Vector) -> list[Any]:
    """The product of complex numbers ``(Re, Im)``."""
    return [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]


def conjugate(a: Vector) -> list[Any]:
    """``(Re, -Im)``."""
    return [a[0], -a[1]]


def waves_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``a1' = -i a2^* a3``, ``a2' = -i a1^* a3``, ``a3' = -i a1 a2``."""
    a1, a2, a3 = zip(state[:3], state[3:], strict=True)
    pumped = [times_complex(conjugate(a2), a3), times_complex(conjugate(a1), a3)]
    rates = [times_complex((0, -1), x) for x in (*pumped, times_complex(a1, a2))]
    return [*(x for x, _ in rates), *(y for _, y in rates)]


def waves_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """``Re(a1 a2 a3^*)``, the invariants of Manley and Rowe, and tr L^3 with tr L^2."""
    a1, a2, a3 = zip(state[:3], state[3:], strict=True)
    one, two, three = (x * x + y * y for x, y in (a1, a2, a3))
    return {
        "energy": times_complex(times_complex(a1, a2), conjugate(a3))[0],
        "J1": -(one + three) / 2,
        "J2": -(two + three) / 2,
        # up to a factor (L^2)_11 - (L^2)_33, and tr L^2
        "integral1": one - two,
        "integral2": one + two + 2 * three,
    }


# -- Steklov's body in a fluid (1893) --------------------------------------------------------------


def steklov_parts(parameters: Vector) -> tuple[Vector, list[Any], list[Any]]:
    """``a_j``, ``b_j = kappa a1 a2 a3/a_j + nu`` and ``c_1 = kappa^2 a1 (a2 - a3)^2 + sigma``."""
    *a, kappa, nu, sigma = parameters
    whole = kappa * a[0] * a[1] * a[2]
    b = [whole / each + nu for each in a]
    gaps = a[1] - a[2], a[2] - a[0], a[0] - a[1]
    return a, b, [kappa**2 * x * gap**2 + sigma for x, gap in zip(a, gaps, strict=True)]


def steklov_velocities(state: Vector, parameters: Vector) -> tuple[list[Any], list[Any]]:
    """``Omega = a Pi + b P``, ``v = b Pi + c P``, axis by axis."""
    a, b, c = steklov_parts(parameters)
    axes = list(zip(a, b, c, state[:3], state[3:], strict=True))
    return [x * m + y * p for x, y, _, m, p in axes], [y * m + z * p for _, y, z, m, p in axes]


def steklov_rates(state: Vector, parameters: Vector) -> list[Any]:
    """Kirchhoff: ``dPi/dt = Pi x Omega + P x v``, ``dP/dt = P x Omega``."""
    Pi, P = state[:3], state[3:]
    omega, v = steklov_velocities(state, parameters)
    return [*plus(cross(Pi, omega), cross(P, v)), *cross(P, omega)]


def steklov_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, Casimirs, velocities, and the integral of Steklov."""
    Pi, P = state[:3], state[3:]
    a, _, _ = steklov_parts(parameters)
    kappa = parameters[3]
    omega, v = steklov_velocities(state, parameters)
    turned = sum((m - 2 * kappa * x * p) * m for m, x, p in zip(Pi, a, P, strict=True))
    gaps = sum((a[i] - a[j]) ** 2 * P[k] ** 2 for i, j, k in ((1, 2, 0), (2, 0, 1), (0, 1, 2)))
    return {
        "energy": (dot(Pi, omega) + dot(P, v)) / 2,
        "casimir1": dot(P, P),
        "casimir2": dot(Pi, P),
        **named("Omega", omega),
        **named("v", v),
        "F": (turned + kappa**2 * gaps) / 2,
    }


# -- Hess's top (1890) -----------------------------------------------------------------------------


def hess_velocity(state: Vector, parameters: Vector) -> list[Any]:
    """``I Omega = Pi`` with ``I2 = I1 - d^2/I3``."""
    I1, I3, d = parameters[:3]
    return inverse_on([[I1, 0, d], [0, I1 - d * d / I3, 0], [d, 0, I3]], state[:3])


def hess_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``dPi/dt = Pi x Omega + m g chi Gamma x e3``, ``dGamma/dt = Gamma x Omega``."""
    Pi, Gamma, omega = state[:3], state[3:], hess_velocity(state, parameters)
    m, g, chi = parameters[3:]
    return [*plus(cross(Pi, omega), cross(Gamma, [0, 0, m * g * chi])), *cross(Gamma, omega)]


def hess_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, Casimirs and angular velocity."""
    Pi, Gamma, omega = state[:3], state[3:], hess_velocity(state, parameters)
    m, g, chi = parameters[3:]
    return {
        "energy": dot(Pi, omega) / 2 + m * g * chi * Gamma[2],
        "casimir1": dot(Gamma, Gamma),
        "casimir2": dot(Pi, Gamma),
        **named("Omega", omega),
    }


# -- Maxwell and Bloch: David and Holm (1992) ------------------------------------------------------


def maxwell_rates(x: Vector, parameters: Vector) -> list[Any]:
    """``(x2, x1 x3, -x1 x2)``."""
    return [x[1], x[0] * x[2], -x[0] * x[1]]


def maxwell_observables(x: Vector, parameters: Vector) -> dict[str, Any]:
    """``h = x3 + x1^2/2`` and ``x2^2 + x3^2``."""
    return {"energy": x[2] + x[0] * x[0] / 2, "casimir1": x[1] * x[1] + x[2] * x[2]}


# -- charges in a magnetic bottle: Northrop (1963), Littlejohn (1983) ------------------------------


def bottle_field(x: Vector, B0: Any, L: Any) -> list[Any]:
    """``B0 (-x z/L^2, -y z/L^2, 1 + z^2/L^2)``."""
    w = x[2] / L**2
    return times(B0, [-x[0] * w, -x[1] * w, 1 + x[2] * w])


def bottle_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``m dv/dt = q v x B``."""
    m, q, *shape = parameters
    return [*state[3:], *times(q / Fraction(m), cross(state[3:], bottle_field(state[:3], *shape)))]


def bottle_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, ``v . B/|B|``, ``m v_across^2/(2 |B|)``, and ``m (r x v)_3 + q A_phi rho``."""
    (m, q, B0, L), x, v = parameters, state[:3], state[3:]
    B = bottle_field(x, B0, L)
    strength = length(dot(B, B))
    along = dot(v, B) / strength
    flux = q * B0 * (x[0] ** 2 + x[1] ** 2) * (1 + x[2] ** 2 / L**2) / 2
    return {
        "energy": m * dot(v, v) / 2,
        "along": along,
        "moment": m * (dot(v, v) - along**2) / (2 * strength),
        "J": m * cross(x, v)[2] + flux,
    }


def bottle_tensor(state: Vector, parameters: Vector) -> list[list[Any]]:
    """``{x_i, v_j} = delta_ij/m`` and ``{v_i, v_j} = q eps_ijk B_k/m^2``."""
    m, q, *shape = parameters
    rows = paired([1 / m] * 3)
    for i, row in enumerate(hat(times(-q / m**2, bottle_field(state[:3], *shape)))):
        rows[3 + i][3:] = row
    return rows


def slopes(function: Any, x: Vector) -> list[list[Any]]:
    """Derivatives of a vector by the three coordinates, by central differences to 50 digits."""
    step, found = Fraction(1, 10**25), []
    for n in range(3):
        up, down = ([a + s * step * (i == n) for i, a in enumerate(x)] for s in (1, -1))
        found.append(times(1 / (2 * step), minus(function(up), function(down))))
    return found


def centre_parts(state: Vector, parameters: Vector) -> tuple[list[Any], Any, list[Any], Any]:
    """``b``, ``|B|``, its gradient, and ``B* = B + (m u/q) curl b``; all from B by differences."""
    m, q, _, *shape = parameters

    def strength(x: Vector) -> list[Any]:
        B = bottle_field(x, *shape)
        return [length(dot(B, B))]

    def direction(x: Vector) -> list[Any]:
        return times(1 / strength(x)[0], bottle_field(x, *shape))

    dx, dy, dz = slopes(direction, state[:3])
    curl = [dy[2] - dz[1], dz[0] - dx[2], dx[1] - dy[0]]
    starred = plus(bottle_field(state[:3], *shape), times(m * state[3] / q, curl))
    gradient = [slope for (slope,) in slopes(strength, state[:3])]
    return direction(state[:3]), strength(state[:3])[0], gradient, starred


def centre_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``X' = (u B* + b x mu grad B/q)/(b . B*)``, ``u' = -B* . mu grad B/(m b . B*)``."""
    m, q, mu, *_ = parameters
    b, _, gradient, starred = centre_parts(state, parameters)
    parallel = dot(b, starred)
    moved = plus(times(state[3], starred), times(mu / q, cross(b, gradient)))
    return [*times(1 / parallel, moved), -mu * dot(starred, gradient) / (m * parallel)]


def centre_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """``m u^2/2 + mu |B|``, the rates by the names of velocities, and ``q A_phi rho``."""
    m, q, mu, B0, L = parameters
    x, y, z, u = state
    flux = B0 * (x**2 + y**2) * (1 + z**2 / L**2) / 2
    return {
        "energy": m * u**2 / 2 + mu * centre_parts(state, parameters)[1],
        **dict(zip(("V1", "V2", "V3", "a"), centre_rates(state, parameters), strict=True)),
        "J": q * flux,
    }


def centre_tensor(state: Vector, parameters: Vector) -> list[list[Any]]:
    """``{F, G} = B* . (grad F G_u - F_u grad G)/(m B*_b) - b . grad F x grad G/(q B*_b)``."""
    m, q, *_ = parameters
    b, _, _, starred = centre_parts(state, parameters)
    parallel = dot(b, starred)
    across = hat(times(1 / (q * parallel), b))  # minus b . e_i x e_j is the entry of hat(b)
    along = times(1 / (m * parallel), starred)
    return [
        *([*row, edge] for row, edge in zip(across, along, strict=True)),
        [*times(-1, along), 0],
    ]


# -- the top in two fields, as Reyman and Semenov-Tian-Shansky (1987) and Kharlamov have it --------


def top_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``alpha' = alpha x w``, ``2 w1' = w2 w3 + beta3`` and so on, times I."""
    moment, a, b = parameters
    rows, (p1, p2, p3) = [state[:3], state[3:6], state[6:9]], state[9:]
    w1, w2, w3 = w = [p1 / (2 * moment), p2 / (2 * moment), p3 / moment]
    alpha, beta = times(a, rows[0]), times(b, rows[1])
    moved = [moment * w2 * w3 + beta[2], -moment * w1 * w3 - alpha[2], alpha[1] - beta[0]]
    return [*(x for row in rows for x in cross(row, w)), *moved]


def top_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """``(w1^2 - w2^2 + alpha1 - beta2)^2 + (2 w1 w2 + alpha2 + beta1)^2``, and Kharlamov's G."""
    moment, a, b = parameters
    rows, momentum = [state[:3], state[3:6], state[6:9]], state[9:]
    w1, w2, w3 = w = [momentum[0] / (2 * moment), momentum[1] / (2 * moment), momentum[2] / moment]
    alpha, beta = times(a / moment, rows[0]), times(b / moment, rows[1])
    gamma = times(a * b / moment**2, rows[2])
    along = [dot(x, [w1, w2, w3 / 2]) for x in (alpha, beta, gamma)]
    G = along[0] ** 2 + along[1] ** 2 + w3 * along[2]
    G -= alpha[0] * (b / moment) ** 2 + beta[1] * (a / moment) ** 2
    grams = {(i, j): dot(rows[i], rows[j]) for i in range(3) for j in range(i, 3)}
    return {
        "energy": moment * (w1**2 + w2**2 + w3**2 / 2 - alpha[0] - beta[1]),
        **named("Omega", w),
        "K": (w1**2 - w2**2 + alpha[0] - beta[1]) ** 2 + (2 * w1 * w2 + alpha[1] + beta[0]) ** 2,
        "G": moment**4 * G,
        # by the matrix of cofactors, which is R where R is a rotation
        **named("Pi_spatial", [dot(cross(rows[n - 2], rows[n - 1]), momentum) for n in range(3)]),
        **{f"R_gram{i + 1}{j + 1}": value for (i, j), value in grams.items()},
    }


def top_tensor(state: Vector) -> list[list[Any]]:
    """``{alpha_i, Pi_j} = -epsilon_ijk alpha_k`` for each row of R, and so for Pi."""
    turned = [hat(state[n : n + 3]) for n in range(0, 12, 3)]
    rows = [[0] * 9 + row for each in turned[:3] for row in each]
    return rows + [[x for each in turned for x in each[i]] for i in range(3)]


RATES = {
    "two_field_top": top_rates,
    "three_wave": waves_rates,
    "steklov": steklov_rates,
    "hess_appelrot": hess_rates,
    "maxwell_bloch": maxwell_rates,
    "magnetic_bottle": bottle_rates,
    "guiding_centre": centre_rates,
}
OBSERVABLES = {
    "two_field_top": top_observables,
    "three_wave": waves_observables,
    "steklov": steklov_observables,
    "hess_appelrot": hess_observables,
    "maxwell_bloch": maxwell_observables,
    "magnetic_bottle": bottle_observables,
    "guiding_centre": centre_observables,
}
TENSORS = {
    "two_field_top": lambda x, p: top_tensor(x),
    "three_wave": lambda x, p: paired([1] * 3),
    "steklov": lambda x, p: se3_tensor(x),
    "hess_appelrot": lambda x, p: se3_tensor(x),
    "maxwell_bloch": lambda x, p: hat([0, x[1], x[2]]),
    "magnetic_bottle": bottle_tensor,
    "guiding_centre": centre_tensor,
}
STATES = {
    "two_field_top": (
        *(f"R{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)),
        *("Pi1", "Pi2", "Pi3"),
    ),
    "three_wave": ("q1", "q2", "q3", "p1", "p2", "p3"),
    "steklov": ("Pi1", "Pi2", "Pi3", "P1", "P2", "P3"),
    "hess_appelrot": ("Pi1", "Pi2", "Pi3", "Gamma1", "Gamma2", "Gamma3"),
    "maxwell_bloch": ("x1", "x2", "x3"),
    "magnetic_bottle": ("x1", "x2", "x3", "v1", "v2", "v3"),
    "guiding_centre": ("X1", "X2", "X3", "u"),
}
PARAMETERS = {
    "two_field_top": ("I", "a", "b"),
    "three_wave": (),
    "steklov": ("a1", "a2", "a3", "kappa", "nu", "sigma"),
    "hess_appelrot": ("I1", "I3", "d", "m", "g", "chi"),
    "maxwell_bloch": (),
    "magnetic_bottle": ("m", "q", "B0", "L"),
    "guiding_centre": ("m", "q", "mu", "B0", "L"),
}
#: With lengths of the state, typed to 80 digits.
CONFIGURATIONS = ("magnetic_bottle", "guiding_centre")
