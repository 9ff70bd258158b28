"""Command ``algebra``: what a Lie algebra is, and a proof of it.

Comes in: the name of an algebra, or a spec that declares one. Goes out: bracket table, Killing
signature, rank, Casimirs and the verdict on each claim, as text, as a LaTeX file or as JSON.
Read next: `coadjoint.prove.examination`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import click

from coadjoint import limits
from coadjoint.cli.arguments import is_path, shipped_names, spec_path
from coadjoint.cli.output import print_json, write_text


@click.command("algebra")
@click.argument("algebra", metavar="NAME|SPEC")
@click.option(
    "--format",
    "form",
    type=click.Choice(["text", "latex", "html", "json"]),
    default="text",
    show_default=True,
    help="latex is a complete file, html one self-contained page.",
)
@click.option(
    "--degree",
    type=click.IntRange(1, 12),
    default=4,
    show_default=True,
    help="Look for polynomial Casimirs up to this degree.",
)
@click.option(
    "--generators",
    type=click.IntRange(1, limits.GENERATORS),
    default=limits.EXAMINED_GENERATORS,
    show_default=True,
    help="Refuse an algebra of more generators.",
)
@click.option("--output", type=click.Path(path_type=Path), help="File to write instead.")
def command(algebra: str, form: str, degree: int, generators: int, output: Path | None) -> None:
    """Show the brackets, invariants and Casimirs of a Lie algebra, each proved.

    NAME is an algebra such as so(4), se(3) or sl(2,R); SPEC is a shipped system or the path of a
    spec, whose algebra with its advected quantities is shown.
    """
    from coadjoint.render.document import render_document
    from coadjoint.sandbox import run_bounded

    record = run_bounded(
        "coadjoint.cli.algebra:examination_record",
        {"algebra": algebra, "degree": degree, "generators": generators},
        seconds=limits.WORKER_SECONDS,
        memory=limits.WORKER_BYTES,
    )
    if form == "json" and output is None:
        print_json(record["record"])
        return
    text = _json(record) if form == "json" else render_document(record["document"], form)
    if output is None:
        click.echo(text, nl=False)
    else:
        write_text(output, text)


def _json(record: Mapping[str, Any]) -> str:
    import json

    return json.dumps(record["record"], indent=2) + "\n"


def examination_record(argument: Mapping[str, Any]) -> dict[str, Any]:
    """The examination of an algebra as plain JSON values; runs in a bounded child."""
    from coadjoint.prove.examination import examine

    algebra = _algebra(argument["algebra"], argument["generators"])
    found = examine(algebra, argument["degree"])
    return {"record": found.as_record(), "document": asdict(found.document())}


def _algebra(word: str, most: int) -> Any:
    """The algebra that a word means."""
    from coadjoint.algebra import algebra_by_name
    from coadjoint.derive import make_setting
    from coadjoint.derive.structure import momentum_algebra
    from coadjoint.errors import AlgebraError
    from coadjoint.spec import read_spec

    if not is_path(word) and word not in shipped_names():
        return algebra_by_name(word, most=most)
    spec = read_spec(spec_path(word))
    if spec.algebra is None:
        raise AlgebraError(
            f"{spec.path}: the system declares a bracket and no algebra; expected a table "
            f"[algebra]. `coadjoint prove {word}` examines the bracket.",
            found=word,
        )
    return momentum_algebra(make_setting(spec))
