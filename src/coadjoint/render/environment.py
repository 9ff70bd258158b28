"""Render, templates of code: the environment that every generated file comes from.

Comes in: names of templates of this package and plain values. Goes out: text. A value given for
nothing is an error, and a value that could end a comment or a string of the output is refused.
Read next: `coadjoint.render.targets`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any, Final

from coadjoint.errors import SpecError
from coadjoint.render.printers import python_call
from coadjoint.render.strict import StrictEnvironment, make_environment
from coadjoint.render.targets import OTHERS, TARGETS

#: What would begin or end a comment or a string, or glue two lines together, in C or in Python.
UNSAFE = re.compile(r'[^ -~]|\\|/\*|\*/|"""|\?\?')

#: Folders of templates of text and pages, whose filters are those of their own environments.
PAGES: Final = ("document/", "explorer/")


@cache
def environment() -> StrictEnvironment:
    """The environment of kernels, with the filters of all targets."""
    made = make_environment(autoescape=False)  # code, not HTML; `refuse_unsafe` guards each value
    made.filters["python_call"] = python_call
    for target in (*TARGETS.values(), *OTHERS.values()):
        made.filters |= target.filters
    return made


def refuse_unsafe(value: object) -> None:
    """Pass over every text inside ``value``: each must be able to stand in a comment and in code.

    Raises:
        SpecError: One holds a comment mark, a backslash or a character outside ASCII.

    >>> refuse_unsafe({"unit": "kg m^2/s"})
    """
    for text in _texts(value):
        mark = UNSAFE.search(text)
        if mark:
            raise SpecError(
                f"{text[:80]!r} cannot stand in generated code: it contains {mark[0]!r}; expected "
                "plain ASCII text without comment marks. Check the units and names of the spec.",
                found=text[:80],
                expected="plain ASCII text without comment marks",
            )


def _texts(value: object) -> Iterator[str]:
    """Every text in records, mappings and sequences."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        yield from _texts([*value.keys(), *value.values()])
    elif isinstance(value, Sequence):
        for entry in value:
            yield from _texts(entry)
    elif is_dataclass(value):
        yield from _texts([getattr(value, field.name) for field in fields(value)])


def render_templates(names: tuple[str, ...], values: Mapping[str, Any]) -> dict[str, str]:
    """The text of each template, given the same values.

    Args:
        names: Paths below the templates folder, e.g. ``numpy/kernel.py.j2``.
        values: What templates may print; each must be read by one template at least.

    Returns:
        Text by template.
    """
    refuse_unsafe(values)
    read = {name: names_read(name) for name in names}
    used = frozenset[str]().union(*read.values())
    assert used == set(values), f"templates read {sorted(used)}, given are {sorted(values)}"
    return {name: environment().get_template(name).render(values) for name in names}


def names_read(template: str) -> frozenset[str]:
    """The names that a template takes from its context.

    >>> "functions" in names_read("c/kernel.h.j2")
    True
    """
    environment().get_template(template)  # which is compiled once
    return frozenset(environment().read[template])


def compile_templates() -> None:
    """Compile the templates of code now, which takes as long as rendering some systems."""
    for name in environment().list_templates(extensions=["j2"]):
        if not name.startswith(PAGES):
            environment().get_template(name)
