r"""Sections: fields that the constraints allow, and the momenta along them.

A section :math:`\Sigma = B\sigma` has the momentum :math:`\langle\partial l/\partial\xi, \Sigma
\rangle`. Where nothing binds the velocities B is 1, and every field is allowed; where momenta are
the state they stand for :math:`\partial l/\partial\xi`.
Comes in: a Setting with sections. Goes out: their components along the frame, and their momenta.
Read next: `coadjoint.prove.momenta`.
"""

from __future__ import annotations

from collections.abc import Iterator

from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.mechanics.distribution import Row, distribution
from coadjoint.derive.mechanics.frames import frame_of
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element
from coadjoint.exact.dense import apply, dot
from coadjoint.spec.model import Section


def section_momenta(setting: Setting) -> Iterator[tuple[str, Element]]:
    """``<dl/dxi, B sigma>`` of every declared section sigma."""
    if not setting.spec.sections:
        return
    momenta = mechanics(setting).momenta
    if setting.momenta and not setting.spec.is_first_order:
        pairs = zip(setting.elements(setting.momenta), setting.weights, strict=True)
        momenta = tuple(mu / weight for mu, weight in pairs)
    for each in setting.spec.sections:
        yield each.name, setting.field.zero + dot(momenta, section_vector(setting, each))


def section_vector(setting: Setting, section: Section) -> Row:
    """``B sigma``: a section as a vector of the frame."""
    along = section_components(setting, section)
    return apply(distribution(setting).B, along) if setting.spec.in_frame else along


def section_components(setting: Setting, section: Section) -> Row:
    """``sigma``: the components of a section along the velocities that nothing gives."""
    bound = setting.spec.in_frame
    names = distribution(setting).independent if bound else frame_of(setting).velocities
    parts = dict.fromkeys(names, setting.field.zero)
    for variable in (part for each in setting.spec.variables for part in each.parts):
        if variable.name in section.section:
            values = setting.components(section.section[variable.name])
            parts |= dict(zip(variable.components, values, strict=True))
    return tuple(parts.values())
