"""Degrees: the degree of an expression in some names, such as those of an element of an algebra.

Comes in: a parsed tree. Goes out: its degree, or a fault where terms differ.
Read next: `coadjoint.spec.sections.symmetries`.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from coadjoint.spec.core.faults import fault_at
from coadjoint.spec.core.tree import Binary, Call, Index, Name, Negate, Node, Number, Power, fold

#: Functions that are linear in each argument, so that degrees add up.
_MULTILINEAR = ("dot", "cross", "outer", "commutator", "qmul")
#: Functions that are linear in all arguments together.
_LINEAR = (
    "trace",
    "transpose",
    "hat",
    "diag",
    "rows",
    "vector",
    "complex",
    "conjugate",
    "translation",
)


def degree_in(tree: Node, names: Sequence[str]) -> int | None:
    """The degree of an expression in some names, if all its terms have the same; None of 0.

    Raises:
        ExpressionError: They do not, or a name stands in a divisor or a function.

    >>> from coadjoint.spec.core.expressions import read_expression
    >>> degree_in(read_expression("cross(xi, r) + 2*xi"), ["xi"])
    1
    >>> degree_in(read_expression("vector(0, xi)"), ["xi"])
    1
    """
    return fold(tree, lambda node, below: _degree(node, below, names))


def _degree(node: Node, below: Sequence[int | None], names: Sequence[str]) -> int | None:
    """The degree of a node by the degrees of its parts."""
    known = [degree for degree in below if degree is not None]
    match node:
        case Number(value=value):
            return 0 if value else None
        case Name(name=name) | Index(name=name):
            return int(name in names)
        case Binary(operator="*"):
            return sum(known) if len(known) == len(below) else None
        case Call(function=function) if function in _MULTILINEAR:
            return sum(known) if len(known) == len(below) else None
        case Call(function="rotate"):
            return 2 * known[0] + known[1] if len(known) == len(below) else None
        case Power(exponent=exponent) if exponent > 0:
            return known[0] * exponent if known else None
    same = all(a == b for a, b in combinations(known, 2))
    plain = isinstance(node, (Negate, Binary)) or getattr(node, "function", "") in _LINEAR
    divided = isinstance(node, Binary) and node.operator == "/"
    if divided and not below[1]:
        return below[0]
    if any(known) and (not same or divided or (isinstance(node, (Power, Call)) and not plain)):
        problem = f"this is not linear in {names[0]!r}"
        expected = f"sums of terms that are linear in {names[0]}"
        raise fault_at(node, problem, names[0], expected)
    return known[0] if known else None if plain else 0
