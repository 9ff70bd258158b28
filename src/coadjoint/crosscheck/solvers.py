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

from collections.abc import Iterable, Mapping
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from coadjoint.crosscheck.compare import Figures
from coadjoint.crosscheck.points import Array
from coadjoint.crosscheck.recurrences import TRIES, check_recurrences, draw_points
from coadjoint.crosscheck.solver_exact import START, Solvers
from coadjoint.crosscheck.solver_objects import (
    CHOICES,
    Advance,
    Function,
    NumpySolver,
    compile_solver,
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
from coadjoint.crosscheck.solver_text import FILES, SolverTexts, check_solver_texts
from coadjoint.crosscheck.subject import Subject
from coadjoint.lower.program import Program
from coadjoint.render.solvers import arrange, select_programs

#: The objects that are compiled, each once: method, target and build. The builds differ in their
#: flags alone, which one method shows.
OBJECTS: Final = (*((method, "c", "exact") for method in CHOICES), ("taylor", "c-fast", "fast"))
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
    pool: Executor, texts: Mapping[str, str], folder: Path, targets: Iterable[str]
) -> Compiling:
    """Have the objects of some targets compiled in a private folder."""
    return {
        (method, target): pool.submit(compile_solver, texts, folder, method, build)
        for method, target, build in OBJECTS
        if target in targets
    }


def check_solvers(
    subject: Subject, texts: Mapping[str, str], compiling: Compiling
) -> SolverFigures:
    """All rungs of the solvers of a system.

    Args:
        subject: The system.
        texts: Its files by name.
        compiling: What `start_compiling` began.

    Raises:
        CompilerError: An object cannot be compiled.
        CrossCheckError: A rung failed.
    """
    programs = select_programs(subject.programs.values())
    text = arrange(programs)
    printed = SolverTexts(
        programs=programs,
        recurrences=text,
        strict=_list_strict(subject),
        files={file: texts[file] for file in FILES},
        system=subject.system.name,
    )
    coefficients = check_recurrences(text, subject)
    lines = check_solver_texts(printed)
    solvers = Solvers(subject, text, _load(subject, texts["solver.py"], compiling))
    batch = draw_points(subject, TRIES, time=START)
    batch = batch.take(np.arange(max(MEMBERS, batch.size)) % batch.size).take(slice(MEMBERS))
    size = choose_size(solvers, batch)
    steps, choices = check_steps(solvers, batch, size), check_choice(solvers, batch)
    equal, together = dict[str, int](), dict[str, int]()
    if compiling:
        if not text.functions:
            equal = check_bits(solvers, batch, size)
        else:
            together = check_together(solvers, batch, size)
    return SolverFigures(
        coefficients=coefficients,
        lines=lines,
        steps=steps,
        choices=choices,
        equal=equal,
        together=together,
    )


def _list_strict(subject: Subject) -> tuple[bool, ...]:
    """Whether each row of the domain may not be zero."""
    return tuple(bound.strict for bound in getattr(subject.system, "DOMAIN", ()))


def _load(subject: Subject, text: str, compiling: Compiling) -> dict[str, dict[str, Advance]]:
    """What advances members, by method and target."""
    programs = select_programs(subject.programs.values())
    functions = {name: _numpy_function(subject, each) for name, each in programs.items()}
    numpy = NumpySolver(*load_numpy(text), functions, _list_strict(subject))
    advance = {method: {"numpy": numpy.advance(method)} for method in CHOICES}
    for (method, target), made in compiling.items():
        advance[method][target] = load_solver(made.result(), subject.system.name)
    return advance


def _numpy_function(subject: Subject, program: Program) -> Function:
    """A function of the NumPy kernel."""
    inputs, call = len(program.inputs), getattr(subject.system, program.name)

    def function(state: Array, parameters: Array, driving: Array) -> Array:
        given = [state, np.ascontiguousarray(parameters)]
        given += [np.ascontiguousarray(driving[:inputs])] if inputs else []
        named = {"time": np.ascontiguousarray(driving[inputs])} if program.time else {}
        out = np.empty((len(program.outputs), state.shape[1]))
        call(*given, **named, target="numpy", out=out)
        return out

    return function
