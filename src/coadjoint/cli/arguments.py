"""Commands: what SYSTEM and SPEC on the command line mean.

Comes in: a word of the command line. Goes out: the path of a spec, or a loaded system. A name means
a shipped system; anything with a slash or ending in ``.toml`` is a file. Names are never looked up
in the working folder, so that a command does not run code that lies there by chance.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from difflib import get_close_matches
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import click

from coadjoint.budget import MOST
from coadjoint.errors import SpecError
from coadjoint.limits import WORKER_SECONDS
from coadjoint.resources import derivations_folder, systems_folder

if TYPE_CHECKING:
    from coadjoint.solve.system import System


def shipped_names() -> list[str]:
    """Names of the shipped systems, sorted.

    >>> "heavy_top" in shipped_names()
    True
    """
    return sorted(path.stem for path in derivations_folder().glob("*.toml"))


def is_path(system: str) -> bool:
    """Whether a word means a file.

    >>> is_path("heavy_top"), is_path("my.toml"), is_path("./heavy_top")
    (False, True, True)
    """
    return "/" in system or os.sep in system or system.endswith(".toml") or _is_own(system)


def _is_own(system: str) -> bool:
    """Whether a word is the name of a spec in this folder, and of no shipped system."""
    plain = system.isidentifier() and system not in shipped_names()
    return plain and Path(f"{system}.toml").is_file()


def spec_path(system: str) -> Path:
    """The spec that a word of the command line means.

    Raises:
        SpecError: No shipped system of that name; the nearest one is named.
    """
    if is_path(system):
        return Path(f"{system}.toml" if _is_own(system) else system)
    names = shipped_names()
    if system not in names:
        here = [path.stem for path in Path().glob("*.toml")]
        near = get_close_matches(system, [*here, *names], n=3)
        own = f"A spec of your own is a path: ./{system}.toml."
        shown = [f"./{name}.toml" if name in here else name for name in near]
        hint = f"Did you mean {' or '.join(map(repr, shown))}?" if near else own
        raise SpecError(
            f"no shipped system is called {system!r}, and there is no {system}.toml here. {hint} "
            f"`coadjoint list` shows the {len(names)} shipped systems.",
            found=system,
            expected=names,
        )
    return derivations_folder() / f"{system}.toml"


def load_system(
    system: str,
    seconds: int | None = None,
    sizes: Mapping[str, int] = MappingProxyType({}),
    derivatives: str = "differences",
) -> System:
    """The system of a word: a shipped one, or that of a spec, built if it has changed.

    Args:
        system: The word.
        seconds: Processor time that deriving may take; see `coadjoint.budget.allowed_seconds`.
        sizes: How many members an index counts, by its name.
        derivatives: Those of fields along space; see `coadjoint.load`.

    Raises:
        CoadjointError: The spec is not in order, or the shipped system has not been generated.
    """
    path = spec_path(system)
    if is_path(system) or sizes or derivatives == "lattice":
        from coadjoint.cli.output import progress_bars
        from coadjoint.loading import load

        with progress_bars() as progress:
            return load(
                path, sizes=sizes, derivatives=derivatives, seconds=seconds, progress=progress
            )
    from coadjoint.solve.folders import load_folder

    folder = systems_folder() / path.stem
    if not (folder / "__init__.py").is_file():
        raise SpecError(
            f"{folder}: the system {path.stem!r} has not been generated. "
            f"Run `coadjoint regenerate {path.stem}`.",
            found=path.stem,
        )
    return load_folder(folder).with_derivatives(derivatives)


def complete_system(
    _context: click.Context, _parameter: click.Parameter, incomplete: str
) -> list[str]:
    """What a shell may complete: names of shipped systems, and specs in the folder at hand."""
    folder, _, begun = incomplete.rpartition("/")
    lead = f"{folder}/" if folder else ""
    names = [] if folder else shipped_names()
    files = [f"{lead}{path.name}" for path in sorted(Path(folder or ".").glob("*.toml"))]
    return [word for word in [*names, *files] if word.startswith(lead + begun)]


#: The argument ``SYSTEM|SPEC`` of a command.
system_argument = click.argument("system", metavar="SYSTEM|SPEC", shell_complete=complete_system)


def complete_route(
    context: click.Context, _parameter: click.Parameter, incomplete: str
) -> list[str]:
    """Routes of the system that the command line names, or all routes."""
    declared = _declared(context).get("routes") or ()
    return [route for route in declared if route.startswith(incomplete)]


def complete_names(table: str) -> Callable[..., list[str]]:
    """A completion for names of a table of the spec that the command line names."""

    def complete(context: click.Context, _parameter: click.Parameter, incomplete: str) -> list[str]:
        names = _declared(context).get(table) or {}
        return [f"{name}=" for name in names if name.startswith(incomplete)]

    return complete


def complete_method(*others: str) -> Callable[..., list[str]]:
    """A completion for names of methods: others, and those that keep structure."""

    def complete(_context: click.Context, _parameter: click.Parameter, begun: str) -> list[str]:
        from coadjoint.methods import MAPPED, STRUCTURED

        return [name for name in (*others, *STRUCTURED, *MAPPED) if name.startswith(begun)]

    return complete


def complete_algebra(
    _context: click.Context, _parameter: click.Parameter, incomplete: str
) -> list[str]:
    """Named algebras, then what `system_argument` completes."""
    from coadjoint.algebra.catalogue import CATALOGUE

    return [word for word in CATALOGUE if word.startswith(incomplete)] + complete_system(
        _context, _parameter, incomplete
    )


def _declared(context: click.Context) -> dict[str, Any]:
    """The tables of the spec that a command line names; a shell waits, so nothing is checked."""
    import tomllib

    # behind an option without its value, what was read before it is not yet a parameter
    word = str(context.params.get("system") or next(iter(context.args), ""))
    path = Path(f"{word}.toml") if _is_own(word) else Path(word)
    if not is_path(word):
        path = derivations_folder() / f"{word}.toml"
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        return {}


#: The option ``--output`` of commands that show a document.
output_option = click.option(
    "--output", type=click.Path(path_type=Path), help="File to write, in place of the terminal."
)


def format_option(*formats: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """The option ``--format`` of commands that show a document; the first format is the default."""
    about = "latex is a complete file, html one self-contained page."
    kind = click.Choice(formats)
    return click.option(
        "--format", "form", type=kind, default=formats[0], show_default=True, help=about
    )


def _read_sizes(
    _context: click.Context, _parameter: click.Parameter, given: tuple[str, ...]
) -> dict[str, int]:
    """Each ``INDEX=12`` as a name and a number."""
    sizes = {}
    for text in given:
        name, _, number = text.partition("=")
        if not number.strip().isdecimal():
            raise click.BadParameter(f"{text!r} is not of the form INDEX=12 with a whole number.")
        sizes[name.strip()] = int(number)
    return sizes


#: The option ``--size`` of commands that derive one system.
size_option = click.option(
    "--size",
    "sizes",
    metavar="INDEX=N",
    multiple=True,
    callback=_read_sizes,
    help="How many members an index counts, or points a field has along a coordinate, e.g. i=12 "
    "or s=512. Default: that of the spec.",
)

#: The option ``--seconds`` of every command that derives.
seconds_option = click.option(
    "--seconds",
    type=click.IntRange(1, MOST),
    help="Processor seconds for the derivation of one system. Default: COADJOINT_SECONDS, else "
    f"{WORKER_SECONDS}.",
)
