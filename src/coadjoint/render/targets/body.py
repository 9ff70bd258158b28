"""Targets, reading: what the reader of each language makes of one function.

Comes in: nothing. Goes out: the records that are compared with a Program and with recurrences, and
the failure of rung 3.
Read next: `coadjoint.crosscheck.parse_back`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from coadjoint.errors import CrossCheckError
from coadjoint.lower.program import (
    Add,
    Divide,
    Factors,
    Multiply,
    Negate,
    Node,
    Solution,
    Symbol,
)

#: A name with its value.
Line = tuple[str, Node]


@dataclass
class Body:
    """What one form of a function does, as read from its text.

    Attributes:
        inputs: Array and row by name: ``{"Pi1": ("state", 0)}``.
        statements: Name and value, in order.
        outputs: Row and value, in order.
        arrays: How many entries each array has that loops run over.
    """

    inputs: dict[str, tuple[str, int]] = field(default_factory=dict)
    statements: list[tuple[str, Node]] = field(default_factory=list)
    outputs: list[tuple[int, Node]] = field(default_factory=list)
    arrays: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class Loop:
    """A loop over the terms 0 < m < k of sums, in the loop over orders.

    Attributes:
        lines: Name and value, in order.
    """

    lines: tuple[tuple[str, Node], ...]


@dataclass
class SolverBody:
    """What one function of a solver does, as read from its text.

    Attributes:
        inputs: Array and row by name: ``{"Pi1": ("state", 0)}``.
        kept: Names of arrays of coefficients.
        lines: Name and value, in order.
        orders: What is done at each order from 1 on.
        starts: Names that are made at an order and added to.
        scales: Names of what scaled values are times, where recurrences are loops.
        arrays: How many entries each array has that loops run over.
    """

    inputs: dict[str, tuple[str, int]] = field(default_factory=dict)
    kept: list[str] = field(default_factory=list)
    lines: list[tuple[str, Node]] = field(default_factory=list)
    orders: list[tuple[str, Node] | Loop] = field(default_factory=list)
    starts: set[str] = field(default_factory=set)
    scales: list[str] = field(default_factory=list)
    arrays: dict[str, int] = field(default_factory=dict)


def read_loop(called: str, given: Sequence[str], arrays: Mapping[str, int]) -> Line | None:
    """The call of a loop, whose arrays have been made with as many entries as it reads.

    Args:
        called: The name of the function.
        given: Its arguments.
        arrays: What has been made.
    """
    match called.removeprefix("coadjoint"), given:
        case "_factor", (name, size) if size.isdigit():
            rows = int(size)
            if arrays.get(name) == rows * (rows + 1) // 2:
                return name, Factors(rows, ())
        case "_solve", (factors, name, size) if size.isdigit():
            rows = int(size)
            if (arrays.get(factors), arrays.get(name)) == (rows * (rows + 1) // 2, rows):
                return name, Solution(Symbol(factors), ())
    return None


def join(left: Node, sign: str, right: Node) -> Node:
    """Two operands under their operator."""
    match sign:
        case "+":
            return Add(left, right)
        case "-":
            return Add(left, Negate(right))
        case "*":
            return Multiply(left, right)
    return Divide(left, right)


def failure(message: str, function: str, **parts: str) -> CrossCheckError:
    """Rung 3 failed."""
    return CrossCheckError(f"rung 3: {message}.", rung=3, function=function, **parts)
