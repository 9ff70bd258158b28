r"""The bracket of fields: pointwise that of finite systems, with what derivatives add.

Over an algebra each point of space has the Lie-Poisson bracket of the state, in which a strain is
advected by the adjoint representation. A strain has the 2-cocycle of loops in addition,

.. math:: \{\mu_i(s), \Xi^j(s')\} = \ldots + \delta_i^j\, \partial_s \delta(s - s'),

so that a strand moves by :math:`\dot\Xi = \partial_s \Omega + \ldots` and
:math:`\dot\mu = -\partial_s l_\Xi + \ldots` (Holm, Ivanov and Percival 2012, arXiv:1109.4421; the
bracket of a semidirect product with a cocycle). Of diffeomorphisms of the circle, right invariant,

.. math:: \{m(s), m(s')\} = -(m \partial_s + \partial_s m + c\, \partial_s^3)\, \delta(s - s'),

with the central charge c (Khesin and Ovsienko 1987). Of the maps of a plane that keep areas,

.. math:: \{w(x), w(x')\} = (w_y \partial_x - w_x \partial_y)\, \delta(x - x'),

in which functions of w are Casimirs (Arnold and Khesin 2021, Topological Methods in Hydrodynamics,
2nd ed., section I.9).
Comes in: a Setting. Goes out: the bracket as an `Operator`.
Read next: `coadjoint.derive.routes.lie_poisson`.
"""

from __future__ import annotations

from coadjoint.derive.fields.jets import jets_of
from coadjoint.derive.fields.operators import Operator, Term
from coadjoint.derive.setting import Setting, once
from coadjoint.derive.structure import poisson_structure
from coadjoint.exact import Element


@once
def field_operator(setting: Setting) -> Operator:
    """The bracket of the fields, in the order of the state."""
    field, one = setting.field, setting.field.one
    if setting.spec.diffeomorphisms is not None:
        (m,) = setting.elements(setting.state)
        if setting.spec.in_plane:
            jets = jets_of(setting)
            m_x, m_y = jets.total(m), jets.total(m, 0, 1)
            return ((((Term(m_y, 1, one), Term(-m_x, 0, one, 1))),),)
        terms = [Term(-m, 1, one), Term(-one, 1, m)]
        charge = central_charge(setting)
        return ((tuple([*terms, Term(-charge, 3, one)] if charge else terms),),)
    tensor, coupled = poisson_structure(setting).tensor, {*cocycle(setting)}
    return tuple(
        tuple(
            (
                *([Term(value, 0, one)] if not field.is_zero(value) else []),
                *([Term(one, 1, one)] if (a, b) in coupled or (b, a) in coupled else []),
            )
            for b, value in zip(setting.state, row, strict=True)
        )
        for a, row in zip(setting.state, tensor, strict=True)
    )


def cocycle(setting: Setting) -> list[tuple[str, str]]:
    """Components of momenta and of strains that the 2-cocycle pairs."""
    strains = [each for each in setting.advected if each.strain]
    return [pair for each in strains for pair in zip(setting.momenta, each.components, strict=True)]


def central_charge(setting: Setting) -> Element:
    """The central charge of the diffeomorphisms; 0 without an extension."""
    group = setting.spec.diffeomorphisms
    if group is None or group.central is None:
        return setting.field.zero
    return setting.formula(group.central)
