"""From plain expression trees to exact field elements, vectors and matrices of them.

Comes in: a tree whose shapes the reader has checked, and values for its names. Goes out: an
element, a tuple of elements (vector) or a tuple of rows (matrix). This is the only place where a
spec's expressions become mathematics, and no text is involved.
Read next: `coadjoint.derive.setting`.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from math import ceil
from typing import Any, Final, cast

from coadjoint.errors import DerivationError
from coadjoint.exact import Element, Field
from coadjoint.exact.dense import (
    Matrix,
    add,
    apply,
    commutator,
    cross,
    determinant,
    diagonal,
    dot,
    hat,
    identity,
    inverse,
    product,
    scale,
    subtract,
    trace,
    transpose,
)
from coadjoint.exact.signs import sign
from coadjoint.exact.text import element_text
from coadjoint.exact.witness import is_nonzero
from coadjoint.groups.quaternions import Quaternion
from coadjoint.spec.core import tree

#: An element, a tuple of elements or a tuple of tuples of elements.
Value = Any

#: Addends beyond which a sum is added in pairs: one by one, the terms that stand already would be
#: copied for each further one.
LONG_SUM: Final = 64

SINGULAR = "the inverse of a singular matrix is asked for; expected det != 0."


class Values:
    """Values of which no sign has to be decided, in the place of a field: numbers, or texts."""

    zero: Any
    one: Any

    def number(self, value: Fraction) -> Any:
        """A rational number."""
        raise NotImplementedError

    def is_zero(self, value: Any) -> bool:
        """Whether a value is certainly 0."""
        raise NotImplementedError

    def is_function_free(self, _: Any) -> bool:
        """Said of every divisor: a division by 0 raises by itself."""
        return True

    def sum(self, values: Iterable[Any]) -> Any:
        """A long sum."""
        return reduce(operator.add, values, self.zero)

    def call(self, function: str, *arguments: Any) -> Any:
        """An elementary function."""
        raise NotImplementedError

    def absolute(self, value: Any) -> Any:
        """The absolute value."""
        raise NotImplementedError

    def power(self, base: Any, exponent: Any) -> Any:
        """A power with any exponent."""
        raise NotImplementedError


def interpret(node: tree.Node, values: Mapping[str, Value], field: Field) -> Value:
    """The value of a tree.

    Args:
        node: A tree whose shapes have been checked.
        values: Value of every declared name, whole quantities and components alike.
        field: Where the elements live.

    Raises:
        DerivationError: Division by zero or the inverse of a singular matrix.
    """
    known: dict[int, Value] = {}
    # definitions put into each other may be 1000 levels deep
    parts = list(tree.walk_up(node, _children))
    traced = _find_traced(parts)
    for part in parts:
        below = [known[id(child)] for child in _children(part)]
        match part:
            case tree.Binary(operator="+") if len(below) > 2:
                value = reduce(add, below) if isinstance(below[0], tuple) else field.sum(below)
            case tree.Binary(operator="/", right=tree.Power(base=base, exponent=n)) if n > 0:
                # by the base n times: a factor of its own cancels, its expanded power does not
                value, divisor = below[0], known[id(base)]
                check_divisor(divisor, field)
                for _ in range(n):
                    value = scale(1 / divisor, value)
            case tree.Binary(operator="*") if id(part) in traced and _are_matrices(below):
                value = dot(entries(below[0]), entries(transpose(below[1])))
            case tree.Call(function="trace") if not isinstance(below[0], tuple):
                value = below[0]
            case _:
                value = _value(part, below, values, field)
        known[id(part)] = value
    return known[id(node)]


def _children(node: tree.Node) -> Sequence[tree.Node]:
    """The nodes below one; of a long sum all its addends, which are then added in pairs."""
    addends, first = list[tree.Node](), node
    while isinstance(first, tree.Binary) and first.operator == "+":
        addends.append(first.right)
        first = first.left
    return [first, *reversed(addends)] if len(addends) > LONG_SUM else tree.children(node)


def _find_traced(parts: Iterable[tree.Node]) -> set[int]:
    """Products of which nothing but traces is asked for, by id: only their diagonals are needed."""
    traced, others = set[int](), set[int]()
    for part in parts:
        is_trace = isinstance(part, tree.Call) and part.function == "trace"
        (traced if is_trace else others).update(map(id, tree.children(part)))
    return traced - others


def _are_matrices(values: Iterable[Value]) -> bool:
    """Whether all values are matrices."""
    return all(isinstance(each, tuple) and isinstance(each[0], tuple) for each in values)


def _value(node: tree.Node, below: list[Value], values: Mapping[str, Value], field: Field) -> Value:
    """The value of one node from those of its children."""
    match node:
        case tree.Number(value=value):
            return field.number(value)
        case tree.Name(name=name):
            return values[name]
        case tree.Index(name=name, indices=indices):
            return _component(values[name], indices)
        case tree.Component(indices=indices):
            return _component(below[0], indices)
        case tree.Negate():
            return scale(-field.one, below[0])
        case tree.Power(exponent=exponent):
            return _power(below[0], exponent, field)
        case tree.Binary(operator="/"):
            check_divisor(below[1], field)
            return scale(1 / below[1], below[0])
        case tree.Binary(operator=symbol):
            return _BINARY[symbol](*below)
        case tree.Call(function="norm"):
            return field.call("sqrt", dot(below[0], below[0]))
        case tree.Call(function="inverse"):
            return _checked_inverse(below[0], field)
        case tree.Call(function="log") if field.is_zero(below[0]):
            raise DerivationError(
                "an expression takes the logarithm of 0; expected a positive one."
            )
        case tree.Call(function="pow"):
            return _any_power(below[0], below[1], field)
        case tree.Call(function="sign") if field.is_zero(below[0]):
            raise DerivationError("an expression takes the sign of 0; expected what is not 0.")
        case tree.Call(function="abs"):
            return _absolute(below[0], field)
        case tree.Call(function="min" | "max" as function):
            a, b = below
            size = _absolute(a - b, field)
            return (a + b + (size if function == "max" else -size)) / 2
        case tree.Call(function=function) if function in _TENSOR_FUNCTIONS:
            return _TENSOR_FUNCTIONS[function](*below)
        case tree.Call(function=function):
            return field.call(function, *below)
    raise AssertionError(node)


def _component(value: Value, indices: Iterable[int]) -> Value:
    """A component counted from 1; of a matrix with one index, a row."""
    for index in indices:
        value = value[index - 1]
    return value


def entries(value: Value) -> tuple[Element, ...]:
    """The components of a value of any shape, row by row."""
    if isinstance(value, tuple):
        return tuple(entry for part in value for entry in entries(part))
    return (value,)


def _multiply(a: Value, b: Value) -> Value:
    """Scalar times anything, matrix times vector, matrix times matrix."""
    if not isinstance(a, tuple):
        return scale(a, b)
    if not isinstance(b, tuple):
        return scale(b, a)
    return product(a, b) if isinstance(b[0], tuple) else apply(a, b)


def check_divisor(divisor: Element, field: Field) -> None:
    """Refuse to divide by what is zero, or may be zero everywhere for all that is known.

    Raises:
        DerivationError: No point of the domain shows that the divisor is not zero.
    """
    if is_nonzero(field, divisor):
        return
    if field.is_zero(divisor):
        raise DerivationError("an expression divides by zero identically; expected a divisor != 0.")
    raise DerivationError(
        "an expression divides by what may be 0 everywhere: no point was found at which the "
        "divisor is certainly not 0; expected one. Write it in simpler functions, or say in "
        "[domain] where it is defined."
    )


def _rotation(a: Value) -> Value:
    """The matrix of ``v -> a v a*`` for a quaternion, or the turning part of a pose."""
    if isinstance(a[0], tuple):
        return tuple(row[:-1] for row in a)
    return transpose(tuple(_rotate(a, axis) for axis in identity(3)))


def _rotate(a: Value, v: Value) -> Value:
    """The vector of ``a v a*``, for a quaternion of any length."""
    q = Quaternion(*a)
    return (q * Quaternion.pure(v) * q.conjugate).vector


def _diag(a: Value) -> Value:
    """A vector as a diagonal matrix; the diagonal of a matrix as a vector."""
    if isinstance(a[0], tuple):
        return tuple(row[i] for i, row in enumerate(a))
    return diagonal(a)


def _checked_inverse(a: Matrix, field: Field) -> Matrix:
    """The inverse of a matrix whose determinant is certainly not zero."""
    det = determinant(a)
    if field.is_zero(det):
        raise DerivationError(SINGULAR)
    check_divisor(det, field)
    return inverse(a)


def _power(base: Value, exponent: int, field: Field) -> Value:
    if not isinstance(base, tuple):
        if exponent < 0:
            check_divisor(base, field)
        return base**exponent
    if exponent < 0:
        base, exponent = _checked_inverse(base, field), -exponent
    result = _diag(tuple(field.one for _ in base))
    for _ in range(exponent):
        result = _multiply(result, base)
    return result


def _any_power(base: Element, exponent: Element, field: Field) -> Element:
    """A power with any exponent, of a base that is positive: ``exp(b*log(a))``.

    ``max(x, 0)^(5/2)`` is ``max(x, 0)^2*exp(log(x^2)/4)``: its slope has a value on either side of
    0, and so have its steps there, where a root of ``max(x, 0)`` has none.

    Raises:
        DerivationError: The base is not known to be positive.
    """
    if isinstance(field, Values):
        return cast(Element, field.power(base, exponent))
    number = field.as_number(exponent)
    if number is not None and number.denominator == 1:
        return cast(Element, _power(base, int(number), field))
    if number is not None and number > 1 and (clamped := find_clamped(base, field)) is not None:
        whole = ceil(number) - 1
        rest = (number - whole) / 2 * field.call("log", clamped.inside**2)
        return base**whole * field.call("exp", rest)
    if sign(field, base) != 1:
        raise DerivationError(
            f"the base of a power with the exponent {element_text(field, exponent)} is "
            f"{element_text(field, base)}, which is not known to be positive everywhere; expected "
            "a positive base, or a literal integer as exponent. Say in [domain] that the base is "
            "> 0, or declare its parameters as positive."
        )
    if number is not None and number.denominator == 2:
        return cast(Element, _power(field.call("sqrt", base), int(2 * number), field))
    return field.call("exp", exponent * field.call("log", base))


@dataclass(frozen=True)
class Clamped:
    """``max(x, 0)`` or ``abs(x)``.

    Attributes:
        inside: The x.
        is_cut: Whether it is 0 where x is negative.
    """

    inside: Element
    is_cut: bool


def find_clamped(base: Element, field: Field) -> Clamped | None:
    """A base as ``max(x, 0)`` or ``abs(x)``; None where it is something else."""
    for name in sorted(field.names_in(base) & field.adjoined.keys()):
        if field.adjoined[name].function != "sign":
            continue
        try:
            parts = field.coefficients(base, name)
        except ValueError:
            continue
        is_cut = 0 in parts
        inside = 2 * parts[0] if is_cut else parts.get(1, field.zero)
        size = _absolute(inside, field)
        if field.is_zero(base - ((inside + size) / 2 if is_cut else size)):
            return Clamped(inside, is_cut)
    return None


def _absolute(value: Element, field: Field) -> Element:
    """The absolute value: the value times its sign, which jumps where it is 0."""
    if isinstance(field, Values):
        return cast(Element, field.absolute(value))
    if field.is_zero(value):
        return field.zero
    known = sign(field, value, strict=False)
    return value * (known or field.call("sign", value))


_BINARY: dict[str, Callable[..., Value]] = {
    "+": add,
    "-": subtract,
    "*": _multiply,
}
_TENSOR_FUNCTIONS: dict[str, Callable[..., Value]] = {
    "dot": dot,
    "cross": cross,
    "hat": hat,
    "trace": trace,
    "transpose": transpose,
    "det": determinant,
    "diag": _diag,
    "outer": lambda a, b: tuple(tuple(x * y for y in b) for x in a),
    "rows": lambda *rows: rows,
    "vector": lambda *components: components,
    "complex": lambda a, b: (
        *(x + tuple(-e for e in y) for x, y in zip(a, b, strict=True)),
        *(y + x for x, y in zip(a, b, strict=True)),
    ),
    "commutator": commutator,
    "qmul": lambda a, b: (Quaternion(*a) * Quaternion(*b)).components,
    "conjugate": lambda a: Quaternion(*a).conjugate.components,
    "rotate": _rotate,
    "rotation": _rotation,
    "translation": lambda a: tuple(row[-1] for row in a),
}
