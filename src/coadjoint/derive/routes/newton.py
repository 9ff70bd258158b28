r"""The Newton route: from declared forces.

Law (Holm 2011, sections 1.1 and 2.1): mass times acceleration is the force,

.. math:: \dot q = v, \qquad M \dot v = F(q, v),

with a mass for each coordinate, or a matrix of masses that multiplies its acceleration: one row per
particle. The law knows no energy and no bracket; where the spec declares a Lagrangian or a
Hamiltonian, these are taken from there, and the certificate says whether they fit the motion.
Comes in: a Setting with [newton]. Goes out: Equations.
Read next: `coadjoint.prove.galilean`.
"""

from __future__ import annotations

from coadjoint.derive.emitted import list_emitted
from coadjoint.derive.equations import Equations
from coadjoint.derive.interpret import entries
from coadjoint.derive.mechanics.configuration import declared_energy, in_state_order
from coadjoint.derive.mechanics.forces import accelerations
from coadjoint.derive.records import Exact, Left, Step, rate, symbol
from coadjoint.derive.setting import Setting
from coadjoint.derive.structure import has_structure, poisson_structure
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
    energy = declared_energy(setting)
    tensor = poisson_structure(setting).tensor if has_structure(setting) else None
    exact = Exact((), rates, energy, list_emitted(setting, energy), tensor)
    return Equations(setting, "newton", exact, _steps(setting, rates))


def _steps(setting: Setting, rates: tuple[Element, ...]) -> tuple[Step, ...]:
    """Forces, masses and the motion."""
    laws = setting.spec.newton
    forces = [line for law in laws for line in _lines("F", law.coordinate, law.force, setting)]
    masses = [line for law in laws for line in _lines("M", law.coordinate, law.mass, setting)]
    motion = tuple(zip(map(rate, setting.state), rates, strict=True))
    return (
        Step("Forces", "F(q, v)", "F(q, v)", tuple(forces)),
        Step("Masses", "M", "M", tuple(masses)),
        Step("Newton's law", "dq/dt = v,  M dv/dt = F", r"\dot q = v, \quad M \dot v = F", motion),
    )


def _lines(
    letter: str, coordinate: str, formula: Formula, setting: Setting
) -> list[tuple[Left, Element]]:
    """The entries of a formula, with names after the coordinate; zeros are left out."""
    names = component_names(f"{letter}_{coordinate}", formula.shape)
    values = entries(setting.value(formula))
    return [(symbol(name), value) for name, value in zip(names, values, strict=True) if value]
