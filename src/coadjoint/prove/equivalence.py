"""Equality of routes: the same motion, through the map that relates their variables.

Comes in: Equations by two routes of one Spec, in one Setting. Goes out: elements that must be zero,
by the claim they belong to. Where a Lagrangian is given, the map is the Legendre transform
``mu = dl/dxi``: both sides are pulled back to velocities, where everything is polynomial. It
loses nothing, since the transform is invertible (a claim of its own).
"""

from __future__ import annotations

from coadjoint.derive import Equations
from coadjoint.derive.interpret import determinant
from coadjoint.derive.legendre import coupled_blocks
from coadjoint.exact import Element


class LegendreMap:
    """Pull-back by ``mu = dl/dxi`` of functions of the state to functions of the velocities."""

    def __init__(self, equations: Equations) -> None:
        setting = equations.setting
        formula = setting.spec.lagrangian
        assert formula is not None, "only a Lagrangian has a Legendre transform"
        self.setting = setting
        self.lagrangian = setting.formula(formula)
        self.slopes = setting.field.gradient(self.lagrangian, setting.velocities)
        # where velocities are themselves the state there is nothing to pull back
        given = self.slopes if setting.momenta else ()
        self.momenta = dict(zip(setting.momenta, given, strict=True))

    @staticmethod
    def applies(equations: Equations) -> bool:
        """Whether velocities are other coordinates of the state, not part of it."""
        return equations.spec.lagrangian is not None and bool(equations.setting.momenta)

    def pull_back(self, equations: Equations, element: Element) -> Element:
        """An element of one route's Equations in velocities and advected quantities alone."""
        field = self.setting.field
        velocities = {
            name: field.substitute(value, self.momenta)
            for name, value in equations.exact.definitions
        }
        return field.substitute(element, self.momenta | velocities)

    def determinants(self) -> list[Element]:
        """Determinants of the blocks of ``d2l/dxi2``: the map is invertible where none vanishes."""
        field, names = self.setting.field, self.setting.velocities
        mass = tuple(field.gradient(slope, names) for slope in self.slopes)
        return [
            determinant(tuple(tuple(mass[i][j] for j in block) for i in block))
            for block in coupled_blocks(mass)
        ]

    def energy_defects(self, equations: Equations) -> list[Element]:
        """``h(dl/dxi, a) - (<dl/dxi, xi> - l)``."""
        field = self.setting.field
        pairs = zip(self.slopes, self.setting.velocities, strict=True)
        energy = sum((slope * field[xi] for slope, xi in pairs), -self.lagrangian)
        assert equations.exact.energy is not None, "a Lagrangian has an energy"
        return [self.pull_back(equations, equations.exact.energy) - energy]

    def velocity_defects(self, equations: Equations) -> list[Element]:
        """``dh/dmu - xi`` at ``mu = dl/dxi``."""
        field = self.setting.field
        assert equations.exact.energy is not None, "a Lagrangian has an energy"
        slopes = field.gradient(equations.exact.energy, self.setting.momenta)
        return [
            self.pull_back(equations, slope) - field[xi]
            for slope, xi in zip(slopes, self.setting.velocities, strict=True)
        ]

    def rate_defects(self, first: Equations, second: Equations) -> list[Element]:
        """Differences of the rates of two routes, both in velocities."""
        return [
            self.pull_back(first, a) - self.pull_back(second, b)
            for a, b in zip(first.exact.rates, second.exact.rates, strict=True)
        ]
