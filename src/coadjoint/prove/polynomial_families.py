"""Polynomials in velocities and positions as functions on the points of a motion.

A motion has relations between its variables: constraints, the lengths of vectors, circles of sines
and cosines. Polynomials that agree where these hold are one function. The family knows how many
monomials are independent functions, from below by their values at points modulo a prime and from
above by the multiples of known relations.
Comes in: a motion, and the numbers of its parameters. Goes out: monomials, their values and rates
at points, and elements for combinations of them.
Read next: `coadjoint.prove.candidates`, which looks for integrals among them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import cached_property
from itertools import islice, product
from operator import add

from coadjoint.exact import Element
from coadjoint.exact.ansatz import Exponents, Solution, monomials
from coadjoint.exact.linear import Row, SpanModulo, whole_numbers
from coadjoint.exact.packed import PackedSpan
from coadjoint.exact.rationals import Written
from coadjoint.exact.residues import residue
from coadjoint.prove.densities import measure_of
from coadjoint.prove.motion import Motion
from coadjoint.prove.samples import Point, Samples, Slopes, leading

#: Points beyond as many as there are unknowns.
SPARE = 5
#: Terms of a known integral, and quotients in it, beyond which no common denominator is made.
LONG, QUOTIENTS = 500, 6

#: A polynomial in the generators modulo the prime.
Terms = dict[Exponents, int]
#: The largest sums of exponents of velocities and of positions in a term.
Degrees = tuple[int, int]


class MonomialsAtPoint(dict[Exponents, tuple[int, int]]):
    """Values of monomials at a point and their rates, each made from one of lower degree.

    Args:
        values: Values of the generators.
        rates: Their rates.
        prime: The prime.

    >>> MonomialsAtPoint([2, 3], [1, 0], 97)[(2, 1)]
    (12, 12)
    """

    def __init__(self, values: Sequence[int], rates: Sequence[int], prime: int) -> None:
        super().__init__({(0,) * len(values): (1, 0)})
        self._generators, self._prime = list(zip(values, rates, strict=True)), prime

    def __missing__(self, exponents: Exponents) -> tuple[int, int]:
        place = next(n for n, exponent in enumerate(exponents) if exponent)
        value, rate = self[(*exponents[:place], exponents[place] - 1, *exponents[place + 1 :])]
        x, slope = self._generators[place]
        self[exponents] = value * x % self._prime, (rate * x + value * slope) % self._prime
        return self[exponents]


class PolynomialFamily:
    """The polynomials in the velocities and positions of one motion.

    Args:
        motion: The motion.
        others: Other functions that will be evaluated.
        parameters: Numbers for the parameters; by default they are random.

    Attributes:
        drawn: The points that were asked for.
    """

    def __init__(
        self,
        motion: Motion,
        others: Iterable[Element] = (),
        parameters: Mapping[str, Fraction] | None = None,
    ) -> None:
        self.motion, self.field = motion, motion.field
        self.samples = Samples(motion, parameters, others)
        self._source = self.samples.points()
        self.drawn: list[Point] = []
        self._tables: list[MonomialsAtPoint] = []
        self._places: dict[tuple[Exponents, ...], list[int]] = {}

    @cached_property
    def velocities(self) -> tuple[str, ...]:
        """The velocities or momenta of the state."""
        return self.motion.fibre

    @cached_property
    def positions(self) -> tuple[str, ...]:
        """Positions, and functions of such in their place."""
        functions = [
            known
            for known in self.samples.functions.known
            if known.function != "sqrt"
            and self.field.reach(self.field[known.generator]) & set(self.motion.positions)
        ]
        called = (self.field[known.generator] for known in functions)
        inside = {name for each in called for name in self.field.reach(each)}
        moved = set(self.samples.state) - inside - set(self.velocities)
        plain = [name for name in self.motion.positions if name in moved]
        return (*plain, *(known.generator for known in functions))

    def monomials(self, degrees: Degrees) -> list[Exponents]:
        """Those up to two degrees, the low ones first."""
        names = self.velocities, self.positions
        parts = (monomials(len(each), degree) for each, degree in zip(names, degrees, strict=True))
        return sorted((a + b for a, b in product(*parts)), key=lambda e: (sum(e), e))

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The generators, of which monomials are products."""
        return (*self.velocities, *self.positions)

    @cached_property
    def generators(self) -> tuple[Element, ...]:
        """What monomials are products of."""
        return tuple(map(self.field.__getitem__, self.names))

    def points(self, count: int) -> list[Point]:
        """The first points, more as they are asked for."""
        self.drawn += islice(self._source, max(count - len(self.drawn), 0))
        return self.drawn[:count]

    @cached_property
    def _slopes(self) -> list[Slopes]:
        return [self.samples.slopes(generator) for generator in self.generators]

    def tables(self, count: int) -> list[MonomialsAtPoint]:
        """Values of monomials, and their rates, at more points than there are monomials."""
        for point in self.points(count + SPARE)[len(self._tables) :]:
            x = [point.value(generator) for generator in self.generators]
            rates = [point.differentiate(slopes) for slopes in self._slopes]
            self._tables.append(MonomialsAtPoint(x, rates, self.samples.prime))
        return self._tables[: count + SPARE]

    def independent_places(self, members: Sequence[Exponents]) -> list[int]:
        """Places of monomials that are independent as functions; of all others, points say no."""
        key = tuple(members)
        if key not in self._places:
            rows = ([table[e][0] for e in members] for table in self.tables(len(members)))
            span = PackedSpan(self.samples.prime, len(members), rows)
            self._places[key] = sorted(span.pivots)
        return self._places[key]

    def count_relations(self, members: Sequence[Exponents], degrees: Degrees) -> int:
        """How many independent relations between monomials are multiples of known ones."""
        place = {exponents: n for n, exponents in enumerate(members)}
        rows = list[Row]()
        for terms in self._relations:
            for shift in self.monomials(degrees):
                moved = {tuple(map(add, e, shift)): x for e, x in terms.items()}
                if moved.keys() <= place.keys():
                    rows.append({place[e]: x for e, x in moved.items()})
        return SpanModulo(self.samples.prime, rows).rank

    @cached_property
    def _relations(self) -> list[Terms]:
        """What is zero at all points: constraints, lengths, and sines and cosines on a circle."""
        circles = [
            self.field[known.generator] ** 2 + self.field[known.partner] ** 2 - 1
            for known in self.samples.functions.known
            if known.function == "sin" and known.generator in self.positions
        ]
        zero = [*self.samples.where.relations, *self._solved, *circles]
        return [terms for terms in map(self._terms, filter(self._holds, zero)) if terms]

    @property
    def _solved(self) -> list[Element]:
        """The kept constraints solved for velocities: what is a common factor of them is gone."""
        allowed = measure_of(self.motion).allowed.items()
        return [self.field.normal(self.field[name] - root) for name, root in allowed]

    def _holds(self, relation: Element) -> bool:
        """Whether a relation holds at points; what does not, or has a pole, is certainly none."""
        with suppress(ZeroDivisionError):
            return not any(point.value(relation) for point in self.points(SPARE))
        return False

    def _terms(self, element: Element) -> Terms | None:
        """The numerator as a polynomial in the generators; None where it is none."""
        names, state = self.names, set(self.samples.state)
        (point,), prime = self.points(1), self.samples.prime
        terms = Terms()
        for quotient in self.field.quotients(element.combine()):
            for monomial in quotient.monomials:
                powers, value = dict(monomial.powers), residue(monomial.number, prime).value
                exponents = tuple(powers.pop(name, 0) for name in names)
                for name, exponent in powers.items():
                    if self.field.reach(self.field[name]) & state:
                        return None
                    value = value * pow(point.value(self.field[name]), exponent, prime) % prime
                terms[exponents] = (terms.get(exponents, 0) + value) % prime
        return {exponents: value for exponents, value in terms.items() if value}

    def degrees_of(self, function: Element) -> Degrees | None:
        """The degrees of a polynomial, reduced by the relations; None for other functions.

        Of a long one the largest degree of an addend, which is enough: too high a degree leaves
        products out.
        """
        state = set(self.samples.state)
        written = self.field.quotients(function)
        is_long = len(written) > QUOTIENTS or sum(len(q.monomials) for q in written) > LONG
        whole = function if is_long else self.field.normal(function).combine()
        quotients = self.field.quotients(whole)
        if any(self.field.reach(d) & state for q in quotients for d, _ in q.divisors):
            return None
        if is_long:
            return self._largest(quotients)
        forms = [self._terms(whole), self._terms(self.samples.where.remainder(whole))]
        return min(
            (_sums(terms, len(self.velocities)) for terms in forms if terms is not None),
            default=None,
        )

    def _largest(self, quotients: Sequence[Written]) -> Degrees | None:
        """The largest degrees of the addends of a function without functions of the state."""
        names, exponents = (*self.velocities, *self.positions), list[Exponents]()
        state = set(self.samples.state)
        for powers in (dict(m.powers) for q in quotients for m in q.monomials):
            exponents.append(tuple(powers.pop(name, 0) for name in names))
            if any(self.field.reach(self.field[name]) & state for name in powers):
                return None
        return _sums(exponents, len(self.velocities))

    def gradient(self, function: Solution[Exponents]) -> Row:
        """Slopes by the state of a combination of monomials, at the first point."""
        slopes = dict.fromkeys(self.samples.state, 0)
        for partials, outer in self._partials:
            rate = sum(number * partials[e][1] for e, number in function.numbers.items())
            for name, inner in outer:
                slopes[name] += rate * inner
        return dict(enumerate(slopes.values()))

    @cached_property
    def _partials(self) -> list[tuple[MonomialsAtPoint, list[tuple[str, int]]]]:
        """Derivatives of monomials by each generator, and its slopes, at the first point."""
        (point,), prime = self.points(1), self.samples.prime
        x = [point.value(generator) for generator in self.generators]
        return [
            (
                MonomialsAtPoint(x, [int(n == place) for n in range(len(x))], prime),
                [(name, point.value(inner)) for name, inner in slopes],
            )
            for place, slopes in enumerate(self._slopes)
        ]

    def write(self, numbers: Mapping[Exponents, Fraction]) -> Element:
        """A combination of monomials, scaled to whole coefficients without common factor."""
        whole = self.field.polynomial(self.names, whole_numbers(numbers))
        return -whole if leading(whole) < 0 else whole


def _sums(terms: Iterable[Exponents], count: int) -> Degrees:
    """The largest degrees in the first generators and in the others."""
    sums = [(sum(e[:count]), sum(e[count:])) for e in terms] or [(0, 0)]
    return max(a for a, _ in sums), max(b for _, b in sums)
