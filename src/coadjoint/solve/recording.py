"""Recording: the steps of generated solvers, looked at for events and kept for dense output.

Comes in: an `Ensemble` on its way, call by call. Goes out: the same, members stopped where terminal
events end them; all events, and the steps for dense output. What is found depends on the steps of
each member alone, so that the number of threads and the length of calls change no bit.
Read next: `coadjoint.solve.lookout`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from coadjoint.solve.dense import Dense, move_onto_constraints
from coadjoint.solve.ensemble import Record, Status
from coadjoint.solve.lookout import Ending, Lookout, explain_ending, list_occurrences

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.driving import Signal
    from coadjoint.solve.ensemble import Ensemble
    from coadjoint.solve.events import Sought, Surroundings
    from coadjoint.solve.occurrences import Events

    Array = NDArray[np.float64]
    Places = NDArray[np.intp]

#: The memory of a record, in numbers.
ROOM: Final = 2_000_000


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
        return self.path.shape[2] - 1

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

    Args:
        run: The ensemble.
        sought: The events.
        surroundings: What the names of their formulas mean.
        degree: Of the polynomials of the solver.
        keeps: Whether steps are kept.
    """

    def __init__(
        self,
        run: Ensemble,
        sought: Sequence[Sought],
        surroundings: Surroundings,
        degree: int,
        *,
        keeps: bool,
    ) -> None:
        self._run, self._sought, self._around = run, sought, surroundings
        self._degree, self._keeps = degree, keeps
        self._slices: list[Slice] = []

    def begin(self, first: int, last: int) -> Slice:
        """The recording of some members, which one thread advances."""
        lookout = Lookout(
            sought=self._sought,
            surroundings=self._around,
            rtol=self._run.rtol,
            atol=self._run.atol,
            first=first,
            last=last,
        )
        part = Slice(self._run, lookout, self._degree, keeps=self._keeps)
        self._slices.append(part)
        return part

    @property
    def _in_order(self) -> list[Slice]:
        return sorted(self._slices, key=lambda part: part.lookout.first)

    def list_events(self, batch: tuple[int, ...]) -> Events:
        """All events by name."""
        return list_occurrences([part.lookout for part in self._in_order], batch)

    def explain_end(self) -> str:
        """Which event ended the only trajectory."""
        endings = [ending for part in self._slices for ending in part.endings]
        return explain_ending(endings[-1])

    def make_dense(self, signal: Signal | Array | None, start: float) -> Dense | None:
        """The steps up to where each member came; None if they were not to be kept."""
        if not self._keeps:
            return None
        lots = [lot for part in self._in_order for lot in part.kept]
        n = len(self._run.state)
        empty = np.empty(0)
        lots = lots or [Polynomials(empty.astype(np.intp), empty, empty, np.empty((0, n, 1)))]
        whole = Polynomials(
            np.concatenate([lot.member for lot in lots]),
            np.concatenate([lot.start for lot in lots]),
            np.concatenate([lot.size for lot in lots]),
            np.concatenate([lot.path for lot in lots]),
        )
        for part in self._slices:
            part.kept.clear()
        order = np.lexsort((whole.start, whole.member))
        inside = whole.start[order] < self._run.time[whole.member[order]]
        return Dense(whole.take(order[inside]), signal, start)


class Slice:
    """The recording of some members.

    Args:
        run: The ensemble.
        lookout: Who looks for events.
        degree: Of the polynomials of the solver.
        keeps: Whether steps are kept.

    Attributes:
        record: What the solver writes into.
        endings: Where terminal events ended members.
        kept: The steps, in lots.
    """

    def __init__(self, run: Ensemble, lookout: Lookout, degree: int, *, keeps: bool) -> None:
        n = len(run.state)
        self._run, self.lookout, self._keeps = run, lookout, keeps
        self.record = Record.make(n, degree, ROOM // (5 + n * (degree + 1)))
        self.endings: list[Ending] = []
        self.kept: list[Polynomials] = []

    def look(self) -> None:
        """Look at the steps of a call, and forget them."""
        record = self.record
        order = np.argsort(record.member, kind="stable")
        steps = Polynomials(
            record.member[order], record.begun[order], record.length[order], record.path[order]
        )
        around = self.lookout.surroundings
        for ending in self.lookout.look(move_onto_constraints(steps, around)):
            self._stop(ending, int(order[ending.decided]))
        if self._keeps:
            self.kept.append(steps)
        record.clear()

    def finish(self) -> None:
        """Look at where members ended."""
        members = np.arange(self.lookout.first, self.lookout.last)
        ended = members[self._run.status[members] != Status.GOES_ON]
        for ending in self.lookout.finish(ended.tolist()):
            self._stop(ending, None)

    def _stop(self, ending: Ending, row: int | None) -> None:
        """End a member; its steps are those up to the one of a row, or all if there is none."""
        run, member = self._run, ending.member
        if row is not None:
            begun = float(self.record.begun[row])
            run.stop(self.record, row, ending.time - begun, ending.state)
        first = int(np.searchsorted(run.samples, ending.time, side="right"))
        if run.out is not None:
            run.out[:, member, first:] = np.nan
        run.next[member] = min(first, int(run.next[member]))
        run.state[:, member], run.time[member] = ending.state, ending.time
        run.status[member] = Status.EVENT
        self.endings.append(ending)
