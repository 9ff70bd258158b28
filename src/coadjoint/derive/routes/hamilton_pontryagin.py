r"""The Hamilton-Pontryagin route: velocity, momentum and group element vary independently.

Theorem (Holm 2011, sections 2.4.1 and 9.2): for a left-invariant Lagrangian, the principle

.. math::
    \delta \int l(\xi, g^{-1} a_0) + \langle \mu, g^{-1} \dot g - \xi \rangle \, dt = 0

gives by :math:`\delta\xi` the Legendre relation :math:`\mu = \partial l/\partial\xi`, by
:math:`\delta\mu` the reconstruction :math:`\dot g = g \xi`, and by :math:`\delta g` the momentum
equation. Right-invariant: :math:`g a_0` and :math:`\dot g g^{-1}`.

The variation of g is taken in exponential coordinates about the point where the motion is:

.. math::
    g = g_0 e^\epsilon, \quad g^{-1} \dot g = \dot\epsilon - [\epsilon, \dot\epsilon]/2 + \ldots,
    \quad a = a_0 - \rho(\epsilon) a_0 + \ldots

so that the momentum equation is the ordinary Euler-Lagrange equation of :math:`\epsilon` at
:math:`\epsilon = 0`. No coadjoint operator and no diamond is formed.
Comes in: a Setting with a Lagrangian. Goes out: Equations with velocities as definitions.
Read next: `coadjoint.derive.routes.clebsch`, where the advected quantities vary instead of g.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.emission import emit_in_momenta, show_momenta, show_velocities
from coadjoint.derive.records import Step, write_rates, write_step
from coadjoint.derive.setting import Setting
from coadjoint.derive.symbols import choose_names
from coadjoint.exact import Element
from coadjoint.spec import Spec


def symbols(spec: Spec) -> tuple[str, ...]:
    """Exponential coordinates of the group and their rates: ``eps1``, ``deps1``."""
    assert spec.algebra is not None, "the reader asks for an algebra on this route"
    numbers = range(1, spec.algebra.dimension + 1)
    return choose_names(spec, [f"{letter}{n}" for letter in ("eps", "deps") for n in numbers])


def derive(setting: Setting) -> Equations:
    """Equations of motion by the Hamilton-Pontryagin principle.

    Raises:
        DerivationError: The Lagrangian has no invertible Legendre transform.
    """
    action = action_near(setting, setting.lagrangian, setting.elements(setting.momenta))
    rates = setting.in_state_order(momentum_equation(setting, action), advection(setting, action))
    steps = _steps(setting, action, rates)
    return emit_in_momenta(setting, "hamilton-pontryagin", rates, steps)


@dataclass(frozen=True)
class Action:
    """The integrand, to first order in the coordinates of g.

    Attributes:
        coordinates: Names of eps.
        rates: Names of its time derivative.
        moved: The advected quantities at ``g0 exp(eps)``, by component.
        integrand: ``l(xi, a(eps)) + <mu, g^-1 dg/dt - xi>``.
    """

    coordinates: tuple[str, ...]
    rates: tuple[str, ...]
    moved: Mapping[str, Element]
    integrand: Element


def action_near(setting: Setting, lagrangian: Element, momenta: Sequence[Element]) -> Action:
    """The action near the point where the motion is.

    Args:
        setting: The spec and the field.
        lagrangian: l of all velocities.
        momenta: mu, symbols or what they are equal to.
    """
    field, n = setting.field, setting.algebra.dimension
    names = symbols(setting.spec)
    eps, deps = setting.elements(names[:n]), setting.elements(names[n:])
    moved: dict[str, Element] = {}
    for variable in setting.advected:
        a = setting.elements(variable.components)
        change = setting.actions[variable.name].act(eps, a)
        pairs = zip(variable.components, a, change, strict=True)
        moved |= {name: x - setting.sign * dx for name, x, dx in pairs}
    turning = field.vector(setting.algebra.bracket(eps, deps))
    constraint = [
        rate - setting.sign * turn / 2 - xi
        for rate, turn, xi in zip(deps, turning, setting.elements(setting.velocities), strict=True)
    ]
    pairing = zip(momenta, constraint, strict=True)
    integrand = field.substitute(lagrangian, moved) + field.sum(mu * c for mu, c in pairing)
    return Action(names[:n], names[n:], moved, integrand)


def _at_the_motion(setting: Setting, action: Action, element: Element) -> Element:
    """An element at eps = 0, deps/dt = xi: what the variations of mu say."""
    rates = zip(action.rates, setting.elements(setting.velocities), strict=True)
    here = dict(rates) | dict.fromkeys(action.coordinates, setting.field.zero)
    return setting.field.substitute(element, here)


def momentum_equation(setting: Setting, action: Action) -> tuple[Element, ...]:
    """Euler-Lagrange of eps: ``d/dt dL/deps' = dL/deps``, solved for dmu/dt.

    ``dL/deps'`` is ``mu`` plus a part linear in eps, whose rate is known since eps' = xi. eps''
    does not occur: L is linear in eps'.
    """
    field = setting.field
    forces = field.gradient(action.integrand, action.coordinates)
    rates = []
    for name, force in zip(action.rates, forces, strict=True):
        slopes = field.gradient(field.derivative(action.integrand, name), action.coordinates)
        carried = (s * field[xi] for s, xi in zip(slopes, action.rates, strict=True))
        rates.append(_at_the_motion(setting, action, force - field.sum(carried)))
    return tuple(rates)


def advection(setting: Setting, action: Action) -> dict[str, list[Element]]:
    """``da/dt`` along ``g0 exp(eps)`` with eps' = xi, per advected quantity."""
    field = setting.field

    def advect(name: str) -> Element:
        slopes = field.gradient(action.moved[name], action.coordinates)
        pairs = zip(slopes, setting.elements(setting.velocities), strict=True)
        total = field.sum(slope * xi for slope, xi in pairs if slope)
        return _at_the_motion(setting, action, total)

    return {each.name: [advect(name) for name in each.components] for each in setting.advected}


def _steps(setting: Setting, action: Action, rates: tuple[Element, ...]) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    velocity, motion = ("g^-1 dg/dt", r"g^{-1} \dot g"), ("dg/dt = g xi", r"\dot g = g \xi")
    near = ("g = g0 exp(eps)", r"g = g_0 e^\epsilon")
    if setting.sign == -1:
        velocity, motion = ("dg/dt g^-1", r"\dot g g^{-1}"), ("dg/dt = xi g", r"\dot g = \xi g")
        near = ("g = exp(eps) g0", r"g = e^\epsilon g_0")
    by_name = dict(zip(setting.state, rates, strict=True))
    moving = [*action.coordinates, *(n for n in setting.state if n not in setting.momenta)]
    by_name |= zip(action.coordinates, setting.elements(setting.velocities), strict=True)
    return (
        write_step(
            "Hamilton-Pontryagin action",
            f"L = l(xi, a) + <mu, {velocity[0]} - xi>,  {near[0]}, first order in eps",
            rf"L = l(\xi, a) + \langle \mu, {velocity[1]} - \xi \rangle, \qquad {near[1]}",
            {"L": action.integrand},
        ),
        show_momenta(setting, "Variation of xi: the Legendre relation"),
        show_velocities(setting),
        write_step(
            f"Variation of mu: the reconstruction {motion[0]}",
            f"{motion[0]}, that is deps/dt = xi at eps = 0",
            rf"{motion[1]}, \qquad \dot\epsilon = \xi",
            write_rates(moving, map(by_name.__getitem__, moving)),
        ),
        write_step(
            "Variation of g: the momentum equation",
            "d/dt dL/d(deps/dt) = dL/deps at eps = 0",
            r"\frac{d}{dt} \frac{\partial L}{\partial \dot\epsilon} "
            r"= \frac{\partial L}{\partial \epsilon}",
            write_rates(setting.momenta, map(by_name.__getitem__, setting.momenta)),
        ),
    )
