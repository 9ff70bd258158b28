"""Cross-check, exact steps of solvers: one step of each method in 60 digits.

Comes in: a system with its solvers, and members. Goes out: where one step of each leads, from the
equations, with the envelope of what rounding may do, from what is printed.
Read next: `coadjoint.crosscheck.solver_steps`, which compares steps with them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import partial
from typing import Any, Final

import numpy as np

from coadjoint.crosscheck import methods
from coadjoint.crosscheck.oracle import (
    CONTEXT,
    Bounded,
    OutsideDomain,
    call,
    exact,
)
from coadjoint.crosscheck.points import Array, Batch
from coadjoint.crosscheck.recurrences import (
    SLOPES,
    bounded_coefficients,
    rates_of,
    run_recurrences,
    split,
)
from coadjoint.crosscheck.series import solve
from coadjoint.crosscheck.solver_objects import ORDER, Advance
from coadjoint.crosscheck.subject import Levels, Subject, level_of
from coadjoint.errors import CrossCheckError
from coadjoint.lower.program import Program, run
from coadjoint.render.solvers import SolverText
from coadjoint.solve.ensemble import Ensemble, Inputs

#: When members begin.
START: Final = 0.5
#: Where the lines of inputs begin.
KNOT: Final = 0.25
TOLERANCE: Final = 1e-6
#: The shortest step that is compared with 60 digits.
SHORTEST: Final = 2.0**-24
#: What an envelope has at least, in parts of the largest: steps have 60 digits and no more.
NOTHING: Final = Decimal("1e-40")
#: The part of a step after which there is a sample.
PART: Final = 0.375
#: Methods of Runge and Kutta.
STEPS: Final = {"rk4": methods.rk4, "dop853": methods.dop853}


@dataclass(frozen=True)
class Solvers:
    """A system with its solvers.

    Attributes:
        subject: The system.
        text: Its recurrences.
        advance: What advances members, by method and target.
        depths: How many operations follow one another in a step, by method, where that is known.
    """

    subject: Subject
    text: SolverText
    advance: Mapping[str, Mapping[str, Advance]]
    depths: dict[str, int] = field(default_factory=dict)

    def begin(self, batch: Batch, samples: Array, *, size: float, steps: int) -> Ensemble:
        """Members at the start of a run."""
        rows, members = len(self.subject.programs["rhs"].state), batch.size
        inputs = batch.arrays.get("inputs", np.zeros((0, members)))
        slopes = np.resize(np.array(SLOPES), len(inputs))[:, np.newaxis] * np.ones(members)
        ensemble = Ensemble(
            state=np.array(batch.state[:rows], order="C"),
            parameters=np.ascontiguousarray(batch.parameters),
            inputs=Inputs(np.array([KNOT]), np.ascontiguousarray(inputs), slopes, own=True),
            has_time=bool(self.subject.programs["rhs"].time),
            samples=samples,
            out=np.full((rows, members, len(samples)), np.nan),
            rtol=TOLERANCE,
            atol=TOLERANCE,
            size=size,
            max_steps=steps,
        )
        ensemble.begin(START)
        return ensemble

    def failure(self, rung: int, message: str, **parts: Any) -> CrossCheckError:
        """A disagreement."""
        return CrossCheckError(
            f"rung {rung}: {self.subject.system.name}: {message}. The solvers do not compute the "
            "motion: look at what changed last in recurrences, steps or templates.",
            rung=rung,
            system=self.subject.system.name,
            **parts,
        )


@dataclass(frozen=True)
class ExactStep:
    """One step of a member by one method.

    Attributes:
        within: The state at the sample within it, with envelopes.
        end: The state at its end.
        depth: How many operations follow one another, at the most.
    """

    within: list[Bounded]
    end: list[Bounded]
    depth: int


def find_steps(
    solvers: Solvers, method: str, batch: Batch, size: float
) -> tuple[Array, dict[int, ExactStep]]:
    """Samples within and at the end of a step, and the exact steps of the members that have some.

    The step is made shorter where none has one: its stages are outside of where rates have values.
    """
    samples = np.array([START + PART * size, START + size])
    known = dict(list_exact_steps(solvers, method, batch, samples))
    if not known and size > SHORTEST:
        return find_steps(solvers, method, batch, size / 8)
    return samples, known


def list_exact_steps(
    solvers: Solvers, method: str, batch: Batch, samples: Array
) -> Iterator[tuple[int, ExactStep]]:
    """Steps of the members that have some, in 60 digits."""
    after, length = (float(each) - START for each in samples)
    for member in range(batch.size):
        point = find_point(solvers, batch, member)
        try:
            with localcontext(CONTEXT):
                step = _exact_step(solvers, method, point, after, length)
                if "projection" in solvers.subject.programs:
                    step = _project(solvers, point, step, after, length)
        except (OutsideDomain, ArithmeticError):
            continue
        if all(math.isfinite(float(each.value)) for each in (*step.within, *step.end)):
            yield member, step  # beyond the largest double there is nothing to compare


def find_point(solvers: Solvers, batch: Batch, member: int) -> dict[str, float]:
    """A member at the start of a run: inputs have followed their lines, and time is that of it."""
    program, point = solvers.subject.programs["rhs"], solvers.subject.inputs(batch, member)
    slopes = np.resize(np.array(SLOPES), len(program.inputs)).tolist()
    for name, slope in zip(program.inputs, slopes, strict=True):
        point[name] = point[name] + slope * (START - KNOT)
    return point | dict.fromkeys(program.time, START)


def _exact_step(
    solvers: Solvers, method: str, point: Mapping[str, float], after: float, length: float
) -> ExactStep:
    """A step of one member: values from the equations, envelopes from what is printed."""
    if method == "taylor":
        return _exact_taylor(solvers, point, after, length)
    program = solvers.subject.programs["rhs"]
    state, given = split(program, point)
    begin = [exact(value) for value in state.values()]
    bounded = {name: tuple(map(exact, values)) for name, values in given.items()}
    reference = partial(solvers.subject.reference.evaluate, "rhs")
    rows = [
        STEPS[method](
            _follow(program.state, partial(evaluate, number=exact, call=call), bounded),
            begin,
            exact(length),
            exact(after),
            exact,
        )
        for evaluate in (reference, partial(_run, program))
    ]
    within, end = (
        [_with_size(a.value, b) for a, b in zip(*both, strict=True)]
        for both in zip(*rows, strict=True)
    )
    return ExactStep(within, end, _find_depth(solvers, method, point))


def _follow(
    names: Sequence[str],
    evaluate: Callable[[Mapping[str, Any]], Iterable[Any]],
    given: Mapping[str, tuple[Any, ...]],
) -> methods.Rates:
    """Rates at a state, some time after the start; inputs follow their lines."""

    def at(x: methods.Row, after: Any) -> methods.Row:
        known = dict(zip(names, x, strict=True))
        for name, first in given.items():
            known[name] = first[0] if len(first) == 1 else first[0] + after * first[1]
        return list(evaluate(known))

    return at


def _run(
    program: Program, values: Mapping[str, Any], number: Callable[[Fraction], Any], call: Any
) -> list[Any]:
    """A Program as a `Reference` evaluates."""
    return list(run(program, values, number, call))


def _find_depth(solvers: Solvers, method: str, point: Mapping[str, float]) -> int:
    """How many operations follow one another in a step of a method, at any point."""
    if method in solvers.depths:
        return solvers.depths[method]
    program, zero = solvers.subject.programs["rhs"], Levels(0)
    state, given = split(program, point)
    levels = {name: (zero,) * len(values) for name, values in given.items()}
    if method == "taylor":
        begin = dict.fromkeys(state, zero)
        counted = run_recurrences(solvers.text, begin, levels, ORDER, level_of, _raise_level)
        end = methods.taylor(list(counted.values()), zero)
    else:
        evaluate = partial(_run, program, number=level_of, call=_raise_level)
        rates = _follow(program.state, evaluate, levels)
        end, _ = STEPS[method](rates, [zero] * len(state), zero, zero, level_of)
    solvers.depths[method] = max(int(each.count) for each in end)
    return solvers.depths[method]


def _raise_level(_: str, *of: Levels) -> Levels:
    """A function is one operation."""
    return Levels(max(each.count for each in of) + 1)


def _project(
    solvers: Solvers, point: Mapping[str, float], step: ExactStep, after: float, length: float
) -> ExactStep:
    """A step with both states moved onto the constraints."""
    program, subject = solvers.subject.programs["projection"], solvers.subject
    _, given = split(subject.programs["rhs"], point)
    moved = []
    for state, time in ((step.within, after), (step.end, length)):
        known = dict(zip(subject.programs["rhs"].state, state, strict=True))
        for name, values in given.items():
            slope = exact(values[1]) * exact(time) if len(values) > 1 else exact(0.0)
            known[name] = exact(values[0]) + slope
        nearest = subject.reference.evaluate("projection", known, exact, call)
        sizes = run(program, known, exact, call)
        least = NOTHING * max(each.envelope for each in state)
        moved.append(
            [
                Bounded(one.value, max(other.envelope, least))
                for one, other in zip(nearest, sizes, strict=True)
            ]
        )
    levels = dict.fromkeys((*program.names,), Levels(step.depth))
    depth = run(program, levels, level_of, _raise_level)
    return ExactStep(moved[0], moved[1], max(each.count for each in depth))


def _exact_taylor(
    solvers: Solvers, point: Mapping[str, float], after: float, length: float
) -> ExactStep:
    """A step of the Taylor method: values from the power series of the equations."""
    state, given = split(solvers.subject.programs["rhs"], point)
    series = solve(rates_of(solvers.subject), state, given, ORDER)
    sizes = bounded_coefficients(solvers.text, state, given, ORDER)
    known = [list(map(_with_size, series[name], sizes[name])) for name in state]
    within, end = (methods.taylor(known, exact(part)) for part in (after, length))
    return ExactStep(within, end, _find_depth(solvers, "taylor", point))


def _with_size(value: Decimal, size: Bounded) -> Bounded:
    """A value with the envelope of another way to it."""
    return Bounded(value, size.envelope)
