"""Workplaces: files and folders that exist only while a run uses them, whatever happens to it.

Comes in: a folder to work in. Goes out: a temporary file or folder that is locked as long as its
process lives. A process that is killed leaves it behind without a lock, and the next run removes
it: `sweep` takes what nobody holds. Read next: `coadjoint.build.cache`.
"""

from __future__ import annotations

import fcntl
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

#: What the name of each of them begins with, so that nothing else is ever swept.
PREFIX = "coadjoint-work-"


@contextmanager
def work_file(base: Path) -> Iterator[tuple[Path, int]]:
    """A new file, open for writing, that is gone at the end unless it was renamed.

    Raises:
        OSError: It cannot be made.
    """
    path, handle = _make_and_lock(base, folder=False)
    try:
        yield path, handle
    finally:
        with suppress(OSError):
            path.unlink()
        os.close(handle)


@contextmanager
def work_folder(base: Path) -> Iterator[Path]:
    """A new private folder that is gone at the end.

    Raises:
        OSError: It cannot be made.
    """
    path, handle = _make_and_lock(base, folder=True)
    try:
        yield path
    finally:
        shutil.rmtree(path, ignore_errors=True)
        os.close(handle)


def keep_folder(base: Path) -> Path:
    """A new private folder that stays until this process ends, and may be swept then.

    Raises:
        OSError: It cannot be made.
    """
    return _make_and_lock(base, folder=True)[0]  # the lock ends with the process


def list_abandoned(base: Path) -> list[Path]:
    """What runs that were killed have left in a folder."""
    return [path for path in _candidates(base) if _is_free(path)]


def sweep(base: Path) -> None:
    """Remove what runs that were killed have left in a folder."""
    for path in _candidates(base):
        with suppress(OSError):
            handle = _lock(path)
            if handle is not None:
                remove(path)  # nobody else can take it: the lock is ours
                os.close(handle)


def remove(path: Path) -> None:
    """Remove a file, a link, or a folder with all that is in it.

    Raises:
        OSError: It cannot be removed.
    """
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _candidates(base: Path) -> list[Path]:
    """Files and folders of this user that were made here."""
    paths = []
    with suppress(OSError), os.scandir(base) as entries:
        for entry in entries:
            if entry.name.startswith(PREFIX) and not entry.is_symlink():
                with suppress(OSError):
                    if entry.stat(follow_symlinks=False).st_uid == os.getuid():
                        paths.append(Path(entry.path))
    return paths


def _is_free(path: Path) -> bool:
    with suppress(OSError):
        handle = _lock(path)
        if handle is not None:
            os.close(handle)
            return True
    return False


def _make_and_lock(base: Path, *, folder: bool) -> tuple[Path, int]:
    """A new file or folder and its lock; a sweep may take it before it is locked, without loss."""
    while True:
        path = base / f"{PREFIX}{os.urandom(8).hex()}"
        if folder:
            path.mkdir(mode=0o700)
        else:
            os.close(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o600))
        with suppress(FileNotFoundError):
            handle = _lock(path)
            if handle is not None:
                return path, handle


def _lock(path: Path) -> int | None:
    """A handle that holds the lock of a path, or None if another process does.

    Raises:
        OSError: It is gone, or the file system knows no locks.
    """
    kind = os.O_RDONLY | os.O_DIRECTORY if path.is_dir() else os.O_WRONLY
    handle = os.open(path, kind | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if os.path.samestat(os.fstat(handle), path.lstat()):
            return handle
    except BlockingIOError:
        pass
    except OSError:
        os.close(handle)
        raise
    os.close(handle)
    return None
