"""The cache: a private folder of compiled kernels by content, each checked whenever it is loaded.

Comes in: the key of a kernel and the bytes of its object. Goes out: the path of an object whose
hash has been checked. Any damage is a miss. Another process of the same user is trusted, as
everywhere; other users are not. Read next: `coadjoint.build.library`, which fills it.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import secrets
import shutil
import stat
import tempfile
import warnings
from contextlib import suppress
from functools import cache
from pathlib import Path

from coadjoint.errors import OutputError


class CacheWarning(UserWarning):
    """The cache cannot be used, so kernels are compiled anew in each process."""


def cache_folder() -> Path:
    """The private cache folder, made if missing.

    ``COADJOINT_CACHE``, else ``XDG_CACHE_HOME/coadjoint``, else ``~/.cache/coadjoint``. Where that
    cannot be used, a temporary folder of this process, with a `CacheWarning`.
    """
    chosen = os.environ.get("COADJOINT_CACHE", "")
    if chosen:
        return _usable(Path(chosen))
    home = os.environ.get("XDG_CACHE_HOME", "")
    return _usable((Path(home) if home else Path.home() / ".cache") / "coadjoint")


@cache
def _usable(folder: Path) -> Path:
    """The folder, or a temporary one in its stead."""
    try:
        check_private(folder)
    except OutputError as error:
        temporary = Path(tempfile.mkdtemp(prefix="coadjoint-cache-"))
        atexit.register(shutil.rmtree, temporary, ignore_errors=True)
        warnings.warn(
            f"{error} Kernels are compiled anew in this process.", CacheWarning, stacklevel=3
        )
        return temporary
    return folder


def check_private(folder: Path) -> None:
    """Make a folder that only this user can write, or find that it is one.

    Raises:
        OutputError: It is a link, belongs to another user, others may write, or it cannot be made.
    """
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        found = folder.lstat()
    except OSError as error:
        raise OutputError(
            f"the cache folder {folder} cannot be used: {error.strerror}. "
            "Set COADJOINT_CACHE to a folder of your own.",
            path=str(folder),
        ) from error
    problem = ""
    if not stat.S_ISDIR(found.st_mode):
        problem = "it is not a real folder"
    elif found.st_uid != os.getuid():
        problem = f"it belongs to user {found.st_uid}"
    elif found.st_mode & 0o022:
        problem = f"others may write to it (mode {stat.S_IMODE(found.st_mode):o})"
    if problem:
        raise OutputError(
            f"the cache folder {folder} is refused: {problem}. "
            f"Run `chmod 700 {folder}`, or set COADJOINT_CACHE to a folder of your own.",
            path=str(folder),
            found=problem,
        )


def fetch(key: str) -> Path | None:
    """The object of a key, if it is there and whole; None otherwise.

    Args:
        key: Hash of all that the object depends on.
    """
    folder = cache_folder() / "kernels"
    with suppress(OSError, UnicodeDecodeError):
        digest = _read(folder / key).decode("ascii").strip()
        path = folder / f"{digest}.so"
        if digest.isalnum() and hashlib.sha256(_read(path)).hexdigest() == digest:
            return path
    return None


def store(key: str, content: bytes) -> Path:
    """Keep an object under a key; the path of the object.

    An object's file is named by its own hash: the loader of the system takes two files of one path
    for one library, so a rebuilt kernel must not reuse the name of another.

    Raises:
        OutputError: It cannot be written.
    """
    folder = cache_folder() / "kernels"
    digest = hashlib.sha256(content).hexdigest()
    try:
        replace_file(folder / f"{digest}.so", content)
        replace_file(folder / key, digest.encode("ascii"))
    except OSError as error:
        raise OutputError(
            f"{folder} could not be written: {error.strerror}. Free some space, or set "
            "COADJOINT_CACHE to another folder.",
            path=str(folder),
        ) from error
    return folder / f"{digest}.so"


def _read(path: Path) -> bytes:
    """The bytes of a regular file of this user; links are not followed."""
    handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    with os.fdopen(handle, "rb") as file:
        found = os.fstat(handle)
        if not stat.S_ISREG(found.st_mode) or found.st_uid != os.getuid():
            raise OSError(f"{path} is not a regular file of this user")
        return file.read()


def replace_file(path: Path, content: bytes) -> None:
    """Write a file of the cache so that it is old or new and never torn; its folder is made."""
    path.parent.mkdir(mode=0o700, exist_ok=True)
    temporary = path.with_name(f".{secrets.token_hex(8)}.tmp")
    handle = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o600)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    finally:
        with suppress(FileNotFoundError):
            temporary.unlink()
