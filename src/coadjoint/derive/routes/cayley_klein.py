r"""The Cayley-Klein route: Lagrange's equations for unit quaternions.

Theorem (Holm 2011, sections 4.1 to 4.1.3): the attitude of a body is a quaternion q up to sign, its
angular velocity :math:`\Omega = 2\,\mathrm{Im}(q^{-1} \dot q)`, and what is fixed in space,
:math:`a_0`, is seen from it as :math:`a = q^{-1} a_0 q`. Of the Lagrangian

.. math::
    L(q, \dot q) = l\bigl(2\,\mathrm{Im}(q^{-1} \dot q),\; q^{-1} a_0 q\bigr)

Lagrange's equations :math:`p = \partial L/\partial\dot q`, :math:`\dot p = \partial L/\partial q`
are taken as they stand. L does not change where q is scaled; with
:math:`\dot q = q \Omega / 2` the length of q stays what it is. The momentum in the body is

.. math::
    \Pi = \tfrac12 \mathrm{Im}(q^* p), \qquad
    \dot\Pi = \tfrac12 \mathrm{Im}(\dot q^* p + q^* \dot p),

and torques come out of :math:`\partial L/\partial q` through a(q). Everything is a product of
quaternions; no cross product, hat or bracket occurs. A right-invariant system multiplies in the
other order: :math:`\Omega = 2\,\mathrm{Im}(\dot q q^{-1})`.
Comes in: a Setting with a Lagrangian on so(3), whose advected quantities are vectors or the unit
quaternion itself. Goes out: Equations in the Chart (q, Pi, a_0) that covers the rotations twice, or
in the declared state where that has the quaternion. Read next: `coadjoint.groups.quaternions`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

from coadjoint.algebra import algebra_by_name, same_constants
from coadjoint.algebra.representation import adjoint
from coadjoint.derive.charts import in_chart
from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.emission import emit_in_momenta
from coadjoint.derive.mechanics.legendre import legendre
from coadjoint.derive.records import Relation, Step, write_rates, write_step
from coadjoint.derive.refusals import refusal
from coadjoint.derive.setting import Setting
from coadjoint.derive.symbols import choose_names
from coadjoint.exact import Element
from coadjoint.groups.quaternions import Quaternion
from coadjoint.spec import Spec
from coadjoint.spec.model import Variable

ROUTE = "cayley-klein"
HALF = Fraction(1, 2)


def symbols(spec: Spec) -> tuple[str, ...]:
    """``q0 .. q3``, and what is fixed in space: ``Gamma_space1``; none where q is declared."""
    if _declared_quaternion(spec) is not None:
        return ()
    fixed = [f"{v.name}_space{n + 1}" for v in spec.having_role("advected") for n in range(3)]
    return choose_names(spec, ["q0", "q1", "q2", "q3", *fixed])


def _declared_quaternion(spec: Spec) -> Variable | None:
    """The quaternion of the declared state, if it has one."""
    return next((v for v in spec.having_role("advected") if v.form == "quaternion"), None)


@dataclass(frozen=True)
class _Body:
    """A body in terms of its Cayley-Klein parameters.

    Attributes:
        setting: What was declared.
        q: The attitude.
        omega: The angular velocity, a pure quaternion.
        seen: What is fixed in space, as the body sees it, by name.
    """

    setting: Setting
    q: Quaternion
    omega: Quaternion
    seen: Mapping[str, Quaternion]

    def product(self, *factors: Quaternion) -> Quaternion:
        """The product in the order of a left-invariant system, reversed for a right one."""
        whole, *others = factors if self.setting.sign == 1 else factors[::-1]
        for factor in others:
            whole = whole * factor
        return whole

    @property
    def seen_components(self) -> dict[str, Element]:
        """The same by component."""
        return {
            name: value
            for variable in self.setting.advected
            if variable.name in self.seen
            for name, value in zip(
                variable.components, self.seen[variable.name].vector, strict=True
            )
        }

    @property
    def q_rate(self) -> Quaternion:
        """``dq/dt = q Omega / 2``."""
        return HALF * self.product(self.q, self.omega)


def derive(setting: Setting) -> Equations:
    """Equations of motion by Lagrange's equations for unit quaternions.

    Raises:
        DerivationError: The algebra is not so(3), or what is advected is not a vector.
    """
    check_rotations(setting)
    body = _body(setting)
    momentum_rate = _momentum_rate(body, _slopes(body, setting.lagrangian))
    if _declared_quaternion(setting.spec) is not None:
        rates = setting.in_state_order(momentum_rate, _advection(body))
        motion = emit_in_momenta(setting, ROUTE, rates, ())
    else:
        motion = _in_chart(body, momentum_rate)
    return replace(motion, steps=_steps(body, motion))


def check_rotations(setting: Setting) -> None:
    """The motions are rotations, and what is advected is turned by them as vectors are."""
    algebra, rotations = setting.algebra, algebra_by_name("so(3)")
    if not same_constants(algebra, rotations):
        raise refusal(
            setting,
            ROUTE,
            f"the algebra is {algebra.name}",
            algebra.name,
            "so(3), or another basis with [e1, e2] = e3 and cyclic",
        )
    turning = tuple(map(dict, adjoint(rotations).matrices))
    for variable in setting.advected:
        action = setting.actions[variable.name]
        if variable.form != "quaternion" and tuple(map(dict, action.matrices)) != turning:
            raise refusal(
                setting,
                ROUTE,
                f"{variable.name} has the representation {action.name!r}",
                action.name,
                "vectors or the unit quaternion, on which quaternions act by products",
            )


def _body(setting: Setting) -> _Body:
    """The attitude and what it sees, in the declared state or in symbols of this route."""
    omega = Quaternion.pure(setting.elements(setting.velocities))
    declared = _declared_quaternion(setting.spec)
    vectors = [each for each in setting.advected if each.form != "quaternion"]
    if declared is not None:
        q = Quaternion(*setting.elements(declared.components))
        seen = {v.name: Quaternion.pure(setting.elements(v.components)) for v in vectors}
        return _Body(setting, q, omega, seen)
    names = symbols(setting.spec)
    q = Quaternion(*setting.elements(names[:4]))
    turned = _Body(setting, q, omega, {})
    fixed = [Quaternion.pure(setting.elements(names[n : n + 3])) for n in range(4, len(names), 3)]
    # the inverse would do as well as q*, since the length of q is 1 here, but not be polynomial
    seen = {v.name: turned.product(q.conjugate, a, q) for v, a in zip(vectors, fixed, strict=True)}
    return _Body(setting, q, omega, seen)


def _slopes(body: _Body, lagrangian: Element) -> Quaternion:
    """``q^* dL/dq`` at ``dq/dt = q Omega / 2``, by the chain rule through Omega(q) and a(q).

    For a small change e of q, with ``h = q^-1 e``: ``d(q^-1) = -h q^-1``, so that Omega changes by
    ``-Im(h Omega)`` and a by ``a h - h a``.
    """
    setting, field = body.setting, body.setting.field
    image = body.seen_components
    names = list(image)
    slopes = field.gradient(lagrangian, names)
    dl_da = dict(zip(names, (field.substitute(s, image) for s in slopes), strict=True))
    pi = setting.elements(setting.momenta)
    slopes_along = []
    for h in Quaternion.units():  # e = q h, so these are the components of q* dL/dq
        turn = body.product(h, body.omega)
        total = [-mu * x for mu, x in zip(pi, turn.vector, strict=True)]
        for variable in setting.advected:
            if variable.name in body.seen:
                a = body.seen[variable.name]
                change = (body.product(a, h) - body.product(h, a)).vector
                pairs = zip(variable.components, change, strict=True)
                total += [dl_da[name] * x for name, x in pairs]
        slopes_along.append(field.sum(field.zero + x for x in total))
    declared = _declared_quaternion(setting.spec)
    if declared is not None:  # l may know the attitude itself
        own = Quaternion(*field.gradient(lagrangian, declared.components))
        slopes_along = [
            f + x
            for f, x in zip(
                slopes_along, body.product(body.q.conjugate, own).components, strict=True
            )
        ]
    return Quaternion(*slopes_along)


def _momentum_rate(body: _Body, slopes: Quaternion) -> tuple[Element, ...]:
    """``dPi/dt = Im((dq/dt)^* p + q^* dp/dt) / 2`` with ``q^* p = 2 Pi``.

    ``p = dL/d(dq/dt)`` pairs e with ``<Pi, 2 Im(q^-1 e)>``; so ``q^* p = 2 Pi``, and
    ``(dq/dt)^* = Omega^* q^* / 2``.
    """
    pi = Quaternion.pure(body.setting.elements(body.setting.momenta))
    turning = body.product(body.omega.conjugate, pi)
    whole = HALF * (turning + slopes)
    return body.setting.field.vector(whole.vector)


def _advection(body: _Body) -> dict[str, tuple[Element, ...]]:
    """``dq/dt`` and ``da/dt = (a Omega - Omega a)/2`` in the declared state."""
    field = body.setting.field
    rates = {
        name: field.vector(
            (HALF * (body.product(a, body.omega) - body.product(body.omega, a))).vector
        )
        for name, a in body.seen.items()
    }
    declared = _declared_quaternion(body.setting.spec)
    assert declared is not None, "the chart has no advected quantities"
    return rates | {declared.name: field.vector(body.q_rate.components)}


def _in_chart(body: _Body, momentum_rate: tuple[Element, ...]) -> Equations:
    """The motion of q, Pi and the fixed vectors, which stand still."""
    setting, field = body.setting, body.setting.field
    names = symbols(setting.spec)
    image = body.seen_components
    rates = dict(zip(names[:4], field.vector(body.q_rate.components), strict=True))
    rates |= zip(setting.momenta, momentum_rate, strict=True)
    rates |= dict.fromkeys(names[4:], field.zero)
    definitions = legendre(setting).definitions
    velocities = [(name, field.substitute(x, image)) for name, x in definitions]
    length = [Relation("dot(q, q) = 1", field.vector((body.q.norm - 1,))[0])]
    through = _through(setting)
    return in_chart(setting, ROUTE, rates, image, through, relations=length, definitions=velocities)


def _through(setting: Setting) -> str:
    """The map in words."""
    cover = "the double cover of the rotations by unit quaternions"
    sides = ("q* ", " q") if setting.sign == 1 else ("q ", " q*")
    seen = [f"{v.name} = {sides[0]}{v.name}_space{sides[1]}" for v in setting.advected]
    return ", ".join((cover, *seen))


def _steps(body: _Body, motion: Equations) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    law, latex = (
        "Omega = 2 Im(q^-1 dq/dt),  a = q^-1 a0 q",
        r"\Omega = 2\,\mathrm{Im}(q^{-1} \dot q), \qquad a = q^{-1} a_0 q",
    )
    q_star_p, star_latex = "q* p", "q^* p"
    if body.setting.sign == -1:
        law = "Omega = 2 Im(dq/dt q^-1),  a = q a0 q^-1"
        latex = r"\Omega = 2\,\mathrm{Im}(\dot q q^{-1}), \qquad a = q a_0 q^{-1}"
        q_star_p, star_latex = "p q*", "p q^*"
    lagrangian = body.setting.lagrangian
    return (
        write_step(
            "Lagrangian", "l(Omega, a)", r"l(\Omega, a)", {"l": lagrangian}, by="stationary-action"
        ),
        write_step("Attitude as a quaternion", law, latex, body.seen_components, by="quaternions"),
        write_step(
            "Angular velocity",
            "Omega solved from Pi = dl/dOmega",
            r"\Omega = \Omega(\Pi, a)",
            motion.exact.definitions,
            by="legendre",
        ),
        write_step(
            "Lagrange's equations for q",
            f"p = dL/d(dq/dt),  dp/dt = dL/dq,  Pi = Im({q_star_p})/2",
            r"p = \partial L / \partial \dot q, \quad \dot p = \partial L / \partial q, \quad "
            rf"\Pi = \tfrac12 \mathrm{{Im}}({star_latex})",
            write_rates(motion.variables, motion.exact.rates),
            by="cayley-klein",
        ),
    )
