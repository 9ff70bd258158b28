"""Elementary functions: the one table of what a function of the expression language is.

Comes in: nothing. Goes out: an entry for each function of scalars that kernels compute. The reader
of expressions, exact elements and their derivatives, domains and signs, the oracle, lowering, the
recurrences of solvers, printers and readers of the targets, and the documents read it. For another
function add an entry here (docs/decisions/functions.md).

What an entry says of values is written as text in the arguments ``u`` and ``v``, in the value ``f``
and in other functions of this table; `evaluate` finds its value in any arithmetic.
Read next: `coadjoint.exact.field`, which adjoins functions to a field.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from types import MappingProxyType
from typing import Any, Final, NamedTuple


@dataclass(frozen=True)
class Elementary:
    """An elementary function.

    Attributes:
        name: In specs, in C, in Python's ``math`` and in mpmath.
        meaning: What it is, for documents.
        slopes: The derivative by each argument.
        enclosed: The value by functions that interval arithmetic has; "" where it has this one.
        positive: What is positive where it is analytic, "" if it is so everywhere.
        has_edge: Whether it has a value where that is 0.
        expects: What arguments it is defined for, in words.
        jumps: What is 0 where it jumps, and what is not positive there; "" for nothing.
        parity: 1 where ``f(-u) = f(u)``, -1 where ``f(-u) = -f(u)``, else 0.
        at_zero: Its value at 0 if that is a rational number.
        partner: The function of the same argument that stands with it, for relation and slope.
        square: Its square, in the partner p too; "" where that is no simpler.
        entire: Whether it is a function of a complex variable without singular points.
        largest: Size of an argument beyond which values or reciprocals, or products of four that
            derivatives have, are no doubles: points beyond are not compared. 0 for no such size.
        is_bounded: Whether no value is larger than 1 in size.
        is_positive: Whether all values are positive.
        numpy: Its name in NumPy, where that is another one.
    """

    name: str
    meaning: str
    slopes: tuple[str, ...]
    enclosed: str = ""
    positive: str = ""
    has_edge: bool = False
    expects: str = ""
    jumps: tuple[str, str] = ("", "")
    parity: int = 0
    at_zero: int | None = None
    partner: str = ""
    square: str = ""
    entire: bool = False
    largest: int = 0
    is_bounded: bool = False
    is_positive: bool = False
    numpy: str = ""

    @property
    def arity(self) -> int:
        """The number of arguments."""
        return len(self.slopes)

    @property
    def is_locally_constant(self) -> bool:
        """Whether all derivatives are 0."""
        return set(self.slopes) == {"0"}

    @property
    def is_exact(self) -> bool:
        """Whether its values are rounded alike everywhere, as those of roots and signs are."""
        return self.name == "sqrt" or self.is_locally_constant

    @property
    def calls_others(self) -> bool:
        """Whether its derivative calls functions other than its partner."""
        return not self.partner and any(map(_has_call, self.slopes))

    @property
    def takes(self) -> str:
        """The arguments that fit, in words."""
        return "a scalar" if self.arity == 1 else "two scalars"

    @property
    def numpy_name(self) -> str:
        """Its name in NumPy."""
        return self.numpy or self.name


_ENTRIES: Final = (
    Elementary(
        name="sqrt",
        meaning="square root",
        slopes=("0.5/f",),
        positive="u",
        has_edge=True,
        expects="a positive argument",
        at_zero=0,
        square="u",
    ),
    Elementary(
        name="sin",
        meaning="sine",
        slopes=("cos(u)",),
        parity=-1,
        at_zero=0,
        partner="cos",
        square="1 - p*p",
        entire=True,
        is_bounded=True,
    ),
    Elementary(
        name="cos",
        meaning="cosine",
        slopes=("-sin(u)",),
        parity=1,
        at_zero=1,
        partner="sin",
        entire=True,
        is_bounded=True,
    ),
    Elementary(
        name="exp",
        meaning="exponential",
        slopes=("f",),
        at_zero=1,
        entire=True,
        largest=700,
        is_positive=True,
    ),
    Elementary(
        name="log",
        meaning="natural logarithm",
        slopes=("1/u",),
        positive="u",
        expects="a positive argument",
    ),
    Elementary(
        name="sinh",
        meaning="hyperbolic sine",
        slopes=("cosh(u)",),
        enclosed="(exp(u) - exp(-u))/2",
        parity=-1,
        at_zero=0,
        partner="cosh",
        square="p*p - 1",
        entire=True,
        largest=170,
    ),
    Elementary(
        name="cosh",
        meaning="hyperbolic cosine",
        slopes=("sinh(u)",),
        enclosed="(exp(u) + exp(-u))/2",
        parity=1,
        at_zero=1,
        partner="sinh",
        entire=True,
        largest=170,
        is_positive=True,
    ),
    Elementary(
        name="tanh",
        meaning="hyperbolic tangent",
        slopes=("1 - f*f",),
        enclosed="1 - 2/(exp(2*u) + 1)",
        parity=-1,
        at_zero=0,
        is_bounded=True,
    ),
    Elementary(
        name="asinh",
        meaning="inverse hyperbolic sine",
        slopes=("1/sqrt(1 + u*u)",),
        enclosed="log(u + sqrt(1 + u*u))",
        parity=-1,
        at_zero=0,
        numpy="arcsinh",
    ),
    Elementary(
        name="atanh",
        meaning="inverse hyperbolic tangent",
        slopes=("1/(1 - u*u)",),
        enclosed="log((1 + u)/(1 - u))/2",
        positive="1 - u*u",
        expects="an argument between -1 and 1",
        parity=-1,
        at_zero=0,
        numpy="arctanh",
    ),
    Elementary(
        name="asin",
        meaning="inverse sine, from -pi/2 to pi/2",
        slopes=("1/sqrt(1 - u*u)",),
        enclosed="atan2(u, sqrt(1 - u*u))",
        positive="1 - u*u",
        has_edge=True,
        expects="an argument between -1 and 1",
        parity=-1,
        at_zero=0,
        numpy="arcsin",
    ),
    Elementary(
        name="acos",
        meaning="inverse cosine, from 0 to pi",
        slopes=("-1/sqrt(1 - u*u)",),
        enclosed="atan2(sqrt(1 - u*u), u)",
        positive="1 - u*u",
        has_edge=True,
        expects="an argument between -1 and 1",
        numpy="arccos",
    ),
    Elementary(
        name="atan",
        meaning="inverse tangent, from -pi/2 to pi/2",
        slopes=("1/(1 + u*u)",),
        enclosed="atan2(u, 1)",
        parity=-1,
        at_zero=0,
        numpy="arctan",
    ),
    Elementary(
        name="atan2",
        meaning="`atan2(y, x)`: angle of the point (x, y), from -pi to pi",
        slopes=("v/(u*u + v*v)", "-u/(u*u + v*v)"),
        positive="u*u + v*v",
        expects="a point other than the origin",
        jumps=("u", "v"),
        numpy="arctan2",
    ),
    Elementary(
        name="sign",
        meaning="-1, 0 or 1",
        slopes=("0",),
        enclosed="u/sqrt(u*u)",
        jumps=("u", ""),
        parity=-1,
        square="1",
        is_bounded=True,
    ),
)

_TABLE: Final = {each.name: each for each in _ENTRIES}
#: Every elementary function by name, in the order in which kernels count them.
ELEMENTARY: Final = MappingProxyType(_TABLE)
#: The names of the arguments in the texts of entries.
ARGUMENTS: Final = ("u", "v")


class Arithmetic(NamedTuple):
    """What values are computed with.

    Attributes:
        number: Takes a rational number into the arithmetic.
        call: Applies an elementary function by name.
        add: ``a + b``.
        multiply: ``a * b``.
        divide: ``a / b``.
        negate: ``-a``.
    """

    number: Callable[[Fraction], Any]
    call: Callable[..., Any]
    add: Callable[[Any, Any], Any] = operator.add
    multiply: Callable[[Any, Any], Any] = operator.mul
    divide: Callable[[Any, Any], Any] = operator.truediv
    negate: Callable[[Any], Any] = operator.neg


def _has_call(text: str) -> bool:
    """Whether a text calls a function."""
    return any(isinstance(each, ast.Call) for each in ast.walk(_parse(text)))


@cache
def _parse(text: str) -> ast.expr:
    """The tree of a text of the table."""
    return ast.parse(text, mode="eval").body


def evaluate(text: str, arithmetic: Arithmetic, **values: Any) -> Any:
    """The value of a text of the table.

    Args:
        text: As an entry has it.
        arithmetic: What to compute with.
        **values: Values of u, v, f and p, as far as they occur.

    >>> evaluate("1 - u*u", Arithmetic(number=Fraction, call=max), u=Fraction(1, 2))
    Fraction(3, 4)
    """
    return _evaluate(_parse(text), arithmetic, values)


def _evaluate(node: ast.expr, own: Arithmetic, values: Mapping[str, Any]) -> Any:
    """The value of a node."""
    match node:
        case ast.Constant(value=int() | float() as value):
            return own.number(Fraction(value))
        case ast.Name(id=name):
            return values[name]
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return own.negate(_evaluate(operand, own, values))
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return own.call(name, *(_evaluate(each, own, values) for each in arguments))
        case ast.BinOp(left=left, op=sign, right=right):
            a, b = _evaluate(left, own, values), _evaluate(right, own, values)
            match sign:
                case ast.Add():
                    return own.add(a, b)
                case ast.Sub():
                    return own.add(a, own.negate(b))
                case ast.Mult():
                    return own.multiply(a, b)
                case ast.Div():
                    return own.divide(a, b)
    raise AssertionError(ast.dump(node))


def by_name(arguments: tuple[Any, ...]) -> dict[str, Any]:
    """Arguments of a function by the names that the texts of its entry have for them."""
    return dict(zip(ARGUMENTS, arguments, strict=False))


def slopes_of(function: str, arguments: tuple[Any, ...], value: Any, own: Arithmetic) -> list[Any]:
    """The derivatives of a function by its arguments.

    Args:
        function: Its name.
        arguments: Values of the arguments.
        value: That of the function.
        own: The arithmetic of both.

    >>> import math
    >>> own = Arithmetic(number=float, call=lambda name, *of: getattr(math, name)(*of))
    >>> slopes_of("atan2", (3.0, 4.0), math.atan2(3.0, 4.0), own)
    [0.16, -0.12]
    """
    known = by_name(arguments)
    return [evaluate(text, own, f=value, **known) for text in ELEMENTARY[function].slopes]


def domain_of(function: str, arguments: tuple[Any, ...], own: Arithmetic) -> Any | None:
    """What is positive where a function is analytic; None where it is so everywhere."""
    text = ELEMENTARY[function].positive
    return evaluate(text, own, **by_name(arguments)) if text else None


def has_constant_value(function: str, arguments: tuple[Fraction, ...]) -> bool:
    """Whether a function has a value at numbers, apart from the edge of its domain.

    >>> has_constant_value("sqrt", (Fraction(0),)), has_constant_value("log", (Fraction(0),))
    (True, False)
    """
    positive = domain_of(function, arguments, Arithmetic(number=Fraction, call=math.hypot))
    if ELEMENTARY[function].at_zero is not None and not any(arguments):
        return True
    return positive is None or positive > 0


def jump_of(function: str, arguments: tuple[Any, ...]) -> tuple[Any | None, Any | None]:
    """What is 0 where a function jumps, and what is not positive there; None for nothing."""
    known = by_name(arguments)
    zero, side = ELEMENTARY[function].jumps
    return known.get(zero), known.get(side)
