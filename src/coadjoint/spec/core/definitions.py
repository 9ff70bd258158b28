"""Definitions: short names for expressions, expanded as trees wherever they occur.

Comes in: a tree, and the definitions that it may name. Goes out: the tree with all of them
expanded. An expanded definition takes the place of the call, so that later faults point there, and
remembers which definition it is from. Read next: `coadjoint.spec.core.formulas`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from coadjoint import limits
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.faults import ExpressionError, did_you_mean
from coadjoint.spec.core.members import Members
from coadjoint.spec.core.names import refusal
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.shapes import shape_of
from coadjoint.spec.core.sizes import check_size
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.tree import (
    Binary,
    Call,
    Component,
    Entry,
    Index,
    Member,
    Name,
    Node,
    Number,
    Sum,
    fold,
    rebuild,
    walk,
)
from coadjoint.spec.core.written_out import write_out


@dataclass(frozen=True)
class Definition:
    """A short name for an expression, expanded as a tree wherever it occurs.

    Attributes:
        name: As declared, ``V`` of ``V(s, d)``.
        arguments: Names of its arguments; empty if it takes none.
        text: The expression as typed.
        typed: The parsed expression, in which earlier definitions are names: documents show it.
        tree: The same with earlier definitions expanded.
        shape: Shape of its value; None with arguments, whose shapes only a call has.
    """

    name: str
    arguments: tuple[str, ...]
    text: str
    typed: Node
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
    """A tree with its definitions expanded.

    Args:
        tree: What was read.
        definitions: What may be expanded, by name.
        spent: Parts that expansion added to other trees of the spec; those of this one are added.

    Raises:
        ExpressionError: One is given another number of arguments, or a tree grows beyond the
            limits, which is seen before it does: 20 definitions that double make a million parts.

    >>> from coadjoint.spec.core.expressions import read_expression
    >>> twice = read_expression("x + x")
    >>> double = Definition(
    ...     name="f", arguments=("x",), text="x + x", typed=twice, tree=twice, shape=None
    ... )
    >>> expand(read_expression("f(2*y)", ["f"]), {"f": double}) == read_expression("2*y + 2*y")
    True
    """
    if not definitions:
        return tree
    spent = Counter() if spent is None else spent
    total = sum(1 for _ in walk(tree))

    def expand_node(node: Node, below: list[tuple[Node, int]]) -> tuple[Node, int]:
        """A node with its number of parts."""
        nonlocal total
        count = 1 + sum(count for _, count in below)
        definition = definitions.get(_name_called(node))
        if definition is None:
            return rebuild(node, [part for part, _ in below]), count
        expanded = _expand_call(node, definition, below)
        total += expanded[1] - count
        spent["DEFINED_PARTS"] += expanded[1]
        if total > limits.EXPRESSION_NODES:
            raise _too_large(node, definition, "EXPRESSION_NODES", "the expression has")
        if spent["DEFINED_PARTS"] > limits.DEFINED_PARTS:
            raise _too_large(node, definition, "DEFINED_PARTS", "all expressions have")
        return expanded

    return fold(tree, expand_node)[0]


def _too_large(node: Node, definition: Definition, limit: str, what: str) -> ExpressionError:
    problem = f"with {definition.name} expanded, {what} too many parts"
    return ExpressionError(problem, node.start, node.end, definition.name, limit=limit)


def _name_called(node: Node) -> str:
    """What a node may be a definition of; empty for operators."""
    match node:
        case Name(name=name) | Index(name=name) | Call(function=name):
            return name
    return ""


def _expand_call(
    node: Node, definition: Definition, given: Sequence[tuple[Node, int]]
) -> tuple[Node, int]:
    """The expression of a definition in the place of its call, and the number of its parts."""
    if len(given) != len(definition.arguments):
        problem = f"{definition.name} is given {len(given)} argument{'s' * (len(given) != 1)}"
        raise ExpressionError(problem, node.start, node.end, str(len(given)), definition.signature)
    values = dict(zip(definition.arguments, given, strict=True))
    count = 0

    def place(part: Node, below: list[Node]) -> Node:
        nonlocal count
        fresh = rebuild(part, below)
        fresh = replace(fresh, start=node.start, end=node.end, within=definition.name)
        argument = values.get(_name_called(part)) if isinstance(part, (Name, Index)) else None
        count += 1 if argument is None else argument[1] + isinstance(part, Index)
        if isinstance(fresh, Member | Entry):
            return _place_indices(fresh, {name: given for name, (given, _) in values.items()})
        return fresh if argument is None else _component(fresh, argument[0])

    whole = fold(definition.tree, place)
    return _component(node, whole), count + isinstance(node, Index)


def _place_indices(node: Member | Entry, given: Mapping[str, Node]) -> Node:
    """A quantity of a member whose name, or whose index, is an argument."""
    named = given.get(node.name)
    if isinstance(named, Name):
        node = replace(node, name=named.name)
    if not isinstance(node, Member) or node.index not in given:
        return node
    index, where = given[node.index], dict[str, Any](start=node.start, end=node.end)
    if isinstance(index, Name):
        return replace(node, index=index.name)
    numbers = [Number(Fraction(each), **where) for each in (node.shift, *node.indices)]
    first = Binary(operator="+", left=index, right=numbers[0], **where)
    return Entry(name=node.name, subscripts=(first, *numbers[1:]), within=node.within, **where)


def _component(node: Node, whole: Node) -> Node:
    """``whole`` for a name that stands for it, and its component for a component of the name."""
    if not isinstance(node, Index):
        return whole
    if isinstance(whole, Name):
        return replace(node, name=whole.name)
    start, end, within = node.start, node.end, node.within
    return Component(
        name=node.name, operand=whole, indices=node.indices, start=start, end=end, within=within
    )


# -- reading --------------------------------------------------------------------------------------


def signature(key: str) -> tuple[str, tuple[str, ...]]:
    """The name and the arguments in a key of [definitions].

    >>> signature("V(s, d)"), signature("u")
    (('V', ('s', 'd')), ('u', ()))
    """
    name, _, rest = key.partition("(")
    return name.strip(), tuple(part.strip() for part in rest.rstrip(") ").split(",") if rest)


def shapes_of(quantities: Iterable[Any]) -> dict[str, Shape]:
    """Shapes of declared quantities, whole and by component."""
    shapes: dict[str, Shape] = {}
    for each in quantities:
        shapes |= {**dict.fromkeys(each.components, ()), each.name: each.value_shape}
    return shapes


def define(
    source: Source, texts: Mapping[str, str], shapes: Mapping[str, Shape]
) -> tuple[Definition, ...]:
    """Definitions in their order; each may use those before it.

    Args:
        source: The text of the spec.
        texts: Expressions by the keys of [definitions].
        shapes: Shapes of all that they may name, apart from each other.

    Raises:
        SpecError: An expression is none, or a name in it is unknown.
        LimitError: With the earlier definitions expanded, an expression is too large.
    """
    known: dict[str, Definition] = {}
    for text, expression in texts.items():
        key: KeyPath = ("definitions", text)
        name, arguments = signature(text)
        _check_arguments(source, key, arguments, [*shapes, *map(_name, texts)])
        try:
            typed = read_expression(
                expression, functions(known), indexed=source.members is not None
            )
            tree = expand(typed, known, source.spent)
            plain, inner = tree, tuple[str, ...]()
            if source.members is not None and arguments:  # which may be indices
                inner = _list_indices(tree, source.members)
            elif source.members is not None:
                plain = write_out(tree, source.members, key)
            shape = _shape(plain, shapes, (*arguments, *inner), [_name(later) for later in texts])
        except ExpressionError as error:
            raise source.expression_fault(key, error) from None
        known[name] = Definition(
            name=name, arguments=arguments, text=expression, typed=typed, tree=tree, shape=shape
        )
    return tuple(known.values())


def _name(key: str) -> str:
    return signature(key)[0]


def _list_indices(tree: Node, members: Members) -> tuple[str, ...]:
    """What counts in a tree, or is the number of what is counted."""
    sums = (node for node in walk(tree) if isinstance(node, Sum))
    named = dict.fromkeys(index for node in sums for index in node.indices)
    return (members.index, members.number, *named)


def _check_arguments(
    source: Source, key: KeyPath, arguments: Sequence[str], taken: Sequence[str]
) -> None:
    """Arguments have names of their own."""
    for place, argument in enumerate(arguments):
        if argument in taken or argument in arguments[:place]:
            problem, expected = f"the argument {argument!r} has a name that is taken", "a free name"
            hint = "A variable or parameter need not be an argument."
        elif (refused := refusal(argument)) is not None:
            problem, expected, hint = refused
        else:
            continue
        at = source.positions.key(key)
        raise source.fault(key, problem, argument, expected, hint, at=at)


def _shape(
    tree: Node, shapes: Mapping[str, Shape], arguments: Sequence[str], defined: Sequence[str]
) -> Shape | None:
    """The shape of a definition; None with arguments, whose shapes only a call has."""
    for node in walk(tree):
        if isinstance(node, (Name, Index)) and node.name not in (*shapes, *arguments):
            later = node.name in defined
            problem = f"{node.name!r} is {'defined no earlier' if later else 'not declared'}"
            expected = "variables, parameters, arguments and earlier definitions"
            hint = "" if later else did_you_mean(node.name, (*shapes, *arguments, *defined))
            raise ExpressionError(problem, node.start, node.end, node.name, expected, hint)
    if arguments:
        return None
    check_size(tree, shapes)
    return shape_of(tree, shapes)
