"""Targets, reading: what the reader of each language makes of one function.

Comes in: nothing. Goes out: the record that is compared with a Program, and the failure of rung 3.
Read next: `coadjoint.crosscheck.parse_back`.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from coadjoint.errors import CrossCheckError
from coadjoint.lower.program import Add, Divide, Multiply, Negate, Node


@dataclass
class Body:
    """What one form of a function does, as read from its text.

    Attributes:
        inputs: Array and row by name: ``{"Pi1": ("state", 0)}``.
        statements: Name and value, in order.
        outputs: Row and value, in order.
    """

    inputs: dict[str, tuple[str, int]] = field(default_factory=dict)
    statements: list[tuple[str, Node]] = field(default_factory=list)
    outputs: list[tuple[int, Node]] = field(default_factory=list)


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
