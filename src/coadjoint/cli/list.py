"""Command ``list``: the systems, and what is known of each.

Comes in: a folder of specs and the generated folder beside it. Goes out: a table. Nothing is
derived and nothing generated is run: what was proved is read from the certificates.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from hashlib import sha256
from pathlib import Path

import click

from coadjoint.cli.output import json_option, print_json, print_table
from coadjoint.cli.regenerate import folders, proved_cell, spec_paths, with_folders
from coadjoint.errors import CoadjointError


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
@with_folders
@json_option
def command(derivations: Path | None, output: Path | None, as_json: bool) -> None:
    """List systems and the state of their certificates."""
    source, target = folders(derivations, output)
    entries = [_entry(path, target) for path in spec_paths(source)]
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


def _entry(path: Path, output: Path) -> Entry:
    """What is known of one system."""
    from coadjoint.spec import read_spec

    certificate = _certificate(output / path.stem / "certificate.json")
    verdicts = [claim["verdict"] for claim in certificate.get("claims", [])]
    counts = verdicts.count("proved"), verdicts.count("numerically supported"), len(verdicts)
    try:
        spec = read_spec(path)
    except CoadjointError:
        return Entry(path.stem, 0, (), "", *counts, "spec unreadable")
    dimension = sum(len(variable.components) for variable in spec.state)
    state = _state(path, output)
    return Entry(spec.name, dimension, spec.routes, spec.title, *counts, state)


def _state(path: Path, output: Path) -> str:
    """How the generated files stand to the spec and to the manifest."""
    from coadjoint.render.compare import is_intact
    from coadjoint.render.write import read_manifest

    entry = read_manifest(output)["systems"].get(path.stem)
    if entry is None:
        return "not generated"
    if entry["spec_sha256"] != sha256(path.read_bytes()).hexdigest():
        return "spec changed"
    return "verified" if is_intact(output, path.stem) else "files changed"


def _certificate(path: Path) -> dict[str, list[dict[str, str]]]:
    """A certificate as it stands in its file; empty if it is missing or damaged."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}
