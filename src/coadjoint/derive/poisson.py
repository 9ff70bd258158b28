r"""The Poisson route: from a Hamiltonian and any Poisson bracket of the state.

Theorem (Holm 2011, section 2.5.1): with a bracket that is bilinear, antisymmetric, a derivation and
satisfies the Jacobi identity, the motion of every function is :math:`\dot f = \{f, h\}`, so
:math:`\dot x_i = \{x_i, x_j\}\, \partial h / \partial x_j`.
Comes in: a Setting with a Hamiltonian and a declared bracket. Goes out: Equations.
Read next: `coadjoint.derive.lie_poisson`, where an algebra gives the bracket.
"""

from __future__ import annotations

from itertools import combinations

from coadjoint.derive.equations import Equations, Exact, Step, bracket, partial, rate, symbol
from coadjoint.derive.observables import observables
from coadjoint.derive.setting import Setting
from coadjoint.derive.structure import poisson_structure
from coadjoint.exact import Element

#: Title, text and LaTeX of the step that states the bracket.
Law = tuple[str, str, str]


def derive(setting: Setting) -> Equations:
    """Equations of motion by the declared bracket.

    Raises:
        DerivationError: A formula divides by zero.
    """
    formula = setting.spec.hamiltonian
    assert formula is not None, "the reader asks for a Hamiltonian on this route"
    law = ("Poisson bracket of the coordinates", "{x_i, x_j}", r"\{x_i, x_j\}")
    return hamiltonian_equations(setting, "poisson", setting.formula(formula), law)


def hamiltonian_equations(setting: Setting, route: str, h: Element, law: Law) -> Equations:
    """``dx/dt = {x, h}`` by the bracket of the state.

    Where the spec names velocities, ``xi = dh/dmu`` are definitions that the rates use.
    """
    field, tensor = setting.field, poisson_structure(setting).tensor
    gradient = dict(zip(setting.state, field.gradient(h, setting.state), strict=True))
    pairs = zip(setting.velocities, setting.momenta, strict=bool(setting.velocities))
    definitions = tuple((velocity, gradient[momentum]) for velocity, momentum in pairs)
    named = gradient | {
        momentum: field[velocity]
        for velocity, momentum in zip(setting.velocities, setting.momenta, strict=False)
    }
    slopes = [named[x] for x in setting.state]
    rates = field.vector(
        sum(entry * slope for entry, slope in zip(row, slopes, strict=True) if entry != 0)
        for row in tensor
    )
    exact = Exact(definitions, rates, h, observables(setting, h), tensor)
    return Equations(setting, route, exact, _steps(setting, exact, gradient, law))


def _steps(
    setting: Setting, exact: Exact, gradient: dict[str, Element], law: Law
) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    state = setting.state
    brackets = tuple(
        (bracket(a, b), exact.poisson_tensor[i][j])
        for (i, a), (j, b) in combinations(enumerate(state), 2)
        if exact.poisson_tensor[i][j] != 0
    )
    return (
        Step("Hamiltonian", "h(x)", "h(x)", ((symbol("h"), exact.energy),)),
        Step(*law, brackets),
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
