"""Single changes to the routes that must be refuted: a sign flipped, a term dropped.

Each names a route, the module that derives it, a piece of text that occurs exactly once there, what
takes its place, and the shipped systems whose certificates judge it.
"""

from __future__ import annotations

from dataclasses import dataclass

DERIVE = "src/coadjoint/derive/"


@dataclass(frozen=True)
class RouteMutant:
    """One change of a derivation.

    Attributes:
        route: As specs name it.
        module: The file's stem in ``derive/``.
        old: What is there, once.
        new: What takes its place.
        systems: Whose certificates judge it.
        tests: Source tests that judge what those let pass.
    """

    route: str
    module: str
    old: str
    new: str
    systems: tuple[str, ...]
    tests: tuple[str, ...] = ()

    @property
    def file(self) -> str:
        """Path below the root of the repository."""
        return f"{DERIVE}{self.module}.py"

    @property
    def name(self) -> str:
        """Short name for reports."""
        return f"{self.route}: {self.old.strip()} -> {self.new.strip()}"


def _of(
    route: str, module: str, systems: tuple[str, ...], *changes: tuple[str, str]
) -> tuple[RouteMutant, ...]:
    """Several changes of one module."""
    return tuple(RouteMutant(route, module, old, new, systems) for old, new in changes)


ROUTE_MUTANTS = (
    *_of(
        "euler-poincare",
        "euler_poincare",
        ("heavy_top", "affine_line"),
        ("[-sign * x for x in", "[sign * x for x in"),
        ("[m + t for", "[m - t for"),
        ("[sign * m for m in momentum]", "[-sign * m for m in momentum]"),
        ("torque = action.diamond(dl_da, a)", "torque = action.diamond(a, dl_da)"),
        ("[m + t for m, t in", "[m for m, t in"),
    ),
    *_of(
        "lie-poisson",
        "structure",
        ("heavy_top", "affine_line"),
        ("sign = -setting.sign", "sign = setting.sign"),
        ("action.dual()) for name", "action) for name"),
    ),
    *_of(
        "poisson",
        "poisson",
        ("nambu_body", "sp2_momentum"),
        ("sum(entry * slope for", "sum(-entry * slope for"),
        ("if entry != 0)", "if entry == 0)"),
    ),
    *_of(
        "nambu",
        "nambu",
        ("nambu_body", "nambu_pendulum"),
        ("-rate for rate in", "rate for rate in"),
        ("(-1) ** i * determinant(minor)", "determinant(minor)"),
    ),
)
