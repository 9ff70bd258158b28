"""What is emitted beside the dynamics, the same for every route.

Comes in: a Setting and a route's energy. Goes out: components by name: the energy, the claimed
Casimirs, the velocities, and what the spec declares.
"""

from __future__ import annotations

from collections.abc import Iterator

from coadjoint.derive.setting import Setting
from coadjoint.derive.symmetries import momentum_maps
from coadjoint.exact import Element
from coadjoint.spec import Formula
from coadjoint.spec.model import component_names


def observables(setting: Setting, energy: Element) -> tuple[tuple[str, Element], ...]:
    """Name and value of each component, in the order in which kernels return them."""
    spec = setting.spec
    casimirs = [
        part
        for n, casimir in enumerate(spec.casimirs, 1)
        for part in _named(component_names(f"casimir{n}", casimir.shape), setting, casimir)
    ]
    velocities = [
        (name, setting.field[name]) for variable in spec.defined for name in variable.components
    ]
    declared = [
        part
        for entry in spec.observables
        for part in _named(entry.components, setting, entry.formula)
    ]
    values = momentum_maps(setting, energy)
    maps = [
        part
        for symmetry in spec.symmetries
        for part in zip(symmetry.components, values[symmetry.name], strict=True)
    ]
    return (("energy", energy), *casimirs, *velocities, *declared, *maps)


def _named(
    names: tuple[str, ...], setting: Setting, formula: Formula
) -> Iterator[tuple[str, Element]]:
    """The components of a formula with their names."""
    return zip(names, setting.components(formula), strict=True)
