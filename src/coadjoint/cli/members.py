"""Members: many trajectories of one command, and a table of how they ended.

Comes in: ``--members FILE|N``. Goes out: a start of each member, with its parameters and inputs;
after the run tables and JSON, a line for each member. Read next: `coadjoint.cli.simulate`.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from coadjoint.cli.output import plural, print_table, say

if TYPE_CHECKING:
    from coadjoint.solve.solution import Solution
    from coadjoint.solve.system import System

#: Random members lie around the start by this part of the largest component of each quantity.
SPREAD: Final = 0.1
#: Most members that a command draws, and most lines of the table of members.
MOST: Final = 10_000_000
SHOWN: Final = 50

members_option = click.option(
    "--members",
    metavar="FILE|N",
    help="Many trajectories: a CSV file with a column for each component that differs, of state, "
    "parameters, inputs or what is reconstructed, and a row for each member; or a number of "
    f"members with random states, each component within {100 * SPREAD:g} % of the largest of its "
    "quantity around the start, uniformly.",
)
seed_option = click.option(
    "--seed",
    type=click.IntRange(0),
    default=0,
    show_default=True,
    help="Of random members, and of noise.",
)


@dataclass(frozen=True)
class Members:
    """What the members of a run, or its only trajectory, begin with.

    Attributes:
        state: ``(n, N)``, of one ``(n,)``.
        parameters: By name, ``(N,)`` where they differ.
        inputs: Likewise; None for the defaults.
        followed: Where what is reconstructed begins, likewise; defaults are left out.
        origin: Where members come from, for a reader; "" of one trajectory.
    """

    state: Any
    parameters: Mapping[str, Any]
    inputs: Mapping[str, Any] | None
    followed: Mapping[str, Any]
    origin: str = ""


def find_members(system: System, given: str, seed: int, one: Members) -> Members:
    """The members that a word of the command line means.

    Args:
        system: The System.
        given: A number, or the path of a file.
        seed: Of random members.
        one: What one trajectory would begin with.

    Raises:
        BadParameter: It is neither, or the file does not have the form.
    """
    if given.isascii() and given.isdecimal():
        count = int(given[:20])
        if not 1 <= count <= MOST:
            raise _refuse(f"{given[:20]} members; expected 1 to {MOST}.")
        return _draw(system, count, seed, one)
    return _read(system, Path(given), one)


def _refuse(message: str) -> click.BadParameter:
    return click.BadParameter(message, param_hint="--members")


def _draw(system: System, count: int, seed: int, one: Members) -> Members:
    """Random states around a start, on the constraints where the system keeps some."""
    import numpy as np

    middle = np.asarray(one.state)[:, np.newaxis]
    sizes = np.ones(middle.shape)
    for quantity in system.STATE.values():
        rows = [system.STATE.components.index(name) for name in quantity.components]
        sizes[rows] = np.abs(middle[rows]).max() or 1.0
    source = np.random.default_rng(seed)
    state = middle + SPREAD * sizes * source.uniform(-1.0, 1.0, (len(middle), count))
    origin = f"random states within {100 * SPREAD:g} % around the start, seed {seed}"
    if "projection" in system.functions:
        from coadjoint.solve.constraints import settle

        time = np.zeros(count) if system.TIME else None

        def project(states: Any) -> Any:
            return system.projection(states, one.parameters, one.inputs, time=time)

        def measure(states: Any) -> Any:
            return system.constraint_residual(states, one.parameters, one.inputs, time=time)

        once = project(state)
        settled = settle(system, once, measure, project)
        state = once if settled is None else settled
        origin = f"{origin}, moved onto the constraints"
    return replace(one, state=state, origin=origin)


def _read(system: System, path: Path, one: Members) -> Members:
    """The rows of a file; what has no column is as for one trajectory."""
    import numpy as np

    columns = _read_columns(path)
    tables = (system.STATE, system.PARAMETERS, system.INPUTS, system.RECONSTRUCTED)
    known = [each.components for each in tables]
    for name in columns:
        if not any(name in names for names in known):
            listed = ", ".join(each.listed for each in tables if each)
            raise _refuse(f"{path}: the column {name!r} is none of {listed}.")
    count = len(next(iter(columns.values())))
    state = np.tile(np.asarray(one.state)[:, np.newaxis], count)
    own: list[dict[str, Any]] = [{}, {}, {}]  # parameters, inputs, what is reconstructed
    for name, values in columns.items():
        place = next(n for n, names in enumerate(known) if name in names)
        if place == 0:
            state[known[0].index(name)] = values
        else:
            own[place - 1][name] = np.array(values)
    given = (one.parameters, one.inputs or {}, one.followed)
    parameters, inputs, followed = (
        _spread(table, values) | differing
        for table, values, differing in zip(tables[1:], given, own, strict=True)
    )
    return Members(
        state=state,
        parameters=parameters,
        inputs=inputs or None,
        followed=followed,
        origin=f"rows of {path}",
    )


def _spread(quantities: Any, given: Mapping[str, Any]) -> dict[str, Any]:
    """Values by component: a column may replace one component of a vector that was given."""
    spread: dict[str, Any] = {}
    for name, values in given.items():
        if name in quantities and quantities[name].shape:
            spread |= dict(zip(quantities[name].components, values, strict=False))
        else:
            spread[name] = values
    return spread


def _read_columns(path: Path) -> dict[str, list[float]]:
    """The columns of a CSV file; lines that begin with ``#`` and empty ones are left out.

    Raises:
        BadParameter: It cannot be read, or is no table of numbers.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            numbered = [(n, line) for n, line in enumerate(file, 1) if line.strip()]
        kept = [(n, line) for n, line in numbered if not line.startswith("#")]
        rows = list(csv.reader(line for _, line in kept))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or error
        raise _refuse(
            f"{path} cannot be read: {reason}. Expected a CSV file or a number."
        ) from None
    head = [name.strip() for name in rows[0]] if rows else []
    if len(rows) < 2 or len(set(head)) < len(head):
        raise _refuse(
            f"{path} has {plural(max(0, len(rows) - 1), 'member')} below the columns "
            f"{', '.join(head) or 'none'}; expected columns with different names, and a row for "
            "each member below them."
        )
    table = []
    for (line, _), row in zip(kept[1:], rows[1:], strict=True):
        try:
            numbers = [float(cell) for cell in row]
        except ValueError as error:
            raise _refuse(f"{path}, line {line}: {error}.") from None
        if len(numbers) != len(head):
            raise _refuse(
                f"{path}, line {line}: {plural(len(row), 'value')}; expected {len(head)}."
            )
        table.append(numbers)
    return {name: list(values) for name, values in zip(head, zip(*table, strict=True), strict=True)}


# -- after the run ------------------------------------------------------------------------------


def print_members(solution: Solution, origin: str) -> None:
    """A line for each member, or for those that failed first; then the drift of all of them."""
    system, count = solution.system, solution.batch[0]
    short = [n for n in range(count) if solution.status[n] != "OK"]
    order = short + [n for n in range(count) if solution.status[n] == "OK"]
    shown = sorted(order[:SHOWN])
    drifts = solution.drift
    absolute = solution.absolute_drift
    rows = [
        [
            str(n),
            str(solution.status[n]),
            f"{solution.time_reached[n]:.6g}",
            str(solution.steps[n]),
            str(solution.rejected[n]),
            *(f"{drift[n]:.1e}" for drift in drifts.values()),
        ]
        for n in shown
    ]
    columns = ["member", "status", ">t", ">steps", ">rejected"]
    columns += [f">{'absolute ' * (name in absolute)}drift of {name}" for name in drifts]
    print_table(columns, rows, title=f"{system.title} ({system.name}), {origin}")
    if len(shown) < count:
        say(f"and {count - len(shown)} more; --json has them all")
    rows = [
        [name, f"{drift.max():.1e}{' absolute' * (name in absolute)}"]
        for name, drift in drifts.items()
    ]
    if rows:
        print_table(["conserved", ">largest drift"], rows)
    for name, drift in solution.attitude_drift.items():
        say(f"|{name}|^2 - 1 up to {drift:.1e}")
    arrived = f"OK: {plural(count, 'member')} reached the end"
    say(f"status: {solution.message or arrived}")
    if solution.course.stepwise:
        say(solution.course.tell_stepwise())
    if solution.course.keeps:
        say(solution.course.tell_keeps())


def describe_members(solution: Solution, origin: str) -> dict[str, Any]:
    """The run as JSON values, with a list over the members for what differs."""
    system = solution.system
    below, course = system.RECONSTRUCTED.components, solution.course
    followed = {} if course.below is None else dict(zip(below, course.below, strict=True))
    components = (*system.STATE.components, *followed, *system.OBSERVABLES.components)
    listed = zip(system.PARAMETERS.components, solution.parameters.tolist(), strict=True)
    return {
        "system": system.name,
        "members": solution.batch[0],
        "origin": origin,
        "status": solution.status.tolist(),
        "message": solution.message,
        **({"stepwise": course.stepwise} if course.stepwise else {}),
        "time": solution.time_reached.tolist(),
        "steps": solution.steps.tolist(),
        "rejected": solution.rejected.tolist(),
        "samples": len(solution),
        "parameters": dict(listed),
        "initial": {name: solution.first(name)[:, 0].tolist() for name in components},
        "final": {name: values.tolist() for name, values in (solution.final | followed).items()},
        "drift": {name: values.tolist() for name, values in solution.drift.items()},
        "absolute_drift": [*solution.absolute_drift],
        "units": {name: solution.unit(name) for name in components},
    }
