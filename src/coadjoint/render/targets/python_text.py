"""Targets, reading Python: what the readers of two targets share.

Comes in: the text of a module. Goes out: its functions, and a `Body` line by line, through a list
of allowed forms. The `ast` of the standard library reads, not our printer.
Read next: `coadjoint.render.targets.numpy.reader`.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import lru_cache
from math import isfinite

from coadjoint.elementary import ELEMENTARY
from coadjoint.errors import CrossCheckError
from coadjoint.lower.program import Call, Negate, Node, Number, Symbol
from coadjoint.render.targets.body import Body, Line, failure, join, read_loop
from coadjoint.render.targets.loops import TABLES, Loops

Functions = dict[str, ast.FunctionDef]


@lru_cache(maxsize=8)  # every function of a file is read from the same text
def _parse(text: str) -> ast.Module:
    """The tree of a text."""
    return ast.parse(text)


#: Functions by their names in NumPy.
NUMPY_FUNCTIONS = {entry.numpy_name: name for name, entry in ELEMENTARY.items()}


class Reader:
    """Reads one function of a Python kernel.

    Args:
        file: The name of the file, for messages.
        name: The function.
        called: The elementary function that an expression names, or None.
    """

    def __init__(self, file: str, name: str, called: Callable[[ast.expr], str | None]) -> None:
        self.file, self.name, self._called = file, name, called

    def refusal(self, problem: str, tree: ast.AST | None = None) -> CrossCheckError:
        """The failure of rung 3, with what was found."""
        shown = "" if tree is None else f"{ast.unparse(tree)[:80]!r} "
        return failure(f"{self.file}: {shown}{problem}", self.name)

    def functions(self, text: str, allowed: Callable[[ast.stmt], bool]) -> Functions:
        """The functions of a module that does nothing but define them, each once.

        Args:
            text: Of the file.
            allowed: Whether another statement may stand between them.
        """
        try:
            module = _parse(text)
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            raise failure(f"{self.file} is not Python: {error}", self.name) from error
        functions: Functions = {}
        for item in module.body:
            match item:
                case ast.FunctionDef(name=defined, decorator_list=[]) if defined not in functions:
                    functions[defined] = item
                case ast.Expr(value=ast.Constant()):
                    pass
                case _:
                    if not allowed(item):
                        raise self.refusal("is out of place", item)
        return functions

    def check_helpers(self, functions: Functions, helpers: str) -> None:
        """Functions that the lines of a system call are those of our template.

        Args:
            functions: All functions of the file.
            helpers: Those of our template, without docstrings.
        """
        for helper in _parse(helpers).body:
            assert isinstance(helper, ast.FunctionDef), helper
            found = functions.get(helper.name)
            if found is None or list(map(ast.dump, found.body[1:])) != list(
                map(ast.dump, helper.body)
            ):
                raise self.refusal(f"{helper.name} is another one than that of our template")
            if ast.dump(found.args) != ast.dump(helper.args):
                raise self.refusal(f"{helper.name} takes other arguments")

    def read(self, line: ast.stmt, body: Body) -> None:
        """One line of a function: inputs, a statement or an output."""
        loop = self.read_loop(line, body.arrays)
        if loop is not None:
            body.statements += loop
            return
        if not isinstance(line, ast.Assign) or len(line.targets) != 1:
            raise self.refusal("is not an assignment", line)
        target, value = line.targets[0], line.value
        match target, value:
            case (ast.Tuple(elts=names), ast.Name(id=array)):
                self._read_names(names, array, 0, body)
            case (
                ast.Tuple(elts=names),
                ast.Subscript(ast.Name(array), ast.Slice(ast.Constant(first))),
            ):
                self._read_names(names, array, first, body)
            case (ast.Name(), ast.Subscript(ast.Name(array), ast.Constant(row))) if (
                array not in body.arrays
            ):
                self._read_names([target], array, row, body)
            case (ast.Name(id=assigned), _):
                body.statements.append((assigned, self.node(value)))
            case (ast.Subscript(ast.Name("out"), ast.Constant(int(row))), _):
                body.outputs.append((row, self.node(value)))
            case (ast.Subscript(ast.Name(array), ast.Constant(int(row))), _) if (
                array in body.arrays
            ):
                body.statements.append((f"{array}[{row}]", self.node(value)))
            case _:
                raise self.refusal("is assigned", target)

    def read_loop(self, line: ast.stmt, arrays: dict[str, int]) -> list[Line] | None:
        """What a line computes that makes an array for a loop or calls one; None of others.

        Args:
            line: The line.
            arrays: How many entries arrays have; one that is made is noted.
        """
        match line:
            case ast.Assign(
                [ast.Name(name)],
                ast.BinOp(ast.List([ast.Constant(0.0)]), ast.Mult(), ast.Constant(int(size))),
            ) if name.startswith("_"):
                arrays[name] = size
                return []
            case ast.Expr(ast.Call(ast.Name(called), arguments, [])):
                loop = read_loop(called, list(map(ast.unparse, arguments)), arrays)
                if loop is None:
                    raise self.refusal("is no loop over arrays that were made", line)
                return [loop]
        return None

    def _read_names(self, names: Sequence[ast.expr], array: str, first: object, body: Body) -> None:
        """Names of consecutive rows; ``_`` is a row that is not read."""
        for offset, target in enumerate(names):
            if not isinstance(target, ast.Name) or not isinstance(first, int):
                raise self.refusal("is an input", target)
            if target.id != "_":
                body.inputs[target.id] = (array, first + offset)

    def node(self, tree: ast.expr) -> Node:
        """A node from the forms that the printer writes, and from no others."""
        match tree:
            case ast.Name(id=symbol):
                return Symbol(symbol)
            case ast.Subscript(ast.Name(array), ast.Constant(int(place))) if array[0] == "_":
                return Symbol(f"{array}[{place}]")
            case ast.Constant(value=float(value)) if isfinite(value):
                return Number(Fraction(value))
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return Negate(self.node(operand))
            case ast.BinOp(left=left, op=operator, right=right):
                sign = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}.get(type(operator))
                if sign:
                    return join(self.node(left), sign, self.node(right))
            case ast.Call(function, arguments, []):
                called = self._called(function)
                if called and len(arguments) == ELEMENTARY[called].arity:
                    return Call(called, *map(self.node, arguments))
        raise self.refusal("is not a form of a Program", tree)


class LoopReader:
    """Reads what is left of a function that loops over a table, and the table.

    Args:
        reader: The reader of the function.
        functions: All functions of the file.
        text: Of the file.
        helpers: What such functions call, as our template has it, without docstrings.
    """

    def __init__(self, reader: Reader, functions: Functions, text: str, helpers: str) -> None:
        self.reader = reader
        tables = {
            item.targets[0].id: item.value
            for item in _parse(text).body
            if isinstance(item, ast.Assign) and isinstance(item.targets[0], ast.Name)
        }
        self.loops = Loops(tables={part: self._read_table(tables, part) for part in TABLES})
        reader.check_helpers(functions, helpers)

    def _read_table(self, tables: dict[str, ast.expr], part: str) -> list[float]:
        """One part of the table."""
        try:
            entries = ast.literal_eval(tables[f"TABLE_{part.upper()}"])
            wanted = type(TABLES[part]("0"))
            if isinstance(entries, tuple) and all(type(each) is wanted for each in entries):
                return list(entries)
        except (KeyError, ValueError):
            pass
        raise self.reader.refusal(f"the table {part} is not one of numbers")

    def read(self, line: ast.stmt) -> bool:
        """Whether a line is one of a function that loops."""
        shown = ast.unparse(line)
        filled = re.fullmatch(r"vector(\d+) = _fill_vector\(state\[(\d+):(\d+)\], scales\)", shown)
        added = re.fullmatch(r"_add_products\(out, \[(.*)\], (\d+)\)", shown)
        match line:
            case ast.Assign([ast.Name("scales")], ast.Tuple(elts=scales)):
                self.loops.scales = list(map(self.reader.node, scales))
                return True
        if filled and int(filled[1]) == len(self.loops.vectors):
            self.loops.vectors.append(int(filled[2]))
        elif added:
            passes = re.findall(r"\(vector(\d+), vector(\d+)\)", added[1])
            self.loops.passes = [(int(a), int(b)) for a, b in passes]
            self.loops.first = int(added[2])
        return bool(filled or added)


def is_table(item: ast.stmt) -> bool:
    """Whether a statement of a module is a part of its table."""
    match item:
        case ast.Assign(targets=[ast.Name(id=name)], value=ast.Tuple()):
            return name.removeprefix("TABLE_").lower() in TABLES
    return False
