"""Plain expression trees: what the reader makes of text, and what the derivation reads.

Comes in: nothing. Goes out: frozen nodes that carry their place in the text (``start``, ``end``,
offsets from 0, end exclusive), so that a later step can still point at the characters at fault.
No SymPy here, and no text of a spec survives in a node except declared names.
Read next: `coadjoint.spec.core.expressions`, which makes these, and `coadjoint.derive.interpret`,
which turns them into exact field elements.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TypeVar

Value = TypeVar("Value")


@dataclass(frozen=True)
class Node:
    """A piece of an expression and its place in the text (which equality ignores).

    Attributes:
        start: Offset of its first character.
        end: Offset after its last one.
        within: The definition whose text it comes from, if that is not the text of the formula.
    """

    start: int = field(compare=False, kw_only=True, default=0)
    end: int = field(compare=False, kw_only=True, default=0)
    within: str = field(compare=False, kw_only=True, default="", repr=False)


@dataclass(frozen=True)
class Number(Node):
    """An exact decimal: ``0.1`` is one tenth."""

    value: Fraction


@dataclass(frozen=True)
class Name(Node):
    """A declared name: a whole quantity (``Omega``) or one of its components (``Omega1``)."""

    name: str


@dataclass(frozen=True)
class Index(Node):
    """A component, counted from 1 as books do: ``Omega[1]``, ``A[1, 2]``; ``A[1]`` is a row."""

    name: str
    indices: tuple[int, ...]


@dataclass(frozen=True)
class Component(Node):
    """A component of an expression: ``cross(a, b)[1]``, or ``u[1]`` for ``u = "A*b"``.

    Attributes:
        name: What messages call the expression.
        operand: The expression.
        indices: Counted from 1.
    """

    name: str
    operand: Node
    indices: tuple[int, ...]


@dataclass(frozen=True)
class Member(Node):
    """A quantity of a member: ``S[i+1]``, and with indices its component: ``S[i+1, 2]``."""

    name: str
    index: str
    shift: int
    indices: tuple[int, ...]


@dataclass(frozen=True)
class Entry(Node):
    """A quantity whose subscripts are worked out: ``M[i, j]``, ``theta[n - i]``."""

    name: str
    subscripts: tuple[Node, ...]


@dataclass(frozen=True)
class Sum(Node):
    """A sum over members, ``sum(i, term)``, or over pairs of them, ``sum(i, j, i < j, term)``.

    Attributes:
        indices: Names that count through all members, each on its own.
        term: What is added up.
        sides: The two sides of the condition on the indices, if there is one.
        sign: What stands between them: ``<``, ``<=``, ``>``, ``>=``, ``==`` or ``!=``.
    """

    indices: tuple[str, ...]
    term: Node
    sides: tuple[Node, ...] = ()
    sign: str = ""


@dataclass(frozen=True)
class Negate(Node):
    """``-operand``."""

    operand: Node


@dataclass(frozen=True)
class Binary(Node):
    """``left operator right`` with operator one of ``+ - * /``."""

    operator: str
    left: Node
    right: Node


@dataclass(frozen=True)
class Power(Node):
    """``base ^ exponent`` with a literal integer exponent, possibly negative."""

    base: Node
    exponent: int


@dataclass(frozen=True)
class Call(Node):
    """``function(arguments)`` for a function of `coadjoint.spec.core.shapes.FUNCTIONS`."""

    function: str
    arguments: tuple[Node, ...]


def children(node: Node) -> tuple[Node, ...]:
    """The nodes directly below ``node``, in reading order."""
    match node:
        case Negate(operand=operand) | Component(operand=operand):
            return (operand,)
        case Binary(left=left, right=right):
            return (left, right)
        case Power(base=base):
            return (base,)
        case Call(arguments=arguments):
            return arguments
        case Sum(term=term, sides=sides):
            return (*sides, term)
        case Entry(subscripts=subscripts):
            return subscripts
    return ()


def rebuild(node: Node, below: Sequence[Node]) -> Node:
    """``node`` with other nodes directly below it, as many as it has."""
    match node:
        case Negate() | Component():
            return replace(node, operand=below[0])
        case Binary():
            return replace(node, left=below[0], right=below[1])
        case Power():
            return replace(node, base=below[0])
        case Call():
            return replace(node, arguments=tuple(below))
        case Sum():
            return replace(node, term=below[-1], sides=tuple(below[:-1]))
        case Entry():
            return replace(node, subscripts=tuple(below))
    return node


def walk(node: Node) -> Iterator[Node]:
    """``node`` and every node below it, parents first; a sum of 500 terms is 500 levels deep."""
    pending = [node]
    while pending:
        node = pending.pop()
        yield node
        pending.extend(reversed(children(node)))


def walk_up(node: Node, below: Callable[[Node], Sequence[Node]] = children) -> Iterator[Node]:
    """Every node below ``node`` and itself, children first and from left to right.

    Args:
        node: The root.
        below: The nodes directly below one; none where a walk is to stop.
    """
    pending = [(node, False)]
    while pending:
        node, seen = pending.pop()
        if seen:
            yield node
        else:
            pending.append((node, True))
            pending.extend((child, False) for child in reversed(below(node)))


def evaluate_nodes(
    tree: Node,
    value_of: Callable[[Node, list[Value]], Value],
    below: Callable[[Node], Sequence[Node]] = children,
) -> dict[int, Value]:
    """The value of every node of a tree, by ``id``, from those of its children."""
    values: dict[int, Value] = {}
    for node in walk_up(tree, below):
        values[id(node)] = value_of(node, [values[id(child)] for child in below(node)])
    return values


def fold(
    tree: Node,
    value_of: Callable[[Node, list[Value]], Value],
    below: Callable[[Node], Sequence[Node]] = children,
) -> Value:
    """The value of a tree, where that of each node follows from those of its children.

    >>> fold(Negate(Number(Fraction(2))), lambda node, below: 1 + sum(below))
    2
    """
    return evaluate_nodes(tree, value_of, below)[id(tree)]
