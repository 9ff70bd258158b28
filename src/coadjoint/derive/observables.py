"""What is emitted beside the dynamics, the same for every route.

Comes in: a Setting and a route's energy. Goes out: components by name: the energy, the claimed
Casimirs, the velocities, what the spec declares, the integrals of a Lax pair, and momenta as seen
from space where the state has the attitude.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType

from coadjoint.derive.integrals import lax_integrals
from coadjoint.derive.interpret import Quantity
from coadjoint.derive.mechanics.reconstruction import spatial_momentum
from coadjoint.derive.setting import Setting
from coadjoint.derive.symmetries import momentum_maps
from coadjoint.exact import Element
from coadjoint.spec import Formula
from coadjoint.spec.model import component_names


def observables(
    setting: Setting, energy: Element | None, momenta: Sequence[tuple[str, Element]] = ()
) -> tuple[tuple[str, Element], ...]:
    """Name and value of each component, in the order in which kernels return them.

    Args:
        setting: The spec and its field.
        energy: Of the route, or None.
        momenta: Along a constraint distribution, of velocities and then of sections.
    """
    spec = setting.spec
    casimirs = [
        part
        for n, casimir in enumerate(spec.casimirs, 1)
        for part in _named(component_names(f"casimir{n}", casimir.shape), setting, casimir)
    ]
    velocities = [
        (name, setting.field[name]) for variable in spec.defined for name in variable.components
    ]
    reactions = [
        (name, setting.field[name]) for each in spec.constraints for name in each.reactions
    ]
    declared = [
        part
        for entry in spec.observables
        for part in _named(entry.components, setting, entry.formula, setting.reactions)
    ]
    values = momentum_maps(setting, energy)
    maps = [
        part
        for symmetry in spec.symmetries
        for part in zip(symmetry.components, values[symmetry.name], strict=True)
    ]
    pair = lax_integrals(setting)
    of_pair = pair.named if pair is not None else ()
    first = () if energy is None else (("energy", energy),)
    of_space = _spatial(setting) if spec.spatial else ()
    return (
        *first,
        *casimirs,
        *velocities,
        *reactions,
        *momenta,
        *declared,
        *maps,
        *of_pair,
        *of_space,
    )


def _spatial(setting: Setting) -> list[tuple[str, Element]]:
    """The components of the momenta as seen from space."""
    seen = dict(zip(setting.momenta, spatial_momentum(setting), strict=True))
    return [
        (name, seen[inner])
        for each in setting.spec.spatial
        for name, inner in zip(each.components, each.momentum.components, strict=True)
    ]


def _named(
    names: tuple[str, ...],
    setting: Setting,
    formula: Formula,
    known: Mapping[str, Quantity] = MappingProxyType({}),
) -> Iterator[tuple[str, Element]]:
    """The components of a formula with their names."""
    return zip(names, setting.components(formula, known), strict=True)
