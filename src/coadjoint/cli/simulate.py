"""Command ``simulate``: a trajectory or many, the drift of their invariants, and a picture.

Comes in: a system, or a spec that is built first, with parameters and an initial state from the
command line. Goes out: tables or JSON, and files that were asked for. Read next:
`coadjoint.cli.members` for many, and `coadjoint.solve.simulate`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from coadjoint.cli.arguments import (
    complete_method,
    complete_names,
    load_system,
    seconds_option,
    size_option,
    system_argument,
)
from coadjoint.cli.events import describe_events, events_options, print_events, take_events
from coadjoint.cli.members import (
    Members,
    describe_members,
    find_members,
    members_option,
    print_members,
    seed_option,
)
from coadjoint.cli.output import json_option, print_json, print_table, progress_bars, say
from coadjoint.errors import KernelArgumentError
from coadjoint.files import check_writable

if TYPE_CHECKING:
    from coadjoint.solve.quantities import Quantities
    from coadjoint.solve.solution import Solution
    from coadjoint.solve.system import System

#: Steps of a run with noise for which none is given, at the least.
LEAST_STEPS = 1000
#: Most rows of a table of first and last values.
SHOWN = 60
Assignment = tuple[str, list[float]]


def _assignments(
    _context: click.Context, _parameter: click.Parameter, given: tuple[str, ...]
) -> list[Assignment]:
    """Each ``NAME=1,2,3``, or ``1,2,3`` with no name, as name and numbers."""
    read = []
    for text in given:
        name, _, numbers = text.rpartition("=")
        try:
            read.append((name.strip(), [float(number) for number in numbers.split(",")]))
        except ValueError:
            raise click.BadParameter(
                f"{text!r} is not of the form NAME=1,2,3 with decimal numbers."
            ) from None
    return read


_repeatable = partial(click.option, metavar="NAME=NUMBERS", callback=_assignments, multiple=True)


@click.command("simulate")
@system_argument
@_repeatable(
    "--set",
    "parameters",
    shell_complete=complete_names("parameters"),
    help="A parameter, e.g. I=1,2,3. Default: that of the spec. Repeatable.",
)
@_repeatable(
    "--input",
    "inputs",
    shell_complete=complete_names("inputs"),
    help="A constant input, e.g. u=0.5. Default: that of the spec. Repeatable.",
)
@_repeatable(
    "--state",
    shell_complete=complete_names("variables"),
    help="Initial value of a variable or component, also of a reconstructed one, e.g. Pi=1,0,0, or "
    "of the whole state, e.g. 1,0,0. Default: that of the spec, else 1 for scalars and unit "
    "vectors, projected onto the constraints. Repeatable.",
)
@click.option(
    "--time", type=float, default=10.0, show_default=True, help="Length of the simulation."
)
@members_option
@seed_option
@click.option(
    "--method",
    default="auto",
    show_default=True,
    shell_complete=complete_method("auto", "taylor", "rk4", "dop853"),
    help="taylor, dop853 or rk4, which are generated, or scipy:NAME; auto is taylor where it "
    "applies. With noise: heun, midpoint, spherical_midpoint or coadjoint_mean; auto is the first "
    "that `show --methods` lists.",
)
@click.option("--rtol", type=float, help="Relative tolerance. Default: 1e-10.")
@click.option("--atol", type=float, help="Absolute tolerance. Default: 1e-12.")
@click.option(
    "--step",
    type=float,
    help="A fixed step for a generated method, in the place of tolerances. Default with noise: a "
    "part of the distance of samples, 1000 steps or more.",
)
@click.option(
    "--newton",
    is_flag=True,
    help="Solve the equations of implicit steps by Newton's method, for stiff forces.",
)
@click.option(
    "--threads",
    type=click.IntRange(1),
    help="How many threads share the members, at the most. Default: one for each processor.",
)
@click.option(
    "--samples",
    type=click.IntRange(1, 10_000_000),
    help="Number of evenly spaced samples; 1 for the end alone. Default: 1001, with --members 101.",
)
@click.option(
    "--max-steps",
    type=click.IntRange(1),
    default=1_000_000,
    show_default=True,
    help="Largest number of steps.",
)
@click.option(
    "--checkpoint",
    type=click.Path(path_type=Path),
    help="File that a generated solver keeps on its way. The same command goes on from it.",
)
@click.option(
    "--derivatives",
    type=click.Choice(["differences", "fourier", "lattice"]),
    default="differences",
    show_default=True,
    help="Derivatives of fields along space. By fourier, methods of SciPy alone apply; a strand "
    "as a lattice is one of bodies with attitudes.",
)
@click.option("--plot", type=click.Path(path_type=Path), help="Picture to write, e.g. top.png.")
@click.option(
    "--animate",
    type=click.Path(path_type=Path),
    help="Film to write, e.g. top.gif, top.mp4 or top.html.",
)
@click.option(
    "--trace",
    type=click.Path(path_type=Path),
    help="Picture of the path of (x, y) on the plane to write, e.g. trace.png.",
)
@click.option(
    "--csv",
    "table",
    type=click.Path(path_type=Path),
    help="Table of the trajectory to write, e.g. top.csv.",
)
@events_options
@size_option
@seconds_option
@json_option
def command(
    system: str,
    parameters: list[Assignment],
    inputs: list[Assignment],
    state: list[Assignment],
    members: str | None,
    seed: int,
    plot: Path | None,
    animate: Path | None,
    trace: Path | None,
    table: Path | None,
    sizes: dict[str, int],
    derivatives: str,
    seconds: int | None,
    as_json: bool,
    time: float,
    **options: Any,
) -> int:
    """Integrate a trajectory, or many; show the drift of invariants."""
    _check_outputs(table, *filter(None, (plot, trace)))
    if animate is not None:
        from coadjoint.solve.animation import check_film  # which needs NumPy

        check_film(animate)
    asked = take_events(options)
    asked.check()
    if members is not None and (plot or animate or trace):
        raise click.UsageError(
            "--plot, --animate and --trace are of one trajectory; expected no --members."
        )
    loaded = load_system(system, seconds, sizes, derivatives)
    asked.check_axes(loaded, followed=members is None and bool(loaded.RECONSTRUCTED))
    if trace is not None:
        from coadjoint.solve.trace import check_traced  # which needs NumPy

        check_traced(loaded)
    given: Mapping[str, Any] = chosen_parameters(loaded.PARAMETERS, parameters)
    driven: Mapping[str, Any] | None = chosen_parameters(loaded.INPUTS, inputs) or None
    if members is None:
        check_inputs(loaded, driven or {})
    state, followed = take_reconstructed(loaded, state)
    start = find_start(loaded, state, given, driven)
    run = Members(state=start, parameters=given, inputs=driven, followed=followed)
    options["samples"] = options["samples"] or (1001 if members is None else 101)
    from coadjoint.solve.noisy import has_noise  # which needs NumPy

    if has_noise(loaded):
        spaces = max(1, options["samples"] - 1)
        steps = spaces * -(-LEAST_STEPS // spaces)
        options |= {"seed": seed, "step": options["step"] or time / steps}
    if members is not None:
        run = find_members(loaded, members, seed, run)
    options |= {"events": asked.events, "reconstruct": run.followed or bool(loaded.RECONSTRUCTED)}
    solution = loaded.simulate(run.state, (0.0, time), run.parameters, run.inputs, **options)
    _show(loaded, solution, run.origin, as_json=as_json)
    if table is not None:
        solution.to_csv(table)
    if plot is not None:
        solution.plot(plot)
    if animate is not None:
        with progress_bars() as show:
            solution.animate(
                animate, progress=lambda n, count: show(loaded.name, "film", n + 1, count)
            )
    if trace is not None:
        solution.trace(trace)
    asked.write(solution)
    asked.warn(solution)
    return 0 if asked.has_arrived(solution) else 1


def _check_outputs(table: Path | None, *pictures: Path) -> None:
    """What was asked for can be written, before anything is derived or computed.

    Raises:
        KernelArgumentError: matplotlib is not installed, or does not know an ending.
        OutputError: A folder is missing or not writable, or a path is a folder.
    """
    if table is not None:
        check_writable(table)
    for picture in pictures:
        from coadjoint.solve.plot import check_picture  # which needs NumPy

        check_picture(picture)


def take_reconstructed(
    system: System, given: Iterable[Assignment]
) -> tuple[list[Assignment], dict[str, list[float] | float]]:
    """What is given of the state, and what is given of what is reconstructed, by name.

    Raises:
        KernelArgumentError: A name is unknown.
    """
    state, below = [], []
    for name, values in given:
        if name in (*system.RECONSTRUCTED, *system.RECONSTRUCTED.components):
            below.append((name, values))
        else:
            state.append((name, values))
            if name and system.RECONSTRUCTED:  # a message names all that there is
                type(system.STATE)(*system.STATE.values(), *system.RECONSTRUCTED.values()).rows(
                    name
                )
    return state, chosen_parameters(system.RECONSTRUCTED, below)


def find_start(
    system: System, given: Iterable[Assignment], parameters: Any = None, inputs: Any = None
) -> Any:
    """Where a run begins; on the constraints, if the user and the spec say nothing."""
    from coadjoint.solve.family import check_profiles  # which loads systems

    given = list(given)
    if all(name for name, _ in given):  # nobody gives the whole state
        check_profiles(system, [name for name, _ in given])
    start = initial_state(system.STATE, given)
    declared = given or all(quantity.default for quantity in system.STATE.values())
    if "projection" not in system.functions or declared:
        return start
    return system.projection(start, parameters, inputs, time=0.0 if system.TIME else None)


def initial_state(quantities: Quantities, given: Iterable[Assignment]) -> list[float]:
    """The whole initial state: defaults, with what was given put in.

    Raises:
        KernelArgumentError: A name is unknown.
        BadParameter: A wrong number of values.
    """
    state = default_state(quantities)
    for name, values in given:
        rows = quantities.rows(name) if name else slice(0, len(state))
        expected = state[rows] if isinstance(rows, slice) else [state[rows]]
        if len(values) != len(expected):
            raise click.BadParameter(
                f"{name or 'the state'} has {len(values)} values {values}; "
                f"expected {len(expected)}.",
                param_hint="--state",
            )
        state[rows if isinstance(rows, slice) else slice(rows, rows + 1)] = values
    return state


def chosen_parameters(
    quantities: Quantities, given: Iterable[Assignment]
) -> dict[str, list[float] | float]:
    """Parameters by name, scalars as numbers: a list would be one value for each member."""
    vectors = {quantity.name for quantity in quantities.values() if quantity.shape}
    return {
        name: values[0] if len(values) == 1 and name not in vectors else values
        for name, values in given
    }


def check_inputs(system: System, given: Mapping[str, Any]) -> None:
    """Every input has a value.

    Raises:
        KernelArgumentError: One has no default, and none is given.
    """
    named = {each.name: each for each in system.INPUTS.values() if not each.default}
    lacking = [n for n, each in named.items() if given.keys().isdisjoint({n, *each.components})]
    if lacking:
        first = named[lacking[0]]
        value = ",".join("0" for _ in first.components)
        raise KernelArgumentError(
            f"{system.name} has no default for the input {', '.join(lacking)}; expected a value. "
            f"Write --input {first.name}={value}, or give a default in [inputs].",
            found=first.name,
        )


def default_state(quantities: Quantities) -> list[float]:
    """What the spec says; else each vector of unit length, no special direction, each scalar 1.

    The first is along (1, 2, ..., n), the next along (2, ..., n, 1) and so on: were position and
    velocity parallel, a particle would fall into a centre of attraction.
    """
    state: list[float] = []
    for place, quantity in enumerate(quantities.values()):
        count = len(quantity.components)
        direction = [(place + n) % count + 1 for n in range(count)]
        length = math.sqrt(sum(n * n for n in direction))
        state += quantity.default or [n / length for n in direction]
    return state


def _shown_names(system: System) -> tuple[str, ...]:
    """State, what is reconstructed, and observables, by component."""
    seen = system.RECONSTRUCTED_OBSERVABLES
    tables = (system.STATE, system.RECONSTRUCTED, system.OBSERVABLES, seen)
    return tuple(name for quantities in tables for name in quantities.components)


def _show(system: System, solution: Solution, origin: str, *, as_json: bool) -> None:
    """Tables or JSON, of one trajectory or of members, and of their events."""
    if as_json:
        record = describe_members(solution, origin) if origin else _record(system, solution)
        events = {"events": describe_events(solution)} if solution.events else {}
        print_json(record | events)
        return
    print_events(solution)
    (print_members(solution, origin) if origin else _print(system, solution))


def _print(system: System, solution: Solution) -> None:
    """First and last values, and the drift of the invariants."""
    _print_ends(solution, "state", system.STATE.components, f"{system.title} ({system.name})")
    if system.RECONSTRUCTED:
        _print_ends(solution, "reconstructed", system.RECONSTRUCTED.components)
    observed = (system.OBSERVABLES, system.RECONSTRUCTED_OBSERVABLES)
    _print_ends(solution, "observable", [name for table in observed for name in table.components])
    for name, drift in solution.attitude_drift.items():
        say(f"|{name}|^2 - 1 up to {drift:.1e}")
    say(": ".join(filter(None, ("status", solution.status, solution.message))))
    if solution.course.stepwise:
        say(solution.course.tell_stepwise())
    if solution.course.keeps:
        say(solution.course.tell_keeps())


def _print_ends(solution: Solution, kind: str, names: Iterable[str], title: str = "") -> None:
    """First and last values as a table; of observables with the drift of those that are kept."""
    from coadjoint.solve.drift import list_owners, tell_drift

    clock = solution.system.clock[0]
    columns = [
        kind,
        f">{clock} = {solution.time[0]:g}",
        f">{clock} = {solution.time_reached:g}",
        "unit",
    ]
    rows = [
        [name, f"{first:.12g}", f"{last:.12g}", solution.unit(name)]
        for name, first, last in _ends(solution, names)
    ]
    if kind == "observable":
        columns.append(">drift")
        owners = list_owners(solution)
        for row in rows:
            row.append(tell_drift(solution, owners[row[0]], row[0]) if row[0] in owners else "")
    if len(rows) > SHOWN:
        rows[SHOWN // 2 : -SHOWN // 2] = [["...", *("" for _ in columns[1:])]]
    print_table(columns, rows, title=title)


def _ends(solution: Solution, names: Iterable[str]) -> list[tuple[str, float, float]]:
    """First and last value of several components."""
    return [(name, float(solution.first(name)[0]), float(solution[name][-1])) for name in names]


def _record(system: System, solution: Solution) -> dict[str, Any]:
    """The run as JSON values."""
    names = _shown_names(system)
    ends, units = _ends(solution, names), {name: solution.unit(name) for name in names}
    return solution.summary() | {
        "initial": {name: first for name, first, _ in ends},
        "final": {name: last for name, _, last in ends},
        "units": units,
    }
