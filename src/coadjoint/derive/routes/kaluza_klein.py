r"""The Kaluza-Klein route: a potential linear in an advected quantity as geodesic motion.

Theorem (Holm 2011, section 8.5): with cyclic coordinates q next to the group, the Lagrangian

.. math::
    l_{KK}(\xi, a, \dot q) = T(\xi) + \tfrac12 |\dot q + a|^2

is quadratic. Its momentum :math:`p = \partial l_{KK}/\partial\dot q = \dot q + a` is conserved, and
since :math:`\partial l_{KK}/\partial a = p` too, the variations
:math:`\delta\xi = \dot\eta + [\xi, \eta]` and :math:`\delta a = -\rho(\eta) a` give

.. math::
    \langle\dot\mu, \eta\rangle = \langle\mu, [\xi, \eta]\rangle - p\cdot\rho(\eta) a, \qquad
    \dot a = -\rho(\xi) a, \qquad \dot p = 0.

On the level set :math:`p = \partial l/\partial a` it is the motion of :math:`l = T(\xi) + p \cdot
a`. For a right-invariant system the sign of :math:`\eta` is turned. The book's formula is partly
illegible; this form was reconstructed, and its equations are derived here.
Comes in: a Setting whose Lagrangian is linear in what is advected. Goes out: Equations in the
Chart of momenta, advected quantities and p. Read next: `coadjoint.prove.charts`.
"""

from __future__ import annotations

from dataclasses import replace

from coadjoint.derive.charts import in_chart
from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.configuration import Mechanics
from coadjoint.derive.mechanics.legendre import legendre_transform
from coadjoint.derive.records import (
    Relation,
    Step,
    sign_text,
    write_rates,
    write_slopes,
    write_step,
)
from coadjoint.derive.refusals import refusal
from coadjoint.derive.setting import Setting
from coadjoint.derive.symbols import choose_names
from coadjoint.exact import Element, element_text
from coadjoint.exact.dense import Vector, add, dot, scale, subtract
from coadjoint.spec import Spec
from coadjoint.spec.model import component_names

ROUTE = "kaluza-klein"


def symbols(spec: Spec) -> tuple[str, ...]:
    """Names of the velocities of the cyclic coordinates, then of their momenta."""
    count = sum(len(variable.components) for variable in spec.having_role("advected"))
    wanted = [name for letter in ("qdot", "p") for name in component_names(letter, (count,))]
    return choose_names(spec, wanted)


def derive(setting: Setting) -> Equations:
    """Equations of motion as geodesics with cyclic coordinates.

    Raises:
        DerivationError: Nothing is advected, or the Lagrangian is not linear in it, with slopes
            that are the same at all times.
    """
    lagrangian, names = setting.lagrangian, setting.advected_names
    level = _level(setting, lagrangian, names)
    field, a = setting.field, setting.elements(names)
    velocities, momenta = _cyclic(setting)
    qdot, p = setting.elements(velocities), setting.elements(momenta)
    kinetic = lagrangian - dot(level, a)
    whole = kinetic + dot(add(qdot, a), add(qdot, a)) / 2
    # p = dl/d qdot has the unit matrix before qdot: qdot = p - (dl/d qdot at rest)
    slopes = field.gradient(whole, velocities)
    solved = dict(zip(velocities, subtract(p, subtract(slopes, qdot)), strict=True))
    forces = [field.substitute(slope, solved) for slope in field.gradient(whole, names)]
    transform = legendre_transform(Mechanics(setting, kinetic))
    inner = dict(zip(setting.velocities, transform.velocities, strict=True))
    mu, xi = setting.elements(setting.momenta), setting.elements(setting.velocities)
    energy = field.substitute(dot(mu, xi) + dot(p, qdot) - whole, inner | solved)
    rates = dict(zip(setting.state, _rates(setting, forces), strict=True))
    rates |= dict.fromkeys(momenta, field.zero)
    relations = [
        Relation(f"{name} = {element_text(field, value)}", field[name] - value)
        for name, value in zip(momenta, level, strict=True)
    ]
    motion = in_chart(
        setting,
        ROUTE,
        rates,
        {},
        "p = dl/da",
        relations=relations,
        definitions=transform.definitions,
        energy=energy,
    )
    return replace(motion, steps=_steps(motion, whole, solved, level))


def _cyclic(setting: Setting) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of the velocities and of the momenta of the cyclic coordinates."""
    names = symbols(setting.spec)
    return names[: len(names) // 2], names[len(names) // 2 :]


def _level(setting: Setting, lagrangian: Element, names: tuple[str, ...]) -> Vector:
    """``dl/da``, the constant value of p."""
    if not names:
        raise refusal(
            setting,
            ROUTE,
            "nothing is advected",
            setting.spec.name,
            "an advected quantity, with which a cyclic coordinate turns the potential into "
            "kinetic energy; without a potential the motion is geodesic already",
        )
    slopes = setting.field.gradient(lagrangian, names)
    for name, slope in zip(names, slopes, strict=True):
        moving = setting.field.reach(slope) & {*setting.velocities, *names, *setting.time}
        if moving:
            text = element_text(setting.field, slope)
            raise refusal(
                setting,
                ROUTE,
                f"dl/d{name} = {text} depends on {', '.join(sorted(moving))}",
                text,
                "a Lagrangian linear in what is advected, such as T - m*g*dot(Gamma, chi)",
            )
    return slopes


def _rates(setting: Setting, forces: list[Element]) -> tuple[Element, ...]:
    """Coefficients of eta in the variation of the action, one basis vector after the other.

    Args:
        setting: The spec and the field.
        forces: ``dl_KK/da`` in terms of p, in the order of the advected components.
    """
    algebra, sign = setting.algebra, setting.sign
    xi, mu = setting.elements(setting.velocities), setting.elements(setting.momenta)
    momentum = []
    for j in range(algebra.dimension):
        eta = tuple(int(i == j) for i in range(algebra.dimension))
        varied = dot(mu, algebra.bracket(xi, eta))
        start = 0
        for variable in setting.advected:
            a = setting.elements(variable.components)
            shift = setting.actions[variable.name].act(eta, a)
            varied -= dot(forces[start : start + len(a)], shift)
            start += len(a)
        momentum.append(sign * varied)
    advected = {
        v.name: scale(-sign, setting.actions[v.name].act(xi, setting.elements(v.components)))
        for v in setting.advected
    }
    return setting.in_state_order(momentum, advected)


def _steps(
    motion: Equations, whole: Element, solved: dict[str, Element], level: Vector
) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    setting, energy = motion.setting, motion.exact.energy
    assert energy is not None, "this route has one"
    back = "-" if setting.sign == 1 else ""
    work = sign_text(setting.sign, "<mu, [xi, eta]> - p . rho(eta) a")
    work_latex = sign_text(setting.sign, r"\langle\mu, [\xi, \eta]\rangle - p \cdot \rho(\eta) a")
    momenta = setting.field.gradient(whole, setting.velocities)
    return (
        write_step(
            "Lagrangian with cyclic coordinates",
            "l = T(xi) + |dq/dt + a|^2/2",
            r"l = T(\xi) + \tfrac12 |\dot q + a|^2",
            {"l": whole},
            by="kaluza-klein",
        ),
        write_step(
            "Momenta",
            "mu = dl/dxi,  p = dl/d(dq/dt) = dq/dt + a",
            r"\mu = \partial l / \partial \xi, \quad p = \partial l / \partial \dot q = \dot q + a",
            (*write_slopes("l", setting.velocities, momenta), *solved.items()),
            by="legendre",
        ),
        write_step(
            "Hamiltonian, quadratic",
            "h = T + |p|^2/2 - p . a",
            r"h = T + \tfrac12 |p|^2 - p \cdot a",
            {"h": energy},
            by="legendre",
        ),
        write_step(
            "Variation of the group with dl/da = p",
            f"<dmu/dt, eta> = {work},  da/dt = {back}rho(xi) a,  dp/dt = 0",
            rf"\langle\dot\mu, \eta\rangle = {work_latex}, \quad "
            rf"\dot a = {back}\rho(\xi) a, \quad \dot p = 0",
            write_rates(motion.variables, motion.exact.rates),
            by="advection",
        ),
        write_step(
            "Level set of the conserved momentum",
            "p = dl/da of the Lagrangian with the potential",
            r"p = \partial l / \partial a",
            zip(_cyclic(setting)[1], level, strict=True),
            by="kaluza-klein",
        ),
    )
