"""Cross-check, reading: emitted text, parsed back, equals the Program it was printed from.

Comes in: a Program and the texts of ``kernel.py`` and ``kernel.c``. Goes out: nothing, or a
`CrossCheckError` that names the function and the line. Numbers are compared as doubles.
Read next: `coadjoint.crosscheck.oracle`.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import zip_longest
from operator import itemgetter

from coadjoint.crosscheck.body import Body, failure
from coadjoint.crosscheck.read_c import read_c
from coadjoint.crosscheck.read_python import read_python
from coadjoint.errors import CrossCheckError
from coadjoint.lower.program import Add, Call, Divide, Multiply, Negate, Node, Number, Program


def check_python(program: Program, text: str) -> None:
    """The function of ``program`` in a ``kernel.py`` reads back as the Program.

    Raises:
        CrossCheckError: It does not; the message names the first difference.
    """
    _check_same(program, read_python(text, program.name), "kernel.py")


def check_c(program: Program, text: str, system: str) -> None:
    """Both branches of the function of ``program`` in a ``kernel.c`` read back as the Program.

    Raises:
        CrossCheckError: One does not; the message names the first difference.
    """
    for body in read_c(text, f"{system}_{program.name}"):
        _check_same(program, body, "kernel.c")


def as_printed(node: Node) -> Node:
    """A node with each number as the nearest double, a negative one as a sign before a positive.

    >>> as_printed(Number(Fraction(-1, 2)))
    Negate(operand=Number(value=Fraction(1, 2)))
    """
    match node:
        case Number(value=value):
            nearest = Number(Fraction(abs(value.numerator / value.denominator)))
            return Negate(nearest) if value < 0 else nearest
        case Negate(operand=operand):
            return Negate(as_printed(operand))
        case Call(function=function, argument=argument):
            return Call(function, as_printed(argument))
        case Add(left=left, right=right):
            return Add(as_printed(left), as_printed(right))
        case Multiply(left=left, right=right):
            return Multiply(as_printed(left), as_printed(right))
        case Divide(left=left, right=right):
            return Divide(as_printed(left), as_printed(right))
    return node


def _check_same(program: Program, body: Body, file: str) -> None:
    """The body does what the Program says: inputs, statements and outputs, in order."""
    rows = {name: ("state", row) for row, name in enumerate(program.state)}
    rows |= {name: ("parameters", row) for row, name in enumerate(program.parameters)}
    wanted = {name: rows[name] for name in sorted(program.used() & rows.keys())}
    read = {name: body.inputs[name] for name in sorted(body.inputs)}
    if read != wanted:
        raise _difference(program, file, "inputs", read, wanted)
    statements = [(each.name, as_printed(each.value)) for each in program.statements]
    outputs = [(row, as_printed(each.value)) for row, each in enumerate(program.outputs)]
    for found, expected in (
        *zip_longest(body.statements, statements),
        *zip_longest(sorted(body.outputs, key=itemgetter(0)), outputs),
    ):
        if found != expected:
            what = str((expected or found)[0])
            raise _difference(program, file, f"the line of {what}", found, expected)


def _difference(
    program: Program, file: str, what: str, found: object, expected: object
) -> CrossCheckError:
    """A difference between text and Program."""
    return failure(
        f"{file}, {program.name}: {what} reads back as {found}; expected {expected}. "
        "The printer, the template or the reader is wrong",
        program.name,
        file=file,
        found=str(found),
        expected=str(expected),
    )
