"""Command ``regenerate``, the main job: specs in, verified kernels out.

Comes in: a folder of specs. Goes out: the generated folder next to it, a table, and the errors of
systems that failed. Read next: `coadjoint.regenerate`.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from coadjoint.cli.arguments import seconds_option
from coadjoint.cli.output import json_option, print_json, print_table, progress_bars, say
from coadjoint.errors import CoadjointError, DriftError, SpecError
from coadjoint.resources import derivations_folder, systems_folder

if TYPE_CHECKING:
    from coadjoint.regenerate import Outcome, Row

folder_options = (
    click.option(
        "--derivations",
        type=click.Path(path_type=Path),
        help="Folder of specs. Default: ./derivations if it exists, else the shipped specs.",
    ),
    click.option(
        "--output",
        type=click.Path(path_type=Path),
        help="Generated folder. Default: `generated` next to the folder of specs.",
    ),
)


def add_folder_options(function: Any) -> Any:
    """Add ``--derivations`` and ``--output`` to a command."""
    for option in reversed(folder_options):
        function = option(function)
    return function


@click.command("regenerate")
@click.argument("names", nargs=-1, metavar="[SYSTEM]...")
@click.option(
    "--check",
    is_flag=True,
    help="Write nothing; compare with a fresh run. Exit status 1 if files differ.",
)
@click.option(
    "--jobs",
    type=click.IntRange(1),
    default=lambda: os.cpu_count() or 1,
    show_default="processors",
    help="Number of systems processed in parallel.",
)
@seconds_option
@add_folder_options
@json_option
def command(
    names: tuple[str, ...],
    check: bool,
    jobs: int,
    seconds: int | None,
    derivations: Path | None,
    output: Path | None,
    as_json: bool,
) -> int:
    """Derive, prove, check and write systems that have changed."""
    from coadjoint import regenerate as engine

    source, target = folders(derivations, output)
    if not check:
        refuse_elsewhere(bool(derivations or output), target)
    paths = spec_paths(source, names)
    run = engine.check
    if not check:
        wait = partial(say, f"waiting for another run in {target}", err=True)
        run = partial(engine.regenerate, on_wait=wait)
    try:
        with progress_bars() as progress:
            whole = not names
            outcome = run(
                paths, target, jobs=jobs, complete=whole, seconds=seconds, progress=progress
            )
    except DriftError as drift:
        show_drift(drift)
        raise
    (print_json(_record(outcome)) if as_json else _print(outcome))
    return report_failures(outcome.failures)


def folders(derivations: Path | None, output: Path | None) -> tuple[Path, Path]:
    """The folder of specs and the generated folder that are meant."""
    here = Path("derivations")
    shipped = derivations_folder()
    source = derivations or (here if here.is_dir() else shipped)
    installed = systems_folder() if source.resolve() == shipped.resolve() else None
    return source, output or installed or source.parent / "generated"


def refuse_elsewhere(is_named: bool, target: Path) -> None:
    """Refuse a run that would write to a folder that the user did not name.

    Args:
        is_named: Whether a folder of specs or a generated folder was named.
        target: The generated folder that is meant.

    Raises:
        SpecError: No folder was named, and no folder of specs is at hand.
        OutputError: The generated folder is part of an installed package.
    """
    from coadjoint.render.ownership import refuse_installed

    if not is_named and not Path("derivations").is_dir():
        raise SpecError(
            f"{Path.cwd()}: there is no folder `derivations` here, so there is nothing to "
            "regenerate; the shipped systems are generated already. Change to your project "
            "folder, or name its specs with --derivations FOLDER. A single spec needs no project: "
            "coadjoint simulate ./my.toml.",
            path=str(Path.cwd()),
            found="",
        )
    refuse_installed(target)


def spec_paths(folder: Path, names: Sequence[str] = ()) -> list[Path]:
    """The specs of a folder, or those of the given names.

    Raises:
        SpecError: There is none, or none of a given name.
    """
    by_name = {path.stem: path for path in sorted(folder.glob("*.toml"))}
    if not by_name:
        raise SpecError(
            f"{folder}: no specs found; expected files ending in .toml. "
            "Write one with `coadjoint new`, or name the folder with --derivations.",
            path=str(folder),
        )
    for name in names:
        if name not in by_name:
            near = get_close_matches(name, by_name, n=1)
            hint = f" Did you mean {near[0]!r}?" if near else ""
            known = ", ".join(by_name)
            message = f"{folder}: no spec is called {name!r}; expected one of {known}.{hint}"
            raise SpecError(message, path=str(folder), found=name)
    return [by_name[name] for name in dict.fromkeys(names or by_name)]


def report_failures(failures: Mapping[str, CoadjointError]) -> int:
    """Print what failed on standard error; the highest exit status of all."""
    for error in failures.values():
        say(f"error: {error}", err=True)
    return max((error.exit_status for error in failures.values()), default=0)


def show_drift(drift: DriftError) -> None:
    """The differences, with the beginning of each diff."""
    for each in drift.differences:
        say(f"{each['kind']}: {each['path']}")
        if each["diff"]:
            say(each["diff"])


def _print(outcome: Outcome) -> None:
    """The table of a run."""
    columns = ("system", ">dim", "routes", ">proved", ">operations", ">k", "targets", ">time")
    print_table(columns, [_cells(row) for row in outcome.rows])


def _cells(row: Row) -> tuple[str, ...]:
    """One line of the table."""
    return (
        row.system,
        str(row.dimension),
        ", ".join(row.routes),
        proved_cell(row.proved, row.supported, row.claims),
        operations_cell(row.operations, row.pair_operations),
        f"{row.k:.2f}",
        ", ".join(row.targets),
        f"{row.seconds:.1f} s" if row.fresh else "unchanged",
    )


def operations_cell(own: int, pair: int) -> str:
    """Operations of a member, and of a pair of members where there are pairs.

    >>> operations_cell(4, 31)
    '4 + 31 a pair'
    """
    return f"{own} + {pair} a pair" if pair else str(own)


def proved_cell(proved: int, supported: int, claims: int) -> str:
    """How many claims are proved of all, and how many are only supported.

    >>> proved_cell(13, 1, 14)
    '13/14 (1 supported)'
    """
    return f"{proved}/{claims}" + (f" ({supported} supported)" if supported else "")


def _record(outcome: Outcome) -> dict[str, Any]:
    """A run as JSON values."""
    return {
        "systems": [asdict(row) for row in outcome.rows],
        "failures": {name: error.as_record() for name, error in outcome.failures.items()},
    }
