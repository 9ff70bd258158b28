"""Routes: what each one starts from and which module follows it. A route is registered here alone.

Comes in: nothing. Goes out: a table by the names that specs use, from which the schema, the checks
of specs and `coadjoint.derive.registry` read. A new route is one line here and one module of
`coadjoint.derive.routes`.
Read next: `coadjoint.spec.consistency`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType


@dataclass(frozen=True)
class Route:
    """A way from a spec to its equations of motion.

    Attributes:
        name: As specs write it.
        kinds: The kinds of spec that it goes with, of those that `coadjoint.spec.kinds` names.
        energies: The tables of which it takes one; empty if it takes none.
        table: A table of its own, without which it cannot start; "" if none.
        options: Tables of its own that may be left out.
        in_frame: Whether the state has velocities along a frame, which constraints may bind; on the
            other routes it has momenta, or velocities of coordinates.
        emitted: Whether it may be the first of a spec. What moves in variables of its own, or
            leaves multipliers out, is there to be proved equal.
        takes_driving: Whether inputs and time may act.
        needs_energy: Whether it must have one of its energies.
        is_first_order: Whether all velocities follow from the state, in which the Lagrangian is of
            first order.
        is_hamiltonian: Whether it starts from a Hamiltonian, which constraints that are imposed
            before the variation give.
        moves_fields: Whether it moves fields along [space], too.
    """

    name: str
    kinds: tuple[str, ...]
    energies: tuple[str, ...] = ()
    table: str = ""
    options: tuple[str, ...] = ()
    in_frame: bool = False
    emitted: bool = True
    takes_driving: bool = True
    needs_energy: bool = True
    is_first_order: bool = False
    is_hamiltonian: bool = False
    moves_fields: bool = False

    @property
    def module(self) -> str:
        """Name of its module in `coadjoint.derive.routes`."""
        return self.name.replace("-", "_")


_LAGRANGIAN, _HAMILTONIAN = ("lagrangian",), ("hamiltonian",)
_EITHER = ("hamiltonian", "lagrangian")
_ALGEBRA = ("algebra",)
#: What has a group, of matrices or of diffeomorphisms.
_GROUPS = ("algebra", "diffeomorphisms")
_SPACE = ("configuration", "poisson")
#: What acts in addition to the energy, on routes where a rate of momenta is known.
_ACTS = ("forces", "dissipation", "double_bracket", "metriplectic")
#: The same where the state has momenta, which Hamiltonians of noise move.
_ACTS_ON_MOMENTA = (*_ACTS, "noise")
_on_algebra = partial(Route, kinds=_ALGEBRA, energies=_LAGRANGIAN, options=_ACTS_ON_MOMENTA)
_chart = partial(Route, kinds=_ALGEBRA, energies=_LAGRANGIAN, emitted=False)
_in_frame = partial(
    Route,
    kinds=("algebra", "configuration"),
    energies=_LAGRANGIAN,
    options=("constraints", *_ACTS),
    in_frame=True,
)
_lax = partial(Route, energies=_EITHER, takes_driving=False)

_ROUTES = (
    _on_algebra("euler-poincare", kinds=_GROUPS, moves_fields=True),
    _on_algebra(
        "lie-poisson", kinds=_GROUPS, energies=_EITHER, is_hamiltonian=True, moves_fields=True
    ),
    _on_algebra("hamilton-pontryagin", moves_fields=True),
    _chart("clebsch", options=("clebsch",)),
    _on_algebra("poincare"),
    _on_algebra("matrix-euler-poincare"),
    _on_algebra("newton-euler"),
    _chart("cayley-klein"),
    _chart("kaluza-klein"),
    Route(name="complexification", kinds=_ALGEBRA, energies=_HAMILTONIAN),
    _lax("manakov", _ALGEBRA),
    _lax("lax", ("algebra", *_SPACE), table="lax", needs_energy=False, moves_fields=True),
    Route(name="nambu", kinds=("algebra", "nambu"), energies=_EITHER, options=_ACTS_ON_MOMENTA),
    Route(name="poisson", kinds=("poisson",), energies=_HAMILTONIAN, options=_ACTS_ON_MOMENTA),
    Route(
        name="canonical",
        kinds=("canonical", "configuration"),
        energies=_EITHER,
        options=_ACTS_ON_MOMENTA,
        is_hamiltonian=True,
    ),
    Route(
        name="euler-lagrange",
        kinds=("configuration", "canonical"),
        energies=_LAGRANGIAN,
        options=_ACTS,
    ),
    Route(
        name="first-order",
        kinds=("configuration", "poisson", "algebra"),
        energies=_LAGRANGIAN,
        options=("forces", "dissipation"),
        is_first_order=True,
    ),
    Route(name="newton", kinds=_SPACE, table="newton"),
    Route(name="alignment", kinds=_SPACE, table="newton", emitted=False),
    _in_frame("nonholonomic"),
    _in_frame("hamel", emitted=False),
    _in_frame("nonholonomic-hamilton-pontryagin", emitted=False),
)
#: Every route by its name.
ROUTES: Mapping[str, Route] = MappingProxyType({route.name: route for route in _ROUTES})


def energies_of(route: str, kinds: tuple[str, ...]) -> tuple[str, ...]:
    """The tables of which a route takes one: a bracket that pairs nothing knows no Lagrangian.

    One of first order has a bracket of its own, which is compared with that of the spec.
    """
    energies, is_first_order = ROUTES[route].energies, ROUTES[route].is_first_order
    if "poisson" in kinds and "canonical" not in kinds and not is_first_order:
        return tuple(each for each in energies if each != "lagrangian")
    return energies
