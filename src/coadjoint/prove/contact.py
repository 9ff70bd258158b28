r"""Contact: what is claimed of a body that rolls on any surface.

With f and F that are zero on the surfaces of the body and in space, g and G their gradients: (i)
the point of the body at the contact moves with the surface; (ii) the points of contact stay on both
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

from coadjoint.derive.mechanics.contact import Touch, step_names, touch_of, turned_names
from coadjoint.derive.mechanics.followed import arm
from coadjoint.derive.mechanics.kinematics import rate_name
from coadjoint.exact import Element
from coadjoint.exact.dense import add, cross, dot, scale, subtract
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
    yield claim(*_about_arm(motion, touch), None if touch.point else _where(motion, touch))
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


def _about_points(motion: ConstrainedRates, touch: Touch) -> Iterator[Examined]:
    """That both points stay on their surfaces, and the normals opposite."""
    F, on = touch.contact.surface.in_one_line, touch.contact.place
    stays = f"the point of contact {on} stays on the surface: the rate of {F} is 0"
    if touch.contact.body is None:
        where = Ideal(motion.field, [touch.F], f"{F} = 0") if touch.contact.turning else None
        yield _claim(motion, stays, lambda: [motion.rate(touch.F)], where)
        return
    rates = _Normals(motion, touch)
    yield _claim(motion, f"{stays} where the normals are opposite", rates.of_surface)
    f, at = touch.contact.body.in_one_line, touch.contact.point
    stays = f"the point of contact {at} stays on the body: the rate of {f} is 0"
    yield _claim(motion, stays, rates.of_body)
    yield _claim(motion, "the normals of body and surface stay opposite", rates.of_normals)


class _Normals:
    r"""The rates of what two curved surfaces keep, without the curvatures written out.

    With :math:`c = g \times G`, which is 0 where the normals are parallel, and any velocity w of
    the point of contact along the body,

    .. math::
        g^2 \dot c = g \times (Q w - k\, g \times \Omega)
            - f'' w \times (g \times c) - g \times ((g \times c) \times \Omega), \qquad
        g^2 \dot F = (g \cdot G)(g \cdot w) - (g \times c) \cdot w.

    These identities, and that the w of the kernel makes the first terms 0, are what is decided.
    """

    def __init__(self, motion: ConstrainedRates, touch: Touch) -> None:
        self.motion, self.touch, self.field = motion, touch, motion.field
        first = motion.equations
        self.definitions = dict(first.exact.definitions)
        self.rates = dict(zip(motion.setting.state, first.exact.rates, strict=True))
        self.w = motion.setting.elements([rate_name(name) for name in touch.point])

    def of_body(self) -> Vector:
        """``g . ds/dt``, with g as the kernel has it; and that this is g."""
        return [self._put(dot(self._g, self._s)), *self._gradients()]

    def of_surface(self) -> Vector:
        """The second identity, and ``g . ds/dt``."""
        g, G, w = self.touch.g, self._G, self.w
        c = cross(g, G)
        moved = dot(self.touch.G, self.touch.in_space(self.w))
        identity = dot(g, g) * moved - dot(g, G) * dot(g, w) + dot(cross(g, c), w)
        return [identity, *self._carried(), *self.of_body()]

    def of_normals(self) -> Vector:
        """The first identity, and what the w of the kernel makes of it."""
        g, G, w, field = self.touch.g, self._G, self.w, self.field
        c, Omega = cross(g, G), self._turning
        own = [self._along(x) for x in c]
        Q = [[self._close(x) for x in row] for row in self.touch.named.Q]
        k = -dot(g, G)
        turned = tuple(dot(row, w) for row in Q)
        first = cross(g, subtract(turned, scale(k, cross(g, Omega))))
        bent = tuple(dot(field.gradient(x, self.touch.point), w) for x in g)
        aside = cross(g, c)
        rest = add(cross(bent, aside), cross(g, cross(aside, Omega)))
        identity = [dot(g, g) * x - y + z for x, y, z in zip(own, first, rest, strict=True)]
        bend = self.touch.named
        moved = tuple(dot(row, self._s) for row in bend.Q)
        solved = cross(bend.g, subtract(moved, scale(bend.k, cross(bend.g, Omega))))
        return [*identity, *self._carried(), *map(self._put, solved), *self._gradients()]

    # -- the parts ----------------------------------------------------------------------

    @property
    def _G(self) -> tuple[Element, ...]:
        return self.touch.from_body(self.touch.G)

    @property
    def _g(self) -> tuple[Element, ...]:
        return self.touch.named.g

    @property
    def _turning(self) -> tuple[Element, ...]:
        frame = self.motion.distribution.frame
        return frame.turning(self.motion.setting.elements(frame.velocities))

    @property
    def _s(self) -> tuple[Element, ...]:
        """ds/dt in names of the kernel."""
        return tuple(self.definitions.get(name, self.field.zero) for name in self._names)

    @property
    def _names(self) -> list[str]:
        return [rate_name(name) for name in self.touch.point]

    def _carried(self) -> list[Element]:
        """dX/dt of the kernel minus its ds/dt, seen from space."""
        names = [rate_name(name) for name in self.touch.place]
        moved = tuple(self.definitions.get(name, self.field.zero) for name in names)
        return list(subtract(moved, self.touch.in_space(self._s)))

    def _along(self, function: Element) -> Element:
        """The rate of a function of positions, w being the velocity of the contact on the body."""
        frame = self.motion.distribution.frame
        rates = frame.rates_apart(self.motion.setting.elements(frame.velocities))
        rates |= zip(self.touch.point, self.w, strict=True)
        rates |= zip(self.touch.place, self.touch.in_space(self.w), strict=True)
        slopes = zip(self.field.gradient(function, list(rates)), rates.values(), strict=True)
        return self.field.sum(slope * rate for slope, rate in slopes if slope != 0)

    def _put(self, element: Element) -> Element:
        """An element in g, Q and Omega alone: with what is made of these."""
        for name in (*reversed(turned_names()), self.touch.functions[-1]):
            value = self.definitions.get(name, self.field.zero)
            element = self.field.substitute(element, {name: value})
        return element

    def _close(self, element: Element) -> Element:
        """An element in the state, with all that is known of the surfaces."""
        for name in reversed(self.touch.functions):
            value = self.definitions.get(name, self.field.zero)
            element = self.field.substitute(element, {name: value})
        return element

    def _gradients(self) -> list[Element]:
        """What the kernel takes for g and k, minus the gradients."""
        named, g = self.touch.named, self.touch.g
        found = [self._close(x) - y for x, y in zip(named.g, g, strict=True)]
        return [*found, self._close(named.k) + dot(g, self._G)]


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
    whole = motion.equations
    first = whole.onto_constraints if whole.spec.turning else whole.projection
    if first is None:
        return
    field, names = motion.field, [name for name, _ in touch.missed]
    defined, known = dict(first.exact.definitions), dict[str, Element]()
    for name in filter(defined.__contains__, step_names()):
        known[name] = field.substitute(defined[name], known)
    moved = (field.substitute(value, known) for value in first.exact.rates)
    after = dict(zip(motion.setting.state, moved, strict=True))
    missed = motion.setting.elements(names)
    points = [touch.place, *([touch.point] if touch.point else [])]
    steps = [[after[name] - field[name] for name in point] for point in points]
    normals = [touch.named.whole, touch.named.g]

    def miss() -> Vector:
        """The functions after a step, as far as their gradients tell; and what has their names."""
        told = zip(missed, normals, steps, strict=False)
        rows = [_in_whole(touch, f + dot(normal, step)) for f, normal, step in told]
        named = [defined[name] - first.close(value) for name, value in touch.missed[: len(rows)]]
        return [*(rows if touch.point else map(first.close, rows)), *named]

    text = "the projection moves points of contact by a step of Newton onto the surfaces"
    yield _claim(motion, text, miss)
    rest = dict.fromkeys(names, field.zero)
    yield _claim(
        motion,
        "the projection leaves points of contact that are in contact as they are",
        lambda: [field.substitute(x, rest) for step in steps for x in step],
    )
    after = dict(zip(motion.setting.state, map(first.close, first.exact.rates), strict=True))
    if touch.contact.centre:
        yield _claim(
            motion,
            f"the projection moves the centre {touch.contact.centre} to the radius from the "
            "surface",
            lambda: [field.substitute(x, after) for _, x in touch.residuals[1:]],
        )


def _in_whole(touch: Touch, element: Element) -> Element:
    """An element with the normal G from the body by that in space."""
    field = touch.setting.field
    seen = touch.from_body(touch.named.whole)
    pairs = zip(touch.named.G, seen, strict=True)
    named = {name: value for x, value in pairs for name in field.names_in(x) if x != value}
    return field.substitute(element, named)
