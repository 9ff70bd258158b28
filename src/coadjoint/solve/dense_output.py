"""Dense output: the steps of an integration, and the states at any time by their polynomials.

Comes in: the steps of the generated solvers, or those of SciPy. Goes out: states between the ends
of steps. They are the states that samples at these times have, to the last bit.
Read next: `coadjoint.solve.crossings`, which looks for events in the same steps.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.arrays import as_float64
from coadjoint.solve.course import Start
from coadjoint.solve.driving import Signal
from coadjoint.solve.lookout import Ending, Lookout, list_occurrences
from coadjoint.solve.occurrences import Events
from coadjoint.solve.surroundings import Driven, Surroundings
from coadjoint.solve.taken import Steps

if TYPE_CHECKING:
    from coadjoint.array_types import Array, Places
    from coadjoint.solve.solution import Solution

#: The degree for which interpolants of SciPy are taken.
SCIPY_DEGREE = 16


class KeptSteps(Steps, Protocol):
    """Steps that are kept."""

    @property
    def nbytes(self) -> int:
        """The memory that they take."""
        ...

    def take(self, which: Places) -> KeptSteps:
        """Some of them, in a given order."""
        ...


@dataclass
class Interpolants:
    """Steps of trajectories by SciPy.

    Attributes:
        paths: The interpolant of each step.
        start: When each begins.
        size: How long each is.
        member: Whose each is.
    """

    paths: Sequence[Any]
    start: Array
    size: Array
    member: Places
    degree: int = SCIPY_DEGREE

    @property
    def nbytes(self) -> int:
        """The memory that they take, but for the objects of SciPy."""
        arrays = (value for path in self.paths for value in vars(path).values())
        return sum(each.nbytes for each in arrays if isinstance(each, np.ndarray))

    def take(self, which: Places) -> Interpolants:
        """Some of them, in a given order."""
        paths = [self.paths[place] for place in which.tolist()]
        return Interpolants(
            paths=paths,
            start=self.start[which],
            size=self.size[which],
            member=self.member[which],
        )

    def follow(self, rows: Places, only: Places | None = None) -> Callable[[Array], Array]:
        """As `Steps.follow`."""

        def evaluate(after: Array) -> Array:
            states = np.empty((len(self.paths[0](self.start[0])), *after.shape))
            for row in np.unique(rows).tolist():
                own = rows == row
                time = self.start[row] + after[..., own]
                states[..., own] = self.paths[row](time.ravel()).reshape(-1, *time.shape)
            return states if only is None else states[only]

        return evaluate

    def enclose(self, row: int) -> None:
        """As `Steps.enclose`: nothing is known."""


class Projected:
    """Steps whose states are moved onto the constraints that a System keeps.

    Args:
        steps: The steps.
        surroundings: The parameters and inputs with which they were made.
    """

    def __init__(self, steps: Steps, surroundings: Surroundings) -> None:
        self._steps, self._around = steps, surroundings
        self.member, self.start, self.size = steps.member, steps.start, steps.size
        self.degree = steps.degree

    def enclose(self, row: int) -> None:
        """As `Steps.enclose`: nothing is known."""

    def follow(self, rows: Places, only: Places | None = None) -> Callable[[Array], Array]:
        """As `Steps.follow`; where there is no nearest state, it is left as it is."""
        follow = self._steps.follow(rows)

        def evaluate(after: Array) -> Array:
            states = self._project(follow(after), rows, after)
            return states if only is None else states[only]

        return evaluate

    def _project(self, states: Array, rows: Places, after: Array) -> Array:
        """The nearest states on the constraints."""
        flat = states.reshape(len(states), -1)
        system, n = self._around.system, self._around.system.STATE.size
        member = np.broadcast_to(self.member[rows], after.shape).ravel()
        start = np.broadcast_to(self.start[rows], after.shape).ravel()
        time = start + after.ravel()
        shared = self._around.parameters.ndim == 1
        nearest = system.evaluate(
            "projection",
            np.ascontiguousarray(flat[:n]),
            self._around.parameters if shared else self._around.parameters[:, member],
            None if self._around.driven is None else self._around.driven(member, start, time),
            time=time if system.TIME else None,
            target="numpy",
        )
        good = np.isfinite(nearest).all(axis=0)
        moved = np.concatenate([np.where(good, nearest, flat[:n]), flat[n:]])
        return moved.reshape(states.shape)


def move_onto_constraints(steps: Steps, surroundings: Surroundings) -> Steps:
    """Steps with their states on the constraints; as they are where a System keeps none."""
    keeps = "projection" in surroundings.system.functions
    return Projected(steps, surroundings) if keeps else steps


# -- what a Solution keeps ------------------------------------------------------------------------


@dataclass(frozen=True)
class Dense:
    """The steps of a Solution.

    Attributes:
        steps: By member and time, as they were taken.
        signal: Inputs over time, or constants of each member, ``(m, *batch)``; None without inputs.
        start: When the trajectories began.
    """

    steps: KeptSteps
    signal: Signal | Array | None
    start: float

    def __repr__(self) -> str:
        return f"<Dense: steps of {self.nbytes / 1e6:.3g} MB>"

    @property
    def nbytes(self) -> int:
        """The memory that the steps take."""
        return self.steps.nbytes

    def take(self, place: tuple[int, ...], batch: tuple[int, ...]) -> Dense:
        """The steps of one member of a batch."""
        inside = tuple(p % n for p, n in zip(place, batch, strict=True))
        member = int(np.ravel_multi_index(inside, batch))
        steps: Any = self.steps.take(np.flatnonzero(self.steps.member == member))
        steps = replace(steps, member=np.zeros(len(steps.member), np.intp))
        signal = self.signal
        if isinstance(signal, np.ndarray):
            at: Any = (slice(None), *place)
            signal = Signal(signal[at])
        return Dense(steps, signal, self.start)


def make_dense(
    lots: Sequence[KeptSteps],
    whole: Callable[[Sequence[KeptSteps]], KeptSteps],
    signal: Signal | Array | None,
    start: float,
) -> Dense:
    """The steps of several calls as one."""
    steps = whole(lots)
    order = np.lexsort((steps.start, steps.member))
    return Dense(steps.take(order), signal, start)


def evaluate_at(solution: Solution, t: Any) -> Solution:
    """The same motion at other times.

    Args:
        solution: One that has its steps.
        t: A time, or several.

    Raises:
        KernelArgumentError: It has no steps, or a time is no number within its span.
    """
    from coadjoint.solve.solution import Solution

    dense = solution.dense
    if dense is None:
        raise KernelArgumentError(
            "this solution has no dense output; expected one that was simulated with dense=True.",
            found=None,
        )
    times = np.atleast_1d(as_float64(t, "t"))
    last = float(np.max(solution.time_reached))
    if times.ndim != 1 or not times.size:
        raise KernelArgumentError(
            f"t has the shape {times.shape}; expected a time, or several in one axis.",
            found=list(times.shape),
        )
    outside = ~((times >= dense.start) & (times <= last))
    if outside.any():
        wrong = float(times[outside][0])
        raise KernelArgumentError(
            f"t is {wrong:.12g}; expected times from {dense.start:.12g} to {last:.12g}, between "
            "which the solution has steps.",
            found=wrong,
            expected=[dense.start, last],
        )
    states = _find_states(solution, dense, times)
    n, inputs = solution.system.STATE.size, _find_inputs(dense.signal, times)
    return Solution(
        system=solution.system,
        time=times,
        state=states[:n],
        parameters=solution.parameters,
        status="" if solution.batch else solution.status,
        message=solution.message,
        reconstructed=states[n:] if len(states) > n else None,
        inputs=inputs,
        course=replace(solution.course, start=_find_start(solution, dense)),
    )


def _find_inputs(signal: Signal | Array | None, times: Array) -> Array | None:
    """Inputs as a Solution of these times has them."""
    if isinstance(signal, np.ndarray):
        return signal[..., np.newaxis]
    return None if signal is None else signal.over(times)


def _find_start(solution: Solution, dense: Dense) -> Start:
    """Where the trajectories began."""
    if solution.course.start is not None:
        return solution.course.start
    inputs = _find_inputs(dense.signal, np.array([dense.start]))
    varies = isinstance(dense.signal, Signal) and type(dense.signal) is not Signal
    below = None if solution.reconstructed is None else solution.reconstructed[..., 0].copy()
    return Start(
        time=dense.start,
        state=solution.state[..., 0].copy(),
        inputs=inputs,
        varies=varies,
        reconstructed=below,
    )


def _find_states(solution: Solution, dense: Dense, times: Array) -> Array:
    """States ``(n, *batch, T)``, and what is reconstructed below; NaN where one did not come."""
    around = Surroundings(
        system=solution.system,
        parameters=solution.parameters.reshape(len(solution.parameters), -1)
        if solution.parameters.ndim > 1
        else solution.parameters,
        driven=None if dense.signal is None else Driven(dense.signal),
    )
    steps = move_onto_constraints(dense.steps, around)
    members = int(np.prod(solution.batch, dtype=np.intp))
    reached = np.broadcast_to(solution.time_reached, solution.batch).ravel()
    bounds = np.searchsorted(steps.member, np.arange(members + 1))
    size = len(solution.state) + (
        0 if solution.reconstructed is None else len(solution.reconstructed)
    )
    states = np.full((size, members, times.size), np.nan)
    for member, (first, last) in enumerate(pairwise(bounds)):
        come = np.flatnonzero(times <= reached[member])
        if first == last or not come.size:
            continue
        # a time between two steps belongs to the first
        places = np.searchsorted(steps.start[first:last], times[come], side="left") - 1
        rows = first + np.maximum(places, 0)
        states[:, member, come] = steps.follow(rows)(times[come] - steps.start[rows])
    return states.reshape(size, *solution.batch, times.size)


# -- the steps of SciPy ---------------------------------------------------------------------------


class Trail:
    """The steps of one trajectory by SciPy, for events and dense output.

    Args:
        lookout: Who looks for events; None if there are none.
        surroundings: The parameters and inputs.
        keeps: Whether steps are kept.
    """

    def __init__(self, lookout: Lookout | None, surroundings: Surroundings, *, keeps: bool) -> None:
        self.lookout, self._around, self._keeps = lookout, surroundings, keeps
        self._paths: list[Any] = []
        self._times: list[float] = []

    @property
    def is_needed(self) -> bool:
        """Whether steps are looked at."""
        return self._keeps or self.lookout is not None

    def add(self, path: Any, before: float, after: float) -> Ending | None:
        """Look at a step: the terminal event that ends the trajectory, if there is one."""
        start, size = np.array([before]), np.array([after - before])
        if self._keeps:
            self._paths.append(path)
            self._times.append(before)
        if self.lookout is None:
            return None
        steps = Interpolants(paths=[path], start=start, size=size, member=np.zeros(1, np.intp))
        endings = self.lookout.look(move_onto_constraints(steps, self._around))
        return endings[0] if endings else None

    def finish(self) -> Ending | None:
        """The terminal event that the end of the trajectory decides, if there is one."""
        endings = [] if self.lookout is None else self.lookout.finish([0])
        return endings[0] if endings else None

    def list_events(self) -> Events:
        """All events by name."""
        return Events() if self.lookout is None else list_occurrences(self.lookout, ())

    def make_dense(self, end: float, signal: Signal | None, start: float) -> Dense | None:
        """The steps up to an end; None if they were not to be kept."""
        if not self._keeps:
            return None
        begun = np.array(self._times)
        steps = Interpolants(
            paths=self._paths,
            start=begun,
            size=np.diff(np.append(begun, end)),
            member=np.zeros(len(begun), np.intp),
        )
        return Dense(steps.take(np.flatnonzero(begun < end)), signal, start)


def join_interpolants(lots: Sequence[KeptSteps]) -> Interpolants:
    """The steps of trajectories, each by SciPy, as those of the members of a batch."""
    own = [each for each in lots if isinstance(each, Interpolants)]
    assert len(own) == len(lots), "each is a run of SciPy"
    return Interpolants(
        paths=[path for each in own for path in each.paths],
        start=np.concatenate([each.start for each in own]),
        size=np.concatenate([each.size for each in own]),
        member=np.repeat(np.arange(len(own)), [len(each.start) for each in own]),
    )
