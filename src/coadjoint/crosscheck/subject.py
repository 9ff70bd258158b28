"""Cross-check, the subject: the functions of one system in every form that is compared.

Comes in: Programs, the equations, a loaded system and targets. Goes out: values of each form at
batches of points, the largest error that is allowed, and the error that shows a disagreement.
Read next: `coadjoint.crosscheck.hard`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property, partial
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from coadjoint.array_types import Array
from coadjoint.crosscheck.inside import points_inside
from coadjoint.crosscheck.oracle import Reference
from coadjoint.crosscheck.points import Batch, Points, safe_exponent
from coadjoint.crosscheck.replay import Replayed
from coadjoint.derive.mechanics.iteration import SETTLE, SETTLE_LAST
from coadjoint.derive.reference import Reference as Derived
from coadjoint.elementary import ELEMENTARY
from coadjoint.errors import CoadjointError, CrossCheckError
from coadjoint.kernel_functions import KERNEL_FUNCTIONS
from coadjoint.lower.evaluation import run
from coadjoint.lower.program import (
    LEVELS,
    Call,
    Divide,
    Factors,
    Node,
    Program,
    Solution,
    Statement,
    list_names,
    walk,
)
from coadjoint.render.kernels import elementary_functions
from coadjoint.render.targets import BUILDS

#: Largest k of + - * / sqrt, and of kernels that call other functions (measured: 2.8 and 7.1).
K_ARITHMETIC: Final = 4.0
K_ELEMENTARY: Final = 16.0
#: What results hold before a kernel writes them: a member that it leaves out keeps this number.
UNTOUCHED: Final = -1.2345678901234567e-89


@dataclass(frozen=True)
class Levels:
    """How many operations follow one another up to a value; an arithmetic for `run`."""

    count: int

    def __add__(self, other: Levels) -> Levels:
        return Levels(max(self.count, other.count) + 1)

    __mul__ = __truediv__ = __add__

    def __neg__(self) -> Levels:
        return self

    def settled(self) -> Levels:
        """A value that is taken as it is."""
        return Levels(0)


def depth(program: Program) -> int:
    """The most operations that follow one another in a Program: no k is above it to first order.

    The error of a sum is at most those of its addends and one rounding, and its envelope is the sum
    of theirs: k grows by 1 at most. The same holds for a product, a quotient and a function.
    """
    inputs = dict.fromkeys(program.names, Levels(0))
    outputs = run(program, inputs, level_of, lambda _, *of: Levels(max(u.count for u in of) + 1))
    return max(output.count for output in outputs)


def level_of(value: Fraction) -> Levels:
    """A constant is rounded once, unless it is a double."""
    return Levels(int(Fraction(float(value)) != value))


def work(program: Program) -> int:
    """How much a function computes: its operations and outputs."""
    counts = (program.operation_counts(level).values() for level in LEVELS)
    return len(program.outputs) + sum(map(sum, counts))


def list_stopping(program: Program) -> tuple[list[Statement], list[Node]]:
    """What a Program divides by and calls functions of: statements in order, and outputs."""

    def stops(node: Node) -> bool:
        return any(isinstance(each, Divide | Call | Factors | Solution) for each in walk(node))

    def names(node: Node) -> set[str]:
        return set(list_names(node))

    outputs = [each.value for each in program.outputs if stops(each.value)]
    read, kept = set[str]().union(*map(names, outputs)), list[Statement]()
    for statement in reversed(program.statements):
        if statement.name in read or stops(statement.value):
            read |= names(statement.value)
            kept.append(statement)
    return kept[::-1], outputs


@dataclass(frozen=True)
class Subject:
    """One system in every form that is compared.

    Attributes:
        programs: Its functions by name.
        reference: Its equations.
        system: The loaded system.
        targets: The targets to evaluate.
        maps: What explicit methods of its solvers make a step of.
    """

    programs: Mapping[str, Program]
    reference: Reference
    system: Any
    targets: tuple[str, ...]
    maps: tuple[Program, ...] = field(default=(), kw_only=True)

    @cached_property
    def work(self) -> dict[str, int]:
        """How much each function computes."""
        return {name: work(program) for name, program in self.programs.items()}

    @cached_property
    def stopping(self) -> dict[str, tuple[list[Statement], list[Node]]]:
        """Of each function the statements and outputs at which a language may stop.

        Something is divided there, or a function called; what these read is among the statements.
        """
        return {name: list_stopping(program) for name, program in self.programs.items()}

    @cached_property
    def elementary(self) -> bool:
        """Whether functions beyond sqrt are called anywhere."""
        return bool(elementary_functions(self.programs.values()))

    @cached_property
    def exact(self) -> tuple[str, ...]:
        """The targets other than NumPy that have the same bits, as far as bits are promised."""
        return tuple(
            each
            for each in self.targets
            if "numpy" in self.targets and each != "numpy" and each in BUILDS[each].exact
        )

    def has_equal_bits(self, function: str) -> bool:
        """Whether a function calls nothing beyond sqrt, so that its bits are promised."""
        return not elementary_functions([self.programs[function]])

    @cached_property
    def threshold(self) -> float:
        """The largest k allowed.

        A k above the `depth` is impossible to first order, and one near it is rare, so that short
        formulas are held to less.
        """
        allowed = K_ELEMENTARY if self.elementary else K_ARITHMETIC
        return max(allowed, *map(float, map(depth, self.programs.values())))

    @cached_property
    def points(self) -> Points:
        """Where the system is evaluated."""
        quantities = self.system.PARAMETERS.values()
        positive = tuple(each.positive for each in quantities for _ in each.components)
        states = len(self._widest.state)
        exponent = safe_exponent(self.programs, self.elementary)
        driving = {"inputs": len(self._widest.inputs), "time": len(self._widest.time)}
        counts = {name: count for name, count in driving.items() if count}
        return Points(states, positive, exponent, counts)

    @cached_property
    def inside(self) -> Array:
        """Points of the domain, each name of the widest function in a row; perhaps none."""
        return self.find_inside(self._widest.names)

    def find_inside(self, names: Sequence[str]) -> Array:
        """The same with rows for some names."""
        of = self.reference.of if isinstance(self.reference, Replayed) else self.reference
        if not isinstance(of, Derived):
            return np.empty((len(names), 0))
        return points_inside(of.equations, names)

    def values(self, batch: Batch) -> dict[str, Any]:
        """State, parameters, inputs and time of a batch by name."""
        rest = batch.rows()[len(batch.state) :]
        known = dict[str, Any]()
        for program in self.programs.values():
            own = (*batch.state[: len(program.state)], *rest)
            known |= zip(program.names, own, strict=True)
        return known

    @property
    def _widest(self) -> Program:
        """A function with the most inputs; those of the others are the first of them."""
        return max(self.programs.values(), key=lambda program: len(program.state))

    def evaluate(self, function: str, batch: Batch, target: str) -> Array:
        """The outputs of one function, ``(rows, N)``.

        Raises:
            CrossCheckError: The kernel raised an error.
        """
        program, members = self.programs[function], batch.size
        given, named = batch.arguments(len(program.state))
        values = np.full((*program.shape, members), UNTOUCHED)
        try:
            method = getattr(self.system, function)
            if KERNEL_FUNCTIONS[function].below == "vector":  # which stands below the state already
                method = partial(self.system.evaluate, function)
            method(*given, **named, target=target, out=values)
        except CoadjointError:
            raise
        except Exception as error:
            raise CrossCheckError(
                f"rung 4: {self.system.name}.{function} of the target {target} does not run: "
                f"{type(error).__name__}: {error}. The printer or the template is wrong.",
                rung=4,
                system=self.system.name,
                function=function,
                target=target,
                found=f"{type(error).__name__}: {error}",
            ) from error
        return values.reshape(len(program.outputs), members)

    def is_defined(self, function: str, batch: Batch) -> NDArray[np.bool_]:
        """For each member, whether the equations, not a kernel, give numbers in doubles.

        So must the functions in them: the slope of ``log(x)`` has a value where x is negative.
        """
        known = self.values(batch)
        called = list[Array]()

        def call(function: str, *arguments: Array) -> Array:
            if function in (SETTLE, SETTLE_LAST):
                return arguments[0]
            called.append(np.asarray(getattr(np, ELEMENTARY[function].numpy_name)(*arguments)))
            return called[-1]

        with np.errstate(all="ignore"):
            values = self.reference.evaluate(function, known, np.float64, call)
        defined = np.ones(batch.size, dtype=bool)
        for value in (*values, *called):
            defined &= np.isfinite(value)
        return defined

    def columns(self, batch: Batch) -> dict[str, Array]:
        """State, parameters, inputs and time by name, a number for each member."""
        return {name: np.broadcast_to(row, batch.size) for name, row in self.values(batch).items()}

    def inputs(self, batch: Batch, member: int) -> dict[str, float]:
        """State, parameters, inputs and time of one member by name."""
        values = self.values(batch).items()
        return {name: float(row[member] if row.ndim else row) for name, row in values}

    def failure(
        self, function: str, row: int, batch: Batch, member: int, **parts: Any
    ) -> CrossCheckError:
        """A disagreement at one member; ``parts`` are the rung, the values and what was allowed."""
        output = self.programs[function].outputs[row].label
        point = {name: repr(value) for name, value in self.inputs(batch, member).items()}
        shown = ", ".join(f"{name} {value}" for name, value in parts.items() if name != "rung")
        where = ", ".join(f"{name} = {value}" for name, value in point.items())
        return CrossCheckError(
            f"rung {parts['rung']}: {self.system.name}.{function}, output {output}: {shown}; "
            f"at {where}. The kernel does not compute the equations: look at what changed last in "
            "lowering, printers, templates or compiler flags.",
            system=self.system.name,
            function=function,
            output=output,
            point=point,
            **parts,
        )
