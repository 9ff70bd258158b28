"""Recording: the steps of generated solvers, looked at for events and kept for dense output.

Comes in: an `Ensemble` on its way, call by call. Goes out: the same, members stopped where terminal
events end them; all events, and the steps for dense output. What is found depends on the steps of
each member alone, so that the number of threads and the length of calls change no bit.
Read next: `coadjoint.solve.lookout`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from coadjoint.solve.dense import Dense, move_onto_constraints
from coadjoint.solve.ensemble import Status
from coadjoint.solve.lookout import Ending, Lookout, explain_ending, list_occurrences

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.driving import Signal
    from coadjoint.solve.ensemble import Ensemble, Record
    from coadjoint.solve.events import Sought, Surroundings
    from coadjoint.solve.occurrences import Events

    Array = NDArray[np.float64]
    Places = NDArray[np.intp]


@dataclass
class Polynomials:
    """Steps as polynomials in the time since each began.

    Attributes:
        member: Whose each is, ``(S,)``.
        start: When it begins.
        size: How long it is.
        path: Coefficients, ``(S, n, degree + 1)``, that of order 0 first.
    """

    member: Places
    start: Array
    size: Array
    path: Array

    @property
    def degree(self) -> int:
        """Of the polynomials."""
        return int(self.path.shape[2] - 1)

    @property
    def nbytes(self) -> int:
        """The memory that they take."""
        return self.member.nbytes + self.start.nbytes + self.size.nbytes + self.path.nbytes

    def take(self, which: Places) -> Polynomials:
        """Some of them, in a given order."""
        return Polynomials(
            self.member[which], self.start[which], self.size[which], self.path[which]
        )

    def evaluate(self, rows: Places, after: Array) -> Array:
        """As `Steps.evaluate`, by Horner."""
        path = self.path[rows].transpose(1, 2, 0)[..., np.newaxis]
        total = np.broadcast_to(path[:, self.degree], (len(path), *after.shape))
        for k in range(self.degree - 1, -1, -1):
            total = total * after + path[:, k]
        return np.ascontiguousarray(total)


class Recording:
    """The recording of a run.

    Several threads may call it at a time, each for members of its own.

    Args:
        run: The ensemble.
        sought: The events.
        surroundings: What the names of their formulas mean.
        keeps: Whether steps are kept.
    """

    def __init__(
        self, run: Ensemble, sought: Sequence[Sought], surroundings: Surroundings, *, keeps: bool
    ) -> None:
        self._run, self._keeps = run, keeps
        self._lookout = Lookout(
            sought=sought,
            surroundings=surroundings,
            rtol=run.rtol,
            atol=run.atol,
            members=run.state.shape[1],
        )
        self._endings: list[Ending] = []
        self._kept: list[Polynomials] = []

    def look(self, record: Record) -> None:
        """Look at the steps of a call, and stop members at terminal events."""
        order = np.argsort(record.member, kind="stable")
        steps = Polynomials(
            record.member[order], record.begun[order], record.length[order], record.path[order]
        )
        around = self._lookout.surroundings
        for ending in self._lookout.look(move_onto_constraints(steps, around)):
            row = int(order[ending.decided])
            after = ending.time - float(record.begun[row])
            self._run.stop(record, row, after, ending.state)
            self._stop(ending)
        if self._keeps:
            self._kept.append(steps)

    def finish(self) -> None:
        """Look at where members ended."""
        for ending in self._lookout.finish(range(self._run.state.shape[1])):
            self._stop(ending)

    def _stop(self, ending: Ending) -> None:
        """End a member where an event does; it made all the steps that are counted."""
        run, member = self._run, ending.member
        first = int(np.searchsorted(run.samples, ending.time, side="right"))
        if run.out is not None:
            run.out[:, member, first:] = np.nan
        run.next[member] = min(first, int(run.next[member]))
        run.state[:, member], run.time[member] = ending.state, ending.time
        run.status[member] = Status.EVENT
        self._endings.append(ending)

    # -- after the run ----------------------------------------------------------------------------

    def list_events(self, batch: tuple[int, ...]) -> Events:
        """All events by name."""
        return list_occurrences(self._lookout, batch)

    def explain_end(self) -> str:
        """Which event ended the only trajectory."""
        return explain_ending(self._endings[-1])

    def make_dense(self, signal: Signal | Array | None, start: float) -> Dense | None:
        """The steps up to where each member came; None if they were not to be kept."""
        if not self._keeps:
            return None
        none, n = np.empty(0), len(self._run.state)
        lots = self._kept or [Polynomials(none.astype(np.intp), none, none, np.empty((0, n, 1)))]
        whole = Polynomials(
            np.concatenate([lot.member for lot in lots]),
            np.concatenate([lot.start for lot in lots]),
            np.concatenate([lot.size for lot in lots]),
            np.concatenate([lot.path for lot in lots]),
        )
        self._kept = []
        order = np.lexsort((whole.start, whole.member))
        inside = whole.start[order] < self._run.time[whole.member[order]]
        return Dense(whole.take(order[inside]), signal, start)
