r"""Rolling: what is claimed of a body that rolls on a plane, or on a surface.

With s from the point of contact to the centre of mass and :math:`\Gamma` normal to the plane, both
seen from the body: (i) the point of the body at the contact is at rest; (ii) the place of contact
moves along the plane, so that the body neither leaves it nor sinks in; (iii) the height
:math:`\Gamma \cdot s` of the centre of mass changes as its velocity Y says.
On a surface the body does not slip either, and both stay in contact: see `coadjoint.prove.contact`.
Comes in: Equations with a distribution. Goes out: claims for the certificate. A wrong profile,
whose :math:`ds/dt` is not tangent to the plane, is refuted by (ii).
Read next: `coadjoint.derive.mechanics.followed`, which rests on (i).
"""

from __future__ import annotations

from collections.abc import Iterator

from coadjoint.derive.mechanics.followed import arm
from coadjoint.exact.dense import cross, dot
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.contact import about_contact
from coadjoint.prove.zero import Examined, decide_zero, mark_place


def about_rolling(motion: ConstrainedRates) -> Iterator[Examined]:
    """The claims about a body that rolls; none about any other."""
    rolling = motion.spec.rolling
    if rolling is not None and rolling.contact is not None:
        yield from mark_place(rolling.contact.surface, about_contact(motion), motion.field)
    elif rolling is not None:
        yield from mark_place(rolling.arm, _about_plane(motion), motion.field)


def _about_plane(motion: ConstrainedRates) -> Iterator[Examined]:
    """The claims about a body that rolls on a plane."""
    first = motion.equations
    setting, rolling = first.setting, first.spec.rolling
    assert rolling is not None, "asked for only of bodies that roll"
    s, Gamma = arm(setting), rolling.normal
    text, by_name = rolling.arm.in_one_line, {v.name: v for v in setting.spec.variables}
    Y, Omega, normal = (
        setting.elements(by_name[name].components)
        for name in (rolling.velocity, rolling.turning, Gamma)
    )
    slip = [y - x for y, x in zip(Y, cross(Omega, s), strict=True)]
    yield (
        f"the point of the body at the contact is at rest: {rolling.velocity} = "
        f"cross({rolling.turning}, {text})",
        "rolling",
        lambda: decide_zero([first.close(x) for x in slip], motion.field, motion.where),
    )
    relations = " and ".join(filter(None, [f"|{Gamma}| = 1", motion.where.text]))
    unit = motion.where.also([dot(normal, normal) - 1], relations)
    yield (
        f"the body stays on the plane: dot({Gamma}, d({text})/dt) = 0 where |{Gamma}| = 1",
        "rolling",
        lambda: decide_zero([dot(normal, [motion.rate(x) for x in s])], motion.field, unit),
    )
    height = dot(normal, s)
    yield (
        f"the height dot({Gamma}, {text}) changes by dot({Gamma}, {rolling.velocity})",
        "rolling",
        lambda: decide_zero(
            [motion.rate(height) - first.close(dot(normal, Y))], motion.field, unit
        ),
    )
