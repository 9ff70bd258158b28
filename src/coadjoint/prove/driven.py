r"""Driven motions: what time and inputs leave of the conservation of energy and of integrals.

The energy of a motion that depends on time changes by its explicit part. With momenta in the state
that is :math:`dh/dt = \partial h/\partial t`; with velocities :math:`dE/dt = -\partial l/\partial
t`, which is the same where both are known, at the same point. An integral that names inputs is one
while these are constant.
Comes in: Equations. Goes out: the change of the energy, and what statements say of it.
Read next: `coadjoint.derive.driving`.
"""

from __future__ import annotations

from collections.abc import Iterable

from coadjoint.derive import Equations
from coadjoint.derive.driving import explicit, names_inputs
from coadjoint.exact import Element

#: What the energy of a motion that depends on time changes by.
OWN_CHANGE = "its explicit dependence on time"


def own_change(equations: Equations) -> Element:
    """What time adds to the energy: ``dh/dt`` at fixed momenta, ``-dl/dt`` at fixed velocities."""
    setting, energy = equations.setting, equations.exact.energy
    assert energy is not None, "only an energy changes"
    if setting.momenta or setting.spec.lagrangian is None:
        return explicit(setting, equations.closed(energy))
    return -explicit(setting, equations.closed(setting.formula(setting.spec.lagrangian)))


def changes_by_time(equations: Equations) -> bool:
    """Whether time adds something to the energy."""
    return not equations.setting.field.is_zero(own_change(equations))


def law_of_change(equations: Equations) -> str:
    """The change that time makes, as a formula."""
    setting = equations.setting
    of_momenta = setting.momenta or setting.spec.lagrangian is None
    return "dh/dt = dh/dt|explicit" if of_momenta else "dE/dt = -dl/dt|explicit"


def while_constant(equations: Equations, elements: Iterable[Element]) -> str:
    """The condition on the inputs under which functions are integrals; "" if there is none."""
    if not equations.setting.inputs:
        return ""
    needed = names_inputs(equations.setting, map(equations.closed, elements))
    return " while the inputs are constant" if needed else ""
