"""The target Python, reading: a function of ``kernel_python.py`` through a list of allowed forms.

Comes in: the text and the Program whose function is read, for its arguments and the shape of its
result. Goes out: a `Body`.
Read next: `coadjoint.render.targets.python_text`.
"""

from __future__ import annotations

import ast
from fractions import Fraction

from coadjoint.lower.program import FUNCTIONS, Node, Number, Program
from coadjoint.render.targets.body import Body
from coadjoint.render.targets.loops import unroll
from coadjoint.render.targets.python_text import Functions, LoopReader, Reader, is_table

#: What functions that loop over a table call.
HELPERS = """
def _fill_vector(rows, scales):
    scaled = [scale * rows[place] for scale, place in zip(scales, TABLE_SCALED, strict=True)]
    return [*rows, *scaled, 1.0]

def _add_products(out, passes, first):
    for row in range(len(out)):
        total = -0.0
        for left, right in passes:
            for entry in range(TABLE_STARTS[first + row], TABLE_STARTS[first + row + 1]):
                factors = left[TABLE_LEFT[entry]], right[TABLE_RIGHT[entry]]
                total += TABLE_COEFFICIENTS[entry] * factors[0] * factors[1]
        out[row] = total
"""
#: What functions that solve equations by loops call.
EQUATIONS = """
def _factor(entries, size):
    for j in range(size):
        pivot = entries[j * (j + 3) // 2]
        below = [i * (i + 1) // 2 + j for i in range(j + 1, size)]
        column = [entries[place] for place in below]
        for place in below:
            entries[place] /= pivot
        for i, place in enumerate(below):
            for k in range(i + 1):
                entries[place + k + 1] -= column[i] * entries[below[k]]

def _solve(factors, known, size):
    for i in range(1, size):
        for j in range(i):
            known[i] -= factors[i * (i + 1) // 2 + j] * known[j]
    for i in range(size):
        known[i] /= factors[i * (i + 3) // 2]
    for k in range(size - 1, 0, -1):
        for i in range(k):
            known[i] -= factors[k * (k + 1) // 2 + i] * known[k]
"""
#: What makes a matrix of a list.
ROWS = "return [out[first:first + size] for first in range(0, len(out), size)]"


def read(text: str, program: Program, system: str) -> list[Body]:
    """The one branch of the function of a Program; other forms than our template's fail."""
    reader = Reader("kernel_python.py", program.name, _called_name)
    functions = reader.functions(text, _is_allowed)
    if program.name not in functions:
        raise reader.refusal(f"there is no function {program.name!r}")
    if program.solves_by_loop:
        reader.check_helpers(functions, EQUATIONS)
    function = functions[program.name]
    taken = [each.arg for each in (*function.args.args, *function.args.kwonlyargs)]
    if taken != list(program.arrays):
        raise reader.refusal(f"takes {', '.join(taken)}", function.args)
    inside = LoopReader(reader, functions, text, HELPERS) if program.table else None
    body = Body() if inside is None else inside.loops.body
    _, *lines, last = function.body
    for line in lines:
        if not _read_start(line, program, body) and not (inside and inside.read(line)):
            reader.read(line, body)
    if inside is not None:
        body = unroll(inside.loops, program)
    _check_result(reader, functions, last, program)
    assigned = {row for row, _ in body.outputs}
    zeros = (row for row in range(len(program.outputs)) if row not in assigned)
    body.outputs += [(row, Number(Fraction(0))) for row in zeros]
    return [body]


def read_expression(text: str, name: str) -> Node:
    """A node from a Python expression; ``name`` is the function it stands in, for messages.

    >>> read_expression("-sqrt(a)", "rhs")
    Negate(operand=Call(function='sqrt', argument=Symbol(name='a'), other=None))
    """
    reader = Reader("kernel_python.py", name, _called_name)
    return reader.node(ast.parse(text.strip(), mode="eval").body)


def _called_name(function: ast.expr) -> str | None:
    """``sqrt`` of ``sqrt``."""
    return function.id if isinstance(function, ast.Name) and function.id in FUNCTIONS else None


def _is_allowed(item: ast.stmt) -> bool:
    """Whether a statement may stand between functions."""
    match item:
        case ast.ImportFrom("math", names, 0):
            return all(each.name in FUNCTIONS and each.asname is None for each in names)
        case ast.Assign(targets=[ast.Name(id="ID")], value=ast.Constant()):
            return True
    return is_table(item)


def _read_start(line: ast.stmt, program: Program, body: Body) -> bool:
    """Whether a line takes the time, or makes the list of results, with a zero for each."""
    if ast.unparse(line) == f"out = [0.0] * {len(program.outputs)}":
        return True
    for name in program.time:
        if ast.unparse(line) == f"{name} = time":
            body.inputs[name] = ("time", 0)
            return True
    return False


def _check_result(reader: Reader, functions: Functions, last: ast.stmt, program: Program) -> None:
    """A number, a list, or a list of rows is returned, as the shape has it."""
    shape = program.shape
    wanted = ["out[0]", "out", f"_rows(out, {shape[-1]})" if shape else ""][len(shape)]
    if ast.unparse(last) != f"return {wanted}":
        raise reader.refusal(f"is not what is returned, {wanted}", last)
    if len(shape) == 2:
        helper = functions.get("_rows")
        if helper is None or ast.unparse(helper.body[-1]) != ROWS or len(helper.body) != 2:
            raise reader.refusal("_rows does not make rows of a list")
        if ast.unparse(helper.args) != "out, size":
            raise reader.refusal("_rows takes other arguments", helper.args)
