"""Definitions: short names for expressions, put in as trees wherever they occur.

Comes in: a tree, and the definitions that it may name. Goes out: the tree with all of them put in.
What is put in takes the place of the call, so that later faults point there, and remembers which
definition it is from. Read next: `coadjoint.spec.core.formulas`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from coadjoint import limits
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.faults import ExpressionError
from coadjoint.spec.core.tree import (
    Call,
    Component,
    Index,
    Name,
    Node,
    children,
    rebuilt,
    walk,
    walk_up,
)


@dataclass(frozen=True)
class Definition:
    """A short name for an expression, put in as a tree wherever it occurs.

    Attributes:
        name: As declared, ``V`` of ``V(s, d)``.
        arguments: Names of its arguments; empty if it takes none.
        text: The expression as typed.
        tree: The parsed expression, with earlier definitions put in.
        shape: Shape of its value; None with arguments, whose shapes only a call has.
    """

    name: str
    arguments: tuple[str, ...]
    text: str
    tree: Node
    shape: Shape | None

    @property
    def signature(self) -> str:
        """How it is called: ``V(s, d)``."""
        return f"{self.name}({', '.join(self.arguments)})" if self.arguments else self.name

    @property
    def in_one_line(self) -> str:
        """The expression without its line breaks, for documents."""
        return " ".join(self.text.split())


def functions(definitions: Mapping[str, Definition]) -> list[str]:
    """Names of the definitions that take arguments."""
    return [definition.name for definition in definitions.values() if definition.arguments]


def expand(
    tree: Node, definitions: Mapping[str, Definition], spent: Counter[str] | None = None
) -> Node:
    """A tree with its definitions put in.

    Args:
        tree: What was read.
        definitions: What may be put in, by name.
        spent: Parts that were put into other trees of the spec; those of this one are added.

    Raises:
        ExpressionError: One is given another number of arguments, or a tree grows beyond the
            limits, which is seen before it does: 20 definitions that double make a million parts.

    >>> from coadjoint.spec.core.expressions import read_expression
    >>> double = Definition("f", ("x",), "x + x", read_expression("x + x"), None)
    >>> expand(read_expression("f(2*y)", ["f"]), {"f": double}) == read_expression("2*y + 2*y")
    True
    """
    if not definitions:
        return tree
    spent = Counter() if spent is None else spent
    total = sum(1 for _ in walk(tree))
    made: dict[int, tuple[Node, int]] = {}  # with the number of parts
    for node in walk_up(tree):
        below = [made[id(child)] for child in children(node)]
        found = rebuilt(node, [part for part, _ in below]), 1 + sum(count for _, count in below)
        definition = definitions.get(_called(node))
        if definition is not None:
            put = _put_in(node, definition, below)
            total += put[1] - found[1]
            spent["DEFINED_PARTS"] += put[1]
            found = put
            if total > limits.EXPRESSION_NODES:
                raise _too_large(node, definition, "EXPRESSION_NODES", "the expression has")
            if spent["DEFINED_PARTS"] > limits.DEFINED_PARTS:
                raise _too_large(node, definition, "DEFINED_PARTS", "all expressions have")
        made[id(node)] = found
    return made[id(tree)][0]


def _too_large(node: Node, definition: Definition, limit: str, what: str) -> ExpressionError:
    return ExpressionError(
        f"with {definition.name} put in, {what} too many parts",
        node.start,
        node.end,
        found=definition.name,
        expected=f"at most {getattr(limits, limit)} ({limit})",
        limit=limit,
    )


def _called(node: Node) -> str:
    """What a node may be a definition of; empty for operators."""
    match node:
        case Name(name=name) | Index(name=name) | Call(function=name):
            return name
    return ""


def _put_in(
    node: Node, definition: Definition, given: Sequence[tuple[Node, int]]
) -> tuple[Node, int]:
    """The expression of a definition in the place of its call, and the number of its parts."""
    if len(given) != len(definition.arguments):
        raise ExpressionError(
            f"{definition.name} is given {len(given)} argument{'s' * (len(given) != 1)}",
            node.start,
            node.end,
            found=str(len(given)),
            expected=definition.signature,
        )
    values = dict(zip(definition.arguments, given, strict=True))
    made: dict[int, Node] = {}
    count = 0
    for part in walk_up(definition.tree):
        fresh = rebuilt(part, [made[id(child)] for child in children(part)])
        fresh = replace(fresh, start=node.start, end=node.end, within=definition.name)
        argument = values.get(_called(part)) if isinstance(part, (Name, Index)) else None
        if argument is not None:
            fresh = _component(fresh, argument[0])
        count += 1 if argument is None else argument[1] + isinstance(part, Index)
        made[id(part)] = fresh
    return _component(node, made[id(definition.tree)]), count + isinstance(node, Index)


def _component(node: Node, whole: Node) -> Node:
    """``whole`` for a name that stands for it, and its component for a component of the name."""
    if not isinstance(node, Index):
        return whole
    if isinstance(whole, Name):
        return replace(node, name=whole.name)
    start, end, within = node.start, node.end, node.within
    return Component(node.name, whole, node.indices, start=start, end=end, within=within)
