"""Command ``show``: a derivation, step by step, as text, LaTeX or a web page; or its methods.

Comes in: a spec. Goes out: a document, or a table. Read next: `coadjoint.derive.document` and
`coadjoint.render.document`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import click

from coadjoint.cli.arguments import (
    complete_route,
    format_option,
    is_path,
    load_system,
    output_option,
    seconds_option,
    size_option,
    spec_path,
    system_argument,
)
from coadjoint.cli.methods import print_methods
from coadjoint.cli.output import find_width, json_option, print_json, show_text
from coadjoint.resources import systems_folder


@click.command("show")
@system_argument
@click.option(
    "--route",
    shell_complete=complete_route,
    help="One of the spec's routes. Default: the first, which is emitted.",
)
@click.option("--methods", is_flag=True, help="Which methods of integration keep what, and why.")
@format_option("text", "latex", "html", "typst", "json")
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
    if methods:
        from coadjoint.bounded import methods_bounded

        judged = methods_bounded(spec_path(system), sizes=sizes, seconds=seconds)
        print_json(judged) if as_json else print_methods(judged)
        return
    record = make_chapter(system, route, form, sizes=sizes, seconds=seconds)
    if as_json or form == "json":
        text = json.dumps(record, indent=2) + "\n"
    else:
        from coadjoint.render.document import WIDTH, render_document

        text = render_document(record, form, find_width(output, WIDTH))
    show_text(text, output)


def make_chapter(
    system: str,
    route: str | None,
    form: str,
    *,
    sizes: Mapping[str, int] = MappingProxyType({}),
    seconds: int | None = None,
) -> dict[str, Any]:
    """The record of a chapter: the derivation, its proofs and, on a page, a picture.

    Claims of a shipped system stand in its folder; those of a spec are proved for the formats that
    show them, and those of another size in every one, unless they are the same for all sizes.
    """
    from coadjoint.bounded import derive_bounded, prove_bounded
    from coadjoint.chapter import complete
    from coadjoint.files import read_certificate
    from coadjoint.regenerate import is_written_out

    path = spec_path(system)
    record = derive_bounded(path, route, sizes=sizes, seconds=seconds)
    is_resized = bool(sizes) and is_written_out(path, sizes, seconds)
    folder = None if is_path(system) or is_resized else systems_folder() / path.stem
    certificate = {} if folder is None else read_certificate(folder / "certificate.json")
    if "claims" not in certificate and (form != "text" or is_resized):
        certificate = prove_bounded(path, sizes=sizes, seconds=seconds)
    record = complete(record, certificate, folder)
    if form in ("html", "latex", "typst"):
        record |= draw_motion(system, form, sizes=sizes, seconds=seconds)
    return record


def draw_motion(
    system: str,
    form: str,
    *,
    sizes: Mapping[str, int] = MappingProxyType({}),
    seconds: int | None = None,
) -> dict[str, Any]:
    """A picture of a motion, of a page, of LaTeX or of Typst, with its caption.

    Empty without matplotlib, and where a spec can be derived and not be run.
    """
    from coadjoint.cli.simulate import find_start
    from coadjoint.errors import CoadjointError
    from coadjoint.solve.illustrate import illustrate

    try:
        loaded = load_system(system, seconds, sizes)
        return illustrate(loaded, find_start(loaded, ()), form)
    except CoadjointError:
        return {}
