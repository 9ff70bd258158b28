"""Elastic rods at rest typed by hand, for comparison with ours.

Moments m and forces n in axes of the sections, by the arc length s: Simo, Marsden and Krishnaprasad
(1988) without what moves, and Love (1927), section 260.
"""

from __future__ import annotations

from typing import Any

from tests.sources.bodies import se3_tensor
from tests.sources.components import Vector, cross, dot, plus
from tests.sources.points import named


def rod_strains(state: Vector, parameters: Vector) -> tuple[list[Any], list[Any]]:
    """``k = K^-1 m``, ``e = e3 + A^-1 n``; without A all of e is e3."""
    m, n, K, A = state[:3], state[3:], parameters[:3], parameters[3:]
    k = [x / y for x, y in zip(m, K, strict=True)]
    return k, plus([x / y for x, y in zip(n, A, strict=True)] if A else [0, 0, 0], [0, 0, 1])


def rod_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``dm/ds = m x k + n x e``, ``dn/ds = n x k``."""
    m, n = state[:3], state[3:]
    k, e = rod_strains(state, parameters)
    return [*plus(cross(m, k), cross(n, e)), *cross(n, k)]


def rod_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """``(m . k + n . (e + e3))/2``, both Casimirs, and strains."""
    m, n = state[:3], state[3:]
    k, e = rod_strains(state, parameters)
    found = {
        "energy": (dot(m, k) + dot(n, e) + n[2]) / 2,
        "casimir1": dot(n, n),
        "casimir2": dot(m, n),
        **named("k", k),
    }
    return found | named("e", e) if len(parameters) > 3 else found


RATES = dict.fromkeys(("cosserat_rod", "kirchhoff_rod"), rod_rates)
OBSERVABLES = dict.fromkeys(RATES, rod_observables)
TENSORS = dict.fromkeys(RATES, lambda x, p: se3_tensor(x))
STATES = dict.fromkeys(RATES, ("m1", "m2", "m3", "n1", "n2", "n3"))
PARAMETERS = {
    "cosserat_rod": ("K1", "K2", "K3", "A1", "A2", "A3"),
    "kirchhoff_rod": ("K1", "K2", "K3"),
}
