"""Totals: trees that are linear in sums over members, their sums, and what is added to these.

Comes in: a tree whose sums are not written out. Goes out: its sums, each with what it stands in,
and the rest: functions of single members at the ends of an open chain.
Read next: `coadjoint.spec.core.written_out`, which writes sums out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

from coadjoint.spec.core.faults import ExpressionError, fault_at
from coadjoint.spec.core.members import Members
from coadjoint.spec.core.tree import (
    Binary,
    Member,
    Name,
    Negate,
    Node,
    Number,
    Sum,
    children,
    fold,
    rebuild,
    walk,
)


def is_plain(node: Sum) -> bool:
    """Whether a sum is over all members, or over all pairs with each of them once."""
    if len(node.indices) == 1:
        return not node.sign
    i, j = node.indices[:2]
    return len(node.indices) == 2 and (node.sides, node.sign) == ((Name(i), Name(j)), "<")


def split_sums(tree: Node) -> list[tuple[Sum, Node]]:
    """Each sum of a tree that is linear in its sums, with the tree that it alone stands in.

    Raises:
        ExpressionError: The tree is not a sum of sums with constant factors.
    """
    sums = [node for node in walk(tree) if isinstance(node, Sum)]
    for node in walk(tree):
        _check_linear(node)
    return [(each, _keep(tree, each)) for each in sums]


def is_linear(tree: Node, members: Members) -> bool:
    """Whether a tree is linear in its sums, with factors that name no member."""
    try:
        return not any(find_alone(alone, members) for _, alone in split_sums(tree))
    except ExpressionError:
        return False


def without_sums(tree: Node) -> Node:
    """A tree with zeros in the place of its sums."""

    def drop(node: Node, below: list[Node]) -> Node:
        return Number(Fraction(0)) if isinstance(node, Sum) else rebuild(node, below)

    return fold(tree, drop)


def find_alone(tree: Node, members: Members) -> set[int]:
    """The numbers of the members that a tree names outside of sums, as formulas count them.

    They count from 0, or from N as -1, -2 and so on.
    """
    found = (members.find_alone(node) for node in walk_outside(tree))
    return {number for number in found if number is not None}


def walk_outside(tree: Node) -> Iterator[Node]:
    """Every node of a tree that does not stand in a sum; sums are among them."""
    pending = [tree]
    while pending:
        node = pending.pop()
        yield node
        if not isinstance(node, Sum):
            pending.extend(reversed(children(node)))


def keep_rest(tree: Node) -> Node | None:
    """A linear tree without the terms that are sums; None if nothing is left."""
    if not has_sum(tree):
        return tree
    match tree:
        case Negate(operand=operand):
            kept = keep_rest(operand)
            return None if kept is None else replace(tree, operand=kept)
        case Binary(operator="+" | "-", left=left, right=right):
            kept, other = keep_rest(left), keep_rest(right)
            if kept is None and other is not None and tree.operator == "-":
                return Negate(other, start=tree.start, end=tree.end)
            if kept is None or other is None:
                return kept or other
            return replace(tree, left=kept, right=other)
        case Binary(left=left, right=right):
            kept, other = keep_rest(left), keep_rest(right)
            return None if kept is None or other is None else replace(tree, left=kept, right=other)
    return None


def has_sum(tree: Node) -> bool:
    """Whether a tree holds a sum over members."""
    return any(isinstance(node, Sum) for node in walk(tree))


def _check_linear(node: Node) -> None:
    """A node does nothing to a sum but multiply it by a constant, or add to it."""
    match node:
        case Sum() | Negate() | Member():
            return
        case Binary(operator="*", left=left, right=right):
            fits = not (has_sum(left) and has_sum(right))
        case Binary(operator="/", right=right):
            fits = not has_sum(right)
        case Binary():
            return
        case _:
            fits = not has_sum(node)
    if not fits:
        problem = "a sum over members stands in an expression that is not linear in it"
        raise fault_at(node, problem, expected="sums with constant factors")


def _keep(tree: Node, only: Sum) -> Node:
    """A linear tree with one of its sums, the others taken out."""
    if tree is only or not has_sum(tree):
        return tree
    match tree:
        case Negate(operand=operand):
            return replace(tree, operand=_keep(operand, only))
        case Binary(operator="+" | "-", left=left, right=right):
            if any(node is only for node in walk(left)):
                return _keep(left, only)
            kept = _keep(right, only)
            return kept if tree.operator == "+" else Negate(kept, start=tree.start, end=tree.end)
        case Binary(left=left, right=right):
            return replace(tree, left=_keep(left, only), right=_keep(right, only))
    raise AssertionError(tree)


def put_term(tree: Node, only: Sum) -> Node:
    """The tree of one sum with the term of the sum in its place."""

    def put(node: Node, below: list[Node]) -> Node:
        return below[-1] if isinstance(node, Sum) else rebuild(node, below)

    return fold(tree, put)
