"""Declared: the small records that derive, render and solve share.

Comes in: nothing. Goes out: records of names and numbers, which a generated package declares in
its own text and which are as light to import as that package.
Read next: `coadjoint.kernel_functions`, the table of all functions of the kernels.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Quantity:
    """A named block of rows: of state, parameters, inputs, observables or what is reconstructed.

    Attributes:
        name: As in the spec, e.g. ``Pi``.
        shape: ``()``, ``(n,)`` or ``(n, m)``.
        unit: Unit text, ``"1"`` if dimensionless, ``""`` if not stated.
        components: Name of each row, row by row.
        default: One value for each row, or None.
        positive: Whether every value must be positive.
        conserved: Whether the motion conserves it.
        while_constant: Whether it does so only while the inputs are constant.
        upright: Of an attitude, the vector of the state that it turns upright at the start, or "".
    """

    name: str
    shape: tuple[int, ...]
    unit: str
    components: tuple[str, ...]
    default: tuple[float, ...] | None = None
    positive: bool = False
    conserved: bool = False
    while_constant: bool = False
    upright: str = ""


@dataclass(frozen=True)
class Bound:
    """What a row of the function ``domain`` is: positive where a system is defined.

    Attributes:
        name: Of the condition; of the acceleration, or of the reaction, whose pivot it is.
        kind: ``condition``, ``acceleration`` or ``reaction``.
        strict: Whether it may not be zero.
        inputs: Components of state, parameters, inputs and time that it depends on.
    """

    name: str
    kind: str
    strict: bool
    inputs: tuple[str, ...]

    @property
    def label(self) -> str:
        """What the row is, for comments and messages."""
        return self.name if self.kind == "condition" else f"pivot of {self.name}"


@dataclass(frozen=True)
class KernelFunction:
    """A function that a kernel may have.

    What it computes, says the function of the same name in `coadjoint.derive.formulas`.

    Attributes:
        name: The same in every target.
        summary: What it is, for the heads of generated files: one clause without its shape.
        shape: The shape of its result, for documents: ``(n, n, *batch)``.
        doc: What a reader of a System is told beyond that.
        constrained: The summary of a system with constraints, where it is another one.
        by: What it is a derivative of the rates by: the name of an array, or "".
        below: Whether the rows of what is reconstructed follow those of the state in its first
            argument.
    """

    name: str
    summary: str
    shape: str
    doc: str = ""
    constrained: str = ""
    by: Literal["", "state", "inputs", "parameters"] = ""
    below: bool = False
