"""Targets, reading loops: what a function does that loops over a table of coefficients.

Comes in: what the reader of a language has read: the table, scales, vectors and passes. Goes out: a
`Body` with every sum written out, which is compared with a Program as any other one.
Read next: `coadjoint.crosscheck.parse_back`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import reduce
from itertools import pairwise

from coadjoint.lower.program import Add, Multiply, Negate, Node, Number, Program, Symbol
from coadjoint.render.targets.body import Body, failure

#: The parts of a table by name, with what its entries are.
TABLES: Mapping[str, Callable[[str], float]] = {
    "starts": int,
    "left": int,
    "right": int,
    "coefficients": float,
    "scaled": int,
}


@dataclass
class Loops:
    """What a function that loops over a table says of itself.

    Attributes:
        tables: The parts of the table, by name.
        vectors: The first row of the state that each vector holds.
        passes: The vectors of each pass over the table.
        first: The first row of the table that the function computes.
        body: The parameters that it takes, and statements of them.
        scales: What the scaled values are times.
    """

    tables: Mapping[str, Sequence[float]]
    vectors: list[int] = field(default_factory=list)
    passes: list[tuple[int, int]] = field(default_factory=list)
    first: int = 0
    body: Body = field(default_factory=Body)
    scales: list[Node] = field(default_factory=list)


def unroll(loops: Loops, program: Program) -> Body:
    """The function with its loops written out.

    Args:
        loops: What its text says.
        program: It names the rows of the state and what is scaled, which the text does by number.

    Raises:
        CrossCheckError: The text counts rows or entries that are not there.
    """
    assert program.table is not None, program.name
    body = loops.body
    body.inputs |= {name: ("state", row) for row, name in enumerate(program.state)}
    try:
        vectors = [_name(loops, program, vector, body) for vector in range(len(loops.vectors))]
        body.outputs = list(enumerate(_sums(loops, vectors, len(program.outputs))))
    except (IndexError, ValueError, TypeError) as error:
        raise failure(
            f"{program.name}: a loop reads what is not there: {error}", program.name
        ) from error
    return body


def _name(loops: Loops, program: Program, vector: int, body: Body) -> list[str]:
    """The names of a vector; what is scaled becomes statements."""
    assert program.table is not None, program.name
    scaled = [int(row) for row in loops.tables["scaled"]]
    known = program.table.vectors[vector]
    size, first = len(known) - len(scaled), loops.vectors[vector]
    names = list(program.state[first : first + size])
    for name, row, scale in zip(known[size:], scaled, loops.scales, strict=True):
        body.statements.append((name, Multiply(scale, Symbol(names[row]))))
    return [*names, *known[size:]]


def _sums(loops: Loops, vectors: Sequence[Sequence[str]], count: int) -> list[Node]:
    """The sums of products of so many rows; what follows the values of a vector is 1."""
    starts, left, right, coefficients = (
        loops.tables[name] for name in ("starts", "left", "right", "coefficients")
    )
    if not len(left) == len(right) == len(coefficients) == starts[-1] or starts[0]:
        raise ValueError(f"{len(left)}, {len(right)} and {len(coefficients)} entries")
    if len(starts) <= loops.first + count:
        raise ValueError(f"{count} rows from {loops.first} on")
    values: list[tuple[Node, ...]]
    values = [(*map(Symbol, names), Number(Fraction(1))) for names in vectors]
    rows = list[Node]()
    for start, end in pairwise(starts[loops.first : loops.first + count + 1]):
        terms: list[Node] = [
            Multiply(
                Multiply(_number(coefficients[entry]), values[a][int(left[entry])]),
                values[b][int(right[entry])],
            )
            for a, b in loops.passes
            for entry in range(int(start), int(end))
        ]
        rows.append(reduce(Add, terms))
    return rows


def _number(value: float) -> Node:
    """A number as texts have it: a negative one is a sign before a positive one."""
    number = Number(Fraction(abs(value)))
    return Negate(number) if value < 0 else number
