"""Files: the bytes of a spec file, with nothing else opened by mistake.

Comes in: a path. Goes out: its bytes, or an error about the file as a whole.
Read next: `coadjoint.spec.reader`.
"""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path

from coadjoint.errors import CoadjointError, LimitError, SpecError
from coadjoint.limits import SPEC_BYTES
from coadjoint.spec.core.faults import did_you_mean


def read_file(path: str) -> bytes:
    """The bytes of a regular file, never waiting for a pipe and never more than the limit."""
    try:
        # Not following a link, so that the file that was checked is the file that is read; not
        # blocking, because opening a pipe would wait for a writer.
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_NOFOLLOW | os.O_CLOEXEC)
    except (OSError, ValueError) as error:
        raise _not_opened(path, error) from None
    try:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode):
            kind = _kind(status.st_mode)
            raise file_fault(path, f"this is {kind}", "a regular file", found=kind)
        check_bytes(path, status.st_size)
        with os.fdopen(os.dup(descriptor), "rb") as file:
            data = file.read(SPEC_BYTES + 1)  # it may have grown since
    except OSError as error:
        raise _not_opened(path, error) from None
    finally:
        os.close(descriptor)
    check_bytes(path, len(data))
    if not data.strip():
        raise file_fault(
            path,
            "the file is empty",
            "a spec",
            "Write one with: coadjoint new NAME.",
            found="",
        )
    return data


def _not_opened(path: str, error: OSError | ValueError) -> CoadjointError:
    """Why a file could not be opened, and which one may have been meant."""
    number = error.errno if isinstance(error, OSError) else None
    if number == errno.ELOOP and Path(path).is_symlink():
        target = str(Path(path).readlink())
        hint = f"Give the file that it points to: {target}."
        return file_fault(path, "this is a symbolic link", "a regular file", hint, found=target)
    if number == errno.ENOENT:
        beside = [str(p) for p in Path(path).parent.glob("*.toml")]
        hint = did_you_mean(path, beside)
        return file_fault(path, "there is no such file", "a spec in TOML", hint, found=path)
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return file_fault(
        path, f"cannot be read: {reason}", "a readable regular file", found=str(reason)
    )


def _kind(mode: int) -> str:
    """What a path is if not a regular file."""
    kinds = (
        (stat.S_ISDIR, "a directory"),
        (stat.S_ISFIFO, "a named pipe (FIFO)"),
        (stat.S_ISSOCK, "a socket"),
    )
    return next((name for is_kind, name in kinds if is_kind(mode)), "a device")


def check_bytes(path: str, size: int) -> None:
    """Refuse a file that is too large.

    Raises:
        LimitError: It is.
    """
    if size > SPEC_BYTES:
        raise file_fault(
            path,
            f"the file has {size} bytes",
            f"at most {SPEC_BYTES} (SPEC_BYTES)",
            found=size,
            kind=LimitError,
        )


def file_fault(
    path: str,
    problem: str,
    expected: str,
    hint: str = "",
    *,
    found: object,
    kind: type[CoadjointError] = SpecError,
) -> CoadjointError:
    """An error about a file as a whole."""
    return kind(
        f"{path}: {problem}; expected {expected}. {hint}".rstrip(),
        path=path,
        line=0,
        column=0,
        key="",
        found=found,
        expected=expected,
        hint=hint,
    )
