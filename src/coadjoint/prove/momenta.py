r"""Momentum equations: how momenta along sections of the distribution change.

Theorem (Bloch, Krishnaprasad, Marsden and Murray 1996, momentum equation; Holm 2011, section
12.3.2): for a field :math:`\Sigma = B\sigma` of the distribution, momenta
:math:`p = \partial l/\partial\xi` and forces f,

.. math::
    \frac{d}{dt} \langle p, \Sigma \rangle
        = \Sigma\, l + \langle p, [\xi, \Sigma] \rangle + \langle f, \Sigma \rangle,

where the reactions do no work. Noether's theorem keeps the momentum of a symmetry only if its
field is in the distribution; Jellett's integral is such a momentum.
Comes in: a motion with declared sections. Goes out: claims for the certificate.
Read next: `coadjoint.derive.mechanics.sections`.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.mechanics.distribution import Row
from coadjoint.derive.mechanics.driving import explicit
from coadjoint.derive.mechanics.external import external_forces
from coadjoint.derive.mechanics.frames import frame_of
from coadjoint.derive.mechanics.relaxed import relaxed
from coadjoint.derive.mechanics.sections import section_momenta, section_vector
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element, element_text
from coadjoint.exact.dense import dot
from coadjoint.prove.findings import SHOWN
from coadjoint.prove.motion import Motion
from coadjoint.prove.zero import Decision, Examined, decide_zero
from coadjoint.spec.model import Section


def about_momenta(motion: Motion) -> Iterator[Examined]:
    """The momentum equation of every declared section."""
    for section in motion.equations.spec.sections:
        law = momentum_law(motion.equations, section)
        yield _statement(motion, section, law), "momentum", partial(_changes, motion, section, law)


def momentum_law(equations: Equations, section: Section) -> Element:
    """The rate of the momentum along a section, by `law_along`."""
    return law_along(equations, section_vector(equations.setting, section))


def law_along(equations: Equations, along: Row) -> Element:
    """``Sigma l + <p, [xi, Sigma]> + <f, Sigma>`` along a field of the frame, in all velocities.

    A field that a constraint does not allow gains the work of its reaction.
    """
    distribution, setting = equations.distribution, equations.setting
    field, frame = setting.field, frame_of(setting)
    bound = () if distribution is None else distribution.equations
    lagrangian = setting.lagrangian
    turned = frame.bracket(setting.elements(frame.velocities), along)
    momenta = mechanics(setting).momenta
    forces = external_forces(setting, frame.velocities)
    reactions = setting.elements([each.reaction for each in bound])
    gained = _gain(setting, along)
    worked = [dot(field.gradient(each.residual, frame.velocities), along) for each in bound]
    return field.sum(
        [
            frame.along(along, lagrangian),
            *(p * x for p, x in zip(momenta, turned, strict=True)),
            *(p * explicit(setting, x) for p, x in zip(momenta, along, strict=True)),
            *(f * x for f, x in zip(forces, along, strict=True)),
            *(r * w for r, w in zip(reactions, worked, strict=True) if w != 0),
            gained,
        ]
    )


def _gain(setting: Setting, along: Row) -> Element:
    """What a symmetric bracket adds along a field, where velocities along the frame are the state.

    It moves the momenta, and by the positions the field.
    """
    field, known, frame = setting.field, relaxed(setting), frame_of(setting)
    if known is None:
        return field.zero
    moved = [known.closed[z] for z in frame.positions]
    turned = (dot(field.gradient(x, frame.positions), moved) if moved else 0 for x in along)
    parts = zip(frame.velocities, mechanics(setting).momenta, along, turned, strict=True)
    return field.sum(known.closed[v] * x + p * y for v, p, x, y in parts)


def _statement(motion: Motion, section: Section, law: Element) -> str:
    """The momentum equation, its right side written out where that is short."""
    spec = motion.equations.spec
    closed = motion.field.normal(motion.equations.close(law)).combine()
    if motion.where.contains(closed):
        return f"{section.name} is conserved, by its momentum equation"
    text = element_text(motion.field, closed)
    if len(text) > SHOWN:
        text = "Sigma l + <dl/dxi, [xi, Sigma]>"
        text += " + <f, Sigma>" * bool(spec.forces or spec.dissipation)
    return f"d{section.name}/dt = {text}"


def _changes(motion: Motion, section: Section, law: Element) -> Decision:
    """The rate of the momentum minus its law."""
    momentum = dict(section_momenta(motion.setting))[section.name]
    rest = motion.rate(momentum) - motion.in_state(law)
    return decide_zero([rest], motion.field, motion.where)
