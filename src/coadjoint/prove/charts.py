"""Routes in variables of their own: the same motion through the map to the declared state.

Comes in: Equations on the declared state and Equations with a `Chart`. Goes out: elements that must
be zero. The chart's motion Y and the declared motion X are related by the map phi,

    D phi . Y = X o phi,

as an identity in the chart's variables, modulo its relations where it has some; the motion must
keep these. What of the state the map reaches is read off the rank of D phi, and where that is not
all of it, functions of the state that vanish on the image name the submanifold.
Read next: `coadjoint.prove.claims`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import cached_property
from itertools import combinations, islice, product
from math import prod

from coadjoint.derive import Equations, Relation
from coadjoint.derive.mechanics.driving import explicit
from coadjoint.errors import AlgebraError
from coadjoint.exact import Element, element_text
from coadjoint.exact.ansatz import monomials, solve_exactly
from coadjoint.exact.dense import determinant
from coadjoint.exact.linear import rank_modulo
from coadjoint.exact.ranks import error_of_ranks, generic_rank, source_of_ranks
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.constrained import motion_of
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.zero import Decision, Discovery, decide_zero, random_points

#: How the dimension of an image is decided.
RANK = "rank of the map's derivative"
ON_QUADRIC = "at rational points of the relation"
#: Points of a relation of degree two at which ranks are taken, and how often they are searched for.
POINTS, TRIES = 2, 20
#: Points beyond as many as there are monomials, at which polynomials that vanish are searched for.
SPARE = 5


class ChartMap:
    """The map from a route's own variables to the declared state.

    Args:
        first: The emitted route, on the declared state.
        other: A route with a chart, in the same Setting.
    """

    def __init__(self, first: Equations, other: Equations) -> None:
        assert first.chart is None, first.route
        assert other.chart is not None, other.route
        self.first, self.other, self.chart = first, other, other.chart
        self.field = first.setting.field
        self.image: dict[str, Element] = dict(
            zip(first.setting.state, self.chart.state, strict=True)
        )

    @cached_property
    def domain(self) -> Ideal:
        """The relations between the chart's variables."""
        relations = [relation.element for relation in self.chart.relations]
        text = ", ".join(relation.text for relation in self.chart.relations)
        return Ideal(self.field, relations, text, self.chart.variables)

    def pull_back(self, element: Element) -> Element:
        """A function of the declared state as one of the chart's variables."""
        return self.field.substitute(element, self.image)

    def rate_along_route(self, function: Element) -> Element:
        """The time derivative of a function of the chart's variables along the route."""
        own = explicit(self.first.setting, function)
        slopes = self.field.gradient(function, self.chart.variables)
        pairs = zip(slopes, self.other.exact.rates, strict=True)
        return own + self.field.sum(slope * rate for slope, rate in pairs if slope and rate)

    def decide_related(self) -> Decision:
        """Whether ``D phi . Y = X o phi``.

        Velocities that both routes define stay symbols, where the definitions agree: what is left
        is polynomial. Only if that fails is everything written out, and so it is where the kernel
        solves for something.
        """
        if self.first.kept:
            return decide_zero(self._solved_defects(), self.field, self.domain)
        shared = [*self._definition_defects(), *self._shared_defects()]
        decision = decide_zero(shared, self.field, self.domain)
        if decision.verdict is Verdict.PROVED:
            return decision
        return decide_zero(list(self._closed_defects()), self.field, self.domain)

    def _shared_defects(self) -> Iterator[Element]:
        """``D phi . Y - X o phi`` with the velocities that both routes define as symbols."""
        kept = {name for name, _ in self.other.exact.definitions}
        missing = {
            name: self.pull_back(self.first.close(self.field[name]))
            for name, _ in self.first.exact.definitions
            if name not in kept
        }
        for name, rate in zip(self.first.setting.state, self.first.exact.rates, strict=True):
            yield self.rate_along_route(self.image[name]) - self.field.substitute(
                rate, self.image | missing
            )

    def _closed_defects(self) -> Iterator[Element]:
        """``D phi . Y - X o phi`` with each route's own velocities written out."""
        for name, rate in zip(self.first.setting.state, self.first.exact.rates, strict=True):
            own = self.other.close(self.rate_along_route(self.image[name]))
            yield own - self.pull_back(self.first.close(rate))

    def _solved_defects(self) -> list[Element]:
        """``D phi . Y - X o phi`` with the solution of linear equations put in."""
        if self.first.distribution is not None:
            rates = {n: self.pull_back(x) for n, x in motion_of(self.first).written_rates.items()}
        else:
            names, solved = self.first.setting.state, self._solution
            closed = (self.pull_back(self.first.close(rate)) for rate in self.first.exact.rates)
            written = (self.field.substitute(rate, solved) for rate in closed)
            rates = dict(zip(names, written, strict=True))
        return [
            self.other.close(self.rate_along_route(self.image[name])) - rate
            for name, rate in rates.items()
        ]

    @cached_property
    def _solution(self) -> dict[str, Element]:
        """The velocities that the kernel solves for, at the image: by Cramer's rule."""
        solution = dict[str, Element]()
        for solve in self.first.exact.solves:
            rows = [[*row, k] for row, k in zip(solve.matrix, solve.known, strict=True)]
            placed = [[self.pull_back(self.first.close(entry)) for entry in row] for row in rows]
            whole = determinant(tuple(tuple(row[:-1]) for row in placed))
            for n, name in enumerate(solve.names):
                turned = tuple((*row[:n], row[-1], *row[n + 1 : -1]) for row in placed)
                solution[name] = determinant(turned) / whole
        return solution

    def constraint_defects(self) -> list[Element]:
        """The constraints that the motion keeps, at the image."""
        return [self.pull_back(residual) for _, residual in motion_of(self.first).kept]

    def decide_bound(self) -> Decision:
        """Whether all of the chart is where these constraints hold."""
        return decide_zero(self.constraint_defects(), self.field, self.domain)

    def _definition_defects(self) -> Iterator[Element]:
        """What the emitted route defines, at the image, minus what this one defines."""
        defined = dict(self.first.exact.definitions)
        for name, _ in self.other.exact.definitions:
            if name in defined:
                whole = self.pull_back(self.first.close(self.field[name]))
                yield whole - self.other.close(self.field[name])

    def decide_kept(self) -> Decision:
        """Whether the motion keeps the relations between the variables."""
        drifts = [
            self.other.close(self.rate_along_route(relation.element))
            for relation in self.chart.relations
        ]
        return decide_zero(drifts, self.field, self.domain)

    # -- what it reaches ----------------------------------------------------------------

    @cached_property
    def rank(self) -> int:
        """Dimension of the image, at almost every point of the chart."""
        return self._ranks[1] - self._ranks[0]

    @cached_property
    def source_of_rank(self) -> str:
        """How the rank is known."""
        if self._is_quadric:
            return ON_QUADRIC
        bound, rows = self._derivatives
        return source_of_ranks(self.field, (bound, self._ranks[0]), ([*bound, *rows], self.rank))

    @cached_property
    def error_of_rank(self) -> str:
        """How likely it is that the rank is larger."""
        return error_of_ranks(self.field, *self._derivatives)

    @property
    def is_certain(self) -> bool:
        """Whether the dimension of the image is certainly no less than the rank.

        The rank of the relations and of the map is certain from below. That of the relations alone
        is no more than their number: so it must be that. And both must have been taken where the
        relations hold: with the solution in their place, or at points of the quadric.
        """
        count = len(self.domain.relations)
        placed = self.domain.is_solved or self._is_quadric
        return not count or (placed and self._ranks[0] == count)

    @cached_property
    def _derivatives(self) -> tuple[list[dict[int, Element]], list[dict[int, Element]]]:
        """The derivatives of the relations and of the map."""
        bound = [self._slopes(relation) for relation in self.domain.relations]
        return bound, [self._slopes(value) for value in self.chart.state]

    @cached_property
    def _ranks(self) -> tuple[int, int]:
        """The ranks of the derivatives of the relations, and of these and the map."""
        bound, rows = self._derivatives
        return self._rank_on_domain(bound), self._rank_on_domain([*bound, *rows])

    def _slopes(self, function: Element) -> dict[int, Element]:
        """The nonzero derivatives of a function, where the relations hold."""
        slopes = self.field.gradient(function, self.chart.variables)
        return {n: self.domain.on_zero_set(slope) for n, slope in enumerate(slopes) if slope}

    def _rank_on_domain(self, rows: Sequence[Mapping[int, Element]]) -> int:
        """The rank of a matrix at points where the relations hold, if such are known."""
        plain = all(self.field.is_function_free(entry) for row in rows for entry in row.values())
        if not (self._is_quadric and plain):
            return generic_rank(self.field, rows)
        largest = 0
        for point in self._quadric:
            with suppress(ZeroDivisionError):
                numbers = (
                    {n: self.field.evaluate(e, point, Fraction, _no_call) for n, e in row.items()}
                    for row in rows
                )
                largest = max(largest, rank_modulo(numbers))
        return largest

    @property
    def _is_quadric(self) -> bool:
        """Whether points of a relation are known that none of its symbols is solved for."""
        plain = all(
            self.field.is_function_free(entry)
            for rows in self._derivatives
            for row in rows
            for entry in row.values()
        )
        return plain and not self.domain.is_solved and bool(self._quadric)

    @cached_property
    def _quadric(self) -> list[dict[str, Fraction]]:
        """Rational points of a single relation of degree two.

        A line through one of them, which has few entries other than 0, meets it once more.
        """
        if len(self.domain.relations) != 1 or not self.field.is_function_free(
            self.domain.relations[0]
        ):
            return []
        zeros = list[dict[str, Fraction]]()
        for start in islice(random_points(self.field.names, self.field.positive), TRIES):
            corner = next(filter(self._is_on, self._corners(start)), None)
            if corner is None:
                continue
            along = {name: start[name] for name in self.chart.variables}
            points = [
                corner | {name: corner[name] + t * x for name, x in along.items()} for t in (1, -1)
            ]
            a, b = map(self._residual, points)  # of a t^2 + b t at 1 and -1
            if a + b and a - b:
                turn = (b - a) / (a + b)
                point = corner | {name: corner[name] + turn * x for name, x in along.items()}
                zeros += [point] if self._is_on(point) and self._is_regular(point) else []
            if len(zeros) == POINTS:
                break
        return zeros

    def _corners(self, start: Mapping[str, Fraction]) -> Iterator[dict[str, Fraction]]:
        """Points with one entry 1 or -1, or two of them, and parameters as given."""
        names = self.chart.variables
        flat = dict(start) | dict.fromkeys(names, Fraction(0))
        for count in (1, 2):
            for chosen in combinations(names, count):
                for signs in product((1, -1), repeat=count):
                    yield flat | dict(zip(chosen, map(Fraction, signs), strict=True))

    def _is_regular(self, point: Mapping[str, Fraction]) -> bool:
        """Whether the derivative of the relation is not zero, so that its zero set is smooth."""
        (row,) = self._derivatives[0]
        return any(self.field.evaluate(e, point, Fraction, _no_call) for e in row.values())

    def _residual(self, point: Mapping[str, Fraction]) -> Fraction:
        return self.field.evaluate(self.domain.relations[0], point, Fraction, _no_call)

    def _is_on(self, point: Mapping[str, Fraction]) -> bool:
        try:
            return not self._residual(point)
        except ZeroDivisionError:
            return False

    @cached_property
    def image_relations(self) -> tuple[Relation, ...]:
        """Functions of the state that vanish on the image, one for each dimension it lacks.

        Claimed Casimirs are tried first, then all polynomials of degree at most two. Their
        gradients are compared on the image: elsewhere dot(P, P) and dot(P, Gamma) seem to be two
        relations, and where P = 0 they are none.
        """
        state = self.first.setting.state
        relations: list[Relation] = []
        slopes: list[dict[int, Element]] = []
        candidates = self._candidates()  # all polynomials, once the Casimirs have been tried
        while len(relations) < len(state) - self.rank and (relation := next(candidates, None)):
            slope = map(self.pull_back, self.field.gradient(relation.element, state))
            placed = map(self.domain.on_zero_set, slope)
            row = {n: value for n, each in enumerate(placed) if (value := self.field.normal(each))}
            if self._rank_on_domain([*slopes, row]) > len(slopes):
                relations.append(relation)
                slopes.append(row)
        return tuple(relations)

    def _candidates(self) -> Iterator[Relation]:
        """Functions that vanish on the image, the simplest first."""
        for casimir in self.first.spec.casimirs:
            if casimir.shape:
                continue
            value = self.first.setting.formula(casimir)
            if self.domain.contains(self.pull_back(value)):
                yield Relation(casimir.in_one_line, value)
        for value in self._polynomials():
            if self.domain.contains(self.pull_back(value)):
                yield Relation(element_text(self.field, value), value)

    def _polynomials(self) -> list[Element]:
        """Polynomials of degree two or less that vanish at many points of the image."""
        state = self.first.setting.state
        family = list(monomials(len(state), 2, least=1))
        conditions = (
            {n: prod(map(pow, values, exponents)) for n, exponents in enumerate(family)}
            for values in islice(self._image_points(), len(family) + SPARE)
        )
        return [self.field.polynomial(state, terms) for terms in solve_exactly(family, conditions)]

    def _image_points(self) -> Iterator[list[Fraction]]:
        """The state at random points of the chart; none where a function is called."""
        values = [self.domain.on_zero_set(value) for value in self.chart.state]
        if not all(map(self.field.is_function_free, values)) or not self.domain.is_solved:
            return
        for point in random_points(self.field.names, self.field.positive):
            yield [self.field.evaluate(value, point, Fraction, _no_call) for value in values]


def _no_call(function: str, argument: Fraction) -> Fraction:
    raise AssertionError(f"{function}({argument}) in a function-free element")


def reach(chart_map: ChartMap) -> tuple[str, Decision | Discovery]:
    """What of the state a chart reaches, as a statement with its decision.

    A rank at a point bounds the dimension from below, and independent relations that vanish on the
    image bound it from above: where the two meet, both are proved.
    """
    way, dimension = chart_map.other.way, len(chart_map.first.setting.state)
    try:
        missing = dimension - chart_map.rank
    except AlgebraError as error:
        return f"what {way} reaches was not decided", Discovery(str(error))
    if not missing:
        return f"{way} reaches an open set of states", _decision(chart_map, True)
    relations = chart_map.image_relations
    met = len(relations) == missing and chart_map.is_certain
    least = "" if met else "at least " if chart_map.is_certain else "probably "
    named = ", ".join(f"{relation.text} = 0" for relation in relations)
    statement = (
        f"the states that {way} reaches have dimension {least}{chart_map.rank} of "
        f"{dimension}" + (f": {named}" if named else "")
    )
    return statement, _decision(chart_map, met)


def _decision(chart_map: ChartMap, met: bool) -> Decision | Discovery:
    """What a rank proves, if it meets its bound from the other side."""
    method = f"{RANK} {chart_map.source_of_rank}"
    if met and chart_map.is_certain:
        return Decision(verdict=Verdict.PROVED, method=method)
    if chart_map.is_certain:
        return Discovery(method, "", chart_map.error_of_rank)
    return Discovery(method, "", "that the relations are no more than they seem is not proved")
