"""Cross-check, exact steps of solvers: one step of each method in 60 digits.

Comes in: a system with its solvers, and members. Goes out: where one step of each leads, from the
equations, with the envelope of what rounding may do, from what is printed.
Read next: `coadjoint.crosscheck.solver_steps`, which compares steps with them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import partial
from typing import Any, Final

import numpy as np

from coadjoint.array_types import Array
from coadjoint.crosscheck import methods
from coadjoint.crosscheck.oracle import (
    CONTEXT,
    Bounded,
    OutsideDomain,
    call,
    exact,
)
from coadjoint.crosscheck.points import Batch
from coadjoint.crosscheck.recurrences import (
    SLOPES,
    bounded_coefficients,
    rates_of,
    run_recurrences,
    split,
)
from coadjoint.crosscheck.series import solve
from coadjoint.crosscheck.solver_motion import Motion
from coadjoint.crosscheck.solver_objects import IMPLICIT, MAPS, NOISY, ORDER, Advance
from coadjoint.crosscheck.subject import Levels, Subject, level_of
from coadjoint.errors import CrossCheckError
from coadjoint.lower.compositions import list_schedules
from coadjoint.lower.evaluation import run
from coadjoint.methods import list_structured
from coadjoint.render.solvers import SolverText
from coadjoint.solve.ensemble import Ensemble, Inputs
from coadjoint.solve.normals import draw_normals

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
#: Of the noise of members, and the largest size of its normal numbers, which some have beyond it.
SEED: Final = 0x243F6A8885A308D3
BOUND: Final = 0.75
#: Sweeps of an implicit step in 60 digits, and those that bound its roundings, of which each is a
#: fraction of the one before. These are this part of others, so that sweeps end soon.
SWEEPS, BOUNDING_SWEEPS, IMPLICIT_PART = 120, 8, 0.125

#: A point as names with their values.
Place = tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class Solvers:
    """A system with its solvers.

    Attributes:
        subject: The system.
        text: Its recurrences.
        advance: What advances members, by method and target.
        depths: How many operations follow one another in a step, by method, where that is known.
        series: Power series of the equations by the points where they begin; targets share them.
        steps: Exact steps by method, member, its point and what is asked for, with None for none.
    """

    subject: Subject
    text: SolverText
    advance: Mapping[str, Mapping[str, Advance]]
    depths: dict[str, int] = field(default_factory=dict)
    series: dict[Place, dict[str, tuple[Decimal, ...]]] = field(default_factory=dict, init=False)
    steps: dict[tuple[str, int, Place, float, float], ExactStep | None] = field(
        default_factory=dict, init=False
    )

    def expand(self, point: Mapping[str, float]) -> dict[str, tuple[Decimal, ...]]:
        """The motion from a point on as a power series of the equations, found once.

        Raises:
            OutsideDomain: The equations have no value there.
        """
        place = tuple(point.items())
        if place not in self.series:
            state, given = split(self.subject.programs["rhs"], point)
            self.series[place] = solve(rates_of(self.subject), state, given, ORDER)
        return self.series[place]

    @property
    def functions(self) -> tuple[str, ...]:
        """The names of its functions, ``kinks`` among them where the rates have some."""
        maps = (each.name for each in self.subject.maps)
        return (*self.subject.programs, *maps, *(["kinks"] if self.text.kinks else []))

    @property
    def is_noisy(self) -> bool:
        """Whether Wiener processes move the state."""
        return "noise" in self.subject.programs

    def begin(
        self, batch: Batch, samples: Array, *, size: float, steps: int, method: str = ""
    ) -> Ensemble:
        """Members at the start of a run by a method; without one, by any that is explicit."""
        rows, members = len(self.subject.programs["rhs"].state), batch.size
        structured = bool(list_structured(self.functions))
        own = IMPLICIT.get(method, IMPLICIT["midpoint"])
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
            seed=SEED,
            bound=BOUND,
            remembered=own.count_memory(rows) if structured else 0,
            is_implicit=structured or self.is_noisy,
            sides=0 if self.text.kinks is None else len(self.text.kinks.outputs),
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
    size = size * IMPLICIT_PART if method in (*NOISY, *IMPLICIT) else size
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
        asked = (method, member, tuple(point.items()), after, length)
        if asked not in solvers.steps:  # rung 5 may ask for those of rung 4
            solvers.steps[asked] = _find_step(solvers, method, member, point, after, length)
        step = solvers.steps[asked]
        if step is not None:
            yield member, step


def _find_step(
    solvers: Solvers,
    method: str,
    member: int,
    point: Mapping[str, float],
    after: float,
    length: float,
) -> ExactStep | None:
    """The step of a member, or None: beyond the largest double there is nothing to compare."""
    try:
        with localcontext(CONTEXT):
            is_moved = solvers.is_noisy and method in NOISY
            noise = find_noise(solvers, member, length) if is_moved else []
            step = _exact_step(solvers, method, point, after, length, noise)
            if "projection" in solvers.subject.programs:
                step = _project(solvers, point, step, after, length)
    except (OutsideDomain, ArithmeticError):
        return None
    ends = all(math.isfinite(float(each.value)) for each in (*step.within, *step.end))
    return step if ends else None


def find_point(solvers: Solvers, batch: Batch, member: int) -> dict[str, float]:
    """A member at the start of a run: inputs have followed their lines, and time is that of it."""
    program, point = solvers.subject.programs["rhs"], solvers.subject.inputs(batch, member)
    slopes = np.resize(np.array(SLOPES), len(program.inputs)).tolist()
    for name, slope in zip(program.inputs, slopes, strict=True):
        point[name] = point[name] + slope * (START - KNOT)
    return point | dict.fromkeys(program.time, START)


def _exact_step(
    solvers: Solvers,
    method: str,
    point: Mapping[str, float],
    after: float,
    length: float,
    noise: Sequence[float],
) -> ExactStep:
    """A step of one member: values from the equations, envelopes and depth from what is printed.

    The noise of the step, its increments over its length, is given.
    """
    if method == "taylor":
        return _exact_taylor(solvers, point, after, length)
    program, h, part = solvers.subject.programs["rhs"], exact(length), exact(after)
    reference, programs = solvers.subject.reference.evaluate, solvers.subject.programs
    name = method.removesuffix("_newton")
    step: Any = methods.composed if method in MAPS else getattr(methods, name, None)
    bounding = step
    if name == "midpoint" and not solvers.is_noisy:
        step = bounding = methods.structured_midpoint
    if method in IMPLICIT or name in ("midpoint", "coadjoint_mean"):
        step, bounding = (partial(step, sweeps=n) for n in (SWEEPS, BOUNDING_SWEEPS))

    def by_printed(function: str, known: Any, number: Any, apply: Any) -> Any:
        return run(programs[function], known, number, apply)

    def motion(evaluate: Any, number: Any, apply: Any, given: Any) -> Motion:
        has_kinks = solvers.text.kinks is not None
        return Motion(programs, evaluate, number, apply, given, noise, has_kinks=has_kinks)

    def maps(number: Any, apply: Any, parameters: Any) -> list[tuple[Any, Any]]:
        """The maps of the method; that they are those of the equations was proved by elements."""
        known = {each.name: each for each in solvers.subject.maps}

        def move(name: str, x: methods.Row, h: Any) -> methods.Row:
            names = dict(zip(known[name].state, [*x, h], strict=True))
            rises = run(known[name], names | parameters, number, apply)
            return [a + rise for a, rise in zip(x, rises, strict=True)]

        return [
            (partial(move, name), None if time == 1.0 else number(Fraction(time)))
            for name, time in list_schedules(known)[method]
        ]

    state, given = split(program, point)
    begin = [exact(value) for value in state.values()]
    bounded = {name: tuple(map(exact, values)) for name, values in given.items()}
    by_equations = motion(reference, exact, call, bounded)
    by_program = motion(by_printed, exact, call, bounded)
    if method in MAPS:
        step = bounding = partial(
            step, maps(exact, call, {name: each[0] for name, each in bounded.items()})
        )
    values = step(by_equations, begin, h, part, exact)
    sizes = bounding(by_program, begin, h, part, exact)
    within, end = (
        [_with_size(a.value, b) for a, b in zip(*both, strict=True)]
        for both in zip(values, sizes, strict=True)
    )
    if method not in solvers.depths:
        zeros = {name: (Levels(0),) * len(values) for name, values in given.items()}
        counted = motion(by_printed, level_of, _raise_level, zeros)
        if method in MAPS:
            levels = {name: each[0] for name, each in zeros.items()}
            bounding = partial(methods.composed, maps(level_of, _raise_level, levels))
        depth, _ = bounding(counted, [Levels(0)] * len(begin), Levels(0), Levels(0), level_of)
        solvers.depths[method] = max(each.count for each in depth)
    return ExactStep(within, end, solvers.depths[method])


def _raise_level(_: str, *of: Levels) -> Levels:
    """A function is one operation."""
    return Levels(max(each.count for each in of) + 1)


def find_noise(solvers: Solvers, member: int, length: float) -> list[float]:
    """The increments of a member over the length of its first step, as solvers take them."""
    first, none = np.array([member], np.uint64), np.zeros(1, np.uint64)
    count = len(solvers.subject.programs["noise"].outputs) // len(
        solvers.subject.programs["rhs"].state
    )
    normals = (float(draw_normals(SEED, first, none, k)[0]) for k in range(count))
    root = math.sqrt(length)
    return [min(max(normal, -BOUND), BOUND) * root / length for normal in normals]


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
    series = solvers.expand(point)
    sizes = bounded_coefficients(solvers.text, state, given, ORDER)
    known = [list(map(_with_size, series[name], sizes[name])) for name in state]
    within, end = (methods.taylor(known, exact(part)) for part in (after, length))
    if "taylor" not in solvers.depths:
        zero = Levels(0)
        levels = {name: (zero,) * len(values) for name, values in given.items()}
        begin = dict.fromkeys(state, zero)
        counted = run_recurrences(solvers.text, begin, levels, ORDER, level_of, _raise_level)
        depth = methods.taylor(list(counted.values()), zero)
        solvers.depths["taylor"] = max(each.count for each in depth)
    return ExactStep(within, end, solvers.depths["taylor"])


def _with_size(value: Decimal, size: Bounded) -> Bounded:
    """A value with the envelope of another way to it."""
    return Bounded(value, size.envelope)
