r"""Shocks: when the waves of a field that is carried by itself break.

A field with :math:`m_t + a(m)\, m_s = 0` is constant along the lines :math:`\dot s = a(m)`, its
characteristics, so that those of neighbouring points meet at the time

.. math:: t^* = -1 / \min_s \partial_s a(m(s, 0)),

after which there is no smooth solution, and differences follow none. For Burgers' equation
:math:`u_t + 3 u u_s = 0` it is :math:`-1/\min 3 u_s`. Hunter and Saxton's equation carries m with
the velocity u, :math:`m = -u_{ss}`, and slopes of u along its particles are
:math:`2 b \tan(\arctan(u_s/2b) - b t)`, with :math:`4 b^2` the mean of :math:`u_s^2`: the least
one becomes infinite at

.. math:: t^* = (\pi/2 + \arctan(\min u_s/2b))/b .

Comes in: a system with such a speed, a state and how long it is followed. Goes out: a warning.
Read next: `coadjoint.solve.simulate`.

Source:
    Lenells, Journal of Geometry and Physics 57 (2007) 2049.
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, cast

import numpy as np

from coadjoint.errors import ShockWarning
from coadjoint.solve.arrays import pack_parameters

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.family import FamilySystem
    from coadjoint.solve.request import Request
    from coadjoint.solve.system import System

    Array = NDArray[np.float64]


def find_shock(system: FamilySystem, request: Request) -> float:
    """How long after the beginning the first shock of a trajectory comes; inf for never."""
    from coadjoint.solve.formulas import Formula  # it reads specs, which few runs need

    text, length = system.wave
    state = request.state.reshape(system.size, -1)  # (N, members)
    given = pack_parameters(system, request.parameters).reshape(system.PARAMETERS.size, -1)
    names = {each.components[0]: given[n] for n, each in enumerate(system.PARAMETERS.values())}
    (field,) = system.own_state
    if system.spectral is not None and text in system.spectral.solved:
        return _find_breaking(system, names, {field: state})
    formula = Formula(text, dict.fromkeys((*names, field), ()), "the speed of waves")
    speed, _ = formula.evaluate({**names, field: state})
    spacing = names[length] / system.size
    slopes = (np.roll(speed, -1, axis=0) - speed) / spacing
    steepest = float(-np.min(slopes, initial=0.0))
    return 1 / steepest if steepest > 0 else np.inf


def _find_breaking(
    system: FamilySystem, parameters: dict[str, Array], fields: dict[str, Array]
) -> float:
    """The same of Hunter and Saxton's equation."""
    from coadjoint.solve.spectral import Waves, solve_velocities

    text, length = system.wave
    u = solve_velocities(system, parameters, fields)[text]
    slopes = Waves(system.size, parameters[length]).differentiate(u, 1)
    least, b = np.min(slopes, axis=0), np.sqrt(np.mean(slopes**2, axis=0)) / 2
    with np.errstate(all="ignore"):
        times = (np.pi / 2 + np.arctan(least / (2 * b))) / b
    return float(np.min(np.where(b > 0, times, np.inf), initial=np.inf))


def warn_of_shock(system: System, request: Request) -> None:
    """Say when the shock comes, if it comes before the end of a run."""
    if not system.wave:  # but for some families, there is none
        return
    after, end = (
        find_shock(cast("FamilySystem", system), request),
        float(request.times[-1]) - request.start,
    )
    clock = system.clock[0]
    if after < end:
        message = (
            f"{system.name} has a shock near {clock} = {request.start + after:.6g}, before the "
            f"end of the run at {clock} = {request.start + end:.6g}: from then on there is no "
            "smooth solution, and states are no approximations of one. Ask for an earlier end."
        )
        warnings.warn(ShockWarning(message, after), stacklevel=4)
