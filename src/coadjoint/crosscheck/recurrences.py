"""Cross-check, recurrences: what solvers print, run in any arithmetic.

Comes in: the records that templates print, and an arithmetic. Goes out: the coefficients that they
stand for. Run in 60 digits they are compared with power series of the equations: rung 2. Run in
numbers that carry their envelopes, and in numbers that count operations, they bound what rounding
does: rung 4.
Read next: `coadjoint.crosscheck.solver_steps`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, MutableMapping, Sequence
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import partial
from itertools import cycle
from typing import Any, Final, TypeVar

import numpy as np

from coadjoint.crosscheck.oracle import CONTEXT, Bounded, OutsideDomain, call, exact
from coadjoint.crosscheck.points import Batch
from coadjoint.crosscheck.series import Rates, solve
from coadjoint.crosscheck.subject import Subject
from coadjoint.errors import CrossCheckError
from coadjoint.lower.evaluation import evaluate, run, settled
from coadjoint.lower.kinks import SIDE
from coadjoint.lower.program import Program, Symbol, walk
from coadjoint.render.recurrences import Line
from coadjoint.render.solvers import SolverText

Value = TypeVar("Value")
#: Orders that are compared, at so many points of which so many are tried.
ORDER: Final = 6
POINTS: Final = 2
TRIES: Final = 60
#: Largest error of 60 digits in units of the largest envelope: 50 are promised.
DIGITS_PROMISED: Final = Decimal("1e-50")
#: Rates of the inputs of a point.
SLOPES: Final = (0.75, -0.25, 0.5)


def run_recurrences(
    text: SolverText,
    state: Mapping[str, Value],
    given: Mapping[str, tuple[Value, ...]],
    order: int,
    number: Callable[[Fraction], Value],
    apply: Callable[..., Value],
) -> dict[str, list[Value]]:
    """The coefficients of a state, by component, as the printed lines compute them.

    Args:
        text: The lines.
        state: Where the motion begins.
        given: Parameters, each alone, and inputs and time with their rates.
        order: The last order.
        number: Takes a number into the arithmetic.
        apply: Applies a function.
    """
    return _Running(text, state, given, number, apply).coefficients(tuple(state), order)


class _Running:
    """Lines being run: names with their orders, and their values."""

    def __init__(
        self,
        text: SolverText,
        state: Mapping[str, Any],
        given: Mapping[str, tuple[Any, ...]],
        number: Callable[[Fraction], Any],
        apply: Callable[..., Any],
    ) -> None:
        self.text, self.number, self.apply = text, number, apply
        self.known: MutableMapping[str, Any] = {f"{name}[0]": x for name, x in state.items()}
        for name, values in given.items():
            if len(values) == 1:
                self.known[name] = values[0]
            self.known |= {f"{name}[{k}]": value for k, value in enumerate(values)}
        if text.kinks is not None:
            known = {**state, **{name: values[0] for name, values in given.items()}}
            sides = (apply("sign", kink) for kink in run(text.kinks, known, number, apply))
            self.known |= {f"{SIDE}{n}": side for n, side in enumerate(sides, 1)}
        self._read: dict[int, frozenset[str]] = {}  # lines live as long as this
        self._driving = [name for name, values in given.items() if len(values) > 1]

    def coefficients(self, state: tuple[str, ...], order: int) -> dict[str, list[Any]]:
        """All orders of the state."""
        for k in range(order + 1):
            self.known[f"_orders[{k}]"] = self.number(Fraction(k))
            if k:
                self.known[f"_parts[{k}]"] = self.number(Fraction(1)) / self.number(Fraction(k))
            for name in self._driving:
                self.known.setdefault(f"{name}[{k}]", self.number(Fraction(0)))
        self._run((*self.text.fixed, *self.text.first))
        for k in range(1, order):
            for stage in self.text.stages:
                self._run(stage.starts, k)
                for m in range(1, k):
                    self._run(stage.terms, k, m)
                self._run(stage.lines, k)
            self._run(self.text.rates, k)
        return {name: [self.known[f"{name}[{k}]"] for k in range(order + 1)] for name in state}

    def _run(self, lines: Iterable[Line], k: int = 0, m: int = 0) -> None:
        """Some lines, at one order and one term."""
        for line in lines:
            values = {name: self.known[_placed(name, k, m)] for name in self._names_in(line)}
            value = evaluate(line.value, values, self.number, self.apply)
            self.known[_placed(line.name, k, m)] = settled(line.name, value)

    def _names_in(self, line: Line) -> frozenset[str]:
        """The names that a line reads."""
        if id(line) not in self._read:
            nodes = walk(line.value)
            self._read[id(line)] = frozenset(n.name for n in nodes if isinstance(n, Symbol))
        return self._read[id(line)]


def _placed(name: str, k: int, m: int) -> str:
    """A name with its order as a number.

    >>> _placed("Pi1[_k - _m]", 5, 2), _placed("_parts[_k + 1]", 5, 2), _placed("h", 5, 2)
    ('Pi1[3]', '_parts[6]', 'h')
    """
    base, bracket, order = name.removesuffix("]").partition("[")
    if not bracket:
        return name
    orders = {"_k": k, "_m": m, "_k - _m": k - m, "_k + 1": k + 1}
    return f"{base}[{orders[order] if order in orders else int(order)}]"


def bounded_coefficients(
    text: SolverText,
    state: Mapping[str, float],
    given: Mapping[str, tuple[float, ...]],
    order: int,
) -> dict[str, list[Bounded]]:
    """The coefficients with their envelopes.

    Raises:
        OutsideDomain: There are none, or none that doubles could find.
    """
    with localcontext(CONTEXT):
        begin = {name: exact(value) for name, value in state.items()}
        rest = {name: tuple(map(exact, values)) for name, values in given.items()}
        try:
            return run_recurrences(text, begin, rest, order, exact, call)
        except ArithmeticError as error:
            raise OutsideDomain from error


def check_recurrences(text: SolverText, subject: Subject) -> int:
    """Rung 2: the recurrences are the power series of the equations.

    Args:
        text: The recurrences.
        subject: The system.

    Returns:
        How many coefficients were compared.

    Raises:
        CrossCheckError: They are not, or no point has a value.
    """
    compared = reached = 0
    batch = draw_points(subject, TRIES)
    for member in range(batch.size):
        state, given = split(subject.programs["rhs"], subject.inputs(batch, member))
        try:
            expected = solve(rates_of(subject), state, given, ORDER)
            found = bounded_coefficients(text, state, given, ORDER)
        except (OutsideDomain, ArithmeticError):
            continue
        _check_equal(found, expected, state, subject.system.name)
        compared += sum(map(len, found.values()))
        reached += 1
        if reached == POINTS:
            break
    if not compared:
        raise CrossCheckError(
            f"rung 2: {subject.system.name}: no coefficient of a power series was compared: there "
            f"is one at none of {batch.size} points.",
            rung=2,
            system=subject.system.name,
        )
    return compared


def draw_points(subject: Subject, count: int, time: float = 0.5) -> Batch:
    """Points of ordinary size at which the rates have a value, those of the domain first.

    Args:
        subject: The system.
        count: How many to draw; those that have no value are left out.
        time: The time at all of them, where the system has one.

    Raises:
        CrossCheckError: The rates have a value at none.
    """
    batch = subject.points.draw("random", seed=7, count=count).take(slice(0, None, 2))
    if subject.inside.size:
        batch = subject.points.draw_around(subject.inside, seed=7, count=count).join(batch)
    if "time" in batch.arrays:
        batch.arrays["time"][...] = time
    defined = subject.is_defined("rhs", batch)
    if "domain" in subject.programs:
        outside = ~(subject.evaluate("domain", batch, "numpy") > 0).all(axis=0)
        order = np.argsort(outside, kind="stable")
        batch, defined = batch.take(order), defined[order]
    batch = batch.take(np.flatnonzero(defined))
    if not batch.size:
        raise CrossCheckError(
            f"rung 2: {subject.system.name}: the rates have a value at no point that was drawn, so "
            "that no solver can be checked. Say in [domain] where they have values.",
            rung=2,
            system=subject.system.name,
        )
    return batch


def rates_of(subject: Subject) -> Rates:
    """The rates of a system, from its equations."""
    return partial(subject.reference.evaluate, "rhs")


def _check_equal(
    found: Mapping[str, list[Bounded]],
    expected: Mapping[str, tuple[Decimal, ...]],
    state: Mapping[str, float],
    system: str,
) -> None:
    """All coefficients are the same but for the last of 60 digits of the largest of them."""
    with localcontext(CONTEXT):
        size = max(each.envelope for coefficients in found.values() for each in coefficients)
        for name, coefficients in found.items():
            for order, (one, other) in enumerate(zip(coefficients, expected[name], strict=True)):
                if abs(one.value - other) > DIGITS_PROMISED * size:
                    raise CrossCheckError(
                        f"rung 2: {system}: order {order} of {name} is {float(one.value)!r} by the "
                        f"recurrences, {float(other)!r} by the power series of the equations; at "
                        f"{state}. The recurrences of coadjoint.lower.jets are wrong.",
                        rung=2,
                        system=system,
                        output=name,
                        found=float(one.value),
                        expected=float(other),
                    )


def split(
    program: Program, point: Mapping[str, float], slopes: Sequence[float] = SLOPES
) -> tuple[dict[str, float], dict[str, tuple[float, ...]]]:
    """A point as a state, and parameters, inputs and time with their rates.

    Args:
        program: The rates.
        point: State, parameters, inputs and time by name.
        slopes: Rates of the inputs, one after the other and again from the first.
    """
    state = {name: point[name] for name in program.state}
    given: dict[str, tuple[float, ...]] = {name: (point[name],) for name in program.parameters}
    driven = zip(program.inputs, cycle(slopes), strict=False)
    given |= {name: (point[name], slope) for name, slope in driven}
    return state, given | {name: (point[name], 1.0) for name in program.time}
