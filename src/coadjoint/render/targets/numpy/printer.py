"""The target NumPy, printing: expressions and statements over arrays.

Read next: `coadjoint.render.printers`, which does the work.
"""

from __future__ import annotations

from typing import Final

from coadjoint.lower.program import Node
from coadjoint.render.printers import Printer, python_assignment

NUMPY: Final = Printer("np.")


def numpy_text(node: Node) -> str:
    """``node`` as a NumPy expression on one line.

    >>> from coadjoint.lower.program import Add, Call, Multiply, Negate, Symbol
    >>> x, y = Symbol("x"), Symbol("y")
    >>> numpy_text(Add(Multiply(x, Add(x, y)), Negate(Call("sqrt", y))))
    'x * (x + y) - np.sqrt(y)'
    """
    return NUMPY.text(node)


def numpy_assignment(node: Node, to: str, column: int = 4, comment: str = "") -> str:
    """``to = node``, as `python_assignment` has it.

    >>> from coadjoint.lower.program import Symbol
    >>> numpy_assignment(Symbol("Pi1"), to="out[0]", comment="dPi1/dt")
    'out[0] = Pi1  # dPi1/dt'
    """
    return python_assignment(NUMPY, node, to, column, comment)


FILTERS: Final = {"numpy_assignment": numpy_assignment}
