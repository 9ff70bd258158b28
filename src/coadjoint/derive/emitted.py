"""Emitted: what is emitted in addition to the rates, as one list that everything else reads.

Comes in: a Setting and a route's energy. Goes out: the energy, the claimed Casimirs, velocities,
the reactions and momenta of constraints, what the spec declares, momentum maps, the integrals of a
Lax pair, and, where the state has attitudes, momenta as seen from space and what stays of them:
each with its unit, its components and what is known of its conservation, in the order in which
kernels return them.
Read next: `coadjoint.derive.units`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from coadjoint.derive import units
from coadjoint.derive.integrals import lax_integrals
from coadjoint.derive.interpret import Value
from coadjoint.derive.mechanics.parts import in_parts
from coadjoint.derive.mechanics.reconstruction import spatial_momentum
from coadjoint.derive.mechanics.sections import section_momenta
from coadjoint.derive.mechanics.turning import gram
from coadjoint.derive.records import Emitted, Kept
from coadjoint.derive.setting import Setting, once
from coadjoint.derive.symmetries import in_formulas, momentum_maps
from coadjoint.exact import Element
from coadjoint.spec.core.components import Argument, Named, unpack
from coadjoint.spec.spatial import grams, spatial_momenta


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
        *declared_observables(setting),
        *_momentum_maps(setting, energy),
        *_list_last(setting),
    )


def emitted_energy(setting: Setting, energy: Element) -> Emitted:
    """The energy of a route."""
    return _emit_number("energy", units.of_energy(setting), energy, Kept.AS_ENERGY)


def _emit(
    each: Named,
    unit: str,
    values: Sequence[Element],
    kept: Kept = Kept.UNKNOWN,
    form: Value | None = None,
) -> Emitted:
    """The quantity that something with a name, a shape and components is."""
    return Emitted(
        name=each.name,
        shape=each.shape,
        components=each.components,
        unit=unit,
        values=tuple(values),
        kept=kept,
        form=form,
    )


def _emit_number(name: str, unit: str, value: Element, kept: Kept) -> Emitted:
    """A quantity of one component, which has its name."""
    return _emit(Argument(name=name, shape=()), unit, (value,), kept)


@once
def _list_first(setting: Setting) -> tuple[Emitted, ...]:
    """Casimirs, velocities that the state gives, and reactions."""
    spec, elements = setting.spec, setting.elements
    casimirs = [
        (Argument(name=f"casimir{n}", shape=c.shape), c) for n, c in enumerate(spec.casimirs, 1)
    ]
    reactions = [(Argument(name=c.reaction, shape=c.shape), c) for c in spec.constraints]
    return (
        *(
            _emit(each, units.of_formula(setting, c), setting.components(c), Kept.UNLESS_WORKED_ON)
            for each, c in casimirs
        ),
        *(
            _emit(v, v.unit, elements(v.components), form=setting.values[v.name])
            for v in spec.defined
        ),
        *(
            _emit(each, units.of_reaction(setting, c), elements(each.components))
            for each, c in reactions
        ),
    )


def _along_distribution(setting: Setting, values: dict[str, Element]) -> Iterator[Emitted]:
    """Momenta of the independent velocities, then of sections."""
    for each in setting.spec.reduced_momenta:
        unit = units.of_momentum(setting, each.of)
        yield _emit(each, unit, [values[name] for name in each.components])
    values |= section_momenta(setting)
    for section in setting.spec.sections:
        kept = _find_claim(setting, section.name)
        yield _emit(section, section.unit, [values[section.name]], kept)


@once
def declared_observables(setting: Setting) -> tuple[Emitted, ...]:
    """The observables of the spec."""
    return tuple(
        _emit(each, each.unit, in_parts(setting, each.formula), _find_claim(setting, each.name))
        for each in setting.spec.observables
        if not each.follows
    )


@once
def list_following(setting: Setting) -> tuple[Emitted, ...]:
    """The observables of the spec that name what is reconstructed."""
    return tuple(
        _emit(each, each.unit, in_parts(setting, each.formula), _find_claim(setting, each.name))
        for each in setting.spec.observables
        if each.follows
    )


def _momentum_maps(setting: Setting, energy: Element | None) -> Iterator[Emitted]:
    """The momentum maps of declared symmetries."""
    values = momentum_maps(setting, energy)
    for each in setting.spec.symmetries:
        parts, kept = values[each.name], _find_claim(setting, each.name)
        yield _emit(each, each.unit, parts, kept, in_formulas(each, parts))


@once
def _list_last(setting: Setting) -> tuple[Emitted, ...]:
    """The integrals of the Lax pair, momenta as seen from space, and what stays of attitudes."""
    emitted, pair = [], lax_integrals(setting)
    for name, value in () if pair is None else pair.named:
        unit = units.of_value(setting, value)
        emitted.append(_emit_number(name, unit, value, Kept.ALWAYS))
    for each in spatial_momenta(setting.spec):
        inner, kept = each.of, Kept.ALWAYS if each.conserved else Kept.UNKNOWN
        seen = dict(zip(setting.momenta, spatial_momentum(setting), strict=True))
        emitted.append(_emit(each, inner.unit, [seen[n] for n in inner.components], kept))
    for of, product in grams(setting.spec):
        values = gram(setting, of)
        form = unpack(values, product.form) if product.form else None
        emitted.append(_emit(product, product.unit, values, Kept.UNLESS_WORKED_ON, form))
    return tuple(emitted)


def _find_claim(setting: Setting, name: str) -> Kept:
    """Whether the spec claims that a quantity is conserved, everywhere."""
    claims = setting.spec.conserved
    return Kept.ALWAYS if name in {each.everywhere for each in claims} else Kept.UNKNOWN
