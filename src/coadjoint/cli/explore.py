"""Command ``explore``: a system as one web page that simulates it.

Comes in: a spec. Goes out: an HTML file. Read next: `coadjoint.explore.page`.
"""

from __future__ import annotations

from pathlib import Path

import click

from coadjoint.cli.arguments import seconds_option, size_option, spec_path, system_argument
from coadjoint.cli.output import say, write_text


@click.command("explore")
@system_argument
@click.option(
    "--output",
    type=click.Path(path_type=Path),
    help="File to write. Default: the name of the system with .html, in the folder at hand.",
)
@size_option
@seconds_option
def command(system: str, output: Path | None, sizes: dict[str, int], seconds: int | None) -> None:
    """Write a web page that simulates a system with its generated code.

    The page is one file and needs no network. Open it in a browser, or send it to somebody.
    """
    from coadjoint.bounded import explore_bounded
    from coadjoint.files import check_writable

    path = spec_path(system)
    place = output or Path(f"{path.stem}.html")
    check_writable(place)  # before the work and not after it
    text = explore_bounded(path, sizes=sizes, seconds=seconds)
    write_text(place, text)
    say(f"{place}: open it in a browser.", err=True)
