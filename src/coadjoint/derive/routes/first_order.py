r"""The first-order route: from a Lagrangian that is singular in the velocities.

Theorem (Faddeev and Jackiw 1988): where the Lagrangian is :math:`\theta(x) \cdot \dot x - h(x)` in
the state x, coordinates and those momenta that are declared, the action is stationary exactly if

.. math:: \omega\,\dot x = \partial h, \qquad
    \omega_{ij} = \partial_i \theta_j - \partial_j \theta_i,

and where omega has an inverse this is Hamiltonian motion by the Poisson bracket
:math:`\{x_i, x_j\} = (\omega^{-1})_{ij}`: of point vortices, of guiding centres, of charges in a
strong magnetic field.
Comes in: a Setting with a Lagrangian and no algebra. Goes out: Equations.
Read next: `coadjoint.derive.mechanics.first_order`, which finds the form.
"""

from __future__ import annotations

from itertools import combinations

from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.bound import Form
from coadjoint.derive.mechanics.bound_momenta import bound_momenta
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.mechanics.driving import explicit
from coadjoint.derive.mechanics.emission import emit
from coadjoint.derive.mechanics.external import LATEX
from coadjoint.derive.mechanics.first_order import FirstOrder, first_order
from coadjoint.derive.records import (
    Step,
    bracket,
    sign_text,
    write_rates,
    write_slopes,
    write_step,
)
from coadjoint.derive.setting import Setting
from coadjoint.derive.structure import lie_poisson_structure, poisson_structure
from coadjoint.exact import Element
from coadjoint.exact.dense import apply, dot


def derive(setting: Setting) -> Equations:
    """Equations of motion by the bracket that the one-form gives, or by the momenta that are left.

    Raises:
        DerivationError: The Lagrangian has no regular form of first order in the declared state.
    """
    if setting.spec.algebra is not None:
        return _derive_over_algebra(setting)
    of, field = first_order(setting), setting.field
    rates = dict(of.rates) or _rates_by_bracket(of)
    pairs = dict(zip(setting.positions, setting.velocities, strict=True))
    definitions = [*of.bound.items(), *((v, field.zero + rates[q]) for q, v in pairs.items())]
    named = field.vector(field[pairs[x]] if x in pairs else rates[x] for x in setting.state)
    steps = _steps(of, named, definitions)
    pushed = apply(of.tensor, of.pulled_force) if of.force else ()
    return emit(
        setting,
        "first-order",
        named,
        steps,
        of.form.energy,
        definitions,
        forces=tuple(-force for force in pushed),
        tensor=of.tensor,
    )


def _rates_by_bracket(of: FirstOrder) -> dict[str, Element]:
    """The rates of the state, and of what follows, by the bracket alone."""
    field, names = of.setting.field, of.setting.state
    moved = apply(of.tensor, field.gradient(of.form.energy, names))
    return dict(zip(names, moved, strict=True)) | {
        x: explicit(of.setting, value) + dot(field.gradient(value, names), moved)
        for x, value in of.bound.items()
    }


def _derive_over_algebra(setting: Setting) -> Equations:
    """Equations of motion where momenta follow, by the law of Euler and Poincare for the others."""
    of, field = bound_momenta(setting), setting.field
    definitions = [*of.bound.items(), *of.velocities.items()]
    rates = field.vector(of.rates[name] for name in setting.state)
    tensor = poisson_structure(setting).tensor
    forces = of.push(lie_poisson_structure(setting)) if setting.spec.is_forced else ()
    names = setting.state
    places = combinations(range(len(names)), 2)
    turned = sign_text(setting.sign, "ad*_xi mu + dl/da <> a")
    latex = sign_text(setting.sign, r"\mathrm{ad}^*_\xi \mu + (\partial l / \partial a) \diamond a")
    if setting.spec.is_forced:
        turned, latex = f"{turned} + f - dR/dxi", rf"{latex} + {LATEX['f - dR/dxi']}"
    steps = (
        write_step(
            "Reduced Lagrangian",
            "l(xi, a)",
            r"l(\xi, a)",
            {"l": setting.lagrangian},
            by="euler-poincare",
        ),
        write_step(
            "Momenta",
            "mu = dl/dxi",
            r"\mu = \partial l / \partial \xi",
            write_slopes("l", setting.velocities, mechanics(setting).momenta),
            by="legendre",
        ),
        write_step(
            "Constraints where d2l/dxi2 is singular, in their order, and what they give",
            "n d2l/dxi2 = 0, n (mu - dl/dxi) = 0",
            r"n\,\partial^2 l/\partial \xi^2 = 0, \quad "
            r"n \cdot (\mu - \partial l/\partial \xi) = 0",
            of.known.lines,
            by="first-order",
        ),
        write_step(
            "Velocities from the momenta and from constraints that last",
            "xi = xi(mu, a)",
            r"\xi = \xi(\mu, a)",
            of.velocities,
            by="legendre",
        ),
        write_step(
            "Euler-Poincare equations and advection of what is left",
            f"dmu/dt = {turned}",
            rf"\dot\mu = {latex}",
            write_rates(names, rates),
            by="advection",
        ),
        write_step(
            "Dirac's bracket of what is left",
            "{f, g} - {f, phi_i} (C^-1)_ij {phi_j, g}, C_ij = {phi_i, phi_j}",
            r"\{f, g\} - \{f, \phi_i\} (C^{-1})_{ij} \{\phi_j, g\}, \quad "
            r"C_{ij} = \{\phi_i, \phi_j\}",
            [(bracket(names[i], names[j]), tensor[i][j]) for i, j in places if tensor[i][j]],
            by="dirac",
        ),
    )
    shown = [step for step in steps if step.lines]
    return emit(setting, "first-order", rates, shown, of.energy, definitions, forces=forces)


def _steps(
    of: FirstOrder, rates: tuple[Element, ...], velocities: list[tuple[str, Element]]
) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    setting, names = of.setting, of.setting.state
    omega = of.form.two_form(setting.field)
    tensor = of.tensor
    places = list(combinations(range(len(names)), 2))
    law, latex = "omega dx/dt = dh/dx", r"\omega\,\dot x = \partial h/\partial x"
    motion, motion_latex = "dx/dt = {x, h}", r"\dot x = \{x, h\}"
    if of.force:
        law, latex = f"{law} - f + dR/dv", rf"{latex} - f + \partial R/\partial v"
        motion, motion_latex = law, latex
    steps = (
        write_step(
            "Lagrangian", "l(q, v)", lines={"l": setting.lagrangian}, by="stationary-action"
        ),
        write_step(
            "Momenta",
            "p = dl/dv",
            r"p = \partial l / \partial v",
            write_slopes("l", setting.velocities, mechanics(setting).momenta),
            by="legendre",
        ),
        write_step(
            "Velocities that momenta give",
            "v solved from p = dl/dv",
            r"v = v(q, p)",
            of.solved,
            by="legendre",
        ),
        write_step(
            "Form of first order",
            "L = theta(x) dx/dt - h(x)",
            r"L = \theta(x) \cdot \dot x - h(x)",
            [
                *_write_theta(of.whole),
                ("h", of.whole.energy),
            ],
            by="first-order",
        ),
        write_step(
            "Constraints where omega is singular, in their order, and what they give",
            "n omega = 0, n dh/dx = 0",
            r"n\,\omega = 0, \quad n \cdot \partial h = 0",
            of.lines,
            by="first-order",
        ),
        write_step(
            "Form of first order within them",
            "L = theta(x) dx/dt - h(x)",
            r"L = \theta(x) \cdot \dot x - h(x)",
            [*_write_theta(of.form), ("h", of.form.energy)] if of.bound else [],
            by="first-order",
        ),
        write_step(
            "Two-form",
            "omega_ij = d theta_j/dx_i - d theta_i/dx_j",
            r"\omega_{ij} = \partial_i \theta_j - \partial_j \theta_i",
            [(f"omega_{names[i]},{names[j]}", omega[i][j]) for i, j in places if omega[i][j]],
            by="first-order",
        ),
        write_step(
            "Poisson bracket",
            "{x_i, x_j} = (omega^-1)_ij",
            r"\{x_i, x_j\} = (\omega^{-1})_{ij}",
            [(bracket(names[i], names[j]), tensor[i][j]) for i, j in places if tensor[i][j]],
            by="symplectic",
        ),
        write_step(
            "Forces and dissipation along what moves",
            "f - dR/dv",
            LATEX["f - dR/dxi"].replace(r"\xi", "v"),
            [(f"f_{x}", f) for x, f in zip(of.whole.names, of.force, strict=False) if f],
            by="forces",
        ),
        write_step("Velocities", law, latex, velocities, by="legendre"),
        write_step(
            "Equations with forces" if of.force else "Hamilton's equations",
            motion,
            motion_latex,
            write_rates(names, rates),
            by="hamilton",
        ),
    )
    return tuple(step for step in steps if step.lines)


def _write_theta(form: Form) -> list[tuple[str, Element]]:
    """Lines for the components of theta that are not zero."""
    return [(f"theta_{x}", value) for x, value in zip(form.names, form.theta, strict=True) if value]
