"""The target C, printing: expressions and statements.

Read next: `coadjoint.render.printers`, which does the work.
"""

from __future__ import annotations

from typing import Final

from coadjoint.lower.program import Node, Symbol, walk
from coadjoint.render.printers import WIDTH, Printer, indent

C: Final = Printer("")
#: Of vectors, on which functions of ours act.
VECTORS: Final = Printer("", "_of")


def c_text(node: Node) -> str:
    """``node`` as a C expression on one line.

    >>> from fractions import Fraction
    >>> from coadjoint.lower.program import Divide, Multiply, Negate, Number, Symbol
    >>> x, y = Symbol("x"), Symbol("y")
    >>> c_text(Divide(Negate(Negate(x)), Multiply(Number(Fraction(1, 2)), y)))
    '-(-x) / (0.5 * y)'
    """
    return C.text(node)


def c_assignment(node: Node, to: str, column: int = 4, comment: str = "") -> str:
    """``to = node;`` in C, broken at the operators if it is long; the first line is not indented.

    >>> from coadjoint.lower.program import Symbol
    >>> c_assignment(Symbol("Pi1"), to="out[0]", comment="dPi1/dt")
    'out[0] = Pi1; /* dPi1/dt */'
    """
    return _assign(C, node, to, column, f" /* {comment} */" if comment else "")


def vector_assignment(node: Node, to: str, column: int = 4) -> str:
    """The same for vectors, one number in each lane.

    >>> from fractions import Fraction
    >>> from coadjoint.lower.program import Call, Number, Symbol
    >>> vector_assignment(Call("sin", Symbol("theta")), to="const V s")
    'const V s = sin_of(theta);'
    >>> vector_assignment(Number(Fraction(1, 2)), to="_rates[0]")
    '_rates[0] = all(0.5);'
    """
    if not any(isinstance(each, Symbol) for each in walk(node)):
        return f"{to} = all({C.text(node)});"
    return _assign(VECTORS, node, to, column, "")


def _assign(printer: Printer, node: Node, to: str, column: int, note: str) -> str:
    """``to = node;`` with a note."""
    line = f"{to} = {printer.text(node)};"
    if column + len(line) + len(note) <= WIDTH:
        return line + note
    inner = printer.break_lines(node, WIDTH - column - 4 - 1)
    inner[-1] += ";"
    return indent([f"{to} ={note}", *("    " + text for text in inner)], column)


FILTERS: Final = {"c_assignment": c_assignment, "vector_assignment": vector_assignment}
