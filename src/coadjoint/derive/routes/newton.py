r"""The Newton route: from declared forces.

Law (Holm 2011, sections 1.1 and 2.1): mass times acceleration is the force,

.. math:: \dot q = v, \qquad M \dot v = F(q, v),

with a mass for each coordinate, or a matrix of masses that multiplies its acceleration: one row per
particle. The law contains no energy and no bracket; where the spec declares a Lagrangian or a
Hamiltonian, these are taken from there, and the certificate says whether they fit the motion.
Comes in: a Setting with [newton]. Goes out: Equations.
Read next: `coadjoint.prove.galilean`.
"""

from __future__ import annotations

from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.configuration import declared_energy, in_state_order
from coadjoint.derive.mechanics.emission import emit
from coadjoint.derive.mechanics.forces import accelerations
from coadjoint.derive.records import Step, write_rates, write_step
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element
from coadjoint.spec.model import Formula, component_names


def derive(setting: Setting) -> Equations:
    """Newton's equations.

    Raises:
        DerivationError: A mass is zero, or a matrix of masses cannot be inverted.
    """
    velocities = setting.elements(setting.velocities)
    named = dict(zip(setting.positions, velocities, strict=True))
    named |= zip(setting.velocities, accelerations(setting), strict=True)
    rates = in_state_order(setting, named)
    return emit(setting, "newton", rates, _steps(setting, rates), declared_energy(setting))


def _steps(setting: Setting, rates: tuple[Element, ...]) -> tuple[Step, ...]:
    """Forces, masses and the motion."""
    laws = setting.spec.newton
    forces = [line for law in laws for line in _lines("F", law.coordinate, law.force, setting)]
    masses = [line for law in laws for line in _lines("M", law.coordinate, law.mass, setting)]
    return (
        write_step("Forces", "F(q, v)", lines=forces, by="newton"),
        write_step("Masses", "M", lines=masses, by="newton"),
        write_step(
            "Newton's law",
            "dq/dt = v,  M dv/dt = F",
            r"\dot q = v, \quad M \dot v = F",
            write_rates(setting.state, rates),
            by="newton",
        ),
    )


def _lines(
    letter: str, coordinate: str, formula: Formula, setting: Setting
) -> list[tuple[str, Element]]:
    """The entries of a formula, with names after the coordinate; zeros are left out."""
    names = component_names(f"{letter}_{coordinate}", formula.shape)
    return [pair for pair in zip(names, setting.components(formula), strict=True) if pair[1]]
