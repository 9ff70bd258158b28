"""The target JavaScript, reading: a function of ``kernel.js`` through a list of allowed forms.

Comes in: the text and the Program whose function is read. Goes out: a `Body`. An expression of the
allowed forms means the same in Python, whose `ast` reads it; statements are told apart here.
Read next: `coadjoint.render.targets.python_text`.
"""

from __future__ import annotations

import ast
import re
from fractions import Fraction

from coadjoint.lower.program import FUNCTIONS, Node, Number, Program
from coadjoint.render.targets.body import Body, read_loop
from coadjoint.render.targets.python_text import Reader

#: How a name is written here; ``$`` ends one that is a word of JavaScript.
NAME = r"[A-Za-z_][A-Za-z_0-9]*\$?"


def read(text: str, program: Program, system: str) -> list[Body]:
    """The one branch of the function of a Program; other forms than our template's fail."""
    reader = Reader("kernel.js", program.name, _called_name)
    opening = rf"^function {program.name}\(([a-z, ]*)\) \{{\n(.*?)^\}}$"
    found = re.findall(opening, text, flags=re.MULTILINE | re.DOTALL)
    if len(found) != 1:
        raise reader.refusal(f"has {len(found)} functions {program.name!r}")
    taken, inside = found[0]
    if taken.split(", ") != [*program.arrays, "out"]:
        raise reader.refusal(f"takes {taken}")
    body = Body()
    *lines, last = [line.strip() for line in re.sub(r"//.*", "", inside).split(";")]
    for line in [*lines, *([last] if last else [])]:
        _read_line(reader, " ".join(line.split()), body)
    assigned = {row for row, _ in body.outputs}
    zeros = (row for row in range(len(program.outputs)) if row not in assigned)
    body.outputs += [(row, Number(Fraction(0))) for row in zeros]
    return [body]


def _read_line(reader: Reader, line: str, body: Body) -> None:
    """One statement without its semicolon."""
    if line in ("out.fill(0.0)", "return out"):
        return
    if made := re.fullmatch(rf"const ({NAME}) = new Float64Array\((\d+)\)", line):
        body.arrays[made[1]] = int(made[2])
    elif row := re.fullmatch(rf"const ({NAME}) = (state|parameters|inputs|time)\[(\d+)\]", line):
        body.inputs[_plain(row[1])] = (row[2], int(row[3]))
    elif output := re.fullmatch(r"out\[(\d+)\] = (.*)", line):
        body.outputs.append((int(output[1]), _node(reader, output[2])))
    elif statement := re.fullmatch(rf"const ({NAME}) = (.*)", line):
        body.statements.append((_plain(statement[1]), _node(reader, statement[2])))
    elif entry := re.fullmatch(rf"({NAME})\[(\d+)\] = (.*)", line):
        body.statements.append((f"{entry[1]}[{entry[2]}]", _node(reader, entry[3])))
    elif call := re.fullmatch(rf"({NAME})\((.*)\)", line):
        loop = read_loop(call[1], call[2].split(", "), body.arrays)
        if loop is None:
            raise reader.refusal(f"{line!r} is no loop over arrays that were made")
        body.statements.append(loop)
    else:
        raise reader.refusal(f"{line[:80]!r} is not a form of a Program")


def _node(reader: Reader, text: str) -> Node:
    """A node from an expression."""
    try:
        tree = ast.parse(re.sub(rf"({NAME})", lambda name: _plain(name[1]), text), mode="eval")
    except (SyntaxError, ValueError, RecursionError) as error:
        raise reader.refusal(f"{text[:80]!r} is not an expression: {error}") from error
    return reader.node(tree.body)


def _plain(name: str) -> str:
    """A name as the spec has it; in Python a keyword gets an underscore, which is not printed."""
    return name.removesuffix("$")


def _called_name(function: ast.expr) -> str | None:
    """``sqrt`` of ``Math.sqrt``, and ``sign`` of ``_sign``."""
    match function:
        case ast.Attribute(ast.Name("Math"), name) if name in FUNCTIONS and name != "sign":
            return name
        case ast.Name("_sign"):
            return "sign"
    return None
