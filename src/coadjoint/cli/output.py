"""Commands: their output. Tables and JSON to standard output, progress to standard error.

Comes in: rows and records. Goes out: text, without anything that a terminal would obey; a place
that takes no text is an error that says so. rich is imported on first use, since it costs as much
time as the rest of a small command.
"""

from __future__ import annotations

import io
import json
import math
import os
import shutil
import sys
import textwrap
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import click

from coadjoint.errors import OutputError, make_printable, plain
from coadjoint.files import write_whole

#: Characters of a column that never wraps, and of one that does, at the least.
RIGID, FLEXIBLE = 16, 12
#: Characters of words that are never broken.
WORD = 40
#: Called with system, stage, stages done, stages in all.
Progress = Callable[[str, str, int, int], None]

json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON for programs.")


def say(text: str = "", *, err: bool = False, end: str = "\n") -> None:
    """Print text on standard output, or on standard error; every command prints through this.

    Characters that a terminal would obey, or that its encoding has not, are shown as escapes.

    Raises:
        OutputError: Standard output cannot be written. A reader of a pipe who has left is a
            BrokenPipeError, which click turns into a quiet end.
    """
    stream = sys.stderr if err else sys.stdout
    encoding = getattr(stream, "encoding", None) or "utf-8"
    shown = plain(text).encode(encoding, "backslashreplace").decode(encoding)
    try:
        click.echo(shown + end, nl=False, err=err)
    except BrokenPipeError:
        raise
    except OSError as error:
        if not err:  # of standard error there is nowhere to complain
            raise explain_unwritten(error) from error


def explain_unwritten(error: OSError) -> OutputError:
    """What to say of a standard output that takes no text; what was left of it is dropped."""
    with suppress(OSError, ValueError):  # so that the end of the program does not try again
        handle = os.open(os.devnull, os.O_WRONLY)
        os.dup2(handle, sys.stdout.fileno())
        os.close(handle)
    return OutputError(
        f"standard output cannot be written: {error.strerror or error}. Redirect it to a place "
        "with free space.",
        path="standard output",
        found=error.strerror or str(error),
    )


def print_table(columns: Sequence[str], rows: Sequence[Sequence[str]], title: str = "") -> None:
    """A table on standard output; columns whose name begins with ``>`` are aligned to the right.

    In a pipe no cell is ever cut or wrapped, whatever the width. On a terminal long cells go on
    below themselves and short ones, such as names, and words stay whole; where even these do not
    fit next to each other, each row is a block with a line for each column.
    """
    width = shutil.get_terminal_size().columns if sys.stdout.isatty() else 10_000
    cells = [[make_printable(cell) for cell in row] for row in rows]
    heads = [column.removeprefix(">") for column in columns]
    natural = [max(map(len, column)) for column in zip(heads, *cells, strict=True)]
    rigid = [n == 0 or size <= RIGID for n, size in enumerate(natural)]
    words = [
        max(len(word) for cell in column for word in ["", *cell.split()])
        for column in zip(heads, *cells, strict=True)
    ]
    least = [
        size if fixed else max(FLEXIBLE, min(word, WORD))
        for size, fixed, word in zip(natural, rigid, words, strict=True)
    ]
    if sum(least) + 3 * len(columns) > width:
        _print_blocks(heads, cells, title, width)
        return
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    drawn = io.StringIO()
    console = Console(file=drawn, width=width, force_terminal=False, color_system=None)
    has_lines = (sys.stdout.encoding or "").lower().startswith("utf")
    table = Table(box=SIMPLE_HEAD if has_lines else None)
    for column, fixed, size in zip(columns, rigid, least, strict=True):
        table.add_column(
            column.removeprefix(">"),
            justify="right" if column.startswith(">") else "left",
            no_wrap=fixed,
            min_width=size,
            overflow="fold",
        )
    for row in cells:
        table.add_row(*map(Text, row))
    console.print(table)
    lines = [*([title] if title else []), *drawn.getvalue().splitlines()]
    say("\n".join(line.rstrip() for line in lines if line.strip()))


def _print_blocks(
    heads: Sequence[str], rows: Sequence[Sequence[str]], title: str, width: int
) -> None:
    """Each row as its first cell, and a line for each of the others that is not empty."""
    lines = [title] if title else []
    for name, *others in rows:
        lines.append(name)
        for head, cell in zip(heads[1:], others, strict=True):
            if cell:
                whole = f"{head}: {cell}" if head else cell
                lines += textwrap.wrap(
                    whole,
                    max(width, 24),
                    initial_indent="  ",
                    subsequent_indent="    ",
                    break_on_hyphens=False,
                )
    say("\n".join(lines))


def print_json(value: Any) -> None:
    """A record on standard output, as JSON; what is not finite becomes null, as JSON has it."""
    say(json.dumps(_replace_infinities(value), indent=2, allow_nan=False))


def _replace_infinities(value: Any) -> Any:
    """JSON values without infinities and NaNs."""
    if isinstance(value, dict):
        return {key: _replace_infinities(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_replace_infinities(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


@contextmanager
def progress_bars() -> Iterator[Progress]:
    """A bar for each system on standard error, if that is a terminal; silence otherwise."""
    if not sys.stderr.isatty():
        yield lambda *_: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("{task.fields[system]}", markup=False),
        BarColumn(),
        TextColumn("{task.description}", markup=False),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bars:
        tasks: dict[str, Any] = {}

        def progress(system: str, stage: str, done: int, total: int) -> None:
            if system not in tasks:
                tasks[system] = bars.add_task(stage, total=total, system=make_printable(system))
            bars.update(tasks[system], description=stage, completed=done, total=total)

        yield progress


def write_text(path: Path, text: str) -> None:
    """Write a file that the user named, whole or not at all.

    Raises:
        OutputError: It cannot be written; the message names it.
    """
    with write_whole(path) as place:
        place.write_text(text, encoding="utf-8")


def find_width(output: Path | None, most: int) -> int:
    """Characters of a line: those of the terminal, at least 40; in a pipe or a file the most."""
    if output is not None or not sys.stdout.isatty():
        return most
    return max(40, min(most, shutil.get_terminal_size().columns))


def show_text(text: str, output: Path | None) -> None:
    """Print a text as it is, or write it to a file that the user named."""
    if output is None:
        say(text, end="")
    else:
        write_text(output, text)


def plural(count: int, noun: str) -> str:
    """A count in words.

    >>> plural(1, "system"), plural(3, "system")
    ('1 system', '3 systems')
    """
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
