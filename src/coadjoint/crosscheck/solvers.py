"""Cross-check, solvers: rungs 2 to 5 for the methods of integration of one system.

Comes in: a `Subject` and the texts of its solvers. Goes out: `SolverFigures`, or a
`CrossCheckError`. Every check counts what it compared, and fails where that is nothing.

    rung 2   the recurrences are the power series of the equations, in 60 digits
    rung 3   the texts read back as recurrences, tableau and template
    rung 4   single steps of NumPy, exact C and fast C against 60 digits
    rung 5   NumPy and exact C agree over some steps

Read next: `coadjoint.crosscheck.recurrences`, then `coadjoint.crosscheck.solver_steps`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from coadjoint.array_types import Array
from coadjoint.crosscheck.compare import Figures
from coadjoint.crosscheck.points import Batch
from coadjoint.crosscheck.recurrences import TRIES, check_recurrences, draw_points
from coadjoint.crosscheck.solver_exact import START, Solvers
from coadjoint.crosscheck.solver_objects import (
    CHOICES,
    COMPILED_MAPS,
    MAPS,
    Advance,
    Function,
    NumpySolver,
    compile_solvers,
    list_compared,
    load_numpy,
    load_solver,
)
from coadjoint.crosscheck.solver_steps import (
    MEMBERS,
    check_bits,
    check_choice,
    check_steps,
    check_together,
    choose_size,
)
from coadjoint.crosscheck.solver_text import SolverTexts, check_solver_texts
from coadjoint.crosscheck.subject import Subject
from coadjoint.crosscheck.whole import make_whole
from coadjoint.elementary import ELEMENTARY
from coadjoint.lower.kinks import hold_sides
from coadjoint.lower.mapped import list_maps
from coadjoint.lower.program import Program
from coadjoint.methods import ASKED, JACOBIAN
from coadjoint.render.kernels import list_called
from coadjoint.render.solvers import arrange, select_programs
from coadjoint.render.targets import BUILDS
from coadjoint.solver_kinds import SOLVER, SolverKind

#: The method whose fast build is compiled as well: builds differ in flags alone, which one shows.
FAST: Final = "taylor"
#: Methods of the exact build in one run of a compiler: fewer runs cost less, and all in one would
#: leave the other processors idle where one system is worked on.
TOGETHER: Final = 6
#: How far points are from the start where constraints are kept and rates have kinks, how many
#: projections move them onto the constraints, and how far they are moved from them in the end.
FROM_START, SETTLING, OFF = 0.25, 5, 2.0**-8
#: What compilers are making, by method and target.
Compiling = Mapping[tuple[str, str], "Future[Path]"]


@dataclass(frozen=True)
class SolverFigures:
    """What was compared of the solvers of a system.

    Attributes:
        coefficients: Coefficients of motions, of recurrences and equations.
        lines: Lines and entries of tables that were read back.
        steps: Largest k of single steps and members, by method and target.
        choices: Steps that the Taylor method chose.
        equal: Numbers with the same bits in NumPy and C, by method.
        together: Members within the bound instead, by method.
    """

    coefficients: int
    lines: int
    steps: Mapping[str, Mapping[str, Figures]]
    choices: int
    equal: Mapping[str, int]
    together: Mapping[str, int]


def start_compiling(
    pool: Executor,
    texts: Mapping[str, str],
    folder: Path,
    system: str,
    targets: Iterable[str],
    kind: SolverKind = SOLVER,
    programs: Mapping[str, Program] | None = None,
) -> Compiling:
    """Have the objects of some targets compiled in a private folder.

    Args:
        pool: Who compiles.
        texts: The files of the system by name.
        folder: Where.
        system: The name of the system.
        targets: What is compared.
        kind: What the solvers integrate.
        programs: As `select_programs` has them, with kinks; None for what all systems have alone.
    """
    spared = {*CHOICES, *MAPS}.difference(COMPILED_MAPS)
    others = (name for name in list_compared(programs or {}) if name not in spared)
    exact = [*CHOICES, *others]
    objects = {"c-fast": ("fast", [[FAST]])}
    objects["c"] = ("exact", [exact[n : n + TOGETHER] for n in range(0, len(exact), TOGETHER)])
    made = dict[tuple[str, str], "Future[Path]"]()
    for target, (build, groups) in objects.items():
        for methods in groups if target in targets else ():
            path = pool.submit(compile_solvers, texts, folder, system, methods, build, kind)
            made |= {(method, target): path for method in methods}
    return made


def check_solvers(
    subject: Subject, texts: Mapping[str, str], compiling: Compiling, kind: SolverKind = SOLVER
) -> SolverFigures:
    """All rungs of the solvers of a system.

    Args:
        subject: The system.
        texts: Its files by name.
        compiling: What `start_compiling` began.
        kind: What the solvers integrate.

    Raises:
        CompilerError: An object cannot be compiled.
        CrossCheckError: A rung failed.
    """
    kernel, base = load_numpy(texts[BUILDS["numpy"].kernel]), subject
    functions = _list_functions(subject, kernel, kind)
    programs = select_programs(subject.programs.values(), kind, subject.maps)
    subject, programs = make_whole(subject, programs, kind), hold_sides(programs)
    text = arrange(programs)
    printed = SolverTexts(
        programs=programs,
        recurrences=text,
        strict=_list_strict(subject),
        files={file: texts[file] for file in kind.files},
        system=subject.system.name,
        kind=kind,
    )
    coefficients = check_recurrences(text, subject)
    lines = check_solver_texts(printed)
    module = load_numpy(texts[kind.files[2]])
    known = len(base.programs["rhs"].state)
    numpy = NumpySolver(module, functions, _list_strict(subject), known)
    advance = _load(subject.system.name, numpy, list_compared(programs), compiling, kind)
    solvers = Solvers(subject=subject, text=text, advance=advance)
    batch = draw_points(subject, TRIES, time=START)
    if text.kinks is not None and "projection" in functions:
        batch = _move_near_constraints(subject, functions["projection"], batch)
    batch = batch.take(np.arange(max(MEMBERS, batch.size)) % batch.size).take(slice(MEMBERS))
    size = choose_size(solvers, batch)
    steps, choices = check_steps(solvers, batch, size), check_choice(solvers, batch)
    equal, together = dict[str, int](), dict[str, int]()
    if compiling:
        methods = _list_equal(programs, [each for each in advance if "c" in advance[each]])
        others = [each for each in advance if "c" in advance[each] and each not in methods]
        equal = check_bits(solvers, batch, size, methods) if methods else equal
        together = check_together(solvers, batch, size, others) if others else together
    return SolverFigures(
        coefficients=coefficients,
        lines=lines,
        steps=steps,
        choices=choices,
        equal=equal,
        together=together,
    )


def _move_near_constraints(subject: Subject, project: Function, batch: Batch) -> Batch:
    """Points near the constraints and the start of a system, at which the rates have a value.

    Far from constraints a step of Newton's method, which a projection is, may lead to the other
    side of a kink: ``q*(3 - |q|^2)/2`` turns a quaternion round whose square is above 3. No motion
    comes there.
    """
    state, rows = batch.state.copy(), len(subject.programs["projection"].state)
    given = [batch.parameters]
    given.append(np.concatenate([batch.arrays[n] for n in batch.driving] or [np.empty((0, 0))]))
    begin = [q.default or (0.0,) * len(q.components) for q in subject.system.STATE.values()]
    start = np.concatenate(begin)[:rows, np.newaxis]
    with np.errstate(all="ignore"):
        own = state[:rows]
        moved = ~np.isclose(project(state, *given)[:rows], own).all(axis=1)
        away = OFF * own[moved]
        own[moved] = start[moved] + FROM_START * own[moved]
        for _ in range(SETTLING):
            own[:] = project(state, *given)[:rows]
        own[moved] += away
    near = Batch({**batch.arrays, "state": state})
    usable = np.flatnonzero(subject.is_defined("rhs", near))
    return near.take(usable) if usable.size else batch


def _list_equal(programs: Mapping[str, Program], methods: Iterable[str]) -> list[str]:
    """The methods whose bits are promised: nothing that they call depends on a library."""
    maps = {name: programs[name] for name in list_maps(programs)}
    others = [each for name, each in programs.items() if name not in maps]
    return [
        each
        for each in methods
        if all(
            ELEMENTARY[function].is_exact
            for function in list_called([*others, *(maps.values() if each in MAPS else ())])
        )
    ]


def _list_strict(subject: Subject) -> tuple[bool, ...]:
    """Whether each row of the domain may not be zero."""
    return tuple(bound.strict for bound in getattr(subject.system, "DOMAIN", ()))


def _load(
    system: str,
    numpy: NumpySolver,
    methods: Iterable[str],
    compiling: Compiling,
    kind: SolverKind,
) -> dict[str, dict[str, Advance]]:
    """What advances members, by method and target."""
    advance = {method: {"numpy": numpy.advance(method)} for method in methods}
    for (method, target), made in compiling.items():
        advance[method][target] = load_solver(made.result(), system, method, kind)
    return advance


def _list_functions(
    subject: Subject, kernel: Mapping[str, Any], kind: SolverKind
) -> dict[str, Function]:
    """The functions of the NumPy kernel by their names in the texts of solvers."""
    others = ("domain", "projection", "noise", "noise_gradient", JACOBIAN, *ASKED)
    bounds = [name for name in others if name in subject.programs]
    found = {name: _numpy_function(subject, kernel, (name,)) for name in bounds}
    found["rates"] = _numpy_function(subject, kernel, kind.rates)
    if "projection" in found and kind != SOLVER:
        found["projection"] = _leave_below(found["projection"], subject.programs["rhs"])
    return found


def _numpy_function(subject: Subject, kernel: Mapping[str, Any], names: Sequence[str]) -> Function:
    """The rows of some functions of the NumPy kernel, one below the other.

    They are called thousands of times for few members, so that checks of arguments would show.
    """
    programs = [subject.programs[name] for name in names]
    inputs, has_time = len(programs[0].inputs), bool(programs[0].time)

    def function(state: Array, parameters: Array, driving: Array) -> Array:
        given = (driving[:inputs],) if inputs else ()
        named = {"time": driving[inputs]} if has_time else {}
        blocks = (
            kernel[each.name](state[: len(each.state)], parameters, *given, **named)
            for each in programs
        )
        return np.concatenate([block.reshape(-1, state.shape[1]) for block in blocks])

    return function


def _leave_below(project: Function, rates: Program) -> Function:
    """A projection that leaves what is reconstructed as it is."""

    def function(state: Array, parameters: Array, driving: Array) -> Array:
        n = len(rates.state)
        return np.concatenate([project(state[:n], parameters, driving), state[n:]])

    return function
