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

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cached_property, reduce
from itertools import combinations_with_replacement, islice
from operator import mul
from typing import Any

from coadjoint.algebra.linear import nullspace
from coadjoint.derive import Equations, Relation
from coadjoint.exact import Element, element_text
from coadjoint.poisson.ranks import BY_VALUES, generic_rank, source_of_ranks
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.zero import Decision, decide_zero, random_points

#: How the dimension of an image is decided.
RANK = "rank of the map's derivative"


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

    def carried(self, function: Element) -> Element:
        """The time derivative of a function of the chart's variables along the route."""
        slopes = self.field.gradient(function, self.chart.variables)
        pairs = zip(slopes, self.other.exact.rates, strict=True)
        return self.field.sum(slope * rate for slope, rate in pairs if slope and rate)

    def related(self) -> Decision:
        """Whether ``D phi . Y = X o phi``.

        Velocities that both routes define stay symbols, where the definitions agree: what is left
        is polynomial. Only if that fails is everything written out.
        """
        shared = [*self._definition_defects(), *self._shared_defects()]
        decision = decide_zero(shared, self.field, self.domain)
        if decision.verdict is Verdict.PROVED:
            return decision
        return decide_zero(list(self._closed_defects()), self.field, self.domain)

    def _shared_defects(self) -> Iterator[Element]:
        """``D phi . Y - X o phi`` with the velocities that both routes define as symbols."""
        kept = {name for name, _ in self.other.exact.definitions}
        missing = {
            name: self.pull_back(self.first.closed(self.field[name]))
            for name, _ in self.first.exact.definitions
            if name not in kept
        }
        for name, rate in zip(self.first.setting.state, self.first.exact.rates, strict=True):
            yield self.carried(self.image[name]) - self.field.substitute(rate, self.image | missing)

    def _closed_defects(self) -> Iterator[Element]:
        """``D phi . Y - X o phi`` with each route's own velocities written out."""
        for name, rate in zip(self.first.setting.state, self.first.exact.rates, strict=True):
            own = self.other.closed(self.carried(self.image[name]))
            yield own - self.pull_back(self.first.closed(rate))

    def _definition_defects(self) -> Iterator[Element]:
        """What the emitted route defines, at the image, minus what this one defines."""
        defined = dict(self.first.exact.definitions)
        for name, _ in self.other.exact.definitions:
            if name in defined:
                whole = self.pull_back(self.first.closed(self.field[name]))
                yield whole - self.other.closed(self.field[name])

    def kept(self) -> Decision:
        """Whether the motion keeps the relations between the variables."""
        drifts = [
            self.other.closed(self.carried(relation.element)) for relation in self.chart.relations
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
        bound, rows = self._derivatives
        ranks = (bound, self._ranks[0]), ([*bound, *rows], self._ranks[1])
        return source_of_ranks(self.field, *ranks)

    @cached_property
    def _derivatives(self) -> tuple[list[dict[int, Element]], list[dict[int, Element]]]:
        """The derivatives of the relations and of the map."""
        bound = [self._slopes(relation) for relation in self.domain.relations]
        return bound, [self._slopes(value) for value in self.chart.state]

    @cached_property
    def _ranks(self) -> tuple[int, int]:
        """The ranks of the derivatives of the relations, and of these and the map."""
        bound, rows = self._derivatives
        return generic_rank(self.field, bound), generic_rank(self.field, [*bound, *rows])

    def _slopes(self, function: Element) -> dict[int, Element]:
        """The nonzero derivatives of a function, where the relations hold."""
        slopes = self.field.gradient(function, self.chart.variables)
        return {n: self.domain.on_zero_set(slope) for n, slope in enumerate(slopes) if slope}

    @cached_property
    def image_relations(self) -> tuple[Relation, ...]:
        """Functions of the state that vanish on the image, one for each dimension it lacks.

        Claimed Casimirs are tried first, then all polynomials of degree at most two. Their
        gradients are compared on the image: elsewhere dot(P, P) and dot(P, Gamma) seem to be two
        relations, and where P = 0 they are none.
        """
        state = self.first.setting.state
        found: list[Relation] = []
        slopes: list[dict[int, Element]] = []
        candidates = self._candidates()  # all polynomials, once the Casimirs have been tried
        while len(found) < len(state) - self.rank and (relation := next(candidates, None)):
            slope = map(self.pull_back, self.field.gradient(relation.element, state))
            row = {n: value for n, each in enumerate(slope) if (value := self.field.normal(each))}
            if generic_rank(self.field, [*slopes, row]) > len(slopes):
                found.append(relation)
                slopes.append(row)
        return tuple(found)

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
        monomials = [
            exponents
            for degree in (1, 2)
            for exponents in combinations_with_replacement(range(len(state)), degree)
        ]
        points = islice(self._image_points(), len(monomials) + 5)
        rows = [dict(enumerate(_products(values, monomials))) for values in points]
        written = _products(self.first.setting.elements(state), monomials)
        return [
            self.field.sum(self.field.number(w) * written[n] for n, w in vector.items())
            for vector in nullspace(rows, len(monomials))
        ]

    def _image_points(self) -> Iterator[list[Fraction]]:
        """The state at random points of the chart; none where a function is called."""
        values = [self.domain.on_zero_set(value) for value in self.chart.state]
        if not all(map(self.field.function_free, values)) or not self.domain.is_solved:
            return
        for point in random_points(self.field.names, self.field.positive):
            yield [self.field.evaluate(value, point, Fraction, _no_call) for value in values]


def _products(values: Sequence[Any], monomials: Sequence[tuple[int, ...]]) -> list[Any]:
    """The products of values at several places."""
    return [reduce(mul, (values[n] for n in places)) for places in monomials]


def _no_call(function: str, argument: Fraction) -> Fraction:
    raise AssertionError(f"{function}({argument}) in a function-free element")


def reach(chart_map: ChartMap) -> tuple[str, Decision]:
    """What of the state a chart reaches, as a statement with its decision.

    A rank at a point bounds the dimension from below, and relations that vanish on the image bound
    it from above: where the two meet, both are proved.
    """
    route, dimension = chart_map.other.route, len(chart_map.first.setting.state)
    missing, source = dimension - chart_map.rank, chart_map.source_of_rank
    if not missing:
        return f"the route {route} reaches an open set of states", _decision(source)
    relations = chart_map.image_relations
    named = ", ".join(f"{relation.text} = 0" for relation in relations)
    statement = (
        f"the states that the route {route} reaches have dimension {chart_map.rank} of {dimension}"
        + (f": {named}" if named else "")
    )
    return statement, _decision(source, met=len(relations) == missing)


def _decision(source: str, met: bool = True) -> Decision:
    """What a rank proves, if it meets its bound from the other side."""
    proved = met and source != BY_VALUES
    return Decision(Verdict.PROVED if proved else Verdict.SUPPORTED, f"{RANK} {source}")
