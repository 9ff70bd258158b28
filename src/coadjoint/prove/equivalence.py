"""Equality of routes: the same motion, through the map that relates their variables.

Comes in: Equations by two routes of one Spec, in one Setting. Goes out: elements that must be zero,
by the claim they belong to. Where a Lagrangian is given, the map is the Legendre transform
``mu = dl/dxi``: both sides are pulled back to velocities, where everything is polynomial. It
loses nothing where the transform is invertible; another claim says where that is proved.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.configuration import (
    LARGEST_BLOCK,
    Matrix,
    coupled_blocks,
    mechanics,
)
from coadjoint.derive.mechanics.iteration import Newton
from coadjoint.derive.mechanics.solution_defects import solution_defects
from coadjoint.derive.mechanics.solver import Solve
from coadjoint.derive.setting import once
from coadjoint.exact import Element, Field
from coadjoint.exact.dense import determinant
from coadjoint.exact.ranks import witness_regular
from coadjoint.exact.signs import sign
from coadjoint.exact.witness import is_entire, point_text


@dataclass(frozen=True)
class Invertible:
    """Where a Legendre transform is invertible, and how that is known.

    Attributes:
        where: In words, after "is invertible".
        method: The proof.
    """

    where: str
    method: str


class LegendreMap:
    """Pull-back by ``mu = dl/dxi`` of functions of the state to functions of the velocities."""

    def __init__(self, equations: Equations) -> None:
        setting = equations.setting
        self.setting, self.lagrangian = setting, setting.lagrangian
        self.slopes = mechanics(setting).momenta
        # where velocities are themselves the state there is nothing to pull back
        pairs = zip(self.slopes, setting.conjugates, strict=bool(setting.momenta))
        self.momenta = {mu: slope * w for slope, (_, mu, w) in pairs}
        self._images: dict[str, dict[str, Element]] = {}

    @staticmethod
    def applies(equations: Equations) -> bool:
        """Whether velocities are other coordinates of the state, not part of it."""
        spec = equations.spec
        transformed = spec.lagrangian is not None and not spec.variational
        transformed = transformed and not spec.is_first_order
        return transformed and bool(equations.setting.momenta)

    def pull_back(self, equations: Equations, element: Element) -> Element:
        """An element of one route's Equations in velocities and advected quantities alone."""
        if equations.route not in self._images:
            # what the kernel solves for is what mu = dl/dxi was solved for: its own symbol
            velocities = {
                name: self.setting.field.substitute(equations.close(value), self.momenta)
                for name, value in equations.exact.definitions
                if name not in equations.kept
            }
            self._images[equations.route] = self.momenta | velocities
        return self.setting.field.substitute(element, self._images[equations.route])

    @cached_property
    def blocks(self) -> list[tuple[tuple[int, ...], Matrix]]:
        """The blocks of ``d2l/dxi2`` with their places."""
        mass = mechanics(self.setting).mass
        return [
            (block, tuple(tuple(mass[i][j] for j in block) for i in block))
            for block in coupled_blocks(mass)
        ]

    @property
    def is_local(self) -> bool:
        """Whether determinants tell of small changes alone: l is not quadratic in velocities."""
        return bool(mechanics(self.setting).bending)

    @cached_property
    def invertible(self) -> Invertible:
        """Where the map is invertible.

        Raises:
            AssertionError: Nowhere, as far as is known; `legendre_transform` refuses those.
        """
        field = self.setting.field
        left = [matrix for _, matrix in self.blocks if not _keeps_sign(field, matrix)]
        if not left:
            inside = "in all of [domain], " if field.region.conditions else ""
            return Invertible(
                f"{inside}wherever the Lagrangian is defined and the declared signs hold",
                "the determinants of the blocks of d2l/dxi2 have constant sign there",
            )
        point = witness_regular(field, *left)
        assert point is not None, "legendre_transform refuses these"
        at = point_text(point)
        method = "the determinants of the blocks of d2l/dxi2 exclude 0 by interval bounds"
        method += f" at {at}" if at else ""
        if is_entire(field, (entry for matrix in left for row in matrix for entry in row)):
            return Invertible("almost everywhere", method)
        part = f"almost everywhere on the connected part of its domain with {at}"
        return Invertible(part, method)

    def solution_defects(self, equations: Equations) -> list[Element]:
        """What vanishes if the kernel solves for its velocities at ``mu = dl/dxi``."""
        field = self.setting.field
        defects, definitions = list[Element](), dict(equations.exact.definitions)
        for solve in equations.exact.solves:
            defects += solution_defects(field, solve, definitions)
            guesses = [] if solve.newton is None else solve.newton.names
            at = {n: field[name] for n, name in zip(guesses, solve.names, strict=False)}
            for entries, known in zip(solve.matrix, solve.known, strict=True):
                products = (
                    field.substitute(entry, at) * field[name]
                    for entry, name in zip(entries, solve.names, strict=True)
                )
                residual = field.substitute(known, at) - field.sum(products)
                defects.append(field.substitute(residual, self.momenta))
            if solve.newton is not None:
                defects += self._guess_defects(solve, solve.newton, at)
        return defects

    def _guess_defects(
        self, solve: Solve, newton: Newton, at: Mapping[str, Element]
    ) -> list[Element]:
        """What vanishes if the iteration has its end at ``mu = dl/dxi``, and H is d2l/dxi2."""
        field, mass = self.setting.field, mechanics(self.setting).mass
        defects = []
        for i, mu, slope, row in zip(
            newton.block, newton.sought, newton.slopes, newton.hessian, strict=True
        ):
            defects.append(field.substitute(mu - field.substitute(slope, at), self.momenta))
            defects += [
                field.substitute(entry, at) - mass[i][j]
                for j, entry in zip(solve.block, row, strict=True)
            ]
        return defects

    def energy_defects(self, equations: Equations) -> list[Element]:
        """``h(dl/dxi, a) - (<dl/dxi, xi> - l)``."""
        field = self.setting.field
        names = mechanics(self.setting).frame.velocities
        pairs = zip(self.slopes, names, strict=True)
        energy = sum((slope * field[xi] for slope, xi in pairs), -self.lagrangian)
        assert equations.exact.energy is not None, "a Lagrangian has an energy"
        return [self.pull_back(equations, equations.exact.energy) - energy]

    def velocity_defects(self, equations: Equations) -> list[Element]:
        """``dh/dmu - xi`` at ``mu = dl/dxi``."""
        field = self.setting.field
        assert equations.exact.energy is not None, "a Lagrangian has an energy"
        momenta = [mu for _, mu, _ in self.setting.conjugates]
        slopes = field.gradient(equations.exact.energy, momenta)
        # at fixed velocities, if h is stationary in those that keep their names
        inner = field.gradient(equations.exact.energy, kept_velocities(equations))
        return [
            *(self.pull_back(equations, slope) for slope in inner),
            *(
                self.pull_back(equations, slope) * w - field[xi]
                for slope, (xi, _, w) in zip(slopes, self.setting.conjugates, strict=True)
            ),
        ]

    def rate_defects(self, first: Equations, second: Equations) -> list[Element]:
        """Differences of the rates of two routes, both in velocities."""
        return [
            self.pull_back(first, a) - self.pull_back(second, b)
            for a, b in zip(first.exact.rates, second.exact.rates, strict=True)
        ]


def _keeps_sign(field: Field, matrix: Matrix) -> bool:
    """Whether a determinant is small enough to write out, and has a sign on the whole domain."""
    return len(matrix) <= LARGEST_BLOCK and sign(field, determinant(matrix)) != 0


def kept_velocities(equations: Equations) -> list[str]:
    """Velocities that the kernel solves for."""
    setting = equations.setting
    named = [xi for xi, _, _ in setting.conjugates] if setting.momenta else setting.velocities
    return [name for name in named if name in equations.kept]


def in_velocities(equations: Equations, elements: Iterable[Element]) -> list[Element]:
    """Elements with a decidable zero: in the state, or where the kernel solves, in velocities.

    A velocity that keeps its name is not independent of its momentum. The momentum is
    replaced by ``dl/dxi``, and velocities and the rest of the state are independent again.
    """
    closed = [equations.close(element) for element in elements]
    if not equations.kept:
        return closed
    momenta = _solved_momenta(equations)
    return [equations.setting.field.substitute(element, momenta) for element in closed]


@once
def _solved_momenta(equations: Equations) -> dict[str, Element]:
    """The momenta of the velocities that the kernel solves for, in velocities."""
    momenta, pairs = LegendreMap(equations).momenta, equations.setting.conjugates
    return {mu: momenta[mu] for xi, mu, _ in pairs if xi in equations.kept}
