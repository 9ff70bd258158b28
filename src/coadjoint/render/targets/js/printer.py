"""The target JavaScript, printing: expressions and statements of numbers.

Read next: `coadjoint.render.printers`, which does the work.
"""

from __future__ import annotations

from typing import Final

from coadjoint.lower.program import Node, Number, Several, Symbol
from coadjoint.render.printers import WIDTH, Printer, indent

#: Words that no constant may have as its name, and names that the template uses.
_WORDS: Final = """
abstract arguments await async boolean break byte case catch char class const continue debugger
default delete do double else enum eval export extends false final finally float for from
function get goto if implements import in instanceof int interface let long native new null of
package private protected public return set short static super switch synchronized this throw
throws transient true try typeof undefined var void volatile while with yield
Infinity Math NaN Float64Array state parameters inputs time out size sums
"""
TAKEN: Final = frozenset(_WORDS.split())


def name_text(name: str) -> str:
    """A name of the spec as one of JavaScript: what is taken gets a sign that no spec has.

    >>> name_text("new"), name_text("Pi1")
    ('new$', 'Pi1')
    """
    return f"{name}$" if name in TAKEN else name


class ScriptPrinter(Printer):
    """Prints nodes as JavaScript."""

    def text(self, node: Node) -> str:
        """``node`` on one line."""
        return name_text(node.name) if isinstance(node, Symbol) else super().text(node)

    def _name(self, function: str) -> str:
        """Functions are those of ``Math``; its sign of -0 is -0, that of NumPy 0."""
        return "_sign" if function == "sign" else super()._name(function)

    def assignment(self, node: Node, to: str, column: int = 2, comment: str = "") -> str:
        """``const to = node;``, or an entry of an array; the first line is not indented.

        >>> SCRIPT.assignment(Symbol("new"), "out[0]")
        'out[0] = new$;'
        >>> SCRIPT.assignment(Symbol("Pi1"), "a")
        'const a = Pi1;'
        """
        if isinstance(node, Several):
            return self.loop(node, to, column)
        place = to if "[" in to else f"const {name_text(to)}"
        line = f"{place} = {self.text(node)};"
        if column + len(line) <= WIDTH or isinstance(node, Symbol | Number):
            return line
        inner = self.break_lines(node, WIDTH - column - 2)
        return indent([f"{place} = (", *("  " + text for text in inner), ");"], column)

    def loop(self, node: Several, to: str, column: int) -> str:
        """An array with its entries, and the loop over them that puts its results in their place.

        >>> from coadjoint.lower.program import Factors
        >>> print(SCRIPT.loop(Factors(1, (Symbol("a"),)), "f", column=0))
        const f = new Float64Array(1);
        f[0] = a;
        _factor(f, 1);
        """
        *entries, call = self._write_loop(node, to, column)
        made = f"const {to} = new Float64Array({len(entries)});"
        return indent([made, *entries, f"{call};"], column)


SCRIPT: Final = ScriptPrinter("Math.", ends_with_comma=False)
FILTERS: Final = {"script_assignment": SCRIPT.assignment, "script_name": name_text}
