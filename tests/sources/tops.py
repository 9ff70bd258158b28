"""Integrable tops and complex bodies: equations typed by hand or derived here, for comparison.

Each function takes the components of state and parameters as flat sequences and returns a flat
list, or values by name. `tests.sources.textbook` has them by system.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from tests.sources.bodies import heavy_top_observables, kirchhoff_observables
from tests.sources.components import Vector, cross, dot, hat, over, plus, root, times

# -- integrable tops: Holm (2011), chapter 8, with the integrals derived here ----------------------


def lagrange_as_heavy(parameters: Vector) -> list[Any]:
    """I1 = I2, and the centre of mass on the third axis."""
    i1, i3, m, g, chi = parameters
    return [i1, i1, i3, m, g, 0, 0, chi]


def equatorial_as_heavy(ratio: int) -> Callable[[Vector], list[Any]]:
    """I1 = I2 = ratio I3, and the centre of mass on the first axis."""

    def as_heavy(parameters: Vector) -> list[Any]:
        i3, m, g, chi = parameters
        return [ratio * i3, ratio * i3, i3, m, g, chi, 0, 0]

    return as_heavy


def lagrange_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Those of the heavy top, and Pi3."""
    found = heavy_top_observables(state, lagrange_as_heavy(parameters))
    return {**found, "spin": state[2]}


def kovalevskaya_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Those of the heavy top, and ``|(Omega1 + i Omega2)^2 - (m g chi/I3) (Gamma1 + i Gamma2)|^2``.

    The sign of Gamma is that of a potential ``+ m g chi Gamma1``.
    """
    (i3, m, g, chi), gamma = parameters, state[3:]
    found = heavy_top_observables(state, equatorial_as_heavy(2)(parameters))
    a, b, c = found["Omega1"], found["Omega2"], m * g * chi / i3
    real, imaginary = a * a - b * b - c * gamma[0], 2 * a * b - c * gamma[1]
    return {**found, "K": real * real + imaginary * imaginary}


def goryachev_chaplygin_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Those of the heavy top, and ``Pi3 (Pi1^2 + Pi2^2) - 4 I3 m g chi Pi1 Gamma3``."""
    (i3, m, g, chi), (p1, p2, p3, *gamma) = parameters, state
    found = heavy_top_observables(state, equatorial_as_heavy(4)(parameters))
    return {**found, "G": p3 * (p1 * p1 + p2 * p2) - 4 * i3 * m * g * chi * p1 * gamma[2]}


# -- Clebsch's case: Holm (2011), section 7.2, with the integral derived here ----------------------


def clebsch_as_kirchhoff(parameters: Vector) -> list[Any]:
    """``1/M_i = 1/M + theta I_i / (I1 I2 I3)``."""
    i1, i2, i3, m, theta = parameters
    masses = [1 / (1 / m + theta * i / (i1 * i2 * i3)) for i in (i1, i2, i3)]
    return [i1, i2, i3, *masses, 0, 0, 0]


def clebsch_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Those of Kirchhoff's vehicle, and ``(Pi . Pi - theta P . I^-1 P)/2``."""
    found = kirchhoff_observables(state, clebsch_as_kirchhoff(parameters))
    turned = dot(state[3:], over(state[3:], parameters[:3]))
    return {**found, "F": (dot(state[:3], state[:3]) - parameters[4] * turned) / 2}


# -- complex bodies: Holm (2011), appendix C.1.2 ---------------------------------------------------


def complex_body_rates(state: Vector, parameters: Vector) -> list[Any]:
    """Real and imaginary parts of ``dL/dt = L x KL``."""
    x, y = state[:3], state[3:]
    Kx, Ky = ([k * c for k, c in zip(parameters, z, strict=True)] for z in (x, y))
    real = plus(cross(x, Kx), times(-1, cross(y, Ky)))
    return [*real, *plus(cross(x, Ky), cross(y, Kx))]


def complex_body_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Real and imaginary parts of ``L . L/2`` and ``L . KL/2``."""
    x, y = state[:3], state[3:]
    Kx, Ky = ([k * c for k, c in zip(parameters, z, strict=True)] for z in (x, y))
    energy = (dot(x, Kx) - dot(y, Ky)) / 2
    return {
        "energy": energy,
        "casimir1": dot(x, x) - dot(y, y),
        "casimir2": dot(x, y),
        "ReC": (dot(x, x) - dot(y, y)) / 2,
        "ImC": dot(x, y),
        "ReH": energy,
        "ImH": dot(x, Ky),
    }


def complex_body_tensor(state: Vector) -> list[list[Any]]:
    """``[[hat x, hat y], [hat y, -hat x]]``: the units i of two arguments multiply to -1."""
    x, y = hat(state[:3]), hat(state[3:])
    top = [a + b for a, b in zip(x, y, strict=True)]
    return top + [b + times(-1, a) for a, b in zip(x, y, strict=True)]


def pt_body_rates(x: Vector, K: Vector) -> list[Any]:
    """``dx/dt = x x Kx - (N/D) w x Kw``, w = x x Kx, N = x . x - 1, D = w . w."""
    w = cross(x, [k * c for k, c in zip(K, x, strict=True)])
    turned = cross(w, [k * c for k, c in zip(K, w, strict=True)])
    return plus(w, times(-(dot(x, x) - 1) / dot(w, w), turned))


def pt_body_observables(x: Vector, K: Vector) -> dict[str, Any]:
    """``(x . Kx - y . Ky)/2`` and y, that is sqrt(N/D) w."""
    Kx = [k * c for k, c in zip(K, x, strict=True)]
    w = cross(x, Kx)
    square = (dot(x, x) - 1) / dot(w, w)
    energy = (dot(x, Kx) - square * dot(w, [k * c for k, c in zip(K, w, strict=True)])) / 2
    alpha = root(square)
    return {"energy": energy, **{f"y{n + 1}": c * alpha for n, c in enumerate(w)}}
