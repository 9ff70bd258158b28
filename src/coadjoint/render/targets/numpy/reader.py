"""The target NumPy, reading: a function of ``kernel.py`` through a list of allowed forms.

Comes in: the text. Goes out: a `Body`.
Read next: `coadjoint.render.targets.python_text`.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from fractions import Fraction

from coadjoint.lower.program import Node, Number, Program
from coadjoint.render.targets.body import Body
from coadjoint.render.targets.loops import unroll
from coadjoint.render.targets.python_text import (
    NUMPY_FUNCTIONS,
    Functions,
    LoopReader,
    Reader,
    is_table,
)

#: What functions that loop over a table call.
HELPERS = """
def _fill_vector(rows, scales):
    scaled = [scale * rows[place] for scale, place in zip(scales, TABLE_SCALED, strict=True)]
    return np.array([*rows, *scaled, np.ones_like(rows[0])])

def _add_products(out, passes, first):
    out[...] = -0.0
    starts = np.array(TABLE_STARTS[first : first + len(out) + 1])
    coefficients = np.array(TABLE_COEFFICIENTS)
    lefts, rights = np.array(TABLE_LEFT), np.array(TABLE_RIGHT)
    for left, right in passes:
        for place in range(np.diff(starts).max()):
            rows = np.flatnonzero(starts[:-1] + place < starts[1:])
            entries = starts[rows] + place
            products = (coefficients[entries] * left[lefts[entries]].T).T
            products *= right[rights[entries]]
            out[rows] += products
"""
#: What functions that solve equations by loops call.
EQUATIONS = """
def _factor(entries, size):
    rows = np.array(np.broadcast_arrays(*entries))
    starts = np.arange(size) * np.arange(1, size + 1) // 2
    for j in range(size - 1):
        below = starts[j + 1 :] + j
        column = rows[below]
        rows[below] = column / rows[starts[j] + j]
        i, k = np.tril_indices(size - j - 1)
        rows[below[i] + k + 1] -= column[i] * rows[below[k]]
    entries[:] = rows

def _solve(factors, known, size):
    both = np.array(np.broadcast_arrays(*factors, *known))
    rows, x = both[:-size], both[-size:]
    starts = np.arange(size) * np.arange(1, size + 1) // 2
    for j in range(size - 1):
        x[j + 1 :] -= rows[starts[j + 1 :] + j] * x[j]
    x /= rows[starts + np.arange(size)]
    for k in range(size - 1, 0, -1):
        x[:k] -= rows[starts[k] : starts[k] + k] * x[k]
    known[:] = x
"""


def read(text: str, program: Program, system: str) -> list[Body]:
    """The one branch of a function of a ``kernel.py``; other forms than our template's fail."""
    name, reader = program.name, _reader(program.name)
    functions = reader.functions(text, _is_allowed)
    for wanted in (name, f"_{name}"):
        if wanted not in functions:
            raise reader.refusal(f"there is no function {wanted!r}")
    _check_calls(reader, functions, tuple(program.arrays))
    if program.solves_by_loop:
        reader.check_helpers(functions, EQUATIONS)
    if program.table is not None:
        return [_read_loops(reader, functions, text, program)]
    body = Body()
    for line in functions[f"_{name}"].body:
        if not _read_zeros(reader, line, body):
            reader.read(line, body)
    return [body]


def _read_loops(reader: Reader, functions: Functions, text: str, program: Program) -> Body:
    """A function that loops over a table, with all sums written out."""
    inside = LoopReader(reader, functions, text, HELPERS)
    for line in functions[f"_{program.name}"].body:
        if not inside.read(line):
            reader.read(line, inside.loops.body)
    return unroll(inside.loops, program)


def read_expression(text: str, name: str) -> Node:
    """A node from a Python expression; ``name`` is the function it stands in, for messages.

    >>> read_expression("-np.sqrt(a)", "rhs")
    Negate(operand=Call(function='sqrt', argument=Symbol(name='a'), other=None))
    """
    return _reader(name).node(ast.parse(text.strip(), mode="eval").body)


def _reader(name: str) -> Reader:
    return Reader("kernel.py", name, find_function)


def find_function(function: ast.expr) -> str | None:
    """``sqrt`` of ``np.sqrt``."""
    match function:
        case ast.Attribute(ast.Name("np"), called):
            return NUMPY_FUNCTIONS.get(called)
    return None


def _is_allowed(item: ast.stmt) -> bool:
    """Whether a statement may stand between functions."""
    match item:
        case ast.Import():
            return True
        case ast.Assign(targets=[ast.Name(id="ID" | "CHUNK")], value=ast.Constant()):
            return True
    return is_table(item)


def _check_calls(reader: Reader, functions: Functions, arrays: Sequence[str]) -> None:
    """The public function hands its private twin and all arrays to the loop over members."""
    name = reader.name
    twin = functions[f"_{name}"].args
    match functions[name].body:
        case [ast.Expr(), ast.Return(value=ast.Call(ast.Name("_over_members"), args, rows))]:
            given = [ast.unparse(argument) for argument in args]
            only_rows = [each.arg for each in rows] in ([], ["n"])
            taken = [each.arg for each in (*twin.posonlyargs, *twin.args, *twin.kwonlyargs)]
            wanted = [*arrays, "out"]
            if only_rows and given[:1] + given[2:] == [f"_{name}", *wanted] and taken == wanted:
                return
    raise reader.refusal(f"{name} does not evaluate _{name}")


def _read_zeros(reader: Reader, line: ast.stmt, body: Body) -> bool:
    """Whether a line is one of the two that set a table of rows to zero."""
    match line:
        case ast.Assign([ast.Name("zeros")], ast.Tuple(elts=rows)):
            for row in rows:
                if not isinstance(row, ast.Constant) or type(row.value) is not int:
                    raise reader.refusal("is not a row", row)
                body.outputs.append((row.value, Number(Fraction(0))))
            return True
        case ast.Assign(
            [ast.Subscript(ast.Name("out"), ast.Tuple([ast.Name("zeros")]))], ast.Constant(0.0)
        ):
            return True  # the rows were noted where they are listed
    return False
