"""Motions whose Hamiltonian is no kinetic energy of all momenta, typed by hand.

Each function takes the components of state and parameters as flat sequences, as those of
`tests.sources.textbook`, which has them by system.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import mpmath

from tests.sources.components import Vector, cross, dot, minus, plus, times
from tests.sources.phase_spaces import paired
from tests.sources.points import DIGITS, length


def particle_parts(state: Vector, parameters: Vector) -> tuple[Vector, Vector, Any]:
    """Kinetic momentum k, velocity, ``m gamma`` (Landau and Lifshitz 1975, sections 9, 16)."""
    x, p = state[:3], state[3:]
    (m, c, q), B = parameters[:3], parameters[6:]
    k = minus(p, times(q / 2, cross(B, x)))
    heavy = m * length(1 + dot(k, k) / (m * c) ** 2)
    return k, times(1 / heavy, k), heavy


def particle_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``dk/dt = q (E + v x B)``; the momentum has ``q B x v/2`` in addition."""
    (q, *E), B = parameters[2:6], parameters[6:]
    _, v, _ = particle_parts(state, parameters)
    turning = [q * each / 2 for each in cross(v, B)]
    return [*v, *plus(times(q, E), turning)]


def particle_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """``m gamma c^2 - q E . x``, and the generators of the Poincare group at the time 0."""
    x, p = state[:3], state[3:]
    m, c, q, *E = parameters[:6]
    k, v, heavy = particle_parts(state, parameters)
    rest = length(m**2 + dot(p, p) / c**2)
    named = {"v": v, "k": k, "J": cross(x, p), "K": times(rest, x)}
    return {"energy": heavy * c**2 - q * dot(E, x)} | {
        f"{name}{n}": part for name, parts in named.items() for n, part in enumerate(parts, 1)
    }


def area_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``du/dt = -pz v, dv/dt = pz u`` of u = px - y pz/2, v = py + x pz/2; dz/dt is the area's."""
    x, y, _, px, py, pz = state
    u, v = px - y * pz / 2, py + x * pz / 2
    return [u, v, (x * v - y * u) / 2, -pz * v / 2, pz * u / 2, 0]


def area_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Half the square of the speed, and what left translations keep."""
    x, y, _, px, py, pz = state
    u, v, w, *_ = area_rates(state, parameters)
    a, b = px + y * pz / 2, py - x * pz / 2
    return {"energy": (u**2 + v**2) / 2, "u": u, "v": v, "w": w, "a": a, "b": b}


def charge_speeds(state: Vector, parameters: Vector) -> tuple[Any, Any, Any]:
    """``k/(c^2 r)``, and the v of ``m v + m v^3/(2 c^2) + k u/(c^2 r) = p``, from cubics in turn.

    One speed is a root of its cubic at the last value of the other, by the hyperbolic sine of a
    third. Of states where ``k/(c^2 r)`` is small next to the masses.
    """
    rounded = isinstance(state[0], float)
    with mpmath.workdps(20 if rounded else 2 * DIGITS):
        x, y, p, q, m, n, c, k = (
            mpmath.mpf(Fraction(each).numerator) / Fraction(each).denominator
            for each in (*state, *parameters)
        )
        near, scale, speeds = k / (c**2 * (x - y)), c * mpmath.sqrt(mpmath.mpf(8) / 3), [0, 0]
        for _ in range(2 * DIGITS):
            for i, (mass, momentum) in enumerate(((m, p), (n, q))):
                third = mpmath.asinh(3 * (momentum - near * speeds[1 - i]) / (mass * scale)) / 3
                speeds[i] = scale * mpmath.sinh(third)
        found = (near, *speeds)
        if rounded:
            return tuple(map(float, found))
        return tuple(Fraction(int(mpmath.nint(each * 10**DIGITS)), 10**DIGITS) for each in found)


def charge_rates(state: Vector, parameters: Vector) -> list[Any]:
    """Speeds, and ``dp/dt = k/r^2 - k v u/(c^2 r^2)`` with its opposite."""
    (x, y), (c, k) = state[:2], parameters[2:]
    _, v, u = charge_speeds(state, parameters)
    force = k / (x - y) ** 2 * (1 - v * u / c**2)
    return [v, u, force, -force]


def charge_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Both kinetic energies, that of Coulomb, and Darwin's term with a plus; total momentum."""
    (x, y, p, q), (m, n, c, k) = state, parameters
    near, v, u = charge_speeds(state, parameters)
    moving = (m * v**2 + n * u**2) / 2 + 3 * (m * v**4 + n * u**4) / (8 * c**2)
    return {"energy": moving + k / (x - y) + near * v * u, "v1": v, "v2": u, "P": p + q}


CONFIGURATIONS = ("relativistic_particle", "darwin_charges")
RATES = {
    "relativistic_particle": particle_rates,
    "heisenberg_sub_riemannian": area_rates,
    "darwin_charges": charge_rates,
}
OBSERVABLES = {
    "relativistic_particle": particle_observables,
    "heisenberg_sub_riemannian": area_observables,
    "darwin_charges": charge_observables,
}
TENSORS = dict.fromkeys(RATES, lambda x, p: paired([1] * (len(x) // 2)))
STATES = {
    "relativistic_particle": ("x1", "x2", "x3", "p1", "p2", "p3"),
    "heisenberg_sub_riemannian": ("x", "y", "z", "px", "py", "pz"),
    "darwin_charges": ("x1", "x2", "p1", "p2"),
}
PARAMETERS = {
    "relativistic_particle": ("m", "c", "q", "E1", "E2", "E3", "B1", "B2", "B3"),
    "heisenberg_sub_riemannian": (),
    "darwin_charges": ("m1", "m2", "c", "k"),
}
