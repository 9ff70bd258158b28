"""Momenta as seen from space, and what stays of attitudes, emitted where the state has these.

Comes in: a Spec with an attitude. Goes out: its momenta, each with whether it stays what it is, and
the products ``R R^T`` or ``|q|^2``.
Read next: `coadjoint.derive.mechanics.reconstruction`, which derives their components.
"""

from __future__ import annotations

from coadjoint.algebra.attitudes import turning_places
from coadjoint.algebra.catalogue import inverse_by
from coadjoint.spec.core.components import Argument
from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.core.tree import walk
from coadjoint.spec.model import DerivedMomentum, Spec, Variable, derive_momentum


def spatial_momenta(spec: Spec) -> tuple[DerivedMomentum, ...]:
    """The momenta seen from space; empty without an attitude that can be inverted.

    A quaternion turns the momenta of rotations, if these commute with the rest of the algebra.
    """
    if spec.attitude is None or spec.algebra is None:
        return ()
    momenta = tuple(each for each in spec.having_role("momentum") if not each.of)
    is_quaternion = spec.attitude.form == "quaternion"
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


def grams(spec: Spec) -> tuple[tuple[Variable, Argument], ...]:
    """What stays of each attitude, quaternion or pose, emitted with the dynamics."""
    return tuple((each, _name_gram(each)) for each in spec.turning)


def _name_gram(each: Variable) -> Argument:
    rows = 0 if each.turning == "quaternion" else each.shape[0]
    shape, form = ((rows * (rows + 1) // 2,), "symmetric") if rows else ((), "")
    return Argument(name=gram_name(each), shape=shape, unit="1", form=form)


def gram_name(each: Variable) -> str:
    """What the product that stays is called."""
    return f"{each.name}_gram"


def describe_gram(spec: Spec, each: Variable) -> str:
    """The product that stays, as a formula."""
    R = describe_rotation(each)
    if each.turning == "quaternion":
        return f"dot({R}, {R})"
    return f"{R}*transpose({R})" if spec.invariance == "left" else f"transpose({R})*{R}"


def describe_rotation(each: Variable) -> str:
    """What turns, as a formula: all of an attitude, a part of a pose."""
    return f"rotation({each.name})" if each.turning == "pose" else each.name


def turning_rows(spec: Spec, each: Variable) -> dict[str, str]:
    """What holds of a rotation, by the names of its rows: a product of unit length, no mirror."""
    unit = f"{describe_gram(spec, each)} == 1"
    rows = dict.fromkeys(_name_gram(each).components, unit)
    if each.turning == "quaternion":
        return rows
    return rows | {f"{each.name}_det": f"det({describe_rotation(each)}) == 1"}


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
