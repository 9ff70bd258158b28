r"""Frames: quasi-velocities, their vector fields and how these commute.

A velocity :math:`\xi = \xi^k X_k` moves positions z, which are advected quantities and coordinates,
by :math:`\dot z = \xi^k X_k z`. Along an algebra the fields commute as its basis does, with the
other sign if the system is right invariant; velocities of coordinates are
:math:`X = \partial/\partial q` and commute with everything. Poincare's equations (Holm 2011,
appendix D) then hold for both at once,

.. math::
    \frac{d}{dt} \frac{\partial l}{\partial \xi^k}
        = \Big\langle \frac{\partial l}{\partial \xi}, [\xi, X_k] \Big\rangle + X_k l.

Comes in: a Setting. Goes out: these fields, brackets and forces.
Read next: `coadjoint.derive.mechanics.distribution`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from coadjoint.derive.mechanics.contact import Touch, touch_of
from coadjoint.derive.setting import Setting, list_components, once
from coadjoint.exact import Element

#: Components along the velocities of a frame.
Vector = tuple[Element, ...]


@dataclass(frozen=True)
class Frame:
    """The velocities of a system with their vector fields.

    Attributes:
        setting: The spec and its field.
    """

    setting: Setting

    @cached_property
    def velocities(self) -> tuple[str, ...]:
        """Names of all velocities: along the algebra, then of coordinates."""
        setting, coordinates = self.setting, self.setting.spec.having_role("coordinate")
        if setting.spec.algebra is None:
            return setting.velocities
        partners = (setting.spec.partner("velocity", q.name) for q in coordinates)
        return (*setting.velocities, *list_components(filter(None, partners)))

    @cached_property
    def positions(self) -> tuple[str, ...]:
        """Names of what the velocities move."""
        touching = () if self.touch is None else (*self.touch.place, *self.touch.point)
        return (*self.setting.advected_names, *self.setting.positions, *touching)

    @property
    def touch(self) -> Touch | None:
        """How a body touches a surface, if one does."""
        return touch_of(self.setting)

    def turning(self, vector: Sequence[Element]) -> tuple[Element, ...]:
        """The angular velocity in a vector of the frame, of a body that rolls on a surface."""
        rolling = self.setting.spec.rolling
        assert rolling is not None, "asked for only of bodies that roll"
        names = next(v.components for v in self.setting.spec.variables if v.name == rolling.turning)
        return tuple(vector[self.velocities.index(name)] for name in names)

    @cached_property
    def _own(self) -> int:
        """How many of the velocities are along the algebra."""
        return 0 if self.setting.spec.algebra is None else self.setting.algebra.dimension

    def rates(self, vector: Sequence[Element]) -> dict[str, Element]:
        """``X z`` of every position z, along a vector of the frame; without `drift`."""
        moved = self.rates_apart(vector)
        return moved if self.touch is None else moved | self.touch.rates(self.turning(vector))

    def rates_apart(self, vector: Sequence[Element]) -> dict[str, Element]:
        """The same of all but points of contact."""
        setting, moved = self.setting, dict[str, Element]()
        for variable in setting.advected:
            a = setting.elements(variable.components)
            acted = setting.actions[variable.name].act(vector[: self._own], a)
            moved |= {
                name: setting.field.zero - setting.sign * x
                for name, x in zip(variable.components, acted, strict=True)
            }
        return moved | dict(zip(setting.positions, vector[self._own :], strict=True))

    def drift(self, function: Element) -> Element:
        """How a function of the positions changes at rest: by a surface that turns."""
        field, own = self.setting.field, {} if self.touch is None else self.touch.drift
        slopes = zip(field.gradient(function, list(own)), own.values(), strict=True)
        return field.sum(slope * rate for slope, rate in slopes if slope != 0)

    def along(self, vector: Sequence[Element], function: Element) -> Element:
        """``X f`` of a function of the positions, along a vector of the frame."""
        field, moved = self.setting.field, self.rates_apart(vector)
        pairs = zip(field.gradient(function, list(moved)), moved.values(), strict=True)
        whole = field.sum(slope * rate for slope, rate in pairs if slope != 0)
        if self.touch is None:
            return whole
        return whole + self.touch.along(self.turning(vector), function)

    def unit(self, k: int) -> Vector:
        """The k-th vector of the frame."""
        field = self.setting.field
        return tuple(field.one if i == k else field.zero for i in range(len(self.velocities)))

    def structure(self, a: Sequence[Element], b: Sequence[Element]) -> Vector:
        """``a^i b^j [X_i, X_j]``: the bracket of vectors with constant components."""
        own = self._own
        return self._extend(self.setting.algebra.bracket(a[:own], b[:own]) if own else ())

    def _extend(self, along: Sequence[Element | int]) -> Vector:
        """Components along the algebra, of the sign of its side; zeros along coordinates."""
        zero, sign = self.setting.field.zero, self.setting.sign
        rest = [zero] * (len(self.velocities) - self._own)
        return (*(zero + sign * x for x in along), *rest)

    def bracket(self, a: Sequence[Element], b: Sequence[Element]) -> Vector:
        """``[a, b]`` of vector fields whose components are functions of the positions."""
        pairs = zip(a, b, self.structure(a, b), strict=True)
        return tuple(self.along(a, y) - self.along(b, x) + c for x, y, c in pairs)

    def inertial(self, momenta: Sequence[Element], vector: Sequence[Element]) -> Vector:
        """``<p, [xi, X_k]>`` for every k."""
        own = self._own
        return self._extend(
            self.setting.algebra.ad_star(vector[:own], momenta[:own]) if own else ()
        )

    def slopes(self, function: Element) -> Vector:
        """``X_k f`` for every k."""
        return tuple(self.along(self.unit(k), function) for k in range(len(self.velocities)))


@once
def frame_of(setting: Setting) -> Frame:
    """The frame of a system."""
    return Frame(setting)
