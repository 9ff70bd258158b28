r"""Driven motions: what time and inputs leave of the conservation of energy and of integrals.

The energy of a motion that depends on time changes by its explicit part. With momenta in the state
that is :math:`dh/dt = \partial h/\partial t`; with velocities :math:`dE/dt = -\partial l/\partial
t`, which is the same where both are known, at the same point. An integral that names inputs is one
while these are constant.
Comes in: Equations. Goes out: the change of the energy, and what statements say of it.
Read next: `coadjoint.derive.mechanics.driving`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.mechanics.driving import explicit, names_inputs
from coadjoint.exact import Element

#: What the energy of a motion that depends on time changes by.
OWN_CHANGE = "its explicit dependence on time"


def own_change(equations: Equations) -> Element:
    """What time adds to the energy: ``dh/dt`` at fixed momenta, ``-dl/dt`` at fixed velocities."""
    setting, energy = equations.setting, equations.exact.energy
    assert energy is not None, "only an energy changes"
    if setting.momenta or setting.spec.lagrangian is None:
        return explicit(setting, equations.close(energy))
    return -equations.close(explicit(setting, setting.lagrangian))


def changes_by_time(equations: Equations) -> bool:
    """Whether time adds something to the energy."""
    return not equations.setting.field.is_zero(own_change(equations))


def has_moving_momenta(equations: Equations) -> bool:
    """Whether velocities are in the state, and their momenta depend on time explicitly."""
    setting = equations.setting
    return not setting.momenta and any(not setting.field.is_zero(p) for p in _own(equations))


def motion_defects(equations: Equations, defects: Sequence[Element]) -> list[Element]:
    """What vanishes if the motion is the bracket with h plus ``dx/dt`` at fixed momenta.

    Of a velocity v that is ``M dv/dt|explicit = -dp/dt|explicit`` with ``M = dp/dv``.

    Args:
        equations: Their rates are those of coordinates and velocities.
        defects: ``dx/dt - {x, h}``.
    """
    setting, names = equations.setting, equations.setting.velocities
    field, named = setting.field, dict(zip(setting.state, defects, strict=True))
    of_velocities = []
    for p, own in zip(_momenta(equations), _own(equations), strict=True):
        slopes = zip(field.gradient(p, names), names, strict=True)
        of_velocities.append(own + field.sum(slope * named[v] for slope, v in slopes))
    return [*(named[name] for name in named if name not in names), *of_velocities]


def _own(equations: Equations) -> list[Element]:
    """The explicit parts of the rates of the momenta."""
    return [explicit(equations.setting, p) for p in _momenta(equations)]


def _momenta(equations: Equations) -> Sequence[Element]:
    """``dl/dv``; none without a Lagrangian."""
    setting = equations.setting
    if setting.spec.lagrangian is None:
        return ()
    return mechanics(setting).momenta


def law_of_change(equations: Equations) -> str:
    """The change that time makes, as a formula."""
    setting = equations.setting
    of_momenta = setting.momenta or setting.spec.lagrangian is None
    return "dh/dt = dh/dt|explicit" if of_momenta else "dE/dt = -dl/dt|explicit"


def while_constant(equations: Equations, elements: Iterable[Element]) -> str:
    """The condition on the inputs under which functions are integrals; "" if there is none."""
    if not equations.setting.inputs:
        return ""
    needed = names_inputs(equations.setting, map(equations.close, elements))
    return " while the inputs are constant" if needed else ""
