"""Momenta as seen from space, emitted where the state has the attitude.

Comes in: a Spec with an attitude. Goes out: its momenta, each with whether it stays what it is.
Read next: `coadjoint.derive.mechanics.reconstruction`, which derives their components.
"""

from __future__ import annotations

from coadjoint.algebra.attitudes import turning_places
from coadjoint.algebra.catalogue import inverse_by
from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.core.tree import walk
from coadjoint.spec.model import DerivedMomentum, Spec, derive_momentum


def spatial_momenta(spec: Spec) -> tuple[DerivedMomentum, ...]:
    """The momenta seen from space; empty without an attitude that can be inverted.

    A quaternion turns the momenta of rotations, if these commute with the rest of the algebra.
    """
    if spec.attitude is None or spec.algebra is None:
        return ()
    momenta, is_quaternion = spec.having_role("momentum"), spec.attitude.form == "quaternion"
    if is_quaternion:
        places = set(turning_places(spec.algebra) or ())
        if any(0 < len(places & set(pair)) < 2 for pair in spec.algebra.constants):
            return ()
        momenta = tuple(each for each in momenta if set(each.block) <= places)
    elif not inverse_by(spec.algebra):
        return ()
    advected = {n for v in spec.having_role("advected") for n in (v.name, *v.components)}
    is_free = not spec.relaxation and not advected & _names_in(
        spec.lagrangian, spec.hamiltonian, *(each.formula for each in spec.noise)
    )
    acted = _places_acted_on(spec)
    acting = (acted & set(each.block) if is_quaternion else acted for each in momenta)
    return tuple(
        derive_momentum(each, "spatial", conserved=is_free and not forced)
        for each, forced in zip(momenta, acting, strict=True)
    )


def _places_acted_on(spec: Spec) -> set[int]:
    """Places of the basis along which forces or friction act."""
    named = {*spec.forces, *_names_in(spec.dissipation)}
    acted = (each for each in spec.variables if named & {each.name, *each.components})
    return {place for each in acted for place in each.block}


def _names_in(*formulas: Formula | None) -> set[str]:
    return {
        getattr(node, "name", "")
        for formula in formulas
        if formula is not None
        for node in walk(formula.tree)
    }
