"""The Poisson structure of a system: minus (left) or plus (right) Lie-Poisson on a semidirect dual.

Comes in: a Setting. Goes out: the tensor ``{x_i, x_j}`` of the state, from the structure constants
of the semidirect product of the algebra with the duals of the advected representations.
"""

from __future__ import annotations

from coadjoint.algebra import LieAlgebra, semidirect_product
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element


def momentum_algebra(setting: Setting) -> LieAlgebra:
    """The algebra on whose dual the state lives: ``g (s) V`` with every advected a in V*.

    An advected quantity a of the representation rho lives in the dual of V, so V carries the dual
    action (Holm 2011, sections 7.2.1 and 9.4).
    """
    actions = [
        (variable.name, variable.representation.dual())
        for variable in setting.advected
        if variable.representation is not None
    ]
    return semidirect_product(setting.spec.algebra, actions) if actions else setting.spec.algebra


def poisson_tensor(setting: Setting) -> tuple[tuple[Element, ...], ...]:
    """``{x_i, x_j} = -+ c_ij^k x_k``, rows and columns in the order of the state."""
    field, algebra = setting.field, momentum_algebra(setting)
    advected = [name for variable in setting.advected for name in variable.components]
    coordinates = [*setting.momenta, *advected]
    tensor = algebra.lie_poisson_tensor(setting.elements(coordinates))
    places = [coordinates.index(name) for name in setting.state]
    return tuple(field.vector(setting.sign * tensor[i][j] for j in places) for i in places)
