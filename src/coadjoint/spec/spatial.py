"""Momenta as seen from space, emitted where the state has the attitude.

Comes in: a Spec with an attitude. Goes out: its momenta, each with whether it stays what it is.
Read next: `coadjoint.derive.mechanics.reconstruction`, which derives their components.
"""

from __future__ import annotations

from dataclasses import dataclass

from coadjoint.algebra.attitudes import turning_places
from coadjoint.algebra.catalogue import inverse_by
from coadjoint.spec.core.components import component_names
from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.core.tree import walk
from coadjoint.spec.model import Spec
from coadjoint.spec.sections.variables import Variable


@dataclass(frozen=True)
class SpatialMomentum:
    """A momentum as seen from space: ``Pi_spatial``.

    Attributes:
        momentum: What it is in the body.
        conserved: Whether the energy knows nothing that is advected and no force acts on it, so
            that it stays what it is.
    """

    momentum: Variable
    conserved: bool

    @property
    def name(self) -> str:
        """Name of the observable."""
        return f"{self.momentum.name}_spatial"

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components, along the basis of the algebra."""
        return component_names(self.name, self.momentum.shape, self.momentum.form)


def spatial_momenta(spec: Spec) -> tuple[SpatialMomentum, ...]:
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
    is_free = not spec.relaxation and not advected & _names_in(spec.lagrangian, spec.hamiltonian)
    acted = _places_acted_on(spec)
    return tuple(
        SpatialMomentum(each, is_free and not (acted & set(each.block) if is_quaternion else acted))
        for each in momenta
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
