"""Trees of specs as formulas of a book: ``dot(Gamma, chi)`` is a product with a dot.

Comes in: a tree of `coadjoint.spec.core.tree`, and which of its names are vectors. Goes out: a
`Written`. Read next: `coadjoint.notation.elements`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Final

from coadjoint.notation.functions import CALLS, raise_mark, write_noise, write_rate, write_sum
from coadjoint.notation.names import differential, differentiate_along, name, partial
from coadjoint.notation.written import (
    ATOM,
    PI,
    Written,
    add,
    attach,
    bracket,
    call,
    divide,
    literal,
    matrix,
    multiply,
    negate,
    number,
    power,
)
from coadjoint.spec.core import tree
from coadjoint.spec.core.components import Shape

#: Functions that only printed lines of noise have: the differential of a name, a rate times dt, and
#: a vector times the increment of a process.
DIFFERENTIAL: Final = "differential_of"
IN_TIME: Final = "in_time"
BY_PROCESS: Final = "by_process"
#: Functions whose value is a matrix.
_MATRICES: Final = frozenset(
    ["transpose", "inverse", "hat", "diag", "outer", "rows", "commutator", "rotation"]
)


def write_tree(
    node: tree.Node, shapes: Mapping[str, Shape], names: Mapping[str, Written] | None = None
) -> Written:
    r"""A tree as a formula.

    Args:
        node: The tree.
        shapes: Shapes of whole quantities by name; those of vectors are bold.
        names: How some names are written, in the place of their own way.

    >>> from coadjoint.spec.core.expressions import read_expression
    >>> formula = read_expression("m*g*dot(Gamma, chi)/2")
    >>> shapes = {"Gamma": (3,), "chi": (3,)}
    >>> write_tree(formula, shapes).text
    '1/2 m g Gamma . chi'
    >>> write_tree(formula, shapes).latex
    '\\frac{1}{2}\\,m\\,g\\,\\boldsymbol{\\Gamma} \\cdot \\boldsymbol{\\chi}'
    """
    known = names or {}

    def write_name(text: str) -> Written:
        if text in known:
            return known[text]
        if text == "pi" and text not in shapes:
            return PI
        return name(text, bold=len(shapes.get(text, ())) == 1)

    def value(part: tree.Node, below: list[Written]) -> Written:
        match part:
            case tree.Number(value=exact):
                return number(exact)
            case tree.Name(name=text):
                return write_name(text)
            case tree.Index(name=text, indices=indices):
                row = len(shapes.get(text, ())) == 2 and len(indices) == 1
                component = _number(text, indices, shapes.get(text, ()))
                if component in known:
                    return known[component]
                base = known[text] if text in known else name(text, bold=row)
                whole = attach(base, below=[number(i) for i in indices])
                return replace(whole, text=_number(base.text, indices, shapes.get(text, ())))
            case tree.Member(name=text, indices=indices):
                whole = name(text, bold=len(shapes.get(text, ())) == 1 and not indices)
                place = _place(part)
                made = attach(whole, below=[place, *map(number, indices)])
                return replace(made, text=f"{text}[{', '.join([place.text, *map(str, indices)])}]")
            case tree.Entry(name=text):
                places = ", ".join(each.text for each in below)
                return replace(attach(name(text), below=below), text=f"{text}[{places}]")
            case tree.Component(indices=indices):
                whole = bracket(below[0], ATOM)
                made = attach(whole, below=[number(i) for i in indices])
                return replace(made, text=f"{whole.text}_{','.join(map(str, indices))}")
            case tree.Negate():
                return negate(below[0])
            case tree.Power(exponent=exponent):
                return power(below[0], exponent)
            case tree.Binary(operator="+"):
                return add(below)
            case tree.Binary(operator="-"):
                return add([below[0], negate(below[1])])
            case tree.Binary(operator="*", left=left):
                # A b x c could be taken for (A b) x c
                parted = below[1].between and _is_matrix(left, shapes)
                return multiply([below[0], bracket(below[1], ATOM)] if parted else below)
            case tree.Binary(operator="/"):
                return _divide(part, *below)
            case tree.Sum(indices=indices, sign=sign):
                return write_sum(indices, below, sign)
            case tree.Call(function="atan", arguments=(tree.Number(value=1),)):
                return multiply([number(Fraction(1, 4)), PI])
            case tree.Call(function="diag", arguments=(tree.Call(function="vector") as entries,)):
                return call("diag", [write_tree(each, shapes, names) for each in entries.arguments])
            case tree.Call(function="rate_of", arguments=(tree.Index() as of,)) if (
                len(of.indices) == 1 and len(shapes.get(of.name, ())) == 2
            ):
                whole = name(of.name, bold=True)
                shown = attach(whole, below=[number(i) for i in of.indices], dot=True)
                return replace(shown, text=f"d{below[0].text}/dt")
            case tree.Call(function="rate_of", arguments=(tree.Name(name=text),)):
                written = name(text, bold=len(shapes.get(text, ())) == 1, dot=True)
                return written if text not in known else write_rate(below[0])
            case tree.Call(function="rate_of", arguments=(tree.Member() as of,)) if not of.indices:
                whole = name(of.name, bold=len(shapes.get(of.name, ())) == 1)
                place = _place(of)
                shown = attach(whole, below=[place], dot=True)
                return replace(shown, text=f"d{of.name}[{place.text}]/dt")
            case tree.Call(function="rate_of"):
                return write_rate(below[0])
            case tree.Call(function="slope_of"):
                return partial(*below)
            case tree.Call(function="along_space"):
                return differentiate_along(below[0])
            case tree.Call(function="differential_of"):
                return differential(below[0])
            case tree.Call(function="in_time"):
                return multiply([below[0], name("dt")])
            case tree.Call(function="by_process"):
                return write_noise(*below)
            case tree.Call(function="rows", arguments=rows) if all(map(_is_vector, rows)):
                lines = [row.arguments for row in rows if isinstance(row, tree.Call)]
                return matrix([[write_tree(one, shapes, names) for one in line] for line in lines])
            case tree.Call(
                function="inverse",
                arguments=(tree.Call(function="transpose", arguments=(turned,)),),
            ):
                return raise_mark(write_tree(turned, shapes, names), "-T", "−⊤")
            case tree.Call(function=function) if function in CALLS:
                return CALLS[function](*below)
            case tree.Call(function=function):
                return call(function, below)
        raise AssertionError(part)

    return tree.fold(node, value)


def _number(text: str, indices: Sequence[int], shape: Shape) -> str:
    """A component as it is called where components are written out: ``Pi1``, ``M_1_10``."""
    joint = "_" if len(indices) == 2 and max(*shape, *indices) > 9 else ""
    lead = f"{text}_" if joint or text[-1].isdigit() else text
    return lead + joint.join(map(str, indices))


def _is_matrix(node: tree.Node, shapes: Mapping[str, Shape]) -> bool:
    """Whether a factor is a matrix, as far as it is seen by its names and functions."""
    match node:
        case tree.Name(name=text):
            return len(shapes.get(text, ())) == 2
        case tree.Call(function=function):
            return function in _MATRICES
        case tree.Binary(operator="*", left=left, right=right):
            return _is_matrix(left, shapes) and _is_matrix(right, shapes)
    return False


def _is_vector(node: tree.Node) -> bool:
    """Whether a vector is written out by its components."""
    return isinstance(node, tree.Call) and node.function == "vector"


def _place(member: tree.Member) -> Written:
    """The place of a member: ``i+1``."""
    own = literal(member.index)
    if not member.shift:
        return own
    shifted = add([own, number(member.shift)])
    return replace(shifted, text=shifted.text.replace(" ", ""))


def _divide(node: tree.Binary, top: Written, bottom: Written) -> Written:
    """A fraction; a plain number below stands before what it divides."""
    if isinstance(node.right, tree.Number) and not isinstance(node.left, tree.Number | tree.Name):
        return multiply([number(1 / node.right.value), top])
    return divide(top, bottom)
