"""Upkeep of the cache: its bound, and what is wrong with it.

Comes in: the folder of the cache. Goes out: a folder within its bound, or a list of problems for
people. Read next: `coadjoint.build.cache`, which calls `evict` after new objects.
"""

from __future__ import annotations

import hashlib
import os
import re
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from coadjoint.build.workplace import list_abandoned, remove
from coadjoint.limits import CACHE_BYTES

#: Folders of the cache: objects by key, what was verified, systems of users, versions of compilers,
#: work in progress.
KERNELS, VERIFIED, SYSTEMS, COMPILERS, WORK = "kernels", "verified", "systems", "compilers", "work"
FOLDERS = (KERNELS, VERIFIED, SYSTEMS, COMPILERS, WORK)
#: Names of what runs keep in each; anything else is somebody's, and is never removed.
_OURS = {
    KERNELS: re.compile(r"[0-9a-f]{64}(\.so)?"),
    VERIFIED: re.compile(r"[0-9a-f]{64}\.json"),
    SYSTEMS: re.compile(r"[0-9a-f]{16}"),
    COMPILERS: re.compile(r"[0-9a-f]{64}\.json"),
}
#: Seconds for which a system of a user stays, whatever the bound: a program may be reading it.
IN_USE = 24 * 3600
#: What a file takes on a disk, at the least.
PAGE = 4096


@dataclass(frozen=True)
class _Entry:
    """Something that can be removed by itself.

    Attributes:
        path: Of a file, or of the folder of a system.
        size: Bytes on the disk, about.
        used: When it was written or used last.
    """

    path: str
    size: int
    used: float


def evict(folder: Path, most: int = CACHE_BYTES) -> None:
    """Remove what was not used for longest until the cache is within its bound.

    Args:
        folder: The cache.
        most: Its bound in bytes.
    """
    entries = sorted(_entries(folder), key=lambda entry: entry.used)
    total = sum(entry.size for entry in entries)
    for entry in entries:
        if total <= most:
            return
        path, fresh = Path(entry.path), entry.used > time.time() - IN_USE
        if path.parent.name == SYSTEMS and fresh:
            continue
        with suppress(OSError):
            remove(path)
            total -= entry.size


def _entries(folder: Path) -> Iterator[_Entry]:
    """Everything that may be evicted."""
    for name in _OURS:
        for kept in _scan(folder / name):
            with suppress(OSError):
                yield _entry(kept)


def list_kept(folder: Path) -> list[Path]:
    """What runs keep in a folder of the cache, by its name."""
    return sorted(Path(kept.path) for kept in _scan(folder))


def _scan(folder: Path) -> list[os.DirEntry[str]]:
    """The same as the system lists it: each new object asks for thousands, and paths are slow."""
    with suppress(OSError), os.scandir(folder) as found:
        return [each for each in found if _OURS[folder.name].fullmatch(each.name)]
    return []


def _entry(kept: os.DirEntry[str]) -> _Entry:
    """A file, or a folder with all that is in it."""
    parts = [kept.stat(follow_symlinks=False)]
    if kept.is_dir(follow_symlinks=False):
        parts += [inner.lstat() for inner in Path(kept.path).rglob("*")]
    size = sum(-(-each.st_size // PAGE) * PAGE for each in parts)
    return _Entry(kept.path, size, max(each.st_mtime for each in parts))


def find_problems(folder: Path) -> list[str]:
    """What is wrong with a cache, a sentence each; nothing is changed.

    All of it is harmless: what is damaged is compiled anew, and what killed runs left is removed
    when the cache is used next.

    Args:
        folder: The cache, which need not exist.
    """
    problems = [f"{path} was left behind by a killed run" for path in list_abandoned(folder / WORK)]
    for name in (KERNELS, VERIFIED, COMPILERS):
        for path in list_kept(folder / name):
            problems += _problem(path)
    total = sum(entry.size for entry in _entries(folder))
    if total > CACHE_BYTES:
        problems.append(
            f"{folder} takes {total // 2**20} MiB, more than its bound of {CACHE_BYTES // 2**20}"
        )
    return problems


def _problem(path: Path) -> list[str]:
    """What is wrong with one file of the cache."""
    if path.is_symlink() or not path.is_file():
        return [f"{path} is not a file"]
    if path.suffix == ".so":
        try:
            content = path.read_bytes()
        except OSError as error:
            return [f"{path} cannot be read: {error.strerror}"]
        if hashlib.sha256(content).hexdigest() != path.stem:
            return [f"{path} is damaged"]
    return []
