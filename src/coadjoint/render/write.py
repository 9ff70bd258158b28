"""Render, writing: texts reach the disk so that each file is old or new, and never torn.

Comes in: all texts of all systems, computed before anything is written. Goes out: a folder per
system and ``manifest.json``, written last. A killed or failed run leaves whole files; where it
leaves old ones next to new ones, their ids and the manifest tell, and the next run heals the tree.
What no run wrote is never touched: see `coadjoint.render.ownership`. Read next:
`coadjoint.render.compare`.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import re
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from coadjoint.errors import OutputError, remedy_for
from coadjoint.render.ownership import (
    LOCK,
    MANIFEST,
    MARK,
    PACKAGE,
    SCHEMA,
    TEMPORARY,
    Plan,
    list_leftovers,
    make_plan,
    read_manifest,
    refuse_installed,
)
from coadjoint.render.targets import TARGETS

__all__ = [
    "LOCK",
    "MANIFEST",
    "MARK",
    "PACKAGE",
    "SYSTEM_FILES",
    "TEMPORARY",
    "GeneratedSystem",
    "lock",
    "manifest_text",
    "read_manifest",
    "tree_texts",
    "write_folders",
    "write_systems",
]

#: The files of every system.
SYSTEM_FILES: Final = (
    "__init__.py",
    "__main__.py",
    *(file for target in TARGETS.values() for file in target.files),
    "certificate.json",
)

_FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC
_NEW_FILE = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC


@dataclass(frozen=True)
class GeneratedSystem:
    """One system ready to be written.

    Attributes:
        texts: Text by file name.
        spec_sha256: Hash of the spec's bytes.
        route: The route whose equations were emitted.
    """

    texts: Mapping[str, str]
    spec_sha256: str
    route: str

    def record(self) -> dict[str, Any]:
        """Its entry in the manifest."""
        return {
            "id": identity_of(self.texts),
            "spec_sha256": self.spec_sha256,
            "route": self.route,
            "files": {name: text_hash(text) for name, text in self.texts.items()},
        }


def identity_of(texts: Mapping[str, str]) -> str:
    """The id that the files of a system carry.

    >>> identity_of({"kernel.py": 'ID = "0123456789abcdef"'})
    '0123456789abcdef'
    """
    line = re.search(r'^ID = "([0-9a-f]{16})"$', texts["kernel.py"], re.MULTILINE)
    assert line, "every kernel.py is rendered with its id"
    return line[1]


def tree_texts(systems: Mapping[str, GeneratedSystem], manifest: str) -> dict[str, str]:
    """Every text of a tree by its path below the generated folder."""
    texts = {
        f"{name}/{file}": text
        for name, system in systems.items()
        for file, text in system.texts.items()
    }
    return {**texts, **PACKAGE, MANIFEST: manifest}


def text_hash(text: str) -> str:
    """The SHA-256 of a text as it stands in its file."""
    return hashlib.sha256(text.encode()).hexdigest()


def manifest_text(systems: Mapping[str, Mapping[str, Any]], templates: Mapping[str, str]) -> str:
    """The manifest as text: sorted, so that the same tree has the same bytes.

    Args:
        systems: Entries by system, as `GeneratedSystem.record` makes them.
        templates: Hashes of the templates by path.

    >>> manifest_text({}, {"c/kernel.c.j2": "00"}).splitlines()[1]
    '  "schema": 1,'
    """
    content = {"schema": SCHEMA, "systems": systems, "templates": templates}
    return json.dumps(content, indent=2, sort_keys=True) + "\n"


def write_systems(
    folder: Path,
    systems: Mapping[str, GeneratedSystem],
    templates: Mapping[str, str],
    keep: Collection[str] | None = None,
    on_wait: Callable[[], None] = lambda: None,
) -> None:
    """Write systems and the manifest into the generated tree.

    Everything goes to temporary files first, then takes its place by renaming, the manifest last.
    Files that the old manifest lists and the new one does not are removed before that, so that a
    run that is killed leaves none that no manifest knows. One run writes at a time.

    Args:
        folder: The generated tree; made if missing.
        systems: What to write, by name.
        templates: Hashes of the templates by path, for the manifest.
        keep: The systems that belong to the tree, written now or before; others that the old
            manifest lists are removed. None keeps every one.
        on_wait: Called once if another run holds the lock.

    Raises:
        OutputError: A file could not be written, and what stood in its place is untouched; or
            something that no run wrote is in the way, and nothing is written.
    """
    refuse_installed(folder)
    with _report_errors(folder):
        folder.mkdir(parents=True, exist_ok=True)
    with lock(folder, on_wait):
        with _report_errors(folder):
            plan = make_plan(folder, {name: each.texts for name, each in systems.items()}, keep)
        entries = plan.entries | {name: system.record() for name, system in systems.items()}
        contents = {name: _kernel_first(system.texts) for name, system in systems.items()}
        last = {**PACKAGE, MANIFEST: manifest_text(entries, templates)}
        for path in list_leftovers(folder):
            with _report_errors(path):
                path.unlink()
        for path in plan.empty:
            with _report_errors(path):
                path.rmdir()
        write_folders(folder, contents, last, lambda: _remove(plan))


def _kernel_first(texts: Mapping[str, str]) -> dict[str, str]:
    """Texts in the order of writing: the mark in the kernel tells whose the others are."""
    return {name: texts[name] for name in sorted(texts, key=lambda name: name != "kernel.py")}


def _remove(plan: Plan) -> None:
    """Remove what the tree no longer has."""
    for path in plan.files:
        with _report_errors(path):
            path.unlink(missing_ok=True)
    for path in plan.folders:
        with _report_errors(path):
            path.rmdir()


def write_folders(
    folder: Path,
    contents: Mapping[str, Mapping[str, str]],
    last: Mapping[str, str] | None = None,
    before_last: Callable[[], None] = lambda: None,
) -> None:
    """Write texts into folders below ``folder``, each file atomically, ``last`` at the very end.

    Args:
        folder: An existing folder.
        contents: Text by file name, by name of the folder below ``folder``.
        last: Text by file name in ``folder`` itself.
        before_last: Called when everything but ``last`` has taken its place.

    Raises:
        OutputError: A file could not be written; its temporary files are removed.
    """
    with ExitStack() as stack:
        staged = []
        for name, texts in contents.items():
            with _report_errors(folder / name):
                (folder / name).mkdir(exist_ok=True)
            staged.append(stack.enter_context(_stage(folder / name, texts)))
        finish = stack.enter_context(_stage(folder, last or {}))
        for take_place in staged:
            take_place()
        before_last()
        finish()


@contextmanager
def _stage(folder: Path, texts: Mapping[str, str]) -> Iterator[Callable[[], None]]:
    """Write temporary files of ``texts``; yields what renames them; removes those not renamed."""
    temporaries: dict[str, str] = {}
    with _report_errors(folder):
        handle = os.open(folder, _FOLDER)
    try:
        with _report_errors(folder):
            _remove_temporaries(handle)
        for name, text in texts.items():
            temporaries[name] = f".coadjoint-{os.urandom(8).hex()}.tmp"
            with _report_errors(folder / name):
                _write_synced(temporaries[name], text.encode(), handle)

        def take_place() -> None:
            for name in texts:
                with _report_errors(folder / name):
                    os.replace(temporaries[name], name, src_dir_fd=handle, dst_dir_fd=handle)
                del temporaries[name]
            with _report_errors(folder):
                os.fsync(handle)

        yield take_place
    finally:
        for temporary in temporaries.values():
            with suppress(OSError):
                os.unlink(temporary, dir_fd=handle)
        os.close(handle)


def _write_synced(name: str, content: bytes, folder: int) -> None:
    """Write a new file and wait until it is on the disk: a rename must not overtake the data."""
    handle = os.open(name, _NEW_FILE, 0o644, dir_fd=folder)
    try:
        rest = memoryview(content)
        while rest:
            rest = rest[os.write(handle, rest) :]
        os.fsync(handle)
    finally:
        os.close(handle)


def _remove_temporaries(folder: int) -> None:
    """Remove what a killed run left; under the lock, no other run owns any of it."""
    for name in os.listdir(folder):
        if TEMPORARY.fullmatch(name):
            os.unlink(name, dir_fd=folder)


@contextmanager
def lock(folder: Path, on_wait: Callable[[], None] = lambda: None) -> Iterator[None]:
    """Hold the lock of a generated tree; the lock file stays, the lock ends with the process.

    Args:
        folder: The generated tree.
        on_wait: Called once if another run holds the lock; then this one waits.

    Raises:
        OutputError: The lock file cannot be opened.
    """
    with _report_errors(folder / LOCK):
        flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC
        handle = os.open(folder / LOCK, flags, 0o644)
    try:
        with _report_errors(folder / LOCK):
            _lock(handle, on_wait)
        yield
    finally:
        os.close(handle)


def _lock(handle: int, on_wait: Callable[[], None]) -> None:
    """Take the lock, at once or after waiting for it."""
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        on_wait()
        fcntl.flock(handle, fcntl.LOCK_EX)


@contextmanager
def _report_errors(path: Path) -> Iterator[None]:
    """Turn an error of the operating system into one that names the path."""
    try:
        yield
    except OSError as error:
        raise OutputError(
            f"{path} could not be written: {error.strerror or error}; what stood there is "
            "untouched. Expected a writable folder with free space: "
            f"{remedy_for(error) or 'Check permissions and disk.'}",
            path=str(path),
            found=error.strerror or str(error),
            expected="a writable folder with free space",
        ) from error
