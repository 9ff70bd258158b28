"""The target C, printing: expressions and statements.

Read next: `coadjoint.render.printers`, which does the work.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from coadjoint.lower.program import Node, Several, Symbol, walk
from coadjoint.render.printers import WIDTH, Printer, indent
from coadjoint.render.targets.c.numbers import in_numbers


class CPrinter(Printer):
    """Writes nodes and assignments in C."""

    loop_prefix = "coadjoint"

    def assignment(self, node: Node, to: str, column: int = 4, comment: str = "") -> str:
        """``to = node;``, broken at the operators if it is long; the first line is not indented.

        >>> from coadjoint.lower.program import Symbol
        >>> C.assignment(Symbol("Pi1"), to="out[0]", comment="dPi1/dt")
        'out[0] = Pi1; /* dPi1/dt */'
        """
        if isinstance(node, Several):
            return self.loop(node, to, column)
        note = f" /* {comment} */" if comment else ""
        line = f"{to} = {self.text(node)};"
        if column + len(line) + len(note) <= WIDTH:
            return line + note
        inner = self.break_lines(node, WIDTH - column - 4 - 1)
        inner[-1] += ";"
        return indent([f"{to} ={note}", *("    " + text for text in inner)], column)

    def loop(self, node: Several, to: str, column: int) -> str:
        """An array with its entries, and the loop over them that puts its results in their place.

        >>> from coadjoint.lower.program import Factors, Symbol
        >>> print(C.loop(Factors(1, (Symbol("a"),)), "const double f", column=0))
        double f[1];
        f[0] = a;
        coadjoint_factor(f, 1);
        """
        kind, name = to.removeprefix("const ").split()
        *entries, last = self._write_loop(node, name, column)
        return indent([f"{kind} {name}[{len(entries)}];", *entries, f"{last};"], column)


def own_assignment(node: Node, to: str, prefix: str) -> str:
    """An assignment in a file that has a prefix of its own for the functions that it defines.

    >>> from coadjoint.lower.program import Call
    >>> own_assignment(Call("sign", Symbol("v")), "s", "top_")
    's = top_sign(v);'
    """
    return replace(C, names={"sign": f"{prefix}sign"}).assignment(node, to)


class VectorPrinter(CPrinter):
    """Writes assignments to vectors, which have one number in each lane."""

    def assignment(self, node: Node, to: str, column: int = 4, comment: str = "") -> str:
        """``to = node;``, where a number goes to all lanes.

        >>> from fractions import Fraction
        >>> from coadjoint.lower.program import Call, Number
        >>> VECTORS.assignment(Call("sin", Symbol("theta")), to="const V s")
        'const V s = sin_of(theta);'
        >>> VECTORS.assignment(Number(Fraction(1, 2)), to="_rates[0]")
        '_rates[0] = all(0.5);'
        """
        if isinstance(node, Several) or any(isinstance(each, Symbol) for each in walk(node)):
            return super().assignment(node, to, column, comment)
        return f"{to} = all({C.text(node)});"

    def argument(self, node: Node) -> str:
        """``node`` as the argument of a function of vectors.

        >>> from fractions import Fraction
        >>> from coadjoint.lower.program import Call, Number
        >>> VECTORS.text(Call("atan2", Symbol("y"), Number(Fraction(1))))
        'atan2_of(y, all(1.0))'
        """
        if any(isinstance(each, Symbol) for each in walk(node)):
            return self.text(node)
        return f"all({C.text(node)})"


C: Final = CPrinter("", ends_with_comma=False)
VECTORS: Final = VectorPrinter("", "_of", ends_with_comma=False)
FILTERS: Final = {
    "c_assignment": C.assignment,
    "vector_assignment": VECTORS.assignment,
    "own_assignment": own_assignment,
    "in_numbers": in_numbers,
}
