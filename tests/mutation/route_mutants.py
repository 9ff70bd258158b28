"""What a change of a derivation is, and short ways to list several.

Read next: `tests.mutation.routes`, the list, and `tests.mutation.route_judge`, which tries them.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).parents[2]
DERIVE = ROOT / "src" / "coadjoint" / "derive"


@dataclass(frozen=True)
class RouteMutant:
    """One change of a derivation or of a spec.

    Attributes:
        route: The route as specs name it, or the step that several routes share.
        file: Path below the root of the repository, in ``derive/`` or in ``derivations/``.
        old: What is there, once.
        new: What takes its place.
        systems: Whose certificates judge it, the cheapest first.
        tests: Source tests that judge what those let pass.
        fallacy: The mistake that the change is, where it has a name.
    """

    route: str
    file: str
    old: str
    new: str
    systems: tuple[str, ...] = ()
    tests: tuple[str, ...] = ()
    fallacy: str = ""

    @property
    def name(self) -> str:
        """Short name for reports."""
        change = f"{self.old.strip()} -> {self.new.strip()}"
        return f"{self.route}: {self.fallacy or change}"


#: Old text, new text, and the name of the mistake where it has one.
Change = tuple[str, str] | tuple[str, str, str]


def of(
    route: str,
    module: str,
    systems: tuple[str, ...],
    *changes: Change,
    tests: tuple[str, ...] = (),
) -> tuple[RouteMutant, ...]:
    """Changes of one module somewhere in ``derive/``, judged by the same systems and tests."""
    (path,) = DERIVE.rglob(f"{module}.py")
    file = path.relative_to(ROOT).as_posix()
    return tuple(
        RouteMutant(route, file, change[0], change[1], systems, tests, *change[2:])
        for change in changes
    )


def of_spec(system: str, *changes: Change) -> tuple[RouteMutant, ...]:
    """Changes of a shipped spec, judged by its own certificate."""
    file = f"derivations/{system}.toml"
    return tuple(
        RouteMutant("spec", file, change[0], change[1], (system,), (), *change[2:])
        for change in changes
    )


def system_of(file: str) -> str:
    """The system whose spec a file is; empty for a module."""
    path = PurePosixPath(file)
    return path.stem if path.suffix == ".toml" else ""
