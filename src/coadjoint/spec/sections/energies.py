"""Energies: the tables [lagrangian] and [hamiltonian], of which a route takes one.

Comes in: their keys. Goes out: a `Formula` each. Read next: `coadjoint.spec.sections.poisson`.
"""

from __future__ import annotations

from pydantic import Field

from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.reading import Reading, Table, if_present
from coadjoint.spec.sections.variables import position_roles, state_roles


class LagrangianPart(Part):
    """The reduced Lagrangian."""

    l: str = Field(description="l of velocities, advected quantities and parameters")  # noqa: E741


class HamiltonianPart(Part):
    """The reduced Hamiltonian."""

    h: str = Field(description="h of momenta, advected quantities or coordinates, and parameters")


def read_lagrangian(reading: Reading) -> Formula | None:
    """L of the velocities and positions, if it is declared."""
    part = reading.file.lagrangian
    if part is None:
        return None
    scope = reading.scope("a Lagrangian", ("velocity", *position_roles(reading)))
    return reading.formula(("lagrangian", "l"), part.l, scope)


def read_hamiltonian(reading: Reading) -> Formula | None:
    """H of the state, if it is declared."""
    part = reading.file.hamiltonian
    if part is None:
        return None
    scope = reading.scope("a Hamiltonian", state_roles(reading))
    return reading.formula(("hamiltonian", "h"), part.h, scope)


LAGRANGIAN = Table[Formula | None](
    key="lagrangian",
    kind=LagrangianPart | None,
    field=Field(None, description="the reduced Lagrangian"),
    read=read_lagrangian,
    formulas=if_present,
    routed=True,
    example='l = "dot(Omega, diag(I)*Omega)/2"',
)
HAMILTONIAN = Table[Formula | None](
    key="hamiltonian",
    kind=HamiltonianPart | None,
    field=Field(None, description="the reduced Hamiltonian"),
    read=read_hamiltonian,
    formulas=if_present,
    routed=True,
    example='h = "dot(Pi, inverse(diag(I))*Pi)/2"',
)
