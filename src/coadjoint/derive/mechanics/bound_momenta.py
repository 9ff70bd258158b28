r"""Singular Lagrangians over an algebra: the momenta that follow, and the bracket of what is left.

Where :math:`\partial^2 l/\partial\xi^2` has no inverse, momenta and advected quantities x = (mu, a)
are bound to functions :math:`\phi = 0`, by the steps of `coadjoint.derive.mechanics.bound`. Each of
them gives a component of x, which follows. Where all velocities are determined on what is left, the
motion there has Dirac's bracket

.. math:: \{f, g\}_D = \{f, g\} - \{f, \phi_i\}\,(C^{-1})_{ij}\,\{\phi_j, g\}, \qquad
    C_{ij} = \{\phi_i, \phi_j\},

with the Lie-Poisson bracket of all of x.
Comes in: a Setting with a Lagrangian over an algebra. Goes out: velocities, rates and bracket.
Read next: `coadjoint.derive.routes.first_order`.

Source:
    Dirac (1964), Lectures on Quantum Mechanics, lectures 1 and 2.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from coadjoint.derive.mechanics.bound import Constraints, check_bound
from coadjoint.derive.mechanics.configuration import Matrix, inverse_in_blocks, mechanics
from coadjoint.derive.mechanics.external import external_forces
from coadjoint.derive.mechanics.singular import constraints_of, laws
from coadjoint.derive.setting import Setting, lagrangian_fault, once
from coadjoint.errors import DerivationError
from coadjoint.exact import Element
from coadjoint.exact.dense import add, apply, product, transpose
from coadjoint.poisson import PoissonStructure


@dataclass(frozen=True)
class BoundMomenta:
    """A singular Lagrangian over an algebra, within its constraints.

    Attributes:
        setting: The spec and its field.
        known: The constraints, all of them solved.
        velocities: All of them, in the state.
        rates: Of momenta and advected quantities, in the state and the velocities.
        energy: ``<mu, xi> - l`` in the state.
    """

    setting: Setting
    known: Constraints
    velocities: Mapping[str, Element]
    rates: Mapping[str, Element]
    energy: Element

    @property
    def bound(self) -> Mapping[str, Element]:
        """What follows, by name, in the state."""
        return self.known.bound

    @cached_property
    def surface(self) -> tuple[tuple[Element, ...], ...]:
        """The gradient of each constraint ``x - x(state)`` by (mu, a)."""
        field, names = self.setting.field, list(self.rates)
        return tuple(
            field.gradient(field[name] - value, names) for name, value in self.bound.items()
        )

    def restrict(self, whole: PoissonStructure) -> Matrix:
        """Dirac's bracket of the state.

        Args:
            whole: The bracket of momenta and advected quantities, in the order of the rates.

        Raises:
            DerivationError: The brackets of the constraints have no inverse.
        """
        tensor, across = self._put(whole.tensor), self._across(whole)
        if self.bound:
            lost = product(product(across, self._inner(across)), transpose(across))
            tensor = self._put(add(tensor, lost))
        places = self._places
        return tuple(tuple(tensor[i][j] for j in places) for i in places)

    def push(self, whole: PoissonStructure) -> tuple[Element, ...]:
        """What forces add to the rates of the state: those along constraints are taken up by these.

        Raises:
            DerivationError: The brackets of the constraints have no inverse.
        """
        setting, field = self.setting, self.setting.field
        acting = external_forces(setting, setting.velocities)
        still = [field.zero] * (len(self.rates) - len(acting))
        forces = [field.substitute(force, self.bound) for force in (*acting, *still)]
        if self.bound and any(forces):
            across = self._across(whole)
            taken = apply(self._inner(across), apply(self.surface, forces))
            lost = apply(across, taken)
            forces = [force - part for force, part in zip(forces, lost, strict=True)]
        return tuple(field.substitute(forces[i], self.bound) for i in self._places)

    @property
    def _places(self) -> list[int]:
        return [list(self.rates).index(name) for name in self.setting.state]

    def _across(self, whole: PoissonStructure) -> Matrix:
        """``{x, phi_i}``."""
        return self._put(product(self._put(whole.tensor), transpose(self.surface)))

    def _inner(self, across: Matrix) -> Matrix:
        """``C^-1``."""
        crossed = product(self.surface, across)
        return inverse_in_blocks(self.setting.field, crossed, self._refuse)

    def _put(self, matrix: Matrix) -> Matrix:
        """A matrix on the constraints."""
        field = self.setting.field
        return tuple(
            tuple(field.substitute(field.zero + x, self.bound) for x in row) for row in matrix
        )

    def _refuse(self, problem: str, _: object) -> DerivationError:
        message = (
            f"the matrix of the brackets of its constraints {problem}, so that the motion has no "
            f"bracket. Constraints in their order: {self.known.chain}. Choose other coordinates."
        )
        return lagrangian_fault(self.setting, message)


@once
def bound_momenta(setting: Setting) -> BoundMomenta:
    """The declared Lagrangian within its constraints.

    Raises:
        DerivationError: It is not quadratic in the velocities, or does not determine the motion.
    """
    of, field = mechanics(setting), setting.field
    names = (*setting.momenta, *setting.advected_names)
    known = constraints_of(of, [name for name in names if name not in setting.state])
    if known is None:
        message = (
            "the equations of the Lagrangian are not linear in the velocities at given momenta; "
            "expected a Lagrangian that is at most quadratic in the velocities, and forces that "
            "are linear in them, on the route first-order. Give the energy of the velocities in "
            "simpler terms, or a [hamiltonian] and the route lie-poisson."
        )
        raise lagrangian_fault(setting, message)
    known.follow()
    check_bound(setting, names, setting.velocities, known)
    velocities = dict(zip(setting.velocities, known.solution, strict=True))
    put = {**known.bound}
    moved = {x: field.substitute(rate, put) for x, rate in laws(of).items()}
    pairs = zip(setting.momenta, setting.velocities, strict=True)
    energy = field.sum(field[mu] * field[xi] for mu, xi in pairs) - of.lagrangian
    energy = field.substitute(field.substitute(energy, put), velocities)
    return BoundMomenta(
        setting=setting, known=known, velocities=velocities, rates=moved, energy=energy
    )
