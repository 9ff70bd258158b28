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
from coadjoint.derive.mechanics.iteration import Newton, iterate_name, rate_name
from coadjoint.derive.mechanics.solver import Solve, solve_in_kernel, solver_names
from coadjoint.exact import Element
from coadjoint.lower.graph import Graph


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


def insert_guesses(
    equations: Equations, graph: Graph, definitions: Iterable[tuple[str, Element]]
) -> list[tuple[str, int]]:
    """The guesses that definitions name, each after the steps towards it.

    Args:
        equations: Which iterations there are.
        graph: Where nodes are made.
        definitions: What is defined in the Program.
    """
    field = equations.setting.field
    reached = frozenset[str]().union(*(field.reach(value) for _, value in definitions))
    lines = list[tuple[str, int]]()
    for newton in equations.iterations:
        if reached.intersection(newton.names):
            lines += _insert(equations, graph, newton)
    return lines


def _insert(equations: Equations, graph: Graph, newton: Newton) -> list[tuple[str, int]]:
    """One iteration."""
    field, lines = equations.setting.field, list[tuple[str, int]]()
    names = frozenset[str]().union(*map(field.reach, newton.elements)) - {*newton.names}

    def number(value: Fraction) -> Noded:
        return Noded(graph, graph.number(value))

    def call(function: str, *arguments: Noded) -> Noded:
        return Noded(graph, graph.call(function, *(each.node for each in arguments)))

    def settle(step: int, place: int, value: Noded) -> Noded:
        lines.append((iterate_name(newton.block[place], step), value.node))
        return Noded(graph, graph.symbol(lines[-1][0]))

    known = {name: Noded(graph, graph.symbol(name)) for name in names}
    found = newton.find(field, known, number, call, settle)
    return [*lines, *((name, value.node) for name, value in found.items())]


def with_carried_velocities(equations: Equations) -> tuple[Equations, list[str]]:
    """Equations in which the velocities that iterations find are state, and their names.

    They change as ``d2l/dxi2 xi' = d/dt (mu - dl/dxi)``, the last at fixed velocities.
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
    carried = replace(
        exact, definitions=tuple(definitions), rates=(*exact.rates, *rates), solves=tuple(solves)
    )
    return replace(equations, exact=carried), names


def _rate(equations: Equations, element: Element) -> Element:
    """The rate of a function of the state and the time, velocities being constant."""
    field, state = equations.setting.field, equations.setting.state
    slopes = zip(field.gradient(element, state), equations.exact.rates, strict=True)
    explicit = field.gradient(element, equations.setting.time)
    return field.sum([*(slope * rate for slope, rate in slopes if slope != 0), *explicit])
