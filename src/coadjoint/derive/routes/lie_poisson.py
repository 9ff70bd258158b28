r"""The Lie-Poisson route: from a Hamiltonian on the dual of a (semidirect product) Lie algebra.

Theorem (Holm 2011, sections 2.5.2 and 9.4): with the bracket

.. math::
    \{f, h\}_\mp(x) = \mp \langle x, [\partial f/\partial x, \partial h/\partial x] \rangle

of the semidirect product that holds momenta and advected quantities, minus for left-invariant and
plus for right-invariant systems, the motion is :math:`\dot x = \{x, h\}`, as in
`coadjoint.derive.routes.poisson`.
Comes in: a Setting with a Hamiltonian, or with a Lagrangian whose Legendre transform gives one.
Goes out: Equations, with the velocities :math:`\xi = \partial h/\partial\mu` as definitions where
the spec names them. Read next: `coadjoint.prove.equivalence`.
"""

from __future__ import annotations

from coadjoint.derive.equations import Equations
from coadjoint.derive.fields.hamiltonian import field_equations
from coadjoint.derive.mechanics.legendre import hamiltonian
from coadjoint.derive.routes.poisson import hamiltonian_equations
from coadjoint.derive.setting import Setting
from coadjoint.derive.structure import momentum_algebra


def derive(setting: Setting) -> Equations:
    """Equations of motion by the Lie-Poisson bracket.

    Raises:
        DerivationError: Neither a Hamiltonian nor an invertible Legendre transform is there.
    """
    if setting.spec.space is not None:
        return field_equations(setting, "lie-poisson")
    sign = "-" if setting.sign == 1 else ""
    law = (
        f"Lie-Poisson bracket on the dual of {momentum_algebra(setting).name}",
        f"{{x_i, x_j}} = {sign}c_ij^k x_k",
        rf"\{{x_i, x_j\}} = {sign}c_{{ij}}^k x_k",
    )
    h, solves = hamiltonian(setting)
    return hamiltonian_equations(setting, "lie-poisson", h, law, solves)
