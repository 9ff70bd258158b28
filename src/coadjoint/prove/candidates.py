r"""Integrals of a motion up to a degree: all of them, by an exact linear solve.

A function F that is a polynomial of the velocities and of the positions has unknown numbers as
coefficients; ``dF/dt = 0`` at random points modulo a prime is linear in them. Functions that agree
where the constraints hold, and where vectors have the length 1, count as one. Where the motion may
run backwards, even and odd parts of an integral in the velocities are integrals, and searched for
apart.

What is certain. Let b be the dimension of the space of all combinations of the monomials, as
functions. The integrals among them have the dimension b - r, where r is the rank of the derivative
d/dt on that space. Ranks of values modulo a prime never exceed true ones (`coadjoint.prove.samples`
says why), so that r is bounded from below, and b too. From above b is bounded by the multiples of
known relations among the monomials, such as ``x (dot(Gamma, Gamma) - 1)``, since the rank of their
coefficients is again at least the one modulo the prime. Where both bounds of b meet there are no
more integrals than were found. Known integrals are in the space as well: as many of their products
as have independent values bound the dimension from below. Where these meet too, the dimension is
proved, and all integrals are polynomials in those known. Otherwise there is a finding, which says
what of it is certain. With random parameters the bound from above holds for almost all of their
values, with numbers for these numbers.

What is not made of known integrals is written out with the numbers that the parameters have by
default, lowest degrees first, and kept if it is proved by its rate there. So Jellett's and Routh's
integrals of a ball of revolution are found (Routh 1884; Holm 2011, section 12.2.1).
Comes in: a motion. Goes out: what is known and found, as claims and findings.
Read next: `coadjoint.prove.polynomial_families`; `coadjoint.prove.measures`, which asks for a
volume instead.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, partial
from itertools import islice
from math import comb, prod

from coadjoint.derive.integrals import lax_integrals
from coadjoint.exact import Element, element_text
from coadjoint.exact.ansatz import Exponents, Solution, solve
from coadjoint.exact.linear import SpanModulo
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.completeness import describe
from coadjoint.prove.motion import Motion, vector_names
from coadjoint.prove.polynomial_families import SPARE, Degrees, PolynomialFamily
from coadjoint.prove.reversibility import reversal_defects
from coadjoint.prove.samples import Samples, samples_of
from coadjoint.prove.zero import Decision, Discovery, Examined, decide_zero
from coadjoint.spec import Spec
from coadjoint.spec.core.constants import Rounded
from coadjoint.spec.spatial import spatial_momenta

#: Degrees in the velocities and in the positions up to which integrals are searched for: those of
#: Jellett and Routh have the degrees (1, 1) and (2, 2).
DEGREES = (2, 2)
#: Monomials among which integrals are searched for; 200 take about a second.
MONOMIALS = 200
#: Unknowns that are solved for together up to which integrals are searched for: each of the random
#: points takes as long as all functions of their differences.
SOLVED = 16
#: Products of known integrals that are tried.
PRODUCTS = 1000
#: How a function that a search has found is called.
FOUND = "those found"
#: How likely it is that more is wrong than what is certain.
LUCK = "an error has a probability below 1e-9"
#: Degrees in the order in which new integrals are searched for, so that generators come first.
STEPS = ((1, 0), (1, 1), (2, 1), (2, 2))


@dataclass(frozen=True)
class Known:
    """An integral by its name or its formula.

    Attributes:
        text: As statements show it.
        parts: Its components, in the state.
    """

    text: str
    parts: tuple[Element, ...]


class CandidateSearch(PolynomialFamily):
    """The search for integrals of one motion.

    Args:
        motion: The motion.
        known: Integrals that are known.
        parameters: Numbers for the parameters; by default they are random.
    """

    def __init__(
        self,
        motion: Motion,
        known: Sequence[Known] = (),
        parameters: Mapping[str, Fraction] | None = None,
    ) -> None:
        super().__init__(motion, [part for each in known for part in each.parts], parameters)
        self.known = tuple(known)
        self._rates = motion if parameters is None else motion.at(parameters)
        self._decided: dict[Element, Decision] = {}
        self._bases: dict[Degrees, list[Solution[Exponents]]] = {}

    @cached_property
    def reversible(self) -> bool:
        """Whether the motion runs backwards when its velocities change their signs."""
        defects = reversal_defects(self.motion)
        return all(map(self.field.is_zero, defects.values()))

    def sectors(self, degrees: Degrees) -> list[list[Exponents]]:
        """Monomials that an integral can have together."""
        whole, count = self.monomials(degrees), len(self.velocities)
        if not self.reversible:
            return [whole]
        return [[e for e in whole if sum(e[:count]) % 2 == parity] for parity in (0, 1)]

    def count_largest(self, degrees: Degrees) -> int:
        """How many monomials the largest sector has, of which there may be too many to list."""
        n, most = len(self.velocities), degrees[0]
        of_degree = [comb(n + k - 1, k) if n else int(k == 0) for k in range(most + 1)]
        parts = [of_degree[::2], of_degree[1::2]] if self.reversible else [of_degree]
        return max(map(sum, parts)) * comb(len(self.positions) + degrees[1], degrees[1])

    def integrals(self, members: Sequence[Exponents]) -> list[Solution[Exponents]]:
        """A basis of the integrals among combinations of monomials."""
        basis = [members[n] for n in self.independent_places(members)]
        conditions = ([table[e][1] for e in basis] for table in self.tables(len(members)))
        return solve(basis, conditions, self.samples.prime)

    def find(self, degrees: Degrees) -> list[Solution[Exponents]]:
        """A basis of the integrals up to some degrees."""
        if degrees not in self._bases:
            sectors = map(self.integrals, self.sectors(degrees))
            self._bases[degrees] = [each for basis in sectors for each in basis]
        return self._bases[degrees]

    def is_bounded(self, degrees: Degrees) -> bool:
        """Whether there are certainly no more integrals than `find` gives."""
        sectors = ((e, len(self.independent_places(e))) for e in self.sectors(degrees))
        return all(
            count + self.count_relations(members, degrees) == len(members)
            for members, count in sectors
        )

    def polynomials(self, degrees: Degrees) -> tuple[int, list[str]]:
        """How many polynomials in known integrals are independent, and in which of these.

        Only proved integrals count. The degrees of a product are the sums of those of its factors.
        """
        parts = [(each, part) for each in self.known for part in each.parts]
        degrees_of = [self.degrees_of(part) for _, part in parts]
        known = [(e, p, d) for (e, p), d in zip(parts, degrees_of, strict=True) if d and any(d)]
        while True:
            count, used = self._products(degrees, known)
            unproved = [n for n in used if not self._is_proved(known[n][1])]
            if not unproved:
                return count, list(dict.fromkeys(known[n][0].text for n in used))
            known = [each for n, each in enumerate(known) if n not in unproved]

    def _products(
        self, degrees: Degrees, known: Sequence[tuple[Known, Element, Degrees]]
    ) -> tuple[int, list[int]]:
        """The number of independent products, that of constants among them, and their factors."""
        count, prime = len(self.points(len(self.monomials(degrees)) + SPARE)), self.samples.prime
        values = [[p.value(part) for p in self.drawn[:count]] for _, part, _ in known]
        span, used = SpanModulo(prime), set[int]()
        for factors in islice(_factors([d for *_, d in known], degrees), PRODUCTS):
            if span.add({p: prod(values[n][p] for n in factors) for p in range(count)}):
                used |= {*factors}
        return span.rank, sorted(used)

    def drift(self, part: Element) -> Decision:
        """Whether a function is conserved where the points lie."""
        if part not in self._decided:
            rate = self._rates.rate(part)
            self._decided[part] = decide_zero([rate], self.field, self.samples.where)
        return self._decided[part]

    def _is_proved(self, part: Element) -> bool:
        return self.drift(part).verdict is Verdict.PROVED

    def independent(self, solutions: Sequence[Solution[Exponents]]) -> list[int]:
        """Places of the integrals that are not functions of those before them and of known ones.

        Slopes at a random point tell, together with those of the relations that hold there.
        """
        (point,), state = self.points(1), self.samples.state
        parts = (*self.samples.where.relations, *(p for known in self.known for p in known.parts))
        slopes = (map(point.value, self.field.gradient(part, state)) for part in parts)
        span = SpanModulo(self.samples.prime, (dict(enumerate(row)) for row in slopes))
        return span.add_independent(self.gradient(each) for each in solutions)

    def find_new(self, degrees: Degrees) -> Iterator[Element]:
        """Integrals that are not functions of known ones, low degrees first, by numbers, proved.

        They are known from then on. Coefficients modulo the prime that are those of no small
        fractions give functions that no proof holds for, and these are passed over.
        """
        for lower in (d for d in STEPS if d[0] <= degrees[0] and d[1] <= degrees[1]):
            solutions = self.find(lower)
            for place in self.independent(solutions):
                numbers = solutions[place].lift()
                if numbers is None:
                    continue
                element = self.write(numbers)
                if self._is_proved(element):
                    self.known = (*self.known, Known(FOUND, (element,)))
                    yield element


def about_candidates(motion: Motion) -> Iterator[Examined]:
    """All integrals up to a degree: from those that are known, or found beyond them."""
    coupled = max(map(len, motion.matrices), default=0)
    if coupled > SOLVED:
        reason = f"{coupled} unknowns are solved for together, more than {SOLVED}"
        text = f"integrals of low degree were not searched for: {reason}"
        yield text, "integrals", lambda: Discovery("no search")
        return
    known = known_integrals(motion)
    search, where = CandidateSearch(motion, known), motion.almost_always
    if search.samples.obstacle:
        yield _pass_over(search)
        return
    degrees = affordable(search)
    if search.independent(search.find(degrees)):
        at_numbers = CandidateSearch(motion, known, default_numbers(motion.equations.spec))
        if not at_numbers.samples.obstacle:
            search, where = at_numbers, _at_defaults(motion)
            for element in search.find_new(degrees):
                text = f"{describe(motion.field, element)} is conserved{where.lstrip(',')}"
                yield text, "integrals", partial(search.drift, element)
    yield _count(search, degrees, where)


def _count(search: CandidateSearch, degrees: Degrees, where: str) -> Examined:
    """How many integrals there are: proved where bounds from both sides meet, else found."""
    solutions, scope = search.find(degrees), f"integrals {_scope(search, degrees)}{where}"
    (certain, names), bounded = search.polynomials(degrees), search.is_bounded(degrees)
    points = f"ranks at {len(search.drawn)} random points modulo {search.samples.prime}"
    listed = f"polynomials in {', '.join(names)}" if names else "constants"
    size = f"a space of dimension {len(solutions)} with constants"
    if bounded and certain == len(solutions):
        decision = Decision(verdict=Verdict.PROVED, method=f"{points}, from above and from below")
        text = f"{size}, all {listed}" if names else "none but constants"
        return f"{scope}: {text}", "integrals", lambda: decision
    others = len(search.independent(solutions))
    names_of = ", ".join(dict.fromkeys(each.text for each in search.known)) or "constants"
    every = f"{names_of} and of {others} more of them" if others else names_of
    most, sure = "", "that there are so many polynomials is exact"
    if bounded:
        most, sure = " at the most", "the bound, and that there are so many polynomials, are exact"
    text = f"{size}{most}, {certain} of it {listed}; all are functions of {every}"
    discovery = Discovery(points, where.strip(", "), f"{sure}; for the rest {LUCK}")
    return f"{scope}: {text}", "integrals", lambda: discovery


def _at_defaults(motion: Motion) -> str:
    """The numbers of the parameters, in words."""
    if not motion.setting.parameters:
        return motion.at_all_times
    whole = all(each.default is not None for each in motion.spec.parameters)
    others = "" if whole else " and 1 where there is none"
    values = (value for each in motion.spec.parameters for value in each.default or ())
    rounded = " as doubles" if any(isinstance(value, Rounded) for value in values) else ""
    return f", at the default parameters{rounded}{others}{motion.at_all_times}"


def _pass_over(search: CandidateSearch) -> Examined:
    """That nothing was searched for, and why."""
    names = ", ".join(each.text for each in search.known) or "constants"
    text = f"integrals other than {names} were not searched for: {search.samples.obstacle}"
    return text, "integrals", lambda: Discovery("no search")


def known_integrals(motion: Motion) -> list[Known]:
    """What may be conserved as a spec or a theorem has it, as functions of the state.

    What changes at a random point is none; what does not is proved where a proof rests on it.
    """
    setting, spec, where = motion.setting, motion.spec, samples_of(motion).where
    names, energy = motion.emitted, motion.equations.exact.energy
    stated = {} if energy is None else {"energy": [motion.close(energy)]}
    for claim in spec.conserved:
        level = [motion.close(g) for f in claim.where for g in setting.components(f, names)]
        if all(where.contains(g) for g in level):
            parts = list(map(motion.close, setting.components(claim.formula, names)))
            stated[claim.formula.in_one_line] = parts
    for casimir in spec.casimirs:
        stated[casimir.in_one_line] = list(map(motion.close, setting.components(casimir)))
    emitted = dict(motion.equations.exact.observables)
    named = [(each.name, each.components) for each in spec.sections]
    named += [(each.name, each.components) for each in spec.symmetries]
    named += [(each.name, each.components) for each in spatial_momenta(spec)]
    for name, components in named:
        stated[name] = [motion.close(emitted[component]) for component in components]
    pair = lax_integrals(setting)
    stated |= {} if pair is None else {name: [motion.close(x)] for name, x in pair.named}
    known, integrals = {*setting.state, *setting.parameters}, list[Known]()
    for text, parts in stated.items():
        plain = parts and all(motion.field.reach(part) <= known for part in parts)
        if plain and not _changes(motion, parts):
            integrals.append(Known(text, tuple(parts)))
    return integrals


def _changes(motion: Motion, parts: Sequence[Element]) -> bool:
    """Whether functions certainly change along the motion, or have no values at its points."""
    samples = samples_of(motion)
    if not samples.serves(parts):
        samples = Samples(motion, None, parts)
    point = samples.first
    return point is None or any(point.differentiate(samples.slopes(part)) for part in parts)


def default_numbers(spec: Spec) -> dict[str, Fraction]:
    """The default of every parameter; 1 where there is none."""
    return {
        name: value
        for each in spec.parameters
        for name, value in zip(
            each.components, each.default or [Fraction(1)] * len(each.components), strict=True
        )
    }


def affordable(search: CandidateSearch) -> Degrees:
    """The degrees that are searched, lower where there are very many monomials."""
    most, degree = DEGREES
    while search.count_largest((most, degree)) > MONOMIALS and most + degree > 1:
        most, degree = (most, degree - 1) if degree else (most - 1, degree)
    return most, degree


def _scope(search: CandidateSearch, degrees: Degrees) -> str:
    """What was searched, in words: polynomials in these names."""
    text = f"of degree <= {degrees[0]} in {_name_generators(search, search.velocities)}"
    if search.positions:
        text += f" and <= {degrees[1]} in {_name_generators(search, search.positions)}"
    lengths = search.samples.where.text
    return f"{text}, where {lengths}" if lengths else text


def _name_generators(search: CandidateSearch, names: Sequence[str]) -> str:
    """Generators as a statement names them: whole vectors by their name."""
    whole, field = {each.name for each in search.motion.spec.state}, search.field
    shown = vector_names(search.motion, names)
    return ", ".join(n if n in whole else element_text(field, field[n]) for n in shown)


def _factors(known: Sequence[Degrees], degrees: Degrees) -> Iterator[tuple[int, ...]]:
    """Products of so high degrees at the most, each by its factors; few factors first.

    >>> list(_factors([(1, 0), (2, 1)], (2, 2)))
    [(), (0,), (1,), (0, 0)]
    """
    level: list[tuple[int, ...]] = [()]
    while level:
        yield from level
        longer = (
            (*factors, n) for factors in level for n in range(max(factors, default=0), len(known))
        )
        level = [
            factors
            for factors in longer
            if all(sum(known[n][k] for n in factors) <= degrees[k] for k in (0, 1))
        ]
