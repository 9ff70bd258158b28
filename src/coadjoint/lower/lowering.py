"""Lowering: Equations become Programs, one for each function of the kernels.

Comes in: Equations. Goes out: a Program for each of the `coadjoint.kernel_functions` that the
equations have.
Definitions keep their names: a kernel reads like the book.
Read next: `coadjoint.lower.check`, which undoes all this exactly.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from itertools import groupby
from typing import Final

from coadjoint.derive import Equations
from coadjoint.derive.formulas import Rows, rhs, rows_of
from coadjoint.derive.mechanics.solver import Solve
from coadjoint.exact import Element
from coadjoint.kernel_functions import KERNEL_FUNCTIONS
from coadjoint.limits import C_STATEMENTS
from coadjoint.lower.definitions import inline_single_uses, shorten
from coadjoint.lower.guesses import find_iterations, insert_guess, with_carried_velocities
from coadjoint.lower.jacobian import factors_of_solves, jacobian, residual_slopes
from coadjoint.lower.minors import entries_of, find_solve, is_faster, set_factored, solve_by_minors
from coadjoint.lower.naming import Naming
from coadjoint.lower.nesting import ORDERS
from coadjoint.lower.program import Program
from coadjoint.lower.scales import cost, find_scales
from coadjoint.lower.shared_frames import name_frames, shared_frames
from coadjoint.lower.sums import Lowering
from coadjoint.lower.tables import (
    UNROLLED_PRODUCTS,
    differentiate_along,
    find_products,
    loop_over,
    loop_rows,
)
from coadjoint.lower.vanishing import find_hidden_zeros

#: Products by which a Jacobian through the solves of the kernel is written out, factors times
#: components of the state; beyond, there is the derivative along a vector in its place. Twelve
#: links of a chain take 3456 (docs/decisions/coupled-velocities.md).
WRITTEN_SLOPES: Final = 4000
#: Rates that cost more are left with the definitions that they have: each try takes as long as
#: lowering them does.
TRIED_COST = 1000


def lower(equations: Equations) -> dict[str, Program]:
    """The Programs of all functions of a system's kernels, by name.

    Jacobians are derivatives of the ``rhs`` Program by forward accumulation, so they share the
    definitions and are as cheap as these make them.
    """
    named = name_frames(equations)
    ways = [equations] if named is equations else [equations, named]
    forms = map(_lower_all, ways)
    programs = min(forms, key=lambda programs: cost(programs["rhs"]))
    return {name: each for name, each in programs.items() if not _is_spared(each)}


def _is_spared(program: Program) -> bool:
    """Whether a function that one method alone asks for is too long for a compiler.

    Then the system goes without this method: matrices of a basis with many entries have a long
    product, and other methods keep the same.
    """
    length = len(program.statements) + len(program.outputs)
    return program.name == "sandwich" and length > C_STATEMENTS


def _lower_all(equations: Equations) -> dict[str, Program]:
    """The same, with the definitions that the equations have."""
    programs: dict[str, Program] = {}
    looped, large = _loop(equations), count_slopes(equations) > WRITTEN_SLOPES
    for name, function in KERNEL_FUNCTIONS.items():
        is_large = looped is not None or (large and function.by == "state")
        if function.looped == ("never" if is_large else "only"):
            continue
        rows = rows_of(equations, name)
        if rows is None:
            continue
        own = None if looped is None else _lower_by_table(name, rows, looped)
        if own is not None:
            programs[name] = own
        elif rows.by:
            programs[name] = _jacobian(name, rows, programs["rhs"])
        else:
            programs[name] = _clear_hidden_zeros(equations, name, rows)
    if looped is None:
        programs["rhs"] = _choose(equations, _scale(equations, programs["rhs"]))
    if equations.guesses:
        programs |= _carry(equations, programs)
    return programs


def _lower_by_table(name: str, rows: Rows, looped: Program) -> Program | None:
    """A function of a system whose rates are loops as a loop; None where it is none."""
    if name == "rhs":
        return looped
    if rows.along:
        return differentiate_along(looped, rows)
    return loop_rows(rows, name, looped) if name in ("energy", "observables") else None


def _loop(equations: Equations) -> Program | None:
    """The rates as loops over a table of coefficients, where they are many products."""
    products = find_products(equations)
    if sum(map(len, products)) <= UNROLLED_PRODUCTS:
        return None
    rows = rhs(equations)
    definitions = equations.definitions_of(rows.elements)
    lowering = Lowering(equations, [element for _, element in definitions])
    named = [(name, lowering.node(element)) for name, element in definitions]
    needed = [(name, lowering.graph.symbol(name)) for name, _ in definitions]
    program = _name(equations, "rhs", lowering, (named, needed), rows.shape, rows.state)
    return loop_over(program, rows, products)


def _carry(equations: Equations, programs: Mapping[str, Program]) -> dict[str, Program]:
    """What moves, with a form in which the velocities of iterations are state, for recurrences."""
    carried, names = with_carried_velocities(equations)
    state, moving = equations.setting.state, carried.exact.rates
    lines = {"rhs": [*zip((*state, *names), moving, strict=True)]}
    rows = {"rhs": (*state, *names)}
    if "reconstruction" in programs:
        lines["reconstruction"] = [*equations.followed]
        rows["reconstruction"] = (*programs["reconstruction"].state, *names)
    found = dict[str, Program]()
    for name, own in lines.items():
        labelled = [(f"d{label}/dt", rate) for label, rate in own]
        form = _program(carried, "rhs", labelled, (len(own),), rows[name])
        found[name] = set_factored(programs[name], form)
    return found


def _choose(equations: Equations, plain: Program) -> Program:
    """The rates without the definitions that cancel one another, found by trying each of them.

    A name is tried with those of the same letters, ``Y1, Y2, Y3``, as vectors have them. What a
    solve names stays.
    """
    rows, best = rhs(equations), plain
    names = [name for name, _ in equations.definitions_of(rows.elements)]
    closed: frozenset[str] = frozenset()
    if cost(plain) > TRIED_COST:
        return plain
    for _, group in groupby(names, key=lambda name: name.rstrip("0123456789_")):
        tried = closed.union(group)
        if tried & equations.intermediates:
            continue
        with suppress(OverflowError):  # functions of other arguments
            program = _program(equations, "rhs", rows.lines, rows.shape, rows.state, closed=tried)
            if cost(program) < cost(best):
                closed, best = tried, program
    nested = 0
    for order in ORDERS:
        program = _program(
            equations, "rhs", rows.lines, rows.shape, rows.state, closed=closed, nested=order
        )
        if cost(program) < cost(best):
            nested, best = order, program
    return _take_minors(equations, best, closed, nested)


def _take_minors(
    equations: Equations, best: Program, closed: frozenset[str], nested: int
) -> Program:
    """The rates with three unknowns by minors, where that takes less time."""
    rows = rhs(equations)
    if (solve := find_solve(equations, rows.lines)) is None:
        return best
    shape, state = rows.shape, rows.state
    program = _program(
        equations, "rhs", rows.lines, shape, state, closed=closed, solve=solve, nested=nested
    )
    return set_factored(program, best) if is_faster(program, best) else best


def _scale(equations: Equations, plain: Program) -> Program:
    """The rates over products of velocities, where that takes fewer operations.

    Jacobians are made of the rates as they were: each product of momenta has one factor to
    differentiate, and a product of velocities has two.
    """
    scales, rows = find_scales(equations), rhs(equations)
    if not scales or plain.statements_at("member"):
        return plain  # velocities are named already
    scaled = _program(equations, "rhs", rows.lines, rows.shape, rows.state, scales)
    return min(plain, scaled, key=cost)


def lower_rows(
    equations: Equations, name: str, lines: Sequence[tuple[str, Element]], state: tuple[str, ...]
) -> Program:
    """One Program from labelled elements, in names of its first argument and of definitions.

    Definitions stand: products of angles, multiplied out, have no end.
    """
    return _program(equations, name, lines, (len(lines),), state, is_short=True)


def _clear_hidden_zeros(equations: Equations, name: str, rows: Rows) -> Program:
    """A Program in which what vanishes everywhere is written as zero, where a row may hide it."""
    program = _program(rows.of, name, rows.lines, rows.shape, rows.state)
    zeros = find_hidden_zeros(program, equations) if rows.may_hide_zeros else []
    if not zeros:
        return program
    lines = list(rows.lines)
    for place in zeros:
        lines[place] = lines[place][0], equations.setting.field.zero
    return _program(rows.of, name, lines, rows.shape, rows.state)


def _jacobian(name: str, rows: Rows, rhs: Program) -> Program:
    """A derivative of the rates: by the state, the inputs or the parameters; or along a vector."""
    equations, field = rows.of, rows.of.setting.field
    state = equations.setting.state
    slopes = residual_slopes(equations, rows.by)
    labelled = [(f"slope {each.row} by {each.by}", each.slope) for each in slopes]
    labelled += [
        (f"factor {i} {k}", value)
        for own_factors in factors_of_solves(equations)
        for (i, k), value in own_factors.items()
    ]
    # what the residuals name has a derivative, whether or not the rates need it
    inner = dict.fromkeys(each.by for each in slopes if each.by not in rows.by)
    labelled += [(by, field[by]) for by in inner]
    lines = [*rows.lines, *labelled]
    wide = _program(equations, "rhs", lines, (len(lines),), state) if labelled else rhs
    return jacobian(name, wide, equations, rows.by, slopes, rows.along)


def count_slopes(equations: Equations) -> int:
    """The products that a Jacobian through all solves takes: factors times components."""
    factors = sum(map(len, factors_of_solves(equations)))
    factors += sum(len(each.block) ** 2 for each in equations.exact.solves if each.is_loop)
    return factors * len(equations.setting.state)


def _program(
    equations: Equations,
    name: str,
    outputs: Sequence[tuple[str, Element]],
    shape: tuple[int, ...],
    state: tuple[str, ...],
    scales: Mapping[str, Element] | None = None,
    closed: frozenset[str] = frozenset(),
    solve: Solve | None = None,
    nested: int = 0,
    *,
    is_short: bool = False,
) -> Program:
    """One Program from labelled elements of names, the state being the first of them."""
    asked = outputs if solve is None else entries_of(solve, outputs)
    shorter = [(n, each if is_short else _shorten(equations, each)) for n, each in asked]
    definitions, parts = inline_single_uses(equations, shorter, closed)
    iterations = find_iterations(equations, definitions)
    curved = [each for newton in iterations for each in newton.curved]
    elements = [*(element for _, element in (*definitions, *parts)), *curved]
    lowering = Lowering(equations, elements, scales, nested)
    named = [(label, lowering.node(element)) for label, element in definitions]
    results = [(label, lowering.node(element)) for label, element in parts]
    guesses = [line for newton in iterations for line in insert_guess(lowering, newton)]
    named = [*guesses, *named]
    if solve is not None:
        lines, results = solve_by_minors(lowering.graph, solve, dict(results), outputs)
        named += lines
    return _name(equations, name, lowering, (named, results), shape, state)


def _shorten(equations: Equations, element: Element) -> Element:
    """An element over fewer terms: multiplied out, or in the names of shared frames."""
    frames, field = shared_frames(equations), equations.setting.field
    if frames is None:
        return shorten(equations, element)
    groups = field.partial_fractions(element)  # each over a divisor of its own
    return field.sum(frames.rewrite(field, shorten(equations, each)) for each in groups)


def _name(
    equations: Equations,
    name: str,
    lowering: Lowering,
    nodes: tuple[Sequence[tuple[str, int]], Sequence[tuple[str, int]]],
    shape: tuple[int, ...],
    state: tuple[str, ...],
) -> Program:
    """One Program from the nodes of definitions and outputs."""
    setting = equations.setting
    naming = Naming(lowering.graph, *nodes, setting.parameters)
    driving = {"inputs": setting.inputs, "time": setting.time}
    return naming.program(name, shape, state=state, parameters=setting.parameters, **driving)
