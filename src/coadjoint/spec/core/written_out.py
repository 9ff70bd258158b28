"""Writing out: sums over the members that an index counts, for a number of them.

Comes in: a tree with sums over members and with quantities of a member. Goes out: the same tree for
N members, without sums and with a name for each quantity of each member. So the rest of a spec's
way is that of any other spec. The equations of the generic member are read off from a few of them,
and what is proved for a few is proved for all by the lemmas in docs/decisions/windows.md; what does
not follow so is written out for all members.
Read next: `coadjoint.spec.windows`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import reduce
from itertools import product
from math import prod
from operator import add, eq, ge, gt, le, lt, mul, ne, sub
from typing import Any

from coadjoint import limits
from coadjoint.spec.core.faults import ExpressionError, fault_at
from coadjoint.spec.core.members import Members, _is_band, find_free, member_name, reach, tell_count
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.tree import (
    Binary,
    Call,
    Component,
    Entry,
    Index,
    Member,
    Name,
    Negate,
    Node,
    Number,
    Power,
    Sum,
    children,
    fold,
    rebuild,
    walk,
)

_SIGNS: Mapping[str, Callable[[Any, Any], bool]] = {
    "<": lt,
    "<=": le,
    ">": gt,
    ">=": ge,
    "==": eq,
    "!=": ne,
}


_OPERATORS: Mapping[str, Callable[[Fraction, Fraction], Fraction]] = {"+": add, "-": sub, "*": mul}


_OF_NUMBERS: Mapping[str, Callable[..., Fraction]] = {"abs": abs, "min": min, "max": max}


#: Tables in which the index may be free: the value has a component for each member.
_FREE = ("claims", "definitions", "observables")


def write_out(tree: Node, members: Members, key: KeyPath) -> Node:
    """A tree for so many members.

    Args:
        tree: With definitions expanded.
        members: How many there are.
        key: Where it stands. In what is written for each member the index is that member; in claims
            and observables it may be any: the value is a vector with a component for each.

    Raises:
        ExpressionError: A quantity of a member stands without an index, or with another one, or
            there are too many terms.
    """
    free, spent, own = find_free(tree, members), Counter[str](), members.member_of(key)
    if own is not None:
        _check_free(free, members)
        return place_at(tree, {members.index: own}, members, spent)
    if not free:
        return place_at(tree, {}, members, spent)
    if key[0] == "definitions" and free.keys() != {members.index}:
        return place_at(tree, dict.fromkeys(free, 0), replace(members, periodic=True), spent)
    _check_free(free, members, free=key[0] in _FREE)
    run = members.run(tree, members.index)
    parts = tuple(place_at(tree, {members.index: k}, members, spent) for k in run)
    return Call(function="vector", arguments=parts, start=tree.start, end=tree.end)


def _check_free(found: Mapping[str, Node], members: Members, *, free: bool = True) -> None:
    """Outside of sums there is the declared index alone, and only where it may be free."""
    for index, node in found.items():
        if not free or index != members.index:
            name = node.name if isinstance(node, Member) else members.index
            problem = f"the index {index!r} is not that of a sum around it"
            expected = f"{name}[{members.index}] inside sum({members.index}, ...)"
            raise fault_at(node, problem, index, expected, tell_count(members, index))


def _below(node: Node) -> tuple[Node, ...]:
    """What is placed before a node: nothing inside a sum, whose index is not known yet."""
    return () if isinstance(node, Sum) or _is_band(node) else children(node)


def place_at(
    term: Node,
    members_of: Mapping[str, int],
    members: Members,
    spent: Counter[str] | None = None,
) -> Node:
    """A term in which indices stand for certain members, and sums for what they add up.

    Args:
        term: With indices.
        members_of: The places of the members by their indices.
        members: How many there are.
        spent: Parts that were written out before, of the same formula.

    Raises:
        ExpressionError: A quantity lies beyond the end, has an index of none, or there are too many
            parts.
    """
    spent = Counter() if spent is None else spent

    def place(node: Node, below: list[Node]) -> Node:
        _count(node, spent)
        match node:
            case Sum():
                return add_up(node, members_of, members, spent)
            case Call(function="tridiagonal"):
                return write_band(node, members)
            case Component() if isinstance(below[0], Name):
                return Index(
                    name=below[0].name, indices=node.indices, start=node.start, end=node.end
                )
            case Name():
                return _place_name(node, members_of, members)
            case Index(name=name, indices=indices) if name in members.names:
                return _find_member(node, name, indices, members)
            case Member():
                return _place_member(node, members_of, members)
            case Entry():
                return _place_entry(node, below, members)
        return _work_out(rebuild(node, below))

    return fold(term, place, _below)


def _count(node: Node, spent: Counter[str], more: int = 1) -> None:
    """Refuse to write out too much, before it is done."""
    spent["WRITTEN_PARTS"] += more
    if spent["WRITTEN_PARTS"] > limits.WRITTEN_PARTS:
        problem = "written out for all members, the expression has too many parts"
        raise fault_at(node, problem, str(spent["WRITTEN_PARTS"]), limit="WRITTEN_PARTS")


def _place_name(node: Name, members_of: Mapping[str, int], members: Members) -> Node:
    """A name, or the number that it stands for."""
    where: dict[str, Any] = {"start": node.start, "end": node.end}
    if node.name in members.names:
        raise _without_index(node, members)
    if node.name in members_of:
        return Number(Fraction(members.first + members_of[node.name]), **where)
    if members.number and node.name == members.number and not members.keeps_number:
        return Number(Fraction(members.count), **where)
    return node


def _place_member(node: Member, members_of: Mapping[str, int], members: Members) -> Node:
    """A quantity of a member, or an entry of a quantity that all share."""
    if node.name in members.scalars:
        problem = f"{node.name!r} has no index"
        expected = "a variable or parameter that is declared with an index"
        hint = f'Write {node.name}, or add index = "{members.index}" where it is declared.'
        raise fault_at(node, problem, node.name, expected, hint)
    if abs(node.shift) > limits.NEIGHBOURS:
        problem = f"the neighbour is {abs(node.shift)} members away"
        raise fault_at(node, problem, str(node.shift), limit="NEIGHBOURS")
    if node.index in members_of:
        number = members.first + members_of[node.index]
    elif node.index and node.index == members.number:
        number = members.count
    else:
        return node
    return _find(node, node.name, (number + node.shift, *node.indices), members)


def _place_entry(node: Entry, below: Sequence[Node], members: Members) -> Node:
    """A quantity whose subscripts are worked out."""
    numbers = list[int]()
    for each in below:
        if not isinstance(each, Number) or each.value.denominator != 1:
            problem = f"a subscript of {node.name!r} is not a whole number"
            expected = "indices of the sums around it, whole numbers and their number"
            raise fault_at(each, problem, node.name, expected)
        numbers.append(int(each.value))
    return _find(node, node.name, tuple(numbers), members)


def _find(node: Node, name: str, numbers: tuple[int, ...], members: Members) -> Node:
    """A quantity by its subscripts, of which the first is a member if it has an index."""
    if name in members.names:
        return _find_member(node, name, numbers, members)
    where = {"start": node.start, "end": node.end}
    if numbers[0] < 1 and not members.first:
        problem = f"the subscript {numbers[0]} of {name!r} is out of range"
        hint = f"Components are counted from 1: write {name}[{members.index}+1], or begin with "
        hint += f"member 1, [index] {members.index} = {{ first = 1 }}."
        raise fault_at(node, problem, str(numbers[0]), "1 or more", hint)
    return Index(name=name, indices=numbers, within=node.within, **where)


def _find_member(node: Node, name: str, numbers: tuple[int, ...], members: Members) -> Node:
    """A quantity of the member of a number."""
    if numbers[1:] and name in members.singles:
        raise _with_component(node, name, numbers, members)
    at, where = members.place(numbers[0] - members.first), {"start": node.start, "end": node.end}
    if at is None:
        problem = f"{name}[{numbers[0]}] lies beyond the end of the chain"
        expected = f"members {members.first} to {members.last}"
        hint = tell_count(members)
        if isinstance(node, Member) and node.index:  # of member i, and so of each
            problem = f"{name}[{node.index}{node.shift:+d}] lies beyond the end of the chain"
            problem += " for some members"
            hint = f"A ring has such a neighbour: write periodic = true in [index] {members.index}."
        raise fault_at(node, problem, str(numbers[0]), expected, hint)
    own = member_name(name, at + (0 if members.from_zero else members.first))
    if numbers[1:]:
        return Index(name=own, indices=numbers[1:], within=node.within, **where)
    return Name(own, within=node.within, **where)


def _with_component(
    node: Node, name: str, numbers: tuple[int, ...], members: Members
) -> ExpressionError:
    """What to say of a component of a quantity that is one number for each member."""
    first = str(numbers[0])
    if isinstance(node, Member) and node.index:
        first = f"{node.index}{f'{node.shift:+d}' if node.shift else ''}"
    text, own = f"{name}[{', '.join([first, *map(str, numbers[1:])])}]", f"{name}[{first}]"
    problem = f"{name!r} is one number for each {members.index}, found {text}"
    hint = f"If members have several of them, add shape = [...] where {name!r} is declared."
    return fault_at(node, problem, text, f"{own}, without a component", hint)


def _work_out(node: Node) -> Node:
    """A node, or the number that it is if all below it are numbers."""
    numbers = [each.value for each in children(node) if isinstance(each, Number)]
    if not numbers or len(numbers) < len(children(node)):
        return _as_power(node)
    value: Fraction | None = None
    match node:
        case Negate():
            value = -numbers[0]
        case Binary(operator="/"):
            value = numbers[0] / numbers[1] if numbers[1] else None
        case Binary(operator=operator):
            value = _OPERATORS[operator](*numbers)
        case Call(function=function) if (
            function in _OF_NUMBERS and len(numbers) > len(function) // 3
        ):
            value = _OF_NUMBERS[function](*numbers)
        case Call(function="pow"):
            return _work_out(power) if isinstance(power := _as_power(node), Power) else node
        case Power(exponent=exponent) if numbers[0] or exponent >= 0:
            value = numbers[0] ** exponent if abs(exponent) <= limits.EXPONENT else None
    return node if value is None else Number(value, start=node.start, end=node.end)


def _as_power(node: Node) -> Node:
    """A power whose exponent has turned out to be a whole number."""
    match node:
        case Call(function="pow", arguments=(base, Number(value=value))):
            if value.denominator == 1 and abs(value) <= limits.EXPONENT:
                return Power(base=base, exponent=int(value), start=node.start, end=node.end)
    return node


def add_up(node: Sum, members_of: Mapping[str, int], members: Members, spent: Counter[str]) -> Node:
    """A sum as what it adds up."""
    _check_sum(node, members_of, members)
    term, runs = node.term, [members.run(node.term, index) for index in node.indices]
    _count(node, spent, prod(map(len, runs)))
    terms = list[Node]()
    for places in product(*runs):
        at = {**members_of, **dict(zip(node.indices, places, strict=True))}
        if _holds(node, at, members, spent):
            terms.append(place_at(term, at, members, spent))
    if not terms:  # of the shape that the sum has
        at = {**members_of, **dict.fromkeys(node.indices, 0)}
        nothing = place_at(term, at, replace(members, periodic=True), spent)
        zero = Number(Fraction(0), start=node.start, end=node.end)
        return _work_out(
            Binary(operator="*", left=zero, right=nothing, start=node.start, end=node.end)
        )
    return reduce(
        lambda a, b: _work_out(
            Binary(operator="+", left=a, right=b, start=node.start, end=node.end)
        ),
        terms,
    )


def _holds(node: Sum, at: Mapping[str, int], members: Members, spent: Counter[str]) -> bool:
    """Whether the condition of a sum holds for some members."""
    values = list[Fraction]()
    for side in node.sides:
        value = place_at(side, at, members, spent)
        if not isinstance(value, Number):
            problem = "the condition of the sum is not one of its indices"
            expected = "indices, numbers and their number, as i < j or j == i + 1"
            raise fault_at(side, problem, expected=expected)
        values.append(value.value)
    return not node.sign or _SIGNS[node.sign](*values)


def write_band(node: Call, members: Members) -> Node:
    """The matrix with a row for each member of an open chain: entries below, on and above.

    ``tridiagonal(a, b, c)`` has a in row i+1 and column i, b in row and column i, and c in row i
    and column i+1.
    """
    if len(node.arguments) != 3 or members.periodic:
        problem = "a ring has no tridiagonal matrix" if members.periodic else "three are needed"
        expected = "tridiagonal(below, diagonal, above) of an open chain"
        raise fault_at(node, problem, str(len(node.arguments)), expected)
    for each in node.arguments:
        _check_free(find_free(each, members), members)
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


def _without_index(node: Name | Index, members: Members) -> Exception:
    problem = f"{node.name!r} is one quantity of each member"
    expected = f"{node.name}[{members.index}] inside sum({members.index}, ...)"
    return fault_at(node, problem, node.name, expected)


def _check_sum(node: Sum, members_of: Mapping[str, int], members: Members) -> None:
    """The indices of a sum have free names and are used, the declared one around the others."""
    index, first = members.index, node.indices[0]
    if index not in members_of and first != index:
        problem = f"there is no index {first!r}"
        raise fault_at(node, problem, first, f"the declared index {index!r}")
    if len(set(node.indices)) < len(node.indices):
        problem = "the two indices of a pair have one name"
        raise fault_at(node, problem, index, f"sum({index}, j, {index} < j, ...)")
    for each in node.indices:
        if each in members.taken:
            problem = f"the name of the index {each!r} is taken"
            hint = "Count with another letter, as sum(k, ...)."
            raise fault_at(node, problem, each, "a name that nothing else has", hint)
    known = {*members_of, *node.indices}
    for name, part in find_free(node.term, members).items():
        if name not in known:
            problem = f"the index {name!r} is not that of a sum around it"
            raise fault_at(part, problem, name, f"one of {', '.join(node.indices)}")
    _check_used(node, members)
    alone = len(node.indices) == 1 and not node.sign
    if not members.periodic and alone and not members.run(node.term, first):
        problem = f"an open chain of {members.count} has no member with these neighbours"
        expected = f"at least {sum(reach(node.term, first, members.names)) + 1} members"
        raise fault_at(node, problem, str(members.count), expected, "Choose a larger size.")


def _check_used(node: Sum, members: Members) -> None:
    """Each index of a sum is named in its term, or in its condition."""
    parts = [part for each in children(node) for part in walk(each)]
    used = {part.index for part in parts if isinstance(part, Member)}
    used |= {part.name for part in parts if isinstance(part, Name)}
    missing = {*node.indices} - used
    if missing:
        problem = f"the term of the sum does not name a member {min(missing)!r}"
        plain = [p for p in parts if isinstance(p, Index) and p.name in members.names]
        name = plain[0].name if plain else ""
        hint = f"The second subscript is a component: {name}[{members.index}, 1]." if plain else ""
        expected = "a quantity of each member in every term"
        raise fault_at(node, problem, min(missing), expected, hint)
