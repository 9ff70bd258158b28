"""Command ``show``: a derivation, step by step, as text, LaTeX or a web page.

Comes in: a spec. Goes out: a document. Read next: `coadjoint.derive.document` and
`coadjoint.render.document`.
"""

from __future__ import annotations

from pathlib import Path

import click

from coadjoint.cli.arguments import (
    format_option,
    output_option,
    seconds_option,
    size_option,
    spec_path,
    system_argument,
)
from coadjoint.cli.output import show_text


@click.command("show")
@system_argument
@click.option("--route", help="One of the spec's routes. Default: the first, which is emitted.")
@format_option("text", "latex", "html")
@output_option
@size_option
@seconds_option
def command(
    system: str,
    route: str | None,
    form: str,
    output: Path | None,
    sizes: dict[str, int],
    seconds: int | None,
) -> None:
    """Show a derivation, step by step."""
    from coadjoint.bounded import derive_bounded
    from coadjoint.render.document import render_document

    record = derive_bounded(spec_path(system), route, sizes=sizes, seconds=seconds)
    show_text(render_document(record, form), output)
