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
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.mechanics.driving import explicit
from coadjoint.derive.mechanics.emission import emit
from coadjoint.derive.mechanics.first_order import FirstOrder, first_order
from coadjoint.derive.records import Step, bracket, write_rates, write_slopes, write_step
from coadjoint.derive.setting import Setting
from coadjoint.derive.structure import poisson_structure
from coadjoint.exact import Element
from coadjoint.exact.dense import apply, dot


def derive(setting: Setting) -> Equations:
    """Equations of motion by the bracket that the one-form gives.

    Raises:
        DerivationError: The Lagrangian has no regular form of first order in the declared state.
    """
    of, field, names = first_order(setting), setting.field, setting.state
    slopes = field.gradient(of.form.energy, names)
    rates = dict(zip(names, apply(poisson_structure(setting).tensor, slopes), strict=True))
    moved = [rates[name] for name in names]
    rates |= {
        x: explicit(setting, value) + dot(field.gradient(value, names), moved)
        for x, value in of.bound.items()
    }
    pairs = dict(zip(setting.positions, setting.velocities, strict=True))
    definitions = [*of.bound.items(), *((v, field.zero + rates[q]) for q, v in pairs.items())]
    named = field.vector(field[pairs[x]] if x in pairs else rates[x] for x in setting.state)
    steps = _steps(of, named, definitions)
    return emit(setting, "first-order", named, steps, of.form.energy, definitions)


def _steps(
    of: FirstOrder, rates: tuple[Element, ...], velocities: list[tuple[str, Element]]
) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    setting, names = of.setting, of.setting.state
    omega = of.form.two_form(setting.field)
    tensor = poisson_structure(setting).tensor
    places = list(combinations(range(len(names)), 2))
    law, latex = "omega dx/dt = dh/dx", r"\omega\,\dot x = \partial h/\partial x"
    steps = (
        write_step("Lagrangian", "l(q, v)", lines={"l": setting.lagrangian}),
        write_step(
            "Momenta",
            "p = dl/dv",
            r"p = \partial l / \partial v",
            write_slopes("l", setting.velocities, mechanics(setting).momenta),
        ),
        write_step(
            "Velocities that momenta give",
            "v solved from p = dl/dv",
            r"v = v(q, p)",
            of.solved,
        ),
        write_step(
            "Form of first order",
            "L = theta(x) dx/dt - h(x)",
            r"L = \theta(x) \cdot \dot x - h(x)",
            [
                *_write_theta(of.whole),
                ("h", of.whole.energy),
            ],
        ),
        write_step(
            "Constraints where omega is singular, in their order, and what they give",
            "n omega = 0, n dh/dx = 0",
            r"n\,\omega = 0, \quad n \cdot \partial h = 0",
            of.lines,
        ),
        write_step(
            "Form of first order within them",
            "L = theta(x) dx/dt - h(x)",
            r"L = \theta(x) \cdot \dot x - h(x)",
            [*_write_theta(of.form), ("h", of.form.energy)] if of.bound else [],
        ),
        write_step(
            "Two-form",
            "omega_ij = d theta_j/dx_i - d theta_i/dx_j",
            r"\omega_{ij} = \partial_i \theta_j - \partial_j \theta_i",
            [(f"omega_{names[i]},{names[j]}", omega[i][j]) for i, j in places if omega[i][j]],
        ),
        write_step(
            "Poisson bracket",
            "{x_i, x_j} = (omega^-1)_ij",
            r"\{x_i, x_j\} = (\omega^{-1})_{ij}",
            [(bracket(names[i], names[j]), tensor[i][j]) for i, j in places if tensor[i][j]],
        ),
        write_step("Velocities", law, latex, velocities),
        write_step(
            "Hamilton's equations",
            "dx/dt = {x, h}",
            r"\dot x = \{x, h\}",
            write_rates(names, rates),
        ),
    )
    return tuple(step for step in steps if step.lines)


def _write_theta(form: Form) -> list[tuple[str, Element]]:
    """Lines for the components of theta that are not zero."""
    return [(f"theta_{x}", value) for x, value in zip(form.names, form.theta, strict=True) if value]
