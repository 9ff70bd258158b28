"""The target NumPy, arranging: a function of ``kernel.py`` as calls that make no new arrays.

Comes in: the text of a function, whose formulas make an array for each operation. Goes out: the
same operations in the same order, hence the same bits, in three functions: of what members share,
of the numbers of one member, and of the arrays of many. The last writes into rows of the result and
into rows that are used again; what is shared are arrays without axes there, which NumPy takes
faster than numbers.
Read next: `coadjoint.render.targets.numpy.loader`, which calls them.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from coadjoint.elementary import ELEMENTARY

_OPERATORS: Final = {
    ast.Add: "add",
    ast.Sub: "subtract",
    ast.Mult: "multiply",
    ast.Div: "divide",
    ast.USub: "negative",
}


@dataclass(frozen=True)
class Arranged:
    """A function in three parts.

    Attributes:
        share: From lists of parameters, inputs and time to what members share.
        single: Evaluates numbers of one state, with what is shared, into a flat result.
        many: Evaluates rows of a state, with what is shared as arrays without axes, into rows of a
            result, with rows of its own.
        rows: How many of these it needs.
    """

    share: Callable[..., list[float]]
    single: Callable[[Sequence[float], Sequence[float], Any], None]
    many: Callable[[Any, Sequence[Any], Any, Any], None]
    rows: int


class _UnknownFormError(Exception):
    """A line that is no formula: a loop over a table."""


def arrange(module: str, name: str) -> Arranged | None:
    """The private twin of a function in three parts; None where it is not made of formulas alone.

    Args:
        module: The text of ``kernel.py``.
        name: Of the function.
    """
    found = re.search(rf"^def _{name}\(.*?(?=^\S|\Z)", module, re.DOTALL | re.MULTILINE)
    if found is None:
        return None
    function = ast.parse(found[0]).body[0]
    assert isinstance(function, ast.FunctionDef)
    try:
        lines = _Lines(function)
    except _UnknownFormError:
        return None
    single, many = _write_single(lines), _Writer(lines)
    share = [*lines.sharing, f"return [{', '.join(lines.shared)}]"]
    given = ", ".join(each.arg for each in function.args.args[1:-1])
    code = [*_define("share", given, share), *_define("single", "state, shared, out", single)]
    code += _define("many", "state, shared, out, rows", many.lines)
    scope: dict[str, Any] = {"np": np, "_root": math.sqrt, "_float": float}
    called = (*_OPERATORS.values(), *(each.numpy_name for each in ELEMENTARY.values()), "copyto")
    scope |= {f"_{each}": getattr(np, each) for each in called}
    exec(compile("\n".join(code), f"{name} of kernel.py", "exec"), scope)  # noqa: S102 (names alone)
    parts = {part: scope[part] for part in ("share", "single", "many")}
    return Arranged(**parts, rows=many.most)


def _define(name: str, arguments: str, lines: Iterable[str]) -> list[str]:
    """A function."""
    return [f"def {name}({arguments}):", *(f"    {line}" for line in lines)]


class _Lines:
    """The lines of a function by what they depend on.

    Attributes:
        sharing: Lines that name what members share.
        unpacking: Lines that name rows of the state.
        moving: Names with their formulas that depend on the member, in order.
        outputs: Rows of the result with their formulas.
        zeros: Rows that are zero everywhere.
        shared: What `moving` and `outputs` read of what is shared: names by formula.
    """

    def __init__(self, function: ast.FunctionDef) -> None:
        self.sharing: list[str] = []
        self.unpacking: list[str] = []
        self.moving: list[tuple[str, ast.expr]] = []
        self.outputs: list[tuple[int, ast.expr]] = []
        self.zeros: list[int] = []
        self.shared: dict[str, str] = {}
        self._known: set[str] = set()
        for line in function.body:
            self._take(line)

    def _take(self, line: ast.stmt) -> None:
        """Sort a line in."""
        match line:
            case ast.Assign([ast.Name("zeros")], ast.Tuple(elts=rows)):
                self.zeros = [ast.literal_eval(row) for row in rows]
            case ast.Assign([ast.Subscript(slice=ast.Tuple())], ast.Constant(0.0)):
                pass  # the rows are known
            case ast.Assign([ast.Subscript(ast.Name("out"), ast.Constant(int(row)))], value):
                self.outputs.append((row, self._mark(value)))
            case ast.Assign([target], ast.Name(array) | ast.Subscript(ast.Name(array))):
                self._take_rows(line, target, array)
            case ast.Assign([ast.Name(name)], value):
                if self._is_shared(value):
                    self.sharing.append(ast.unparse(line))
                    self._known.add(name)
                else:
                    self.moving.append((name, self._mark(value)))
            case _:
                raise _UnknownFormError

    def _take_rows(self, line: ast.Assign, target: ast.expr, array: str) -> None:
        """Names of rows."""
        if array not in ("state", "parameters", "inputs", "time"):
            self.moving.append((ast.unparse(target), self._mark(line.value)))
        elif array == "state":
            self.unpacking.append(ast.unparse(line))
        else:
            self.sharing.append(ast.unparse(line))
            self._known.update(_list_names(target))

    def _is_shared(self, value: ast.expr) -> bool:
        """Whether a formula has the same value for all members."""
        return all(name in self._known or name == "np" for name in _list_names(value))

    def _mark(self, value: ast.expr) -> ast.expr:
        """A formula in which the largest parts that are shared are names."""
        if self._is_shared(value):
            name = self.shared.setdefault(ast.unparse(value), f"_shared{len(self.shared)}")
            return ast.Name(name)
        match value:
            case ast.Name():
                return value
            case ast.BinOp(left, operator, right):
                return ast.BinOp(self._mark(left), operator, self._mark(right))
            case ast.UnaryOp(operator, operand):
                return ast.UnaryOp(operator, self._mark(operand))
            case ast.Call(ast.Attribute(ast.Name("np")) as function, arguments, []):
                return ast.Call(function, list(map(self._mark, arguments)), [])
        raise _UnknownFormError


def _write_single(lines: _Lines) -> list[str]:
    """Formulas over numbers of Python, which take a tenth of the time of arrays of one."""
    text = [*lines.unpacking, *_unpack(lines.shared.values(), "shared")]
    text += ["out.fill(0.0)"] * bool(lines.zeros)
    text += [f"{name} = {_write_number(value)}" for name, value in lines.moving]
    return text + [f"out[{row}] = {_write_number(value)}" for row, value in lines.outputs]


def _write_number(value: ast.expr) -> str:
    """A formula of numbers; functions beyond the root are NumPy's, whose bits are its own."""
    match value:
        case ast.BinOp(left, operator, right):
            inner = ast.BinOp(_name(_write_number(left)), operator, _name(_write_number(right)))
            return f"({ast.unparse(inner)})"
        case ast.UnaryOp(_, operand):
            return f"(-{_write_number(operand)})"
        case ast.Call(ast.Attribute(attr="sqrt"), [argument]):
            return f"_root({_write_number(argument)})"
        case ast.Call(ast.Attribute(attr=called), arguments):
            return f"_float(_{called}({', '.join(map(_write_number, arguments))}))"
    return ast.unparse(value)


def _name(text: str) -> ast.Name:
    """Text that stands for an operand."""
    return ast.Name(text)


def _unpack(names: Iterable[str], array: str) -> list[str]:
    """The line that names what an array has, if it has anything."""
    listed = "".join(f"{name}, " for name in names)
    return [f"{listed}= {array}"] if listed else []


class _Writer:
    """Formulas over arrays, one call for each operation.

    A name is written into a row of its own, or, where a result is this name, into the result. What
    stands inside a formula goes where the whole of it goes, or into a row that is free again after
    the operation.

    Attributes:
        lines: What was written.
        most: How many rows were in use at a time.
    """

    def __init__(self, lines: _Lines) -> None:
        self.most, self._free = 0, list[str]()
        final = {
            value.id: row for row, value in reversed(lines.outputs) if isinstance(value, ast.Name)
        }
        values = [*lines.moving, *((f"_out{row}", value) for row, value in lines.outputs)]
        names = [dict.fromkeys(_list_names(value)) for _, value in values]
        last = {each: n for n, own in enumerate(names) for each in own}
        self._places: dict[str, str] = {}
        self._text: list[str] = []
        for n, (name, value) in enumerate(values):
            self._write_line(name, value, final)
            for each in names[n]:
                place = self._places.get(each, "")
                if last[each] == n and place.startswith("_row"):
                    self._free.append(place)
        self.lines = [
            *lines.unpacking,
            *_unpack(lines.shared.values(), "shared"),
            *["out.fill(0.0)"] * bool(lines.zeros),
            *(f"_out{row} = out[{row}]" for row, _ in lines.outputs),
            *_unpack((f"_row{row}" for row in range(self.most)), "rows"),
            *self._text,
        ]

    def _write_line(self, name: str, value: ast.expr, final: dict[str, int]) -> None:
        """Compute a name, or a result."""
        if name.startswith("_out"):
            place = name
        else:
            place = f"_out{final[name]}" if name in final else self._take_row()
            self._places[name] = place
        found = self._write(value, place)
        if found != place:
            self._text.append(f"_copyto({place}, {found})")

    def _take_row(self) -> str:
        """A row that nothing is in."""
        if self._free:
            return self._free.pop()
        self.most += 1
        return f"_row{self.most - 1}"

    def _write(self, value: ast.expr, place: str) -> str:
        """Compute a formula; the answer is where it stands, in a place unless it is a name."""
        match value:
            case ast.Name(name):
                return self._places.get(name, name)
            case ast.BinOp(left, operator, right):
                return self._write_pair(left, right, _OPERATORS[type(operator)], place)
            case ast.UnaryOp(operand=operand):
                self._text.append(f"_negative({self._write(operand, place)}, {place})")
            case ast.Call(ast.Attribute(attr=called), [argument]):
                self._text.append(f"_{called}({self._write(argument, place)}, {place})")
            case ast.Call(ast.Attribute(attr=called), [left, right]):
                return self._write_pair(left, right, called, place)
        return place

    def _write_pair(self, left: ast.expr, right: ast.expr, operator: str, place: str) -> str:
        """An operation on two: the first compound operand goes where the result will."""
        first = self._write(left, place)
        if first == place and not isinstance(right, ast.Name):
            row = self._take_row()
            second = self._write(right, row)
            self._free.append(row)
        else:
            second = self._write(right, place)
        self._text.append(f"_{operator}({first}, {second}, {place})")
        return place


def _list_names(value: ast.AST) -> Iterator[str]:
    """Names in a formula, from left to right; `ast.walk` takes three times as long."""
    match value:
        case ast.Name(name):
            yield name
        case ast.BinOp(left, _, right):
            yield from _list_names(left)
            yield from _list_names(right)
        case ast.UnaryOp(_, operand):
            yield from _list_names(operand)
        case ast.Constant():
            pass
        case _:
            for part in ast.iter_child_nodes(value):
                yield from _list_names(part)
