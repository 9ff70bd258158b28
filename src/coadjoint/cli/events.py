"""Command ``simulate``: its options for events, and how events are shown.

Comes in: formulas from the command line, and a Solution with its events. Goes out: `Event` records,
and a table, JSON values, or files of what was found. Read next: `coadjoint.cli.simulate`.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from coadjoint.cli.output import plural, print_table, say
from coadjoint.files import check_writable

if TYPE_CHECKING:
    from coadjoint.solve.events import Event
    from coadjoint.solve.occurrences import Occurrences
    from coadjoint.solve.solution import Solution
    from coadjoint.solve.system import System

Command = TypeVar("Command", bound=Callable[..., Any])

#: Rows of the table on screen.
ROWS = 20
_WORDS = {1: "rises", -1: "falls", 0: "touches"}
#: A name in a formula.
_NAME = re.compile(r"[A-Za-z_]\w*")


def events_options(command: Command) -> Command:
    """The options of events."""
    for option in reversed(
        [
            click.option(
                "--events",
                metavar="FORMULA",
                multiple=True,
                help="Where to look for events, e.g. 'Gamma3 = 0'. Repeatable.",
            ),
            click.option(
                "--until-event", is_flag=True, help="End each trajectory at its first event."
            ),
            click.option(
                "--events-csv",
                type=click.Path(path_type=Path),
                help="Table of all events to write, e.g. events.csv.",
            ),
            click.option(
                "--section",
                type=click.Path(path_type=Path),
                help="Picture of the states at events to write, e.g. section.png.",
            ),
            click.option(
                "--section-axes",
                metavar="NAME,NAME",
                help="The two components of --section. Default: those that vary most.",
            ),
        ]
    ):
        command = option(command)
    return command


@dataclass(frozen=True)
class Asked:
    """What was asked for.

    Attributes:
        formulas: To look for.
        until_event: Whether the first event ends a trajectory.
        table: Where a table of events goes.
        section: Where a picture of them goes.
        axes: Of the picture.
    """

    formulas: tuple[str, ...]
    until_event: bool
    table: Path | None
    section: Path | None
    axes: str | None

    @property
    def events(self) -> list[Event] | None:
        """The events, as `System.simulate` takes them."""
        from coadjoint.solve.events import Event  # which needs NumPy

        ends = self.until_event
        return [Event(formula=text, terminal=ends) for text in self.formulas] or None

    def check(self) -> None:
        """The options go together, and what was asked for can be written.

        Raises:
            UsageError: An option needs another one.
            KernelArgumentError: matplotlib is not installed, or does not know an ending.
            OutputError: A folder is missing or not writable, or a path is a folder.
        """
        needs = {
            "--until-event": self.until_event,
            "--events-csv": self.table,
            "--section": self.section,
        }
        for option, given in needs.items():
            if given and not self.formulas:
                raise click.UsageError(f"{option} needs --events, e.g. --events 'Gamma3 = 0'.")
        if self.axes and not self.section:
            raise click.UsageError("--section-axes needs --section, the picture to write.")
        if self.table is not None:
            check_writable(self.table)
        if self.section is not None:
            from coadjoint.solve.plot import check_picture  # which needs NumPy

            check_picture(self.section)

    @property
    def _axes(self) -> list[str] | None:
        """The names of the axes of the picture."""
        return None if self.axes is None else [each.strip() for each in self.axes.split(",")]

    def check_axes(self, system: System, *, followed: bool) -> None:
        """The axes of the picture are components.

        Raises:
            KernelArgumentError: There are not two, or one is no component.
        """
        if self._axes is not None:
            from coadjoint.solve.section import check_axes  # which needs NumPy

            check_axes(system, self._axes, followed=followed)

    def write(self, solution: Solution) -> None:
        """Write the files."""
        if self.table is not None:
            solution.events.to_csv(self.table)
        if self.section is not None:
            solution.events.plot(self.section, self._axes)

    def warn(self, solution: Solution) -> None:
        """Say on standard error where a run that was to end at an event has met none."""
        late = _list_statuses(solution).count("OK") if self.until_event else 0
        if late:
            who = (
                f"{late} of {plural(solution.batch[0], 'member')}" if solution.batch else "the run"
            )
            sought = " or ".join(map(repr, self.formulas))
            say(f"warning: {who} came to the end without an event {sought}", err=True)

    def has_arrived(self, solution: Solution) -> bool:
        """Whether all trajectories ended as they were to: at an event, or else at the end."""
        return set(_list_statuses(solution)) == {"EVENT" if self.until_event else "OK"}


def _list_statuses(solution: Solution) -> list[str]:
    """How the trajectories ended."""
    return list(solution.status.ravel().tolist() if solution.batch else [solution.status])


def take_events(options: dict[str, Any]) -> Asked:
    """What was asked for, taken out of the options of the command."""
    return Asked(
        formulas=options.pop("events"),
        until_event=options.pop("until_event"),
        table=options.pop("events_csv"),
        section=options.pop("section"),
        axes=options.pop("section_axes"),
    )


# -- output ---------------------------------------------------------------------------------------


def describe_events(solution: Solution) -> dict[str, Any]:
    """The events as JSON values, by name."""
    return {name: _describe(each) for name, each in solution.events.items()}


def _describe(found: Occurrences) -> dict[str, Any]:
    names = found.system.STATE.components
    member = {"member": found.member.tolist()} if found.batch else {}
    return {
        "count": len(found),
        **member,
        "time": found.time.tolist(),
        "direction": found.direction.tolist(),
        "state": {name: found[name].tolist() for name in names},
    }


def print_events(solution: Solution) -> None:
    """A table of the first events, with the state and what they name; a line for what never was."""
    from coadjoint.solve.event_tables import list_columns

    if not solution.events:
        return
    columns = list_columns(solution.events)
    clock = solution.system.clock[0]
    total, names = len(columns["time"]), list(solution.system.STATE.components)
    axes = [name for name in columns if name.startswith("member")]
    told = {name for each in solution.events.values() for name in _NAME.findall(each.event.formula)}
    told -= {"event", "time", "direction", *axes, *names}
    names += [name for name in columns if name in told]
    if total:
        shown = ["event", *(f">{axis}" for axis in axes), f">{clock}", "left side"]
        shown += [f">{name}" for name in names]
        rows = []
        for n in range(min(total, ROWS)):
            row = [columns["event"][n], *(str(columns[axis][n]) for axis in axes)]
            row += [f"{columns['time'][n]:.12g}", _WORDS[columns["direction"][n]]]
            rows.append(row + [f"{columns[name][n]:.6g}" for name in names])
        print_table(shown, rows)
    if total > ROWS:
        say(f"{total - ROWS} more events; --events-csv FILE writes all {total}.")
    for name, found in solution.events.items():
        if not len(found):
            say(f"no event {name!r}")
        first = float(found.undefined.min())
        if first < float("inf"):
            say(f"event {name!r}: the formula has no finite value at {clock} = {first:.6g}")
