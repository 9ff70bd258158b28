"""Equality of routes: the same motion, through the map that relates their variables.

Comes in: Equations by two routes of one Spec, in one Setting. Goes out: elements that must be zero,
by the claim they belong to. Where a Lagrangian is given, the map is the Legendre transform
``mu = dl/dxi``: both sides are pulled back to velocities, where everything is polynomial. It
loses nothing, since the transform is invertible (a claim of its own).
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property

from coadjoint.derive import Equations
from coadjoint.derive.interpret import determinant
from coadjoint.derive.legendre import (
    LARGEST_BLOCK,
    Matrix,
    coupled_blocks,
    known_side,
    mass_matrix,
)
from coadjoint.derive.solver import Solve, solution_defects
from coadjoint.exact import Element
from coadjoint.poisson.ranks import generic_rank


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
        scaled = zip(self.slopes, setting.weights or (1,) * len(self.slopes), strict=True)
        given = [slope * w for slope, w in scaled] if setting.momenta else []
        self.momenta = dict(zip(setting.momenta, given, strict=True))
        self._images: dict[str, dict[str, Element]] = {}

    @staticmethod
    def applies(equations: Equations) -> bool:
        """Whether velocities are other coordinates of the state, not part of it."""
        return equations.spec.lagrangian is not None and bool(equations.setting.momenta)

    def pull_back(self, equations: Equations, element: Element) -> Element:
        """An element of one route's Equations in velocities and advected quantities alone."""
        if equations.route not in self._images:
            # what the kernel solves for is what mu = dl/dxi was solved for: its own symbol
            velocities = {
                name: self.setting.field.substitute(value, self.momenta)
                for name, value in equations.exact.definitions
                if name not in equations.kept
            }
            self._images[equations.route] = self.momenta | velocities
        return self.setting.field.substitute(element, self._images[equations.route])

    @cached_property
    def blocks(self) -> list[tuple[tuple[int, ...], Matrix]]:
        """The blocks of ``d2l/dxi2`` with their places."""
        mass = mass_matrix(self.setting, self.lagrangian)
        return [
            (block, tuple(tuple(mass[i][j] for j in block) for i in block))
            for block in coupled_blocks(mass)
        ]

    def is_invertible(self) -> bool:
        """Whether no determinant of a block vanishes, so that the map is invertible somewhere.

        One of full rank at a point modulo a prime does not.
        """
        field = self.setting.field
        return all(
            generic_rank(field, [dict(enumerate(row)) for row in matrix]) == len(block)
            if len(block) > LARGEST_BLOCK
            else not field.is_zero(determinant(matrix))
            for block, matrix in self.blocks
        )

    def solution_defects(self, equations: Equations) -> list[Element]:
        """What vanishes if the kernel solves ``mass * xi = mu - dl/dxi(0)`` for its velocities."""
        known = known_side(self.setting, self.slopes)
        return [
            defect
            for block, matrix in self.blocks
            if len(block) > LARGEST_BLOCK
            for defect in solution_defects(
                self.setting.field,
                Solve(
                    matrix,
                    [known[i] for i in block],
                    block,
                    [self.setting.velocities[i] for i in block],
                ),
                dict(equations.exact.definitions),
            )
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
        names = self.setting.velocities
        slopes = field.gradient(equations.exact.energy, self.setting.momenta)
        # at fixed velocities, if h is stationary in those that keep their names
        inner = field.gradient(equations.exact.energy, kept_velocities(equations))
        return [
            *(self.pull_back(equations, slope) for slope in inner),
            *(
                self.pull_back(equations, slope) * w - field[xi]
                for slope, xi, w in zip(slopes, names, self.setting.weights, strict=True)
            ),
        ]

    def rate_defects(self, first: Equations, second: Equations) -> list[Element]:
        """Differences of the rates of two routes, both in velocities."""
        return [
            self.pull_back(first, a) - self.pull_back(second, b)
            for a, b in zip(first.exact.rates, second.exact.rates, strict=True)
        ]


def kept_velocities(equations: Equations) -> list[str]:
    """Velocities that the kernel solves for."""
    return [name for name in equations.setting.velocities if name in equations.kept]


def in_velocities(equations: Equations, elements: Iterable[Element]) -> list[Element]:
    """Elements with a decidable zero: in the state, or where the kernel solves, in velocities.

    A velocity that keeps its name is no independent symbol beside its momentum. The momentum is
    replaced by ``dl/dxi``, and velocities and the rest of the state are independent again.
    """
    closed = [equations.closed(element) for element in elements]
    if not equations.kept:
        return closed
    pairs = zip(equations.setting.velocities, LegendreMap(equations).momenta.items(), strict=True)
    momenta = {mu: slope for xi, (mu, slope) in pairs if xi in equations.kept}
    return [equations.setting.field.substitute(element, momenta) for element in closed]
