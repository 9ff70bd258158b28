r"""Contact: how the point at which a body touches a surface moves.

The surface is F(X) = 0 in space, that of the body f(s) = 0 in its axes. With the gradients g of f
and G of F, seen from the body too, the normals are opposite: :math:`G = -\mu g`. The place of
contact moves by the same :math:`\dot s` along both surfaces, and the normals stay opposite:

.. math::
    Q \dot s = k\, g \times \Omega \ \text{in the tangent plane}, \qquad
    Q = k \nabla^2 f + g^2 \nabla^2 F, \qquad k = -g \cdot G = \mu g^2,

with the angular velocity of the body relative to the surface. In a plane such an equation has the
solution

.. math::
    \dot s = k\, \frac{g \times Q (g^2\, \Omega - g\, (g \cdot \Omega))}
        {g \cdot \mathrm{adj}(Q)\, g},

which divides by the product of the relative principal curvatures, up to factors that are positive.
It is what Montana (1988) writes with curvature forms in charts. A ball of radius r has
:math:`g = -G`, :math:`Q = |G|/r + \nabla^2 F` and k = 1.
Comes in: a Setting with [rolling] on a surface. Goes out: the rates of s and X along an angular
velocity, and what a surface that turns adds to them.
Read next: `coadjoint.derive.mechanics.frames`; `coadjoint.prove.rolling` proves what they keep.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from coadjoint.derive.setting import Setting, fault, once
from coadjoint.exact import Element
from coadjoint.exact.dense import Matrix, add, cross, diagonal, dot, scale, subtract
from coadjoint.spec.sections.contacts import Contact

Vector = tuple[Element, ...]
#: Keeps some components, or gives them names.
Keep = Callable[[Vector], Vector]
#: How many values of a contact have names: G in space and from the body, g, Q and the product.
FUNCTIONS = 16
#: What Q turns, what is 0 at contact, and steps towards contact.
TURNED, MISSED, STEPS = 3, 5, 10


def contact_names() -> tuple[str, ...]:
    """The names of what the kernel computes once of a contact."""
    return tuple(f"_o{n + 1}" for n in range(FUNCTIONS + TURNED + MISSED + STEPS))


def turned_names() -> tuple[str, ...]:
    """The names of what Q turns."""
    return contact_names()[FUNCTIONS : FUNCTIONS + TURNED]


def missed_names() -> tuple[str, ...]:
    """The names of what a projection makes 0."""
    return contact_names()[-MISSED - STEPS : -STEPS]


def step_names() -> tuple[str, ...]:
    """The names of what a projection computes once."""
    return contact_names()[-STEPS:]


@dataclass(frozen=True)
class Bend:
    """Two surfaces at their point of contact.

    Attributes:
        whole: G, in space.
        G: The same, seen as velocities are.
        g: Normal to the body.
        Q: How the normals change along both surfaces.
        k: By what Q is larger than that.
        product: ``g . adj(Q) g``: that of the relative curvatures, times what is positive.
    """

    whole: Vector
    G: Vector
    g: Vector
    Q: Matrix
    k: Element
    product: Element

    def turn(self, turning: Vector) -> Vector:
        """``Q (g^2 w - g (g . w))``."""
        across = subtract(scale(dot(self.g, self.g), turning), scale(dot(self.g, turning), self.g))
        return tuple(dot(row, across) for row in self.Q)

    def move(self, turned: Vector) -> Vector:
        """ds/dt, from what `turn` gives."""
        return scale(self.k / self.product, cross(self.g, turned))

    def solve(self, normal: Vector) -> Vector:
        """The step in the tangent plane by which the normals change by a vector of this plane."""
        turned = cross(self.g, normal)
        return self.move(tuple(-dot(row, turned) for row in self.Q))

    @property
    def aslant(self) -> Vector:
        """``g + G / mu``: what is 0 where the normals are parallel."""
        return add(self.g, scale(-dot(self.g, self.g) / dot(self.g, self.G), self.G))


@dataclass(frozen=True)
class Touch:
    """A body that touches a surface.

    Attributes:
        setting: The spec and its field.
        contact: What is declared of it.
    """

    setting: Setting
    contact: Contact

    # -- points and axes ----------------------------------------------------------------

    @cached_property
    def place(self) -> tuple[str, ...]:
        """Names of the components of X."""
        return self._components(self.contact.place)

    @cached_property
    def point(self) -> tuple[str, ...]:
        """Names of the components of s; none of a ball."""
        return self._components(self.contact.point) if self.contact.point else ()

    def _components(self, name: str) -> tuple[str, ...]:
        return next(v.components for v in self.setting.spec.variables if v.name == name)

    @cached_property
    def _axes(self) -> Matrix:
        """The axes of space; empty where everything is seen from there."""
        return tuple(self.setting.elements(self._components(n)) for n in self.contact.axes)

    def from_body(self, vector: Vector) -> Vector:
        """A vector in space, seen as velocities are."""
        if not self._axes:
            return vector
        return tuple(dot(vector, column) for column in zip(*self._axes, strict=True))

    def in_space(self, vector: Vector) -> Vector:
        """A vector that is seen as velocities are, in space."""
        return tuple(dot(axis, vector) for axis in self._axes) if self._axes else vector

    # -- surfaces -----------------------------------------------------------------------

    @cached_property
    def F(self) -> Element:
        """The function that is 0 on the surface."""
        return self.setting.formula(self.contact.surface)

    @cached_property
    def f(self) -> Element:
        """The function that is 0 on the surface of the body."""
        assert self.contact.body is not None, "a ball has none"
        return self.setting.formula(self.contact.body)

    @cached_property
    def G(self) -> Vector:
        """``dF/dX``, in space."""
        return self.setting.field.gradient(self.F, self.place)

    @cached_property
    def g(self) -> Vector:
        """Normal to the body, outwards: ``df/ds``, or ``-G`` of a ball."""
        if self.contact.body is None:
            return scale(self.setting.field.number(-1), self.from_body(self.G))
        return self.setting.field.gradient(self.f, self.point)

    @cached_property
    def length(self) -> Element:
        """``|G|``."""
        return self.setting.field.call("sqrt", dot(self.G, self.G))

    def _hessian(self, slopes: Vector, names: Sequence[str]) -> Matrix:
        return tuple(self.setting.field.gradient(slope, names) for slope in slopes)

    def _curvature(self, g: Vector, G: Vector) -> Matrix:
        """Q, from the normals seen as velocities are."""
        rows = self._hessian(self.G, self.place)
        seen = tuple(zip(*map(self.from_body, rows), strict=True))
        whole = tuple(map(self.from_body, seen))
        if self.contact.radius is not None:
            across = self.length / self.setting.formula(self.contact.radius)
            return add(diagonal((across, across, across)), whole)
        own = scale(-dot(g, G), self._hessian(self.g, self.point))
        return add(own, scale(dot(g, g), whole))

    def _bend(self, keep: Keep) -> Bend:
        field = self.setting.field
        whole = keep(self.G)
        G = keep(self.from_body(whole)) if self._axes else whole
        g = scale(field.number(-1), G) if self.contact.body is None else keep(self.g)
        (a, b, c), (_, d, e), (*_, f) = self._curvature(g, G)
        a, b, c, d, e, f = keep((a, b, c, d, e, f))
        Q = ((a, b, c), (b, d, e), (c, e, f))
        normals = (cross(Q[1], Q[2]), cross(Q[2], Q[0]), cross(Q[0], Q[1]))
        product = field.sum(x * dot(n, g) for x, n in zip(g, normals, strict=True))
        if field.is_zero(product):
            raise self._flat()
        (product,) = keep((product,))
        k = field.one if self.contact.body is None else -dot(g, G)
        return Bend(whole=whole, G=G, g=g, Q=Q, k=k, product=product)

    def _flat(self) -> Exception:
        message = (
            "the surfaces touch along a line or a whole face; expected one point of contact, where "
            "the curvatures of surface and body are not opposite. Correct the surface or the body."
        )
        return fault(self.setting, self.contact.surface, message, self.contact.surface.text)

    @cached_property
    def closed(self) -> Bend:
        """The surfaces at the contact, in the state."""
        return self._bend(lambda values: values)

    @cached_property
    def _written(self) -> tuple[list[tuple[str, Element]], Bend]:
        """What the kernel computes of them once, and the same in terms of it."""
        lines = list[tuple[str, Element]]()
        return lines, self._bend(self._keep_in(lines, contact_names()))

    def _keep_in(self, lines: list[tuple[str, Element]], names: Sequence[str]) -> Keep:
        """Gives names to what is no number, and lists what they stand for."""
        free = iter(names)

        def name(value: Element) -> Element:
            if self.setting.field.as_number(value) is not None:
                return value
            lines.append((next(free), value))
            return self.setting.field[lines[-1][0]]

        return lambda values: tuple(map(name, values))

    @property
    def functions(self) -> tuple[str, ...]:
        """The names of these, which are functions of positions alone."""
        return tuple(name for name, _ in self._written[0])

    @property
    def named(self) -> Bend:
        """The surfaces at the contact, by the names of what the kernel computes."""
        return self._written[1]

    # -- rates --------------------------------------------------------------------------

    def rates(self, turning: Sequence[Element]) -> dict[str, Element]:
        """Rates of s and X along an angular velocity: the part that is linear in it."""
        field = self.setting.field
        moved = (
            field.sum(c * w for c, w in zip(row, turning, strict=True))
            for row in zip(*self._columns, strict=True)
        )
        return self.spread(tuple(moved))

    def along(self, turning: Sequence[Element], function: Element) -> Element:
        """How points of contact change a function, along an angular velocity."""
        field = self.setting.field
        in_space, in_body = (field.gradient(function, n) for n in (self.place, self.point))
        slopes = self.from_body(in_space)
        if in_body:
            slopes = add(slopes, in_body)
        if not any(slopes):
            return field.zero
        return field.sum(
            dot(slopes, column) * w for column, w in zip(self._columns, turning, strict=True) if w
        )

    @cached_property
    def _columns(self) -> tuple[Vector, ...]:
        """ds/dt along each axis, in names where two surfaces are curved."""
        field, bend = self.setting.field, self.named if self.point else self.closed
        units = diagonal((field.one, field.one, field.one))
        return tuple(bend.move(bend.turn(unit)) for unit in units)

    def spread(self, moved: Vector) -> dict[str, Element]:
        """One velocity along both surfaces, by component."""
        in_space = zip(self.place, self.in_space(moved), strict=True)
        return {**dict(in_space), **dict(zip(self.point, moved, strict=False))}

    @cached_property
    def drift(self) -> dict[str, Element]:
        """What a surface that turns adds to the rates; empty where it is at rest."""
        if self.contact.turning is None:
            return {}
        slower = self.rates(scale(self.setting.field.number(-1), self._turn))
        return self._carry(slower)

    def _carry(self, rates: Mapping[str, Element]) -> dict[str, Element]:
        """Rates with that of the surface itself."""
        carried = dict(zip(self.place, self.carried, strict=True))
        return {name: rate + carried.get(name, 0) for name, rate in rates.items()}

    @property
    def _turn(self) -> Vector:
        """The angular velocity of the surface, seen as velocities are."""
        assert self.contact.turning is not None, "asked for only of surfaces that turn"
        return self.from_body(self.setting.components(self.contact.turning))

    @cached_property
    def carried(self) -> Vector:
        """The velocity of the surface at the point of contact, in space."""
        if self.contact.turning is None:
            return (self.setting.field.zero,) * 3
        X = self.setting.elements(self.place)
        return cross(self.setting.components(self.contact.turning), X)

    def list_lines(self, turning: Vector) -> tuple[list[tuple[str, Element]], dict[str, Element]]:
        """What the kernel computes, with the rates of s and X in terms of it."""
        lines, bend = self._written
        relative = turning if self.contact.turning is None else subtract(turning, self._turn)
        own = turned_names()
        turned = zip(own, bend.turn(relative), strict=True)
        moved = bend.move(self.setting.elements(own))
        return [*lines, *turned], self._carry(self.spread(moved))

    # -- what is kept -------------------------------------------------------------------

    @cached_property
    def residuals(self) -> tuple[tuple[str, Element], ...]:
        """What is 0 while body and surface touch, by name."""
        rows = [("rolling_surface", self.F)]
        if self.contact.body is not None:
            rows += [("rolling_body", self.f), *_number("rolling_normals", self.closed.aslant)]
        elif self.contact.centre:
            rows += _number("rolling_centre", self._off_centre)
        return tuple(rows)

    @property
    def _off_centre(self) -> Vector:
        """``c - X - r n`` of a ball."""
        c, X = map(self._components, (self.contact.centre, self.contact.place))
        found = subtract(self.setting.elements(c), self.setting.elements(X))
        return subtract(found, self.outwards)

    @property
    def outwards(self) -> Vector:
        """``r n`` of a ball, in space: from the point of contact to its centre."""
        assert self.contact.radius is not None, "asked for only of balls"
        return scale(self.setting.formula(self.contact.radius) / self.length, self.G)

    @property
    def bounds(self) -> tuple[tuple[str, Element], ...]:
        """What is positive where surfaces touch at one point only of all that are near.

        The product of the relative principal curvatures, their sum, and of a body that is no ball
        how far the normals are opposite.
        """
        bend = self.named
        trace = dot(bend.g, bend.g) * (bend.Q[0][0] + bend.Q[1][1] + bend.Q[2][2])
        along = dot(bend.g, tuple(dot(row, bend.g) for row in bend.Q))
        found = [("rolling_apart", bend.product), ("rolling_outside", trace - along)]
        if self.contact.body is not None:
            found.append(("rolling_facing", -dot(bend.g, bend.G)))
        return tuple(found)

    @property
    def missed(self) -> list[tuple[str, Element]]:
        """What a projection makes 0, by the names that `nearest` uses."""
        values = [self.F]
        if self.contact.body is not None:
            values += [self.f, *self.named.aslant]
        return list(zip(missed_names(), values, strict=False))

    def nearest(
        self, decide: Callable[[Element], Element]
    ) -> tuple[list[tuple[str, Element]], dict[str, Element]]:
        """A state nearer to contact, by one step of Newton.

        Each point moves along the normal onto its surface, and the normals are made opposite by
        rolling along both surfaces. The centre of a ball follows.

        Args:
            decide: Writes what names stand for that are not computed.

        Returns:
            What has names, in order, and what the step changes, in terms of these.
        """
        bend, field, lines = self.named, self.setting.field, list[tuple[str, Element]]()
        keep = self._keep_in(lines, step_names())
        above, *others = self.setting.elements([name for name, _ in self.missed])
        squared = dot(bend.whole, bend.whole)
        rolled: Vector = (field.zero,) * 3
        changes = dict[str, Element]()
        if others:
            inside, *aslant = others
            onto = keep(scale(-inside / dot(bend.g, bend.g), bend.g))
            turned = keep(self._turned_by(bend, onto, scale(-above / squared, bend.G)))
            rolled = keep(scale(field.number(-1), bend.solve(add(tuple(aslant), turned))))
            changes |= zip(self.point, add(rolled, onto), strict=True)
            (above,) = keep((above + dot(bend.G, rolled),))
        down = scale(-above / squared, bend.whole)
        changes |= zip(self.place, add(self.in_space(rolled), down), strict=True)
        after = {name: decide(field[name] + change) for name, change in changes.items()}
        if self.contact.centre:
            X = tuple(after[name] for name in self.place)
            out = [field.substitute(x, after) for x in self.outwards]
            after |= zip(self._components(self.contact.centre), add(X, tuple(out)), strict=True)
        return [(name, decide(value)) for name, value in lines], after

    def _turned_by(self, bend: Bend, on_body: Vector, in_space: Vector) -> Vector:
        """How the normals change where each point moves on its own."""
        own = self._hessian(self.g, self.point)
        apart = tuple(dot(row, subtract(on_body, in_space)) for row in own)
        return add(apart, scale(1 / bend.k, tuple(dot(row, in_space) for row in bend.Q)))


def _number(name: str, values: Sequence[Element]) -> list[tuple[str, Element]]:
    """Components under a common name."""
    return [(f"{name}{n}", value) for n, value in enumerate(values, 1)]


@once
def touch_of(setting: Setting) -> Touch | None:
    """How a body touches a surface; None where none does, or on a plane."""
    rolling = setting.spec.rolling
    if rolling is None or rolling.contact is None:
        return None
    return Touch(setting, rolling.contact)
