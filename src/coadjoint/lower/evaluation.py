"""Programs and their nodes in any arithmetic: exact elements, fractions, 50 digits, floats.

Comes in: a Program with the values of its inputs, and what takes numbers and calls into an
arithmetic. Goes out: the values of its outputs, by the operations and in the order of all targets.
Read next: `coadjoint.lower.lowering`, which makes Programs of Equations.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any, Final, TypeVar

from coadjoint.derive.mechanics.iteration import is_step
from coadjoint.exact.factored import factor
from coadjoint.lower.program import (
    Add,
    Call,
    Divide,
    Factors,
    Item,
    Multiply,
    Negate,
    Node,
    Number,
    Program,
    Several,
    Symbol,
    children,
)

Value = TypeVar("Value")


#: What two operands make.
_COMBINE: Final[dict[type, Callable[[Any, Any], Any]]] = {
    Add: operator.add,
    Multiply: operator.mul,
    Divide: operator.truediv,
}


def evaluate(
    node: Node,
    values: Mapping[str, Value],
    number: Callable[[Fraction], Value],
    call: Callable[..., Value],
) -> Value:
    """The value of a node in any arithmetic that has ``+ * /`` and unary ``-``.

    Args:
        node: What to evaluate.
        values: Values of the names it reads.
        number: Takes an exact constant into the arithmetic.
        call: Applies an elementary function by name.
    """
    kind = type(node)
    if kind in _COMBINE:  # most nodes, so these come first, and by their type alone
        left = evaluate(node.left, values, number, call)  # type: ignore[union-attr]
        right = evaluate(node.right, values, number, call)  # type: ignore[union-attr]
        return _COMBINE[kind](left, right)  # type: ignore[no-any-return]
    if kind is Symbol:
        return values[node.name]  # type: ignore[union-attr]
    match node:
        case Number(value=value):
            return number(value)
        case Call(function=function):
            return call(function, *(evaluate(u, values, number, call) for u in children(node)))
        case Negate(operand=operand):
            return -evaluate(operand, values, number, call)  # type: ignore[operator, no-any-return]
        case Item(of=of, place=place):
            several: Any = evaluate(of, values, number, call)
            return several[place]  # type: ignore[no-any-return]
    return _evaluate_several(node, values, number, call)  # type: ignore[arg-type, no-any-return]


def _evaluate_several(
    node: Several,
    values: Mapping[str, Any],
    number: Callable[[Fraction], Any],
    call: Callable[..., Any],
) -> Any:
    """L and D, or the unknowns."""
    first, *rest = (evaluate(each, values, number, call) for each in children(node))
    return factor([first, *rest]) if isinstance(node, Factors) else first.solve(rest)


def settled(name: str, value: Value) -> Value:
    """A value by its name: steps of an iteration are taken as they are, however they came about.

    Arithmetics that know where a value came from, such as those of errors, forget it.
    """
    settle = getattr(value, "settled", None) if is_step(name) else None
    return value if settle is None else settle()


def run(
    program: Program,
    inputs: Mapping[str, Value],
    number: Callable[[Fraction], Value],
    call: Callable[..., Value],
) -> list[Value]:
    """The outputs of a Program in any arithmetic: exact elements, fractions, 50 digits, floats."""
    values = dict(inputs)
    for statement in program.statements:
        value = evaluate(statement.value, values, number, call)
        values[statement.name] = settled(statement.name, value)
    return [evaluate(output.value, values, number, call) for output in program.outputs]
