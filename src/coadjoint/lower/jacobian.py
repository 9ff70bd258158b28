"""Lowering, Jacobian: the derivative of the rates by forward accumulation.

Comes in: the Program ``rhs``. Goes out: the Program ``jacobian``, which shares the definitions and
is as cheap as they make it. Where the kernel solves ``A x = b``, the derivative of x solves
``A x' = b' - A' x`` with the same factors: differentiating the factors themselves took twice
the operations for two coupled bodies, and compilers more than a minute.
Read next: `coadjoint.lower.check`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

from coadjoint.derive import Equations
from coadjoint.derive.solver import Solve, factor_name, is_intermediate, pivot_name
from coadjoint.exact import Element
from coadjoint.lower.graph import Graph
from coadjoint.lower.naming import Naming
from coadjoint.lower.program import Program

#: Derivatives of one value by components of the state, zeros left out.
Slopes = dict[str, int]


def residual_slopes(equations: Equations) -> list[tuple[str, Element]]:
    """``d(b - A x)_i / dx_j`` at fixed x of all solves, labelled, row by row."""
    field, slopes = equations.setting.field, []
    for solve in equations.exact.solves:
        for name, row, known in zip(solve.names, solve.matrix, solve.known, strict=True):
            unknowns = (field[unknown] for unknown in solve.names)
            products = (entry * x for entry, x in zip(row, unknowns, strict=True))
            gradient = field.gradient(known - field.sum(products), equations.setting.state)
            labels = (f"slope of {name} by {x}" for x in equations.setting.state)
            slopes += list(zip(labels, gradient, strict=True))
    return slopes


def jacobian(rhs: Program, equations: Equations) -> Program:
    """``d rhs_i / d x_j`` row by row, from the statements of the ``rhs`` Program.

    Definitions keep their names; temporaries are found anew where they are still shared.

    Args:
        rhs: Its outputs are the rates, and behind them the `residual_slopes`.
        equations: What it was lowered from.
    """
    graph, n = Graph(), len(rhs.state)
    definitions, values = _inserted(graph, rhs, {name for name, _ in equations.exact.definitions})
    slopes: dict[int, Slopes] = {graph.symbol(name): {name: graph.number(1)} for name in rhs.state}
    slopes |= {graph.symbol(name): {} for name in rhs.parameters}
    solved: dict[str, Slopes] = {}
    residuals = [values[row : row + n] for row in range(n, len(values), n)]
    for solve in equations.exact.solves:
        own, residuals = residuals[: len(solve.names)], residuals[len(solve.names) :]
        solved |= _solved(graph, solve, rhs.state, own, definitions)
    # By the unknowns first, and by the state through them at the very end: carrying the derivatives
    # of all unknowns by all of the state through the rates took twice the operations.
    for name, value in definitions.items():
        if name in solved:
            slopes[graph.symbol(name)] = {name: graph.number(1)}
        elif not is_intermediate(name):
            slopes[graph.symbol(name)] = graph.derivative(value, slopes)
    outputs = []
    for output, value in zip(rhs.outputs, values[:n], strict=False):
        slope = graph.derivative(value, slopes)
        outputs += [
            (f"d({output.label})/d{name}", _total(graph, slope, solved, name)) for name in rhs.state
        ]
    return Naming(graph, list(definitions.items()), outputs, rhs.parameters).program(
        "jacobian", rhs.state, rhs.parameters, (n, n)
    )


def _total(graph: Graph, slope: Slopes, solved: Mapping[str, Slopes], name: str) -> int:
    """The derivative by a component of the state, through the unknowns that depend on it."""
    through = [
        graph.multiply(slope[unknown], inner[name])
        for unknown, inner in solved.items()
        if unknown in slope and name in inner
    ]
    direct = [slope[name]] if name in slope else []
    return graph.sum([*direct, *through])


def _inserted(graph: Graph, rhs: Program, defined: set[str]) -> tuple[dict[str, int], list[int]]:
    """The nodes of the definitions by name, and of the outputs; temporaries are written out."""
    definitions: dict[str, int] = {}
    temporaries: dict[str, int] = {}
    for statement in rhs.statements:
        known = definitions if statement.name in defined else temporaries
        known[statement.name] = graph.insert(statement.value, temporaries)
    return definitions, [graph.insert(output.value, temporaries) for output in rhs.outputs]


def _solved(
    graph: Graph,
    solve: Solve,
    state: Sequence[str],
    residuals: Sequence[Sequence[int]],
    present: Collection[str],
) -> dict[str, Slopes]:
    """``x' = A^-1 r`` by L and D for each component of the state: slopes by unknown.

    Args:
        graph: Where L and D are symbols.
        solve: What is solved.
        state: Names of the components.
        residuals: r, a row for each unknown, a column for each component of the state.
        present: Names of the entries of L and D that are not zero.
    """
    size = range(len(solve.names))
    factors = {
        (i, k): graph.symbol(name)
        for i in size
        for k in size[:i]
        if (name := factor_name(solve.block[i], solve.block[k])) in present
    }
    one = graph.number(1)
    shares = [graph.divide(one, graph.symbol(pivot_name(i))) for i in solve.block]

    def less(start: int, terms: Iterable[tuple[int, int]]) -> int:
        products = (graph.negate(graph.multiply(a, b)) for a, b in terms)
        return graph.sum([start, *(p for p in products if not graph.is_zero(p))])

    slopes: dict[str, Slopes] = {name: {} for name in solve.names}
    for column, component in enumerate(state):
        y: list[int] = []
        for i in size:
            before = [(factors[i, k], y[k]) for k in size[:i] if (i, k) in factors]
            y.append(less(residuals[i][column], before))
        x: dict[int, int] = {}
        for i in reversed(size):
            after = [(factors[k, i], x[k]) for k in size[i + 1 :] if (k, i) in factors]
            x[i] = less(graph.multiply(y[i], shares[i]), after)
            if not graph.is_zero(x[i]):
                slopes[solve.names[i]][component] = x[i]
    return slopes
