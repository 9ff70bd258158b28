"""Cross-check, motions of solvers: what steps ask of a motion, in any arithmetic.

Comes in: functions of a kernel, by the equations or by the Programs, and where a member is. Goes
out: its rates, and the other functions that methods on orbits and discrete gradients use.
Read next: `coadjoint.crosscheck.methods`, the steps.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from coadjoint.crosscheck.oracle import Bounded, OutsideDomain
from coadjoint.lower.program import Program

Row = list[Any]


class Motion:
    """A motion, as a function of a state and of the time since a step began: its rates.

    Args:
        programs: The functions of its kernel by name; ``rhs`` has all rows that are integrated.
        evaluate: The rows of a function: its name, values by name, number and functions.
        number: Takes a number into the arithmetic.
        apply: Elementary functions.
        given: Parameters, inputs and time, with their rates.
        noise: Increments of Wiener processes over the length of the step.
        has_kinks: Whether signs have to stay those of the first stage.
    """

    def __init__(
        self,
        programs: Mapping[str, Program],
        evaluate: Callable[..., Any],
        number: Callable[[Fraction], Any],
        apply: Any,
        given: Mapping[str, Sequence[Any]],
        noise: Sequence[float] = (),
        *,
        has_kinks: bool = False,
    ) -> None:
        self._programs, self._evaluate, self._number, self._given = (
            programs,
            evaluate,
            number,
            given,
        )
        self._signs = _Signs(apply)
        self._apply = self._signs.call if has_kinks else apply
        self._noise = [number(Fraction(each)) for each in noise]

    def __call__(self, x: Row, after: Any) -> Row:
        """The rates, with those of noise."""
        rows = self._find("rhs", x, after)
        if self._noise:
            rows = self._add_noise(rows, self._find("noise", x, after))
        self._signs.end_stage()
        return rows

    @property
    def is_noisy(self) -> bool:
        """Whether Wiener processes move it."""
        return bool(self._noise)

    def find_values(self, functions: Sequence[str], x: Row, after: Any) -> Row:
        """The rows of functions at a state, one below the other."""
        return [row for name in functions for row in self._find(name, x, after)]

    def find_gradients(self, functions: Sequence[str], x: Row, after: Any) -> Row:
        """Their derivatives by the state, those of one function below those of another."""
        return self.find_values([f"{name}_gradient" for name in functions], x, after)

    def find_gradient(self, x: Row, after: Any) -> Row:
        """The derivative of the energy by the state, with those of noise times its increments."""
        rows = self._find("energy_gradient", x, after)
        if self._noise:
            rows = self._add_noise(rows, self._find("noise_gradient", x, after))
        return rows

    def turn(self, x: Row, vector: Row, middle: Row, after: Any) -> Row:
        """The Poisson tensor at a state times a vector; what is reconstructed, by a middle."""
        n = len(self._programs["bracket_vector"].state) // 2
        rows = self._find("bracket_vector", [*x[:n], *vector[:n]], after)
        if n < len(x):
            rows += self._find("rhs", [*middle[:n], *x[n:]], after)[n:]
        return rows

    def relax(self, x: Row, vector: Row, after: Any) -> Row:
        """G of a metriplectic motion at a state times a vector."""
        return self._find("metric_vector", [*x, *vector], after)

    def _find(self, function: str, x: Row, after: Any) -> Row:
        """The rows of a function, whose first argument may be shorter than a state."""
        known = dict(zip(self._programs[function].state, x, strict=False))
        for name, first in self._given.items():
            known[name] = first[0] if len(first) == 1 else first[0] + after * first[1]
        return list(self._evaluate(function, known, self._number, self._apply))

    def _add_noise(self, rows: Row, fields: Row) -> Row:
        """Rows with those of each process times its increment."""
        count = len(self._noise)
        for place, each in enumerate(fields):
            rows[place // count] = rows[place // count] + each * self._noise[place % count]
        return rows


class _Signs:
    """Functions of which signs have to stay those of the first stage, as solvers hold sides.

    Args:
        apply: The functions.
    """

    def __init__(self, apply: Any) -> None:
        self._apply, self._first, self._now = apply, list[Any](), list[Any]()

    def call(self, function: str, *of: Any) -> Any:
        """The value of a function."""
        value = self._apply(function, *of)
        if function == "sign" and isinstance(value, Bounded):
            self._now.append(value.value)
        return value

    def end_stage(self) -> None:
        """The stage is done.

        Raises:
            OutsideDomain: It is beyond a kink.
        """
        self._first = self._first or self._now
        if self._now != self._first:
            raise OutsideDomain
        self._now = []
