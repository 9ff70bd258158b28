r"""Diffeomorphisms of the circle: their Euler-Poincare equation, from the variation of a velocity.

The velocity :math:`u = \dot g \circ g^{-1}` of a motion g of the circle varies by
:math:`\delta u = \eta_t + u \eta_s - u_s \eta`, with :math:`\eta = \delta g \circ g^{-1}`. So the
integral of :math:`\langle m, \delta u \rangle`, :math:`m = \partial l/\partial u`, is stationary if

.. math:: m_t = E_\eta (m (u \eta_s - u_s \eta) + c\, \eta_s u_{ss})
    = -(u m_s + 2 u_s m) - c\, u_{sss},

with the Euler operator by eta, and the cocycle of Virasoro's algebra for a central charge c
(Khesin and Wendt 2009, The Geometry of Infinite-Dimensional Groups, section II.2).
Comes in: a Setting with a Lagrangian. Goes out: Equations in jets of m.
Read next: `coadjoint.derive.fields.structure`, where the bracket is.
"""

from __future__ import annotations

from coadjoint.derive.equations import Equations
from coadjoint.derive.fields.emission import emit_fields
from coadjoint.derive.fields.jets import Jets, depth, jets_of
from coadjoint.derive.fields.structure import central_charge
from coadjoint.derive.records import write_rates, write_slopes, write_step
from coadjoint.derive.setting import Setting, fault, once
from coadjoint.exact import Element
from coadjoint.spec import Spec
from coadjoint.spec.sections.space import jet_name

#: The variation of the motion, whose derivatives are symbols like those of a field.
VARIED = "_eta"


def symbols(spec: Spec) -> tuple[str, ...]:
    """Names of the variation and its derivatives."""
    if spec.diffeomorphisms is None or spec.space is None:
        return ()
    return tuple(jet_name(VARIED, spec.space.name, n) for n in range(depth(spec) + 1))


def euler_poincare(setting: Setting, route: str) -> Equations:
    """The Euler-Poincare equation on the circle.

    Raises:
        DerivationError: The velocity is no function of the momentum at each point.
    """
    u, (m,) = velocity(setting), setting.elements(setting.state)
    jets = jets_of(setting)
    varied = symbols(setting.spec)
    eta, eta_s = setting.elements(varied[:2])
    charge = central_charge(setting)
    integrand = m * (u * eta_s - jets.total(u) * eta) + charge * eta_s * jets.total(u, 2)
    both = Jets(setting.field, {**jets.towers, VARIED: varied})
    rate = both.euler(integrand, VARIED)
    steps = (
        write_step("Lagrangian", "l(u)", "l(u)", {"l": setting.lagrangian}),
        write_step(
            "Momentum",
            "m = dl/du",
            r"m = \partial l / \partial u",
            write_slopes("l", [_name(setting)], [_slope(setting)]),
        ),
        write_step(
            "Variation: delta u = eta_t + u eta_s - u_s eta, integrated by parts",
            "dm/dt = E_eta(m (u eta_s - u_s eta) + c eta_s u_ss)",
            r"\dot m = E_\eta (m (u \eta_s - u_s \eta) + c\, \eta_s u_{ss})",
            write_rates(setting.state, [rate]),
        ),
    )
    return emit_fields(setting, route, [rate], steps, energy(setting))


def _name(setting: Setting) -> str:
    """The name of the velocity."""
    (velocity,) = setting.spec.having_role("velocity")
    return velocity.name


def _slope(setting: Setting) -> Element:
    """``dl/du``."""
    return setting.field.derivative(setting.lagrangian, _name(setting))


@once
def velocity(setting: Setting) -> Element:
    """The velocity in terms of the momentum.

    Raises:
        DerivationError: It is no function of the momentum at each point.
    """
    field, name, formula = setting.field, _name(setting), setting.spec.lagrangian
    assert formula is not None, "the reader asks for a Lagrangian on this route"
    slope = _slope(setting)
    named = {c for each in setting.spec.jets for c in each.components}
    mass = field.derivative(slope, name)
    if field.reach(setting.lagrangian) & named or field.reach(mass) & {name, *setting.state}:
        message = (
            f"the momentum dl/d{name} is no multiple of {name} at each point; expected a "
            f"Lagrangian that is quadratic in {name}, without its derivatives."
        )
        raise fault(setting, formula, message, formula.text)
    if field.is_zero(mass):
        message = f"the Lagrangian has no kinetic energy of {name}; expected one."
        raise fault(setting, formula, message, formula.text)
    (m,) = setting.elements(setting.state)
    return (m - field.substitute(slope, {name: field.zero})) / mass


@once
def energy(setting: Setting) -> Element:
    """The density of the energy, ``m u - l``."""
    u, (m,) = velocity(setting), setting.elements(setting.state)
    return m * u - setting.field.substitute(setting.lagrangian, {_name(setting): u})
