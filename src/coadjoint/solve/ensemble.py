"""Ensembles: many trajectories on their way, as arrays that a solver advances.

Comes in: initial states, parameters, inputs and sample times. Goes out: the same arrays further on.
All that is known of a member stands in them, so that a run can stop after any call and go on later
with the same bits, whatever the number of members in a call.
Read next: `coadjoint.solve.steps`, the methods in NumPy, and ``templates/c/solver.c.j2``, in C.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from coadjoint.solve.steps import Lanes

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
    EVENT = 6


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
        time: Where they are in time, ``(N,)``.
        step: The steps to try next, ``(N,)``; 0 to have them chosen.
        next: The sample that comes next, ``(N,)``.
        steps: Steps that were taken, ``(N,)``.
        rejected: Steps that were not, ``(N,)``.
        status: One of `Status`, ``(N,)``.
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
    time: Array = field(init=False)
    step: Array = field(init=False)
    next: Counts = field(init=False)
    steps: Counts = field(init=False)
    rejected: Counts = field(init=False)
    status: NDArray[np.int8] = field(init=False)

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

    @property
    def end(self) -> float:
        """When they end."""
        return float(self.samples[-1])

    def advance(self, method: Method, work: int, members: slice = slice(None)) -> int:
        """Go on with some members in NumPy, as ``NAME_advance`` of a solver does in C.

        Args:
            method: The method.
            work: So many steps are tried of each member, at most.
            members: Which ones.

        Returns:
            How many of them go on.
        """
        chosen = np.arange(self.state.shape[1])[members]
        with np.errstate(all="ignore"):
            going = chosen[self.status[chosen] == Status.GOES_ON]
            for _ in range(work):
                if not going.size:
                    break
                self._step(method, going)
                going = going[self.status[going] == Status.GOES_ON]
        return int(going.size)

    def _step(self, method: Method, going: NDArray[np.intp]) -> None:
        """Try one step of some members."""
        lanes = self._lanes(going)
        attempt = method.try_step(lanes)
        time = lanes.time + attempt.took
        time = np.where(attempt.took == lanes.end - lanes.time, lanes.end, time)
        finite = np.isfinite(attempt.state).all(axis=0)
        stuck = (time == lanes.time) | (attempt.took < 1e-300)
        accepted = attempt.accepted & finite & ~stuck
        if self.out is not None:
            self._store_samples(going, lanes, attempt, time, accepted)
        self.state[:, going] = np.where(accepted, attempt.state, lanes.state)
        self.time[going] = np.where(accepted, time, lanes.time)
        self.step[going] = lanes.step
        self.steps[going] += accepted
        self.rejected[going] += ~accepted
        status = np.zeros(going.shape, np.int8)
        over = self.steps[going] >= self.max_steps
        status[accepted & over] = Status.MAX_STEPS
        status[accepted & (self.time[going] >= self.end)] = Status.OK
        status[~accepted & stuck & finite] = Status.STEP_UNDERFLOW
        lost = stuck | np.full(stuck.shape, not method.tries_again)
        status[~accepted & ~finite & lost] = Status.NONFINITE
        self.status[going] = status

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
        )

    def _store_samples(
        self,
        going: NDArray[np.intp],
        lanes: Lanes,
        attempt: Attempt,
        time: Array,
        accepted: Mask,
    ) -> None:
        """States at the samples that a step passes."""
        assert self.out is not None
        while True:
            place = self.next[going].astype(np.intp)
            inside = place < len(self.samples)
            at = self.samples[np.where(inside, place, 0)]
            wanted = accepted & inside & (at <= time)
            if not wanted.any():
                return
            after = np.where(wanted, at - lanes.time, attempt.took)
            state = attempt.path(after)
            members = going[wanted]
            self.out[:, members, place[wanted]] = state[:, wanted]
            self.next[members] += np.uint64(1)
