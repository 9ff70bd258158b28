r"""Followed: the rates of what a motion turns and carries along, and does not feel.

A left-invariant motion turns the attitude by :math:`\dot q = q\,(0, \Omega)/2`, a right-invariant
one by :math:`(0, \omega)\,q/2`. For a body that rolls on a plane, with s from the point of contact
to the centre of mass, seen from the body, the centre of mass is at :math:`x_{com} = x + O s` and
moves by :math:`\dot x_{com} = O Y`; where Y is :math:`\Omega \times s`, as
`coadjoint.prove.rolling` proves of the constraints, the point of contact moves by

.. math:: \dot x = O (Y - \Omega \times s - \dot s) = -O \dot s.

Comes in: a Setting and, for constrained motions, the distribution, which names what the kernel
computes anyway. Goes out: each variable with its rate.
Read next: `coadjoint.lower.lowering`, which makes the function ``reconstruction`` of them.
"""

from __future__ import annotations

from collections.abc import Sequence

from coadjoint.algebra import algebra_by_name
from coadjoint.algebra.attitudes import quaternion, turning_places
from coadjoint.derive.mechanics.distribution import Distribution
from coadjoint.derive.mechanics.kinematics import kinematics
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element
from coadjoint.groups.quaternions import Quaternion
from coadjoint.spec.model import Reconstructed
from coadjoint.spec.sections.rolling import ATTITUDE, CONTACT


def rates_followed(setting: Setting, of: Distribution | None) -> tuple[tuple[str, Element], ...]:
    """Name and rate of every variable that is reconstructed, in order."""
    place: dict[str, Element] = {}
    if setting.spec.rolling is not None and setting.spec.rolling.normal:
        assert of is not None, "the reader asks for constraints with [rolling]"
        place = dict(zip(CONTACT, contact_rate(of), strict=False))  # without the height
    return tuple(
        pair
        for each in setting.spec.reconstruction
        for pair in zip(each.components, _rate(setting, each, place), strict=True)
    )


def _rate(setting: Setting, each: Reconstructed, place: dict[str, Element]) -> Sequence[Element]:
    """The rates of the components of one variable."""
    if each.attitude:
        return attitude_rate(setting, each.components)
    return [place[each.name]] if each.rate is None else setting.components(each.rate)


def attitude_rate(setting: Setting, components: Sequence[str]) -> tuple[Element, ...]:
    """``dq/dt`` by the action of the rotations on unit quaternions."""
    places = turning_places(setting.algebra)
    assert places is not None, "the reader asks for rotations with an attitude"
    action = quaternion(algebra_by_name("so(3)"), setting.spec.invariance)
    turning = setting.elements([setting.velocities[n] for n in places])
    acted = action.act(turning, setting.elements(components))
    return tuple(setting.field.zero - setting.sign * x for x in acted)


def contact_rate(of: Distribution) -> tuple[Element, ...]:
    """``-O ds/dt``: the velocity of the point of contact in space, the height last."""
    setting = of.setting
    q = Quaternion(*setting.elements(attitude_components(setting)))
    carried = Quaternion.pure([kinematics(setting).rate(x) for x in arm(setting)])
    return setting.field.vector((-(q * carried * q.conjugate)).vector)


def arm(setting: Setting) -> tuple[Element, ...]:
    """s, from the point of contact to the centre of mass, seen from the body."""
    rolling = setting.spec.rolling
    assert rolling is not None, "asked for only of bodies that roll"
    return setting.components(rolling.arm)


def attitude_components(setting: Setting) -> tuple[str, ...]:
    """Names of the components of the attitude of a rolling body."""
    return next(q.components for q in setting.spec.reconstruction if q.name == ATTITUDE)
