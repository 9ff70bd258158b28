"""Cross-check, reading: emitted text, parsed back, equals the Program it was printed from.

Comes in: a Program and the text of a kernel of any target. Goes out: nothing, or a
`CrossCheckError` that names the function and the line. Numbers are compared as doubles.
Read next: `coadjoint.crosscheck.oracle`.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import zip_longest
from operator import itemgetter

from coadjoint.errors import CrossCheckError
from coadjoint.lower.program import (
    Item,
    Negate,
    Node,
    Number,
    Program,
    Symbol,
    children,
    with_children,
    write_entries,
)
from coadjoint.render.targets.body import Body, failure
from coadjoint.render.targets.protocol import Target


def check_text(program: Program, target: Target, text: str, system: str) -> int:
    """Each branch of the function of a Program in the text of a kernel reads back as the Program.

    Args:
        program: The function.
        target: The language of the text.
        text: Of the kernel.
        system: Name of the system.

    Returns:
        How many lines were compared, in all branches together.

    Raises:
        CrossCheckError: It does not; the message names the first difference.
    """
    bodies = target.read(text, program, system)
    return sum(_check_same(program, body, target.kernel) for body in bodies)


def as_printed(node: Node) -> Node:
    """A node with each number as the nearest double, a negative one as a sign before a positive.

    >>> as_printed(Number(Fraction(-1, 2)))
    Negate(operand=Number(value=Fraction(1, 2)))
    """
    if isinstance(node, Number):
        nearest = Number(Fraction(abs(node.value.numerator / node.value.denominator)))
        return Negate(nearest) if node.value < 0 else nearest
    if isinstance(node, Item) and isinstance(node.of, Symbol):
        return Symbol(f"{node.of.name}[{node.place}]")
    return with_children(node, map(as_printed, children(node)))


def printed_lines(name: str, value: Node) -> list[tuple[str, Node]]:
    """The lines of a statement with their nodes as texts have them."""
    return [(line, as_printed(each)) for line, each in write_entries(name, value)]


def _check_same(program: Program, body: Body, file: str) -> int:
    """The body does what the Program says: inputs, statements and outputs, in order.

    Returns:
        How many lines were compared.
    """
    rows = {
        name: (array, row)
        for array, names in program.arrays.items()
        for row, name in enumerate(names)
    }
    wanted = {name: rows[name] for name in sorted(program.names_used() & rows.keys())}
    read = {name: body.inputs[name] for name in sorted(body.inputs)}
    if read != wanted:
        raise _difference(program, file, "inputs", read, wanted)
    statements = [
        line for each in program.statements for line in printed_lines(each.name, each.value)
    ]
    outputs = [(row, as_printed(each.value)) for row, each in enumerate(program.outputs)]
    lines = [
        *zip_longest(body.statements, statements),
        *zip_longest(sorted(body.outputs, key=itemgetter(0)), outputs),
    ]
    for line, expected in lines:
        if line != expected:
            what = str((expected or line)[0])
            raise _difference(program, file, f"the line of {what}", line, expected)
    return len(lines)


def _difference(
    program: Program, file: str, what: str, line: object, expected: object
) -> CrossCheckError:
    """A difference between text and Program."""
    return failure(
        f"{file}, {program.name}: {what} reads back as {line}; expected {expected}. "
        "The printer, the template or the reader is wrong",
        program.name,
        file=file,
        found=str(line),
        expected=str(expected),
    )
