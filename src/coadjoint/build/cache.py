"""The cache: a private folder of compiled kernels by content, each checked whenever it is loaded.

Comes in: the key of a kernel and the bytes of its object. Goes out: the path of an object whose
hash has been checked. Any damage is a miss, and is replaced. What was not used for longest is
removed where the cache grows beyond its bound, and what killed runs left when it is used next.
Another process of the same user is trusted, as everywhere; other users are not. Read next:
`coadjoint.build.library`, which fills it, and `coadjoint.build.upkeep`.
"""

from __future__ import annotations

import atexit
import errno
import hashlib
import os
import shutil
import stat
import tempfile
import warnings
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from pathlib import Path

from coadjoint.build.upkeep import FOLDERS, KERNELS, WORK, evict, find_problems
from coadjoint.build.workplace import keep_folder, remove, sweep, work_file, work_folder
from coadjoint.errors import OutputError
from coadjoint.limits import CACHE_BYTES

#: Bytes that a process adds before it looks at the bound again: to look at thousands of objects
#: takes longer than to keep one.
UNSEEN = CACHE_BYTES // 64
_unseen = [UNSEEN]  # the first object of a process looks


class CacheWarning(UserWarning):
    """The cache cannot be used, so kernels are compiled anew in each process."""


def cache_folder() -> Path:
    """The private cache folder, made if missing; what killed runs left there is removed.

    ``COADJOINT_CACHE``, else ``XDG_CACHE_HOME/coadjoint``, else ``~/.cache/coadjoint``. Where that
    cannot be used, a temporary folder of this process, with a `CacheWarning`.

    Raises:
        OutputError: No temporary folder can be made either.
    """
    return _make_usable(chosen_folder())


def chosen_folder() -> Path | None:
    """Where the cache is to be, by the environment; None where there is no home."""
    chosen = os.environ.get("COADJOINT_CACHE", "")
    if chosen:
        return Path(chosen)
    home = os.environ.get("XDG_CACHE_HOME", "")
    with suppress(RuntimeError):  # no HOME, and a user whom the system does not know
        return (Path(home) if home else Path.home() / ".cache") / "coadjoint"
    return None


@cache
def _make_usable(folder: Path | None) -> Path:
    """The folder, or a temporary one in its stead."""
    try:
        if folder is None:
            raise OutputError(
                "no home folder is set, so there is no place for the cache. Set HOME, or set "
                "COADJOINT_CACHE to a folder that you own."
            )
        check_private(folder)
    except OutputError as error:
        temporary = _make_temporary(error)
        warnings.warn(
            f"{error} Kernels are compiled again in this process.", CacheWarning, stacklevel=3
        )
        return temporary
    sweep(folder / WORK)
    return folder


def _make_temporary(reason: OutputError) -> Path:
    """A cache for this process alone.

    Raises:
        OutputError: It cannot be made.
    """
    try:
        base = Path(tempfile.gettempdir())
        sweep(base)
        folder = keep_folder(base)
    except OSError as error:
        raise OutputError(
            f"{reason} No temporary folder can be written either: {error.strerror or error}.",
            **reason.parts,
        ) from error
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


@contextmanager
def working_folder() -> Iterator[Path]:
    """A private folder for the length of a block, in the cache or else among temporary files.

    One whose process is killed is removed when the cache is used next.

    Raises:
        OutputError: None can be written.
    """
    with ExitStack() as stack:
        yield enter_working_folder(stack)


def enter_working_folder(stack: ExitStack) -> Path:
    """A working folder that a stack removes at its end."""
    with suppress(OSError, OutputError):
        base = cache_folder() / WORK
        _make_folder(base)
        return stack.enter_context(work_folder(base))
    try:
        base = Path(tempfile.gettempdir())
        sweep(base)
        return stack.enter_context(work_folder(base))
    except OSError as error:
        raise OutputError(
            f"no temporary folder can be written: {error.strerror or error}. Free some space, or "
            "set TMPDIR to a folder that you can write to."
        ) from error


def check_private(folder: Path) -> None:
    """Make a folder that only this user can write, or find that it is one.

    Raises:
        OutputError: It is a link, belongs to another user, others may write, or it cannot be made.
    """
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        problem = _refusal(folder)
    except OSError as error:
        raise OutputError(
            f"the cache folder {folder} cannot be used: {error.strerror}. "
            "Set COADJOINT_CACHE to a folder that you own.",
            path=str(folder),
        ) from error
    if problem:
        raise OutputError(
            f"the cache folder {folder} is refused: {problem}. Set COADJOINT_CACHE to a folder of "
            "your own.",
            path=str(folder),
            found=problem,
        )


def _refusal(folder: Path) -> str:
    """Why a folder cannot be the cache, or "".

    Raises:
        OSError: It cannot be looked at.
    """
    status = folder.lstat()
    if not stat.S_ISDIR(status.st_mode):
        return "it is not a real folder"
    if status.st_uid != os.getuid():
        return f"it belongs to user {status.st_uid}"
    if status.st_mode & 0o022:
        mode = f"{stat.S_IMODE(status.st_mode):o}"
        return f"other users may write to it (mode {mode}), run `chmod 700 {folder}`"
    for name in FOLDERS:
        if os.path.lexists(folder / name) and not stat.S_ISDIR((folder / name).lstat().st_mode):
            return f"no run of coadjoint made {name!r}, which stands in it"
    return ""


def cache_problems() -> list[str]:
    """What the next run mends in the cache, a sentence each; nothing is made or changed here.

    Damaged objects are compiled anew, and what killed runs left is removed. A cache that cannot be
    used at all is a matter of `cache_folder`.
    """
    folder = chosen_folder()
    with suppress(OSError):
        if folder is not None and not _refusal(folder):
            return find_problems(folder)
    return []


def fetch(key: str) -> Path | None:
    """The object of a key, if it is there and whole; None otherwise.

    Args:
        key: Hash of all that the object depends on.
    """
    with suppress(OSError, OutputError, UnicodeDecodeError):
        folder = cache_folder() / KERNELS
        digest = read_own(folder / key).decode("ascii").strip()
        path = folder / f"{digest}.so"
        if digest.isalnum() and hashlib.sha256(read_own(path)).hexdigest() == digest:
            note_use(folder / key)
            note_use(path)
            return path
    return None


def note_use(path: Path) -> None:
    """Make something in the cache the last to be evicted."""
    with suppress(OSError):
        os.utime(path)


def store(key: str, content: bytes) -> Path:
    """Keep an object under a key; the path of the object.

    An object's file is named by its own hash: the loader of the system takes two files of one path
    for one library, so a rebuilt kernel must not reuse the name of another.

    Raises:
        OutputError: It cannot be written.
    """
    cache = cache_folder()
    folder, digest = cache / KERNELS, hashlib.sha256(content).hexdigest()
    try:
        replace_file(folder / f"{digest}.so", content)
        replace_file(folder / key, digest.encode("ascii"))
    except OSError as error:
        raise OutputError(
            f"{folder} could not be written: {error.strerror}. Free some space, or set "
            "COADJOINT_CACHE to another folder.",
            path=str(folder),
        ) from error
    _unseen.append(len(content))
    if sum(_unseen) > UNSEEN:
        evict(cache)
        _unseen.clear()
    return folder / f"{digest}.so"


def read_own(path: Path) -> bytes:
    """The bytes of a regular file of this user; links are not followed.

    Raises:
        OSError: It is not such a file, or cannot be read.
    """
    handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    with os.fdopen(handle, "rb") as file:
        status = os.fstat(handle)
        if not stat.S_ISREG(status.st_mode) or status.st_uid != os.getuid():
            raise OSError(f"{path} is not a regular file of this user")
        return file.read()


def replace_file(path: Path, content: bytes) -> None:
    """Write a file of the cache so that it is old or new and never torn; its folder is made.

    Args:
        path: A file in a folder of the cache, by a name that only files of ours have.
        content: Its bytes.

    Raises:
        OSError: It cannot be written.
    """
    work = path.parent.parent / WORK
    for folder in (path.parent, work):
        _make_folder(folder)
    with work_file(work) as (temporary, handle):
        with os.fdopen(handle, "wb", closefd=False) as file:
            file.write(content)
            file.flush()
            os.fsync(handle)
        if path.is_dir() and not path.is_symlink():
            remove(path)  # a folder that stands where a file belongs
        temporary.replace(path)


def _make_folder(folder: Path) -> None:
    """A folder of the cache; what else stands in its place is somebody's, and stays.

    Raises:
        OSError: It is not a folder, or a link to one.
    """
    folder.mkdir(mode=0o700, exist_ok=True)
    if folder.is_symlink():
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder))
