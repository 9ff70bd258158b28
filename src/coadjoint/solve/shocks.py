r"""Shocks: when the waves of a field that is carried by itself break.

A field with :math:`m_t + a(m)\, m_s = 0` is constant along the lines :math:`\dot s = a(m)`, its
characteristics, so that those of neighbouring points meet at the time

.. math:: t^* = -1 / \min_s \partial_s a(m(s, 0)),

after which there is no smooth solution, and differences follow none. For Burgers' equation
:math:`u_t + 3 u u_s = 0` it is :math:`-1/\min 3 u_s`.
Comes in: a system with such a speed, a state and how long it is followed. Goes out: a warning.
Read next: `coadjoint.solve.simulate`.
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, cast

import numpy as np

from coadjoint.errors import ShockWarning
from coadjoint.solve.arrays import pack_parameters

if TYPE_CHECKING:
    from coadjoint.solve.family import FamilySystem
    from coadjoint.solve.request import Request
    from coadjoint.solve.system import System


def find_shock(system: FamilySystem, request: Request) -> float:
    """How long after the beginning the first shock of a trajectory comes; inf for never."""
    from coadjoint.solve.formulas import Formula  # it reads specs, which few runs need

    text, length = system.wave
    state = request.state.reshape(system.size, -1)  # (N, members)
    given = pack_parameters(system, request.parameters).reshape(system.PARAMETERS.size, -1)
    names = {each.components[0]: given[n] for n, each in enumerate(system.PARAMETERS.values())}
    (field,) = system.own_state
    formula = Formula(text, dict.fromkeys((*names, field), ()), "the speed of waves")
    speed, _ = formula.evaluate({**names, field: state})
    spacing = names[length] / system.size
    slopes = (np.roll(speed, -1, axis=0) - speed) / spacing
    steepest = float(-np.min(slopes, initial=0.0))
    return 1 / steepest if steepest > 0 else np.inf


def warn_of_shock(system: System, request: Request) -> None:
    """Say when the shock comes, if it comes before the end of a run."""
    if not system.wave:  # but for some families, there is none
        return
    after, end = (
        find_shock(cast("FamilySystem", system), request),
        float(request.times[-1]) - request.start,
    )
    if after < end:
        warnings.warn(
            f"{system.name} has a shock at t = {request.start + after:.6g}, before the end of the "
            f"run at t = {request.start + end:.6g}: from then on there is no smooth solution, and "
            "states are no approximations of one. Ask for an earlier end.",
            ShockWarning,
            stacklevel=4,
        )
