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
        is_bare: Whether it may do without any of them.
        table: A table of its own, without which it cannot start; "" if none.
        options: Tables of its own that may be left out.
        in_frame: Whether the state has velocities along a frame, which constraints may bind; on the
            other routes it has momenta, or velocities of coordinates.
        emitted: Whether it may be the first of a spec. What moves in variables of its own, or
            leaves multipliers out, is there to be proved equal.
    """

    kinds: tuple[str, ...]
    energies: tuple[str, ...] = ()
    table: str = ""
    options: tuple[str, ...] = ()
    in_frame: bool = False
    emitted: bool = True
    is_bare: bool = False


_LAGRANGIAN, _HAMILTONIAN = ("lagrangian",), ("hamiltonian",)
_EITHER = ("hamiltonian", "lagrangian")
#: What acts beside the energy, on routes where a rate of momenta is known.
_DRIVES = ("forces", "dissipation")
#: What acts by the bracket of the state.
_RELAXES = ("double_bracket", "metriplectic")
_ON_ALGEBRA = Start(("algebra",), _LAGRANGIAN, options=(*_DRIVES, *_RELAXES))
_CHART = Start(("algebra",), _LAGRANGIAN, emitted=False)
_IN_FRAME = Start(
    ("algebra", "configuration"), _LAGRANGIAN, options=("constraints", *_DRIVES), in_frame=True
)

STARTS: Mapping[str, Start] = MappingProxyType(
    {
        "euler-poincare": _ON_ALGEBRA,
        "lie-poisson": Start(("algebra",), _EITHER, options=(*_DRIVES, *_RELAXES)),
        "hamilton-pontryagin": _ON_ALGEBRA,
        "clebsch": replace(_CHART, options=("clebsch",)),
        "poincare": _ON_ALGEBRA,
        "matrix-euler-poincare": _ON_ALGEBRA,
        "newton-euler": _ON_ALGEBRA,
        "cayley-klein": _CHART,
        "kaluza-klein": _CHART,
        "complexification": Start(("algebra",), _HAMILTONIAN),
        "manakov": Start(("algebra",), _EITHER),
        "lax": Start(("algebra", "poisson", "configuration"), _EITHER, "lax", is_bare=True),
        "nambu": Start(("algebra", "nambu"), _EITHER, options=(*_DRIVES, *_RELAXES)),
        "poisson": Start(("poisson",), _HAMILTONIAN, options=(*_DRIVES, *_RELAXES)),
        "canonical": Start(("canonical", "configuration"), _EITHER, options=(*_DRIVES, *_RELAXES)),
        "euler-lagrange": Start(
            ("configuration", "canonical"), _LAGRANGIAN, options=(*_DRIVES, *_RELAXES)
        ),
        "newton": Start(("configuration", "poisson"), (), "newton"),
        "alignment": Start(("configuration", "poisson"), (), "newton", emitted=False),
        "nonholonomic": _IN_FRAME,
        "hamel": replace(_IN_FRAME, emitted=False),
    }
)


def energies_of(route: str, kinds: tuple[str, ...]) -> tuple[str, ...]:
    """The tables of which a route takes one: a bracket that pairs nothing knows no Lagrangian."""
    energies = STARTS[route].energies
    if "poisson" in kinds and "canonical" not in kinds:
        return tuple(each for each in energies if each != "lagrangian")
    return energies


def is_in_frame(file: SpecFile) -> bool:
    """Whether the state has velocities along a frame: what constraints bind, or their routes move.

    >>> is_in_frame(SpecFile.model_construct(constraints=None, routes=["hamel"]))
    True
    """
    return file.constraints is not None or any(STARTS[route].in_frame for route in file.routes)


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
