"""Machines and balls with constraints typed by hand, for comparison with ours.

The forces of the constraints are those of Newton's laws: across axles, along rods, at a joint, at
a point of contact. Each function takes the components of state and parameters as flat sequences
and returns a flat list, or values by name; `tests.sources.textbook` has them by system.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from tests.sources import planes
from tests.sources.components import Vector, cross, dot, hat, minus, plus, times
from tests.sources.points import circular, named

PLANES = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))


# -- Suslov's problem on so(5): Fedorov and Kozlov (1995) ------------------------------------------


def suslov_5_parts(w: Vector, parameters: Vector) -> tuple[list[Any], list[Any], list[Any]]:
    """``K + j``, ``(K + j) w`` and ``dw/dt``."""
    K, k, j = parameters[:4], parameters[4:8], parameters[8]
    inertia = [each + j for each in K]
    pull, square = (sum(a * b for a, b in zip(x, w, strict=True)) for x in (k, w))
    force = [pull * a - square * b for a, b in zip(w, k, strict=True)]
    momentum = [i * a for i, a in zip(inertia, w, strict=True)]
    return inertia, momentum, [f / i for f, i in zip(force, inertia, strict=True)]


def suslov_5_rates(w: Vector, parameters: Vector) -> list[Any]:
    """``(K + j) dw/dt = (k . w) w - (w . w) k``."""
    return suslov_5_parts(w, parameters)[2]


def suslov_5_planes(w: Vector, k: Vector) -> list[Any]:
    """``M_ij = w_i k_j - k_i w_j``: the momentum in the planes that do not turn."""
    return [w[i] * k[j] - k[i] * w[j] for i, j in PLANES]


def suslov_5_observables(w: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, no other velocity, and ``dM_ij/dt - [M, Omega]_ij`` in these planes."""
    k = parameters[4:8]
    _, momentum, rates = suslov_5_parts(w, parameters)
    moved = suslov_5_planes(rates, k)
    turned = [w[i] * momentum[j] - momentum[i] * w[j] for i, j in PLANES]
    return {
        "energy": sum(a * b for a, b in zip(w, momentum, strict=True)) / 2,
        **named("u", [0 * w[0]] * 6),
        **named("planes_reaction", minus(moved, turned)),
        **named("w_momentum", momentum),
    }


def suslov_5_tensor(w: Vector, parameters: Vector) -> list[list[Any]]:
    """``-<M, [E_i5, E_j5]> = M_ij``."""
    rows: list[list[Any]] = [[0] * 4 for _ in range(4)]
    for (i, j), value in zip(PLANES, suslov_5_planes(w, parameters[4:8]), strict=True):
        rows[i][j], rows[j][i] = value, -value
    return rows


# -- roller racer: Krishnaprasad and Tsakiris (2001) -----------------------------------------------


class Racer:
    """Two carriages of a roller racer, each with its own laws of Newton and Euler.

    Args:
        state: v, omega and phi.
        parameters: Masses, moments of inertia and distances.
    """

    def __init__(self, state: Vector, parameters: Vector) -> None:
        (self.v, self.omega, phi), (self.m1, self.m2, self.I1, self.I2, self.d1, self.d2) = (
            state,
            parameters,
        )
        self.s, self.c = circular("sin", phi), circular("cos", phi)
        self.gap = self.d1 * self.c - self.d2
        self.swing = (self.omega * self.gap - self.v * self.s) / self.d2
        self.second = self.omega + self.swing
        self.moving = [
            self.v + self.d2 * self.s * self.second,
            self.d1 * self.omega - self.d2 * self.c * self.second,
        ]

    def laws(self, accelerations: Vector) -> tuple[list[Any], list[Any]]:
        """What vanishes for the right rates of v and omega, and the forces across the axles.

        The joint pushes the second carriage by minus the force that the first one needs: along its
        axis by Newton's law, across by Euler's. The second axle gives no force along its carriage,
        and no torque about its own centre of mass.
        """
        dv, domega = accelerations
        v, s, c, omega, swing, d1, d2 = (
            *(self.v, self.s, self.c, self.omega, self.swing, self.d1, self.d2),
        )
        dswing = (domega * self.gap - omega * d1 * s * swing - dv * s - v * c * swing) / d2
        dsecond = domega + dswing
        moved = [
            dv + d2 * (c * swing * self.second + s * dsecond),
            d1 * domega + d2 * (s * swing * self.second - c * dsecond),
        ]
        x, y = self.moving
        second = times(self.m2, plus(moved, [-omega * y, omega * x]))
        joint = [self.m1 * dv, self.I1 * domega / d1]
        push = plus(second, joint)
        torque = self.I2 * dsecond + d2 * (c * joint[1] - s * joint[0])
        across = [self.m1 * v * omega - joint[1], c * push[1] - s * push[0]]
        return [c * push[0] + s * push[1], torque], across

    @property
    def solved(self) -> list[Any]:
        """The rates of v and omega, and the forces across the axles."""
        (k1, k2), _ = self.laws([0, 0])
        (a, b), (c, d) = (minus(self.laws(unit)[0], [k1, k2]) for unit in ([1, 0], [0, 1]))
        whole = a * d - b * c  # by Cramer's rule
        found = [(c * k2 - d * k1) / whole, (b * k1 - a * k2) / whole]
        return [*found, *self.laws(found)[1]]

    @property
    def momenta(self) -> list[Any]:
        """Those along v, u, omega and the rate of phi, each free."""
        (x, y), d2, turned = self.moving, self.d2, self.I2 * self.second
        swung = turned + self.m2 * d2 * (x * self.s - y * self.c)
        lever = self.I1 * self.omega + swung + self.m2 * y * self.d1
        return [self.m1 * self.v + self.m2 * x, self.m2 * y, lever, swung]


def racer_rates(state: Vector, parameters: Vector) -> list[Any]:
    """Both accelerations, and the rate of phi."""
    racer = Racer(state, parameters)
    return [*racer.solved[:2], racer.swing]


def racer_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, velocities, forces along the declared constraints, and momenta.

    A force N across the second axle does the work ``N (-v s + c u + omega gap - d2 swing) dt``.
    """
    racer = Racer(state, parameters)
    _, _, across1, across2 = racer.solved
    along, _, turning, swung = racer.momenta
    squares = racer.m1 * racer.v**2 + racer.m2 * sum(x * x for x in racer.moving)
    return {
        "energy": (squares + racer.I1 * racer.omega**2 + racer.I2 * racer.second**2) / 2,
        "u": 0 * racer.v,
        "vphi": racer.swing,
        "rear_reaction": across1 + racer.c * across2,
        "front_reaction": -across2 * racer.d2,
        "v_momentum": along - swung * racer.s / racer.d2,
        "omega_momentum": turning + swung * racer.gap / racer.d2,
    }


def racer_tensor(state: Vector, parameters: Vector) -> list[list[Any]]:
    """``{phi, M_v} = f``, ``{phi, M_omega} = g``, ``{M_v, M_omega} = p_u - (f g' - g f') p_phi``.

    Along v and omega are ``D_v = P1 + f d/dphi`` and ``D_omega = J + g d/dphi`` with
    ``f = -sin(phi)/d2`` and ``g = (d1 cos(phi) - d2)/d2``; ``[P1, J] = -P2``.
    """
    racer = Racer(state, parameters)
    _, across, _, swung = racer.momenta
    f, g = -racer.s / racer.d2, racer.gap / racer.d2
    slope = (racer.d1 * racer.s**2 + racer.gap * racer.c) / racer.d2**2
    bracket = across - slope * swung
    return [[0, bracket, -f], [-bracket, 0, -g], [f, g, 0]]


# -- Appell's machine (1911): Neimark and Fufaev (1972) --------------------------------------------


def appell_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``(K b^2 + m a^2 + C) phi'' = m g a - K b rho w^2``, ``(A + K rho^2) w' = K rho b phi' w``.

    K is the mass of frame and weight.
    """
    w, _, _, rolling = state
    M, m, A, C, a, b, rho, g = parameters
    K = M + m
    return [
        K * rho * b * rolling * w / (A + K * rho**2),
        -a * rolling,
        rolling,
        (m * g * a - K * b * rho * w**2) / (K * b**2 + m * a**2 + C),
    ]


def appell_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, velocities, the forces on wheel and thread, and momenta."""
    w, z, _, rolling = state
    M, m, A, C, a, b, rho, g = parameters
    K, (dw, _, _, spun) = M + m, appell_rates(state, parameters)
    momenta = (A + K * rho**2) * w, (K * b**2 + m * a**2 + C) * rolling
    return {
        "energy": (momenta[0] * w + momenta[1] * rolling) / 2 + m * g * z,
        "v1": b * rolling,
        "v2": -rho * w,
        "vz": -a * rolling,
        "rolling_reaction": K * (b * spun + rho * w**2),
        "wheel_reaction": K * (b * rolling * w - rho * dw),
        "thread_reaction": m * (g - a * spun),
        "omega_momentum": momenta[0],
        "vphi_momentum": momenta[1],
    }


def appell_tensor(state: Vector, parameters: Vector) -> list[list[Any]]:
    """``{z, M_phi} = -a``, ``{phi, M_phi} = 1``, and ``[J, b P1] = b P2``."""
    M, m, _, _, a, b, rho, _ = parameters
    bracket = (M + m) * b * rho * state[0]
    return [[0, 0, 0, bracket], [0, 0, 0, -a], [0, 0, 0, 1], [-bracket, a, -1, 0]]


# -- double spherical pendulum: Marsden and Scheurle (1993) ----------------------------------------


def rods(state: Vector) -> list[Vector]:
    """Directions and their rates."""
    return [state[n : n + 3] for n in (0, 3, 6, 9)]


def tensions(state: Vector, parameters: Vector) -> tuple[Any, Any]:
    """From ``(gamma . gamma')' = 0`` of both rods, by Cramer's rule."""
    (one, two, v1, v2), (m1, m2, l1, l2, g) = rods(state), parameters
    lean, first, second = dot(one, two), dot(one, one), dot(two, two)
    a, b, c = first / m1, -lean / m1, second * (1 / Fraction(m1) + 1 / Fraction(m2))
    k1, k2 = l1 * dot(v1, v1) - g * one[2], l2 * dot(v2, v2)
    whole = a * c - b * b
    return (c * k1 - b * k2) / whole, (a * k2 - b * k1) / whole


def rods_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``m1 a1 = -m1 g e3 - T1 gamma1 + T2 gamma2``, ``m2 a2 = -m2 g e3 - T2 gamma2``."""
    (one, two, v1, v2), (m1, m2, l1, l2, g) = rods(state), parameters
    T1, T2 = tensions(state, parameters)
    first = plus(times(-T1 / m1, one), times(T2 / m1, two))
    upper, lower = plus([0, 0, -g], first), plus([0, 0, -g], times(-T2 / m2, two))
    return [
        *v1,
        *v2,
        *times(1 / Fraction(l1), upper),
        *times(1 / Fraction(l2), minus(lower, upper)),
    ]


def rods_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, moments of the tensions, momenta, and angular momentum about the vertical."""
    (one, two, v1, v2), (m1, m2, l1, l2, g) = rods(state), parameters
    T1, T2 = tensions(state, parameters)
    upper = times(l1, v1)
    lower = plus(upper, times(l2, v2))
    p1, p2 = times(l1, plus(times(m1, upper), times(m2, lower))), times(m2 * l2, lower)
    fallen = (m1 + m2) * l1 * one[2] + m2 * l2 * two[2]
    kinetic = m1 * dot(upper, upper) + m2 * dot(lower, lower)
    return {
        "energy": kinetic / 2 + g * fallen,
        "rod1_reaction": -l1 * T1,
        "rod2_reaction": -l2 * T2,
        **named("v1_momentum", p1),
        **named("v2_momentum", p2),
        "J": cross(one, p1)[2] + cross(two, p2)[2],
    }


# -- four links that hang from each other ----------------------------------------------------------

LINKS = range(4)


def links_parts(state: Vector, parameters: Vector) -> tuple[list[list[Any]], list[Any]]:
    """``M_ij = m l^2 (5 - max(i, j)) cos(theta_i - theta_j)`` and what accelerations balance."""
    theta, omega, (m, length, g) = state[:4], state[4:], parameters
    masses = [[m * (4 - max(i, j)) for j in LINKS] for i in LINKS]

    def turned(function: str, i: int, j: int) -> Any:
        return length**2 * masses[i][j] * circular(function, theta[i] - theta[j])

    pulls = [
        -sum(turned("sin", i, j) * omega[j] ** 2 for j in LINKS)
        - g * length * masses[i][i] * circular("sin", theta[i])
        for i in LINKS
    ]
    return [[turned("cos", i, j) for j in LINKS] for i in LINKS], pulls


def links_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``sum_j M_ij theta_j'' = pull_i``, by elimination in the order of the links."""
    matrix, pulls = links_parts(state, parameters)
    rows = [[*row, pull] for row, pull in zip(matrix, pulls, strict=True)]
    for n in LINKS:
        rows[n] = [each / rows[n][n] for each in rows[n]]
        for k in set(LINKS) - {n}:
            rows[k] = minus(rows[k], times(rows[k][n], rows[n]))
    return [*state[4:], *(row[4] for row in rows)]


def links_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy and angular momentum, from the positions and velocities of the masses."""
    theta, omega, (m, length, g) = state[:4], state[4:], parameters
    arms = [(length * circular("sin", each), -length * circular("cos", each)) for each in theta]
    moved = [(-y * w, x * w) for (x, y), w in zip(arms, omega, strict=True)]
    places, speeds = (
        [[sum(arm[k] for arm in given[: n + 1]) for k in (0, 1)] for n in LINKS]
        for given in (arms, moved)
    )
    about = [m * (p[0] * v[1] - p[1] * v[0]) for p, v in zip(places, speeds, strict=True)]
    return {
        "energy": sum(
            m * ((v[0] ** 2 + v[1] ** 2) / 2 + g * p[1])
            for p, v in zip(places, speeds, strict=True)
        ),
        "x": places[3][0],
        "y": places[3][1],
        "L": sum(about),
    }


def links_tensor(state: Vector, parameters: Vector) -> list[list[Any]]:
    """``{theta_i, p_i} = 1``."""
    unit = [[int(i == j) for j in LINKS] for i in LINKS]
    above = [[0] * 4 + row for row in unit]
    return [*above, *([*times(-1, row), 0, 0, 0, 0] for row in unit)]


# -- balls that roll: Fasso and Sansonetto (2016), Routh (1905) ------------------------------------


def turntable_parts(state: Vector, parameters: Vector) -> tuple[list[Any], Any, list[Any]]:
    """The velocity v of the centre, ``nu = W I/(I + m r^2)``, and ``dv/dt = nu e3 x v``."""
    (w1, w2, _, x, y), (inertia, m, r, W) = state, parameters
    v = [r * w2 - W * y, -r * w1 + W * x]
    nu = W * inertia / (inertia + m * r**2)
    return v, nu, [-nu * v[1], nu * v[0]]


def turntable_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``I dw/dt = -r e3 x m dv/dt``."""
    inertia, m, r, _ = parameters
    v, _, moved = turntable_parts(state, parameters)
    lever = r * m / Fraction(inertia)
    return [lever * moved[1], -lever * moved[0], 0 * v[0], *v]


def turntable_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, moving energy, the force of friction, momenta, and the centre of the circle."""
    (*w, x, y), (inertia, m, r, W) = state, parameters
    v, nu, moved = turntable_parts(state, parameters)
    energy = (inertia * dot(w, w) + m * (v[0] ** 2 + v[1] ** 2)) / 2
    held = [inertia * w[0] - m * r * v[1], inertia * w[1] + m * r * v[0], inertia * w[2]]
    return {
        "energy": energy,
        **named("v", v),
        **named("rolling_reaction", times(m, moved)),
        **named("omega_momentum", held),
        "moving": energy - W * (inertia * w[2] + m * (x * v[1] - y * v[0])),
        **named("centre", [x - v[1] / nu, y + v[0] / nu]),
    }


def sphere_parts(state: Vector, parameters: Vector) -> tuple[list[Any], list[Any]]:
    """The rate of n, and dw/dt: ``(I + m r^2 n^2) dw/dt = m r n x (r n' x w + g e3)``."""
    w, n, (inertia, m, r, a, g) = state[:3], state[3:], parameters
    moved = times(r / Fraction(a), cross(n, w))
    push = plus(times(r, cross(moved, w)), [0, 0, g])
    return moved, times(m * r / (inertia + m * r**2 * dot(n, n)), cross(n, push))


def sphere_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``I dw/dt = r n x (m a n'' + m g e3)``, of which n . dw/dt = 0."""
    moved, turned = sphere_parts(state, parameters)
    return [*turned, *moved]


def sphere_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, the force of the sphere times a, momenta, spin, and momentum about the vertical."""
    w, n, (inertia, m, r, a, g) = state[:3], state[3:], parameters
    moved, turned = sphere_parts(state, parameters)
    second = times(r / Fraction(a), plus(cross(moved, w), cross(n, turned)))
    around = cross(n, moved)
    kinetic = inertia * dot(w, w) + m * a**2 * dot(moved, moved)
    return {
        "energy": kinetic / 2 + m * g * a * n[2],
        **named("vn", moved),
        **named("rolling_reaction", times(m * a, plus(times(a, second), [0, 0, g]))),
        **named("omega_momentum", minus(times(inertia, w), times(m * a * r, around))),
        "spin": dot(w, n),
        "J": inertia * w[2] - m * r * a * around[2],
    }


def sphere_tensor(state: Vector, parameters: Vector) -> list[list[Any]]:
    """``{n, M_k} = (r/a) n x e_k``; ``{M_i, M_j} = eps_ijk (I w + m r^2 n x n')_k``.

    Of turning fields ``[X_i, X_j] = -eps_ijk X_k`` in space; of ``V_k = (r/a) n x e_k`` it is
    ``(r/a) eps_ijk V_k``.
    """
    w, n, (inertia, m, r, a, _) = state[:3], state[3:], parameters
    moved = sphere_parts(state, parameters)[0]
    spun = hat(times(-1, plus(times(inertia, w), times(m * r**2, cross(n, moved)))))
    carried = hat(times(r / Fraction(a), n))
    top = [
        [*row, *times(-1, column)]
        for row, column in zip(spun, zip(*carried, strict=True), strict=True)
    ]
    return [*top, *([*row, 0, 0, 0] for row in carried)]


RATES = {
    "suslov_so5": suslov_5_rates,
    "roller_racer": racer_rates,
    "appell_machine": appell_rates,
    "double_spherical_pendulum": rods_rates,
    "n_link_chain": links_rates,
    "ball_on_turntable": turntable_rates,
    "ball_in_sphere": sphere_rates,
    "veselova_so4": planes.planes_rates,
}
OBSERVABLES = {
    "suslov_so5": suslov_5_observables,
    "roller_racer": racer_observables,
    "appell_machine": appell_observables,
    "double_spherical_pendulum": rods_observables,
    "n_link_chain": links_observables,
    "ball_on_turntable": turntable_observables,
    "ball_in_sphere": sphere_observables,
    "veselova_so4": planes.planes_observables,
}
#: Brackets of the state, velocities standing for their momenta.
TENSORS = {
    "suslov_so5": suslov_5_tensor,
    "roller_racer": racer_tensor,
    "appell_machine": appell_tensor,
    "n_link_chain": links_tensor,
    "ball_in_sphere": sphere_tensor,
    "veselova_so4": planes.planes_tensor,
}
TURNING = ("omega1", "omega2", "omega3")
STATES = {
    "suslov_so5": ("w1", "w2", "w3", "w4"),
    "roller_racer": ("v", "omega", "phi"),
    "appell_machine": ("omega", "z", "phi", "vphi"),
    "double_spherical_pendulum": tuple(
        f"{name}_{n}" for name in ("gamma1", "gamma2", "v1", "v2") for n in (1, 2, 3)
    ),
    "n_link_chain": tuple(f"{name}_{n}" for name in ("theta", "omega") for n in (1, 2, 3, 4)),
    "ball_on_turntable": (*TURNING, "x1", "x2"),
    "ball_in_sphere": (*TURNING, "n1", "n2", "n3"),
    "veselova_so4": planes.STATE,
}
PARAMETERS = {
    "suslov_so5": ("K1", "K2", "K3", "K4", "k1", "k2", "k3", "k4", "j"),
    "roller_racer": ("m1", "m2", "I1", "I2", "d1", "d2"),
    "appell_machine": ("M", "m", "A", "C", "a", "b", "rho", "g"),
    "double_spherical_pendulum": ("m1", "m2", "l1", "l2", "g"),
    "n_link_chain": ("m", "l", "g"),
    "ball_on_turntable": ("I", "m", "r", "W"),
    "ball_in_sphere": ("I", "m", "r", "a", "g"),
    "veselova_so4": planes.PARAMETERS,
}
#: With sines and cosines of the state, typed to 80 digits.
CONFIGURATIONS = ("roller_racer", "n_link_chain")
#: Whose rates are quotients in the state.
QUOTIENTS = ("double_spherical_pendulum", "ball_in_sphere", "veselova_so4")
