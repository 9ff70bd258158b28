"""Render, health: what is wrong with a generated tree, for people who ask.

Comes in: a generated folder. Goes out: problems with what to do about each; nothing is changed.
Read next: `coadjoint.cli.doctor`, which shows them.
"""

from __future__ import annotations

import fcntl
import os
import stat
from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from coadjoint.errors import OutputError
from coadjoint.files import read_certificate, read_object, read_present
from coadjoint.render.compare import is_intact
from coadjoint.render.ownership import (
    LOCK,
    MANIFEST,
    PACKAGE,
    is_manifest,
    is_marked,
    list_leftovers,
    make_plan,
)
from coadjoint.spec.core.faults import list_names

_AGAIN: Final = "coadjoint regenerate"


@dataclass(frozen=True)
class Problem:
    """One thing that is not as a run leaves it.

    Attributes:
        found: What it is, with its path.
        remedy: What to do.
        heals: Whether the next run mends it without being told.
        regenerates: Whether regenerating the systems mends it.
    """

    found: str
    remedy: str
    heals: bool = False
    regenerates: bool = False


def tree_problems(folder: Path, *, is_shipped: bool = False) -> Iterator[Problem]:
    """Everything that is wrong with a generated tree.

    Args:
        folder: The tree.
        is_shipped: Whether it may be part of an installed package, which no run writes to.

    Raises:
        OSError: It cannot be read.
    """
    if not folder.is_dir():
        yield Problem(f"{folder} is not there", _AGAIN, regenerates=True)
        return
    manifest = read_object(folder / MANIFEST)
    if not is_manifest(manifest):
        what = "is damaged" if os.path.lexists(folder / MANIFEST) else "is missing"
        yield Problem(f"{folder / MANIFEST} {what}", _AGAIN, regenerates=True)
        manifest = {"systems": {}}
    for name, text in PACKAGE.items():
        if read_present(folder / name) != text.encode():
            yield Problem(f"{folder / name} is missing or was changed", _AGAIN, regenerates=True)
    changed = [name for name in manifest["systems"] if not is_intact(folder, name)]
    if changed:
        lost = f"{folder}: files of {list_names(changed, 8)} are missing or changed"
        yield Problem(lost, _AGAIN, regenerates=True)
    for name in changed:
        certificate = folder / name / "certificate.json"
        if "claims" not in read_certificate(certificate):
            lost = f"{certificate} is missing or damaged"
            yield Problem(lost, f"{_AGAIN} {name}", regenerates=True)
    if not is_shipped:
        files = {name: list(entry["files"]) for name, entry in manifest["systems"].items()}
        yield from _list_obstacles(folder, files)
    yield from _list_unlisted(folder, manifest["systems"])
    for path in list_leftovers(folder):
        yield Problem(f"{path} was left behind by a killed run", "the next run removes it", True)
    yield from _lock(folder / LOCK)


def _list_obstacles(folder: Path, files: Mapping[str, Collection[str]]) -> Iterator[Problem]:
    """What a run would refuse, and a folder that cannot be written."""
    if not os.access(folder, os.W_OK | os.X_OK):
        yield Problem(f"{folder} cannot be written", "check its permissions")
    try:
        make_plan(folder, files)
    except OutputError as error:
        strange = error.parts.get("found")
        found = f"{folder}: {list_names(strange, 8)}" if isinstance(strange, list) else str(error)
        yield Problem(f"{found}: no run wrote this", "move it away")


def _list_unlisted(folder: Path, systems: Collection[str]) -> Iterator[Problem]:
    """Folders that a run wrote and the manifest does not know."""
    for path in sorted(folder.iterdir()):
        if path.name not in systems and not path.is_symlink() and path.is_dir() and is_marked(path):
            yield Problem(
                f"{path} contains a system that {MANIFEST} does not list",
                f"{_AGAIN} {path.name}, or remove the folder",
                regenerates=True,
            )


def _lock(path: Path) -> Iterator[Problem]:
    """A lock that another run holds, or that can be no lock."""
    with suppress(FileNotFoundError):
        if not stat.S_ISREG(path.lstat().st_mode):
            yield Problem(f"{path} is not a file", "remove it")
            return
        with path.open("rb") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
            except BlockingIOError:
                yield Problem(f"{path} is held: another run is at work", "wait for it", True)
