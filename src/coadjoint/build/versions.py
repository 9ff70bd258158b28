"""Versions of compilers, kept in the cache: to ask takes longer than to load a kernel.

Comes in: the command of a compiler. Goes out: what it said when it was asked, as long as its files
are those of then. Read next: `coadjoint.build.compiler`, which asks.
"""

from __future__ import annotations

import hashlib
import json
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path

from coadjoint.build.cache import cache_folder, read_own, replace_file
from coadjoint.build.upkeep import COMPILERS
from coadjoint.errors import OutputError

#: The first line of a version, and whether the compiler is GCC.
Version = tuple[str, bool]


def recall_version(command: tuple[str, ...]) -> Version | None:
    """What a compiler said before; None if it is another one now, or was not asked."""
    with suppress(OSError, OutputError, ValueError, KeyError, TypeError):
        known = json.loads(read_own(_place(command)))
        version, is_gnu = known["version"], known["is_gnu"]
        if isinstance(version, str) and isinstance(is_gnu, bool):
            return version, is_gnu
    return None


def keep_version(command: tuple[str, ...], version: Version) -> None:
    """Keep what a compiler said, if that is possible."""
    with suppress(OSError, OutputError):
        content = json.dumps({"version": version[0], "is_gnu": version[1]})
        replace_file(_place(command), content.encode())


def _place(command: tuple[str, ...]) -> Path:
    """The file of a compiler; another one as soon as its own files change.

    Raises:
        OSError: It has none.
    """
    files = [Path(command[0]), *(_package(name) for name in command[1:] if name == "ziglang")]
    marks = []
    for file in files:
        status = file.stat()
        marks += [str(file.resolve()), status.st_ino, status.st_size]
        marks += [status.st_mtime_ns, status.st_ctime_ns]
    name = hashlib.sha256(json.dumps([command, marks]).encode()).hexdigest()
    return cache_folder() / COMPILERS / f"{name}.json"


def _package(name: str) -> Path:
    """The first file of a package.

    Raises:
        OSError: It has none.
    """
    spec = find_spec(name)
    if spec is None or spec.origin is None:
        raise FileNotFoundError(name)
    return Path(spec.origin)
