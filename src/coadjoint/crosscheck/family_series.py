"""Cross-check, series of families: what solvers print of a member, and the coefficients it gives.

Comes in: the rates of a family as loops, the texts of its solver, the equations of a small number
of members that are written out, and the loaded system. Goes out: how many lines or coefficients
were compared, or a `CrossCheckError`.

    rung 3   each line of the recurrences reads back as it was to be printed
    rung 4   coefficients are those of the power series of the equations in 60 digits, which are
             found by Picard's iteration and know nothing of recurrences and loops

Read next: `coadjoint.crosscheck.families`.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from itertools import zip_longest
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.crosscheck.oracle import OutsideDomain
from coadjoint.crosscheck.parse_back import as_printed
from coadjoint.crosscheck.series import solve
from coadjoint.errors import CrossCheckError
from coadjoint.lower.program import Node, Symbol
from coadjoint.render.family_solvers import FamilySolverText, PartText
from coadjoint.render.recurrences import Line
from coadjoint.render.targets.body import failure
from coadjoint.render.targets.c.solver_reader import NumberReader, VectorReader
from coadjoint.render.targets.numpy.reader import find_function
from coadjoint.render.targets.python_text import Reader
from coadjoint.solve.choices import Choice
from coadjoint.solve.family_steps import FamilyTwin, load
from coadjoint.solve.steps import Lanes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.derive.reference import Reference

    Array = NDArray[np.float64]

#: What a text does, one after the other: a line is a name and its value, else there is a text.
Item = str | tuple[str, Node]
#: Order to which coefficients are compared, and how near they are in units of the largest of each
#: order: a wrong recurrence is wrong in the first digits, and roundings add up.
ORDER: Final = 8
NEAR: Final = 1e-9
#: Points that are compared, and how many are tried.
POINTS, TRIES = 3, 12


# -- texts ----------------------------------------------------------------------------------------


def check_series_text(solver: FamilySolverText, texts: Mapping[str, str]) -> int:
    """Rung 3: the recurrences of all parts read back from both texts.

    Args:
        solver: What was to be printed.
        texts: The files by name.

    Returns:
        How many lines were compared.

    Raises:
        CrossCheckError: A text does something else.
    """
    compared = 0
    for part in solver.parts:
        for file, read, expect in (
            ("solver.c", _read_c, _expect_c),
            ("solver.py", _read_numpy, _expect_numpy),
        ):
            pairs = zip_longest(read(texts[file], part.name), expect(part))
            for found, expected in pairs:
                if found != expected:
                    raise failure(
                        f"{file}: expand_{part.name} reads back as {found}; expected {expected}",
                        part.name,
                        file=file,
                        found=str(found),
                        expected=str(expected),
                    )
                compared += 1
    return compared


def _lines(lines: Iterable[Line], prefix: str = "") -> Iterator[Item]:
    """Lines, each with how it is declared before it."""
    for line in lines:
        yield f"{prefix if line.is_new else ''}{line.name}"
        yield line.name, as_printed(line.value)


def _expect_c(part: PartText) -> Iterator[Item]:
    """What the text in C is to do."""
    for place in part.places:
        pointer = "*const " if place.moves else ""
        yield f"const V {pointer}{place.name} = {place.function}(_at, {place.text})"
    for n, name in enumerate(part.kept):
        yield f"V *const {name} = _slots + {n} * ORDER"
    slots = [f"_slots[{len(part.kept)} * ORDER + {n}]" for n in range(len(part.single))]
    yield "if (_k == 0) {"
    yield from _lines((*part.fixed, *part.first), "const V ")
    yield from (f"{slot} = {name}" for slot, name in zip(slots, part.single, strict=True))
    yield from ("return", "}")
    yield from (f"const V {name} = {slot}" for slot, name in zip(slots, part.single, strict=True))
    for stage in part.stages:
        yield from _lines(stage.starts, "V ")
        if stage.terms:
            yield "for (int _m = 1; _m < _k; ++_m) {"
            yield from _lines(stage.terms)
            yield "}"
        yield from _lines(stage.lines, "const V ")
    yield from _lines(part.results)


def _expect_numpy(part: PartText) -> Iterator[Item]:
    """What the text in NumPy is to do."""
    yield from (f"{place.name} = at.{place.function}({place.text})" for place in part.places)
    yield from (f"{name} = at.room(order)" for name in part.kept)
    yield f"_out = [0.0] * {part.count}"
    yield from _lines((*part.fixed, *part.first))
    yield from ("yield _out", "for _k in range(1, order)")
    for stage in part.stages:
        yield from _lines(stage.starts)
        if stage.terms:
            yield "for _m in range(1, _k)"
            yield from _lines(stage.terms)
            yield "end"
        yield from _lines(stage.lines)
    yield from _lines(part.results)
    yield from ("yield _out", "end")


_STATEMENT = re.compile(
    r"\s*(?:(?P<head>(?:for|if) \([^)]*\) \{)|(?P<end>\})|(?P<plain>[^;{}]*);)\s*"
)
_LINE = re.compile(r"((?:const )?V )?(\w+(?:\[(?:\d+|_k)\])?) = (.*)")
#: Lines that compute nothing: places, and what is kept.
_SETUP = re.compile(r".*\(_at, [-\d, ]*\)|V \*const .*|.*_slots\[.*|return")


def _read_c(text: str, part: str) -> Iterator[Item]:
    """What the function of a part does in C."""
    found = re.search(
        rf"^INLINE void expand_{part}\(const Site \*restrict _at, V \*restrict _slots, int _k, "
        rf"V \*restrict _out\)\n\{{\n    \(void\)_at, \(void\)_slots;\n(.*?)^\}}$",
        text,
        re.DOTALL | re.MULTILINE,
    )
    if not found:
        raise failure(f"solver.c has no function expand_{part}", part)
    body, at = found[1].strip(), 0
    while at < len(body):
        statement = _STATEMENT.match(body, at)
        if not statement:
            raise failure(f"solver.c: expand_{part}: {body[at : at + 60]!r} is no statement", part)
        at = statement.end()
        line = " ".join(statement[statement.lastgroup or 0].split())
        assigned = _LINE.fullmatch(line)
        if statement.lastgroup != "plain" or _SETUP.fullmatch(line) or not assigned:
            yield line
            continue
        constant = re.fullmatch(r"all\((.*)\)", assigned[3])
        reader = NumberReader if constant else VectorReader
        value = reader(constant[1] if constant else assigned[3], part, "solver.c").whole()
        yield f"{assigned[1] or ''}{assigned[2]}"
        yield assigned[2], value


class _Numpy(Reader):
    """Reads expressions whose names have orders."""

    def node(self, tree: ast.expr) -> Node:
        """A node; an entry of an array is a name with its order."""
        match tree:
            case ast.Subscript(ast.Name(id=name), index):
                return Symbol(f"{name}[{ast.unparse(index)}]")
        return super().node(tree)


def _read_numpy(text: str, part: str) -> Iterator[Item]:
    """What the function of a part does in NumPy."""
    reader = _Numpy("solver.py", f"_expand_{part}", find_function)
    named = [
        each
        for each in ast.parse(text).body
        if isinstance(each, ast.FunctionDef) and each.name == f"_expand_{part}"
    ]
    if len(named) != 1 or [each.arg for each in named[0].args.args] != ["at", "order"]:
        raise failure(f"solver.py has no function _expand_{part} of at and order", part)

    def read(lines: Iterable[ast.stmt]) -> Iterator[Item]:
        for line in lines:
            match line:
                case ast.For(target, over, body, []):
                    yield f"for {ast.unparse(target)} in {ast.unparse(over)}"
                    yield from read(body)
                    yield "end"
                case ast.Assign([ast.Name("_out")], _) | ast.Expr(ast.Yield()):
                    yield ast.unparse(line).strip("()")
                case ast.Assign([ast.Name()], ast.Call(ast.Attribute(ast.Name("at")))):
                    yield ast.unparse(line)
                case ast.Assign([ast.Name() | ast.Subscript() as to], value):
                    name = ast.unparse(to)
                    yield name
                    yield name, reader.node(value)
                case _:
                    raise reader.refusal("is no line of a recurrence", line)

    return read(named[0].body[1:])


# -- coefficients ---------------------------------------------------------------------------------


def check_series(
    reference: Reference,
    names: tuple[tuple[str, ...], ...],
    system: Any,
    targets: Iterable[str],
    counted: Mapping[str, float],
) -> int:
    """Rung 4: coefficients of every target are those of the power series of the equations.

    Args:
        reference: The equations of a number of members.
        names: The rows of the state, of the parameters, of inputs and of the time in the order of
            a family.
        system: The system of so many members.
        targets: ``c`` or ``numpy``, or both.
        counted: Their number by its name, if formulas name it.

    Returns:
        How many coefficients were compared.

    Raises:
        CrossCheckError: One is another number, or no point has a series.
    """
    state, parameters, inputs, time = names
    source, choice = np.random.default_rng(len(state)), Choice(name="taylor", order=ORDER)
    steppers = {
        target: load(system, choice, target)
        if target == "c"
        else FamilyTwin(system, choice, target)
        for target in targets
    }
    reached = compared = 0
    for _ in range(TRIES):
        point, given = (
            source.uniform(-1.5, 1.5, len(state)),
            source.uniform(0.5, 2, len(parameters)),
        )
        values = dict(zip(state, point.tolist(), strict=True))
        lines = source.uniform(0.5, 2, (len(inputs) + len(time), 2))
        lines[len(inputs) :, 1] = 1.0  # the rate of the time
        driven = zip((*inputs, *time), map(tuple, lines.tolist()), strict=True)
        known = {name: (value,) for name, value in zip(parameters, given.tolist(), strict=True)}
        known |= {**dict(driven), **{name: (value,) for name, value in counted.items()}}
        ordered = {name: values[name] for name in reference.state}
        try:
            series = solve(partial(reference.evaluate, "rhs"), ordered, known, ORDER)
        except (OutsideDomain, ArithmeticError):
            continue
        exact = np.array([[float(each) for each in series[name]] for name in state])
        for target, stepper in steppers.items():
            lanes = _make_lanes(point, given, lines)
            stepper._limits.find_sides(lanes)
            found = stepper._expand(lanes, ORDER)[:, :, 0]
            near = np.abs(found - exact) <= NEAR * np.abs(exact).max(axis=0, initial=1.0)
            if not near.all():
                row, order = np.argwhere(~near)[0].tolist()
                raise CrossCheckError.on(
                    4,
                    system.name,
                    f"order {order} of {state[row]} is {float(found[row, order])!r} by the "
                    f"recurrences of {target}, {float(exact[row, order])!r} by the power series of "
                    "the equations",
                    target=target,
                )
            compared += found.size
        reached += 1
        if reached == POINTS:
            break
    if not compared:
        raise CrossCheckError(
            f"rung 4: {system.name}: no coefficient of a power series was compared.",
            rung=4,
            system=system.name,
        )
    return compared


def _make_lanes(state: Array, parameters: Array, lines: Array) -> Lanes:
    """One trajectory, with values and rates of what drives it, ``(m, 2)``."""
    none = np.zeros(1)
    return Lanes(
        state=state[:, np.newaxis].copy(),
        time=none,
        end=none,
        step=none,
        parameters=parameters,
        driving=lines[:, :1],
        slopes=lines[:, 1:],
        member=np.zeros(1, np.uint64),
        steps=np.zeros(1, np.uint64),
    )
