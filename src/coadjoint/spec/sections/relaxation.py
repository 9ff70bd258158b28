"""Relaxation: the tables [double_bracket] and [metriplectic], dissipation by a symmetric bracket.

Comes in: their keys. Goes out: a `Relaxation`, or None. That G is symmetric and positive
semidefinite is proved later. Read next: `coadjoint.spec.sections.domain`.
"""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import Field

from coadjoint.spec.core.formulas import Formula, misfit
from coadjoint.spec.core.parts import Accept, Part
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading, Table
from coadjoint.spec.sections.state import state_of
from coadjoint.spec.sections.variables import VARIABLES, motion_roles, state_roles


class DoubleBracketPart(Part):
    """Dissipation along the symplectic leaves: Casimirs are kept, the energy falls."""

    G: str = Field(description="symmetric, positive semidefinite: a number, or a matrix")
    accept: Accept = None


class MetriplecticPart(Part):
    """Dissipation along level sets of the energy: it is kept, the entropy S grows."""

    S: str = Field(description="the entropy, a Casimir")
    G: str = Field(description="symmetric, positive semidefinite, with G dh = 0")
    accept: Accept = None


@dataclass(frozen=True)
class Relaxation:
    """Dissipation by a symmetric bracket, in addition to the Poisson bracket P.

    Attributes:
        G: Symmetric and positive semidefinite: a scalar, times the unit matrix, or a matrix with a
            row for each component of the state.
        S: The entropy of a metriplectic motion, ``dx/dt = P dh + G dS``; None for a double
            bracket, ``dx/dt = P dh + P G P dh``.
    """

    G: Formula
    S: Formula | None = None

    @property
    def table(self) -> str:
        """The table of a spec that declares it."""
        return "double_bracket" if self.S is None else "metriplectic"

    @property
    def added(self) -> str:
        """What it adds to the rates of the state."""
        return "P G P dh" if self.S is None else "G dS"


def read_double_bracket(reading: Reading, part: DoubleBracketPart) -> Relaxation:
    """Dissipation that keeps Casimirs.

    Raises:
        SpecError: G has another size than the state, or the state has velocities.
    """
    return Relaxation(_read_metric(reading, "double_bracket", part.G))


def read_metriplectic(reading: Reading, part: MetriplecticPart) -> Relaxation:
    """Dissipation that keeps the energy.

    Raises:
        SpecError: As `read_double_bracket`, or both are declared.
    """
    if reading.file.double_bracket is not None:
        problem = "there are both [double_bracket] and [metriplectic]"
        expected = "one of them: the first keeps Casimirs, the second the energy"
        hint = "Remove [metriplectic] or [double_bracket]."
        raise reading.fault(("metriplectic",), problem, "metriplectic", expected, hint)
    G = _read_metric(reading, "metriplectic", part.G)
    scope = reading.scope("an entropy", state_roles(reading), driven=())
    return Relaxation(G, reading.formula(("metriplectic", "S"), part.S, scope))


def _read_metric(reading: Reading, table: str, text: str) -> Formula:
    """G: a scalar, or a matrix with a row for each component of the state."""
    key: KeyPath = (table, "G")
    _check_bracket(reading, table)
    scope = reading.scope("a metric", motion_roles(reading))
    G = reading.formula(key, text, scope, any_shape=True)
    size = sum(len(each.components) for each in state_of(VARIABLES.of(reading)))
    if G.shape not in ((), (size, size)):
        matrix = f"a {size} x {size} matrix with a row for each component of the state"
        raise misfit(reading.source, key, G, f"a number, or {matrix}")
    return G


def _check_bracket(reading: Reading, table: str) -> None:
    """The state has a bracket, which nothing binds.

    Raises:
        SpecError: Constraints bind it, or no Lagrangian gives the momenta of its velocities.
    """
    file, key = reading.file, (table,)
    moving = [v for v in state_of(VARIABLES.of(reading)) if v.role == "velocity"]
    if file.constraints is not None:
        raise reading.fault(
            key,
            f"there are [{table}] and [constraints]: G may move positions otherwise than the "
            "velocities do, which the constraints bind",
            table,
            "one of the two",
            f"Remove [{table}], and write dissipation of velocities in [dissipation].",
        )
    if moving and file.lagrangian is None and file.poisson is None:
        raise reading.fault(
            key,
            f"the state has the velocity {moving[0].name!r} and no [lagrangian] gives its momentum",
            moving[0].name,
            "a bracket of the state",
            "Declare [lagrangian] and a route that takes it, or [poisson].",
        )


DOUBLE_BRACKET = Table[Relaxation | None](
    "double_bracket",
    DoubleBracketPart,
    "dissipation that keeps Casimirs, dx/dt = P dh + P G P dh",
    read_double_bracket,
    attribute="relaxation",
    acts=True,
)
METRIPLECTIC = Table[Relaxation | None](
    "metriplectic",
    MetriplecticPart,
    "dissipation that keeps the energy, dx/dt = P dh + G dS",
    read_metriplectic,
    attribute="relaxation",
    acts=True,
)
