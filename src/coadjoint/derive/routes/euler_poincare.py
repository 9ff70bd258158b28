r"""The Euler-Poincare route: from a reduced Lagrangian, with advected quantities.

Theorem (Holm 2011, section 9.1 (9.1.4); Holm, Marsden and Ratiu 1998): Hamilton's principle for
a left-invariant Lagrangian, with :math:`\delta\xi = \dot\eta + [\xi, \eta]` and
:math:`\delta a = -\rho(\eta) a`, gives

.. math::
    \frac{d}{dt}\frac{\partial l}{\partial\xi} = \mathrm{ad}^*_\xi \frac{\partial l}{\partial\xi}
        + \frac{\partial l}{\partial a} \diamond a, \qquad \dot a = -\rho(\xi) a,

and a right-invariant one the same with the opposite sign of the right-hand sides. Coordinates q
next to the algebra move by :math:`\dot p = \partial l/\partial q`, p being the slope of l by their
velocities.

On a strand g(s, t) the strain :math:`\Xi = g^{-1} g_s` is a field in addition, with
:math:`\delta\Xi = \eta_s + [\Xi, \eta]`: it is advected by the adjoint representation, and
moved by :math:`\partial_s \xi`; its momentum adds :math:`-\partial_s (\partial l/\partial\Xi)`
to the rate of mu (Holm, Ivanov and Percival 2012, arXiv:1109.4421).
Comes in: a Setting with a Lagrangian. Goes out: Equations in the momenta :math:`\mu = \partial
l/\partial\xi`, with the velocities as definitions. Read next:
`coadjoint.derive.routes.lie_poisson`, the same motion from a Hamiltonian.
"""

from __future__ import annotations

from coadjoint.derive.equations import Equations
from coadjoint.derive.fields import circle
from coadjoint.derive.fields.emission import close, emit_fields, strand_terms
from coadjoint.derive.mechanics.emission import emit_in_momenta, show_momenta, show_velocities
from coadjoint.derive.mechanics.legendre import legendre
from coadjoint.derive.records import Step, sign_text, write_rates, write_step
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element


def derive(setting: Setting) -> Equations:
    """Equations of motion by the Euler-Poincare theorem.

    Raises:
        DerivationError: The Lagrangian has no invertible Legendre transform.
    """
    if setting.spec.diffeomorphisms is not None:
        return circle.euler_poincare(setting, "euler-poincare")
    rates = _rates(setting)
    if setting.spec.space is not None:
        return _derive_fields(setting, rates)
    return emit_in_momenta(setting, "euler-poincare", rates, _steps(setting, rates))


def _derive_fields(setting: Setting, rates: tuple[Element, ...]) -> Equations:
    """The same with what derivatives along space add."""
    added = strand_terms(setting)
    whole = [
        close(setting, rate) + added.get(name, setting.field.zero)
        for name, rate in zip(setting.state, rates, strict=True)
    ]
    *steps, _ = _steps(setting, rates)
    turn = "+" if setting.sign == 1 else "-"
    turned = not all(each.strain for each in setting.advected)  # by something else than strains
    law = sign_text(setting.sign, "ad*_xi mu + ad*_Xi nu" + " + dl/da <> a" * turned)
    law_latex = sign_text(
        setting.sign,
        r"\mathrm{ad}^*_\xi \mu + \mathrm{ad}^*_\Xi \nu"
        + r" + (\partial l / \partial a) \diamond a" * turned,
    )
    steps.append(
        write_step(
            "Euler-Poincare equations of a strand, and compatibility of g_st = g_ts",
            f"dmu/dt = {law} - d nu/ds,  nu = dl/dXi,  dXi/dt = dxi/ds {turn} [Xi, xi]",
            rf"\dot\mu = {law_latex} - \partial_s \nu, \qquad "
            rf"\dot\Xi = \partial_s \xi {turn} [\Xi, \xi]",
            write_rates(setting.state, whole),
            by="strand",
        )
    )
    energy = close(setting, legendre(setting).energy)
    return emit_fields(setting, "euler-poincare", whole, steps, energy)


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


def _tell_coordinates(setting: Setting) -> tuple[str, str]:
    """The law of coordinates next to the algebra, as text and as LaTeX; "" without any."""
    if not setting.positions:
        return "", ""
    rates = r", \qquad \dot q = v, \qquad \dot p = \partial l / \partial q"
    return ",  dq/dt = v,  dp/dt = dl/dq", rates


def _steps(setting: Setting, rates: tuple[Element, ...]) -> tuple[Step, ...]:
    """The derivation as a person would write it down, with advection where there is some."""
    back = "-" if setting.sign == 1 else ""
    advected = setting.spec.having_role("advected")
    force, force_latex = " + dl/da <> a", r" + (\partial l / \partial a) \diamond a"
    carried, carried_latex = f",  da/dt = {back}rho(xi) a", rf", \qquad \dot a = {back}\rho(\xi) a"
    if not advected:
        force = force_latex = carried = carried_latex = ""
    rests = "advection" if advected else "euler-poincare"
    moved, moved_latex = _tell_coordinates(setting)
    turned = sign_text(setting.sign, f"ad*_xi mu{force}")
    turned_latex = sign_text(setting.sign, rf"\mathrm{{ad}}^*_\xi \mu{force_latex}")
    return (
        write_step(
            "Reduced Lagrangian",
            "l(xi, a)" if advected else "l(xi)",
            r"l(\xi, a)" if advected else r"l(\xi)",
            {"l": setting.lagrangian},
            by="euler-poincare",
        ),
        show_momenta(setting),
        show_velocities(setting),
        write_step(
            "Euler-Poincare equations and advection" if advected else "Euler-Poincare equations",
            f"dmu/dt = {turned}{carried}{moved}",
            rf"\dot\mu = {turned_latex}{carried_latex}{moved_latex}",
            write_rates(setting.state, rates),
            by=rests,
        ),
    )
