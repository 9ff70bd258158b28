"""Tables of events: of all the events of a solution as a file, a frame, or JSON values.

Comes in: an `Events`. Goes out: a table of one row per occurrence, or a record from which the same
events are read back to the last bit.
Read next: `coadjoint.solve.carried`, which has the records in files of solutions.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.files import write_whole
from coadjoint.solve.events import Event
from coadjoint.solve.occurrences import Events, Occurrences

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.solve.system import System


def list_columns(events: Events) -> dict[str, list[Any]]:
    """The columns of the table: name, members, time and direction, then state and observables.

    Rows stand by member and time.
    """
    found = [each for each in events.values() if len(each)]
    columns: dict[str, list[Any]] = {"event": []}
    if not found:
        return columns | {"time": [], "direction": []}
    member = np.concatenate([each.member for each in found])
    time = np.concatenate([each.time for each in found])
    order = np.lexsort((time, member))
    names = [name for each in found for name in [each.event.name] * len(each)]
    columns["event"] = [names[place] for place in order.tolist()]
    batch, system = found[0].batch, found[0].system
    axes = ["member"] if len(batch) == 1 else [f"member_{n}" for n in range(len(batch))]
    places = np.unravel_index(member[order], batch) if batch else ()
    columns |= {axis: place.tolist() for axis, place in zip(axes, places, strict=True)}
    columns["time"] = time[order].tolist()
    directions = np.concatenate([each.direction for each in found])
    columns["direction"] = directions[order].tolist()
    followed = system.RECONSTRUCTED.components[: len(found[0].state) - system.STATE.size]
    for name in (*system.STATE.components, *followed, *system.OBSERVABLES.components):
        if name not in columns:
            columns[name] = np.concatenate([each[name] for each in found])[order].tolist()
    return columns


def write_events(events: Events, path: Path) -> None:
    """Write the table, whole or not at all."""
    columns = list_columns(events)
    with write_whole(path) as place, place.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(zip(*columns.values(), strict=True))


# -- records --------------------------------------------------------------------------------------


def describe_events(events: Events) -> list[dict[str, Any]]:
    """All that is known of events but the parameters, as JSON values."""
    return [
        {
            "event": asdict(each.event),
            "batch": list(each.batch),
            "member": each.member.tolist(),
            "time": each.time.tolist(),
            "direction": each.direction.tolist(),
            "state": each.state.tolist(),
            "inputs": None if each.inputs is None else each.inputs.tolist(),
            "undefined": [t if t < np.inf else None for t in each.undefined.ravel().tolist()],
        }
        for each in events.values()
    ]


def read_events_back(
    system: System, parameters: Array, records: list[Mapping[str, Any]]
) -> dict[str, Occurrences]:
    """What `describe_events` said, with the packed parameters of the solution.

    Raises:
        KeyError: A record has not what it needs.
        TypeError: Likewise.
        ValueError: Likewise.
    """
    found = {}
    flat = parameters if parameters.ndim == 1 else parameters.reshape(len(parameters), -1)
    for record in records:
        event, member = Event(**record["event"]), np.array(record["member"], np.intp)
        count, batch = len(member), tuple(record["batch"])
        times = [np.inf if time is None else time for time in record["undefined"]]
        inputs = record["inputs"]
        found[event.name] = Occurrences(
            event=event,
            system=system,
            batch=batch,
            member=member,
            time=np.array(record["time"], np.float64),
            direction=np.array(record["direction"], np.int8),
            state=_read_rows(record["state"], count),
            parameters=flat if flat.ndim == 1 else flat[:, member],
            inputs=None if inputs is None else _read_rows(inputs, count),
            undefined=np.array(times, np.float64).reshape(batch),
        )
    return found


def _read_rows(rows: list[list[float]], count: int) -> Array:
    """Rows of as many values as there are occurrences, which may be none."""
    return np.array(rows, np.float64).reshape(len(rows), count)
