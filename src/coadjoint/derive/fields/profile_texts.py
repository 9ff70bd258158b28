"""Texts of profiles: the fields at the beginning as formulas of Python.

A generated package evaluates them in double precision, at as many points as it has, and needs
nothing but `math` for it. They are built as trees of Python, node by node: no text of a spec
is ever run.
Comes in: a Spec with [profiles]. Goes out: `WrittenProfiles`.
Read next: `coadjoint.derive.fields.profiles`, where the same is computed to 50 digits.
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Final, cast

from coadjoint.derive.interpret import Values, entries, interpret
from coadjoint.derive.setting import assemble
from coadjoint.exact import Field
from coadjoint.families import WrittenProfiles
from coadjoint.spec import Spec

#: Whole numbers below which all are doubles.
EXACT: Final = 2**53


def write_profiles(spec: Spec) -> WrittenProfiles | None:
    """The profiles as texts of Python; None where there are none."""
    space, called = spec.space, set[str]()
    if space is None or not spec.profiles:
        return None
    along = [each for each in (space, space.across) if each is not None]
    names = [each.name for each in along]
    names += [component for each in spec.parameters for component in each.components]
    values: dict[str, Any] = {name: _Term(ast.Name(name)) for name in names}
    for each in spec.parameters:
        values[each.name] = assemble(each, values)
    found = dict[str, tuple[str, ...]]()
    for name, formula in spec.profiles.items():
        components: Any = entries(interpret(formula.tree, values, cast("Field", _Texts())))
        trees = [_Tidy().visit(_Term.of(each).node) for each in components]
        found[name] = tuple(map(ast.unparse, trees))
        called |= {
            part.id for tree in trees for part in ast.walk(tree) if isinstance(part, ast.Name)
        }
    return WrittenProfiles(
        lengths=tuple(each.length for each in along),
        arguments=tuple(names),
        texts=found,
        called=tuple(sorted(called - {*names})),
    )


@dataclass(frozen=True)
class _Term:
    """A text of Python as a tree, and its value where that is a rational number."""

    node: ast.expr
    value: Fraction | None = None

    @classmethod
    def of(cls, value: Any) -> _Term:
        """A number as a term; a term as it is."""
        if isinstance(value, cls):
            return value
        number = Fraction(value)
        short = number.numerator if number.denominator == 1 else float(number)
        return cls(ast.Constant(short), number)

    def __add__(self, other: Any) -> _Term:
        return _combine(ast.Add(), operator.add, self, other, neutral=0)

    def __radd__(self, other: Any) -> _Term:
        return _Term.of(other) + self

    def __sub__(self, other: Any) -> _Term:
        other = _Term.of(other)
        return (
            -other if self.value == 0 else _combine(ast.Sub(), operator.sub, self, other, right=0)
        )

    def __rsub__(self, other: Any) -> _Term:
        return _Term.of(other) - self

    def __mul__(self, other: Any) -> _Term:
        other = _Term.of(other)
        if 0 in (self.value, other.value):
            return _Term.of(0)
        return _combine(ast.Mult(), operator.mul, self, other, neutral=1)

    def __rmul__(self, other: Any) -> _Term:
        return _Term.of(other) * self

    def __truediv__(self, other: Any) -> _Term:
        return _combine(ast.Div(), operator.truediv, self, other, right=1)

    def __rtruediv__(self, other: Any) -> _Term:
        return _Term.of(other) / self

    def __pow__(self, exponent: int) -> _Term:
        return _combine(ast.Pow(), operator.pow, self, exponent, right=1)

    def __neg__(self) -> _Term:
        if self.value is not None:
            return _Term.of(-self.value)
        return _Term(ast.UnaryOp(ast.USub(), self.node))


def _combine(
    symbol: ast.operator,
    calculate: Callable[[Fraction, Any], Any],
    left: _Term,
    right_side: Any,
    neutral: int | None = None,
    right: int | None = None,
) -> _Term:
    """Two terms as one; numbers are computed where that is exact as a double.

    Args:
        symbol: The operation in a text.
        calculate: The same of numbers.
        left: The first term.
        right_side: The second one.
        neutral: The number that changes nothing on either side.
        right: That changes nothing on the right.
    """
    other = _Term.of(right_side)
    product = _Term(ast.BinOp(left.node, symbol, other.node))
    if other.value is not None and other.value in (neutral, right):
        return left
    if left.value is not None and left.value == neutral:
        return other
    if left.value is not None and other.value:
        whole = isinstance(symbol, ast.Pow)
        number = Fraction(calculate(left.value, int(other.value) if whole else other.value))
        if max(abs(number.numerator), number.denominator) < EXACT:
            return _Term.of(number) if Fraction(float(number)) == number else product
    return product


class _Tidy(ast.NodeTransformer):
    """Texts as a person writes them: pi, minus and quotients."""

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        """A product of two factors."""
        self.generic_visit(node)
        match node:
            case ast.BinOp(
                ast.Constant(4), ast.Mult(), ast.Call(ast.Name("atan"), [ast.Constant(1)])
            ):
                return ast.Name("pi")
            case ast.BinOp(ast.Constant(-1), ast.Mult(), factor):
                return ast.UnaryOp(ast.USub(), factor)
            case ast.BinOp(ast.BinOp(ast.Constant(1), ast.Div(), divisor), ast.Mult(), factor):
                return ast.BinOp(factor, ast.Div(), divisor)
        return node


class _Texts(Values):
    """Texts, as trees."""

    zero, one = _Term.of(0), _Term.of(1)

    def number(self, value: Fraction) -> _Term:
        """A rational number."""
        return _Term.of(value)

    def is_zero(self, value: Any) -> bool:
        """Whether a term is certainly 0."""
        return bool(_Term.of(value).value == 0)

    def call(self, function: str, *arguments: Any) -> _Term:
        """An elementary function of Python's ``math``, which has no sign."""
        nodes = [_Term.of(each).node for each in arguments]
        if function == "sign":
            above, below = (
                ast.Compare(nodes[0], [order], [ast.Constant(0)]) for order in (ast.Gt(), ast.Lt())
            )
            return _Term(ast.BinOp(above, ast.Sub(), below))
        return _Term(ast.Call(ast.Name(function), nodes, []))

    def absolute(self, value: Any) -> _Term:
        """The absolute value."""
        return self.call("fabs", value)

    def power(self, base: Any, exponent: Any) -> _Term:
        """A power with any exponent."""
        return self.call("pow", base, exponent)
