"""Command ``list``: the systems, and what is known of each.

Comes in: a folder of specs and the generated folder next to it. Goes out: a table. Nothing is
derived and nothing generated is run: what was proved is read from the certificates, and the specs
are read in a bounded child.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import click

from coadjoint.cli.arguments import seconds_option
from coadjoint.cli.output import json_option, print_json, print_table
from coadjoint.cli.regenerate import add_folder_options, folders, proved_cell, spec_paths
from coadjoint.errors import CoadjointError
from coadjoint.files import read_certificate


@dataclass(frozen=True)
class Entry:
    """One system of the list.

    Attributes:
        system: Its name.
        dimension: Number of state components; 0 if the spec cannot be read.
        routes: Its routes, the emitted one first.
        title: Free text of the spec.
        proved: Claims proved.
        supported: Claims that are numerically supported and not proved.
        claims: Claims in all.
        state: ``verified``, ``spec changed``, ``files changed``, ``not generated`` or ``spec
            unreadable``.
    """

    system: str
    dimension: int
    routes: tuple[str, ...]
    title: str
    proved: int
    supported: int
    claims: int
    state: str


@click.command("list")
@add_folder_options
@seconds_option
@json_option
def command(
    derivations: Path | None, output: Path | None, seconds: int | None, as_json: bool
) -> None:
    """List systems, claims proved and the state of their files."""
    from coadjoint.bounded import read_all_bounded

    source, target = folders(derivations, output)
    paths = spec_paths(source)
    declared = read_all_bounded([str(path) for path in paths], seconds=seconds)
    entries = [_entry(path, target, each) for path, each in zip(paths, declared, strict=True)]
    if as_json:
        print_json([asdict(entry) for entry in entries])
        return
    print_table(
        ("system", ">dim", "routes", "title", ">proved", "state"),
        [
            (
                entry.system,
                str(entry.dimension or "?"),
                ", ".join(entry.routes),
                entry.title,
                proved_cell(entry.proved, entry.supported, entry.claims),
                entry.state,
            )
            for entry in entries
        ],
    )


def _entry(path: Path, output: Path, declared: Mapping[str, Any] | CoadjointError) -> Entry:
    """What is known of one system."""
    certificate = read_certificate(output / path.stem / "certificate.json")
    verdicts = [claim["verdict"] for claim in certificate.get("claims", [])]
    entry = Entry(
        system=path.stem,
        dimension=0,
        routes=(),
        title="",
        proved=verdicts.count("proved"),
        supported=verdicts.count("numerically supported"),
        claims=len(verdicts),
        state="spec unreadable",
    )
    if isinstance(declared, CoadjointError):
        return entry
    return replace(
        entry,
        system=declared["name"],
        dimension=len(declared["state"]),
        routes=tuple(declared["routes"]),
        title=declared["title"],
        state=_state(path, output, declared["sha256"]),
    )


def _state(path: Path, output: Path, sha256: str) -> str:
    """How the generated files stand to the spec and to the manifest."""
    from coadjoint.render.compare import is_intact
    from coadjoint.render.ownership import read_manifest

    entry = read_manifest(output)["systems"].get(path.stem)
    if entry is None:
        return "not generated"
    if entry["spec_sha256"] != sha256:
        return "spec changed"
    return "verified" if is_intact(output, path.stem) else "files changed"
