r"""Random points of a motion modulo a prime, and the motion there.

Comes in: a motion. Goes out: points at which its constraints hold and its
unit vectors are of length one, with the values of any function and of its rate.

A point is a homomorphism from the functions of the motion to the integers modulo the prime: what is
zero on the constraints is zero there. It is one of a rational parametrization: velocities solve the
constraints, whose rank is full there, unit vectors come by stereographic projection, and elementary
functions satisfy all relations between them (`coadjoint.prove.functions`), or there is no point.
So a rank of values at points never exceeds the true one. The accelerations are those that the
kernel computes, definition by definition. Parameters, and functions of parameters alone, have one
value in all points. They are random unless numbers are given: then a rank bounds that for almost
all of their values, since a minor that is not zero for some is zero for almost none.
Read next: `coadjoint.prove.candidates`, `coadjoint.prove.measures`.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from fractions import Fraction
from functools import cached_property
from itertools import islice

from coadjoint.derive.setting import once
from coadjoint.exact import Element, Field
from coadjoint.exact.linear import PRIME, echelon_modulo, primes
from coadjoint.exact.residues import Residue, residue
from coadjoint.prove.functions import Experiment, Functions, FunctionsAtPoint
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.motion import Motion
from coadjoint.spec import Variable

#: Why there are no points where no prime has all that is needed.
NOWHERE = "no point has all square roots modulo a prime"
#: Values by name.
Values = dict[str, Residue]
#: Primes that are tried, each with other parameters: so many times 2^n for n square roots, which
#: all exist in one of 2^n cases, and the most of them.
PRIMES, MOST = 40, 4000
#: Numbers below which none of the primes divides any.
SMALL = 10**12
#: Choices of numbers for the parameters, until all square roots of such exist.
SEEDS = 20
#: How often a next point is tried.
TRIES = 2000
#: The derivatives of a function that are not zero, by the names of the state.
Slopes = list[tuple[str, Element]]


class Point(dict[str, int]):
    """One point with the motion there: residues of all symbols, and of functions once called.

    Args:
        samples: Where it comes from.
        values: Parameters, state and all that the accelerations need.
        call: Values of the elementary functions.
    """

    def __init__(self, samples: Samples, values: Values, call: FunctionsAtPoint) -> None:
        super().__init__({name: x.value for name, x in values.items()})
        self.samples, self.call = samples, call
        self._inverses = dict[int, int]()

    def __missing__(self, generator: str) -> int:
        """The value of a function by its generator."""
        known = self.samples.field.adjoined[generator]
        argument = Residue(self.value(known.argument), self.samples.prime)
        self[generator] = self.call(known.function, argument).value
        return self[generator]

    def value(self, element: Element) -> int:
        """The value of a function of the symbols."""
        samples = self.samples
        return samples.field.evaluate_modulo(element, self, samples.prime, self._inverses)

    def differentiate(self, slopes: Slopes) -> int:
        """``dF/dt`` of a function of the state, from its slopes."""
        total = sum(self.value(s) * self.velocity[name] for name, s in slopes)
        return total % self.samples.prime

    @cached_property
    def velocity(self) -> dict[str, int]:
        """``dx/dt`` of the state."""
        equations = self.samples.motion.equations
        pairs = zip(self.samples.state, equations.exact.rates, strict=True)
        return {name: self.value(rate) for name, rate in pairs}


class Samples:
    """Points of a motion modulo a prime, the same in every run.

    Args:
        motion: The motion.
        parameters: Values of the parameters; by default random ones, the same at all points.
        others: Other functions that will be evaluated at the points.

    Attributes:
        prime: The prime; another than `PRIME` where that has not the square roots of some numbers.
    """

    def __init__(
        self,
        motion: Motion,
        parameters: Mapping[str, Fraction] | None = None,
        others: Iterable[Element] = (),
    ) -> None:
        self.motion, self.field = motion, motion.field
        self.state = motion.setting.state
        self.moving = (*self.state, *motion.setting.driving)
        self.prime, self._source = PRIME, random.Random(3)  # noqa: S311 (not for secrets)
        self._given, self._others = parameters, tuple(others)
        self._parameters = Values()

    def points(self) -> Iterator[Point]:
        """Points, as many as are asked for; none where there is an obstacle.

        Poles, and points without the square roots, are passed over.
        """
        while not self.obstacle:
            point = self._next()
            if point is None:
                return
            yield point

    def _next(self) -> Point | None:
        for _ in range(TRIES):
            with suppress(ZeroDivisionError):
                return self._point()
        return None

    @cached_property
    def first(self) -> Point | None:
        """The first point; None where there is none."""
        return next(self.points(), None)

    @cached_property
    def functions(self) -> Functions:
        """The elementary functions of the motion, with what is known of relations between them."""
        parameters = self.motion.equations.setting.parameters
        return Functions(self.field, self._evaluated, self.moving, parameters, self._given or {})

    @cached_property
    def _evaluated(self) -> list[Element]:
        """All that points are made for."""
        equations = self.motion.equations
        solved = [e for s in equations.exact.solves for row in (*s.matrix, s.known) for e in row]
        return [
            *equations.exact.rates,
            *(value for _, value in self._needed),
            *(entry for row in self._kept for entry in row),
            *self.where.relations,
            *solved,
            *self._others,
        ]

    @cached_property
    def _long_numbers(self) -> set[int]:
        """Numerators and denominators that a prime might divide."""
        return _long_numbers(self.field, self._evaluated, (self._given or {}).values())

    def serves(self, others: Iterable[Element]) -> bool:
        """Whether the points serve functions that they were not made for."""
        elements = list(others)
        plain = all(map(self.field.is_function_free, elements))
        return plain and not _long_numbers(self.field, elements)

    @cached_property
    def obstacle(self) -> str:
        """Why there are no points; else empty.

        Primes and parameters are tried until a point has all square roots, and until each of these
        has once been missing where those before it were there: so it is none of their combinations.
        """
        if self.functions.obstacle:
            return self.functions.obstacle
        reached = False
        count = min(PRIMES << len(self.functions.roots) + len(self.functions.surds), MOST)
        for prime in islice(primes(), count):
            if any(number % prime == 0 for number in self._long_numbers):
                continue
            with suppress(ZeroDivisionError):
                self.prime = prime
                self._experiment = Experiment(self.functions, prime, self._source)
                self._parameters = self._choice()
                self._point()
                reached = True
                if self.functions.proper == self.functions.roots:
                    return ""
        return "square roots occur that may be made of each other" if reached else NOWHERE

    def _choice(self) -> Values:
        """The parameters: as given, or random."""
        if self._given is not None:
            return {name: residue(value, self.prime) for name, value in self._given.items()}
        names = self.motion.equations.setting.parameters
        return {name: self._experiment.draw() for name in names}

    @cached_property
    def unit(self) -> tuple[Variable, ...]:
        """The advected vectors that begin with the length 1, and keep it."""
        return tuple(
            each
            for each in self.motion.equations.spec.having_role("advected")
            if each.default is not None
            and sum(x**2 for x in each.default) == 1
            and self.field.is_zero(self.motion.rate(self.square(each)))
        )

    def square(self, variable: Variable) -> Element:
        """The square of the length of a vector."""
        return self.field.sum(self.field[name] ** 2 for name in variable.components)

    @cached_property
    def where(self) -> Ideal:
        """The relations that hold at the points: kept constraints and the lengths of vectors.

        With the numbers of the parameters, where these are given.
        """
        kept = self.motion.where
        lengths = [self.square(each) - 1 for each in self.unit]
        texts = [f"dot({each.name}, {each.name}) = 1" for each in self.unit]
        text = ", ".join(filter(None, (kept.text, *texts)))
        if not self._given:
            return kept.also(lengths, text)
        numbers = {name: self.field.number(value) for name, value in self._given.items()}
        relations, nonzero = (
            [self.field.substitute(each, numbers) for each in elements]
            for elements in (kept.relations, kept.nonzero)
        )
        return Ideal(self.field, [*relations, *lengths], text, nonzero=nonzero)

    def slopes(self, function: Element) -> Slopes:
        """The derivatives of a function by the state."""
        pairs = zip(self.state, self.field.gradient(function, self.state), strict=True)
        return [(name, slope) for name, slope in pairs if slope != 0]

    def _draw(self) -> Residue:
        return self._experiment.draw()

    def _point(self) -> Point:
        """One point.

        Raises:
            ZeroDivisionError: It is a pole, or a square root is missing there.
        """
        values = self._parameters | {name: self._draw() for name in self.moving}
        for variable in self.unit:
            values |= dict(zip(variable.components, self._on_sphere(variable), strict=True))
        velocities = self.motion.fibre
        call = FunctionsAtPoint(self._experiment)
        call.learn({name: x for name, x in values.items() if name not in velocities})
        point = Point(self, values, call)
        allowed = self._allow(point) | self._transform(point)
        point.update({name: x.value for name, x in allowed.items()})
        call.learn(values | allowed)
        loops = self.motion.equations.loops
        for name, definition in self._needed:
            for symbol in self.field.names_in(definition) & loops.keys() - point.keys():
                given = loops[symbol].run_loop(
                    symbol, lambda e: Residue(point.value(e), self.prime)
                )
                point.update({each: x.value for each, x in given.items()})
            point[name] = point.value(definition)
        return point

    def _transform(self, point: Point) -> Values:
        """Velocities that iterations find, and the momenta that these have."""
        setting, found = self.motion.setting, Values()
        for newton in self.motion.equations.iterations:
            for place, guess in zip(newton.block, newton.names, strict=True):
                found[guess] = found[setting.conjugates[place][0]] = self._draw()
                point[guess] = found[guess].value
            for place, slope in zip(newton.block, newton.slopes, strict=True):
                _, mu, weight = setting.conjugates[place]
                found[mu] = Residue(point.value(slope * weight), self.prime)
        return found

    def _on_sphere(self, variable: Variable) -> list[Residue]:
        """A point of the unit sphere, by stereographic projection."""
        flat = [self._draw() for _ in variable.components[1:]]
        if not flat:  # 1 or -1
            return [residue(x, self.prime) for x in variable.default or ()]
        one, square = Residue(1, self.prime), Residue(0, self.prime)
        for x in flat:
            square += x * x
        below = square + one
        return [(square + -one) / below, *((x + x) / below for x in flat)]

    def _allow(self, point: Point) -> Values:
        """Velocities that the kept constraints allow: some of them, from the others.

        Raises:
            ZeroDivisionError: The rank of the constraints drops here, and velocities would be free
                that are not so elsewhere.
        """
        names = self.motion.fibre
        rows = [
            {n: v for n, entry in enumerate(row) if (v := point.value(entry))} for row in self._kept
        ]
        solved = echelon_modulo(rows, self.prime)
        if len(solved) < len(rows) or len(names) in solved:
            raise ZeroDivisionError("the constraints depend on each other here")
        values = {}
        for pivot, row in solved.items():
            others = (
                value * (point[names[n]] if n < len(names) else 1)
                for n, value in row.items()
                if n != pivot
            )
            values[names[pivot]] = Residue(-sum(others) % self.prime, self.prime)
        return values

    @cached_property
    def _kept(self) -> list[tuple[Element, ...]]:
        return self.motion.kept_rows

    @cached_property
    def _needed(self) -> list[tuple[str, Element]]:
        """The definitions on which the rates rest, in order."""
        equations = self.motion.equations
        return equations.definitions_of(equations.exact.rates)


def _long_numbers(
    field: Field, elements: Iterable[Element], others: Iterable[Fraction] = ()
) -> set[int]:
    """Numerators and denominators in elements, and of other numbers, that a prime might divide."""
    written = [q for element in elements for q in field.quotients(element)]
    divisors = [d for quotient in written for d, _ in quotient.divisors]
    written += [q for divisor in divisors for q in field.quotients(divisor)]
    numbers = {m.number for quotient in written for m in quotient.monomials} | {*others}
    parts = {abs(part) for x in numbers for part in (x.numerator, x.denominator)}
    return {part for part in parts if part >= SMALL}


@once
def samples_of(motion: Motion) -> Samples:
    """The points of a motion at random parameters, made for its equations alone."""
    return Samples(motion)


def leading(element: Element) -> Fraction:
    """The leading coefficient of the numerator, by whose sign functions are written down."""
    return Fraction(str(element.combine().parts[0].numer.LC))


def random_numbers(motion: Motion) -> dict[str, Fraction]:
    """Numbers for the parameters, without relations among them; the square roots exist."""
    for seed in range(SEEDS):
        source = random.Random(seed)  # noqa: S311 (not for secrets)
        names = motion.equations.setting.parameters
        numbers = {name: Fraction(source.randint(2, 999), 7) for name in names}
        if not Samples(motion, numbers).obstacle:
            break
    return numbers
