"""Occurrences: where an event occurred along trajectories, as a Solution holds them.

Comes in: times, members and states that the lookout found. Goes out: a record that people index by
name. Read next: `coadjoint.solve.event_tables`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.events import TIME, Event, explain_unknown
from coadjoint.solve.surroundings import observe

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.array_types import Array, Places
    from coadjoint.solve.system import System


@dataclass(frozen=True)
class Occurrences:
    """Where an event occurred, by member and time.

    ``occurrences["Pi"]`` is ``(3, E)``, ``occurrences["time"]`` and ``occurrences["energy"]`` are
    ``(E,)``. Of a batch, `of` has those of one member.

    Attributes:
        event: What was looked for.
        system: The System.
        batch: The shape of the batch; empty for one trajectory.
        member: Whose each is, ``(E,)``: its place in the batch, rows after rows.
        time: When, ``(E,)``.
        direction: 1 where the left side rises, -1 where it falls, 0 where it touches the right.
        state: The states there, ``(n, E)``.
        parameters: ``(k,)``, or ``(k, E)``.
        inputs: ``(m, E)``; None if there are none.
        undefined: When the formula first had no finite value, of each member in the shape of the
            batch; infinite for never. No occurrence is found there.
    """

    event: Event
    system: System
    batch: tuple[int, ...]
    member: Places
    time: Array
    direction: NDArray[np.int8]
    state: Array
    parameters: Array
    inputs: Array | None
    undefined: Array

    def __len__(self) -> int:
        return len(self.time)

    @property
    def count(self) -> Any:
        """How many there are, of a batch an array."""
        counts = np.bincount(self.member, minlength=math.prod(self.batch)).reshape(self.batch)
        return counts[()] if self.batch else int(counts)

    def of(self, *place: int) -> Occurrences:
        """Those of one member of a batch.

        Args:
            place: Its place in the batch, one number for each axis.

        Raises:
            KernelArgumentError: There is no such member.
        """
        batch = self.batch
        good = len(place) == len(batch) > 0
        if not good or not all(-n <= p < n for p, n in zip(place, batch, strict=True)):
            raise KernelArgumentError(
                f"member {place} is not in a batch of the shape {batch}; expected {len(batch)} "
                "numbers within it.",
                found=list(place),
                expected=list(batch),
            )
        inside = [p % n for p, n in zip(place, batch, strict=True)]
        own = self.member == np.ravel_multi_index(inside, batch)
        return replace(
            self,
            batch=(),
            member=np.zeros(int(own.sum()), np.intp),
            time=self.time[own],
            direction=self.direction[own],
            state=self.state[:, own],
            parameters=self.parameters if self.parameters.ndim == 1 else self.parameters[:, own],
            inputs=None if self.inputs is None else self.inputs[:, own],
            undefined=np.asarray(self.undefined[tuple(place)]),
        )

    @cached_property
    def observables(self) -> Array:
        """Observables at all of them, one row per component."""
        if "observables" not in self.system.functions:
            return self.state[:0]
        return observe(
            self.system, self._own_state, self.parameters, self.inputs, np.asarray(self.time)
        )

    @property
    def _own_state(self) -> Array:
        """The state alone, without what is reconstructed below it."""
        return np.ascontiguousarray(self.state[: self.system.STATE.size])

    def __getitem__(self, name: str) -> Array:
        if name in TIME:
            return self.time
        system, n = self.system, self.system.STATE.size
        tables: Mapping[str, tuple[Any, Callable[[], Array]]] = {
            "state": (system.STATE, lambda: self.state[:n]),
            "reconstructed": (system.RECONSTRUCTED, lambda: self.state[n:]),
            "observables": (system.OBSERVABLES, lambda: self.observables),
        }
        names: list[str] = []
        for kind, (quantities, values) in tables.items():
            if kind == "reconstructed" and len(self.state) == n:
                continue
            if quantities.has(name):
                rows: Array = values()[quantities.rows(name)]
                return rows
            names += quantities.components
        raise explain_unknown(name, names)

    def __repr__(self) -> str:
        name, many = self.event.name, len(self)
        if not many:
            return f"<no event {name!r}>"
        members = f" of {len(np.unique(self.member))} members" if self.batch else ""
        first, last, clock = self.time.min(), self.time.max(), self.system.clock[0]
        told = f"{many} events {name!r}{members}, {clock} = {first:g} .. {last:g}"
        return f"<{told}>" if many > 1 else f"<1 event {name!r}, {clock} = {first:g}>"


def join_occurrences(lots: Sequence[Occurrences], batch: tuple[int, ...]) -> Occurrences:
    """Those of trajectories, one after the other, as those of the members of a batch.

    Args:
        lots: Of one event, without inputs.
        batch: The shape of the batch.
    """
    first, counts = lots[0], [len(each) for each in lots]
    parameters = np.stack([each.parameters for each in lots], axis=1)
    own = parameters != parameters[:, :1]
    return replace(
        first,
        batch=batch,
        member=np.repeat(np.arange(len(lots)), counts),
        time=np.concatenate([each.time for each in lots]),
        direction=np.concatenate([each.direction for each in lots]),
        state=np.concatenate([each.state for each in lots], axis=1),
        parameters=np.repeat(parameters, counts, axis=1) if own.any() else first.parameters,
        undefined=np.array([each.undefined for each in lots]).reshape(batch),
    )


class Events(Mapping[str, Occurrences]):
    """The events of a Solution by name; without any where none were looked for.

    Args:
        by_name: The occurrences of each event.
    """

    def __init__(self, by_name: Mapping[str, Occurrences] | None = None) -> None:
        self._by_name = dict(by_name or {})

    def __getitem__(self, name: str) -> Occurrences:
        if name not in self._by_name:
            told = ", ".join(map(repr, self._by_name)) or "none: simulate with events="
            raise KernelArgumentError(
                f"{name!r} is not among the events of this solution; expected one of {told}.",
                found=name,
                expected=list(self._by_name),
            )
        return self._by_name[name]

    def __contains__(self, name: object) -> bool:
        return name in self._by_name

    def __iter__(self) -> Iterator[str]:
        return iter(self._by_name)

    def __len__(self) -> int:
        return len(self._by_name)

    def of(self, *place: int) -> Events:
        """The events of one member of a batch."""
        return Events({name: each.of(*place) for name, each in self.items()})

    def to_pandas(self) -> Any:
        """A `pandas.DataFrame` of one row per occurrence, by member and time.

        Raises:
            KernelArgumentError: pandas is not installed; the message has the pip command.
        """
        from coadjoint.solve.carried import import_extra
        from coadjoint.solve.event_tables import list_columns

        return import_extra("pandas", "to_pandas").DataFrame(list_columns(self))

    def to_csv(self, path: str | PathLike[str]) -> None:
        """Write the table of `to_pandas`, whole or not at all.

        Raises:
            OutputError: The file cannot be written.
        """
        from coadjoint.solve.event_tables import write_events

        write_events(self, Path(path))

    def plot(
        self, path: str | PathLike[str] | None = None, axes: Sequence[str] | None = None
    ) -> Any:
        """Draw the states at events, one component over another; see `coadjoint.solve.section`.

        Args:
            path: Picture file to write; None to return the figure for showing.
            axes: The names of two components; None for those that vary most.
        """
        from coadjoint.solve.section import draw_section

        return draw_section(self, path, axes)

    def __repr__(self) -> str:
        return "\n".join(map(repr, self.values())) or "<no events were looked for>"
