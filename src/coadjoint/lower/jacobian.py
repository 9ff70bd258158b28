"""Lowering, Jacobians: derivatives of the rates by forward accumulation.

Comes in: the Program ``rhs``. Goes out: the Program ``jacobian``, by the state, or that by inputs
or parameters, which shares the definitions and is as cheap as they make it. Where the kernel solves
``A x = b``, the derivative of x solves ``A x' = b' - A' x`` with the same factors: differentiating
the factors themselves took twice the operations for two coupled bodies, and compilers more than a
minute.
Read next: `coadjoint.lower.check`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.solver import Solve, factors
from coadjoint.exact import Element
from coadjoint.lower.graph import Graph
from coadjoint.lower.naming import Naming
from coadjoint.lower.program import Program
from coadjoint.lower.vanishing import find_hidden_zeros

#: Derivatives of one value by state, inputs or parameters, zeros left out.
Slopes = dict[str, int]


@dataclass(frozen=True)
class ResidualSlope:
    """How a residual ``(b - A x)_i`` changes at fixed x.

    Attributes:
        row: Of the residual, counted through all solves.
        by: A variable, or a definition through which the residual depends on it.
        slope: The partial derivative.
    """

    row: int
    by: str
    slope: Element


def residual_slopes(equations: Equations, variables: Sequence[str]) -> list[ResidualSlope]:
    """The derivatives of ``b - A x`` of all solves by what they name, zeros left out."""
    field, partials, row = equations.setting.field, list[ResidualSlope](), 0
    solved = {name for solve in equations.exact.solves for name in solve.names}
    inner = {name for name, _ in equations.exact.definitions}
    inner -= solved | equations.intermediates | equations.numbers.keys()
    for solve in equations.exact.solves:
        for entries, known in zip(solve.matrix, solve.known, strict=True):
            unknowns = (field[unknown] for unknown in solve.names)
            products = (entry * x for entry, x in zip(entries, unknowns, strict=True))
            residual = known - field.sum(products)
            names = [*variables, *sorted(inner & field.reach(residual))]
            slopes = zip(names, field.gradient(residual, names), strict=True)
            partials += [ResidualSlope(row, name, slope) for name, slope in slopes if slope != 0]
            row += 1
    return partials


def factors_of_solves(equations: Equations) -> list[dict[tuple[int, int], Element]]:
    """L, U and one over D of every solve, by row and column; none of one that is a loop."""
    field, definitions = equations.setting.field, dict(equations.exact.definitions)
    return [
        {} if solve.is_loop else factors(field, solve, definitions)
        for solve in equations.exact.solves
    ]


def jacobian(
    name: str,
    rhs: Program,
    equations: Equations,
    variables: Sequence[str],
    residuals: Sequence[ResidualSlope],
    along: Sequence[str] = (),
) -> Program:
    """``d rhs_i / d x_j`` row by row, from the statements of the ``rhs`` Program.

    Definitions keep their names; temporaries are made anew where they are still shared.

    Args:
        name: Of the function.
        rhs: Its outputs are the rates, behind them the slopes of the residuals, and then the
            factors of the solves.
        equations: What it was lowered from.
        variables: The x that the derivatives are by.
        residuals: What these are the slopes of.
        along: Components of a vector: the derivative is that along it, one for each rate.
    """
    graph, n, columns = Graph(), len(rhs.state), variables if not along else ("vector",)
    definitions, values = _insert_definitions(
        graph, rhs, {name for name, _ in equations.exact.definitions} | equations.guesses
    )
    slopes: dict[int, Slopes] = {graph.symbol(x): {} for x in rhs.names}
    slopes |= {graph.symbol(x): {} for x in equations.guesses}
    if along:
        vector = zip(variables, along, strict=True)
        slopes |= {graph.symbol(x): {columns[0]: graph.symbol(h)} for x, h in vector}
    else:
        slopes |= {graph.symbol(x): {x: graph.number(1)} for x in variables}
    rows: dict[int, dict[str, int]] = {}
    for residual, node in zip(residuals, values[n:], strict=False):
        rows.setdefault(residual.row, {})[residual.by] = node
    solved: dict[str, Slopes] = {}
    # By the unknowns first, and by the state through them at the very end: carrying the derivatives
    # of all unknowns by all of the state through the rates took twice the operations.
    unknowns = {name for solve in equations.exact.solves for name in solve.names}
    for defined, value in definitions.items():
        if defined in unknowns:
            slopes[graph.symbol(defined)] = {defined: graph.number(1)}
        elif defined not in equations.intermediates:
            slopes[graph.symbol(defined)] = graph.derivative(value, slopes)
    first, factors_of = 0, iter(values[n + len(residuals) :])
    for solve, places in zip(equations.exact.solves, factors_of_solves(equations), strict=True):
        own = [rows.get(first + k, {}) for k in range(len(solve.names))]
        right = [_differentiate_through(graph, row, slopes, columns) for row in own]
        own_factors = {place: next(factors_of) for place in places}
        if solve.is_loop:
            solved |= _solve_by_loop(graph, solve, columns, right, definitions)
        else:
            solved |= _solve_slopes(graph, solve, columns, right, own_factors)
        first += len(solve.names)
    outputs = []
    for output, value in zip(rhs.outputs, values[:n], strict=False):
        slope = graph.derivative(value, slopes)
        outputs += [(f"d({output.label})/d{x}", _total(graph, slope, solved, x)) for x in columns]

    def program() -> Program:
        naming = Naming(graph, list(definitions.items()), outputs, rhs.parameters)
        shape = (n,) if along else (n, len(columns))
        return naming.program(name, shape, **rhs.arrays | {"state": (*rhs.state, *along)})

    computed = program()
    zeros = find_hidden_zeros(computed, equations)
    for place in zeros:
        outputs[place] = outputs[place][0], graph.number(0)
    return program() if zeros else computed


def _differentiate_through(
    graph: Graph, row: Mapping[str, int], slopes: Mapping[int, Slopes], columns: Sequence[str]
) -> list[int]:
    """Derivatives of a residual by each column, through definitions too."""
    found = []
    for name in columns:
        addends = []
        for by, slope in row.items():
            inner = slopes[graph.symbol(by)]
            if name in inner:
                addends.append(graph.multiply(slope, inner[name]))
        found.append(graph.sum(addends))
    return found


def _total(graph: Graph, slope: Slopes, solved: Mapping[str, Slopes], name: str) -> int:
    """The derivative by a variable, through the unknowns that depend on it."""
    through = [
        graph.multiply(slope[unknown], inner[name])
        for unknown, inner in solved.items()
        if unknown in slope and name in inner
    ]
    direct = [slope[name]] if name in slope else []
    return graph.sum([*direct, *through])


def _insert_definitions(
    graph: Graph, rhs: Program, defined: set[str]
) -> tuple[dict[str, int], list[int]]:
    """The nodes of the definitions by name, and of the outputs; temporaries are written out."""
    definitions: dict[str, int] = {}
    temporaries: dict[str, int] = {}
    for statement in rhs.statements:
        known = definitions if statement.name in defined else temporaries
        known[statement.name] = graph.insert(statement.value, temporaries)
    return definitions, [graph.insert(output.value, temporaries) for output in rhs.outputs]


def _solve_by_loop(
    graph: Graph,
    solve: Solve,
    variables: Sequence[str],
    residuals: Sequence[Sequence[int]],
    definitions: Mapping[str, int],
) -> dict[str, Slopes]:
    """``x' = A^-1 r`` by the loop that gave x; see `_solve_slopes`."""
    slopes: dict[str, Slopes] = {name: {} for name in solve.names}
    for column, component in enumerate(variables):
        right = [row[column] for row in residuals]
        if all(map(graph.is_zero, right)):
            continue
        unknown = next(definitions[name] for name in solve.names if name in definitions)
        factors = graph.operands[graph.operands[unknown][0]][0]
        solution = graph.solution(factors, right)
        for place, name in enumerate(solve.names):
            slopes[name][component] = graph.item(solution, place)
    return slopes


def _solve_slopes(
    graph: Graph,
    solve: Solve,
    variables: Sequence[str],
    residuals: Sequence[Sequence[int]],
    factors: Mapping[tuple[int, int], int],
) -> dict[str, Slopes]:
    """``x' = A^-1 r`` by L, D and U for each variable: slopes by unknown.

    Args:
        graph: Where L, D and U are.
        solve: What is solved.
        variables: Their names.
        residuals: r, a row for each unknown, a column for each variable.
        factors: L below the diagonal, U above it and one over D on it, zeros left out.
    """
    size = range(len(solve.names))

    def less(start: int, terms: Iterable[tuple[int, int]]) -> int:
        products = (graph.negate(graph.multiply(a, b)) for a, b in terms)
        return graph.sum([start, *(p for p in products if not graph.is_zero(p))])

    slopes: dict[str, Slopes] = {name: {} for name in solve.names}
    for column, component in enumerate(variables):
        y: list[int] = []
        for i in size:
            before = [(factors[i, k], y[k]) for k in size[:i] if (i, k) in factors]
            y.append(less(residuals[i][column], before))
        x: dict[int, int] = {}
        for i in reversed(size):
            after = [(factors[i, k], x[k]) for k in size[i + 1 :] if (i, k) in factors]
            x[i] = less(graph.multiply(y[i], factors[i, i]), after)
            if not graph.is_zero(x[i]):
                slopes[solve.names[i]][component] = x[i]
    return slopes
