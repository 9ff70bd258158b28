"""Lowering, jets of families: the Taylor coefficients of a member, one order after the other.

Comes in: the parts of the rates of a family. Goes out: the recurrences of each part. A part is no
system of its own: what it computes are terms of sums or rates of a member, and what moves in it,
the member, its neighbours, a partner and sums, has coefficients that are given order by order.
Read next: `coadjoint.lower.jets`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from coadjoint.lower.jets import Jets, make_jets
from coadjoint.lower.loops import Loops, Part, Read
from coadjoint.lower.program import Level, Program, Statement, list_names


@dataclass(frozen=True)
class PartJets:
    """The recurrences of a part.

    Attributes:
        name: In texts: ``partners``, ``member``, or ``end_0`` and so on.
        part: It.
        program: It, with what is constant among its parameters.
        jets: Its recurrences; their rates are its outputs.
    """

    name: str
    part: Part
    program: Program
    jets: Jets


def make_family_jets(rates: Loops) -> tuple[PartJets, ...]:
    """The recurrences of the parts of rates, in order.

    Args:
        rates: The function ``rhs`` of a family, or ``sided_rhs``.
    """
    count = rates.components
    return tuple(_make(name, part, count) for name, part in list_rate_parts(rates))


def list_rate_parts(rates: Loops) -> Iterator[tuple[str, Part]]:
    """The parts of rates by their names in texts."""
    if rates.partners is not None:
        yield "partners", _take_first(rates.partners, rates.pair_sums)
    assert rates.member is not None, rates.name
    yield "member", rates.member
    for n, (_, part) in enumerate(rates.ends):
        yield f"end_{n}", part


def _take_first(part: Part, count: int) -> Part:
    """The terms of member i alone: each member goes through all its partners."""
    outputs = part.program.outputs[:count]
    needed = {name for output in outputs for name in list_names(output.value)}
    statements = list[Statement]()
    for statement in reversed(part.program.statements):
        if statement.name in needed:
            statements.append(statement)
            needed |= set(list_names(statement.value))
    program = replace(part.program, statements=tuple(statements[::-1]), outputs=outputs)
    return Part(program, part.reads)


def _make(name: str, part: Part, components: int) -> PartJets:
    program = _separate(part, components)
    return PartJets(name, part, program, make_jets(program))


def is_constant(read: Read, components: int) -> bool:
    """Whether a name is constant in a step: a parameter, a size, or a sign below the state."""
    return read.array in ("parameters", "sizes") or (
        read.array == "state" and read.blocks >= components
    )


def _separate(part: Part, components: int) -> Program:
    """The Program of a part, in which what is constant along a motion is a parameter."""
    program = part.program
    constant = [read.name for read in part.reads if is_constant(read, components)]
    known, statements = set(constant), []
    for statement in program.statements:
        read = set(list_names(statement.value))
        if read <= known:
            known.add(statement.name)
        level: Level = "parameters" if read <= known else "member"
        statements.append(replace(statement, level=level))
    return replace(
        program,
        state=tuple(each for each in program.state if each not in constant),
        parameters=tuple(constant),
        statements=tuple(sorted(statements, key=lambda each: each.level != "parameters")),
    )
