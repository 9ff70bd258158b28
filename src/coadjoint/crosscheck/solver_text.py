"""Cross-check, text of solvers: what is printed, read back, is what was to be printed.

Comes in: recurrences and the texts of ``solver.c``, ``solver.h`` and ``solver.py``, or of those of
another kind. Goes out: how many lines and table entries were compared, or a `CrossCheckError` that
names the line. The lines of
the system and the tables are read by the readers of the targets; the rest of each text, in which
the system has its name and sizes alone, is compared letter by letter with what the template gives
for a system without recurrences.
Read next: `coadjoint.crosscheck.recurrences`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import zip_longest

from coadjoint.crosscheck.parse_back import printed_lines
from coadjoint.derive.setting import STEP
from coadjoint.lower.compositions import list_schedules
from coadjoint.lower.mapped import list_maps, list_moved
from coadjoint.lower.program import Node, Program, Symbol
from coadjoint.lower.tableau import Tableau, dop853
from coadjoint.render.environment import render_templates
from coadjoint.render.kernels import (
    TEMPLATES,
    Row,
    arrange_sides,
    elementary_functions,
    name_solver,
)
from coadjoint.render.recurrences import Line
from coadjoint.render.solvers import (
    FunctionText,
    SolverText,
    arrange_function,
    arrange_map,
    describe_noise,
    describe_structured,
    list_sharing,
)
from coadjoint.render.tables import tell_loops
from coadjoint.render.targets.body import Loop, SolverBody, failure
from coadjoint.render.targets.c import solver_reader as c_reader
from coadjoint.render.targets.numpy import solver_reader as numpy_reader
from coadjoint.solver_kinds import SOLVER, SolverKind

Pair = tuple[str, Node]


@dataclass(frozen=True)
class SolverTexts:
    """The solvers of a system in every form.

    Attributes:
        programs: The rates and what bounds the motion, by their names in the texts.
        recurrences: What was to be printed.
        strict: Whether each row of the domain has to be more than 0, or may be 0.
        files: The printed files by name.
        system: Name of the system.
        kind: What they integrate.
    """

    programs: Mapping[str, Program]
    recurrences: SolverText
    strict: tuple[bool, ...]
    files: Mapping[str, str]
    system: str
    kind: SolverKind = SOLVER


def check_solver_texts(texts: SolverTexts) -> int:
    """Rung 3: texts of solvers read back as what was to be printed.

    Returns:
        How many lines and entries of tables were compared.

    Raises:
        CrossCheckError: They do not; the message names the first difference.
    """
    c, _, numpy = texts.kind.files
    check_rest(texts)
    loops, table = texts.recurrences.loops, dop853()
    looped = loops.numbers if loops else {}
    tableau = {each.name: tuple(map(float, getattr(table, each.name))) for each in fields(table)}
    compared = _check_tables(c_reader.read_tables(texts.files[c], c), {**looped, **tableau}, c)
    compared += _check_tables(numpy_reader.read_tables(texts.files[numpy], numpy), looped, numpy)
    for function in ("find_fixed", "expand", *(f"find_{name}" for name in texts.programs)):
        if not loops or function not in c_reader.LOOPED:
            body = c_reader.read_function(texts.files[c], function, c)
            compared += _check_body(body, _expected(texts, function), c, function)
    for name in list_maps(texts.programs):
        body = numpy_reader.read_map(texts.files[numpy], name, numpy)
        compared += _check_body(body, _expected_map(texts, name), numpy, f"find_{name}")
    body = numpy_reader.read_expand(texts.files[numpy], numpy, is_looped=loops is not None)
    compared += _check_body(body, _expected(texts, numpy), numpy, "expand")
    for name, program in texts.programs.items():
        if name in numpy_reader.HELD and texts.recurrences.kinks is not None:
            body = numpy_reader.read_rows(texts.files[numpy], f"find_{name}", numpy)
            compared += _check_body(body, _expect_rows(program), numpy, f"find_{name}")
    return compared


# -- the lines of the system ----------------------------------------------------------------------


def _expected(texts: SolverTexts, function: str) -> SolverBody:
    """What a function is to do."""
    solver, program = texts.recurrences, texts.programs["rates"]
    driven = (*program.inputs, *program.time)
    rows = {"parameters": program.parameters, "state": program.state, "driving": driven}
    rows["fixed"] = tuple(line.name for line in (*solver.fixed, *solver.shared))
    if function == "find_fixed":
        reads = solver.fixed_reads | solver.shared_reads
        return _body(rows, ("parameters",), reads, (*solver.fixed, *solver.shared))
    name = function.removeprefix("find_")
    if name in texts.programs:
        found = arrange_function(name, texts.programs[name])
        shares = name == "rates" or list_sharing([name])
        if not list_maps([name]):
            rows["state"] = texts.programs[name].state
        arrays = ("state", "parameters", "driving", *(["fixed"] if shares else []))
        begin = [Line(STEP, Symbol("_after"))] if list_maps([name]) else []
        return _body(rows, arrays, found.reads, (*begin, *found.lines))
    if solver.loops:
        body = _body(rows, ("parameters",), solver.fixed_reads, solver.fixed)
        body.scales = list(solver.loops.scales)
        return body
    is_c = function == "expand"
    reads = solver.reads.union(program.state, (frozenset() if is_c else solver.fixed_reads))
    arrays = ("state", "parameters", "driving", *(["fixed"] if is_c else []))
    lines = solver.first if is_c else (*solver.fixed, *solver.first)
    body = _body(rows, arrays, reads, lines)
    body.kept, body.orders = list(solver.kept), list(_orders(solver))
    return body


def _expected_map(texts: SolverTexts, name: str) -> SolverBody:
    """What a map is to do in NumPy."""
    program = texts.programs["rates"]
    rows = {"parameters": program.parameters, "state": program.state}
    found = arrange_map(texts.programs[name])
    return _body(rows, ("state", "parameters"), found.reads, found.lines)


def _expect_rows(program: Program) -> SolverBody:
    """What a function in NumPy is to do that computes all rows of a Program."""
    found, driven = arrange_function("held", program), (*program.inputs, *program.time)
    rows = {"parameters": program.parameters, "state": program.state, "driving": driven}
    return _body(rows, tuple(rows), found.reads, found.lines)


def _body(
    rows: Mapping[str, Sequence[str]],
    arrays: Iterable[str],
    reads: frozenset[str],
    lines: Iterable[Line],
) -> SolverBody:
    """A body with the inputs of some arrays and with some lines."""
    inputs = {
        name: (array, row)
        for array in arrays
        for row, name in enumerate(rows[array])
        if name in reads
    }
    return SolverBody(inputs=inputs, lines=_pairs(lines))


def _orders(solver: SolverText) -> Iterable[Pair | Loop]:
    """What is done at each order."""
    for stage in solver.stages:
        yield from _pairs(stage.starts)
        if stage.terms:
            yield Loop(tuple(_pairs(stage.terms)))
        yield from _pairs(stage.lines)
    yield from _pairs(solver.rates)


def _pairs(lines: Iterable[Line]) -> list[Pair]:
    return [each for line in lines for each in printed_lines(line.name, line.value)]


def _check_body(found: SolverBody, expected: SolverBody, file: str, function: str) -> int:
    """Inputs, arrays, lines and orders are the same."""
    lines = [
        *zip_longest(sorted(found.inputs.items()), sorted(expected.inputs.items())),
        *zip_longest(found.kept, expected.kept),
        *zip_longest(found.scales, expected.scales),
        *zip_longest(found.lines, expected.lines),
        *zip_longest(found.orders, expected.orders),
    ]
    for one, other in lines:
        if one != other:
            raise failure(
                f"{file}, {function}: {one} was read back; expected {other}. The printer, the "
                "template or the reader is wrong",
                function,
                file=file,
                found=str(one),
                expected=str(other),
            )
    return sum(1 + (len(one.lines) if isinstance(one, Loop) else 0) for one, _ in lines)


def _check_tables(
    found: Mapping[str, Sequence[float]], expected: Mapping[str, Sequence[float]], file: str
) -> int:
    """The tables are what they are to be, number by number."""
    for name in {**expected, **found}:
        pairs = zip_longest(found.get(name, ()), expected.get(name, ()))
        for place, (one, other) in enumerate(pairs):
            if one != other:
                raise failure(
                    f"{file}: entry {place} of {name} is {one!r}; expected {other!r}",
                    name,
                    file=file,
                    found=repr(one),
                    expected=repr(other),
                )
    return sum(map(len, expected.values()))


# -- the rest of the text -------------------------------------------------------------------------


def check_rest(texts: SolverTexts) -> None:
    """What is no line of the system is the template's, letter by letter.

    Raises:
        CrossCheckError: A line differs.
    """
    expected = _render_without_lines(texts)
    for file, text in texts.files.items():
        cut = (_cut(texts, file, each) for each in (text, expected[file]))
        pairs = zip_longest(*map(str.splitlines, cut))
        for number, (one, other) in enumerate(pairs, 1):
            if one != other:
                raise failure(
                    f"{file}: line {number} of what all systems share is {one!r}; expected "
                    f"{other!r}",
                    file,
                    file=file,
                    found=str(one),
                    expected=str(other),
                )


def _cut(texts: SolverTexts, file: str, text: str) -> str:
    """A text without what belongs to the system."""
    looped = texts.recurrences.loops is not None
    c, _, numpy = texts.kind.files
    if file == c:
        return c_reader.rest(text, is_looped=looped)
    return numpy_reader.rest(text, is_looped=looped) if file == numpy else text


def _render_without_lines(texts: SolverTexts) -> dict[str, str]:
    """The files of a system of this name and these sizes that has no recurrences."""
    program, solver = texts.programs["rates"], texts.recurrences
    nothing = FunctionText((), frozenset())
    kinks = arrange_sides(texts.programs)
    known = len(program.parameters) - len(kinks["sides"])
    bare = SolverText(
        fixed=solver.fixed,
        kept=(),
        first=(),
        stages=(),
        rates=(),
        functions=solver.functions,
        products=solver.products,
        operations=solver.operations,
        reads=frozenset(),
        fixed_reads=frozenset(),
        branches=solver.branches,
        shared=solver.shared,
        unknowns=solver.unknowns,
    )
    driving = {"inputs": _rows(program.inputs), "time": _rows(program.time)}
    templates = {file: TEMPLATES[file] for file in texts.kind.files}
    rendered = render_templates(
        tuple(templates.values()),
        {
            "name": texts.system,
            **name_solver(texts.system, texts.kind),
            **_head(texts.kind.files[2], texts.files[texts.kind.files[2]]),
            "state": _rows(program.state),
            "parameters": _rows(program.parameters[:known]),
            **kinks,
            "held": dict.fromkeys(kinks["held"], nothing),
            "driving": {name: rows for name, rows in driving.items() if rows},
            **describe_noise(texts.programs),
            **describe_structured(texts.programs),
            "solver": bare,
            "loops": solver.loops and tell_loops(solver.loops, is_empty=True),
            "solved": dict.fromkeys(texts.programs, nothing),
            "maps": dict.fromkeys(list_maps(texts.programs), nothing),
            "moved": list_moved(texts.programs[name] for name in list_maps(texts.programs)),
            "schedules": list_schedules(list_maps(texts.programs)),
            "exact_maps": not elementary_functions(
                texts.programs[name] for name in list_maps(texts.programs)
            ),
            "refusals": numpy_reader.read_refusals(texts.files[texts.kind.files[2]]),
            "strict": texts.strict,
            "dop853": {field.name: [] for field in fields(Tableau)},
        },
    )
    return {file: rendered[template] for file, template in templates.items()}


def _rows(names: Iterable[str]) -> list[Row]:
    return [Row(index, name, "") for index, name in enumerate(names)]


def _head(file: str, text: str) -> dict[str, str]:
    """The spec, licence and id that the head of a file tells."""
    found = re.match(
        r"# Generated by `coadjoint regenerate` from (.*); edits are lost\.\n"
        r"# Template: .*\n# (.*)\n# id: ([0-9a-f]{16})\n",
        text,
    )
    if not found:
        raise failure(f"{file} has another head than its template", "expand")
    return dict(zip(("spec", "licence", "id"), found.groups(), strict=True))
