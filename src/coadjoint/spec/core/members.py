"""Members: sums over the members that an index counts, written out for a few of them.

Comes in: a tree with sums over members and with quantities of a member. Goes out: the same tree for
N members, without sums and with a name for each quantity of each member. So the rest of a spec's
way is that of any other spec: the equations of the generic member are read off from a few of them,
and what is proved for a few is proved for all by the lemmas in docs/decisions/windows.md.
Read next: `coadjoint.spec.windows`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import reduce
from itertools import combinations

from coadjoint import limits
from coadjoint.spec.core.faults import fault_at
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.tree import (
    Binary,
    Call,
    Component,
    Index,
    Member,
    Name,
    Negate,
    Node,
    Number,
    Sum,
    fold,
    rebuild,
    walk,
)


def member_name(name: str, member: int) -> str:
    """What a quantity of one member is called where all members are written out.

    >>> member_name("S", 3)
    'S_3'
    """
    return f"{name}_{member}"


@dataclass(frozen=True)
class Members:
    """How many members there are, and what each of them has.

    Attributes:
        index: The index that counts them.
        count: How many are written out.
        periodic: Whether the last one is followed by the first.
        names: What each member has: variables and parameters.
        bound: Of keys that are written out for each member, the member.
    """

    index: str
    count: int
    periodic: bool
    names: frozenset[str]
    bound: Mapping[KeyPath, int] = field(default_factory=dict)

    def place(self, member: int) -> int | None:
        """The member of a number from 0; None beyond the end of an open chain."""
        if self.periodic:
            return member % self.count
        return member if 0 <= member < self.count else None

    def run(self, node: Node) -> range:
        """The members for which a term reads no neighbour beyond the end of an open chain."""
        before, after = (0, 0) if self.periodic else reach(node)
        return range(before, self.count - after)


def reach(node: Node) -> tuple[int, int]:
    """How many members a term reads before the one that the index counts, and after it."""
    shifts = [0, *(part.shift for part in walk(node) if isinstance(part, Member))]
    return -min(shifts), max(shifts)


def write_out(tree: Node, members: Members, key: KeyPath) -> Node:
    """A tree for so many members.

    Args:
        tree: With definitions expanded.
        members: How many there are.
        key: Where it stands. In a bracket of a member the index is that member; in a claim it may
            be any: the value is a vector with a component for each.

    Raises:
        ExpressionError: A quantity of a member stands without an index, or with another one.
    """

    def write(node: Node, below: list[Node]) -> Node:
        if isinstance(node, Name | Index) and node.name in members.names:
            raise _without_index(node, members)
        if isinstance(node, Member):
            _check_member(node, members)
        fresh = rebuild(node, below)
        if isinstance(fresh, Call) and fresh.function == "tridiagonal":
            return write_band(fresh, members)
        return add_up(fresh, members) if isinstance(fresh, Sum) else fresh

    whole = fold(tree, write)
    if not any(isinstance(node, Member) for node in walk(whole)):
        return whole
    if key in members.bound:
        _check_free(whole, members, free=True)
        return place_at(whole, {members.index: members.bound[key]}, members)
    _check_free(whole, members, free=key[0] in ("claims", "definitions"))
    parts = tuple(place_at(whole, {members.index: k}, members) for k in members.run(whole))
    return Call(function="vector", arguments=parts, start=whole.start, end=whole.end)


def _check_free(whole: Node, members: Members, *, free: bool) -> None:
    """Outside of sums there is the declared index alone, and only where it may be free."""
    for node in walk(whole):
        if isinstance(node, Member) and (not free or node.index != members.index):
            problem = f"the index {node.index!r} is not that of a sum around it"
            expected = f"{node.name}[{members.index}] inside sum({members.index}, ...)"
            raise fault_at(node, problem, node.index, expected)


def add_up(node: Sum, members: Members) -> Node:
    """A sum as what it adds up."""
    term = node.term
    _check_sum(node, members)
    places: Iterator[Sequence[int]]
    if len(node.indices) == 1:
        places = ((k,) for k in members.run(term))
    else:
        places = iter(combinations(range(members.count), 2))
    terms = [place_at(term, dict(zip(node.indices, at, strict=True)), members) for at in places]
    if not terms:  # of the shape that the sum has
        wrapped = replace(members, periodic=True)
        nothing = place_at(term, dict.fromkeys(node.indices, 0), wrapped)
        zero = Number(Fraction(0), start=node.start, end=node.end)
        return Binary(operator="*", left=zero, right=nothing, start=node.start, end=node.end)
    return reduce(
        lambda a, b: Binary(operator="+", left=a, right=b, start=node.start, end=node.end), terms
    )


def write_band(node: Call, members: Members) -> Node:
    """The matrix with a row for each member of an open chain: entries below, on and above.

    ``tridiagonal(a, b, c)`` has a in row i+1 and column i, b in row and column i, and c in row i
    and column i+1.
    """
    if len(node.arguments) != 3 or members.periodic:
        problem = "a ring has no tridiagonal matrix" if members.periodic else "three are needed"
        expected = "tridiagonal(below, diagonal, above) of an open chain"
        raise fault_at(node, problem, str(len(node.arguments)), expected)
    _check_free(node, members, free=True)
    start, end, rows = node.start, node.end, list[Node]()
    for row in range(members.count):
        entries: list[Node] = []
        for column in range(members.count):
            side = column - row
            entry: Node = Number(Fraction(0), start=start, end=end)
            if abs(side) < 2:
                at = {members.index: min(row, column)}
                entry = place_at(node.arguments[side + 1], at, members)
            entries.append(entry)
        rows.append(Call(function="vector", arguments=tuple(entries), start=start, end=end))
    return Call(function="rows", arguments=tuple(rows), start=start, end=end)


def place_at(term: Node, members_of: Mapping[str, int], members: Members) -> Node:
    """A term in which indices stand for certain members."""

    def place(node: Node, below: list[Node]) -> Node:
        if isinstance(node, Component) and isinstance(below[0], Name):
            return Index(name=below[0].name, indices=node.indices, start=node.start, end=node.end)
        if not isinstance(node, Member) or node.index not in members_of:
            return rebuild(node, below)
        at = members.place(members_of[node.index] + node.shift)
        if at is None:
            problem = f"{node.name}[{node.index}{node.shift:+d}] lies beyond the end of the chain"
            raise fault_at(node, problem, str(node.shift), "members of the chain")
        name, where = member_name(node.name, at), {"start": node.start, "end": node.end}
        if node.indices:
            return Index(name=name, indices=node.indices, within=node.within, **where)
        return Name(name, within=node.within, **where)

    return fold(term, place)


def _check_member(node: Member, members: Members) -> None:
    """A quantity with an index has one, and no neighbour is too far."""
    if node.name not in members.names:
        problem = f"{node.name!r} has no index"
        expected = "a variable or parameter that is declared with an index"
        hint = f'Write {node.name}, or add index = "{members.index}" where it is declared.'
        raise fault_at(node, problem, node.name, expected, hint)
    if abs(node.shift) > limits.NEIGHBOURS:
        problem = f"the neighbour is {abs(node.shift)} members away"
        raise fault_at(node, problem, str(node.shift), limit="NEIGHBOURS")


def _without_index(node: Name | Index, members: Members) -> Exception:
    problem = f"{node.name!r} is one quantity of each member"
    expected = f"{node.name}[{members.index}] inside sum({members.index}, ...)"
    hint = "The second subscript is a component" if isinstance(node, Index) else ""
    hint += f": {node.name}[{members.index}, 1]." if hint else ""
    return fault_at(node, problem, node.name, expected, hint)


def _check_sum(node: Sum, members: Members) -> None:
    """A sum is over the declared index, its pairs know no neighbours, its term has a member."""
    index, parts = members.index, list(walk(node.term))
    if node.indices[0] != index:
        problem, found = f"there is no index {node.indices[0]!r}", node.indices[0]
        raise fault_at(node, problem, found, f"the declared index {index!r}")
    if len(set(node.indices)) < len(node.indices):
        problem = "the two indices of a pair have one name"
        raise fault_at(node, problem, index, f"sum({index}, j, {index} < j, ...)")
    inside = [part for part in parts if isinstance(part, Member)]
    for part in inside:
        if part.index not in node.indices:
            problem = f"the index {part.index!r} is not that of a sum around it"
            raise fault_at(part, problem, part.index, f"one of {', '.join(node.indices)}")
        if part.shift and len(node.indices) > 1:
            problem = "a sum over pairs names a neighbour"
            expected = f"{part.name}[{part.index}] without a shift"
            hint = f"Write {part.name}[{part.index}]."
            raise fault_at(part, problem, str(part.shift), expected, hint)
    missing = set(node.indices) - {part.index for part in inside}
    if missing:
        problem = f"the term of the sum does not name a member {min(missing)!r}"
        raise fault_at(node, problem, min(missing), "a quantity of each member in every term")
    if not members.periodic and len(node.indices) == 1 and not members.run(node.term):
        problem = f"an open chain of {members.count} has no member with these neighbours"
        expected = f"at least {sum(reach(node.term)) + 1} members"
        raise fault_at(node, problem, str(members.count), expected, "Choose a larger size.")


def split_sums(tree: Node) -> list[tuple[Sum, Node]]:
    """Each sum of a tree that is linear in its sums, with the tree that it alone stands in.

    Raises:
        ExpressionError: The tree is not a sum of sums with constant factors.
    """
    sums = [node for node in walk(tree) if isinstance(node, Sum)]
    for node in walk(tree):
        _check_linear(node)
    return [(each, _keep(tree, each)) for each in sums]


def without_sums(tree: Node) -> Node:
    """A tree with zeros in the place of its sums."""

    def drop(node: Node, below: list[Node]) -> Node:
        return Number(Fraction(0)) if isinstance(node, Sum) else rebuild(node, below)

    return fold(tree, drop)


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
        case Binary(left=left, right=right):
            fits = has_sum(left) == has_sum(right)
        case _:
            fits = not has_sum(node)
    if not fits:
        problem = "a sum over members stands in an expression that is not linear in it"
        expected = "sums of sums over members, each with a constant factor"
        hint = "Put what stands around the sum into its term, or leave it out."
        raise fault_at(node, problem, expected=expected, hint=hint)


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
        return below[0] if isinstance(node, Sum) else rebuild(node, below)

    return fold(tree, put)
