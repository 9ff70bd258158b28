"""Render, solvers: the recurrences of a system arranged for the templates of its solvers.

Comes in: the Program of the rates. Goes out: a `SolverText`, plain records that templates loop
over. Names of coefficients are written with their order, ``Pi1[_k]``; C and NumPy read them alike.
Read next: ``templates/c/solver.c.j2``, and `coadjoint.solve.steps`, the methods in NumPy.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import reduce
from itertools import pairwise
from typing import Any

from coadjoint.derive.mechanics.iteration import is_guess, slope_place
from coadjoint.elementary import ELEMENTARY
from coadjoint.kernel_functions import KERNEL_FUNCTIONS
from coadjoint.lower import normals
from coadjoint.lower.carriers import find_carriers
from coadjoint.lower.compositions import COMPOSITIONS, list_schedules
from coadjoint.lower.jets import Jets, make_jets
from coadjoint.lower.joined import join, rename, widen
from coadjoint.lower.mapped import list_maps
from coadjoint.lower.orbits import (
    find_scales,
    find_spheres,
    is_carried,
    is_metriplectic,
    is_nambu,
    is_noisy_action,
    stays_on_orbits,
)
from coadjoint.lower.program import (
    Call,
    Factors,
    Number,
    Program,
    Symbol,
    Table,
    walk,
)
from coadjoint.lower.stars import Stars, find_stars, make_looped_jets
from coadjoint.methods import (
    ACTION,
    ASKED,
    JACOBIAN,
    MAPPED,
    TERMS,
    list_noisy,
    list_structured,
)
from coadjoint.render.recurrences import (
    Line,
    Stage,
    arrange_first,
    arrange_stages,
    find_next,
    list_reads,
)
from coadjoint.solve.methods import coadjoint_mean, spherical_midpoint
from coadjoint.solve.methods.discrete_gradient import GRADIENTS
from coadjoint.solve.methods.gauss import TABLEAUS
from coadjoint.solve.methods.lie_poisson import STOPPING
from coadjoint.solver_kinds import SOLVER, SolverKind


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
    """Order 0 of what recurrences carry and the state does not have.

    These are velocities of iterations, and rates of inputs, which are order 1 of the inputs.
    """
    form, lines = rates.factored or rates, list[Line]()
    carried = form.state[len(rates.state) :]
    names = {name: f"{name}[0]" for name in (*rates.state, *rates.inputs, *rates.time, *carried)}
    if not carried:
        return []
    for name in carried:
        if (place := slope_place(name)) is not None:
            lines.append(Line(names[name], Symbol(f"{rates.inputs[place]}[1]")))
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
        Line(f"{name}[_k + 1]", find_next(tail, arrays))
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
        reads=list_reads(lines),
        fixed_reads=list_reads(fixed),
        branches=branches,
        shared=tuple(shared),
        shared_reads=list_reads(shared),
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
    others = ("domain", "projection", "noise", "noise_gradient")
    bounds = {name: known[name] for name in others if name in known}
    slopes = {JACOBIAN: known[JACOBIAN]} if JACOBIAN in known and "noise" not in known else {}
    has_action = {*ACTION} <= known.keys() and kind == SOLVER and "noise" not in known
    action: list[str] = [name for name in ASKED if name in known] if has_action else []
    if is_carried(known) if kind != SOLVER else is_noisy_action(known):
        carried = (*ACTION, "sandwich") if kind != SOLVER else ACTION
        action = [name for name in carried if name in known]
    return {
        "rates": rates,
        **{
            name: widen(program, rates.state, moves=name == "projection")
            for name, program in bounds.items()
        },
        **slopes,
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
    return {
        "noise": 0 if program is None else len(program.outputs) // len(program.state),
        "sweeps": normals.SWEEPS,
        "normals": list_normals(),
    }


def list_normals() -> dict[str, Any]:
    """The tables of random words and normal numbers by their names."""
    names = ("ROUNDS", "MULTIPLIERS", "WEYL", "SERIES", "LOG2", "MIDDLE", "TAIL", "FAR")
    return {name: getattr(normals, name) for name in names}


def describe_structured(programs: Mapping[str, Program]) -> dict[str, Any]:
    """What templates read of methods that keep structure, under one name.

    Args:
        programs: As `select_programs` has them, with kinks.
    """
    bracket = programs.get("bracket_vector")
    state = () if bracket is None else bracket.state
    # of noise, and of what is reconstructed below the state, `select_programs` has asked
    is_noisy = bracket is not None and "noise" in programs
    is_followed = bracket is not None and len(programs["rates"].state) > len(state) // 2
    still = {**programs, "rhs": programs["rates"]}
    on_orbits = is_followed or (bracket is not None and not is_noisy and stays_on_orbits(still))
    spheres = find_spheres(programs) if on_orbits or is_noisy else ()
    scales = find_scales(programs, spheres) if is_followed else ()
    carriers = find_carriers(programs, spheres, scales) if is_followed and spheres else ()
    if is_followed and not carriers:
        spheres = ()
    marks = {
        "orbits": on_orbits,
        "spheres": bool(spheres) and not is_noisy,
        "nambu": is_nambu(still),
        "metriplectic": is_metriplectic(still),
    }
    methods = list_structured([*programs, *(name for name, is_so in marks.items() if is_so)])
    noisy = (*programs, *["orbits"] * is_noisy, *["spheres"] * bool(spheres))
    has_newton = bool(methods) and JACOBIAN in programs
    composed = [each for each in methods if each.file != "gauss"]
    orders = sorted({each.order for each in composed})
    return {
        "structured": {
            "methods": methods,
            "noisy": list_noisy(noisy),
            "mapped": [MAPPED[name] for name in list_schedules(list_maps(programs))],
            "names": {each.macro: (each.file, each.order) for each in composed},
            "stages": {order: list(map(repr, COMPOSITIONS[order])) for order in orders},
            "has_bracket": bracket is not None,
            "known": len(state) // 2 if is_followed else 0,
            "acting": [name for name in ASKED if name in programs],
            "spheres": spheres,
            "carriers": carriers,
            "is_noisy": is_noisy,
            "near": spherical_midpoint.NEAR,
            "roundings": spherical_midpoint.ROUNDINGS,
            # names of a vector below the state, with their rows, and the functions that take one
            "vector": [*enumerate(state)][len(state) // 2 :],
            "with_vector": [
                each.name for each in KERNEL_FUNCTIONS.values() if each.below == "vector"
            ],
            "gradients": GRADIENTS,
            "mean": {name: getattr(coadjoint_mean, name) for name in ("TERMS", "LEAST", "PARTS")},
            "tableaus": {
                each.macro: TABLEAUS[each.order] for each in methods if each.file == "gauss"
            },
            "sweeps": normals.SWEEPS,
            "stopping": STOPPING,
            "has_newton": has_newton,
            "slopes": len(programs[JACOBIAN].state) if has_newton else 0,
            "terms": TERMS,
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
    return FunctionText(tuple(lines), list_reads(lines))


def arrange_map(program: Program) -> FunctionText:
    """The lines of a map with what it needs of the parameters, as the twin in NumPy has them."""
    shared = [Line(each.name, each.value) for each in program.statements_at("parameters")]
    lines = (*shared, *arrange_function(program.name, program).lines)
    return FunctionText(lines, list_reads(lines))


def _count(function: FunctionText) -> int:
    """The operations of a function."""
    leaves = Symbol | Number
    return sum(not isinstance(n, leaves) for line in function.lines for n in walk(line.value))
