"""Render, solvers: the recurrences of a system arranged for the templates of its solvers.

Comes in: the Program of the rates. Goes out: a `SolverText`, plain records that templates loop
over. Names of coefficients are written with their order, ``Pi1[_k]``; C and NumPy read them alike.
Read next: ``templates/c/solver.c.j2``, and `coadjoint.solve.steps`, the methods in NumPy.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from functools import reduce
from itertools import islice, pairwise
from typing import Any

from coadjoint.derive.mechanics.iteration import is_guess
from coadjoint.elementary import ELEMENTARY
from coadjoint.lower import normals
from coadjoint.lower.jets import Cell, Jets, make_jets
from coadjoint.lower.joined import join, rename, widen
from coadjoint.lower.mapped import list_maps
from coadjoint.lower.orbits import find_spheres, stays_on_orbits
from coadjoint.lower.polynomials import product_of, sum_of
from coadjoint.lower.program import (
    ONE,
    ZERO,
    Add,
    Call,
    Divide,
    Factors,
    Item,
    Multiply,
    Negate,
    Node,
    Number,
    Program,
    Solution,
    Symbol,
    Table,
    children,
    walk,
    with_children,
)
from coadjoint.lower.stars import Stars, find_stars, make_looped_jets
from coadjoint.methods import ACTION, ASKED, list_structured
from coadjoint.solve.methods import (
    average_gradient,
    coadjoint_mean,
    discrete_gradient,
    spherical_midpoint,
)
from coadjoint.solve.methods.gauss import TABLEAUS
from coadjoint.solve.methods.lie_poisson import COMPOSITIONS
from coadjoint.solver_kinds import SOLVER, SolverKind

#: Sums that one loop runs over: as many as vector registers hold with their factors.
SUMS = 16
#: Sums among which the next one of a loop is looked for.
NEAR = 40
#: The factor m of the sums of logarithms, exponentials, sines and cosines.
_WEIGHT = Symbol("_orders[_m]")


@dataclass(frozen=True)
class Line:
    """``name = value``.

    Attributes:
        name: What is assigned: a name of its own, or an entry of an array.
        value: What is computed.
    """

    name: str
    value: Node

    @property
    def is_new(self) -> bool:
        """Whether the name is one of its own, which C declares."""
        return "[" not in self.name


@dataclass(frozen=True)
class Stage:
    """What is computed at an order k > 0 in one loop, and after it.

    Attributes:
        starts: Sums, which are zero.
        terms: Sums with what is added for each 0 < m < k.
        lines: What follows from them.
    """

    starts: tuple[Line, ...]
    terms: tuple[Line, ...]
    lines: tuple[Line, ...]


@dataclass(frozen=True)
class LoopText:
    """What recurrences loop over where the rates do.

    Attributes:
        table: The table of the rates.
        stars: The products of its components.
        scales: Names of what scaled values are times.
    """

    table: Table
    stars: Stars
    scales: tuple[str, ...]

    @property
    def sizes(self) -> dict[str, int]:
        """How many there are of what loops run over."""
        return {
            "VALUES": len(self.table.vectors[0]),
            "ENTRIES": len(self.table.entries),
            "STARS": len(self.stars.left),
            "TERMS": len(self.stars.rows),
        }

    @property
    def star_sizes(self) -> list[int]:
        """How many products stars have."""
        return sorted({end - start for start, end in pairwise(self.stars.starts)})

    @property
    def numbers(self) -> dict[str, tuple[float, ...]]:
        """The tables by name."""
        stars = {f"star_{each.name}": getattr(self.stars, each.name) for each in fields(Stars)}
        return {**self.table.columns(), **stars}


@dataclass(frozen=True)
class SolverText:
    """The recurrences of a system as templates print them.

    Attributes:
        fixed: What depends on parameters alone.
        kept: Names of arrays of coefficients, those of the state and of what drives it left out.
        first: Order 0 of all, and order 1 of the state.
        stages: Each order k > 0.
        rates: Coefficients of the state at the order k + 1.
        functions: Elementary functions that are called, with their arguments, sqrt left out.
        products: How many sums there are.
        operations: How many operations the rates take where parameters are fixed.
        reads: Names that the recurrences read.
        fixed_reads: Names that ``fixed`` reads.
        branches: Whether the rates call functions of what moves that have branch points or jumps,
            as sqrt and log. A motion may be analytic there.
        shared: What other functions need of the parameters alone, which follows what is `fixed`.
        shared_reads: Names that ``shared`` reads.
        loops: What `first`, `stages` and `rates` are printed as, where these are loops.
        kinks: What the sides are those of, which are the last parameters; None for no sides.
        unknowns: The largest number of unknowns that a loop solves for; 0 without loops.
    """

    fixed: tuple[Line, ...]
    kept: tuple[str, ...]
    first: tuple[Line, ...]
    stages: tuple[Stage, ...]
    rates: tuple[Line, ...]
    functions: tuple[tuple[str, str], ...]
    products: int
    operations: int
    reads: frozenset[str]
    fixed_reads: frozenset[str]
    branches: bool
    shared: tuple[Line, ...] = ()
    shared_reads: frozenset[str] = frozenset()
    loops: LoopText | None = None
    kinks: Program | None = None
    unknowns: int = 0


def count_unknowns(programs: Iterable[Program]) -> int:
    """The largest number of unknowns that a loop solves for; 0 without loops."""
    values = (value for program in programs for value in program.values())
    return max((value.size for value in values if isinstance(value, Factors)), default=0)


def arrange(programs: Mapping[str, Program], *, is_written_out: bool = True) -> SolverText:
    """The recurrences of the rates of a system as its templates print them.

    Args:
        programs: As `select_programs` has them.
        is_written_out: Whether to write out what is printed as loops.
    """
    rates = programs["rates"]
    if rates.table is None:
        return _arrange(programs, make_jets(rates.factored or rates), (), _begin(rates))
    stars = find_stars(rates.table)
    jets, weights = make_looped_jets(rates, stars, is_written_out=is_written_out)
    names = tuple(statement.name for statement in jets.fixed[-len(rates.table.scaled) :])
    lines = tuple(Line(statement.name, statement.value) for statement in weights)
    loops = LoopText(table=rates.table, stars=stars, scales=names)
    return replace(
        _arrange(programs, jets, lines),
        loops=loops,
        products=len(list(stars.products())),
        operations=3 * len(rates.table.entries) + len(rates.table.scaled),
    )


def _begin(rates: Program) -> list[Line]:
    """Order 0 of what recurrences carry and the state does not have: velocities of iterations."""
    form, lines = rates.factored or rates, list[Line]()
    carried = form.state[len(rates.state) :]
    names = {name: f"{name}[0]" for name in (*rates.state, *rates.inputs, *rates.time, *carried)}
    if not carried:
        return []
    for statement in rates.statements_at("member"):
        own = statement.name if is_guess(statement.name) else f"_s{statement.name}"
        names.setdefault(statement.name, own)
        lines.append(Line(names[statement.name], rename(statement.value, names)))
    last = max(n for n, line in enumerate(lines) if line.name in {f"{each}[0]" for each in carried})
    return lines[: last + 1]


def _arrange(
    programs: Mapping[str, Program],
    jets: Jets,
    weights: tuple[Line, ...],
    begin: Sequence[Line] = (),
) -> SolverText:
    """The lines of recurrences; weights come before them, and what they begin with."""
    arrays = jets.kept.union(jets.state, jets.driving)
    carried = jets.state[len(programs["rates"].state) :]
    first = [*weights, *begin, *arrange_first(jets, arrays)]
    stages = tuple(arrange_stages(jets, arrays, is_one_loop=bool(weights)))
    rates = tuple(
        Line(f"{name}[_k + 1]", _next(tail, arrays))
        for name, (_, tail) in zip(jets.state, jets.rates, strict=bool(jets.rates))
    )
    lines = [*first, *rates]
    lines += [line for s in stages for line in (*s.starts, *s.terms, *s.lines)]
    others = [programs[name] for name in list_sharing(programs)]
    shared = [Line(s.name, s.value) for each in others for s in each.statements_at("parameters")]
    calls = {n.function for line in lines for n in walk(line.value) if isinstance(n, Call)}
    branches = any(ELEMENTARY[each].positive or ELEMENTARY[each].jumps[0] for each in calls)
    values = (value for program in programs.values() for value in program.values())
    calls |= {n.function for value in values for n in walk(value) if isinstance(n, Call)}
    fixed = tuple(Line(statement.name, statement.value) for statement in jets.fixed)
    return SolverText(
        fixed=fixed,
        kept=(*carried, *(cell.name for cell in jets.cells if cell.name in arrays)),
        first=tuple(first),
        stages=stages,
        rates=rates,
        functions=tuple((f, "ab"[: ELEMENTARY[f].arity]) for f in sorted(calls - {"sqrt"})),
        products=jets.products,
        operations=_count(arrange_function("rates", programs["rates"])),
        reads=_reads(lines),
        fixed_reads=_reads(fixed),
        branches=branches,
        shared=tuple(shared),
        shared_reads=_reads(shared),
        kinks=programs.get("kinks"),
        unknowns=count_unknowns(programs.values()),
    )


@dataclass(frozen=True)
class FunctionText:
    """A Program as lines.

    Attributes:
        lines: Statements, then rows of the result.
        reads: Names that they read.
    """

    lines: tuple[Line, ...]
    reads: frozenset[str]


def select_programs(
    programs: Iterable[Program], kind: SolverKind = SOLVER, maps: Iterable[Program] = ()
) -> dict[str, Program]:
    """The rates, what bounds the motion, noise and maps, by their names in the texts of solvers.

    Where a motion is made of a bracket and an energy, also these.

    Args:
        programs: The functions of the kernel.
        kind: What is integrated. What is reconstructed has no bounds, and a projection leaves it.
        maps: What explicit methods make a step of, which is of the state alone.
    """
    known = {program.name: program for program in programs}
    rates = reduce(join, (known[name] for name in kind.rates))
    others = ("domain", "projection", "noise")
    bounds = {name: known[name] for name in others if name in known}
    has_action = {*ACTION} <= known.keys() and kind == SOLVER and "noise" not in known
    action = [name for name in ASKED if name in known] if has_action else []
    return {
        "rates": rates,
        **{
            name: widen(program, rates.state, moves=name == "projection")
            for name, program in bounds.items()
        },
        **{name: _with_own_names(known[name]) for name in action},
        **{each.name: _with_own_names(each) for each in maps if kind == SOLVER},
    }


def list_sharing(programs: Iterable[str]) -> list[str]:
    """The functions that share what parameters give with the rates, but for the rates."""
    names = tuple(programs)
    return [*list_maps(names), *(name for name in names if name in ASKED)]


def _with_own_names(program: Program) -> Program:
    """A function with names of its own, since all of them share what parameters give."""
    names = {each.name: f"_{program.name}{each.name}" for each in program.statements}
    statements = tuple(
        replace(each, name=names.get(each.name, each.name), value=rename(each.value, names))
        for each in program.statements
    )
    outputs = tuple(replace(each, value=rename(each.value, names)) for each in program.outputs)
    return replace(program, statements=statements, outputs=outputs)


def describe_noise(programs: Mapping[str, Program]) -> dict[str, Any]:
    """What templates read of noise: how many Wiener processes there are, and the tables of normals.

    Args:
        programs: As `select_programs` has them.
    """
    program = programs.get("noise")
    names = ("ROUNDS", "MULTIPLIERS", "WEYL", "SERIES", "LOG2", "MIDDLE", "TAIL", "FAR")
    return {
        "noise": 0 if program is None else len(program.outputs) // len(program.state),
        "sweeps": normals.SWEEPS,
        "normals": {name: getattr(normals, name) for name in names},
    }


def describe_structured(programs: Mapping[str, Program]) -> dict[str, Any]:
    """What templates read of methods that keep structure, under one name.

    Args:
        programs: As `select_programs` has them, with kinks.
    """
    bracket = programs.get("bracket_vector")
    on_orbits = bracket is not None and stays_on_orbits({**programs, "rhs": programs["rates"]})
    spheres = find_spheres(programs) if on_orbits else ()
    marks = {"orbits": on_orbits, "spheres": bool(spheres)}
    methods = list_structured([*programs, *(name for name, is_so in marks.items() if is_so)])
    state = () if bracket is None else bracket.state
    composed = [each for each in methods if each.file != "gauss"]
    orders = sorted({each.order for each in composed})
    return {
        "structured": {
            "methods": methods,
            "names": {each.macro: (each.file, each.order) for each in composed},
            "stages": {order: list(map(repr, COMPOSITIONS[order])) for order in orders},
            "has_bracket": bracket is not None,
            "acting": [name for name in ASKED if name in programs],
            "spheres": spheres,
            "near": spherical_midpoint.NEAR,
            # names of a vector below the state, with their rows
            "vector": [*enumerate(state)][len(state) // 2 :],
            "gradients": {
                "NODES": average_gradient.NODES,
                "ROUNDINGS": discrete_gradient.ROUNDINGS,
                "NEAR": discrete_gradient.NEAR,
            },
            "mean": {name: getattr(coadjoint_mean, name) for name in ("TERMS", "LEAST", "PARTS")},
            "tableaus": {
                each.macro: TABLEAUS[each.order] for each in methods if each.file == "gauss"
            },
            "sweeps": normals.SWEEPS,
        }
    }


def arrange_function(name: str, program: Program) -> FunctionText:
    """The lines of a Program, whose rows go to ``_rows``.

    Args:
        name: Its name in a solver. Of rates and of what `list_sharing` has, what depends on
            parameters alone is left out.
        program: What to arrange.
    """
    if program.table is not None:  # the template has the loops
        return FunctionText((), frozenset())
    shares = name == "rates" or list_sharing([name])
    statements = program.statements_at("member") if shares else program.statements
    lines = [Line(statement.name, statement.value) for statement in statements]
    lines += [Line(f"_rows[{row}]", each.value) for row, each in enumerate(program.outputs)]
    return FunctionText(tuple(lines), _reads(lines))


def arrange_map(program: Program) -> FunctionText:
    """The lines of a map with what it needs of the parameters, as the twin in NumPy has them."""
    shared = [Line(each.name, each.value) for each in program.statements_at("parameters")]
    lines = (*shared, *arrange_function(program.name, program).lines)
    return FunctionText(lines, _reads(lines))


def _count(function: FunctionText) -> int:
    """The operations of a function."""
    leaves = Symbol | Number
    return sum(not isinstance(n, leaves) for line in function.lines for n in walk(line.value))


def _reads(lines: Iterable[Line]) -> frozenset[str]:
    """The names that lines read, without their orders."""
    nodes = (node for line in lines for node in walk(line.value))
    return frozenset(node.name.split("[")[0] for node in nodes if isinstance(node, Symbol))


def set_order(node: Node, order: str, arrays: frozenset[str]) -> Node:
    """A node with the coefficients of one order in the place of names."""
    match node:
        case Symbol(name=name):
            return Symbol(f"{name}[{order}]") if name in arrays else node
        case Negate(operand=operand):
            return Negate(set_order(operand, order, arrays))
        case Call(function=function):
            return Call(function, *(set_order(each, order, arrays) for each in children(node)))
        case Add(left=left, right=right) | Multiply(left=left, right=right):
            return type(node)(set_order(left, order, arrays), set_order(right, order, arrays))
        case Divide(left=left, right=right):
            return Divide(set_order(left, order, arrays), set_order(right, order, arrays))
        case Factors() | Solution() | Item():
            return with_children(node, (set_order(each, order, arrays) for each in children(node)))
    return node


def _next(tail: Node, arrays: frozenset[str]) -> Node:
    """A coefficient of the state, from its rate; zero where the rate is constant."""
    if tail == ZERO:
        return ZERO
    return Multiply(Symbol("_parts[_k + 1]"), set_order(tail, "_k", arrays))


def arrange_first(jets: Jets, arrays: frozenset[str]) -> Iterator[Line]:
    """Order 0 of all cells, and the rates."""
    for cell in jets.cells:
        yield _line(cell.name, "0", set_order(cell.value, "0", arrays), arrays)
        divisor = _divisor(cell)
        if divisor is not None:
            yield Line(f"{cell.name}_r", Divide(ONE, set_order(divisor, "0", arrays)))
    for name, (whole, _) in zip(jets.state, jets.rates, strict=bool(jets.rates)):
        yield Line(f"{name}[1]", set_order(whole, "0", arrays))


def _divisor(cell: Cell) -> Node | None:
    """What all later orders of a cell are divided by; None for no such thing."""
    match cell.value:
        case Divide(right=right) if cell.tail is None:
            return right
        case Call(function="sqrt"):
            return Multiply(Number(Fraction(2)), Symbol(cell.name))
        case Call() if cell.divisor:
            return Symbol(cell.divisor)
    return None


def _line(name: str, order: str, value: Node, arrays: frozenset[str]) -> Line:
    """An entry of an array where all orders are kept, else a name."""
    return Line(f"{name}[{order}]" if name in arrays else name, value)


def arrange_stages(jets: Jets, arrays: frozenset[str], *, is_one_loop: bool) -> Iterator[Stage]:
    """The loops of an order k > 0, and the coefficients that follow from their sums.

    The terms of a loop are known when the order begins, whatever depends on what.
    """
    terms, lines = dict[str, Node](), list[Line]()
    for cell in jets.cells:
        if isinstance(cell.value, Factors):  # those of order 0 serve all orders
            continue
        if isinstance(cell.value, Solution):
            own, value = _solve_order(cell, cell.value, jets, arrays)
            terms |= own
        elif cell.tail is None:
            total = f"{cell.name}_s"
            terms[total], value = _recurrence(cell, Symbol(total), jets, arrays)
        else:
            value = set_order(cell.tail, "_k", arrays)
        lines.append(_line(cell.name, "_k", value, arrays))
    for loop in [list(terms.items())] if is_one_loop else _loops(terms):
        sums = tuple(Line(name, Add(Symbol(name), term)) for name, term in loop)
        yield Stage(tuple(Line(name, ZERO) for name, _ in loop), sums, ())
    yield Stage((), (), tuple(_without_unread(lines, [*terms.values(), *_rates(jets, arrays)])))


def _rates(jets: Jets, arrays: frozenset[str]) -> Iterator[Node]:
    """The rates of the state at an order k > 0."""
    return (set_order(tail, "_k", arrays) for _, tail in jets.rates)


def _without_unread(lines: list[Line], others: list[Node]) -> list[Line]:
    """Lines but for names that nothing reads, as the arguments of signs at orders k > 0."""
    kept, read = list[Line](), {name for node in others for name in list_names(node)}
    for line in reversed(lines):
        if not line.is_new or line.name in read:
            kept.append(line)
            read.update(list_names(line.value))
    return kept[::-1]


def _loops(terms: dict[str, Node]) -> Iterator[list[tuple[str, Node]]]:
    """Terms by loops, those together that read the same coefficients, which are loaded once."""
    rest = {
        name: [(form, frozenset(list_names(form))) for form in (term, *_turned(term))]
        for name, term in terms.items()
    }
    while rest:
        loop, loaded = list[tuple[str, Node]](), frozenset[str]()
        while rest and len(loop) < SUMS:
            near = islice(rest.items(), NEAR)
            candidates = ((name, *form) for name, forms in near for form in forms)
            name, term, read = min(candidates, key=lambda each: len(each[2] - loaded))
            loop.append((name, term))
            loaded |= read
            del rest[name]
        yield loop


def _turned(term: Node) -> Iterator[Node]:
    """The same sum from its other end, where no weight tells the ends apart."""
    match term:
        case Multiply(left=Symbol(name=a), right=Symbol(name=b)):
            first, second = a.removesuffix("[_m]"), b.removesuffix("[_k - _m]")
            yield Multiply(Symbol(f"{second}[_m]"), Symbol(f"{first}[_k - _m]"))


def list_names(node: Node) -> Iterator[str]:
    """The names that a node reads, with their orders."""
    return (each.name for each in walk(node) if isinstance(each, Symbol))


def _recurrence(cell: Cell, total: Symbol, jets: Jets, arrays: frozenset[str]) -> tuple[Node, Node]:
    """What is added to the sum of a cell for each m < k, and the coefficient that follows.

    What is known last comes last: a processor can add the rest while it waits.
    """
    name, reciprocal, part = cell.name, Symbol(f"{cell.name}_r"), Symbol("_parts[_k]")

    def term(left: str, right: str, *weight: Symbol) -> Node:
        return product_of([*weight, Symbol(f"{left}[_m]"), Symbol(f"{right}[_k - _m]")])

    def ends(left: str, right: str) -> Node:
        return Multiply(Symbol(f"{left}[_k]"), Symbol(f"{right}[0]"))

    match cell.value:
        case Multiply(left=Symbol(name=a), right=Symbol(name=b)):
            return term(a, b), Add(Add(total, ends(b, a)), ends(a, b))
        case Divide(left=above, right=Symbol(name=b)):
            moves = isinstance(above, Symbol) and above.name in jets.moving
            known = Add(set_order(above, "_k", arrays), Negate(total)) if moves else Negate(total)
            return term(b, name), Multiply(Add(known, Negate(ends(b, name))), reciprocal)
        case Call(function="sqrt", argument=argument):
            rest = Add(set_order(argument, "_k", arrays), Negate(total))
            return term(name, name), Multiply(rest, reciprocal)
        case Call(argument=Symbol(name=a), other=None):
            ((factor, minus),) = cell.factors
            if not cell.divisor:
                whole = Add(Multiply(part, total), ends(a, factor))
                return term(a, factor, _WEIGHT), Negate(whole) if minus else whole
            if not factor:
                left = sum_of([(minus, Symbol(f"{a}[_k]")), (True, Multiply(part, total))])
                return term(name, cell.divisor, _WEIGHT), Multiply(left, reciprocal)
        case Call() if cell.divisor:
            pairs = list(zip(children(cell.value), cell.factors, strict=True))
            added = [(minus, term(_name_of(a), factor)) for a, (factor, minus) in pairs]
            last = [(minus, ends(_name_of(a), factor)) for a, (factor, minus) in pairs]
            inner = sum_of([*added, (True, term(name, cell.divisor))])
            whole = Add(Multiply(part, total), sum_of(last))
            return Multiply(_WEIGHT, inner), Multiply(whole, reciprocal)
    raise AssertionError(cell)


def _solve_order(
    cell: Cell, solution: Solution, jets: Jets, arrays: frozenset[str]
) -> tuple[dict[str, Node], Node]:
    """The sums of a solution by their names, and the equations of an order k > 0 with them."""
    terms, known = dict[str, Node](), list[Node]()
    for n, (row, tail) in enumerate(
        zip(cell.list_products(jets.moving), cell.tails, strict=True), 1
    ):
        side = set_order(tail, "_k", arrays)
        if row:
            total: Node = Symbol(f"{cell.name}_s{n}")
            inner = (Multiply(Symbol(f"{a}[_m]"), Symbol(f"{x}[_k - _m]")) for a, x in row)
            terms[f"{cell.name}_s{n}"] = sum_of((False, each) for each in inner)
            for a, x in row:
                total = Add(total, Multiply(Symbol(f"{a}[_k]"), Symbol(f"{x}[0]")))
            side = Negate(total) if side == ZERO else Add(side, Negate(total))
        known.append(side)
    return terms, Solution(solution.factors, tuple(known))


def _name_of(node: Node) -> str:
    """The name that a node is."""
    assert isinstance(node, Symbol), node
    return node.name
