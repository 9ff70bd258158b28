"""Command ``export``: one step of a method as a file that programs of others include.

Comes in: a spec, and a method. Goes out: a header of C. Read next: `coadjoint.export`.
"""

from __future__ import annotations

from pathlib import Path

import click

from coadjoint.cli.arguments import (
    complete_method,
    output_option,
    seconds_option,
    size_option,
    spec_path,
    system_argument,
)
from coadjoint.cli.output import show_text


@click.command("export")
@system_argument
@click.option(
    "--method",
    default="auto",
    show_default=True,
    shell_complete=complete_method("auto", "rk4", "dop853"),
    help="As `coadjoint show SYSTEM --methods` lists them, rk4 or dop853.",
)
@click.option(
    "--format",
    "form",
    type=click.Choice(["c"]),
    default="c",
    show_default=True,
    help="c is a header for C99 and C++17.",
)
@output_option
@size_option
@seconds_option
def command(
    system: str,
    method: str,
    form: str,
    output: Path | None,
    sizes: dict[str, int],
    seconds: int | None,
) -> None:
    """Write one step of a method as a header without dependencies.

    It has the bits of the library where it is compiled with -ffp-contract=off.
    """
    from coadjoint.bounded import export_bounded
    from coadjoint.files import check_writable

    if output is not None:
        check_writable(output)  # before the work and not after it
    text = export_bounded(spec_path(system), method, sizes=sizes, seconds=seconds)
    show_text(text, output)
