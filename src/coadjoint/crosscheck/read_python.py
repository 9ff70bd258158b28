"""Cross-check, reading Python: a function of ``kernel.py`` through a list of allowed forms.

Comes in: the text. Goes out: a `Body`. The `ast` of the standard library reads, not our printer.
Read next: `coadjoint.crosscheck.read_c`.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from fractions import Fraction
from math import isfinite

from coadjoint.crosscheck.body import Body, failure, joined
from coadjoint.lower.program import FUNCTIONS, Call, Negate, Node, Number, Symbol


def read_python(text: str, name: str, arrays: Sequence[str] = ("state", "parameters")) -> Body:
    """The function ``_name`` of a ``kernel.py``; other forms than our template's fail.

    Args:
        text: Of the file.
        name: Of the function.
        arrays: The arrays that it takes, in order.
    """
    try:
        module = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise failure(f"kernel.py is not Python: {error}", name) from error
    functions = _functions(module, name)
    for wanted in (name, f"_{name}"):
        if wanted not in functions:
            raise failure(f"kernel.py has no function {wanted!r}", name)
    _check_calls(functions, name, arrays)
    body = Body()
    for line in functions[f"_{name}"].body:
        if not isinstance(line, ast.Assign) or len(line.targets) != 1:
            raise failure(f"kernel.py: {ast.unparse(line)!r} is not an assignment", name)
        _read_assignment(line.targets[0], line.value, body, name)
    return body


def read_expression(text: str, name: str) -> Node:
    """A node from a Python expression; ``name`` is the function it stands in, for messages.

    >>> read_expression("-np.sqrt(a)", "rhs")
    Negate(operand=Call(function='sqrt', argument=Symbol(name='a')))
    """
    return _node(ast.parse(text.strip(), mode="eval").body, name)


def _functions(module: ast.Module, name: str) -> dict[str, ast.FunctionDef]:
    """The functions of a module that does nothing but define them, each once."""
    functions: dict[str, ast.FunctionDef] = {}
    for item in module.body:
        match item:
            case ast.FunctionDef(name=defined, decorator_list=[]) if defined not in functions:
                functions[defined] = item
            case ast.Expr(value=ast.Constant()) | ast.Import():
                pass
            case ast.Assign(targets=[ast.Name(id="ID" | "CHUNK")], value=ast.Constant()):
                pass
            case _:
                raise failure(f"kernel.py: {ast.unparse(item)[:80]!r} is out of place", name)
    return functions


def _check_calls(functions: dict[str, ast.FunctionDef], name: str, arrays: Sequence[str]) -> None:
    """The public function hands its private twin and all arrays to the loop over members."""
    twin = functions[f"_{name}"].args
    match functions[name].body:
        case [ast.Expr(), ast.Return(value=ast.Call(ast.Name("_over_members"), args, rows))]:
            given = [ast.unparse(argument) for argument in args]
            only_rows = [each.arg for each in rows] in ([], ["n"])
            taken = [each.arg for each in (*twin.posonlyargs, *twin.args, *twin.kwonlyargs)]
            wanted = [*arrays, "out"]
            if only_rows and given[:1] + given[2:] == [f"_{name}", *wanted] and taken == wanted:
                return
    raise failure(f"kernel.py: {name} does not evaluate _{name}", name)


def _read_assignment(target: ast.expr, value: ast.expr, body: Body, name: str) -> None:
    """One line of a private function: inputs, a statement or an output."""
    match target, value:
        case (ast.Tuple(elts=names), ast.Name(id=array)):
            _read_names(names, array, 0, body, name)
        case (
            ast.Tuple(elts=names),
            ast.Subscript(ast.Name(array), ast.Slice(ast.Constant(first))),
        ):
            _read_names(names, array, first, body, name)
        case (ast.Name(), ast.Subscript(ast.Name(array), ast.Constant(row))):
            _read_names([target], array, row, body, name)
        case (ast.Name(id="zeros"), ast.Tuple(elts=rows)):
            body.outputs += [(_row(row, name), Number(Fraction(0))) for row in rows]
        case (ast.Subscript(ast.Name("out"), ast.Tuple([ast.Name("zeros")])), ast.Constant(0.0)):
            pass  # the rows were noted where they are listed
        case (ast.Name(id=assigned), _):
            body.statements.append((assigned, _node(value, name)))
        case (ast.Subscript(ast.Name("out"), ast.Constant(int(row))), _):
            body.outputs.append((row, _node(value, name)))
        case _:
            raise failure(f"kernel.py: {ast.unparse(target)!r} is assigned", name)


def _row(tree: ast.expr, name: str) -> int:
    """A row of the table of zeros."""
    if isinstance(tree, ast.Constant) and type(tree.value) is int:
        return tree.value
    raise failure(f"kernel.py: {ast.unparse(tree)!r} is no row", name)


def _read_names(
    names: Sequence[ast.expr], array: str, first: object, body: Body, name: str
) -> None:
    """Names of consecutive rows; ``_`` is a row that is not read."""
    for offset, target in enumerate(names):
        if not isinstance(target, ast.Name) or not isinstance(first, int):
            raise failure(f"kernel.py: {ast.unparse(target)!r} is an input", name)
        if target.id != "_":
            body.inputs[target.id] = (array, first + offset)


def _node(tree: ast.expr, name: str) -> Node:
    """A node from the forms that the printer writes, and from no others."""
    match tree:
        case ast.Name(id=symbol):
            return Symbol(symbol)
        case ast.Constant(value=float(value)) if isfinite(value):
            return Number(Fraction(value))
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return Negate(_node(operand, name))
        case ast.BinOp(left=left, op=operator, right=right):
            sign = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}.get(type(operator))
            if sign:
                return joined(_node(left, name), sign, _node(right, name))
        case ast.Call(ast.Attribute(ast.Name("np"), function), [argument], []):
            if function in FUNCTIONS:
                return Call(function, _node(argument, name))
    raise failure(f"kernel.py: {ast.unparse(tree)!r} is no form of a Program", name)
