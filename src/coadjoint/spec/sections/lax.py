"""Lax pairs: the table [lax], two matrices that name the spectral parameter.

Comes in: its keys. Goes out: a `Lax` with two square matrices of one size. Whether
``dL/dt = [L, M]`` is a claim that the certificate decides.
Read next: `coadjoint.derive.routes.lax`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from pydantic import Field

from coadjoint.spec.core.formulas import Formula, Scope, misfit
from coadjoint.spec.core.names import NAME
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading, Table
from coadjoint.spec.core.shapes import FUNCTIONS, words
from coadjoint.spec.core.values import Number
from coadjoint.spec.sections.variables import motion_roles, state_roles


class LaxPart(Part):
    """A Lax pair, ``dL/dt = [L, M]`` for every value of the spectral parameter."""

    spectral: str = Field("lambda", description="name of the spectral parameter in L and M")
    L: str = Field(description="a square matrix of state, parameters and the spectral parameter")
    M: str = Field(description="the same of velocities too: how L turns")
    values: list[Number] = Field(
        [],
        description="of fields around a circle: numbers in the place of the spectral parameter, "
        'which the trace of the holonomy of L is computed, as [0.5, "1/3"]',
    )


@dataclass(frozen=True)
class Lax:
    """A declared Lax pair: ``dL/dt = [L, M]`` for every value of the spectral parameter.

    Attributes:
        spectral: Name of the spectral parameter.
        L: The matrix.
        M: How it turns.
        values: Numbers for which the trace of the holonomy of L is computed.
    """

    spectral: str
    L: Formula
    M: Formula
    values: tuple[Fraction, ...] = ()


def read_lax(reading: Reading, part: LaxPart) -> Lax:
    """The declared pair.

    Raises:
        SpecError: The spectral parameter has a taken name, or L and M are not square matrices of
            one size.
    """
    others = {part.spectral: ()}
    of_state = reading.scope("L of a Lax pair", state_roles(reading), others, driven=())
    of_motion = reading.scope("M of a Lax pair", motion_roles(reading), others, driven=())
    _check_spectral(reading, part.spectral)
    L = _read_square(reading, "L", part.L, of_state)
    M = _read_square(reading, "M", part.M, of_motion)
    if L.shape != M.shape:
        raise misfit(reading.source, ("lax", "M"), M, f"{words(L.shape)}, as L is")
    _check_values(reading, part.values)
    return Lax(part.spectral, L, M, tuple(part.values))


def _check_values(reading: Reading, values: Sequence[Fraction]) -> None:
    """There is a circle, and no value twice."""
    space, key = reading.file.space, ("lax", "values")
    if not values:
        return
    if not space or any(each.ends != "periodic" for each in space.values()):
        problem, expected = "values are given, and there is no circle", "none"
        hint = "Remove values, or write [space] without ends."
        raise reading.source.fault(key, problem, "values", expected, hint)
    for place, value in enumerate(values):
        if value in values[:place]:
            problem = f"the value {value} is there twice"
            raise reading.source.fault((*key, place), problem, str(value), "each once")


def _check_spectral(reading: Reading, name: str) -> None:
    """The spectral parameter has a name of its own; it may be a keyword, since no code names it."""
    if not NAME.fullmatch(name) or name in reading.owners or name in FUNCTIONS:
        problem = f"{name!a} cannot name the spectral parameter"
        expected = "a name that nothing else has, such as 'lambda'"
        raise reading.fault(("lax", "spectral"), problem, name, expected)


def _read_square(reading: Reading, which: str, text: str, scope: Scope) -> Formula:
    """One of the two matrices."""
    key: KeyPath = ("lax", which)
    formula = reading.formula(key, text, scope, any_shape=True)
    if len(formula.shape) != 2 or formula.shape[0] != formula.shape[1]:
        hint = "Write hat(a) for the matrix of a vector a, diag(a) for a diagonal one."
        raise misfit(reading.source, key, formula, "a square matrix", hint)
    return formula


LAX = Table[Lax | None](
    "lax",
    LaxPart,
    "a Lax pair of the motion",
    read_lax,
    routed=True,
    example='L = "hat(Pi)" and M = "hat(Omega)"',
)
