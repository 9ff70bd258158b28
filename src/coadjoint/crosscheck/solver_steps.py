"""Cross-check, steps of solvers: against 60 digits, and NumPy against C.

Comes in: a `Subject`, its recurrences and its solvers, in NumPy and compiled. Goes out: figures, or
a `CrossCheckError` that shows a member and the two values.

    rung 4   one step of each method, and a sample within it, against the step in 60 digits from
             the equations: no error is above depth * 2^-53 * envelope, where the envelope is that
             of the recurrences, or of the method run on the Program, and the depth is the number of
             operations that follow one another in it; and the step that the Taylor method chooses
             is that of Jorba and Zou, rounded down to eighths of an octave
    rung 5   some steps of a dozen members with samples between them: NumPy has the same bits as
             exact C; where functions beyond sqrt are called, single steps are within the same bound

Read next: `coadjoint.crosscheck.solvers`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal, localcontext
from functools import partial
from typing import Any, Final

import numpy as np

from coadjoint.crosscheck import methods
from coadjoint.crosscheck.bits import find_differing_bits
from coadjoint.crosscheck.compare import Figures
from coadjoint.crosscheck.oracle import (
    CONTEXT,
    Bounded,
    OutsideDomain,
    call,
    distance_in_envelopes,
    error_in_envelopes,
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
from coadjoint.crosscheck.solver_objects import DEGREES, FLAGS, ORDER, Advance
from coadjoint.crosscheck.subject import Levels, Subject, level_of
from coadjoint.errors import CrossCheckError
from coadjoint.lower.program import run
from coadjoint.render.solvers import SolverText
from coadjoint.solve.ensemble import ROOM, Ensemble, Inputs, Record, Status

#: Members of a run: more than lanes, and no multiple of them.
MEMBERS: Final = 13
#: Members that are compared with 60 digits.
ORACLE_MEMBERS: Final = 3
START: Final = 0.5
#: How far a run may go that takes one step as long as it likes.
FAR: Final = 2.0**30
#: Where the lines of inputs begin.
KNOT: Final = 0.25
TOLERANCE: Final = 1e-6
MOST_STEPS: Final = 12
#: The shortest step that is compared with 60 digits.
SHORTEST: Final = 2.0**-24
#: What an envelope has at least, in parts of the largest: steps have 60 digits and no more.
NOTHING: Final = Decimal("1e-40")
#: The part of a step after which there is a sample.
PART: Final = 0.375
#: How far the chosen step may be from the one that is asked for, in octaves: logarithms are within
#: 0.01, a power within one part in 5000.
OCTAVES: Final = 0.02 / (ORDER - 1) + 3e-4
_KEPT: Final = ("out", "state", "time", "step", "next", "steps", "rejected", "status")


@dataclass(frozen=True)
class Solvers:
    """A system with its solvers.

    Attributes:
        subject: The system.
        text: Its recurrences.
        advance: What advances members, by method and target.
    """

    subject: Subject
    text: SolverText
    advance: Mapping[str, Mapping[str, Advance]]

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


def choose_size(solvers: Solvers, batch: Batch) -> float:
    """A step of ordinary length: the median of those that the Taylor method chooses."""
    ensemble = solvers.begin(batch, np.array([START + FAR]), size=0.0, steps=1)
    solvers.advance["taylor"]["numpy"](ensemble, 1)
    taken = (ensemble.time - START)[np.isfinite(ensemble.time) & (ensemble.time > START)]
    return 2.0 ** round(math.log2(float(np.median(taken)))) if taken.size else 0.125


# -- rung 4 ---------------------------------------------------------------------------------------


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


def check_steps(solvers: Solvers, batch: Batch, size: float) -> dict[str, dict[str, Figures]]:
    """Rung 4: single steps against 60 digits.

    Returns:
        The largest k of each method and target, and the members that were compared.

    Raises:
        CrossCheckError: A step is wrong, or none was compared.
    """
    few = batch.take(slice(ORACLE_MEMBERS))
    figures = {}
    for method, targets in solvers.advance.items():
        samples, known = _find_steps(solvers, method, few, size)
        length = float(samples[-1] - START)
        found = {each: solvers.begin(few, samples, size=length, steps=2) for each in targets}
        for target, ensemble in found.items():
            targets[target](ensemble, 1)
        figures[method] = {
            target: _measure(solvers, method, target, ensemble, known)
            for target, ensemble in found.items()
        }
    return figures


def _find_steps(
    solvers: Solvers, method: str, batch: Batch, size: float
) -> tuple[Array, dict[int, ExactStep]]:
    """Samples within and at the end of a step, and the exact steps of the members that have some.

    The step is made shorter where none has one: its stages are outside of where rates have values.
    """
    samples = np.array([START + PART * size, START + size])
    known = dict(_exact_steps(solvers, method, batch, samples))
    if not known and size > SHORTEST:
        return _find_steps(solvers, method, batch, size / 8)
    return samples, known


def _measure(
    solvers: Solvers, method: str, target: str, ensemble: Ensemble, known: Mapping[int, ExactStep]
) -> Figures:
    """The largest error of a target, which no depth may fall below."""
    worst, out, compared = 0.0, ensemble.out, 0
    assert out is not None
    for member, step in known.items():
        if ensemble.status[member] == Status.DOMAIN:
            continue
        compared += 1
        for row, name in enumerate(solvers.subject.programs["rhs"].state):
            pairs = [(out[row, member, 0], step.within[row])]
            pairs.append((ensemble.state[row, member], step.end[row]))
            for value, bounded in pairs:
                k = error_in_envelopes(float(value), bounded)
                if not k <= step.depth:
                    raise solvers.failure(
                        4,
                        f"a step of {method}, {target}: {name} is {float(value)!r}, exactly "
                        f"{float(bounded.value)!r}; k {k:.3g}, allowed {step.depth}",
                        target=target,
                        output=name,
                        found=float(value),
                        expected=float(bounded.value),
                    )
                worst = max(worst, k)
    if not compared:
        raise solvers.failure(4, f"no step of {method} was compared with 60 digits")
    return Figures(worst, 0.0, compared)


def _exact_steps(
    solvers: Solvers, method: str, batch: Batch, samples: Array
) -> Iterator[tuple[int, ExactStep]]:
    """Steps of the members that have some, in 60 digits."""
    after, length = (float(each) - START for each in samples)
    for member in range(batch.size):
        point = _point(solvers, batch, member)
        try:
            with localcontext(CONTEXT):
                step = _exact_step(solvers, method, point, after, length)
                if "projection" in solvers.subject.programs:
                    step = _project(solvers, point, step, after, length)
        except (OutsideDomain, ArithmeticError):
            continue
        yield member, step


def _point(solvers: Solvers, batch: Batch, member: int) -> dict[str, float]:
    """A member at the start of a run: inputs have followed their lines, and time is that of it."""
    program, point = solvers.subject.programs["rhs"], solvers.subject.inputs(batch, member)
    slopes = np.resize(np.array(SLOPES), len(program.inputs)).tolist()
    for name, slope in zip(program.inputs, slopes, strict=True):
        point[name] = point[name] + slope * (START - KNOT)
    return point | dict.fromkeys(program.time, START)


def _exact_step(
    solvers: Solvers, method: str, point: Mapping[str, float], after: float, length: float
) -> ExactStep:
    """A step of one member: values from the equations, envelopes and depth from what is printed."""
    if method == "taylor":
        return _exact_taylor(solvers, point, after, length)
    program, h, part = solvers.subject.programs["rhs"], exact(length), exact(after)
    reference = partial(solvers.subject.reference.evaluate, "rhs")
    step = methods.rk4 if method == "rk4" else methods.dop853

    def rates(evaluate: Any, number: Any, apply: Any, given: Any) -> methods.Rates:
        def at(x: methods.Row, after: Any) -> methods.Row:
            known = dict(zip(program.state, x, strict=True))
            for name, first in given.items():
                known[name] = first[0] if len(first) == 1 else first[0] + after * first[1]
            return list(evaluate(known, number, apply))

        return at

    state, given = split(program, point)
    begin = [exact(value) for value in state.values()]
    bounded = {name: tuple(map(exact, values)) for name, values in given.items()}
    levels = {name: (Levels(0),) * len(values) for name, values in given.items()}
    by_equations = rates(reference, exact, call, bounded)
    by_program = rates(partial(run, program), exact, call, bounded)
    counted = rates(partial(run, program), level_of, lambda _, of: Levels(of.count + 1), levels)
    rows = []
    for end in (part, h):
        values = step(by_equations, begin, h, end, exact)
        sizes = step(by_program, begin, h, end, exact)
        rows.append([_with_size(a.value, b) for a, b in zip(values, sizes, strict=True)])
    zeros, part_level = [Levels(0)] * len(begin), Levels(0)
    depth = step(counted, zeros, Levels(0), part_level, level_of)
    return ExactStep(rows[0], rows[1], max(each.count for each in depth))


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
    depth = run(program, levels, level_of, lambda _, of: Levels(of.count + 1))
    return ExactStep(moved[0], moved[1], max(each.count for each in depth))


def _exact_taylor(
    solvers: Solvers, point: Mapping[str, float], after: float, length: float
) -> ExactStep:
    """A step of the Taylor method: values from the power series of the equations."""
    state, given = split(solvers.subject.programs["rhs"], point)
    series = solve(rates_of(solvers.subject), state, given, ORDER)
    sizes = bounded_coefficients(solvers.text, state, given, ORDER)
    known = [list(map(_with_size, series[name], sizes[name])) for name in state]
    counted = run_recurrences(
        solvers.text,
        dict.fromkeys(state, Levels(0)),
        {name: (Levels(0),) * len(values) for name, values in given.items()},
        ORDER,
        level_of,
        lambda _, of: Levels(of.count + 1),
    )
    depth = methods.taylor(list(counted.values()), Levels(0))
    within, end = (methods.taylor(known, exact(part)) for part in (after, length))
    return ExactStep(within, end, max(each.count for each in depth))


def _with_size(value: Decimal, size: Bounded) -> Bounded:
    """A value with the envelope of another way to it."""
    return Bounded(value, size.envelope)


def check_choice(solvers: Solvers, batch: Batch) -> int:
    """Rung 4: the step that the Taylor method chooses, from the power series of the equations.

    Returns:
        How many steps were compared.

    Raises:
        CrossCheckError: One is another.
    """
    few, compared = batch.take(slice(ORACLE_MEMBERS)), 0
    for target, advance in solvers.advance["taylor"].items():
        ensemble = solvers.begin(few, np.array([START + FAR]), size=0.0, steps=1)
        advance(ensemble, 1)
        for member in range(few.size):
            taken = float(ensemble.time[member]) - START
            if ensemble.status[member] == Status.DOMAIN:
                continue
            try:
                octaves = _choose(solvers, _point(solvers, few, member))
            except (OutsideDomain, ArithmeticError, ValueError):
                continue
            if octaves < -20:  # the time, to which the step is added, has too few digits for it
                continue
            compared += 1
            if abs(math.log2(taken) - octaves) > OCTAVES:
                raise solvers.failure(
                    4,
                    f"the Taylor method, {target}, takes the step {taken!r}; expected "
                    f"{2.0**octaves!r}",
                    target=target,
                    found=taken,
                    expected=2.0**octaves,
                )
    if not compared:
        raise solvers.failure(4, "no step that the Taylor method chooses was compared")
    return compared


def _choose(solvers: Solvers, point: Mapping[str, float]) -> float:
    """The logarithm to base 2 of the step in which the last two orders are below the tolerance.

    With the factor of A. Jorba and M. Zou, Experimental Mathematics 14 (2005) 99. It is that of all
    the time there is where the last two orders vanish.
    """
    state, given = split(solvers.subject.programs["rhs"], point)
    series = solve(rates_of(solvers.subject), state, given, ORDER)
    norms = [max(abs(float(row[k])) for row in series.values()) for k in range(ORDER + 1)]
    size = TOLERANCE * max(norms[0], 1.0)
    last = [k for k in (ORDER - 1, ORDER) if norms[k]]
    radius = min(((size / norms[k]) ** (1 / k) for k in last), default=math.inf)
    return math.log2(min(radius * math.exp(-0.7 / (ORDER - 1)), FAR))


# -- rung 5 ---------------------------------------------------------------------------------------


def check_bits(solvers: Solvers, batch: Batch, size: float) -> dict[str, int]:
    """Rung 5: NumPy and exact C take the same steps, bit for bit.

    Returns:
        Numbers that were compared, by method.

    Raises:
        CrossCheckError: Two differ in a bit.
    """
    equal = dict.fromkeys(FLAGS, 0)
    samples = START + size * np.array([0.0, 0.375, 0.5, 1.25, 2.0, 2.125, 3.3])
    for method, given, fixed in _runs(batch, size):
        targets = solvers.advance[method]
        found, rows = {}, len(solvers.subject.programs["rhs"].state)
        for target, work in (("numpy", MOST_STEPS), ("c", 3)):
            ensemble = solvers.begin(given, samples, size=fixed, steps=MOST_STEPS)
            record = Record.make(rows, DEGREES[method], given.size * MOST_STEPS + ROOM)
            for _ in range(2 * MOST_STEPS):
                if not targets[target](ensemble, work, record):
                    break
            found[target] = {name: np.asarray(getattr(ensemble, name), float) for name in _KEPT}
            order = np.argsort(record.member, kind="stable")
            found[target]["record"] = record.rows[: record.count][order]
        for name, one in found["numpy"].items():
            other = found["c"][name]
            if one.shape != other.shape:
                raise solvers.failure(
                    5, f"{method}: {name} has the shape {one.shape} in NumPy, {other.shape} in C"
                )
            different = np.argwhere(find_differing_bits(one, other))
            if len(different):
                place = tuple(different[0].tolist())
                raise solvers.failure(
                    5,
                    f"{method}: {name}{list(place)} is {float(one[place])!r} in NumPy, "
                    f"{float(other[place])!r} in C",
                    found=float(other[place]),
                    expected=float(one[place]),
                )
        equal[method] += int(np.isfinite(found["c"]["out"]).sum())
    for method, count in equal.items():
        if not count:
            raise solvers.failure(5, f"nothing of {method} was compared")
    return equal


def _runs(batch: Batch, size: float) -> Iterator[tuple[str, Batch, float]]:
    """Methods with members and fixed steps: with parameters of their own, and with shared ones."""
    for given in (batch, batch.share("parameters")):
        yield "taylor", given, 0.0
        yield "dop853", given, 0.0
        yield "rk4", given, size * 0.3125
    yield "taylor", batch, size * 0.75
    yield "dop853", batch, size * 0.75


def check_together(solvers: Solvers, batch: Batch, size: float) -> dict[str, int]:
    """Rung 5 with functions beyond sqrt: steps of NumPy and of exact C are within the bound.

    Returns:
        Members that were compared, by method.

    Raises:
        CrossCheckError: Two are further apart.
    """
    few, together = batch.take(slice(ORACLE_MEMBERS)), dict.fromkeys(FLAGS, 0)
    for method in FLAGS:
        samples, known = _find_steps(solvers, method, few, size)
        found, left = [], np.zeros(few.size, bool)
        for target in ("numpy", "c"):
            ensemble = solvers.begin(few, samples, size=float(samples[-1] - START), steps=2)
            solvers.advance[method][target](ensemble, 1)
            found.append(ensemble.state)
            left |= ensemble.status == Status.DOMAIN
        for member, step in known.items():
            if left[member]:
                continue
            pairs = np.array(found)[:, :, member].T.tolist()
            for (one, other), bounded in zip(pairs, step.end, strict=True):
                k = distance_in_envelopes(one, other, bounded)
                if not k <= step.depth:
                    raise solvers.failure(
                        5,
                        f"a step of {method}: {one!r} in NumPy, {other!r} in C; k {k:.3g}, "
                        f"allowed {step.depth}",
                        found=other,
                        expected=one,
                    )
            together[method] += 1
    return together
