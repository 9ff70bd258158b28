"""Counted: sizes that the number of members gives, as in ``so(n)`` and ``shape = ["n"]``.

Comes in: a checked file with an index whose number of members has a name. Goes out: where that name
stands in names of algebras and in shapes, and the file with numbers there. Such a system is written
out for the size that is chosen. Read next: `coadjoint.spec.windows`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from coadjoint.errors import CoadjointError
from coadjoint.families import Index
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.values import COUNTED_PATTERN

#: What an algebra's name has in parentheses, or behind R^.
_SIZES = re.compile(r"(?<=[(,^])\s*([^(),^]+?)\s*(?=[),]|$)")
#: Tables of quantities with shapes, and those with algebras.
_SHAPED, _OF_ALGEBRAS = ("variables", "parameters", "inputs"), ("algebra", "symmetries")


def find_counted(file: Any) -> Iterator[tuple[KeyPath, str]]:
    """Where a size is no number but a text such as ``n`` or ``2n``: its key, and the text."""
    for table in _SHAPED:
        for name, part in getattr(file, table).items():
            for side in part.shape or ():
                if isinstance(side, str):
                    yield (table, name, "shape"), side
    for table in _OF_ALGEBRAS:
        for key, name in _list_names(getattr(file, table), (table,)):
            for found in _SIZES.finditer(name):
                if _read(found[1]) is not None:
                    yield key, found[1]


def name_fault(source: Source, key: KeyPath, text: str, count: str) -> CoadjointError:
    """The fault of a size whose name counts nothing."""
    problem = f"the size {text!a} is no number"
    expected = f"a number, or {count}, the number of members" if count else "a number"
    hint = "" if count else 'Declare what it counts: [index] i = { size = 8, count = "n" }.'
    return source.fault(key, problem, text, expected, hint)


def count_out(source: Source, file: Any, index: Index, declared: int | None) -> Any:
    """The file with numbers in the place of such sizes.

    A default with an entry for each component is one for the declared size alone.

    Raises:
        SpecError: A size has another name, or is less than 1.
    """
    assert index.size is not None, index

    def work_out(key: KeyPath, text: str) -> int:
        factor, name, more = _read(text) or (0, "", 0)
        size = factor * (index.size or 0) + more
        if name != index.count:
            raise name_fault(source, key, text, index.count)
        if size < 1:
            problem = f"the size {text!a} is {size}"
            raise source.fault(key, problem, size, "1 or more", "Choose a larger size.")
        return size

    update = dict[str, Any]()
    for table in _SHAPED:
        parts = getattr(file, table)
        update[table] = {
            name: _give_shape(part, (table, name, "shape"), work_out, index.size == declared)
            for name, part in parts.items()
        }
    for table in _OF_ALGEBRAS:
        update[table] = _give_names(getattr(file, table), (table,), work_out)
    return file.model_copy(update=update)


def _read(text: str) -> tuple[int, str, int] | None:
    """Factor, name and addend of a size; None of a number, or of what is no size."""
    found = re.fullmatch(COUNTED_PATTERN, text)
    if found is None:
        return None
    factor, name, more = found.groups()
    return int(factor or 1), name, int((more or "0").replace(" ", ""))


def _list_names(part: Any, key: KeyPath) -> Iterator[tuple[KeyPath, str]]:
    """The names of algebras in a part, at any depth."""
    if isinstance(part, Mapping):
        for name, each in part.items():
            yield from _list_names(each, (*key, name))
    elif isinstance(part, list):
        for place, each in enumerate(part):
            yield from _list_names(each, (*key, place))
    elif isinstance(part, Part):
        for name in type(part).model_fields:
            value = getattr(part, name)
            if name == "name" and isinstance(value, str):
                yield (*key, name), value
            else:
                yield from _list_names(value, (*key, name))


def _give_shape(part: Any, key: KeyPath, work_out: Any, is_declared: bool) -> Any:
    """A quantity whose shape has numbers."""
    if not any(isinstance(side, str) for side in part.shape or ()):
        return part
    shape = [work_out(key, side) if isinstance(side, str) else side for side in part.shape]
    keeps = is_declared or not isinstance(part.default, list)
    return part.model_copy(update={"shape": shape, "default": part.default if keeps else None})


def _give_names(part: Any, key: KeyPath, work_out: Any) -> Any:
    """A part in which names of algebras have numbers."""

    def put(found: re.Match[str]) -> str:
        return found[1] if _read(found[1]) is None else str(work_out(key, found[1]))

    if isinstance(part, Mapping):
        return {name: _give_names(each, (*key, name), work_out) for name, each in part.items()}
    if isinstance(part, list):
        return [_give_names(each, (*key, n), work_out) for n, each in enumerate(part)]
    if not isinstance(part, Part):
        return part
    update = dict[str, Any]()
    for name in type(part).model_fields:
        value = getattr(part, name)
        if name == "name" and isinstance(value, str):
            key = (*key, name)
            update[name] = _SIZES.sub(put, value)
        else:
            update[name] = _give_names(value, (*key, name), work_out)
    return part.model_copy(update=update)
