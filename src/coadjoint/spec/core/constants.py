"""Constants: numbers that a formula without names gives, such as ``sqrt(2)/2`` and ``pi/3``.

Comes in: a text. Goes out: the rational number that it is, exactly, or else the nearest double as a
`Rounded` number, which no proof takes for the constant. SymPy is loaded for such texts alone.
Read next: `coadjoint.spec.core.values`.
"""

from __future__ import annotations

from fractions import Fraction
from math import isinf
from typing import TYPE_CHECKING

from coadjoint.elementary import ELEMENTARY
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.faults import ExpressionError
from coadjoint.spec.core.sizes import check_size
from coadjoint.spec.core.tree import Binary, Call, Negate, Node, Number, Power, fold, walk

if TYPE_CHECKING:
    from coadjoint.exact import Element, Field


_KNOWN = {*ELEMENTARY, "tan"}


class Rounded(Fraction):
    """The double that is nearest to an irrational constant."""


def read_constant(text: str) -> Fraction:
    """The number that a formula without names is.

    Raises:
        ValueError: It is no such formula, has no value, or is too close to a number that two
            doubles are equally near to.

    >>> read_constant("cos(2*pi/3)"), read_constant("(sqrt(5) - 2)*(sqrt(5) + 2)")
    (Fraction(-1, 2), Fraction(1, 1))
    >>> float(read_constant("sqrt(2)")) ** 2
    2.0000000000000004
    """
    try:
        tree = read_expression(text)
        check_size(tree, {})
    except ExpressionError as error:
        raise ValueError(f"is not a formula of numbers: {error.problem}") from None
    others = {node.function for node in walk(tree) if isinstance(node, Call)} - _KNOWN
    if others:
        raise ValueError(f"calls {min(others)}, and only {', '.join(sorted(_KNOWN))} take numbers")
    return _value(tree)


def _value(tree: Node) -> Fraction:
    """The value of a tree of numbers, exact or rounded once."""
    from mpmath.libmp import round_nearest, to_float

    from coadjoint.exact import Field
    from coadjoint.exact.witness import UNDEFINED, enclosure

    calls = sum(isinstance(node, Call) for node in walk(tree))
    field = Field([], slots=8 * calls)
    try:
        value = fold(tree, lambda node, below: _take(field, node, below))
        number = field.as_number(field.normal(value))
        if number is not None or field.is_zero(value):
            return number or Fraction(0)
        bounds = enclosure(field, value, {}).bounds
    except UNDEFINED:
        raise ValueError("has no value") from None
    low, high = (to_float(end, rnd=round_nearest) for end in bounds._mpi_)
    if low != high or isinf(low):
        raise ValueError("is too large, or too close to the middle between two doubles")
    nearest = Rounded(low)
    return Fraction(nearest) if field.is_zero(value - field.number(nearest)) else nearest


def _take(field: Field, node: Node, below: list[Element]) -> Element:
    """A node in the exact field, by those below it."""
    match node:
        case Number(value=value):
            return field.number(value)
        case Negate():
            return -below[0]
        case Power(exponent=exponent):
            return below[0] ** exponent
        case Call(function=function):
            return field.call(function, *below)
        case Binary(operator=operator):
            left, right = below
            if operator in "+-":
                return left + right if operator == "+" else left - right
            return left * right if operator == "*" else left / right
    raise AssertionError(node)
