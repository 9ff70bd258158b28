"""Render: Programs and names of one system become the files of its generated folder.

Comes in: a `KernelContext`, which holds all that a generated file says. Goes out: text by file
name. The choice of what to print is made here, in plain records; the templates loop and print.
Read next: `coadjoint.render.targets`, then `coadjoint.render.write`.
"""

from __future__ import annotations

import hashlib
import json
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from typing import Any, Final

from coadjoint.declared import CLOCK, Bound, KernelContext, Quantity
from coadjoint.elementary import ELEMENTARY
from coadjoint.kernel_functions import KERNEL_FUNCTIONS
from coadjoint.lower.compositions import list_schedules
from coadjoint.lower.kinks import hold_sides
from coadjoint.lower.mapped import list_maps, list_moved
from coadjoint.lower.program import (
    FUNCTIONS,
    ZERO,
    Output,
    Program,
    Statement,
    operation,
    walk,
)
from coadjoint.lower.tableau import dop853
from coadjoint.methods import JudgedMethod
from coadjoint.render.environment import render_templates
from coadjoint.render.printers import WIDTH, Printer
from coadjoint.render.solvers import (
    arrange,
    arrange_function,
    arrange_map,
    count_unknowns,
    describe_noise,
    describe_structured,
    select_programs,
)
from coadjoint.render.tables import arrange_table, fill, tell_loops
from coadjoint.render.targets import TARGETS
from coadjoint.solver_kinds import FILES, SOLVER, SolverKind, list_kinds

#: Template of each rendered file.
TEMPLATES: Final = {
    "__init__.py": "package/__init__.py.j2",
    "__main__.py": "package/__main__.py.j2",
} | {file: template for target in TARGETS.values() for file, template in target.files.items()}

#: Where the id is to stand; no name, unit or number has these marks.
PLACE: Final = "<the 16 letters>"

NO_LICENSE: Final = "The licence of this file is that of its spec; coadjoint claims none."

#: Members that the NumPy kernel evaluates at a time (measured: docs/decisions/numpy-kernels.md).
CHUNK: Final = 11_000


@dataclass(frozen=True)
class Row:
    """One component of an input: its row, name and unit."""

    index: int
    name: str
    unit: str


@dataclass(frozen=True)
class Function:
    """One Program, arranged for the templates.

    Attributes:
        name: Name in Python; in C the system's name stands before it.
        summary: What it is, with its shape.
        costs: Its operation counts, as lines.
        shape: Shape for one member, as Python text.
        size: Number of its results.
        result: What a function of plain Python makes of the list of them.
        rows: How many rows its first argument has, the state and what may follow.
        state: Components of the state that it reads.
        parameters: Components of the parameters that it reads.
        driving: Components of inputs and time that it reads, by array, as far as it takes them.
        python_inputs: The lines that take these from each array in Python.
        of_parameters: Statements that depend on parameters alone.
        of_member: The other statements.
        outputs: Row and value of the results, those left out that are zero everywhere.
        zeros: Their rows, as lines of numbers with commas. Large Jacobians and Poisson tensors are
            mostly zero, and compilers take twice the time where each zero is a statement.
        passes: The vectors of each pass over the table, if it loops over one; `of_member` and
            `outputs` are empty then.
        vectors: How many vectors there are.
        first: Its first row in the table of the kernel.
        scales: What the scaled values are times, in order, where it does.
    """

    name: str
    summary: str
    costs: list[str]
    shape: str
    size: int
    result: str
    rows: int
    state: tuple[Row, ...]
    parameters: tuple[Row, ...]
    driving: dict[str, tuple[Row, ...]]
    python_inputs: dict[str, list[str]]
    of_parameters: tuple[Statement, ...]
    of_member: tuple[Statement, ...]
    outputs: tuple[tuple[int, Output], ...]
    zeros: tuple[str, ...]
    passes: tuple[tuple[int, int], ...]
    vectors: int
    first: int
    scales: tuple[str, ...]


def render_system(context: KernelContext) -> dict[str, str]:
    """The kernels of one generated folder and the package that declares them, by file name."""
    return identify(partial(_render, context))


def identify(render: Callable[[str], dict[str, str]]) -> dict[str, str]:
    """Texts by file name, given a function of the id that they carry, which follows from them."""
    texts = render(PLACE)
    blank = {file: text.replace(PLACE, "0" * len(PLACE)) for file, text in texts.items()}
    identity = fingerprint(blank)
    return {file: text.replace(PLACE, identity) for file, text in texts.items()}


def fingerprint(texts: Mapping[str, str]) -> str:
    """Sixteen hexadecimal digits that change with any byte of a file.

    >>> fingerprint({"a": "b"}) == fingerprint({"ab": ""})
    False
    """
    content = json.dumps(sorted(texts.items()))
    return hashlib.sha256(content.encode()).hexdigest()[:16]


def elementary_functions(programs: Iterable[Program]) -> tuple[str, ...]:
    """Functions that are not exact and that Programs call.

    Where there are none, all targets agree in bits.
    """
    called = list_called(programs)
    return tuple(name for name in FUNCTIONS if name in called and not ELEMENTARY[name].is_exact)


def list_called(programs: Iterable[Program]) -> list[str]:
    """All functions that Programs call, in alphabetical order, as imports have them."""
    values = (value for program in programs for value in program.values())
    called = {operation(node) for value in values for node in walk(value)}
    return sorted(name for name in FUNCTIONS if name in called)


def find_chunk(unknowns: int) -> int:
    """How many members the NumPy kernel evaluates at a time, given how many unknowns it solves for.

    >>> find_chunk(0), find_chunk(20)
    (11000, 500)
    """
    return 210_000 // (unknowns * (unknowns + 1)) if unknowns else CHUNK


def _render(context: KernelContext, identity: str) -> dict[str, str]:
    """The rendered files, given the id."""
    table, firsts = arrange_table(context.programs)
    unknowns = count_unknowns(context.programs)
    state = rows_of(context.state)
    reconstructed = rows_of(context.reconstructed, len(state))
    shared: dict[str, Any] = {
        "name": context.name,
        "spec": context.spec,
        "licence": tell_licence(context.license),
        "id": identity,
        "parameters": rows_of(context.parameters),
        "driving": {
            array: rows_of(quantities)
            for array, quantities in _optional(context).items()
            if not array.startswith("reconstructed")
        },
    }
    texts = _render_files(
        (file for file in TEMPLATES if file not in FILES),
        {
            **shared,
            "state": state,
            "reconstructed": reconstructed,
            "chunk": find_chunk(unknowns),
            "unknowns": unknowns,
            "routes": wrap([*context.routes, *note_unproved(context.supported)]),
            "equations": wrap(context.equations),
            "functions": [
                _function(program, _summary(context, program), firsts.get(program.name, 0))
                for program in context.programs
            ],
            "table": table,
            "called": list_called(context.programs),
            "elementary": tuple_text(map(quote, elementary_functions(context.programs))),
            "shapes": _shapes(context.programs),
            "system": _system(context, identity),
            "declared": {
                table: list(map(declaration, quantities))
                for table, quantities in _tables(context).items()
            },
            "domain": list(map(declaration, context.domain)),
            "methods": list(map(declaration, context.methods)),
        },
    )
    for kind in list_kinds([program.name for program in context.programs]):
        rows = state if kind == SOLVER else [*state, *reconstructed]
        texts |= _render_files(
            kind.files, shared | {"state": rows} | describe_solver(context, kind)
        )
    return {file: texts[file] for file in TEMPLATES if file in texts}


def _render_files(files: Iterable[str], values: Mapping[str, Any]) -> dict[str, str]:
    """The text of each file, given the same values."""
    templates = {file: TEMPLATES[file] for file in files}
    rendered = render_templates(tuple(templates.values()), values)
    return {file: rendered[template] for file, template in templates.items()}


def describe_solver(context: KernelContext, kind: SolverKind) -> dict[str, Any]:
    """What the templates of solvers read alone."""
    solved = hold_sides(select_programs(context.programs, kind, context.maps))
    table = dop853()
    solver = arrange(solved, is_written_out=False)
    return name_solver(context.name, kind) | {
        **describe_noise(solved),
        **describe_structured(solved),
        "solver": replace(solver, loops=None),
        "loops": solver.loops and tell_loops(solver.loops),
        **arrange_sides(solved),
        "solved": {name: arrange_function(name, each) for name, each in solved.items()},
        "maps": {name: arrange_map(solved[name]) for name in list_maps(solved)},
        "moved": list_moved(solved[name] for name in list_maps(solved)),
        "schedules": list_schedules(list_maps(solved)),
        "exact_maps": not elementary_functions(solved[name] for name in list_maps(solved)),
        "refusals": dict(context.refusals) if kind == SOLVER else {},
        "strict": [bound.strict for bound in context.domain],
        "dop853": {each.name: fill(map(repr, getattr(table, each.name))) for each in fields(table)},
    }


def arrange_sides(solved: Mapping[str, Program]) -> dict[str, Any]:
    """What templates read of kinks: a row of the parameters for each side, and what it is that of.

    Args:
        solved: As `coadjoint.lower.kinks.hold_sides` has them.
    """
    kinks = solved.get("kinks")
    if kinks is None:
        return {"sides": [], "kinks": [], "held": {}}
    names = solved["rates"].parameters
    known = len(kinks.parameters)
    return {
        "sides": [Row(index, name, "") for index, name in enumerate(names) if index >= known],
        "kinks": [quote(Printer("").text(output.value)) for output in kinks.outputs],
        "held": {name: arrange_function("held", solved[name]) for name in ("rates", "kinks")},
    }


def name_solver(system: str, kind: SolverKind) -> dict[str, str]:
    """The names that a kind of solvers has in its files, and what it says of itself."""
    return {
        "stem": kind.stem,
        "prefix": kind.prefix(system),
        "about": "" if kind == SOLVER else " What is reconstructed stands below the state.",
    }


def note_unproved(number: int) -> list[str]:
    """The line of the head about claims that are not proved; none if all are."""
    claims = "1 claim is" if number == 1 else f"{number} claims are"
    text = f"{claims} numerically supported and NOT proved: see certificate.json."
    return [text] * bool(number)


def _system(context: KernelContext, identity: str) -> list[str]:
    """The arguments of the System that a generated package makes."""
    tables = ["__file__", "STATE", "PARAMETERS", "OBSERVABLES", "FUNCTIONS", "ELEMENTARY"]
    domain = ["DOMAIN"] * bool(context.domain)
    present = [f"{name}={name.upper()}" for name in _optional(context)]
    present += ["methods=METHODS"] * bool(context.methods)
    if context.unit_of_time != "s":
        present.append(f"unit_of_time={quote(context.unit_of_time)}")
    if context.clock != CLOCK:
        present.append(f"clock={tuple_text(map(quote, context.clock))}")
    if context.written is not None:
        index, size = context.written
        present.append(f"written=({quote(index)}, {size})")
    return [quote(context.name), *tables, quote(identity), *domain, *present]


def _tables(context: KernelContext) -> dict[str, tuple[Quantity, ...]]:
    """The tables of quantities that a generated package declares."""
    tables = {"STATE": context.state, "PARAMETERS": context.parameters}
    others = {name.upper(): quantities for name, quantities in _optional(context).items()}
    return {**tables, "OBSERVABLES": context.observables, **others}


def _optional(context: KernelContext) -> dict[str, tuple[Quantity, ...]]:
    """The quantities that only some systems have, as far as this one has them."""
    names = ("reconstructed", "reconstructed_observables", "inputs", "time")
    return {name: getattr(context, name) for name in names if getattr(context, name)}


def tell_licence(expression: str) -> str:
    """The line of a file's head that states its licence."""
    return f"SPDX-License-Identifier: {expression}" if expression else NO_LICENSE


def wrap(lines: Iterable[str]) -> list[str]:
    """Lines for the head of a file, the long ones continued on indented lines."""
    return [
        piece
        for line in lines
        for piece in textwrap.wrap(
            line,
            WIDTH - 8,
            subsequent_indent="    ",
            break_long_words=False,
            break_on_hyphens=False,
        )
    ]


def rows_of(quantities: Iterable[Quantity], first: int = 0) -> list[Row]:
    """The components of an input array, row by row from ``first`` on."""
    named = [
        (name, quantity.unit_of(name)) for quantity in quantities for name in quantity.components
    ]
    return [Row(index, name, unit) for index, (name, unit) in enumerate(named, first)]


def _function(program: Program, summary: str, first: int) -> Function:
    """A Program as the templates read it, with its first row in the table of the kernel."""
    names_used, table = program.names_used(), program.table
    rows = [] if table else list(enumerate(program.outputs))
    return Function(
        name=program.name,
        summary=summary,
        costs=_costs(program),
        shape=tuple_text(map(str, program.shape)),
        size=len(program.outputs),
        result=_result(program.shape),
        rows=len(program.state),
        state=_read(program.state, names_used),
        parameters=_read(program.parameters, names_used),
        driving={
            array: _read(names, names_used)
            for array, names in program.arrays.items()
            if array in ("inputs", "time")
        },
        python_inputs={
            array: _unpack(names, names_used, array) for array, names in program.arrays.items()
        },
        of_parameters=program.statements_at("parameters"),
        of_member=() if table else program.statements_at("member"),
        outputs=tuple((row, output) for row, output in rows if output.value != ZERO),
        zeros=_zeros(row for row, output in rows if output.value == ZERO),
        passes=table.passes if table else (),
        vectors=len(table.vectors) if table else 0,
        first=first,
        scales=tuple(map(Printer("").text, table.scales)) if table else (),
    )


def _result(shape: tuple[int, ...]) -> str:
    """A list of results as a number, a list, or a list of rows."""
    return {0: "out[0]", 1: "out"}.get(len(shape)) or f"_rows(out, {shape[-1]})"


def _zeros(rows: Iterable[int]) -> tuple[str, ...]:
    """Rows as lines of numbers, each with its comma."""
    return tuple(textwrap.wrap(" ".join(f"{row}," for row in rows), WIDTH - 8))


def _read(names: Sequence[str], used: frozenset[str]) -> tuple[Row, ...]:
    """The components that a Program reads; C warns of the others."""
    return tuple(Row(index, name, "") for index, name in enumerate(names) if name in used)


def _summary(context: KernelContext, program: Program) -> str:
    """One sentence on a function."""
    shape = ", ".join([*map(str, program.shape), "..."])
    function = KERNEL_FUNCTIONS[program.name]
    text = context.is_bound and context.turning and function.turning_bound
    text = text or (context.is_bound and function.constrained)
    text = text or (context.turning and function.turning) or function.summary
    return f"{text}, shape ({shape})."


def _costs(program: Program) -> list[str]:
    """What a call costs, so that a heavier kernel shows in the diff."""
    costs = [f"Operations per member: {_counts(program, 'member')}."]
    if program.statements_at("parameters"):
        costs += [f"Of the parameters alone: {_counts(program, 'parameters')}."]
    return wrap(costs)


def _counts(program: Program, level: str) -> str:
    """Operation counts as text: ``9 add, 15 multiply``."""
    counts = program.operation_counts(level)
    return ", ".join(f"{count} {kind}" for kind, count in counts.items()) or "none"


def _unpack(names: Sequence[str], used: frozenset[str], source: str) -> list[str]:
    """Python lines that take the used names from ``source``, as many to a line as fit.

    All of them on one line where that fits, as a book names them; an unused name is ``_``.
    """
    slots = [name if name in used else "_" for name in names]
    if not used & set(names):
        return []
    line = f"    {', '.join(slots)} = {source}"
    if len(slots) > 1 and len(line) <= WIDTH:
        return [line.strip()]
    lines, start = [], 0
    for stop in range(1, len(slots) + 1):
        piece = _piece(slots, start, stop, source)
        if stop == len(slots) or len(_piece(slots, start, stop + 1, source)) > WIDTH - 4:
            lines += [piece] if set(slots[start:stop]) != {"_"} else []
            start = stop
    return lines


def _piece(slots: Sequence[str], start: int, stop: int, source: str) -> str:
    """The line that takes a stretch of rows."""
    rows = str(start) if stop == start + 1 else f"{start}:{stop}"
    return f"{', '.join(slots[start:stop])} = {source}[{rows}]"


def _shapes(programs: Sequence[Program]) -> list[str]:
    """The entries of the table of functions."""
    return [f"{quote(program.name)}: {tuple_text(map(str, program.shape))}" for program in programs]


def declaration(record: Quantity | Bound | JudgedMethod) -> list[str]:
    """The arguments of a record as a generated package writes it; usual values are left out.

    >>> declaration(Bound("height", "condition", True, ("h",)))
    ['"height"', '"condition"', 'strict=True', 'inputs=("h",)']
    """
    given = []
    for each in fields(record):
        value = getattr(record, each.name)
        if each.name in ("name", "kind"):
            given.append(_literal(value))
        elif value != each.default:
            given.append(f"{each.name}={_literal(value)}")
    return given


def _literal(value: Any) -> str:
    """A value as Python text: texts in double quotes, tuples of such values, and numbers."""
    if isinstance(value, tuple):
        return tuple_text(map(_literal, value))
    return quote(value) if isinstance(value, str) else repr(value)


def tuple_text(entries: Iterable[str]) -> str:
    """Texts as a Python tuple.

    >>> tuple_text([]), tuple_text(["3"]), tuple_text(["3", "4"])
    ('()', '(3,)', '(3, 4)')
    """
    listed = list(entries)
    return f"({listed[0]},)" if len(listed) == 1 else f"({', '.join(listed)})"


def quote(text: str) -> str:
    """A Python string literal in double quotes."""
    return json.dumps(text)
