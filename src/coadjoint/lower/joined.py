"""Joined: Programs of one system as one, for solvers of a larger state.

Comes in: the Program of the rates, and that of the rates of what is reconstructed. Goes out: one
Program with the rows of both, in which each value is computed as in the Program that it is of. What
both compute is there once.
Read next: `coadjoint.render.solvers`.
"""

from __future__ import annotations

from dataclasses import replace

from coadjoint.lower.program import (
    Node,
    Output,
    Program,
    Statement,
    Symbol,
    children,
    with_children,
)


def join(one: Program, other: Program) -> Program:
    """The rows of one Program, then those of another.

    Args:
        one: The first one; its first argument is where that of the other begins.
        other: The second one. Its statements get other names where the first has theirs.
    """
    statements, named = list(one.statements), dict[str, str]()
    known = {statement.value: statement.name for statement in statements}
    taken = {*other.names, *(statement.name for statement in statements)}
    for statement in other.statements:
        value = rename(statement.value, named)
        if value not in known:
            name = statement.name if statement.name not in taken else _find_name(taken)
            taken.add(name)
            known[value] = name
            statements.append(Statement(name, value, statement.level))
        named[statement.name] = known[value]
    rows = (Output(row.label, rename(row.value, named)) for row in other.outputs)
    outputs = (*one.outputs, *rows)
    return replace(
        other,
        name=one.name,
        statements=tuple(sorted(statements, key=lambda each: each.level != "parameters")),
        outputs=outputs,
        shape=(len(outputs),),
        factored=_join_forms(one, other),
    )


def _join_forms(one: Program, other: Program) -> Program | None:
    """The forms that carry velocities as state behind the rows of both; None without them."""
    if one.factored is None or other.factored is None:
        return None
    joined, count = join(one.factored, other.factored), len(one.outputs)
    carried, last = joined.outputs[count : len(one.factored.outputs)], len(one.factored.outputs)
    outputs = (*joined.outputs[:count], *joined.outputs[last:], *carried)
    return replace(joined, outputs=outputs, factored=None)


def widen(program: Program, state: tuple[str, ...], *, moves: bool) -> Program:
    """A Program whose first argument has more rows.

    Args:
        program: The Program.
        state: All rows.
        moves: Whether its results are rows of the state, so that the others follow as they are.
    """
    rest = tuple(Output(name, Symbol(name)) for name in state[len(program.state) :] if moves)
    outputs = (*program.outputs, *rest)
    return replace(program, state=state, outputs=outputs, shape=(len(outputs),))


def rename(node: Node, named: dict[str, str]) -> Node:
    """A node with other names."""
    if isinstance(node, Symbol):
        return Symbol(named.get(node.name, node.name))
    return with_children(node, (rename(child, named) for child in children(node)))


def _find_name(taken: set[str]) -> str:
    """A name that nothing has yet."""
    number = 1
    while f"_r{number}" in taken:
        number += 1
    return f"_r{number}"
