r"""Constrained motions: rates of functions, the energy and the divergence where constraints bind.

Comes in: Equations with a distribution. Goes out: their motion. A rate is affine in the
accelerations, which solve :math:`\mathcal{M} x = k`; its value is written with
determinants,

.. math:: c \cdot x + d = d - \det \begin{pmatrix} \mathcal{M} & k \\ c & 0 \end{pmatrix}
    \Big/ \det \mathcal{M},

so that it is a rational function with a decidable zero. Constraints that are kept are relations.
Read next: `coadjoint.prove.constraints`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from types import MappingProxyType

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.configuration import LARGEST_BLOCK
from coadjoint.derive.mechanics.distribution import Distribution, Equation, Row
from coadjoint.derive.mechanics.driving import explicit
from coadjoint.derive.mechanics.kinematics import rate_name
from coadjoint.derive.mechanics.sections import section_components
from coadjoint.derive.mechanics.solver import Solve
from coadjoint.derive.setting import once
from coadjoint.exact import Element
from coadjoint.exact.dense import adjugate, determinant, dot
from coadjoint.exact.residues import Residue, call_modulo, draw, residue
from coadjoint.prove.energy import Balance
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.identities import followed_rate
from coadjoint.prove.motion import Motion
from coadjoint.prove.relaxation import lost

#: No combination of the equations of motion.
NO_DIRECTION: Mapping[str, Element] = MappingProxyType({})


class ConstrainedRates(Motion):
    """A motion along a frame, whose accelerations the kernel solves for.

    The equations are by a route with a distribution.
    """

    @property
    def distribution(self) -> Distribution:
        """The velocities that the constraints allow."""
        distribution = self.equations.distribution
        assert distribution is not None, self.equations.route
        return distribution

    @cached_property
    def fibre(self) -> tuple[str, ...]:
        """The independent velocities."""
        return self.distribution.independent

    @cached_property
    def positions(self) -> tuple[str, ...]:
        """What the velocities move."""
        state = {*self.setting.state}
        return tuple(name for name in self.distribution.frame.positions if name in state)

    @property
    def kept(self) -> tuple[tuple[Equation, Element], ...]:
        """The constraints that give no velocity, with their residuals."""
        return self.distribution.kept

    @property
    def kept_rows(self) -> list[Row]:
        """``(A, -b)`` of these."""
        return self.distribution.kept_rows

    @cached_property
    def where(self) -> Ideal:
        """The constraints that are kept, as relations of the state.

        No motion is defined where they depend on each other, as where one has no velocity left:
        ``q*u == q*v`` at q = 0. There a claim says nothing, and the certificate says so.
        """
        kept = self.distribution.kept
        text = ", ".join(f"{equation.name} = 0" for equation, _ in kept)
        nonzero = _rank_drops(self.distribution)
        return Ideal(self.field, [residual for _, residual in kept], text, nonzero=nonzero)

    def rate(self, function: Element) -> Element:
        """The time derivative of a function of state and velocities, or of reactions."""
        followed = self.in_state(followed_rate(self.equations, function))
        return self.value(self._differentiate(self.in_state(function)) + followed)

    def balance(self, function: Element, gain: Element, along: Row) -> Element:
        """The time derivative of a function minus what it gains, in the state alone.

        Args:
            function: Of state and velocities.
            gain: Affine in the reactions.
            along: The vector of the frame whose equation of motion says so, if there is one.
        """
        names = self.distribution.frame.velocities
        direction = {rate_name(n): self.close(x) for n, x in zip(names, along, strict=False)}
        return self.value(self._differentiate(self.in_state(function)) - gain, direction)

    def _differentiate(self, function: Element) -> Element:
        """The time derivative of a function of state and time, in accelerations."""
        own = explicit(self.equations.setting, function)
        names = self.equations.setting.state
        slopes = zip(self.field.gradient(function, names), names, strict=True)
        return own + self.field.sum(s * self.rates[name] for s, name in slopes if s != 0)

    @property
    def written_rates(self) -> dict[str, Element]:
        """The rates in the state, without accelerations."""
        return self.decidable_rates

    def write(self, function: Element) -> Element:
        """A function of the state alone."""
        return self.in_state(function)

    def in_state(self, function: Element) -> Element:
        """A function of the state alone, also where it names reactions."""
        closed = self.close(function)
        rests = self.field.reach(closed) & set(self.equations.kept)
        return self.value(closed) if rests else closed

    def value(self, element: Element, direction: Mapping[str, Element] = NO_DIRECTION) -> Element:
        """An element affine in accelerations and multipliers, in the state alone.

        Args:
            element: In accelerations and multipliers.
            direction: A combination of the equations that may give it, by the names of theirs.
        """
        rest = self.field.substitute(self.close(element), self.resting)
        parts = []
        for block in self.solves:
            slopes = self.field.gradient(rest, block.names)
            if any(slope != 0 for slope in slopes):
                parts.append(self._along(block, slopes, direction))
        unknown = {name: self.field.zero for block in self.solves for name in block.names}
        return self.field.sum([self.field.substitute(rest, unknown), *parts])

    def _along(self, block: Solve, c: Row, direction: Mapping[str, Element]) -> Element:
        """``c . x`` where x solves a block.

        No determinant is needed where ``c = w M``: for the energy w is eta, for the momentum along
        a section of the distribution it is that section, and a unit vector for its basis. Residuals
        of kept constraints are zero: with these the columns of A are ``A eta``.
        """
        field = self.field
        for weights in self._likely_first(block, c, direction):
            turned = (dot(weights, column) for column in zip(*block.matrix, strict=True))
            if all(map(self._vanishes, (x - y for x, y in zip(turned, c, strict=True)))):
                return dot(weights, block.known)
        bordered = (
            *((*row, k) for row, k in zip(block.matrix, block.known, strict=True)),
            (*c, field.zero),
        )
        return -determinant(bordered) / self._determinants[block.names[0]]

    def _vanishes(self, element: Element) -> bool:
        """Whether an element is zero, or a residual of a kept constraint up to its sign."""
        zero = self.field.zero
        spared = (zero, *(sign * each for each in self._residuals for sign in (1, -1)))
        return any(self.field.is_zero(element - each) for each in spared)

    @cached_property
    def _residuals(self) -> list[Element]:
        """The residuals of the kept constraints, in the state."""
        return [self.close(residual) for _, residual in self.kept]

    @cached_property
    def _determinants(self) -> dict[str, Element]:
        """The determinant of every solve, by the name of its first unknown."""
        return {solve.names[0]: determinant(solve.matrix) for solve in self.solves}

    def _likely_first(self, block: Solve, c: Row, direction: Mapping[str, Element]) -> list[Row]:
        """Combinations of the equations of a block, those first that give c modulo a prime."""
        listed = list(self._weights(block, direction))
        try:
            (*columns, sides) = [list(map(self._residue, row)) for row in (*block.matrix, c)]
            weights = [
                [(n, self._residue(w)) for n, w in enumerate(row) if w != 0] for row in listed
            ]
        except ZeroDivisionError:  # a pole, or no square root
            return listed

        def differs(place: int) -> bool:
            pairs = weights[place]
            return any(
                sum(w.value * columns[n][column].value for n, w in pairs) % side.prime != side.value
                for column, side in enumerate(sides)
            )

        return [listed[place] for place in sorted(range(len(listed)), key=differs)]

    def _residue(self, element: Element) -> Residue:
        """The value of an element at a point modulo a prime."""
        return self.field.evaluate(element, self._point, residue, call_modulo)

    @cached_property
    def _point(self) -> dict[str, Residue]:
        """A point modulo a prime, with the values of functions as far as there are some."""
        field = self.field
        at = {name: draw(name) for name in field.names}
        for generator in field.adjoined:
            with suppress(ZeroDivisionError):
                at[generator] = field.evaluate(field[generator], at, residue, call_modulo)
        return at

    def _weights(self, block: Solve, direction: Mapping[str, Element]) -> Iterator[Row]:
        """Combinations of the equations of a block that are worth a trial."""
        one, zero = self.field.one, self.field.zero
        for name in block.names:
            yield tuple(one if name == other else zero for other in block.names)
        for values in (*self._directions, *([direction] if direction else [])):
            yield tuple(values.get(name, zero) for name in block.names)

    @cached_property
    def _directions(self) -> list[dict[str, Element]]:
        """The velocities and the declared sections, by the names of the accelerations."""
        distribution = self.distribution
        sections = (section_components(self.setting, each) for each in self.spec.sections)
        velocities = self.equations.setting.elements(distribution.independent)
        names = list(map(rate_name, distribution.independent))
        return [
            dict(zip(names, map(self.close, values), strict=True))
            for values in (velocities, *sections)
        ]

    @cached_property
    def resting(self) -> dict[str, Element]:
        """What rests on the accelerations, written out in them: other rates and the reactions."""
        solved = {name for solve in self.equations.exact.solves for name in solve.names}
        names = set(self.equations.kept) - solved - self.equations.intermediates
        known: dict[str, Element] = {}
        for name, value in self.equations.exact.definitions:
            if name in names:
                known[name] = self.close(self.field.substitute(value, known))
        return known

    @property
    def solved_velocities(self) -> Sequence[str]:
        """None: velocities are the state, or follow from it in closed form."""
        return ()

    @property
    def determinant(self) -> str:
        """What the determinant of the whole matrix below is called."""
        corner = "A^T" if all(solve.symmetric for solve in self.solves) else "A^T + C"
        return f"|det [[B^T M B, {corner}], [A, 0]]|" if self.kept else "det(B^T M B)"

    @cached_property
    def matrices(self) -> list[tuple[Row, ...]]:
        """The matrices that accelerations are solved with."""
        return [tuple(map(tuple, solve.matrix)) for solve in self.solves]

    @cached_property
    def divergence(self) -> Element:
        """``div X`` in velocities and positions."""
        return self._diverge({})

    def grow(self, powers: Sequence[tuple[Element, Fraction]]) -> Element:
        """As of any motion; what a determinant of a solve adds often cancels entry by entry."""
        own, others = dict[str, Fraction](), list[tuple[Element, Fraction]]()
        for factor, exponent in powers:
            found = (n for n, d in self._determinants.items() if factor in (d, -d))
            if name := next(found, ""):
                own[name] = exponent
            else:
                others.append((factor, exponent))
        growth = [self.rate(factor) / factor * x for factor, x in others]
        return self.field.sum([self._diverge(own), *growth])

    def _diverge(self, powers: Mapping[str, Fraction]) -> Element:
        """``div X + d ln rho/dt`` of powers of determinants, which have the names of solves."""
        field = self.field
        parts = [field.derivative(self.rates[name], name) for name in self.positions]
        for solve in self.solves:
            slopes = self._slopes(solve)
            if power := powers.get(solve.names[0]):
                for (i, j), slope in slopes.items():
                    twice = 2 if solve.symmetric and i != j else 1
                    slopes[i, j] = slope + self.rate(solve.matrix[i][j]) * twice * power
            cofactors = adjugate(solve.matrix)
            total = field.sum(cofactors[j][i] * x for (i, j), x in slopes.items() if x != 0)
            parts.append(total / self._determinants[solve.names[0]])  # Cramer's rule
        return field.sum(parts)

    def _slopes(self, solve: Solve) -> dict[tuple[int, int], Element]:
        """The slopes of the sides of a solve by the velocities of its unknowns, by their places.

        After a symmetric matrix, whose inverse is symmetric, too, they are added in pairs: the
        antisymmetric part, which may be long, does not count in the trace.
        """
        field, slopes = self.field, dict[tuple[int, int], Element]()
        for column, name in enumerate(solve.names):
            velocity = next((v for v in self.fibre if self.rates[v] == field[name]), None)
            for row in range(len(solve.names)):
                place = (min(row, column), max(row, column)) if solve.symmetric else (row, column)
                own = self._slope(solve, row, velocity) if velocity else field.zero  # multipliers
                slopes[place] = slopes.get(place, field.zero) + own
        return slopes

    def _slope(self, solve: Solve, row: int, velocity: str) -> Element:
        """How ``(k - A x)_row`` changes with a velocity at fixed x.

        A depends on velocities where a force is proportional to a reaction, and where the
        Lagrangian is not quadratic in them.
        """
        field = self.field
        slope = field.derivative(solve.known[row], velocity)
        entries = (field.derivative(entry, velocity) for entry in solve.matrix[row])
        pairs = zip(entries, solve.names, strict=True)
        return slope - field.sum(a * self.in_state(field[x]) for a, x in pairs if a != 0)

    @cached_property
    def solves(self) -> Sequence[Solve]:
        """Every solve, in the state alone."""
        return [
            replace(
                solve,
                matrix=tuple(tuple(map(self.close, row)) for row in solve.matrix),
                known=list(map(self.close, solve.known)),
            )
            for solve in self.equations.exact.solves
        ]

    def energy_balance(self) -> Element:
        """``dE/dt`` minus the power of declared forces and of constraints that move."""
        balance = Balance(self.equations)
        power = balance.power + lost(self.equations, balance.energy)
        return self.value(self._differentiate(self.close(balance.energy)) - power)


@once
def motion_of(equations: Equations) -> Motion:
    """The motion of Equations, with constraints or without."""
    return Motion(equations) if equations.distribution is None else ConstrainedRates(equations)


def _rank_drops(distribution: Distribution) -> list[Element]:
    """What is zero where the constraints that are kept depend on each other."""
    products = list_products(distribution)
    rows = [row[n] for n, row in enumerate(products)]
    return [*rows, determinant(products)] if 1 < len(products) <= LARGEST_BLOCK else rows


def list_products(distribution: Distribution) -> tuple[Row, ...]:
    """``A A^T`` of the constraints that are kept, in the velocities of the state."""
    field, rows = distribution.setting.field, [row[:-1] for row in distribution.kept_rows]
    return tuple(
        tuple(field.sum(x * y for x, y in zip(a, b, strict=True)) for b in rows) for a in rows
    )
