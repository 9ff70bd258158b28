"""Recording: the steps of generated solvers, looked at for events and kept for dense output.

Comes in: an `Ensemble` on its way, call by call. Goes out: the same, members stopped where terminal
events end them; all events, and the steps for dense output. What is found depends on the steps of
each member alone, so that the number of threads and the length of calls change no bit.
Read next: `coadjoint.solve.lookout`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.solve.dense_output import Dense, move_onto_constraints
from coadjoint.solve.enclosures import Enclosure
from coadjoint.solve.ensemble import Status
from coadjoint.solve.lookout import (
    Ending,
    Lookout,
    explain_ending,
    list_occurrences,
    take_below,
)
from coadjoint.solve.terms import write_terms

if TYPE_CHECKING:
    from coadjoint.array_types import Array, Places
    from coadjoint.solve.driving import Signal
    from coadjoint.solve.ensemble import Ensemble
    from coadjoint.solve.events import Sought
    from coadjoint.solve.occurrences import Events
    from coadjoint.solve.step_records import Record
    from coadjoint.solve.surroundings import Surroundings


@dataclass
class Polynomials:
    """Steps as polynomials in the time since each began.

    Attributes:
        member: Whose each is, ``(S,)``.
        start: When it begins.
        size: How long it is.
        lots: Coefficients, ``(any, n, degree + 1)`` each, that of order 0 first: as solvers wrote
            them, since moving them takes longer than computing them.
        place: Where in the lots, one behind the other, each step stands, ``(S,)``.
    """

    member: Places
    start: Array
    size: Array
    lots: tuple[Array, ...]
    place: Places

    @property
    def degree(self) -> int:
        """Of the polynomials."""
        return int(self.lots[0].shape[2] - 1)

    @property
    def path(self) -> Array:
        """The coefficients of all steps, ``(S, n, degree + 1)``."""
        return self._gather(self.place)

    @property
    def nbytes(self) -> int:
        """The memory that they take."""
        arrays = (self.member, self.start, self.size, *self.lots, self.place)
        return sum(each.nbytes for each in arrays)

    def take(self, which: Places) -> Polynomials:
        """Some of them, in a given order."""
        return Polynomials(
            member=self.member[which],
            start=self.start[which],
            size=self.size[which],
            lots=(self._gather(self.place[which]),),
            place=np.arange(len(which)),
        )

    def follow(self, rows: Places, only: Places | None = None) -> Callable[[Array], Array]:
        """As `Steps.follow`, by Horner."""
        path = self._gather(self.place[rows], slice(None) if only is None else only)
        return partial(_evaluate, np.ascontiguousarray(path.transpose(2, 1, 0)))

    def enclose(self, row: int) -> Enclosure:
        """As `Steps.enclose`."""
        path = np.ascontiguousarray(self._gather(self.place, row).T)
        return Enclosure.of_polynomial(path, self.size)

    def _gather(self, places: Places, only: Any = slice(None)) -> Array:
        """The coefficients at some places; of some components or one."""
        if len(self.lots) == 1:
            chosen = places[:, np.newaxis] if isinstance(only, np.ndarray) else places
            taken: Array = self.lots[0][chosen, only]
            return taken
        ends = np.cumsum([len(lot) for lot in self.lots])
        found: Array = np.empty((len(places), *self.lots[0][:0, only].shape[1:]))
        whose = np.searchsorted(ends, places, side="right")
        for n in np.unique(whose).tolist():
            own = whose == n
            found[own] = self.lots[n][:, only][places[own] - (ends[n] - len(self.lots[n]))]
        return found


def _evaluate(table: Array, after: Array) -> Array:
    """Polynomials ``(degree + 1, m, R)`` at ``(..., R)``, by Horner; ``(m, ..., R)``."""
    shape = (table.shape[1], *(1,) * (after.ndim - 1), table.shape[2])
    total = np.repeat(table[-1], len(after) if after.ndim > 1 else 1, axis=0)
    total = total.reshape(table.shape[1], *after.shape)
    for coefficient in table[-2::-1]:
        total *= after
        total += coefficient.reshape(shape)
    return total


class Recording:
    """The recording of a run.

    Several threads may call it at a time, each for members of its own.

    Args:
        run: The ensemble.
        sought: The events.
        surroundings: What the names of their formulas mean.
        keeps: Whether steps are kept.

    Attributes:
        terms: What has to be recorded, as `Record` has it; None for every step.
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
        self.terms = None if keeps else write_terms(sought, surroundings)
        self._endings: list[Ending] = []
        self._kept: list[Polynomials] = []

    def look(self, record: Record) -> None:
        """Look at the steps of a call, and stop members at terminal events."""
        member = record.member
        order = (
            np.argsort(member, kind="stable") if self._lookout.sought else np.arange(len(member))
        )
        steps = Polynomials(
            member=member[order],
            start=record.begun[order],
            size=record.length[order],
            lots=(record.path,),
            place=order,
        )
        around = self._lookout.surroundings
        for ending in self._lookout.look(move_onto_constraints(steps, around)):
            row = int(order[ending.decided])
            after = ending.time - float(record.begun[row])
            self._run.stop(record, row, after, ending.state)
            self._stop(ending)
        if self._keeps and len(steps.member):
            self._kept.append(replace(steps, lots=(record.hand_over(),)))

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

    # -- checkpoints ------------------------------------------------------------------------------

    def save(self) -> dict[str, Any]:
        """All that is known of the run beyond its ensemble, as arrays."""
        arrays = {f"events.{name}": array for name, array in self._lookout.save().items()}
        names = [each.event.name for each in self._lookout.sought]
        arrays |= {
            "endings.member": np.array([each.member for each in self._endings], np.intp),
            "endings.time": np.array([each.time for each in self._endings]),
            "endings.state": np.array([each.state for each in self._endings]),
            "endings.event": np.array([names.index(each.name) for each in self._endings], np.intp),
        }
        if self._keeps:
            self._kept = [_join(self._kept, self._run)]
            if len(self._kept[0].member):
                arrays |= {f"steps.{name}": getattr(self._kept[0], name) for name in _STORED}
        return arrays

    def restore(self, arrays: Mapping[str, Any]) -> None:
        """Know what was saved."""
        self._lookout.restore(take_below(arrays, "events"))
        ended = take_below(arrays, "endings")
        self._endings = [
            Ending(
                member=int(member),
                time=float(time),
                state=state.copy(),
                name=self._lookout.sought[event].event.name,
                decided=-1,
            )
            for member, time, state, event in zip(
                *(ended[name] for name in ("member", "time", "state", "event")), strict=True
            )
        ]
        steps = take_below(arrays, "steps")
        if steps:
            named = {name: steps[name] for name in _STORED if name != "path"}
            place = np.arange(len(steps["member"]))
            self._kept = [Polynomials(**named, lots=(steps["path"],), place=place)]

    # -- after the run ----------------------------------------------------------------------------

    def list_events(self, batch: tuple[int, ...]) -> Events:
        """All events by name."""
        return list_occurrences(self._lookout, batch)

    def explain_end(self, clock: str) -> str:
        """Which event ended the only trajectory, by the symbol of the independent variable."""
        return explain_ending(self._endings[-1], clock)

    def make_dense(self, signal: Signal | Array | None, start: float) -> Dense | None:
        """The steps up to where each member came; None if they were not to be kept."""
        if not self._keeps:
            return None
        return Dense(_join(self._kept, self._run), signal, start)


#: What a checkpoint has of steps, which stand in order there.
_STORED = ("member", "start", "size", "path")


def _join(kept: Sequence[Polynomials], run: Ensemble) -> Polynomials:
    """The steps of several calls by member and time, up to where each member came."""
    none = np.empty(0)
    member = np.concatenate([none.astype(np.intp), *(each.member for each in kept)])
    begun = np.concatenate([none, *(each.start for each in kept)])
    size = np.concatenate([none, *(each.size for each in kept)])
    lots = [lot for each in kept for lot in each.lots]
    firsts = np.cumsum([0, *(sum(map(len, each.lots)) for each in kept)])
    place = np.concatenate(
        [none.astype(np.intp), *(n + each.place for n, each in zip(firsts, kept, strict=False))]
    )
    order = np.argsort(member, kind="stable")  # those of one member come as they were made
    order = order[begun[order] < run.time[member[order]]]
    return Polynomials(
        member=member[order],
        start=begun[order],
        size=size[order],
        lots=tuple(lots) or (np.empty((0, len(run.state), 1)),),
        place=place[order],
    )
