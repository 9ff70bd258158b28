r"""The Euler-Poincare route: from a reduced Lagrangian, with advected quantities.

Theorem (Holm 2011, sections 9.1 and 9.1.4; Holm, Marsden and Ratiu 1998): Hamilton's principle for
a left-invariant Lagrangian, with :math:`\delta\xi = \dot\eta + [\xi, \eta]` and
:math:`\delta a = -\rho(\eta) a`, gives

.. math::
    \frac{d}{dt}\frac{\partial l}{\partial\xi} = \mathrm{ad}^*_\xi \frac{\partial l}{\partial\xi}
        + \frac{\partial l}{\partial a} \diamond a, \qquad \dot a = -\rho(\xi) a,

and a right-invariant one the same with the opposite sign of the right-hand sides. Coordinates q
next to the algebra move by :math:`\dot p = \partial l/\partial q`, p being the slope of l by their
velocities.
Comes in: a Setting with a Lagrangian. Goes out: Equations in the momenta :math:`\mu = \partial
l/\partial\xi`, with the velocities as definitions. Read next:
`coadjoint.derive.routes.lie_poisson`, the same motion from a Hamiltonian.
"""

from __future__ import annotations

from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.emission import emit_in_momenta, show_momenta, show_velocities
from coadjoint.derive.records import Step, sign_text, write_rates, write_step
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element


def derive(setting: Setting) -> Equations:
    """Equations of motion by the Euler-Poincare theorem.

    Raises:
        DerivationError: The Lagrangian has no invertible Legendre transform.
    """
    rates = _rates(setting)
    return emit_in_momenta(setting, "euler-poincare", rates, _steps(setting, rates))


def _rates(setting: Setting) -> tuple[Element, ...]:
    """Right-hand sides in state, velocities and parameters, in the order of the state."""
    sign, xi = setting.sign, setting.elements(setting.velocities)
    mu = setting.elements(setting.momenta)
    momentum = list(setting.algebra.ad_star(xi, mu))
    advected = {}
    for variable in setting.advected:
        action = setting.actions[variable.name]
        a = setting.elements(variable.components)
        dl_da = setting.field.gradient(setting.lagrangian, variable.components)
        torque = action.diamond(dl_da, a)
        momentum = [m + t for m, t in zip(momentum, torque, strict=True)]
        advected[variable.name] = [-sign * x for x in action.act(xi, a)]
    return setting.in_state_order(
        [sign * m for m in momentum], advected, _rates_of_coordinates(setting)
    )


def _rates_of_coordinates(setting: Setting) -> dict[str, Element]:
    """Euler and Lagrange's ``dq/dt = v, dp/dt = dl/dq`` of coordinates next to the algebra."""
    slopes = setting.field.gradient(setting.lagrangian, setting.positions)
    pairs = setting.conjugates[len(setting.momenta) :]
    rates = dict[str, Element]()
    for q, slope, (v, p, weight) in zip(setting.positions, slopes, pairs, strict=True):
        rates |= {q: setting.field[v], p: slope * weight}
    return rates


def _tell_coordinates(setting: Setting) -> str:
    """The law of coordinates next to the algebra; "" without any."""
    return ",  dq/dt = v,  dp/dt = dl/dq" if setting.positions else ""


def _steps(setting: Setting, rates: tuple[Element, ...]) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    back = "-" if setting.sign == 1 else ""
    turned = sign_text(setting.sign, "ad*_xi mu + dl/da <> a")
    turned_latex = sign_text(
        setting.sign, r"\mathrm{ad}^*_\xi \mu + (\partial l / \partial a) \diamond a"
    )
    return (
        write_step("Reduced Lagrangian", "l(xi, a)", r"l(\xi, a)", {"l": setting.lagrangian}),
        show_momenta(setting),
        show_velocities(setting),
        write_step(
            "Euler-Poincare equations and advection",
            f"dmu/dt = {turned},  da/dt = {back}rho(xi) a{_tell_coordinates(setting)}",
            rf"\dot\mu = {turned_latex}, \qquad \dot a = {back}\rho(\xi) a",
            write_rates(setting.state, rates),
        ),
    )
