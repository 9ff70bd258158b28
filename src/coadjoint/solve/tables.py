"""Tables of a solution: a CSV file and a pandas frame, one row per time.

Comes in: a Solution, or a file that `to_csv` wrote. Goes out: the other, to the last bit. The lines
above the table are JSON values by name.
Read next: `coadjoint.solve.carried`.
"""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from coadjoint.files import write_whole
from coadjoint.solve.carried import (
    check_same_system,
    describe_form,
    describe_run,
    explain_unread,
    import_extra,
    list_batch,
    list_components,
    name_axes,
    rebuild,
)
from coadjoint.solve.step_tables import as_json, describe_dense

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.solution import Solution
    from coadjoint.solve.system import System

    Array = NDArray[np.float64]


def to_pandas(solution: Solution) -> Any:
    """A frame of one row per time, or per member and time, and one column per component."""
    pandas = import_extra("pandas", "to_pandas")
    units, batch = list_components(solution), list_batch(solution)
    columns = {name: solution[name].ravel() for name in units}
    time = solution.time
    axes = [*map(range, batch), time]
    names = [*name_axes(batch, units), solution.system.column_of_time]
    index = (
        pandas.MultiIndex.from_product(axes, names=names)
        if batch
        else pandas.Index(time, name=names[0])
    )
    frame = pandas.DataFrame(columns, index=index)
    frame.attrs = _describe(solution)
    return frame


def to_csv(solution: Solution, path: Path) -> None:
    """Write the table below what is known about it."""
    with write_whole(path) as place, place.open("w", encoding="utf-8", newline="") as file:
        write_table(solution, file)


def write_table(solution: Solution, file: IO[str]) -> None:
    """Write the table to an open file."""
    said, steps = _describe(solution), describe_dense(solution.dense)
    said |= {} if steps is None else {"dense": steps}
    for name, value in said.items():
        file.write(f"# {name}: {json.dumps(value, default=as_json)}\n")
    units, batch = list_components(solution), list_batch(solution)
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow([*name_axes(batch, units), solution.system.column_of_time, *units])
    values = {name: solution[name] for name in units}
    for member in np.ndindex(batch):
        columns = (values[name][member].tolist() for name in units)
        rows = zip(solution.time.tolist(), *columns, strict=True)
        writer.writerows([*member, *row] for row in rows)


def read_csv(system: System, path: Path) -> Solution:
    """The solution that a file holds."""
    try:
        said, columns = _read_table(path)
    except (OSError, csv.Error, ValueError) as error:
        raise explain_unread(path, getattr(error, "strerror", None) or error) from error
    check_same_system(system, said, path, needed=_TABLE_ONLY)
    batch, samples = tuple(said["batch"]), said["samples"]

    def rows(name: str) -> Array:
        try:
            return columns[name].reshape(*batch, samples)
        except (KeyError, ValueError) as error:
            found = columns[name].size if name in columns else "none"
            raise explain_unread(
                path, f"of {name}, {found} values were found in place of {batch} times {samples}"
            ) from error

    time = rows(system.column_of_time).reshape(-1, samples)[0]
    form = said["form"] | {"time": time, "parameters": list(said["parameters"].values())}
    described = {name: value for name, value in said.items() if name not in _TABLE_ONLY}
    return rebuild(system, path, described, rows, form)


#: What only a table says above its rows.
_TABLE_ONLY = ("parameters", "units", "batch", "samples", "form")


def _describe(solution: Solution) -> dict[str, Any]:
    """What stands above a table."""
    names, time = solution.system.PARAMETERS.components, solution.system.column_of_time
    return describe_run(solution) | {
        "parameters": dict(zip(names, solution.parameters.tolist(), strict=True)),
        "units": {time: solution.unit("time"), **list_components(solution)},
        "batch": list(list_batch(solution)),
        "samples": len(solution.time),
        "form": describe_form(solution),
    }


def _read_table(path: Path) -> tuple[dict[str, Any], dict[str, Array]]:
    """What stands above a table, and its columns.

    Raises:
        ValueError: It is no such table.
    """
    with path.open(encoding="utf-8", newline="") as file:
        lines = list(file)
    above = [line[1:].partition(":") for line in lines if line.startswith("#")]
    said = {name.strip(): json.loads(value) for name, _, value in above}
    head, *rows = csv.reader(line for line in lines if not line.startswith("#"))
    numbers = np.array([[float(cell) for cell in row] for row in rows]).reshape(-1, len(head))
    return said, {name: np.ascontiguousarray(numbers[:, n]) for n, name in enumerate(head)}
