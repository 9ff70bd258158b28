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

On a strand g(s, t) the principle has :math:`\langle \nu, g^{-1} g_s - \Xi \rangle` in addition,
with the strain :math:`\Xi` varied like the velocity, and :math:`\epsilon(s, t)` has an
Euler-Lagrange equation in both variables. That its mixed derivatives are equal gives the rate of
the strain.
Comes in: a Setting with a Lagrangian. Goes out: Equations with velocities as definitions.
Read next: `coadjoint.derive.routes.clebsch`, where the advected quantities vary instead of g.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from coadjoint.derive.equations import Equations
from coadjoint.derive.fields.emission import close, emit_fields
from coadjoint.derive.fields.jets import jets_of
from coadjoint.derive.mechanics.emission import emit_in_momenta, show_momenta, show_velocities
from coadjoint.derive.mechanics.legendre import legendre
from coadjoint.derive.records import Step, write_rates, write_step
from coadjoint.derive.setting import Setting
from coadjoint.derive.symbols import choose_names
from coadjoint.exact import Element
from coadjoint.spec import Spec


def symbols(spec: Spec) -> tuple[str, ...]:
    """Exponential coordinates of the group and their rates: ``eps1``, ``deps1``.

    On a strand also their derivatives along space, ``seps1``.
    """
    assert spec.algebra is not None, "the reader asks for an algebra on this route"
    numbers = range(1, spec.algebra.dimension + 1)
    letters = ("eps", "deps") if spec.space is None else ("eps", "deps", "seps")
    return choose_names(spec, [f"{letter}{n}" for letter in letters for n in numbers])


def derive(setting: Setting) -> Equations:
    """Equations of motion by the Hamilton-Pontryagin principle.

    Raises:
        DerivationError: The Lagrangian has no invertible Legendre transform.
    """
    action = action_near(setting, setting.lagrangian, setting.elements(setting.momenta))
    momentum, advected = momentum_equation(setting, action), advection(setting, action)
    if setting.spec.space is not None:
        return _derive_fields(setting, action, momentum, advected)
    rates = setting.in_state_order(momentum, advected)
    steps = _steps(setting, action, rates)
    return emit_in_momenta(setting, "hamilton-pontryagin", rates, steps)


@dataclass(frozen=True)
class Action:
    """The integrand, to first order in the coordinates of g.

    Attributes:
        coordinates: Names of eps.
        rates: Names of its time derivative.
        moved: The advected quantities at ``g0 exp(eps)``, by component.
        integrand: ``l(xi, a(eps)) + <mu, g^-1 dg/dt - xi>``, and ``<nu, g^-1 dg/ds - Xi>`` on a
            strand.
        slopes: Names of the derivatives of eps along space, on a strand.
        turned: ``g^-1 dg/dt`` and, on a strand, ``g^-1 dg/ds``.
    """

    coordinates: tuple[str, ...]
    rates: tuple[str, ...]
    moved: Mapping[str, Element]
    integrand: Element
    slopes: tuple[str, ...] = ()
    turned: tuple[tuple[Element, ...], ...] = ()


def action_near(setting: Setting, lagrangian: Element, momenta: Sequence[Element]) -> Action:
    """The action near the point where the motion is.

    Args:
        setting: The spec and the field.
        lagrangian: l of all velocities.
        momenta: mu, symbols or what they are equal to.
    """
    field, n = setting.field, setting.algebra.dimension
    names = symbols(setting.spec)
    eps, *ways = (setting.elements(names[k : k + n]) for k in range(0, len(names), n))
    moved: dict[str, Element] = {}
    pairings = [(momenta, setting.elements(setting.velocities))]
    for variable in setting.advected:
        a = setting.elements(variable.components)
        if variable.strain:
            pairings.append((field.gradient(lagrangian, variable.components), a))
            continue
        change = setting.actions[variable.name].act(eps, a)
        pairs = zip(variable.components, a, change, strict=True)
        moved |= {name: x - setting.sign * dx for name, x, dx in pairs}
    turned = tuple(_turn(setting, eps, along) for along in ways)
    pairing = [
        mu * (value - given)
        for (multipliers, velocity), values in zip(pairings, turned, strict=False)
        for mu, value, given in zip(multipliers, values, velocity, strict=True)
    ]
    integrand = field.substitute(lagrangian, moved) + field.sum(pairing)
    return Action(
        coordinates=names[:n],
        rates=names[n : 2 * n],
        moved=moved,
        integrand=integrand,
        slopes=names[2 * n :],
        turned=turned,
    )


def _turn(
    setting: Setting, eps: Sequence[Element], along: Sequence[Element]
) -> tuple[Element, ...]:
    """``g^-1 dg`` of exponential coordinates and their derivatives, to first order in eps."""
    turning = setting.field.vector(setting.algebra.bracket(eps, along))
    return tuple(x - setting.sign * y / 2 for x, y in zip(along, turning, strict=True))


def _at_the_motion(setting: Setting, action: Action, element: Element) -> Element:
    """An element at eps = 0, deps/dt = xi: what the variations of mu say."""
    rates = zip(action.rates, setting.elements(setting.velocities), strict=True)
    here = dict(rates) | dict.fromkeys(action.coordinates, setting.field.zero)
    here |= zip(action.slopes, _strains(setting), strict=False)
    return setting.field.substitute(element, here)


def momentum_equation(setting: Setting, action: Action) -> tuple[Element, ...]:
    """Euler-Lagrange of eps: ``d/dt dL/deps' = dL/deps``, solved for dmu/dt.

    ``dL/deps'`` is ``mu`` plus a part linear in eps, whose rate is known since eps' = xi. eps''
    does not occur: L is linear in eps'.
    """
    field = setting.field
    forces = field.gradient(action.integrand, action.coordinates)
    rates = list(forces)
    for names in filter(None, (action.rates, action.slopes)):
        for n, name in enumerate(names):
            slopes = field.gradient(field.derivative(action.integrand, name), action.coordinates)
            rates[n] -= field.sum(s * field[x] for s, x in zip(slopes, names, strict=True))
    return tuple(_at_the_motion(setting, action, rate) for rate in rates)


def _strains(setting: Setting) -> tuple[Element, ...]:
    """The strain of a strand; empty without one."""
    return tuple(x for v in setting.advected if v.strain for x in setting.elements(v.components))


def _derive_fields(
    setting: Setting,
    action: Action,
    momentum: Sequence[Element],
    advected: Mapping[str, list[Element]],
) -> Equations:
    """The equations of a strand, in jets alone."""
    field, jets, moving = setting.field, jets_of(setting), dict(advected)
    momentum = [close(setting, rate) for rate in momentum]
    for each in (v for v in setting.advected if v.strain):
        nu = field.gradient(setting.lagrangian, each.components)
        momentum = [m - jets.total(close(setting, x)) for m, x in zip(momentum, nu, strict=True)]
        along = (jets.total(close(setting, xi)) for xi in setting.elements(setting.velocities))
        mixed = _mixed_derivatives(setting, action)
        moving[each.name] = [x + close(setting, y) for x, y in zip(along, mixed, strict=True)]
    closed = {name: [close(setting, x) for x in values] for name, values in moving.items()}
    rates = setting.in_state_order(momentum, closed)
    steps = _steps(setting, action, rates)
    energy = close(setting, legendre(setting).energy)
    return emit_fields(setting, "hamilton-pontryagin", rates, steps, energy)


def _mixed_derivatives(setting: Setting, action: Action) -> list[Element]:
    """``d/dt g^-1 g_s - d/ds g^-1 g_t`` at eps = 0, where ``eps_st`` cancels."""
    field, (in_time, in_space) = setting.field, action.turned

    def carry(value: Element, along: Sequence[str]) -> Element:
        slopes = field.gradient(value, action.coordinates)
        return field.sum(s * field[x] for s, x in zip(slopes, along, strict=True))

    return [
        _at_the_motion(setting, action, carry(b, action.rates) - carry(a, action.slopes))
        for a, b in zip(in_time, in_space, strict=True)
    ]


def advection(setting: Setting, action: Action) -> dict[str, list[Element]]:
    """``da/dt`` along ``g0 exp(eps)`` with eps' = xi, per advected quantity."""
    field = setting.field

    def advect(name: str) -> Element:
        slopes = field.gradient(action.moved[name], action.coordinates)
        pairs = zip(slopes, setting.elements(setting.velocities), strict=True)
        total = field.sum(slope * xi for slope, xi in pairs if slope)
        return _at_the_motion(setting, action, total)

    free = (each for each in setting.advected if not each.strain)
    return {each.name: [advect(name) for name in each.components] for each in free}


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
            by="hamilton-pontryagin",
        ),
        show_momenta(setting, "Variation of xi: the Legendre relation"),
        show_velocities(setting),
        write_step(
            f"Variation of mu: the reconstruction {motion[0]}",
            f"{motion[0]}, that is deps/dt = xi at eps = 0",
            rf"{motion[1]}, \qquad \dot\epsilon = \xi",
            write_rates(moving, map(by_name.__getitem__, moving)),
            by="hamilton-pontryagin",
        ),
        write_step(
            "Variation of g: the momentum equation",
            "d/dt dL/d(deps/dt) = dL/deps at eps = 0",
            r"\frac{d}{dt} \frac{\partial L}{\partial \dot\epsilon} "
            r"= \frac{\partial L}{\partial \epsilon}",
            write_rates(setting.momenta, map(by_name.__getitem__, setting.momenta)),
            by="hamilton-pontryagin",
        ),
    )
