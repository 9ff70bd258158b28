"""Sizes: how large an expression would grow if it were multiplied out, estimated before it is.

Comes in: a tree whose shapes fit. Goes out: nothing, or an `ExpressionError` that names the limit.
The estimate is of the most terms, the highest degree and the longest coefficient of any component;
a quotient counts as a product with the inverse of its divisor as a new name. What it lets through
and is still too much ends at the time limit of the derivation.
Read next: `coadjoint.spec.reader`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import ceil, comb, factorial

from coadjoint import limits
from coadjoint.elementary import ELEMENTARY, has_constant_value
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.faults import ExpressionError, fault_at
from coadjoint.spec.core.shapes import PIECEWISE, QUATERNION, SCALAR, shapes
from coadjoint.spec.core.tree import (
    Binary,
    Call,
    Component,
    Negate,
    Node,
    Number,
    Power,
    children,
    fold,
)


@dataclass(frozen=True)
class Size:
    """The estimate for one node.

    Attributes:
        terms: Terms of the largest component.
        degree: Degree in all names together.
        bits: Bits of numerator and denominator of the longest coefficient.
        diagonal: Whether the value is a diagonal matrix.
        constant: Exact value of a constant, or None.
        fixed: Whether no name occurs in it; ``sqrt(2)`` is fixed and has no exact value.
    """

    terms: int = 1
    degree: int = 0
    bits: int = 0
    diagonal: bool = False
    constant: Fraction | None = None
    fixed: bool = False


#: Functions that have values at all numbers, none of them large.
OF_NUMBERS = ("sin", "cos", "tan", "tanh", "atan")
_BY_NAME: dict[str, Callable[..., Fraction]] = {"abs": abs, "min": min, "max": max}


def check_size(tree: Node, scope: Mapping[str, Shape]) -> int:
    """Refuse an expression that would grow beyond the limits.

    Returns:
        The terms that it has after multiplying out, estimated.

    Raises:
        ExpressionError: A limit is passed, a constant is divided by zero, or a function is applied
            to a constant where it has no value.

    >>> from coadjoint.spec.core.expressions import read_expression
    >>> check_size(read_expression("(x + 1)^32"), {"x": ()})
    33
    """
    shape = shapes(tree, scope)

    def measure(node: Node, below: list[Size]) -> Size:
        size = _size(node, below, [shape[id(child)] for child in children(node)])
        _check(node, size)
        return size

    return fold(tree, measure).terms


def _check(node: Node, size: Size) -> None:
    for value, limit, what in (
        (size.terms, "EXPANDED_TERMS", "terms after multiplying out"),
        (size.degree, "EXPANDED_DEGREE", "as degree after multiplying out"),
        (size.bits, "CONSTANT_BITS", "bits in a constant"),
    ):
        if value > getattr(limits, limit):
            known = str(value) if value < 10**12 else "over 10^12"
            raise _refusal(node, limit, f"the expression has about {known} {what}")


def _size(node: Node, below: list[Size], shape: list[Shape]) -> Size:
    """The size of a node from sizes and shapes of its children."""
    match node:
        case Number(value=value):
            return _constant(value)
        case Negate():
            return _negate(below[0])
        case Power(exponent=exponent):
            return _power(node, below[0], exponent, shape[0])
        case Binary(operator="*"):
            return _product(below[0], below[1], _count_products(below, shape))
        case Binary(operator="/"):
            return _quotient(node, *below)
        case Binary(operator=operator):
            return _sum(below[0], _negate(below[1]) if operator == "-" else below[1])
        case Component():
            return replace(below[0], diagonal=False, constant=None)
        case Call(function="pow"):
            return _any_power(node, *below)
        case Call(function=function) if function in PIECEWISE:
            return _piecewise(function, below)
        case Call(function=function) if function in SCALAR:
            return _function(node, function, below)
        case Call(function=function):
            return _tensor(node, function, below, shape)
    return Size(degree=1)


def _constant(value: Fraction) -> Size:
    bits = value.numerator.bit_length() + value.denominator.bit_length()
    return Size(bits=bits, constant=value, fixed=True)


def _negate(a: Size) -> Size:
    return a if a.constant is None else _constant(-a.constant)


def _sum(a: Size, b: Size) -> Size:
    if a.constant is not None and b.constant is not None:
        return _constant(a.constant + b.constant)
    return Size(
        terms=a.terms + b.terms,
        degree=max(a.degree, b.degree),
        bits=max(a.bits, b.bits) + 1,
        diagonal=a.diagonal and b.diagonal,
        fixed=a.fixed and b.fixed,
    )


def _product(a: Size, b: Size, summed: int = 1) -> Size:
    """A product that adds up ``summed`` products of components."""
    if a.constant is not None and b.constant is not None:
        return _constant(a.constant * b.constant)
    return Size(
        terms=summed * a.terms * b.terms,
        degree=a.degree + b.degree,
        bits=a.bits + b.bits + summed.bit_length() - 1,
        diagonal=a.diagonal and b.diagonal,
        fixed=a.fixed and b.fixed,
    )


def _count_products(below: list[Size], shape: list[Shape]) -> int:
    """How many products of components a component of a product adds up."""
    left, right = shape
    return left[1] if left and right and not any(part.diagonal for part in below) else 1


def _quotient(node: Node, a: Size, b: Size) -> Size:
    if b.constant is None:
        return _product(a, Size(terms=1, degree=b.degree, bits=b.bits, fixed=b.fixed))
    if b.constant == 0:
        raise _no_value(node, "the expression divides by zero", "a divisor other than 0")
    return _product(a, _constant(1 / b.constant))


def _power(node: Node, base: Size, exponent: int, shape: Shape) -> Size:
    if base.constant is not None:
        if base.constant == 0 and exponent < 0:
            raise _no_value(node, "the expression divides by zero", "a base other than 0")
        if base.bits * abs(exponent) > 2 * limits.CONSTANT_BITS:  # too long to be worked out
            return Size(bits=base.bits * abs(exponent))
        return _constant(base.constant**exponent)
    n = abs(exponent)
    if shape and not base.diagonal:
        terms = (shape[0] ** max(n - 1, 0)) * base.terms**n
        if exponent < 0:
            terms *= factorial(shape[0])
    else:
        terms = comb(n + base.terms - 1, n)
    carries = base.terms.bit_length() if base.terms > 1 else 0
    bits = n * (base.bits + carries)
    return Size(
        terms=terms, degree=n * base.degree, bits=bits, diagonal=base.diagonal, fixed=base.fixed
    )


def _any_power(node: Node, base: Size, exponent: Size) -> Size:
    """A power by a root, or by an exponential and a logarithm."""
    if base.constant is not None and base.constant <= 0:
        raise _no_value(node, f"a power of {base.constant}", "a positive base")
    number = exponent.constant
    if number is not None and abs(number) > limits.EXPONENT:
        raise _refusal(node, "EXPONENT", f"the exponent is {number}")
    if number is not None and number.denominator <= 2:
        return _power(node, replace(base, constant=None), ceil(abs(number)), ())
    return Size(fixed=base.fixed and exponent.fixed, degree=base.degree + 1)


def _piecewise(function: str, arguments: Sequence[Size]) -> Size:
    """An absolute value, a minimum or a maximum: a sum of products with signs."""
    known = [each.constant for each in arguments if each.constant is not None]
    if len(known) == len(arguments):
        return _constant(_BY_NAME[function](*known))
    return _product(_largest(list(arguments)), Size(terms=2, degree=1))


def _function(node: Node, function: str, arguments: Sequence[Size]) -> Size:
    """An elementary function: a new name; a constant argument must be within the limits."""
    if not all(argument.fixed for argument in arguments):
        return Size(degree=1)
    if function in OF_NUMBERS or (function == "sqrt" and arguments[0].constant is None):
        return Size(fixed=True)
    values = tuple(argument.constant or Fraction(0) for argument in arguments)
    if any(each.constant is None for each in arguments) or max(map(abs, values)) > (
        limits.FUNCTION_ARGUMENT
    ):
        raise _refusal(
            node, "FUNCTION_ARGUMENT", f"{function} of a constant that is not a small rational"
        )
    if function in ELEMENTARY and not has_constant_value(function, values):
        problem = f"{function} of {', '.join(map(str, values))} is not a real number"
        if function in ("asin", "acos") and abs(values[0]) == 1:
            problem = f"{function} of {values[0]} is written without a function"
        raise _no_value(node, problem, ELEMENTARY[function].expects)
    return Size(fixed=True)


def _tensor(node: Node, function: str, below: list[Size], shape: list[Shape]) -> Size:
    """A function that is made of sums and products."""
    a, n = below[0], (*shape[0], 1)[0]
    match function:
        case "dot":
            return _product(a, below[1], n)
        case "outer":
            return _product(a, below[1])
        case "rows" | "vector" | "complex":
            return _largest(below)
        case "cross":
            return _product(a, below[1], 2)
        case "qmul":
            return _product(a, below[1], n)
        case "rotate":
            return _product(_product(a, a, 4), below[1], 3)
        case "rotation" if shape[0] == QUATERNION:
            return _product(a, a, 4)
        case "commutator":
            products = _product(a, below[1], _count_products(below, shape))
            return _sum(products, products)
        case "trace":
            return Size(terms=n * a.terms, degree=a.degree, bits=a.bits + n.bit_length())
        case "diag":
            return Size(terms=a.terms, degree=a.degree, bits=a.bits, diagonal=len(shape[0]) == 1)
        case "transpose":
            return a
        case "conjugate" | "rotation" | "translation":
            return replace(a, diagonal=False, constant=None)
        case "hat":
            return Size(terms=a.terms, degree=a.degree, bits=a.bits)
        case "norm":
            _check(node, _product(a, a, n))
            return Size(degree=1)
        case "det":
            return _determinant(a, n)
        case "inverse":
            _check(node, _determinant(a, n))
            cofactor = _determinant(a, n - 1) if not a.diagonal else Size()
            return Size(
                terms=cofactor.terms,
                degree=n * a.degree,
                bits=n * a.bits + n.bit_length(),
                diagonal=a.diagonal,
            )
    raise AssertionError(function)


def _largest(parts: list[Size]) -> Size:
    """The size of a vector or matrix by its parts."""
    return Size(
        terms=max(part.terms for part in parts),
        degree=max(part.degree for part in parts),
        bits=max(part.bits for part in parts),
        fixed=all(part.fixed for part in parts),
    )


def _determinant(a: Size, n: int) -> Size:
    products = 1 if a.diagonal else factorial(n)
    return Size(
        terms=products * a.terms**n, degree=n * a.degree, bits=n * a.bits + products.bit_length()
    )


def _refusal(node: Node, limit: str, problem: str) -> ExpressionError:
    return fault_at(node, problem, problem, limit=limit)


def _no_value(node: Node, problem: str, expected: str) -> ExpressionError:
    return fault_at(node, problem, problem, expected)
