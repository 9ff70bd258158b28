"""Energies: the tables [lagrangian] and [hamiltonian], of which a route takes one.

Comes in: their keys. Goes out: a `Formula` each. Read next: `coadjoint.spec.sections.poisson`.
"""

from __future__ import annotations

from pydantic import Field

from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.reading import Reading, Table
from coadjoint.spec.sections.variables import position_roles, state_roles


class LagrangianPart(Part):
    """The reduced Lagrangian."""

    l: str = Field(description="l of velocities, advected quantities and parameters")  # noqa: E741


class HamiltonianPart(Part):
    """The reduced Hamiltonian."""

    h: str = Field(description="h of momenta, advected quantities or coordinates, and parameters")


def read_lagrangian(reading: Reading, part: LagrangianPart) -> Formula:
    """Read l of the velocities and positions."""
    scope = reading.scope("a Lagrangian", ("velocity", *position_roles(reading)))
    return reading.formula(("lagrangian", "l"), part.l, scope)


def read_hamiltonian(reading: Reading, part: HamiltonianPart) -> Formula:
    """Read h of the state."""
    scope = reading.scope("a Hamiltonian", state_roles(reading))
    return reading.formula(("hamiltonian", "h"), part.h, scope)


LAGRANGIAN = Table[Formula | None](
    "lagrangian",
    LagrangianPart,
    "the reduced Lagrangian",
    read_lagrangian,
    routed=True,
    example='l = "dot(Omega, diag(I)*Omega)/2"',
)
HAMILTONIAN = Table[Formula | None](
    "hamiltonian",
    HamiltonianPart,
    "the reduced Hamiltonian",
    read_hamiltonian,
    routed=True,
    example='h = "dot(Pi, inverse(diag(I))*Pi)/2"',
)
