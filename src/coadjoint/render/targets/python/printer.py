"""The target Python, printing: expressions and statements of numbers.

Read next: `coadjoint.render.printers`, which does the work.
"""

from __future__ import annotations

from typing import Final

from coadjoint.lower.program import Node
from coadjoint.render.printers import Printer, python_assignment

PYTHON: Final = Printer("")


def plain_assignment(node: Node, to: str, column: int = 4, comment: str = "") -> str:
    """``to = node``, as `python_assignment` has it.

    >>> from coadjoint.lower.program import Call, Negate, Symbol
    >>> plain_assignment(Negate(Call("sqrt", Symbol("Pi1"))), to="_t1")
    '_t1 = -sqrt(Pi1)'
    """
    return python_assignment(PYTHON, node, to, column, comment)


FILTERS: Final = {"plain_assignment": plain_assignment}
