r"""Minors: three unknowns by elimination without quotients in between.

``A x = b`` with a symmetric A takes three quotients by :math:`L D L^T`, each of which waits for the
one before: on a processor that costs more than all the products. Without quotients on the way the
leading minors :math:`n_1, n_2` and :math:`n_1 n_3` come first, then two quotients that do not wait
for each other, :math:`1/(n_1 n_2)` and that of the last unknown. The digits are as good, since a
minor cancels as its pivot does. Of more unknowns products of minors would leave the range of
doubles: here they are of the fourth degree in A.
Comes in: a solve of the rates. Goes out: its lines in a graph. Solvers and Jacobians keep the
factors, which have fewer products that move.
Read next: `coadjoint.lower.lowering`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.solver import Solve
from coadjoint.exact import Element
from coadjoint.lower.definitions import Lines
from coadjoint.lower.graph import Graph
from coadjoint.lower.program import Node, Program, Statement, Symbol, children, with_children

#: Names or labels with their nodes.
Nodes = list[tuple[str, int]]
#: Rows of a result with their labels.
Rows = Sequence[tuple[str, Element]]
#: A quotient takes as long as so many sums or products, at least.
QUOTIENT = 8


def find_solve(equations: Equations, rows: Rows) -> Solve | None:
    """A solve of three coupled unknowns that are rates themselves; None where there is none."""
    field = equations.setting.field
    for solve in equations.exact.solves:
        entries = [solve.matrix[i][j] for i in range(len(solve.names)) for j in range(i)]
        full = len(entries) == 3 and all(entry != 0 for entry in entries)
        results = [field[name] for name in solve.names]
        others = [element for _, element in rows if element not in results]
        asked = [element for _, element in rows if element in results]
        rests = frozenset[str]().union(*map(field.reach, _close(equations, others)))
        if solve.symmetric and full and len(asked) == 3 and not rests & {*solve.names}:
            return solve
    return None


def _close(equations: Equations, elements: list[Element]) -> list[Element]:
    """Elements with the definitions on which they rest."""
    return elements + [value for _, value in equations.definitions_of(elements)]


def entries_of(solve: Solve, rows: Rows) -> Lines:
    """What is computed in the place of the unknowns: A on and below the diagonal, and b."""
    asked = set(solve.names)
    entries = [(f"a{i}{j}", solve.matrix[i][j]) for i in range(3) for j in range(i + 1)]
    known = [(f"b{i}", value) for i, value in enumerate(solve.known)]
    return entries + known + [(label, value) for label, value in rows if str(value) not in asked]


def is_faster(program: Program, other: Program) -> bool:
    """Whether a Program takes less time than another one, a quotient being long."""
    times = []
    for counts in (program.operation_counts(), other.operation_counts()):
        times.append(sum(counts.values()) + (QUOTIENT - 1) * counts.get("divide", 0))
    return times[0] < times[1]


def solve_by_minors(
    graph: Graph, solve: Solve, entries: Mapping[str, int], rows: Rows
) -> tuple[Nodes, Nodes]:
    """The lines that solve, in an order in which they can be computed, and the rows.

    Args:
        graph: Where they go.
        solve: What to solve.
        entries: Nodes of the entries, as `entries_of` labels them.
        rows: The result; an unknown is a name.
    """
    a00, a10, a11, a20, a21, a22 = (entries[f"a{i}{j}"] for i in range(3) for j in range(i + 1))
    b0, b1, b2 = (entries[f"b{i}"] for i in range(3))
    i, j, k = (place + 1 for place in solve.block)
    lines: Nodes = []

    def define(name: str, node: int) -> int:
        lines.append((name, node))
        return graph.symbol(name)

    def cross(a: int, b: int, c: int, d: int) -> int:
        """``a b - c d``."""
        return graph.sum((graph.multiply(a, b), graph.negate(graph.multiply(c, d))))

    first = define(f"_n{i}", a00)
    second = define(f"_n{j}", cross(first, a11, a10, a10))
    corner = define(f"_n{k}_{j}", cross(first, a21, a20, a10))
    third = define(f"_n{k}", cross(second, cross(first, a22, a20, a20), corner, corner))
    f1 = define(f"_f{j}", cross(first, b1, a10, b0))
    f2 = cross(second, cross(first, b2, a20, b0), corner, f1)
    one = define(f"_h{i}", graph.divide(graph.number(1), graph.multiply(first, second)))
    x2 = define(solve.names[2], graph.divide(f2, third))
    x1 = cross(f1, graph.number(1), corner, x2)
    x1 = define(solve.names[1], graph.multiply(graph.multiply(one, first), x1))
    taken = graph.sum((graph.multiply(a10, x1), graph.multiply(a20, x2)))
    x0 = graph.sum((b0, graph.negate(taken)))
    define(solve.names[0], graph.multiply(graph.multiply(one, second), x0))
    unknowns = {name: graph.symbol(name) for name in solve.names}
    nodes = ((label, unknowns.get(str(element))) for label, element in rows)
    return lines, [(label, entries[label] if node is None else node) for label, node in nodes]


def set_factored(program: Program, factored: Program) -> Program:
    """A Program that knows its factored form, from which solvers make their recurrences.

    What depends on parameters alone is computed once for both: equal values get one name, and other
    values other names.
    """
    shared = list(program.statements_at("parameters"))
    known = {each.value: each.name for each in shared}
    names: dict[str, str] = {}

    def rename(node: Node) -> Node:
        if isinstance(node, Symbol):
            return Symbol(names.get(node.name, node.name))
        return with_children(node, map(rename, children(node)))

    for statement in factored.statements_at("parameters"):
        value = rename(statement.value)
        if value not in known:
            known[value] = f"_p{len(shared) + 1}"
            shared.append(Statement(known[value], value, "parameters"))
        names[statement.name] = known[value]
    moving = [replace(s, value=rename(s.value)) for s in factored.statements_at("member")]
    outputs = tuple(replace(each, value=rename(each.value)) for each in factored.outputs)
    form = replace(factored, statements=(*shared, *moving), outputs=outputs)
    return replace(program, factored=form)
