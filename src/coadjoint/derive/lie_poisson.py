r"""The Lie-Poisson route: from a Hamiltonian on the dual of a (semidirect product) Lie algebra.

Theorem (Holm 2011, sections 2.5.2 and 9.4): with the bracket

.. math::
    \{f, h\}_\mp(x) = \mp \langle x, [\partial f/\partial x, \partial h/\partial x] \rangle

of the semidirect product that holds momenta and advected quantities, minus for left-invariant and
plus for right-invariant systems, the motion is :math:`\dot x = \{x, h\}`.
Comes in: a Setting with a Hamiltonian, or with a Lagrangian whose Legendre transform gives one.
Goes out: Equations, with the velocities :math:`\xi = \partial h/\partial\mu` as definitions where
the spec names them. Read next: `coadjoint.prove.equivalence`.
"""

from __future__ import annotations

from itertools import combinations

from coadjoint.derive.equations import Equations, Exact, Step, bracket, partial, rate, symbol
from coadjoint.derive.legendre import legendre_transform
from coadjoint.derive.observables import observables
from coadjoint.derive.setting import Setting
from coadjoint.derive.structure import momentum_algebra, poisson_tensor
from coadjoint.exact import Element


def derive(setting: Setting) -> Equations:
    """Equations of motion by the Lie-Poisson bracket.

    Raises:
        DerivationError: Neither a Hamiltonian nor an invertible Legendre transform is there.
    """
    field, h = setting.field, hamiltonian(setting)
    tensor = poisson_tensor(setting)
    gradient = dict(zip(setting.state, field.gradient(h, setting.state), strict=True))
    pairs = zip(setting.velocities, setting.momenta, strict=bool(setting.velocities))
    definitions = tuple((velocity, gradient[momentum]) for velocity, momentum in pairs)
    named = gradient | {
        momentum: field[velocity]
        for velocity, momentum in zip(setting.velocities, setting.momenta, strict=False)
    }
    rates = field.vector(
        sum(entry * named[x] for entry, x in zip(row, setting.state, strict=True)) for row in tensor
    )
    exact = Exact(definitions, rates, h, observables(setting, h), tensor)
    return Equations(setting, "lie-poisson", exact, _steps(setting, exact, gradient))


def hamiltonian(setting: Setting) -> Element:
    """The declared Hamiltonian, or the Legendre transform of the declared Lagrangian."""
    spec = setting.spec
    if spec.hamiltonian is not None:
        return setting.formula(spec.hamiltonian)
    assert spec.lagrangian is not None, "the reader asks for a Hamiltonian or a Lagrangian"
    transform = legendre_transform(setting, setting.formula(spec.lagrangian))
    velocities = dict(zip(setting.velocities, transform.velocities, strict=True))
    return setting.field.substitute(transform.energy, velocities)


def _steps(setting: Setting, exact: Exact, gradient: dict[str, Element]) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    sign, state = "-" if setting.sign == 1 else "", setting.state
    brackets = tuple(
        (bracket(a, b), exact.poisson_tensor[i][j])
        for (i, a), (j, b) in combinations(enumerate(state), 2)
        if exact.poisson_tensor[i][j] != 0
    )
    return (
        Step("Hamiltonian", "h(mu, a)", r"h(\mu, a)", ((symbol("h"), exact.energy),)),
        Step(
            f"Lie-Poisson bracket on the dual of {momentum_algebra(setting).name}",
            f"{{x_i, x_j}} = {sign}c_ij^k x_k",
            rf"\{{x_i, x_j\}} = {sign}c_{{ij}}^k x_k",
            brackets,
        ),
        Step(
            "Derivatives of the Hamiltonian",
            "dh/dx",
            r"\partial h / \partial x",
            tuple((partial("h", name), value) for name, value in gradient.items()),
        ),
        Step(
            "Hamilton's equations",
            "dx/dt = {x, h}",
            r"\dot x = \{x, h\}",
            tuple(zip(map(rate, state), exact.rates, strict=True)),
        ),
    )
