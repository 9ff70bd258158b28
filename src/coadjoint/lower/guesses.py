"""Guesses: Newton's iterations as statements, before the definitions that name what they find.

Comes in: the graph of a Program in the making. Goes out: definitions of the guesses, and of what
each step towards them gives. They are the operations of `coadjoint.derive.mechanics.iteration`.
Read next: `coadjoint.lower.lowering`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from fractions import Fraction

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.iteration import Newton, iterate_name, rate_name, slope_name
from coadjoint.derive.mechanics.solver import Solve, solve_in_kernel, solver_names
from coadjoint.exact import Element
from coadjoint.lower.graph import Graph
from coadjoint.lower.sums import Lowering


@dataclass(frozen=True)
class Noded:
    """A node of a graph, with the arithmetic that makes others of it."""

    graph: Graph
    node: int

    def __add__(self, other: Noded) -> Noded:
        return Noded(self.graph, self.graph.add(self.node, other.node))

    def __mul__(self, other: Noded) -> Noded:
        return Noded(self.graph, self.graph.multiply(self.node, other.node))

    def __truediv__(self, other: Noded) -> Noded:
        return Noded(self.graph, self.graph.divide(self.node, other.node))

    def __neg__(self) -> Noded:
        return Noded(self.graph, self.graph.negate(self.node))


def find_iterations(
    equations: Equations, definitions: Iterable[tuple[str, Element]]
) -> list[Newton]:
    """The iterations for guesses that definitions name."""
    field = equations.setting.field
    reached = frozenset[str]().union(*(field.reach(value) for _, value in definitions))
    return [each for each in equations.iterations if reached.intersection(each.names)]


def insert_guess(lowering: Lowering, newton: Newton) -> list[tuple[str, int]]:
    """A guess after the steps towards it.

    Args:
        lowering: Where nodes are made; it knows what is evaluated in each step.
        newton: The iteration.
    """
    field, graph, lines = lowering.field, lowering.graph, list[tuple[str, int]]()
    curved = [lowering.node(each) for each in newton.curved]
    names = frozenset[str]().union(*map(field.reach, newton.elements)) - {*newton.names}

    def number(value: Fraction) -> Noded:
        return Noded(graph, graph.number(value))

    def call(function: str, *arguments: Noded) -> Noded:
        return Noded(graph, graph.call(function, *(each.node for each in arguments)))

    def settle(step: int, place: int, value: Noded) -> Noded:
        lines.append((iterate_name(newton.block[place], step), value.node))
        return Noded(graph, graph.symbol(lines[-1][0]))

    def exchange(values: list[Noded]) -> list[Noded]:
        nodes = dict(zip(newton.names, (each.node for each in values), strict=True))
        known = {graph.symbol(name): node for name, node in nodes.items()}
        return [Noded(graph, graph.exchange(each, {}, known)) for each in curved]

    known = {name: Noded(graph, graph.symbol(name)) for name in names}
    found = newton.find(field, known, number, call, settle, exchange)
    return [*lines, *((name, value.node) for name, value in found.items())]


def with_carried_velocities(equations: Equations) -> tuple[Equations, list[str]]:
    """Equations in which the velocities that iterations find are state, and their names.

    They change as ``d2l/dxi2 xi' = d/dt (mu - dl/dxi)``, the last at fixed velocities. Where it
    has rates of inputs, these are state, too: inputs are straight lines between their jumps.
    """
    field, exact = equations.setting.field, equations.exact
    found = [each for each in exact.solves if each.newton is not None]
    names = [name for each in found for name in each.names]
    gone = {*names, *(each for solve in found for each in solver_names(solve.block))}
    definitions = [line for line in exact.definitions if line[0] not in gone]
    solves = [each for each in exact.solves if each.newton is None]
    for each in found:
        assert each.newton is not None
        at = {n: field[name] for n, name in zip(each.newton.names, each.names, strict=True)}
        pairs = zip(each.newton.sought, each.newton.slopes, strict=True)
        residuals = [mu - field.substitute(slope, at) for mu, slope in pairs]
        own = Solve(
            matrix=tuple(tuple(field.substitute(e, at) for e in row) for row in each.matrix),
            known=[_rate(equations, residual) for residual in residuals],
            block=each.block,
            names=[*map(rate_name, each.block)],
        )
        definitions += solve_in_kernel(field, own)
        solves.append(own)
    rates = [field[rate_name(place)] for each in found for place in each.block]
    reached = frozenset[str]().union(*(field.reach(value) for _, value in definitions))
    turning = sorted(reached.intersection(_input_slopes(equations)))
    names, rates = [*names, *turning], [*rates, *(field.zero for _ in turning)]
    carried = replace(
        exact, definitions=tuple(definitions), rates=(*exact.rates, *rates), solves=tuple(solves)
    )
    return replace(equations, exact=carried), names


def _rate(equations: Equations, element: Element) -> Element:
    """The rate of a function of state, inputs and time, velocities being constant."""
    field, state = equations.setting.field, equations.setting.state
    slopes = zip(field.gradient(element, state), equations.exact.rates, strict=True)
    explicit = field.gradient(element, equations.setting.time)
    inputs = _input_slopes(equations)
    driven = zip(field.gradient(element, [*inputs.values()]), inputs, strict=True)
    moving = [slope * rate for slope, rate in slopes if slope != 0]
    moving += [slope * field[name] for slope, name in driven if slope != 0]
    return field.sum([*moving, *explicit])


def _input_slopes(equations: Equations) -> dict[str, str]:
    """Components of the inputs by the names of their rates."""
    return {slope_name(place): name for place, name in enumerate(equations.setting.inputs)}
