"""The reader: a spec file to a `Spec`, the first step of all.

Comes in: a path, or a text. Goes out: a frozen, checked `Spec`; or an error with file, line,
column, source line and likely fix. Faults are looked for in the order in which they are worth
reporting: the file (`files`), its form (`validate`), the variables and what they need, the routes
(`consistency`), then every table (`tables`).
Read next: `coadjoint.derive.setting`.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import fields
from hashlib import sha256
from pathlib import Path
from typing import Any

from coadjoint.spec.consistency import check_routes, check_tables, check_used
from coadjoint.spec.core.names import system_refusal
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.positions import KeyPath, scan
from coadjoint.spec.core.reading import Naming, Reading
from coadjoint.spec.core.source import Source
from coadjoint.spec.files import check_bytes, file_fault, read_file
from coadjoint.spec.model import Spec
from coadjoint.spec.restriction import restrict
from coadjoint.spec.sections.reduction import REDUCTION
from coadjoint.spec.tables import TABLES
from coadjoint.spec.tiling import check_blocks, check_covered
from coadjoint.spec.validate import validate


def read_spec(path: str | os.PathLike[str]) -> Spec:
    """Read a spec from a file.

    What the text may ask for is limited (docs/limits.md); the time that reading takes is not, and
    nor is that of `coadjoint.derive` and `coadjoint.prove`. For a file of a stranger there are
    `coadjoint.read_bounded`, `derive_bounded` and `prove_bounded`.

    Args:
        path: A regular file in TOML; its stem names the system.

    Raises:
        SpecError: The file cannot be read, or is not a spec; the message points at the place.
        LimitError: It asks for more than docs/limits.md allows.
        AlgebraError: The declared brackets or matrices make no Lie algebra.

    >>> from coadjoint.resources import derivations_folder
    >>> spec = read_spec(derivations_folder() / "heavy_top.toml")
    >>> [name for variable in spec.state for name in variable.components]
    ['Pi1', 'Pi2', 'Pi3', 'Gamma1', 'Gamma2', 'Gamma3']
    """
    data = read_file(os.fspath(path))
    try:
        return read_spec_text(data.decode("utf-8"), path)
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise file_fault(
            f"{os.fspath(path)}:{line}",
            f"the byte 0x{data[error.start]:02x} is not UTF-8",
            "a text in UTF-8",
            found=data[error.start],
        ) from None


def read_spec_text(text: str, path: str | os.PathLike[str]) -> Spec:
    """Read a spec from its text.

    Args:
        text: What the file would hold.
        path: Where it comes from, for messages; the stem names the system.

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
    source = Source(os.fspath(path), plain, scan(plain))
    file = validate(source)
    reading = Reading(source, file, name, TABLES)
    check_tables(source, file)
    check_blocks(reading)
    check_routes(source, file)
    check_covered(reading)
    spec = Spec(
        name=name,
        title=file.title,
        source=file.source,
        description=file.description,
        license=file.license,
        routes=tuple(file.routes),
        path=Path(path),
        sha256=sha256(data).hexdigest(),
        accepted=frozenset(_list_accepted(file)),
        **_read_tables(reading),
    )
    following = [(each.momentum.name, each.name, each.components) for each in spec.spatial]
    following += [(each.velocity.name, each.name, each.components) for each in spec.reduced_momenta]
    for owner, momentum, components in following:
        reading.declare(Naming(("variables", owner), momentum, components))
    check_used(source, spec)
    submanifold = REDUCTION.of(reading)
    return spec if submanifold is None else restrict(spec, submanifold)


def _read_tables(reading: Reading) -> dict[str, Any]:
    """The record of every table, by the attribute of a `Spec` that it is."""
    own, found = {each.name for each in fields(Spec)}, dict[str, Any](records={})
    for table in TABLES:
        record = table.of(reading)
        if table.place is None:
            found |= vars(record)
        elif table.place not in own:
            found["records"][table.key] = record
        elif found.get(table.place) is None:  # two tables may give one attribute
            found[table.place] = record
    return found


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
