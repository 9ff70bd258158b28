r"""Dissipation by a symmetric bracket where velocities along a frame are the state.

The Poisson bracket J is one of momenta :math:`M = \partial l/\partial\eta` and positions z. With

.. math:: T = \frac{\partial (M, z)}{\partial (\eta, z)}
    = \begin{pmatrix} \mathcal{M} & N \\ 0 & 1 \end{pmatrix}, \qquad
    J\,\partial h = J \begin{pmatrix} \eta \\ -\partial_z l \end{pmatrix},
    \qquad v = T^{-1} J\,\partial h

and a G of the state (eta, z), a double bracket adds :math:`w = J\,T^{-T} G\,v` to the rates of
(M, z), and a metriplectic one :math:`w = T G\,\partial S`. So the kernel solves
:math:`\mathcal{M} \dot\eta = k + w_M - N w_z`, and :math:`\dot z` gains :math:`w_z`.
Comes in: a Setting whose spec declares such a bracket. Goes out: w and what it adds.
Read next: `coadjoint.derive.mechanics.constrained`, which adds it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from coadjoint.derive.mechanics.almost_poisson import Tensor, almost_poisson
from coadjoint.derive.mechanics.configuration import (
    Matrix,
    Mechanics,
    inverse_in_blocks,
    mechanics,
    moves_along_frame,
)
from coadjoint.derive.mechanics.distribution import Row
from coadjoint.derive.mechanics.external import metric, symbols
from coadjoint.derive.mechanics.solver import Definition
from coadjoint.derive.setting import Setting, fault, once
from coadjoint.errors import DerivationError
from coadjoint.exact import Element
from coadjoint.exact.dense import apply, dot, transpose
from coadjoint.spec.sections.relaxation import Relaxation


@dataclass(frozen=True)
class Relaxed:
    """A symmetric bracket along a frame that nothing binds.

    Attributes:
        setting: The spec and its field.
        declared: What the spec declares.
    """

    setting: Setting
    declared: Relaxation

    @cached_property
    def definitions(self) -> list[Definition]:
        """The rates v by the bracket alone, which a double bracket uses twice."""
        names, state, field = symbols(self.setting.spec), self.setting.state, self.setting.field
        if not names:
            return []
        slopes = [
            field[x] if x in self._momenta else -field.derivative(self.setting.lagrangian, x)
            for x in state
        ]
        rates = self._name(apply(self._tensor, slopes))
        forces = apply(self._inverse, self._without_positions(rates))
        rates |= zip(self._momenta, forces, strict=True)
        return [(name, rates[x]) for name, x in zip(names, state, strict=True)]

    @cached_property
    def added(self) -> dict[str, Element]:
        """W by the names of the state."""
        G, state = metric(self.setting), self.setting.state
        if self.declared.S is None:
            covector = apply(G, self.setting.elements(symbols(self.setting.spec)))
            return self._name(apply(self._tensor, self._pull(covector)))
        S = self.setting.formula(self.declared.S)
        turn = (self._momenta.get(x, self.setting.field[x]) for x in state)
        slopes = [self.setting.field.gradient(value, state) for value in turn]
        return self._name(apply(slopes, apply(G, self.setting.field.gradient(S, state))))

    @cached_property
    def closed(self) -> dict[str, Element]:
        """W in the state, without the names of v."""
        known, field = dict(self.definitions), self.setting.field
        return {x: field.substitute(value, known) for x, value in self.added.items()}

    @cached_property
    def forces(self) -> Row:
        """``w_M - N w_z`` along each velocity of the frame."""
        return self._without_positions(self.added)

    # -- the change of coordinates ------------------------------------------------------------

    @property
    def _mechanics(self) -> Mechanics:
        return mechanics(self.setting)

    @cached_property
    def _momenta(self) -> dict[str, Element]:
        """M by the velocities that they are of."""
        return dict(zip(self._mechanics.frame.velocities, self._mechanics.momenta, strict=True))

    @cached_property
    def _positions(self) -> list[str]:
        return [x for x in self.setting.state if x not in self._momenta]

    @cached_property
    def _mixed(self) -> Matrix:
        """N."""
        field = self.setting.field
        return tuple(field.gradient(M, self._positions) for M in self._momenta.values())

    @cached_property
    def _tensor(self) -> Tensor:
        tensor = almost_poisson(self.setting)
        assert tensor is not None, "a free motion has a bracket"
        return tensor

    @cached_property
    def _inverse(self) -> Matrix:
        """The inverse of the mass matrix.

        Raises:
            DerivationError: It is singular, or couples too many velocities to be written out.
        """
        return inverse_in_blocks(self.setting.field, self._mechanics.mass, self._refuse)

    def _refuse(self, problem: str, places: Sequence[int]) -> DerivationError:
        """Why velocities cannot be solved for."""
        names = ", ".join(self._mechanics.frame.velocities[i] for i in places)
        message = (
            f"[{self.declared.table}] acts through the inverse of the mass matrix d2l/d({names})2, "
            f"which {problem}. Write dissipation of velocities in [dissipation]."
        )
        return fault(self.setting, self.declared.G, message, names)

    def _name(self, values: Sequence[Element]) -> dict[str, Element]:
        return dict(zip(self.setting.state, values, strict=True))

    def _without_positions(self, rates: dict[str, Element]) -> Row:
        """Rates of momenta less what positions make of these, ``N dz/dt``."""
        moved = [rates[z] for z in self._positions]
        pairs = zip(self._momenta, self._mixed, strict=True)
        return tuple(rates[x] - dot(row, moved) if row else rates[x] for x, row in pairs)

    def _pull(self, covector: Row) -> Row:
        """``T^-T`` times a covector of the state."""
        named = self._name(covector)
        along = apply(self._inverse, [named[x] for x in self._momenta])
        named |= zip(self._momenta, along, strict=True)
        turned = apply(transpose(self._mixed), [named[x] for x in self._momenta])
        named |= {z: named[z] - x for z, x in zip(self._positions, turned, strict=True)}
        return tuple(named.values())


@once
def relaxed(setting: Setting) -> Relaxed | None:
    """The declared symmetric bracket where velocities along a frame are the state."""
    spec = setting.spec
    if spec.relaxation is None or not (spec.in_frame or moves_along_frame(setting)):
        return None
    return Relaxed(setting, spec.relaxation)
