"""Files: what stands on a disk, read without trust in what it is, and results written whole.

Comes in: a path. Goes out: the bytes of a regular file, or the JSON object in it. A named pipe, a
device, a folder, a link, a file without end and a text nested to any depth are each an `OSError` or
an empty object, never a program that hangs or ends with a fault of ours. A result replaces the file
of its name only once it is complete.
"""

from __future__ import annotations

import errno
import json
import os
import re
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Final

from coadjoint.errors import OutputError

#: Bytes of a file of ours at the most; the manifest of 50 systems has 35 000.
MOST_BYTES: Final = 64 * 1024**2


def read_regular(path: Path, most: int = MOST_BYTES) -> bytes:
    """The bytes of a regular file; links are not followed, and nothing is waited for.

    Raises:
        OSError: It cannot be read, is not a regular file, or has more than ``most`` bytes.
    """
    handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    with os.fdopen(handle, "rb") as file:
        if not stat.S_ISREG(os.fstat(handle).st_mode):
            raise OSError(errno.EINVAL, "not a regular file", str(path))
        content = file.read(most + 1)
    if len(content) > most:
        raise OSError(errno.EFBIG, f"more than {most} bytes", str(path))
    return content


#: What opening a path says where no regular file of ours stands.
_ABSENT: Final = frozenset(
    {errno.ENOENT, errno.ENOTDIR, errno.EINVAL, errno.ELOOP, errno.EISDIR, errno.ENXIO, errno.EFBIG}
)


def read_present(path: Path) -> bytes:
    """The bytes of a regular file; none if something else or nothing stands there.

    Raises:
        OSError: Something may stand there, and the system refuses to read it.
    """
    try:
        return read_regular(path)
    except OSError as error:
        if error.errno not in _ABSENT:
            raise
        return b""


def read_object(path: Path) -> dict[str, Any]:
    """The JSON object in a file; an empty one if none can be read."""
    with suppress(OSError):
        return parse_object(read_regular(path))
    return {}


def parse_object(content: bytes) -> dict[str, Any]:
    """The JSON object that bytes hold; an empty one if they hold none."""
    with suppress(ValueError, RecursionError):
        value = json.loads(content)
        if isinstance(value, dict):
            return value
    return {}


def read_certificate(path: Path) -> dict[str, Any]:
    """A certificate as a run writes it; what is not of its form is left out.

    Programs index what comes back, so each known key holds what it should: texts, tables of texts,
    and claims that have at least a statement, a verdict and a method.
    """
    certificate = read_object(path)
    for key in ("title", "source", "description"):
        if not isinstance(certificate.get(key), str):
            certificate.pop(key, None)
    for key in ("docs", "definitions", "observables", "constraints", "domain"):
        if not is_table_of_texts(certificate.get(key)):
            certificate.pop(key, None)
    for key in ("casimirs", "routes"):
        if not _is_list_of(certificate.get(key), str):
            certificate.pop(key, None)
    for key, needed in (
        ("claims", ("statement", "verdict", "method")),
        ("findings", ("statement", "method")),
        ("methods", ("name", "decides", "cost")),
    ):
        if not _is_list_of(certificate.get(key), dict) or not all(
            isinstance(entry.get(part), str) for entry in certificate[key] for part in needed
        ):
            certificate.pop(key, None)
    if not _is_list_of(certificate.get("motion"), dict) or not all(
        map(_is_motion, certificate["motion"])
    ):
        certificate.pop("motion", None)
    return certificate


#: Elements without a script, a link or an address, whatever their styles, and text between them.
_MATHML: Final = re.compile(
    r"<math>(?:</?m[a-z]+(?: (?!href|on|style)[a-z]+=\"[a-z0-9.-]*\"| style=\"[a-z0-9.:; -]*\")*/?>"
    r"|&(?:#x[0-9A-F]+|lt|gt|amp);|[^<>&])*</math>"
)


def _is_motion(section: Mapping[str, Any]) -> bool:
    """Whether a part of the equations of motion is words and formulas that a page can show."""
    formulas = [section.get("vectors"), section.get("lines")]
    return all(isinstance(section.get(key), str) for key in ("title", "law")) and all(
        _is_list_of(lines, dict)
        and all(
            is_table_of_texts(line)
            and {"text", "latex", "mathml"} <= line.keys()
            and _MATHML.fullmatch(line["mathml"])
            for line in lines or ()
        )
        for lines in formulas
    )


def is_table_of_texts(value: Any) -> bool:
    """Whether a JSON value is a table whose values are texts."""
    return isinstance(value, Mapping) and all(isinstance(entry, str) for entry in value.values())


def _is_list_of(value: Any, kind: type) -> bool:
    """Whether a JSON value is a list of one kind."""
    return isinstance(value, list) and all(isinstance(entry, kind) for entry in value)


def check_writable(path: Path) -> None:
    """A file can be written at a path, as far as that shows without writing it.

    Raises:
        OutputError: Its folder is missing or not writable, or the path is a folder.
    """
    folder, reason = path.resolve().parent, ""
    if path.is_dir():
        reason = "it is a folder. Name a file in it."
    elif _is_special(path):  # which is written in place
        reason = "" if os.access(path, os.W_OK) else "no permission. Choose another file."
    elif not folder.is_dir():
        reason = f"{folder} is not a folder. Create it, or choose another file."
    elif not os.access(folder, os.W_OK | os.X_OK):  # where it is replaced
        reason = f"no permission to write in {folder}. Choose another file."
    if reason:
        raise OutputError(f"{path}: cannot be written: {reason}", path=str(path))


@contextmanager
def write_whole(path: Path) -> Iterator[Path]:
    """A place to write a file, which is moved to its path at the end: whole or not at all.

    A link stays a link to what is replaced. A device or pipe is written in place.

    Raises:
        OutputError: It cannot be written; what stood there before is untouched.
    """
    check_writable(path)
    target = path.resolve()
    place = target.with_name(f".{target.stem}.{os.urandom(4).hex()}{target.suffix}")
    if _is_special(path):
        place = target = path
    try:
        yield place
        if place != target:
            place.replace(target)
    except OSError as error:
        raise OutputError(
            f"{path}: cannot be written: {error.strerror or error}. "
            "Choose another file, or free some space.",
            path=str(path),
        ) from error
    finally:
        if place != target:
            place.unlink(missing_ok=True)


def _is_special(path: Path) -> bool:
    """Whether a path is a device, pipe or socket, or names an open file; nothing replaces it."""
    if path.is_absolute() and path.parts[1:2] in (("dev",), ("proc",)):
        return path.exists()
    return path.exists() and not path.is_file() and not path.is_dir()
