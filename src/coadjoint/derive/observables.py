"""Scalars emitted beside the dynamics, the same for every route.

Comes in: a Setting and a route's energy. Goes out: names with elements: the energy, the claimed
Casimirs, the velocities, and what the spec declares.
"""

from __future__ import annotations

from coadjoint.derive.setting import Setting
from coadjoint.exact import Element


def observables(setting: Setting, energy: Element) -> tuple[tuple[str, Element], ...]:
    """Name and value of each observable, in the order in which kernels return them."""
    spec = setting.spec
    casimirs = [
        (f"casimir{n}", setting.formula(casimir)) for n, casimir in enumerate(spec.casimirs, 1)
    ]
    velocities = [
        (name, setting.field[name])
        for variable in spec.having_role("velocity")
        for name in variable.components
    ]
    declared = [(entry.name, setting.formula(entry.formula)) for entry in spec.observables]
    return (("energy", energy), *casimirs, *velocities, *declared)
