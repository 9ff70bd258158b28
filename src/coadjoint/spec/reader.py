"""The reader: a spec file to a `Spec`, the first step of all.

Comes in: a path, or a text. Goes out: a frozen, checked `Spec`; or an error with file, line,
column, source line and likely fix. Faults are searched for in the order in which they are worth
reporting: the file (`files`), its form (`validate`), the variables and what they need, the routes
(`consistency`), then every table (`tables`).
Read next: `coadjoint.derive.setting`.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields
from functools import partial
from hashlib import sha256
from pathlib import Path
from types import MappingProxyType
from typing import Any

from coadjoint.errors import CoadjointError, LimitError, SpecError, check_type
from coadjoint.limits import SPEC_BYTES
from coadjoint.resources import derivations_folder
from coadjoint.spec.consistency import (
    check_blocks,
    check_covered,
    check_routes,
    check_tables,
    check_used,
    set_clock,
)
from coadjoint.spec.copies import QUANTITIES
from coadjoint.spec.core.faults import did_you_mean
from coadjoint.spec.core.names import system_refusal
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.positions import KeyPath, scan
from coadjoint.spec.core.reading import Naming, Reading
from coadjoint.spec.core.source import Source
from coadjoint.spec.counted import find_counted
from coadjoint.spec.counted import name_fault as counted_fault
from coadjoint.spec.dimensions import infer_units
from coadjoint.spec.laws import demand_laws
from coadjoint.spec.model import Spec
from coadjoint.spec.sections.indices import read_indices
from coadjoint.spec.sections.reduction import REDUCTION
from coadjoint.spec.spatial import grams, spatial_momenta
from coadjoint.spec.tables import TABLES
from coadjoint.spec.truncated import read_truncated
from coadjoint.spec.validate import validate
from coadjoint.spec.windows import name_fault, read_windows


def read_spec(
    path: str | os.PathLike[str], sizes: Mapping[str, int] = MappingProxyType({})
) -> Spec:
    """Read a spec from a file.

    What the text may ask for is limited (docs/limits.md). The time that reading takes is not
    limited, nor that of `coadjoint.derive` and `coadjoint.prove`. For an untrusted file use
    `coadjoint.read_bounded`, `derive_bounded` and `prove_bounded`.

    Args:
        path: A regular file in TOML; its stem names the system.
        sizes: How many members an index counts, by its name.

    Raises:
        SpecError: The file cannot be read, or is not a spec; the message points at the place.
        LimitError: It asks for more than docs/limits.md allows.
        AlgebraError: The declared brackets or matrices make no Lie algebra.

    >>> from coadjoint.resources import derivations_folder
    >>> spec = read_spec(derivations_folder() / "heavy_top.toml")
    >>> [name for variable in spec.state for name in variable.components]
    ['Pi1', 'Pi2', 'Pi3', 'Gamma1', 'Gamma2', 'Gamma3']
    """
    check_type("read_spec", path, (str, os.PathLike), 'the path of a spec, "my.toml"')
    data = read_file(os.fspath(path))
    try:
        return read_spec_text(data.decode("utf-8"), path, sizes)
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        problem = f"the byte 0x{data[error.start]:02x} is not UTF-8"
        raise file_fault(
            f"{os.fspath(path)}:{line}", problem, "a text in UTF-8", found=data[error.start]
        ) from None


def read_spec_text(
    text: str,
    path: str | os.PathLike[str],
    sizes: Mapping[str, int] = MappingProxyType({}),
) -> Spec:
    """Read a spec from its text.

    Args:
        text: What the file would hold.
        path: Where it comes from, for messages; the stem names the system.
        sizes: How many members an index counts, by its name.

    Raises:
        SpecError: The text is not a spec; the message points at the place.
        LimitError: It asks for more than docs/limits.md allows.
        AlgebraError: The declared brackets or matrices make no Lie algebra.
    """
    data, name = text.encode("utf-8", "surrogatepass"), Path(path).stem
    refused = system_refusal(name)
    if refused is not None:
        raise file_fault(os.fspath(path), refused[0], *refused[1:], found=name)
    check_bytes(os.fspath(path), len(data))
    plain = text.replace("\r\n", "\n")
    source = Source(path=os.fspath(path), text=plain, positions=scan(plain))
    file: Any = validate(source)
    read = partial(_read, path=Path(path), sha256=sha256(data).hexdigest())
    if file.index:
        read_indices(Reading(source, file, name, TABLES), file.index)
        return read_windows(source, file, read, sizes)
    if file.truncation:
        return read_truncated(source, file, read, sizes)
    if file.space and sizes:
        file = _choose_points(source, file, sizes)
        sizes = {}
    _refuse_indices(source, file, sizes)
    return read(source, file)


def _choose_points(source: Source, file: Any, sizes: Mapping[str, int]) -> Any:
    """The file with so many points of space.

    Raises:
        SpecError: The coordinate is another one, or the size is no number of points.
    """
    names = [*file.space]
    for other, size in sizes.items():
        if other not in names:
            problem = f"a size is chosen for {other!a}, which is no coordinate of space"
            expected = f"the coordinate {' or '.join(map(repr, names))}"
            raise source.at_key(("space", names[0]), problem, other, expected)
        if isinstance(size, bool) or not isinstance(size, int) or size < 1:
            problem = f"the size {size!r} is chosen for {other!r}"
            raise source.at_key(("space", other), problem, str(size), "an integer of 1 or more")
    chosen = {
        name: part.model_copy(update={"size": sizes.get(name, part.size)})
        for name, part in file.space.items()
    }
    return file.model_copy(update={"space": chosen})


def _refuse_indices(source: Source, file: Any, sizes: Mapping[str, int]) -> None:
    """Without an index, nothing has one, no size is chosen, and no size counts members."""
    for key, text in find_counted(file):
        if key[-1] == "shape":  # what is no size in the name of an algebra is told with the name
            raise counted_fault(source, key, text, "")
    for table in QUANTITIES:
        for name, part in getattr(file, table).items():
            if part.index is not None:
                raise name_fault(source, (table, name), part.index)
    if sizes:
        chosen = next(iter(sizes))
        problem, expected = f"a size is chosen for {chosen!a}, which is no index", "no sizes"
        hint = "Leave sizes out, or declare [index]."
        raise file_fault(source.path, problem, expected, hint, found=chosen)


def _read(source: Source, file: Any, *, path: Path, sha256: str) -> Spec:
    """The Spec of checked tables without an index."""
    name = path.stem
    reading = Reading(source, file, name, TABLES)
    check_tables(source, file)
    check_blocks(reading)
    check_routes(reading)
    check_covered(reading)
    spec = Spec(
        name=name,
        title=file.title,
        source=file.source,
        description=file.description,
        license=file.license,
        routes=tuple(file.routes),
        path=path,
        sha256=sha256,
        accepted=frozenset(_list_accepted(file)),
        **_read_tables(reading),
    )
    derived = (*spatial_momenta(spec), *spec.reduced_momenta)
    following = [(each.of.name, each.name, each.components) for each in derived]
    following += [(owner.name, each.name, each.components) for owner, each in grams(spec)]
    for owner, momentum, components in following:
        reading.declare(Naming(key=("variables", owner), name=momentum, components=components))
    check_used(source, spec)
    spec = set_clock(spec)
    submanifold = REDUCTION.of(reading)
    spec = infer_units(source, spec, partial(demand_laws, submanifold=submanifold))
    return spec if submanifold is None else spec.restricted_to(submanifold)


def _read_tables(reading: Reading) -> dict[str, Any]:
    """The record of every table, by the attribute of a `Spec` that it is."""
    own, attributes = {each.name for each in fields(Spec)}, dict[str, Any](records={})
    for table in TABLES:
        record = table.of(reading)
        if table.place is None:
            attributes |= vars(record)
        elif table.place not in own:
            attributes["records"][table.key] = record
        elif attributes.get(table.place) is None:  # two tables may give one attribute
            attributes[table.place] = record
    return attributes


def _list_accepted(part: Any, key: KeyPath = ()) -> Iterator[KeyPath]:
    """The keys of the claims for which support by numbers is enough; brackets by their places."""
    if getattr(part, "accept", None) is not None:
        yield key
    entries: Iterable[tuple[str | int, Any]] = ()
    if isinstance(part, dict) and key != ("claims", "brackets"):
        entries = part.items()
    elif isinstance(part, dict | list):
        entries = enumerate(part.values() if isinstance(part, dict) else part)
    elif isinstance(part, Part):
        entries = part
    for name, inner in entries:
        yield from _list_accepted(inner, (*key, name))


def read_file(path: str) -> bytes:
    """The bytes of a regular file, never waiting for a pipe and never more than the limit."""
    try:
        # Not following a link, so that the file that was checked is the file that is read; not
        # blocking, because opening a pipe would wait for a writer.
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_NOFOLLOW | os.O_CLOEXEC)
    except (OSError, ValueError) as error:
        raise _explain_unopened(path, error) from None
    try:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode):
            kind = _kind(status.st_mode)
            raise file_fault(path, f"this is {kind}", "a regular file", found=kind)
        check_bytes(path, status.st_size)
        with os.fdopen(os.dup(descriptor), "rb") as file:
            data = file.read(SPEC_BYTES + 1)  # it may have grown since
    except OSError as error:
        raise _explain_unopened(path, error) from None
    finally:
        os.close(descriptor)
    check_bytes(path, len(data))
    if not data.strip():
        raise file_fault(
            path, "the file is empty", "a spec", "Write one with: coadjoint new NAME.", found=""
        )
    return data


def _explain_unopened(path: str, error: OSError | ValueError) -> CoadjointError:
    """Why a file could not be opened, and which one may have been meant."""
    number = error.errno if isinstance(error, OSError) else None
    if number == errno.ELOOP and Path(path).is_symlink():
        target = str(Path(path).readlink())
        hint = f"Give the file that it points to: {target}."
        return file_fault(path, "this is a symbolic link", "a regular file", hint, found=target)
    if number == errno.ENOENT:
        near = [str(p) for p in Path(path).parent.glob("*.toml")]
        hint = _name_shipped(path) or did_you_mean(path, near)
        return file_fault(path, "there is no such file", "a spec in TOML", hint, found=path)
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return file_fault(
        path, f"cannot be read: {reason}", "a readable regular file", found=str(reason)
    )


def _name_shipped(path: str) -> str:
    """How to get the spec or the shipped system that a name without an ending means."""
    if not path.isidentifier():
        return ""
    if Path(f"{path}.toml").is_file():
        return f"Did you mean './{path}.toml'?"
    if (derivations_folder() / f"{path}.toml").is_file():
        return f"The shipped system is loaded by: from coadjoint.systems import {path}."
    return ""


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
        expected = f"at most {SPEC_BYTES} (SPEC_BYTES)"
        raise file_fault(path, f"the file has {size} bytes", expected, found=size, kind=LimitError)


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
