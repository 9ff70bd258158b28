"""The lookout: events of an integration while it goes on, and where they end trajectories.

Comes in: the steps of some members, call by call. Goes out: `Ending` records for trajectories that
end at a terminal event, and at last all `Occurrences` up to there.
Read next: `coadjoint.solve.crossings`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from coadjoint.solve.crossings import EPS, Crossings, Watch, join
from coadjoint.solve.occurrences import Events, Occurrences
from coadjoint.solve.surroundings import enclose, make_function

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.solve.events import Sought
    from coadjoint.solve.surroundings import Surroundings
    from coadjoint.solve.taken import Steps


class Ending(NamedTuple):
    """Where a terminal event ends a trajectory.

    Attributes:
        member: Whose.
        time: When.
        state: Where, ``(n,)``.
        name: Of the event.
        decided: The row of the step that decided it; -1 for the end of the trajectory.
    """

    member: int
    time: float
    state: Array
    name: str
    decided: int


def explain_ending(ending: Ending, clock: str) -> str:
    """What a Solution says of it, by the symbol of its independent variable."""
    return f"the event {ending.name!r} ended it at {clock} = {ending.time:.12g}"


def take_below(arrays: Mapping[str, Any], name: str) -> dict[str, Any]:
    """The arrays whose names begin with ``name.``, by what follows.

    >>> take_below({"a.b": 1, "a.c.d": 2, "ab.c": 3}, "a")
    {'b': 1, 'c.d': 2}
    """
    begin = f"{name}."
    return {each[len(begin) :]: array for each, array in arrays.items() if each.startswith(begin)}


class Lookout:
    """The search for all events of some members.

    Args:
        sought: The events.
        surroundings: What the names of their formulas mean.
        rtol: Relative tolerance of the integration.
        atol: Absolute tolerance.
        members: How many there are.
    """

    def __init__(
        self,
        sought: Sequence[Sought],
        surroundings: Surroundings,
        rtol: float,
        atol: float,
        members: int,
    ) -> None:
        self.sought, self.surroundings = tuple(sought), surroundings
        self._watches = [Watch(each.make_band(rtol, atol), rtol, members) for each in sought]
        self._lots: list[list[Crossings]] = [[] for _ in sought]
        self._counts = [np.zeros(members, np.int64) for _ in sought]
        #: When each trajectory was ended by an event.
        self.ends = np.full(members, np.inf)

    def look(self, steps: Steps) -> list[Ending]:
        """Find the events of the next steps.

        Returns:
            The trajectories that a terminal event ends, each once, by its first.
        """
        if not len(steps.member):
            return []
        endings: list[Ending] = []
        for place, (sought, watch) in enumerate(zip(self.sought, self._watches, strict=True)):
            function = make_function(sought, self.surroundings, steps)
            known = enclose(sought, self.surroundings, steps)
            endings += self._add(place, watch.scan(function, steps, known))
        return self._end(endings)

    def finish(self, members: Iterable[int]) -> list[Ending]:
        """Find the events that the ends of trajectories decide."""
        endings: list[Ending] = []
        for member in members:
            for place, watch in enumerate(self._watches):
                crossing = watch.finish(member)
                if crossing is not None:
                    endings += self._add(place, crossing)
        return self._end(endings)

    def _add(self, place: int, crossings: Crossings) -> list[Ending]:
        """Keep crossings in the direction asked for; those that end their trajectories."""
        sought = self.sought[place]
        if sought.event.direction:
            crossings = crossings.take(crossings.direction == sought.event.direction)
        self._lots[place].append(crossings)
        member, counts = crossings.member, self._counts[place]
        if not sought.limit:
            return []
        # crossings stand by member and time: how many of each member come before one
        begins = np.flatnonzero(np.append(True, member[1:] != member[:-1]))[: member.size]
        lengths = np.diff(np.append(begins, len(member))).astype(np.intp)
        number = np.arange(len(member)) - np.repeat(begins, lengths) + counts[member] + 1
        np.add.at(counts, member, 1)
        return [
            Ending(
                member=int(crossings.member[n]),
                time=float(crossings.time[n]),
                state=crossings.state[:, n].copy(),
                name=sought.event.name,
                decided=int(crossings.decided[n]),
            )
            for n in np.flatnonzero(number == sought.limit).tolist()
        ]

    def _end(self, endings: list[Ending]) -> list[Ending]:
        """The first ending of each member, if it is not after one that is known."""
        first: dict[int, Ending] = {}
        for ending in endings:
            known = first.get(ending.member)
            if known is None or ending.time < known.time:
                first[ending.member] = ending
        kept = [e for e in first.values() if e.time < self.ends[e.member]]
        for ending in kept:
            self.ends[ending.member] = ending.time
            for place, watch in enumerate(self._watches):  # others at the same time
                crossing = watch.finish(ending.member)
                if crossing is not None:
                    self._add(place, crossing)
        return kept

    def save(self) -> dict[str, Any]:
        """What is known of all events, as arrays."""
        arrays: dict[str, Any] = {"ends": self.ends}
        for place, watch in enumerate(self._watches):
            lots = self._join(place)
            self._lots[place] = [lots]
            known = {**watch.save(), "count": self._counts[place]}
            known |= {f"crossing_{name}": array for name, array in vars(lots).items()}
            arrays |= {f"{place}.{name}": array for name, array in known.items()}
        return arrays

    def restore(self, arrays: Mapping[str, Any]) -> None:
        """Know what was saved."""
        self.ends[:] = arrays["ends"]
        for place, watch in enumerate(self._watches):
            own = take_below(arrays, str(place))
            watch.restore(own)
            self._counts[place][:] = own["count"]
            names = (each.name for each in fields(Crossings))
            self._lots[place] = [Crossings(**{name: own[f"crossing_{name}"] for name in names})]

    def _join(self, place: int) -> Crossings:
        """All crossings of an event."""
        return join(
            self._lots[place], self.surroundings.system.STATE.size + self.surroundings.followed
        )

    def collect(self, place: int) -> tuple[Crossings, Array]:
        """The crossings of an event up to the ends of trajectories, and where it is undefined."""
        whole, ends = self._join(place), self.ends
        # of two at one time either may end a trajectory: the other is not lost by its last digit
        kept = whole.take(whole.time <= ends[whole.member] + 8 * EPS * np.abs(whole.time))
        kept.time = np.minimum(kept.time, ends[kept.member])
        return kept, self._watches[place].undefined


def list_occurrences(lookout: Lookout, batch: tuple[int, ...]) -> Events:
    """All events by name.

    Args:
        lookout: Who looked for them.
        batch: The shape of the batch.
    """
    found: dict[str, Occurrences] = {}
    around = lookout.surroundings
    for place, sought in enumerate(lookout.sought):
        whole, undefined = lookout.collect(place)
        shared = around.parameters.ndim == 1
        inputs = None
        if around.driven is not None:
            inputs = around.driven(whole.member, whole.time, whole.time)
        found[sought.event.name] = Occurrences(
            event=sought.event,
            system=around.system,
            batch=batch,
            member=whole.member,
            time=whole.time,
            direction=whole.direction,
            state=whole.state,
            parameters=around.parameters if shared else around.parameters[:, whole.member],
            inputs=inputs,
            undefined=undefined.reshape(batch),
        )
    return Events(found)
