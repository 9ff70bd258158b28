"""Ensembles: many trajectories on their way, as arrays that a solver advances.

Comes in: initial states, parameters, inputs and sample times. Goes out: the same arrays further on.
All that is known of a member stands in them, so that a run can stop after any call and go on later
with the same bits, whatever the number of members in a call.

A call of a solver can also record each step that it accepts: see `coadjoint.solve.step_records`.
Events and dense output are found from these records, in the same way for all solvers, and a member
can be stopped at a time within a recorded step, `Ensemble.stop`.
Read next: `coadjoint.solve.steps`, the methods in NumPy, and ``templates/c/solver.c.j2``, in C.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from coadjoint.solve.limits import ALIKE, NONE, Limits, Step
from coadjoint.solve.step_records import HEAD, Record
from coadjoint.solve.steps import ROUNDING, Lanes, add_low, reaches_end

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.steps import Attempt, Method

    Array = NDArray[np.float64]
    Counts = NDArray[np.uint64]
    Mask = NDArray[np.bool_]


class Status(IntEnum):
    """How a trajectory stands."""

    GOES_ON = 0
    OK = 1
    STEP_UNDERFLOW = 2
    NONFINITE = 3
    MAX_STEPS = 4
    DOMAIN = 5
    EVENT = 6
    SLIDING = 7
    NOT_SOLVED = 8


def tell_endings(codes: NDArray[np.int8]) -> str:
    """How many trajectories stopped before the end, and why; "" if none did."""
    counts = {status.name: int((codes == status).sum()) for status in Status}
    ended = [f"{count} {name}" for name, count in counts.items() if count and name != "OK"]
    short = codes.size - counts["OK"]
    told = f"{short} of {codes.size} trajectories did not reach the end: {', '.join(ended)}"
    return told if ended else ""


#: Numbers that tell of a kink that was met.
MET = 4


@dataclass
class Inputs:
    """Inputs as straight lines between knots.

    Attributes:
        knots: Where each line begins, ``(pieces,)``, increasing; the first at the start or before.
        values: Where each begins, ``(m, pieces)``; or constants of each member, ``(m, N)``.
        slopes: Their rates, in the shape of values.
        own: Whether each member has its own constants.
    """

    knots: Array
    values: Array
    slopes: Array
    own: bool = False

    @property
    def pieces(self) -> int:
        """How many lines there are."""
        return len(self.knots)


@dataclass
class Ensemble:
    """Trajectories on their way.

    Attributes:
        state: Where they are, ``(n, N)``.
        parameters: ``(k, N)``, or ``(k,)`` if all share them.
        inputs: What drives them; without rows where nothing does.
        has_time: Whether the system depends on time.
        samples: Increasing times at which states are wanted; the last of them is the end.
        out: These states, ``(n, N, T)``, or None.
        rtol: Relative tolerance.
        atol: Absolute tolerance.
        size: A fixed step; 0 to have steps follow the tolerances.
        max_steps: A trajectory ends after so many.
        seed: Of the noise, where there is some.
        bound: The largest size of its normal numbers.
        sides: How many kinks the rates have.
        remembered: How many numbers a step leaves for the next one besides the state.
        is_implicit: Whether steps are solved for by sweeps, which are counted.
        has_clock: Whether what rounding takes of the time is kept.
        time: Where they are in time, ``(N,)``.
        step: The steps to try next, ``(N,)``; 0 to have them chosen.
        next: The sample that comes next, ``(N,)``.
        steps: Steps that were taken, ``(N,)``.
        rejected: Steps that were not, ``(N,)``.
        status: One of `Status`, ``(N,)``.
        kinks: Kinks that they have met, ``(N,)``; None where rates have none.
        brief: How many of the last of these followed one another within 2^-30 of a step, or of the
            time; likewise.
        late: What rounding took of the time, ``(N,)``, so that n steps of length h end at the
            number that is nearest to n h; None where nothing is kept of it.
        memory: What steps leave for the next one: first what rounding took of the state,
            ``(remembered, N)``; None where the method leaves nothing.
        sweeps: Sweeps of all steps, ``(N,)``; None where there are none.
        met: The kinks that were met: rows of the member, how many steps that made with it, which
            kink, and the time; in no order.
    """

    state: Array
    parameters: Array
    inputs: Inputs
    has_time: bool
    samples: Array
    out: Array | None
    rtol: float
    atol: float
    size: float
    max_steps: int
    seed: int = 0
    bound: float = np.inf
    sides: int = 0
    remembered: int = 0
    is_implicit: bool = False
    has_clock: bool = True
    late: Array | None = field(init=False, default=None)
    memory: Array | None = field(init=False, default=None)
    sweeps: Counts | None = field(init=False, default=None)
    time: Array = field(init=False)
    step: Array = field(init=False)
    next: Counts = field(init=False)
    steps: Counts = field(init=False)
    rejected: Counts = field(init=False)
    status: NDArray[np.int8] = field(init=False)
    kinks: Counts | None = field(init=False, default=None)
    brief: Counts | None = field(init=False, default=None)
    met: list[Array] = field(init=False, default_factory=list)

    def begin(self, start: float) -> None:
        """Set all members to the start; a sample there is their state."""
        members = self.state.shape[1]
        first = int(self.samples[0] == start and len(self.samples) > 1)
        if first and self.out is not None:
            self.out[:, :, 0] = self.state
        self.time, self.step = np.full(members, start), np.zeros(members)
        self.next = np.full(members, first, np.uint64)
        self.steps, self.rejected = np.zeros(members, np.uint64), np.zeros(members, np.uint64)
        self.status = np.zeros(members, np.int8)
        if self.has_clock:
            self.late = np.zeros(members)
        if self.remembered:
            self.memory = np.zeros((self.remembered, members))
        if self.is_implicit:
            self.sweeps = np.zeros(members, np.uint64)
        if self.sides:
            self.kinks, self.brief = np.zeros(members, np.uint64), np.zeros(members, np.uint64)

    @property
    def end(self) -> float:
        """When they end."""
        return float(self.samples[-1])

    def list_met(self) -> Array:
        """The kinks that were met, as rows of `met` by member and time, ``(count, 4)``."""
        rows = np.concatenate([np.empty((0, MET)), *self.met])
        return rows[np.lexsort((rows[:, 2], rows[:, 1], rows[:, 0]))]

    def advance(
        self,
        method: Method,
        work: int,
        members: slice = slice(None),
        limits: Limits = NONE,
        record: Record | None = None,
    ) -> int:
        """Go on with some members in NumPy, as ``NAME_advance`` of a solver does in C.

        Args:
            method: The method.
            work: So many steps are tried of each member, at most.
            members: Which ones.
            limits: What bounds their motion.
            record: Where accepted steps are recorded; the call ends when it is full.

        Returns:
            How many of them go on.
        """
        chosen = np.arange(self.state.shape[1])[members]
        with np.errstate(all="ignore"):
            going = chosen[self.status[chosen] == Status.GOES_ON]
            for _ in range(work):
                room = going.size if record is None else len(record.rows) - record.count
                if not (going.size and room):
                    break
                self._step(method, going[:room], limits, record)
                going = going[self.status[going] == Status.GOES_ON]
        return int(going.size)

    def _step(
        self, method: Method, going: NDArray[np.intp], limits: Limits, record: Record | None
    ) -> None:
        """Try one step of some members."""
        lanes = self._lanes(going)
        limits.find_sides(lanes)
        attempt = method.try_step(lanes)
        took, state = attempt.took, limits.project(lanes, attempt.took, attempt.state)
        time, late = self._find_time(going, lanes, took)
        finite = np.isfinite(state).all(axis=0)
        stuck = (time == lanes.time) | (took < 1e-300)
        accepted = attempt.accepted & finite & ~stuck
        step = Step(
            lanes=lanes,
            attempt=attempt,
            limits=limits,
            accepted=accepted,
            allowed=self._find_allowed(state, took),
        )
        outside = step.find_dips()
        if method.halves:
            far, shorter = step.find_retries(outside)
            lanes.step = np.where(far, shorter, lanes.step)
            accepted &= ~far
            outside = np.where(far, took, outside)
        inside, outside, left = self._store_samples(going, step, time, outside)
        left |= accepted & ~step.are_held(took, state)
        beyond = accepted & ~left & limits.find_beyond(lanes, took, state)
        met = beyond.any(axis=0)
        self._store_kinks(going, beyond, time)
        if left.any():
            inside, beyond_it = step.find_exit(inside, outside)
            outside = np.where(left, beyond_it, outside)
            state = np.where(left, step.find_state(inside), state)
            time = np.where(left, lanes.time + inside, time)
            crossing = step.cross(left, outside, (state, time))
            met, state, time = met | crossing.met, crossing.state, crossing.time
            late = np.where(left, 0.0, late)
            left &= ~crossing.met
            self._store_kinks(going, crossing.kinks, time)
        if record is not None and accepted.any():
            self._record(record, going, attempt, time - lanes.time, accepted)
        self.state[:, going] = np.where(accepted, state, lanes.state)
        self._take_left(going, attempt, accepted, limits)
        self.time[going] = np.where(accepted, time, lanes.time)
        if self.late is not None:
            self.late[going] = np.where(accepted, late, self.late[going])
        self.step[going] = lanes.step
        self.steps[going] += accepted
        self.rejected[going] += ~accepted
        status = np.zeros(going.shape, np.int8)
        over = self.steps[going] >= self.max_steps
        status[accepted & over] = Status.MAX_STEPS
        status[accepted & (self.time[going] >= self.end)] = Status.OK
        short = outside < step.find_brief()
        status[accepted & self._count_kinks(going, met, accepted, short)] = Status.SLIDING
        status[left] = Status.DOMAIN
        status[~accepted & stuck & finite] = Status.STEP_UNDERFLOW
        lost = stuck | np.full(stuck.shape, not method.tries_again)
        status[~accepted & ~finite & lost] = Status.NONFINITE
        if attempt.left is not None:
            status[~accepted & ~attempt.left.solved] = Status.NOT_SOLVED
        self.status[going] = status

    def _find_allowed(self, end: Array, took: Array) -> Array:
        """How much rates may differ on the two sides of a kink that does not end a step.

        That is a part of what its error may be; with a fixed step of what rounding makes of it.
        """
        rtol, atol = (0.0, 0.0) if self.size > 0 else (self.rtol, self.atol)
        sizes = np.abs(end)
        rounding = ROUNDING * np.fmax.reduce(sizes, axis=0, initial=0.0)
        least = np.where(atol > rounding, atol, rounding)
        return np.asarray((least + rtol * sizes) * ALIKE / took)

    def _take_left(
        self, going: NDArray[np.intp], attempt: Attempt, accepted: Mask, limits: Limits
    ) -> None:
        """Keep what a step that was accepted leaves, and count the sweeps of all steps.

        What moves a state onto constraints is no rounding, and there the sums begin anew.
        """
        left = attempt.left
        if left is None:
            return
        if self.sweeps is not None:
            made = accepted | ~left.solved
            self.sweeps[going] += np.where(made, left.sweeps, np.uint64(0))
        memory = left.memory
        if memory is None or self.memory is None:
            return
        if limits.projection is not None:
            memory[: len(attempt.state)] = 0.0
        own = self.memory[: len(memory)]
        own[:, going] = np.where(accepted, memory, own[:, going])

    def _find_time(self, going: NDArray[np.intp], lanes: Lanes, took: Array) -> tuple[Array, Array]:
        """The time after a step, and what rounding takes of it."""
        late = np.zeros(took.shape) if self.late is None else self.late[going]
        time, late = add_low(lanes.time, late, took)
        ends = reaches_end(lanes, took)
        return np.where(ends, lanes.end, time), np.where(ends, 0.0, late)

    def _record(
        self,
        record: Record,
        going: NDArray[np.intp],
        attempt: Attempt,
        length: Array,
        accepted: Mask,
    ) -> None:
        """Record the steps that were accepted."""
        whose = going[accepted]
        head = [whose, self.steps[whose] + 1.0, self.rejected[whose], self.time[whose]]
        path = attempt.coefficients()[:, :, accepted]
        record.append(np.array([*head, length[accepted]], np.float64), path)

    def stop(self, record: Record, step: int, after: float, state: Array) -> None:
        """End a member within a recorded step, as if it had made no step after it.

        Args:
            record: Where the step is.
            step: Its row.
            after: How long after it began the member ends.
            state: Where it ends, ``(n,)``.
        """
        member, steps, rejected, begun, _ = record.rows[step, :HEAD].tolist()
        whose, time = int(member), begun + after
        first = int(np.searchsorted(self.samples, time, side="right"))
        if self.out is not None:
            self.out[:, whose, first : int(self.next[whose])] = np.nan
        self.next[whose] = min(first, int(self.next[whose]))
        self.state[:, whose], self.time[whose] = state, time
        self.steps[whose], self.rejected[whose] = int(steps), int(rejected)
        self.status[whose] = Status.EVENT

    def _lanes(self, going: NDArray[np.intp]) -> Lanes:
        """Some members, as methods take them."""
        time = self.time[going]
        inputs = self.inputs
        piece = np.searchsorted(inputs.knots[1:], time, side="right")
        place = going if inputs.own else piece
        ends = np.append(inputs.knots[1:], np.inf)[piece]
        slopes = inputs.slopes[:, place]
        driving = inputs.values[:, place] + slopes * (time - inputs.knots[piece])
        if self.has_time:
            driving = np.vstack([driving, time])
            slopes = np.vstack([slopes, np.ones(time.shape)])
        return Lanes(
            state=self.state[:, going],
            time=time,
            end=np.where(ends < self.end, ends, self.end),
            step=self.step[going],
            parameters=self.parameters if self.parameters.ndim == 1 else self.parameters[:, going],
            driving=driving,
            slopes=slopes,
            member=going.astype(np.uint64),
            steps=self.steps[going],
            memory=None if self.memory is None else self.memory[:, going],
        )

    def _store_kinks(self, going: NDArray[np.intp], crossed: Mask, time: Array) -> None:
        """Add the kinks that were met by the end of a step to the others."""
        kink, lane = np.nonzero(crossed)
        if kink.size:
            whose = going[lane]
            rows = [whose, self.steps[whose] + 1.0, kink, time[lane]]
            self.met.append(np.array(rows, np.float64).T)

    def _count_kinks(self, going: NDArray[np.intp], met: Mask, accepted: Mask, short: Mask) -> Mask:
        """Count the kinks that were met. Where too many followed one another, a member slides."""
        if self.kinks is None or self.brief is None:
            return np.zeros(met.shape, bool)
        self.kinks[going] += met
        brief = met & short
        self.brief[going[brief]] += np.uint64(1)
        self.brief[going[accepted & ~brief]] = 0
        return np.asarray(self.brief[going] > 2 * self.sides + 8)

    def _store_samples(
        self, going: NDArray[np.intp], step: Step, time: Array, outside: Array
    ) -> tuple[Array, Array, Mask]:
        """Store states at the samples that a step passes, as far as it is not outside.

        Args:
            going: The members.
            step: The step.
            time: When it ends. A sample then is its end, to the bit.
            outside: When it is found outside, or its length.

        Returns:
            A time after its start at which a member is in the domain, and a later one: at which it
            is outside, or the end of the step; and where it is outside, if only by its path.
        """
        took, out = step.attempt.took, self.out
        until = np.where(outside < took, step.lanes.time + outside, time)
        whole = outside >= took
        inside, open_ = np.zeros(took.shape), step.accepted.copy()
        while out is not None:
            place = self.next[going].astype(np.intp)
            known = place < len(self.samples)
            at = self.samples[np.where(known, place, 0)]
            wanted = open_ & known & (at <= until)
            if not wanted.any():
                break
            within = wanted & ~(whole & (at == time))
            after = np.where(within, at - step.lanes.time, took)
            state = step.find_state(after)
            good = step.are_held(after, state)
            outside = np.where(wanted & ~good, after, outside)
            open_ &= ~wanted | good
            wanted &= good
            inside = np.where(wanted, after, inside)
            members = going[wanted]
            out[:, members, place[wanted]] = state[:, wanted]
            self.next[members] += np.uint64(1)
        return inside, outside, (outside < took) | (step.accepted & ~open_)
