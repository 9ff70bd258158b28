"""Command ``show``: a derivation, step by step, as text, LaTeX or a web page; or its methods.

Comes in: a spec. Goes out: a document, or a table. Read next: `coadjoint.derive.document` and
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
from coadjoint.cli.methods import print_methods
from coadjoint.cli.output import json_option, print_json, show_text


@click.command("show")
@system_argument
@click.option("--route", help="One of the spec's routes. Default: the first, which is emitted.")
@click.option("--methods", is_flag=True, help="Which methods of integration keep what, and why.")
@format_option("text", "latex", "html")
@output_option
@size_option
@seconds_option
@json_option
def command(
    system: str,
    route: str | None,
    methods: bool,
    form: str,
    output: Path | None,
    sizes: dict[str, int],
    seconds: int | None,
    as_json: bool,
) -> None:
    """Show a derivation, step by step, or methods of integration."""
    from coadjoint.bounded import derive_bounded, methods_bounded
    from coadjoint.render.document import render_document

    if methods:
        judged = methods_bounded(spec_path(system), sizes=sizes, seconds=seconds)
        print_json(judged) if as_json else print_methods(judged)
        return
    record = derive_bounded(spec_path(system), route, sizes=sizes, seconds=seconds)
    if as_json:
        print_json(record)
        return
    show_text(render_document(record, form), output)
