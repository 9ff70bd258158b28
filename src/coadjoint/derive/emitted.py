"""Emitted: what is emitted in addition to the rates, as one list that everything else reads.

Comes in: a Setting and a route's energy. Goes out: the energy, the claimed Casimirs, velocities,
the reactions and momenta of constraints, what the spec declares, momentum maps, the integrals of a
Lax pair, and momenta as seen from space where the state has the attitude: each with its unit, its
components and what is known of its conservation, in the order in which kernels return them.
Read next: `coadjoint.derive.units`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from coadjoint.derive import units
from coadjoint.derive.integrals import lax_integrals
from coadjoint.derive.mechanics.parts import in_parts
from coadjoint.derive.mechanics.reconstruction import spatial_momentum
from coadjoint.derive.mechanics.sections import section_momenta
from coadjoint.derive.records import Emitted, Kept
from coadjoint.derive.setting import Setting, once
from coadjoint.derive.symmetries import in_formulas, momentum_maps
from coadjoint.exact import Element
from coadjoint.spec.model import component_names
from coadjoint.spec.spatial import spatial_momenta


def list_emitted(
    setting: Setting, energy: Element | None, momenta: Sequence[tuple[str, Element]] = ()
) -> tuple[Emitted, ...]:
    """Everything that is emitted, in order.

    Args:
        setting: The spec and its field.
        energy: Of the route, or None.
        momenta: Along a constraint distribution, of velocities.
    """
    return (
        *(() if energy is None else (emitted_energy(setting, energy),)),
        *_list_first(setting),
        *_along_distribution(setting, dict(momenta)),
        *_declared_observables(setting),
        *_momentum_maps(setting, energy),
        *_list_last(setting),
    )


def emitted_energy(setting: Setting, energy: Element) -> Emitted:
    """The energy of a route."""
    return _emit_number("energy", units.of_energy(setting), energy, Kept.AS_ENERGY)


def _emit_number(name: str, unit: str, value: Element, kept: Kept) -> Emitted:
    """A quantity of one component, which has its name."""
    return Emitted(name=name, shape=(), components=(name,), unit=unit, values=(value,), kept=kept)


@once
def _list_first(setting: Setting) -> tuple[Emitted, ...]:
    """Casimirs, velocities that the state gives, and reactions."""
    spec, elements = setting.spec, setting.elements
    emitted = []
    for n, casimir in enumerate(spec.casimirs, 1):
        name, unit = f"casimir{n}", units.of_formula(setting, casimir)
        names, values = component_names(name, casimir.shape), setting.components(casimir)
        emitted.append(
            Emitted(
                name=name,
                shape=casimir.shape,
                components=names,
                unit=unit,
                values=values,
                kept=Kept.UNLESS_WORKED_ON,
            )
        )
    for v in spec.defined:
        values, form = elements(v.components), setting.values[v.name]
        emitted.append(
            Emitted(
                name=v.name,
                shape=v.shape,
                components=v.components,
                unit=v.unit,
                values=values,
                form=form,
            )
        )
    for each in spec.constraints:
        name, unit = each.reaction, units.of_reaction(setting, each)
        names, values = each.reactions, elements(each.reactions)
        emitted.append(
            Emitted(name=name, shape=each.shape, components=names, unit=unit, values=values)
        )
    return tuple(emitted)


def _along_distribution(setting: Setting, values: dict[str, Element]) -> Iterator[Emitted]:
    """Momenta of the independent velocities, then of sections."""
    for each in setting.spec.reduced_momenta:
        unit = units.of_momentum(setting, each.velocity)
        parts = tuple(values[name] for name in each.components)
        yield Emitted(
            name=each.name,
            shape=each.velocity.shape,
            components=each.components,
            unit=unit,
            values=parts,
        )
    values |= section_momenta(setting)
    for section in setting.spec.sections:
        name, kept = section.name, _find_claim(setting, section.name)
        yield _emit_number(name, section.unit, values[name], kept)


@once
def _declared_observables(setting: Setting) -> tuple[Emitted, ...]:
    """The observables of the spec."""
    return tuple(
        Emitted(
            name=each.name,
            shape=each.shape,
            components=each.components,
            unit=each.unit,
            values=in_parts(setting, each.formula),
            kept=_find_claim(setting, each.name),
        )
        for each in setting.spec.observables
    )


def _momentum_maps(setting: Setting, energy: Element | None) -> Iterator[Emitted]:
    """The momentum maps of declared symmetries."""
    values = momentum_maps(setting, energy)
    for each in setting.spec.symmetries:
        parts, kept = values[each.name], _find_claim(setting, each.name)
        whole = in_formulas(each, parts)
        yield Emitted(
            name=each.name,
            shape=each.shape,
            components=each.components,
            unit=each.unit,
            values=parts,
            kept=kept,
            form=whole,
        )


@once
def _list_last(setting: Setting) -> tuple[Emitted, ...]:
    """The integrals of the Lax pair, then momenta as seen from space."""
    emitted, pair = [], lax_integrals(setting)
    for name, value in () if pair is None else pair.named:
        unit = units.of_value(setting, value)
        emitted.append(_emit_number(name, unit, value, Kept.ALWAYS))
    for each in spatial_momenta(setting.spec):
        inner, kept = each.momentum, Kept.ALWAYS if each.conserved else Kept.UNKNOWN
        seen = dict(zip(setting.momenta, spatial_momentum(setting), strict=True))
        parts = tuple(seen[name] for name in inner.components)
        emitted.append(
            Emitted(
                name=each.name,
                shape=inner.shape,
                components=each.components,
                unit=inner.unit,
                values=parts,
                kept=kept,
            )
        )
    return tuple(emitted)


def _find_claim(setting: Setting, name: str) -> Kept:
    """Whether the spec claims that a quantity is conserved, everywhere."""
    claims = setting.spec.conserved
    return Kept.ALWAYS if name in {each.everywhere for each in claims} else Kept.UNKNOWN
