"""Kinks: where the rates of a system have a corner or a jump, and the rates on either side of it.

Comes in: the Program of the rates. Goes out: the same rates with a given side for each argument of
a sign that moves, and these arguments as a Program. `abs`, `min` and `max` call `sign` too. Between
two kinks the rates with given sides are those of the system, and they are smooth across the kinks,
so that a method of integration keeps its order in a step that ends at one.
Read next: `coadjoint.render.solvers`, and `coadjoint.solve.kinks`, which ends steps.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from coadjoint.lower.program import (
    Call,
    Node,
    Output,
    Program,
    Symbol,
    children,
    list_names,
    walk,
    with_children,
)
from coadjoint.methods import ASKED, JACOBIAN

#: What a side is called: no name of a spec begins with an underscore.
SIDE = "_side"
#: Operations of an argument, written out, beyond which sides are not held: iterations have so many.
MOST = 2000


def hold_sides(programs: Mapping[str, Program]) -> dict[str, Program]:
    """Programs in which the rates take sides as further parameters, and ``kinks`` with arguments.

    They are as they were where no argument of a sign moves, and where there is noise, which crosses
    a kink at any scale of time.

    Args:
        programs: The rates, and what bounds the motion.
    """
    rates = programs["rates"]
    kinks = () if rates.table is not None or "noise" in programs else find_kinks(rates)
    if not kinks:
        return dict(programs)
    sides = {kink: f"{SIDE}{n}" for n, kink in enumerate(kinks, 1)}
    held, form = _hold(rates, sides), rates.factored
    if form is not None:
        if not set(find_kinks(form)) <= sides.keys():
            return dict(programs)  # recurrences are made of other arguments
        held = replace(held, factored=_hold(form, sides))
    bounds = {name: each for name, each in programs.items() if name not in (*ASKED, JACOBIAN)}
    return {**bounds, "rates": held, "kinks": _make_kinks(rates, kinks)}


def find_kinks(rates: Program) -> tuple[Node, ...]:
    """The arguments of signs that move, in the names of inputs of the Program alone.

    There are none where one of them is too long to be written out.
    """
    known, moving = dict[str, Node](), {*rates.state, *rates.inputs, *rates.time}
    found, sizes = dict[Node, None](), dict[str, int]()
    for value in _values(rates, known, sizes):
        for argument in _list_arguments(value):
            if _count(argument, sizes) > MOST:
                return ()
            whole = _expand(argument, known)
            if moving.intersection(list_names(whole)):
                found.setdefault(whole)
    return tuple(found)


def _values(program: Program, known: dict[str, Node], sizes: dict[str, int]) -> Iterator[Node]:
    """The values of statements and outputs, in order; statements are known once they were seen."""
    for statement in program.statements:
        yield statement.value
        known[statement.name] = statement.value
        sizes[statement.name] = _count(statement.value, sizes)
    for output in program.outputs:
        yield output.value


def _list_arguments(value: Node) -> Iterator[Node]:
    """The arguments of signs in a value, the inner ones first."""
    for child in children(value):
        yield from _list_arguments(child)
    match value:
        case Call(function="sign", argument=argument):
            yield argument


def _count(node: Node, sizes: Mapping[str, int]) -> int:
    """The nodes of a value that is written out."""
    return sum(sizes.get(each.name, 1) if isinstance(each, Symbol) else 1 for each in walk(node))


def _expand(node: Node, known: Mapping[str, Node]) -> Node:
    """A node without the names of statements."""
    if isinstance(node, Symbol):
        return _expand(known[node.name], known) if node.name in known else node
    return with_children(node, (_expand(child, known) for child in children(node)))


def _hold(program: Program, sides: Mapping[Node, str]) -> Program:
    """A Program with given sides, its last parameters."""
    known = {statement.name: statement.value for statement in program.statements}

    def hold(node: Node) -> Node:
        match node:
            case Call(function="sign", argument=argument):
                side = sides.get(_expand(argument, known))
                if side is not None:
                    return Symbol(side)
        return with_children(node, map(hold, children(node)))

    return replace(
        program,
        parameters=(*program.parameters, *sides.values()),
        statements=tuple(replace(each, value=hold(each.value)) for each in program.statements),
        outputs=tuple(replace(each, value=hold(each.value)) for each in program.outputs),
    )


def _make_kinks(rates: Program, kinks: tuple[Node, ...]) -> Program:
    """The arguments as a Program, with the statements that they read."""
    return Program(
        name="kinks",
        state=rates.state,
        parameters=rates.parameters,
        statements=(),
        outputs=tuple(Output(f"kink {n}", kink) for n, kink in enumerate(kinks, 1)),
        shape=(len(kinks),),
        inputs=rates.inputs,
        time=rates.time,
    )
