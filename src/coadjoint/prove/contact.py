r"""Contact: what is claimed of a body that rolls on any surface.

With f and F that are zero on the surfaces of the body and in space, g and G their gradients: (i) the
point of the body at the contact moves with the surface; (ii) the points of contact stay on both
surfaces; (iii) the normals stay opposite; (iv) the centre of mass is where the arm says; (v) a
surface that turns goes over into itself; (vi) the projection of a state is a step of Newton, and
leaves a state that is in contact.
Comes in: Equations with a distribution and a contact. Goes out: claims for the certificate. A wrong
rate of a point of contact, as of a wrong curvature, is refuted by (iii) or (iv).
Read next: `coadjoint.derive.mechanics.contact`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

from coadjoint.derive.mechanics.contact import Touch, touch_of
from coadjoint.derive.mechanics.followed import arm
from coadjoint.exact import Element
from coadjoint.exact.dense import add, cross, dot, subtract
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.zero import Decision, Examined, decide_zero

Vector = Sequence[Element]


def about_contact(motion: ConstrainedRates) -> Iterator[Examined]:
    """The claims about a body that touches a surface."""
    touch = touch_of(motion.setting)
    assert touch is not None, "asked for only of bodies that touch a surface"
    claim = partial(_claim, motion)
    moves = "moves with the surface" if touch.contact.turning else "is at rest"
    yield claim(f"the point of the body at the contact {moves}", lambda: _slip(motion, touch))
    yield from _about_points(motion, touch)
    yield claim(*_about_arm(motion, touch), _where(motion, touch))
    if touch.contact.turning is not None:
        yield claim(
            "the surface goes over into itself as it turns",
            lambda: [dot(touch.G, touch.carried)],
            Ideal(motion.field, [touch.F], f"{touch.contact.surface.in_one_line} = 0"),
        )
    yield from _about_projection(motion, touch)


def _claim(
    motion: ConstrainedRates,
    statement: str,
    make: Callable[[], Vector],
    where: Ideal | None = None,
) -> Examined:
    """A claim that elements are zero, everywhere or where relations hold."""

    def decide() -> Decision:
        return decide_zero(list(make()), motion.field, where)

    return statement, "rolling", decide


def _slip(motion: ConstrainedRates, touch: Touch) -> Vector:
    """The velocity of the body at the contact, relative to the surface."""
    setting, rolling = motion.setting, motion.spec.rolling
    assert rolling is not None, "asked for only of bodies that roll"
    by_name = {v.name: v.components for v in setting.spec.variables}
    velocity, turning = (
        setting.elements(by_name[name]) for name in (rolling.velocity, rolling.turning)
    )
    at_contact = subtract(velocity, cross(turning, arm(setting)))
    surface = touch.from_body(touch.carried)
    return [motion.close(x) for x in subtract(at_contact, surface)]


def _where(motion: ConstrainedRates, touch: Touch) -> Ideal:
    """Contact, as relations of the state."""
    return Ideal(motion.field, [value for _, value in touch.residuals], "body and surface touch")


def _parallel(motion: ConstrainedRates, touch: Touch) -> Ideal:
    """That the normals are parallel, without denominators."""
    turned = cross(touch.g, touch.from_body(touch.G))
    return Ideal(motion.field, list(turned), "the normals are opposite")


def _about_points(motion: ConstrainedRates, touch: Touch) -> Iterator[Examined]:
    """That both points stay on their surfaces, and the normals opposite."""
    F, on = touch.contact.surface.in_one_line, touch.contact.place
    stays = f"the point of contact {on} stays on the surface: the rate of {F} is 0"
    if touch.contact.body is None:
        where = Ideal(motion.field, [touch.F], f"{F} = 0") if touch.contact.turning else None
        yield _claim(motion, stays, lambda: [motion.rate(touch.F)], where)
        return
    parallel = _parallel(motion, touch)
    if touch.contact.turning:
        parallel = parallel.also([touch.F], f"the normals are opposite and {F} = 0")
    yield _claim(motion, stays, lambda: [motion.rate(touch.F)], parallel)
    f, at = touch.contact.body.in_one_line, touch.contact.point
    stays = f"the point of contact {at} stays on the body: the rate of {f} is 0"
    yield _claim(motion, stays, lambda: [motion.rate(touch.f)])
    yield _claim(
        motion,
        "the normals of body and surface stay opposite",
        lambda: [motion.rate(x) for x in cross(touch.g, touch.from_body(touch.G))],
        parallel,
    )


def _about_arm(motion: ConstrainedRates, touch: Touch) -> tuple[str, Callable[[], Vector]]:
    """That the centre of mass is where the arm says, in the body or in space."""
    text = motion.spec.rolling.arm.in_one_line if motion.spec.rolling else ""
    if touch.contact.body is not None:
        s = motion.setting.elements(touch.point)
        found = add(arm(motion.setting), s)
        statement = f"{text} + {touch.contact.point} is constant: the arm ends in the body"
    elif touch.contact.centre:
        found = tuple(value for _, value in touch.residuals[1:])
        statement = f"the centre {touch.contact.centre} stays at the radius from the surface"
    else:
        found = subtract(arm(motion.setting), touch.from_body(touch.outwards))
        statement = f"{text} less the radius along the normal is constant"
    return statement, lambda: [motion.rate(x) for x in found]


def _about_projection(motion: ConstrainedRates, touch: Touch) -> Iterator[Examined]:
    """That the projection is a step of Newton, and leaves a state that is in contact."""
    first = motion.equations.projection
    if first is None:
        return
    field, state = motion.field, motion.setting.state
    after = dict(zip(state, map(first.close, first.exact.rates), strict=True))
    functions = [touch.F] + ([] if touch.contact.body is None else [touch.f])
    changes = {name: after[name] - field[name] for name in (*touch.place, *touch.point)}
    yield _claim(
        motion,
        "the projection moves points of contact by a step of Newton onto the surfaces",
        lambda: [
            f + dot(field.gradient(f, list(changes)), list(changes.values())) for f in functions
        ],
    )
    yield _claim(
        motion,
        "the projection leaves points of contact that are in contact as they are",
        lambda: list(changes.values()),
        _where(motion, touch),
    )
    if touch.contact.centre:
        yield _claim(
            motion,
            f"the projection moves the centre {touch.contact.centre} to the radius from the surface",
            lambda: [field.substitute(x, after) for _, x in touch.residuals[1:]],
        )
