"""What a mutant is: a file, a line that names one change of it, and what must refute it.

Read next: `tests.mutation.addresses`, how a line names a change, then `tests.mutation.routes` and
`tests.mutation.engine`, the lists.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType

from tests.mutation.addresses import (
    AddressError,
    find_edit,
    find_edits,
    function_of,
    source_with,
    tree_of,
)
from tests.mutation.operators import Edit, core
from tests.mutation.texts import changed_spec, changed_template

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "src" / "coadjoint"


@dataclass(frozen=True)
class Mutant:
    """One change.

    Attributes:
        file: Path below the root of the repository.
        line: The change, as `tests.mutation.addresses` and `tests.mutation.texts` say it; empty
            for none.
        route: The route as specs name it, or the step that several routes share.
        systems: Whose certificates judge it, the cheapest first.
        tests: Tests that judge what those let pass, each as a run of pytest has it.
        fallacy: The mistake that the change is, where it has a name.
        equivalent: Why no check can see it, if so.
        always: Whether it is tried in every run of the tests, not only in campaigns.
        edit: The change itself, where no line names it since it is one of all.
    """

    file: str
    line: str
    route: str = ""
    systems: tuple[str, ...] = ()
    tests: tuple[str, ...] = ()
    fallacy: str = ""
    equivalent: str = ""
    always: bool = False
    edit: Edit | None = None

    @property
    def name(self) -> str:
        """Short name for reports."""
        change = self.fallacy or f"{Path(self.file).name.partition('.')[0]}.{self.line}"
        return f"{self.route}: {change}" if self.route else change

    def text(self) -> str:
        """The changed text of the file.

        Raises:
            AddressError: The line fits nowhere, or at several places.
        """
        if self.edit is not None:
            return source_with(tree_of(ROOT / self.file), self.edit)
        return _text(self.file, self.line)


@cache
def _text(file: str, line: str) -> str:
    path = ROOT / file
    if not line:
        return path.read_text(encoding="utf-8")
    try:
        return _CHANGED[path.suffix](path, line)
    except AddressError as error:
        raise AddressError(f"{file}: {error}") from None


def _changed_module(path: Path, line: str) -> str:
    tree = tree_of(path)
    return source_with(tree, find_edit(tree, line))


def _of_text(change: Callable[[str, str], str]) -> Callable[[Path, str], str]:
    return lambda path, line: change(path.read_text(encoding="utf-8"), line)


_CHANGED = {
    ".py": _changed_module,
    ".toml": _of_text(changed_spec),
    ".j2": _of_text(changed_template),
}
#: A line, with the name of the mistake where it has one.
Change = str | tuple[str, str]


@cache
def module(name: str) -> str:
    """The path of a module below ``src/coadjoint``, by its name and folders that are above it.

    Other folders may stand between: ``derive/hamel`` is ``derive/routes/hamel.py``.
    """
    *folders, stem = name.split("/")
    found = [
        path.relative_to(ROOT).as_posix()
        for path in SOURCE.rglob(f"{stem}.py")
        if {*folders} <= {*path.relative_to(SOURCE).parts}
    ]
    found = [each for each in found if each == f"src/coadjoint/{name}.py"] or found
    assert len(found) == 1, f"{name!r} names {found or 'no module'} below {SOURCE}"
    return found[0]


def of(
    route: str,
    name: str,
    systems: tuple[str, ...],
    *changes: Change,
    tests: tuple[str, ...] = (),
) -> tuple[Mutant, ...]:
    """Changes of one module of ``derive/``, judged by the same systems and tests."""
    return tuple(
        Mutant(module(f"derive/{name}"), line, route, systems, tests, fallacy)
        for line, fallacy in map(_with_fallacy, changes)
    )


def changes_of(name: str, *lines: str, tests: tuple[str, ...] = ()) -> tuple[Mutant, ...]:
    """Changes of one module below ``src/coadjoint``, or of one template."""
    file = f"templates/{name}" if name.endswith(".j2") else module(name)
    return tuple(Mutant(file, line, tests=tests) for line in lines)


def core_of(
    route: str,
    name: str,
    names: str,
    *,
    systems: tuple[str, ...],
    tests: tuple[str, ...] = (),
    fallacies: Mapping[str, str] = MappingProxyType({}),
    equivalent: Mapping[str, str] = MappingProxyType({}),
) -> tuple[Mutant, ...]:
    """All changes of signs, terms, factors and the order of arguments in functions of a route.

    The first by each operator and those with a name are tried in every run, others in campaigns.

    Args:
        route: The route.
        name: The module in ``derive/``.
        names: Its functions.
        systems: Whose certificates judge them.
        tests: The tests that judge what those let pass.
        fallacies: The names of mistakes, by lines.
        equivalent: Why changes move nothing, by lines that may fit several.
    """
    file = module(f"derive/{name}")
    tree = tree_of(ROOT / file)
    mistakes = {find_edit(tree, line).place: mistake for line, mistake in fallacies.items()}
    reasons = {
        edit.place: reason for line, reason in equivalent.items() for edit in find_edits(tree, line)
    }
    found, tried, counts = list[Mutant](), set[str](), Counter[str]()
    seen = set[tuple[int, str]]()
    for function in names.split():
        for edit in core(function_of(tree, function)):
            if (same := (id(edit.old), ast.dump(edit.new))) in seen:
                continue
            seen.add(same)
            mistake, reason = (table.pop(edit.place, "") for table in (mistakes, reasons))
            line = f"{function}: {edit.label}"
            counts[line] += 1
            line += f" ({counts[line]})" if counts[line] > 1 else ""
            always = bool(mistake) or (edit.operator not in tried and not reason)
            tried |= {edit.operator} if always else set()
            found.append(Mutant(file, line, route, systems, tests, mistake, reason, always, edit))
    assert not mistakes, f"no operator makes {mistakes} in {file}"
    return tuple(found)


def of_spec(system: str, *changes: Change) -> tuple[Mutant, ...]:
    """Changes of a shipped spec, judged by its own certificate."""
    return tuple(
        Mutant(f"derivations/{system}.toml", line, "spec", (system,), fallacy=fallacy)
        for line, fallacy in map(_with_fallacy, changes)
    )


def _with_fallacy(change: Change) -> tuple[str, str]:
    return (change, "") if isinstance(change, str) else change
