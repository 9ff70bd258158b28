r"""Hamel's route: the constrained Lagrangian with the gyroscopic force that it misses.

Theorem (Hamel 1904; Holm 2011, section 12.3.3): let :math:`l_c(\eta, z) = l(B\eta + \beta, z)` be
the Lagrangian with the constraints substituted. The motion is not that of :math:`l_c`: with
:math:`D_k = B_k^l X_l` the fields of the distribution,

.. math::
    \frac{d}{dt}\frac{\partial l_c}{\partial \eta^k} - D_k\, l_c
        = \Big\langle \frac{\partial l}{\partial \xi}, [\xi, D_k] \Big\rangle + B_k \cdot f,

where :math:`[\xi, D_k]` gains :math:`\partial D_k/\partial t` if the constraints move, and
the brackets of the fields leave the distribution unless the constraints are integrable, so
that the momentum on the right is that of the whole Lagrangian.
Comes in: a Setting with a Lagrangian and constraints. Goes out: Equations in velocities.
Read next: `coadjoint.derive.routes.nonholonomic`, which projects the forces.
"""

from __future__ import annotations

from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.mechanics.constrained import (
    ConstrainedMotion,
    emit_motion,
    show_mass,
    start_motion,
)
from coadjoint.derive.mechanics.distribution import Row
from coadjoint.derive.mechanics.driving import explicit_rate
from coadjoint.derive.mechanics.external import external_forces
from coadjoint.derive.mechanics.kinematics import Matrix
from coadjoint.derive.records import Step, component, write_slopes, write_step
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element


def derive(setting: Setting) -> Equations:
    """Equations of motion by Hamel's equations.

    Raises:
        DerivationError: As on the route nonholonomic.
    """
    motion = start_motion(setting)
    names = motion.distribution.independent
    constrained = setting.field.substitute(setting.lagrangian, motion.distribution.solved)
    momenta = setting.field.gradient(constrained, names)
    mass = tuple(setting.field.gradient(p, names) for p in momenta)
    known = _right_side(motion, constrained, momenta)
    steps = _steps(motion, constrained, momenta, mass, known)
    return emit_motion(motion, "hamel", mass, known, lambda _: steps)


def _right_side(motion: ConstrainedMotion, constrained: Element, momenta: Row) -> Row:
    """``D_k l_c + <p, [xi, D_k]> + B_k f - dp_c/dz dz/dt``."""
    of, frame = motion.distribution, motion.frame
    field = frame.setting.field
    p = [field.substitute(slope, of.solved) for slope in mechanics(frame.setting).momenta]
    acting = external_forces(frame.setting, frame.velocities)
    forces = [field.substitute(force, of.solved) for force in acting]
    known = []
    for k, momentum in enumerate(momenta):
        D = [row[k] for row in of.B]
        own = (explicit_rate(frame.setting, d, "a constraint") + frame.drift(d) for d in D)
        turned = [a + b for a, b in zip(frame.bracket(of.xi, D), own, strict=True)]
        gyroscopic = field.sum(a * b for a, b in zip(p, turned, strict=True) if a and b)
        driven = field.sum(b * f for b, f in zip(D, forces, strict=True) if b and f)
        carried = frame.along(of.xi, momentum)
        carried += explicit_rate(frame.setting, momentum, "a momentum") + frame.drift(momentum)
        known.append(frame.along(D, constrained) + gyroscopic + driven - carried)
    return tuple(known)


def _steps(
    motion: ConstrainedMotion, constrained: Element, momenta: Row, mass: Matrix, known: Row
) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    pull, pull_latex = "", ""
    if motion.distribution.kept:
        pull, pull_latex = " + (A^T lambda)_k", r" + (A^\top \lambda)_k"
    return (
        write_step(
            "Constrained Lagrangian",
            "l_c(eta, z) = l(B eta + beta, z)",
            r"l_c(\eta, z) = l(B\eta + \beta, z)",
            {"l_c": constrained},
            by="hamel",
        ),
        write_step(
            "Its momenta",
            "dl_c/deta",
            r"\partial l_c / \partial \eta",
            write_slopes("l_c", motion.distribution.independent, momenta),
            by="legendre",
        ),
        show_mass(mass, "d2l_c/deta2", r"\partial^2 l_c / \partial \eta^2"),
        write_step(
            "Hamel's equations, solved for the accelerations in the kernel",
            f"d/dt dl_c/deta_k = D_k l_c + <p, [xi, D_k]> + B_k f{pull}",
            r"\frac{d}{dt}\frac{\partial l_c}{\partial \eta^k} = D_k l_c + \langle p, [\xi, D_k] "
            rf"\rangle + B_k f{pull_latex}",
            (
                (component("M eta'", r"M \dot\eta", "M dot(eta)", n), value)
                for n, value in enumerate(motion.pull(known), 1)
            ),
            by="hamel",
        ),
        motion.show_kept(),
    )
