"""Routes: what each one starts from, so that the reader can say what is missing.

Comes in: nothing. Goes out: a table by the names that specs use. How a route is followed is the
business of `coadjoint.derive`; a test holds its table against this one.
Read next: `coadjoint.spec.consistency`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

from coadjoint.spec.schema import SpecFile


@dataclass(frozen=True)
class Start:
    """What a route starts from.

    Attributes:
        kinds: The kinds of spec that it goes with, of those that `kinds_of` returns.
        energies: The tables of which it takes one; empty if it takes none.
        table: A table of its own, without which it cannot start; "" if none.
        options: Tables of its own that may be left out.
        emitted: Whether it may be the first of a spec. What moves in variables of its own, or
            leaves multipliers out, is there to be proved equal.
    """

    kinds: tuple[str, ...]
    energies: tuple[str, ...] = ()
    table: str = ""
    options: tuple[str, ...] = ()
    emitted: bool = True


_LAGRANGIAN, _HAMILTONIAN = ("lagrangian",), ("hamiltonian",)
_EITHER = ("hamiltonian", "lagrangian")
_ON_ALGEBRA = Start(("algebra",), _LAGRANGIAN)
_CHART = replace(_ON_ALGEBRA, emitted=False)
_CONSTRAINED = Start(
    ("algebra", "configuration"), _LAGRANGIAN, "constraints", ("forces", "dissipation")
)

STARTS: Mapping[str, Start] = MappingProxyType(
    {
        "euler-poincare": _ON_ALGEBRA,
        "lie-poisson": Start(("algebra",), _EITHER),
        "hamilton-pontryagin": _ON_ALGEBRA,
        "clebsch": replace(_CHART, options=("clebsch",)),
        "poincare": _ON_ALGEBRA,
        "matrix-euler-poincare": _ON_ALGEBRA,
        "newton-euler": _ON_ALGEBRA,
        "cayley-klein": _CHART,
        "kaluza-klein": _CHART,
        "complexification": Start(("algebra",), _HAMILTONIAN),
        "manakov": Start(("algebra",), _EITHER),
        "lax": Start(("algebra", "poisson"), _EITHER, "lax"),
        "nambu": Start(("algebra", "nambu"), _EITHER),
        "poisson": Start(("poisson",), _HAMILTONIAN),
        "canonical": Start(("canonical", "configuration"), _EITHER),
        "euler-lagrange": Start(("configuration", "canonical"), _LAGRANGIAN),
        "newton": Start(("configuration", "poisson"), (), "newton"),
        "alignment": Start(("configuration", "poisson"), (), "newton", emitted=False),
        "nonholonomic": _CONSTRAINED,
        "hamel": replace(_CONSTRAINED, emitted=False),
    }
)


def energies_of(route: str, kinds: tuple[str, ...]) -> tuple[str, ...]:
    """The tables of which a route takes one: a bracket that pairs nothing knows no Lagrangian."""
    energies = STARTS[route].energies
    if "poisson" in kinds and "canonical" not in kinds:
        return tuple(each for each in energies if each != "lagrangian")
    return energies


def kinds_of(file: SpecFile) -> tuple[str, ...]:
    """The kinds that a spec is of: ``algebra``, ``configuration``, or ``poisson`` and its way.

    >>> kinds_of(SpecFile.model_construct(algebra=None, poisson=None))
    ('configuration',)
    """
    if file.algebra is not None:
        return ("algebra",)
    if file.poisson is None:
        return ("configuration",)
    ways = ("nambu", "brackets", "canonical")
    return ("poisson", *(way for way in ways if getattr(file.poisson, way) is not None))
