"""Render, drift: a fresh tree of texts against the one on the disk.

Comes in: text by path, as a fresh run makes it, and the generated folder. Goes out: every
difference, missing and extra files included, which comparing known files alone would not see.
Read next: `coadjoint.pipeline`, which runs it for ``coadjoint regenerate --check``.
"""

from __future__ import annotations

import difflib
import hashlib
import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from coadjoint.files import read_regular
from coadjoint.render.ownership import LOCK, read_manifest

#: Files of the tree that are not output.
NOT_OURS: Final = frozenset({LOCK})


@dataclass(frozen=True)
class Difference:
    """One file that differs.

    Attributes:
        path: Path below the generated folder.
        kind: ``"missing"``, ``"extra"`` or ``"changed"``.
        diff: The first lines of a unified diff of a changed file, from the disk to the fresh text.
    """

    path: str
    kind: str
    diff: str = ""


def compare_tree(fresh: Mapping[str, str], folder: Path, lines: int = 12) -> list[Difference]:
    """Every difference between a fresh tree and the one on the disk, in the order of paths.

    Args:
        fresh: Text by path below ``folder``, the manifest included.
        folder: The generated folder.
        lines: How many lines of each diff to keep.
    """
    paths = {path.relative_to(folder).as_posix(): path for path in folder.rglob("*")}
    present = {name: path for name, path in paths.items() if _is_output(name, path)}
    differences = [Difference(name, "missing") for name in fresh.keys() - present.keys()]
    differences += [Difference(name, "extra") for name in present.keys() - fresh.keys()]
    for name in fresh.keys() & present.keys():
        if _content(present[name]) != fresh[name].encode():
            differences.append(
                Difference(name, "changed", _diff(name, present[name], fresh[name], lines))
            )
    return sorted(differences, key=lambda difference: difference.path)


def is_intact(folder: Path, name: str) -> bool:
    """Whether the files of a system are those of its entry in the manifest, no more and no fewer.

    Args:
        folder: The generated folder.
        name: The system.
    """
    entry = read_manifest(folder)["systems"].get(name, {"files": None})
    hashes = {
        path.name: hashlib.sha256(_content(path) or b"").hexdigest()
        for path in (folder / name).glob("*")
        if path.name != "__pycache__"
    }
    return bool(hashes == entry["files"])


def _content(path: Path) -> bytes | None:
    """The bytes of a regular file; None of anything else, and of what cannot be read."""
    try:
        return read_regular(path)
    except OSError:
        return None


def _is_output(name: str, path: Path) -> bool:
    """Whether a path counts: a file, and neither bytecode nor one of those that no run writes."""
    if name in NOT_OURS or "__pycache__" in Path(name).parts:
        return False
    return path.is_symlink() or not path.is_dir()


def _diff(name: str, path: Path, fresh: str, lines: int) -> str:
    """The first lines of a unified diff."""
    content = _content(path)
    if content is None:
        return "this is not a regular file that can be read"
    old = content.decode(errors="replace").splitlines()
    whole = difflib.unified_diff(
        old, fresh.splitlines(), f"on disk: {name}", f"fresh: {name}", "", "", 1, ""
    )
    return "\n".join(itertools.islice(whole, lines)) or "the line ends or the kind of file differ"
