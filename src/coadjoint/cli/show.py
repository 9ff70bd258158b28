"""Command ``show``: a derivation, step by step, as text, LaTeX or a web page.

Comes in: a spec. Goes out: a document. Read next: `coadjoint.derive.document` and
`coadjoint.render.document`.
"""

from __future__ import annotations

from pathlib import Path

import click

from coadjoint.cli.arguments import seconds_option, spec_path, system_argument
from coadjoint.cli.output import say, write_text


@click.command("show")
@system_argument
@click.option("--route", help="One of the spec's routes. Default: the first, which is emitted.")
@click.option(
    "--format",
    "form",
    type=click.Choice(["text", "latex", "html"]),
    default="text",
    show_default=True,
    help="latex is a complete file, html one self-contained page.",
)
@click.option(
    "--output", type=click.Path(path_type=Path), help="File to write, in place of the terminal."
)
@seconds_option
def command(
    system: str, route: str | None, form: str, output: Path | None, seconds: int | None
) -> None:
    """Show a derivation, step by step."""
    from coadjoint.bounded import derive_bounded
    from coadjoint.render.document import render_document

    text = render_document(derive_bounded(spec_path(system), route, seconds=seconds), form)
    if output is None:
        say(text, end="")
    else:
        write_text(output, text)
