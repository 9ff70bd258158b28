r"""Random points of a constrained motion modulo a prime, and the motion there.

Comes in: the rates of a constrained motion. Goes out: points at which its constraints hold and its
unit vectors are of length one, with the values of any function and of its rate. What is an identity
over the rationals is one modulo the prime, so a rank there never exceeds the true one; it falls
short with a chance of about 1e-17 (`coadjoint.poisson.ranks`). The accelerations are those that the
kernel computes, definition by definition. Parameters are random as well unless numbers are given:
what is found then holds for almost all of their values.
Read next: `coadjoint.prove.candidates`, `coadjoint.prove.measures`.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property

from coadjoint.algebra.linear import PRIME, echelon_modulo
from coadjoint.derive.kinematics import kept_rows
from coadjoint.exact import Element
from coadjoint.poisson.ranks import Residue, residue, residue_call
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.ideals import Ideal
from coadjoint.spec import Variable

#: Values by name.
Values = dict[str, Residue]
#: How often a first point is tried.
TRIES = 200
#: The derivatives of a function that are not zero, by the names of the state.
Slopes = list[tuple[str, Element]]


@dataclass
class Point:
    """One point with the motion there.

    Attributes:
        samples: Where it comes from.
        values: Residues of parameters, state and all that the accelerations need.
        call: Values of the elementary functions.
    """

    samples: Samples
    values: Values
    call: Callable[[str, Residue], Residue]
    factors: dict[int, Residue] = field(default_factory=dict)

    def value(self, element: Element) -> int:
        """The value of a function."""
        ring = self.samples.field
        return ring.evaluate(element, self.values, residue, self.call, self.factors).value

    def moved(self, slopes: Slopes) -> int:
        """``dF/dt`` of a function of the state, from its slopes."""
        return sum(self.value(s) * self.velocity[name] for name, s in slopes) % PRIME

    @cached_property
    def velocity(self) -> dict[str, int]:
        """``dx/dt`` of the state."""
        equations = self.samples.motion.equations
        pairs = zip(self.samples.state, equations.exact.rates, strict=True)
        return {name: self.value(rate) for name, rate in pairs}


class Samples:
    """Points of a constrained motion modulo `PRIME`, the same in every run.

    Args:
        motion: The motion.
        parameters: Values of the parameters; by default random ones, the same at all points.
    """

    def __init__(
        self, motion: ConstrainedRates, parameters: Mapping[str, Fraction] | None = None
    ) -> None:
        self.motion, self.field = motion, motion.field
        self.state = motion.equations.setting.state
        self._source = random.Random(3)  # noqa: S311 (not for secrets)
        self._given = parameters
        self._parameters = self._choice()

    def points(self) -> Iterator[Point]:
        """Endless points, but none beside an obstacle.

        Poles, and points without the square roots, are passed over.
        """
        while not self.obstacle:
            with suppress(ZeroDivisionError):
                yield self._point()

    @cached_property
    def obstacle(self) -> str:
        """Why there are no points; else empty.

        Functions of one argument, or of a symbol each, take values that no algebra relates; sines
        of x, y and x + y do not.
        """
        needed = [*self.motion.equations.exact.rates, *(value for _, value in self._needed)]
        names = sorted(frozenset[str]().union(*map(self.field.functions_in, needed)))
        called = [self.field.adjoined[name] for name in names]
        arguments = list[Element]()
        for known in called:
            if known.function != "sqrt" and known.argument not in arguments:
                arguments.append(known.argument)
        symbols = [self.field[name] for name in self.field.names]
        if len(arguments) > 1 and not all(argument in symbols for argument in arguments):
            return f"functions of {len(arguments)} arguments occur, which may be related"
        for _ in range(TRIES):  # a square root of parameters alone is there at all points or none
            with suppress(ZeroDivisionError):
                self._point()
                return ""
            self._parameters = self._choice()
        return "no point has all square roots modulo a prime"

    def _choice(self) -> Values:
        """The parameters: as given, or random."""
        if self._given is not None:
            return {name: residue(value) for name, value in self._given.items()}
        return {name: self._draw() for name in self.motion.equations.setting.parameters}

    @cached_property
    def unit(self) -> tuple[Variable, ...]:
        """The advected vectors that begin with the length 1, and keep it."""
        return tuple(
            each
            for each in self.motion.equations.spec.having_role("advected")
            if each.default is not None
            and sum(x**2 for x in each.default) == 1
            and self.field.is_zero(self.motion.rate(self.squared(each)))
        )

    def squared(self, variable: Variable) -> Element:
        """The square of the length of a vector."""
        return self.field.sum(self.field[name] ** 2 for name in variable.components)

    @cached_property
    def where(self) -> Ideal:
        """The relations that hold at the points: kept constraints and the lengths of vectors.

        With the numbers of the parameters, where these are given.
        """
        kept = self.motion.where
        numbers = {name: self.field.number(value) for name, value in (self._given or {}).items()}
        relations = [self.field.substitute(each, numbers) for each in kept.relations]
        lengths = [self.squared(each) - 1 for each in self.unit]
        texts = [f"dot({each.name}, {each.name}) = 1" for each in self.unit]
        text = ", ".join(filter(None, (kept.text, *texts)))
        return Ideal(self.field, [*relations, *lengths], text)

    def slopes(self, function: Element) -> Slopes:
        """The derivatives of a function by the state."""
        pairs = zip(self.state, self.field.gradient(function, self.state), strict=True)
        return [(name, slope) for name, slope in pairs if slope != 0]

    def _draw(self) -> Residue:
        return Residue(self._source.randrange(1, PRIME))

    def _point(self) -> Point:
        values = self._parameters | {name: self._draw() for name in self.state}
        for variable in self.unit:
            values |= dict(zip(variable.components, self._on_sphere(variable), strict=True))
        point = Point(self, values, self._functions())
        values |= self._allowed(point)
        for name, definition in self._needed:
            values[name] = Residue(point.value(definition))
        return point

    def _on_sphere(self, variable: Variable) -> list[Residue]:
        """A point of the unit sphere, by stereographic projection."""
        flat = [self._draw() for _ in variable.components[1:]]
        square = residue(0)
        for x in flat:
            square += x * x
        below = square + residue(1)
        return [(square + residue(-1)) / below, *((x + x) / below for x in flat)]

    def _functions(self) -> Callable[[str, Residue], Residue]:
        """Functions of symbols at random values: those of one symbol are independent of it."""
        known: dict[tuple[str, int], Residue] = {}

        def call(function: str, argument: Residue) -> Residue:
            if function == "sqrt":
                return residue_call(function, argument)
            at = argument.value
            if (function, at) not in known:
                known["cos", at], known["sin", at] = self._on_circle()
                known["exp", at], known["log", at] = self._draw(), self._draw()
            return known[function, at]

        return call

    def _on_circle(self) -> tuple[Residue, Residue]:
        t, one = self._draw(), residue(1)
        below = one + t * t
        return (one + -(t * t)) / below, (t + t) / below

    def _allowed(self, point: Point) -> Values:
        """Velocities that the kept constraints allow: some of them, from the others."""
        names = self.motion.distribution.independent
        rows = [
            {n: v for n, entry in enumerate(row) if (v := point.value(entry))} for row in self._kept
        ]
        found = {}
        for pivot, row in echelon_modulo(rows).items():
            if pivot == len(names):
                raise ZeroDivisionError("the constraints contradict each other here")
            others = (
                value * (point.values[names[n]].value if n < len(names) else 1)
                for n, value in row.items()
                if n != pivot
            )
            found[names[pivot]] = Residue(-sum(others) % PRIME)
        return found

    @cached_property
    def _kept(self) -> list[tuple[Element, ...]]:
        return kept_rows(self.motion.distribution)

    @cached_property
    def _needed(self) -> list[tuple[str, Element]]:
        """The definitions on which the rates rest, in order."""
        equations = self.motion.equations
        return equations.definitions_of(equations.exact.rates)


class AtNumbers(ConstrainedRates):
    """The rates of a motion at given parameters, which are much shorter.

    Args:
        motion: The motion.
        numbers: Values of all parameters.
    """

    def __init__(self, motion: ConstrainedRates, numbers: Mapping[str, Fraction]) -> None:
        super().__init__(motion.equations)
        self._numbers = {name: self.field.number(x) for name, x in numbers.items()}

    def closed(self, element: Element) -> Element:
        """An element without parameters."""
        return self.field.substitute(super().closed(element), self._numbers)


def leading(element: Element) -> Fraction:
    """The leading coefficient of the numerator, by whose sign functions are written down."""
    return Fraction(str(element.combined().parts[0].numer.LC))
