"""Guesses: Newton's iterations as statements, before the definitions that name what they find.

Comes in: the graph of a Program in the making. Goes out: definitions of the guesses, and of what
each step towards them gives. They are the operations of `coadjoint.derive.mechanics.newton`.
Read next: `coadjoint.lower.lowering`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.newton import Newton, iterate_name
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
    found = (each.newton for each in equations.exact.solves if each.newton is not None)
    lines = list[tuple[str, int]]()
    for newton in found:
        if reached.intersection(newton.names):
            lines += _insert(equations, graph, newton)
    return lines


def _insert(equations: Equations, graph: Graph, newton: Newton) -> list[tuple[str, int]]:
    """One iteration."""
    field, lines = equations.setting.field, list[tuple[str, int]]()
    names = frozenset().union(*map(field.reach, newton.elements)) - {*newton.names}

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
