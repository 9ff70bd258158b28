"""The starts of a run by a generated solver: in the domain, and on the constraints that are kept.

Comes in: the initial states of all members. Goes out: the same, moved onto the constraints by
roundings, or an error that names the first member that cannot begin where it is.
Read next: `coadjoint.solve.domain` and `coadjoint.solve.constraints`, which look at one of them.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.constraints import Constraints, find_excess
from coadjoint.solve.domain import Domain
from coadjoint.solve.driving import Driving

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.ensemble import Ensemble
    from coadjoint.solve.request import Request
    from coadjoint.solve.system import System


def check_starts(system: System, request: Request, run: Ensemble, now: dict[str, Any]) -> None:
    """Have all members of a run begin in the domain and on the constraints.

    Args:
        system: The System.
        request: What is to be done.
        run: The members, which are moved onto the constraints.
        now: Inputs and time at the start, as functions of the System take them.

    Raises:
        KernelArgumentError: A member is outside of the domain, or off the constraints.
    """
    state = run.state[: system.STATE.size]
    if system.DOMAIN:
        rows = system.domain(state, run.parameters, target="numpy", **now)
        least = np.array([np.nextafter(0.0, 1.0) * bound.strict for bound in system.DOMAIN])
        _refuse_first(system, request, run, ~((rows >= least[:, None]) & (rows < np.inf)))
    if "projection" in system.functions:
        at = partial(system.constraint_residual, parameters=run.parameters, target="numpy", **now)
        _refuse_first(system, request, run, find_excess(system, state, at, request.atol) > 0)
        nearest = system.projection(state, run.parameters, target="numpy", **now)
        state[:] = np.where(np.isfinite(nearest).all(axis=0), nearest, state)


def _refuse_first(system: System, request: Request, run: Ensemble, bad: NDArray[np.bool_]) -> None:
    """Say what is wrong with the first member that has a bad row."""
    members = np.flatnonzero(bad.any(axis=0))
    if not members.size:
        return
    member, start = int(members[0]), request.start
    parameters = run.parameters if run.parameters.ndim == 1 else run.parameters[:, member].copy()
    own = run.inputs.own
    inputs = run.inputs.values[:, member].copy() if own else request.inputs
    driving = Driving(system, inputs, start, float(request.times[-1]))
    state = run.state[: system.STATE.size, member].copy()
    try:
        Domain(system, parameters, request.target, driving).check_start(start, state)
        Constraints(system, parameters, request.target, driving).find_start(
            start, state, request.atol
        )
    except KernelArgumentError as error:
        if run.state.shape[1] == 1:
            raise
        where = ", ".join(map(str, np.unravel_index(member, request.state.shape[1:])))
        raise KernelArgumentError(f"member {where}: {error}", **error.parts) from None
