r"""Integrals of a constrained motion up to a degree: all of them, by an exact linear solve.

A function F that is a polynomial of the velocities and of the positions has unknown numbers as
coefficients; ``dF/dt = 0`` at random points modulo a prime is linear in them. A rank modulo a prime
never exceeds the true one, so that there are no more integrals than solutions is a proof, and one
for almost all parameters, since these are random as well. Functions that agree where the
constraints hold, and where vectors have the length 1, count as one. Where the motion may run
backwards, even and odd parts of an integral in the velocities are integrals, and looked for apart.

What is not made of known integrals is written out with the numbers that the parameters have by
default, lowest degrees first, and proved by its rate there. So Jellett's and Routh's integrals of a
ball of revolution are found (Routh 1884; Holm 2011, section 12.2.1).
Comes in: the rates of a constrained motion. Goes out: what is known, what was found, as claims.
Read next: `coadjoint.prove.measures`, which asks for a volume instead.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, partial
from itertools import combinations_with_replacement, islice
from math import gcd, lcm, prod
from operator import mul

from coadjoint.algebra.linear import (
    PRIME,
    Row,
    echelon_modulo,
    nullspace_modulo,
    rational_vector,
)
from coadjoint.derive.interpret import Quantity
from coadjoint.exact import Element
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.completeness import described
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.reversibility import reversal_defects
from coadjoint.prove.samples import AtNumbers, Point, Samples, Slopes, leading
from coadjoint.prove.zero import Decision, Examined, decide_zero
from coadjoint.spec import Spec

#: Degrees in the velocities and in the positions up to which integrals are looked for: those of
#: Jellett and Routh have the degrees (1, 1) and (2, 2).
DEGREES = (2, 2)
#: Monomials among which integrals are looked for; 200 take about a second.
MONOMIALS = 200
#: Points beyond as many as there are unknowns.
SPARE = 5
#: Degrees in the order in which new integrals are looked for, so that generators come first.
STEPS = ((1, 0), (1, 1), (2, 1), (2, 2))

#: Exponents of the generators.
Exponents = tuple[int, ...]


@dataclass(frozen=True)
class Known:
    """An integral by its name or its formula.

    Attributes:
        text: As statements show it.
        parts: Its components, in the state.
    """

    text: str
    parts: tuple[Element, ...]


class CandidateSearch:
    """The search for integrals of one motion.

    Args:
        motion: The motion.
        known: Integrals that are known.
        parameters: Numbers for the parameters; by default they are random.
    """

    def __init__(
        self,
        motion: ConstrainedRates,
        known: Sequence[Known] = (),
        parameters: Mapping[str, Fraction] | None = None,
    ) -> None:
        self.motion, self.field, self.known = motion, motion.field, tuple(known)
        self.samples = Samples(motion, parameters)
        self._source = self.samples.points()
        self._points: list[Point] = []
        self.values_at: list[tuple[list[int], list[int]]] = []  # of the generators, and their rates

    # -- the ansatz -----------------------------------------------------------------------

    @cached_property
    def velocities(self) -> tuple[str, ...]:
        """The independent velocities."""
        return self.motion.distribution.independent

    @cached_property
    def positions(self) -> tuple[str, ...]:
        """Positions, and functions of such in their place."""
        functions = [
            known
            for known in self.field.adjoined.values()
            if known.function != "sqrt"
            and self.field.reach(known.argument) & set(self.motion.distribution.frame.positions)
        ]
        inside = {name for known in functions for name in self.field.reach(known.argument)}
        moved = set(self.samples.state) - inside - set(self.velocities)
        plain = [name for name in self.motion.distribution.frame.positions if name in moved]
        return (*plain, *(known.generator for known in functions))

    def monomials(self, degrees: tuple[int, int]) -> list[Exponents]:
        """Those up to two degrees, the low ones first."""
        parts = [
            [
                tuple(factors.count(i) for i in range(len(names)))
                for d in range(degree + 1)
                for factors in combinations_with_replacement(range(len(names)), d)
            ]
            for names, degree in zip((self.velocities, self.positions), degrees, strict=True)
        ]
        return sorted(((*a, *b) for a in parts[0] for b in parts[1]), key=lambda e: (sum(e), e))

    @cached_property
    def generators(self) -> tuple[Element, ...]:
        """What monomials are products of."""
        return tuple(self.field[name] for name in (*self.velocities, *self.positions))

    @cached_property
    def reversible(self) -> bool:
        """Whether the motion runs back when its velocities are turned round."""
        defects = reversal_defects(self.motion)
        return all(map(self.field.is_zero, defects.values()))

    def sectors(self, degrees: tuple[int, int]) -> list[list[Exponents]]:
        """Monomials that an integral can have together."""
        whole, count = self.monomials(degrees), len(self.velocities)
        if not self.reversible:
            return [whole]
        return [[e for e in whole if sum(e[:count]) % 2 == parity] for parity in (0, 1)]

    # -- values ---------------------------------------------------------------------------

    def points(self, count: int) -> list[Point]:
        """The first points, more as they are asked for."""
        for point in islice(self._source, max(count - len(self._points), 0)):
            self._points.append(point)
            x = [point.value(generator) for generator in self.generators]
            self.values_at.append((x, [point.moved(slopes) for slopes in self._slopes]))
        return self._points[:count]

    @cached_property
    def _slopes(self) -> list[Slopes]:
        return [self.samples.slopes(generator) for generator in self.generators]

    def integrals(self, monomials: Sequence[Exponents]) -> list[Row]:
        """A basis of the integrals among combinations of monomials, by their places."""
        count = len(self.points(len(monomials) + SPARE))
        tables = [_table(*values, monomials) for values in self.values_at[:count]]
        basis = sorted(echelon_modulo(dict(enumerate(values)) for values, _ in tables))
        rows = [{n: rates[place] for n, place in enumerate(basis)} for _, rates in tables]
        return [
            {basis[n]: value for n, value in vector.items()}
            for vector in nullspace_modulo(rows, len(basis))
        ]

    def found(self, degrees: tuple[int, int]) -> list[tuple[Sequence[Exponents], Row]]:
        """A basis of the integrals up to some degrees, each as monomials and coefficients."""
        return [
            (monomials, vector)
            for monomials in self.sectors(degrees)
            for vector in self.integrals(monomials)
        ]

    # -- what is new ----------------------------------------------------------------------

    def independent(self, found: Sequence[tuple[Sequence[Exponents], Row]]) -> list[int]:
        """Places of the integrals that are no functions of those before them and of known ones.

        Slopes at a random point tell, together with those of the relations that hold there.
        """
        (point,), state = self.points(1), self.samples.state
        parts = [part for known in self.known for part in known.parts]
        span = [
            [point.value(slope) for slope in self.field.gradient(part, state)]
            for part in (*self.samples.where.relations, *parts)
        ]
        rank, places = _rank(span), []
        for place, (monomials, vector) in enumerate(found):
            slopes = self._gradient(point, monomials, vector)
            if _rank([*span, slopes]) > rank:
                span, rank = [*span, slopes], rank + 1
                places.append(place)
        return places

    def _gradient(self, point: Point, monomials: Sequence[Exponents], vector: Row) -> list[int]:
        """Slopes by the state of a combination of monomials."""
        x, used = self.values_at[0][0], [monomials[n] for n in vector]
        slopes = dict.fromkeys(self.samples.state, 0)
        for place, outer in enumerate(self._slopes):
            along = [int(n == place) for n in range(len(x))]
            rate = sum(map(mul, vector.values(), _table(x, along, used)[1]))
            for name, inner in outer:
                slopes[name] += rate * point.value(inner)
        return [value % PRIME for value in slopes.values()]

    def new(self, degrees: tuple[int, int]) -> Iterator[Element]:
        """Integrals that are no functions of known ones, low degrees first, by numbers.

        They are known from then on; coefficients that are no small fractions are passed over.
        """
        for lower in (d for d in STEPS if d[0] <= degrees[0] and d[1] <= degrees[1]):
            found = self.found(lower)
            for place in self.independent(found):
                monomials, vector = found[place]
                numbers = rational_vector(vector)
                if numbers is not None:
                    element = self._function(monomials, numbers)
                    self.known = (*self.known, Known("", (element,)))
                    yield element

    def _function(self, monomials: Sequence[Exponents], numbers: Mapping[int, Fraction]) -> Element:
        """A combination of monomials, scaled to whole coefficients without common factor."""
        common = lcm(*(x.denominator for x in numbers.values()))
        shared = gcd(*(int(x * common) for x in numbers.values()))
        powers = (
            (x * common / shared, zip(self.generators, monomials[n], strict=True))
            for n, x in numbers.items()
        )
        whole = self.field.sum(
            prod((g**e for g, e in pairs if e), start=self.field.number(x)) for x, pairs in powers
        )
        return -whole if leading(whole) < 0 else whole


def about_candidates(motion: ConstrainedRates, known: Sequence[Known]) -> Iterator[Examined]:
    """All integrals up to a degree: from those that are known, or found beyond them.

    Args:
        motion: The motion.
        known: Its known integrals; those that are constant where the motion is looked at may stay.
    """
    search = CandidateSearch(motion, known)
    names, where = [each.text for each in known], "for almost all parameters"
    if search.samples.obstacle:
        yield _passed_over(search, names)
        return
    degrees = affordable(search)
    found = search.found(degrees)
    if search.independent(found):
        values = default_numbers(motion.equations.spec)
        numeric, at_numbers = AtNumbers(motion, values), CandidateSearch(motion, known, values)
        if not at_numbers.samples.obstacle:
            search, where = at_numbers, "at the default parameters"
        for element in search.new(degrees) if search is at_numbers else ():
            text = described(motion.field, element)
            yield (
                f"{text} is conserved {where}",
                "integrals",
                partial(_drift, numeric, search, element),
            )
        names += ["those found"] * (len(search.known) > len(known))
        found = search.found(degrees)
    others = len(search.independent(found))
    share = f"{len(found) - others} of them" if others else "all"
    yield (
        f"integrals {_scope(search, degrees)}: a space of dimension {len(found)} with constants, "
        f"{share} functions of {', '.join(names) or 'nothing'}",
        "integrals",
        partial(_counted, search, where),
    )


def _passed_over(search: CandidateSearch, names: Sequence[str]) -> Examined:
    """That nothing was looked for, and why."""
    text = f"integrals beside {', '.join(names) or 'constants'} were not looked for"
    decision = Decision(Verdict.SUPPORTED, "no search")
    return f"{text}: {search.samples.obstacle}", "integrals", lambda: decision


def known_integrals(motion: ConstrainedRates, names: Mapping[str, Quantity]) -> list[Known]:
    """The energy, if it is conserved, and what a spec claims to be, as functions of the state.

    Args:
        motion: The motion.
        names: What claims may name beside the state.
    """
    equations, samples = motion.equations, Samples(motion)
    if samples.obstacle:
        return []
    setting, point, found = equations.setting, next(samples.points()), list[Known]()
    energy = [] if equations.exact.energy is None else [motion.closed(equations.exact.energy)]
    stated = [("energy", energy)]
    for claim in equations.spec.conserved:
        level = [motion.closed(g) for f in claim.where for g in setting.components(f, names)]
        if all(samples.where.contains(g) for g in level):
            parts = list(map(motion.closed, setting.components(claim.formula, names)))
            stated.append((claim.formula.in_one_line, parts))
    known = {*setting.state, *setting.parameters}
    for text, parts in dict(stated).items():
        plain = parts and all(motion.field.reach(part) <= known for part in parts)
        if plain and not any(point.moved(samples.slopes(part)) for part in parts):
            found.append(Known(text, tuple(parts)))
    return found


def default_numbers(spec: Spec) -> dict[str, Fraction]:
    """The default of every parameter; 1 where there is none."""
    return {
        name: value
        for each in spec.parameters
        for name, value in zip(
            each.components, each.default or [Fraction(1)] * len(each.components), strict=True
        )
    }


def affordable(search: CandidateSearch) -> tuple[int, int]:
    """The degrees that are searched, lower where there are very many monomials."""
    most, degree = DEGREES
    while max(map(len, search.sectors((most, degree)))) > MONOMIALS and degree:
        degree -= 1
    return most, degree


def _drift(motion: AtNumbers, search: CandidateSearch, element: Element) -> Decision:
    return decide_zero([motion.rate(element)], motion.field, search.samples.where)


def _scope(search: CandidateSearch, degrees: tuple[int, int]) -> str:
    """What was searched, in words."""
    text = f"of degree <= {degrees[0]} in the velocities"
    if search.positions:
        text += f" and <= {degrees[1]} in the positions"
    lengths = search.samples.where.text
    return f"{text}, where {lengths}" if lengths else text


def _counted(search: CandidateSearch, where: str) -> Decision:
    """The dimensions are ranks, of which those that exclude more integrals are certain."""
    count = len(search.values_at)
    return Decision(Verdict.PROVED, f"ranks at {count} random points modulo {PRIME}, {where}")


def _table(
    x: Sequence[int], rates: Sequence[int], monomials: Sequence[Exponents]
) -> tuple[list[int], list[int]]:
    """Values of monomials at a point, and their rates."""
    values, moved = [], []
    for exponents in monomials:
        factors = [i for i, e in enumerate(exponents) for _ in range(e)]
        values.append(prod(x[i] for i in factors) % PRIME)
        parts = (
            rates[i] * prod(x[j] for m, j in enumerate(factors) if m != n)
            for n, i in enumerate(factors)
        )
        moved.append(sum(parts) % PRIME)
    return values, moved


def _rank(rows: Sequence[Sequence[int]]) -> int:
    """The rank of lists of residues."""
    return len(echelon_modulo({n: x for n, x in enumerate(row) if x} for row in rows))
