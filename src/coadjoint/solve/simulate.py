"""Simulation: what is asked for, checked, and handed to what can do it.

Comes in: an initial state and times. Goes out: a `Solution`. Read next: `coadjoint.solve.request`,
which checks what was asked for, `coadjoint.solve.generated`, by generated solvers, and
`coadjoint.solve.scipy_steps`, by SciPy's.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.methods import MAPPED, STRUCTURED
from coadjoint.solve import generated
from coadjoint.solve.checkpoints import check_checkpoint
from coadjoint.solve.costs import LEAST, SHARE
from coadjoint.solve.events import read_events
from coadjoint.solve.family import FamilySystem
from coadjoint.solve.kernels import check_target
from coadjoint.solve.noisy import check_no_noise, check_samples, choose_noisy, has_noise
from coadjoint.solve.obstacles import (
    NO_SERIES,
    check_newton_applies,
    find_noisy_obstacle,
    find_obstacle,
    find_stepwise,
    list_obstacles,
)
from coadjoint.solve.reconstruct import check_asked, is_asked
from coadjoint.solve.request import (
    ATOL,
    RTOL,
    SCIPY,
    Request,
    check_count,
    check_dense,
    check_newton,
    check_positive,
    check_progress,
    check_state,
    check_steps,
    choose_method,
    find_kind,
    is_auto,
    list_times,
    prefers_dop853,
    take_ends_of_steps,
)
from coadjoint.solve.scipy_steps import check_alone, simulate_alone
from coadjoint.solve.shocks import warn_of_shock
from coadjoint.solve.solution import Solution
from coadjoint.solve.stability import is_of_waves, watch_waves

if TYPE_CHECKING:
    from coadjoint.solve.system import System


def simulate(
    system: System,
    state: Any,
    t: Any,
    parameters: Any,
    *,
    inputs: Any,
    method: Any,
    rtol: Any,
    atol: Any,
    step: Any,
    samples: Any,
    max_steps: Any,
    target: Any,
    threads: Any,
    progress: Any,
    reconstruct: Any,
    checkpoint: Any,
    events: Any,
    dense: Any,
    seed: Any = None,
    newton: Any = False,
) -> Solution:
    """Integrate; arguments as in `System.simulate`."""
    initial = check_state(system, state)
    below = check_asked(system, reconstruct).size if is_asked(reconstruct) else 0
    start, times = list_times(t, samples, initial.size + initial[0].size * below)
    tolerances = rtol is not None or atol is not None
    rtol, atol = RTOL if rtol is None else rtol, ATOL if atol is None else atol
    check_positive(rtol=rtol, atol=atol, **({} if step is None else {"step": step}))
    check_count(max_steps=max_steps, **({} if threads is None else {"threads": threads}))
    check_target(target)
    check_progress(progress)
    obstacle = find_obstacle(system, target, reconstruct)
    recorded = bool(events or dense)
    stepwise = find_stepwise(system, inputs, is_recorded=recorded)
    chosen = ""
    if has_noise(system):
        given = {"rtol or atol": tolerances, "dense": dense}
        given["reconstruct"] = is_asked(reconstruct)
        preferred = choose_noisy(system, method, step, seed, given)
        name, chosen = preferred.name, preferred.why
        if obstacle := obstacle or find_noisy_obstacle(system, name):
            raise _explain_obstacle(system, name, obstacle)
    else:
        check_no_noise(system, method, seed)
        obstacles = list_obstacles(
            system,
            method,
            step,
            reconstruct,
            obstacle=obstacle,
            stepwise=stepwise,
            rtol=float(rtol),
            members=initial[0].size,
        )
        preferred = choose_method(system, method, step, obstacles, tolerances=tolerances)
        name, chosen = preferred.name, preferred.why
        within = "the path within steps is asked for" if recorded else obstacle or system.stepwise
        within = within or stepwise
        if prefers_dop853(system, find_kind(reconstruct), method, step, float(rtol), within):
            name, rtol, atol = "dop853", rtol * SHARE, atol * SHARE
        elif (
            name == "dop853"
            and step is None
            and is_auto(method)
            and obstacles.get("taylor") == NO_SERIES
        ):
            share = max(SHARE, min(1.0, LEAST / rtol))
            rtol, atol = rtol * share, atol * share
    if check_newton(newton, name) and system.obstacle:
        raise KernelArgumentError(
            f"newton is True, and {system.obstacle}; expected newton=False.",
            found="True",
            reason=system.obstacle,
        )
    if newton:
        check_newton_applies(system, reconstruct)
    if np.size(t) == 2 and (name in {*STRUCTURED, *MAPPED} or has_noise(system)):
        assert step is not None, "methods that keep structure, and noise, have steps of one length"
        times = take_ends_of_steps(start, times, float(step))
    request = Request(
        state=initial,
        start=start,
        times=times,
        samples=int(samples) if times.size == 1 else times.size,
        parameters=parameters,
        inputs=inputs,
        method=name,
        rtol=float(rtol),
        atol=float(atol),
        step=None if step is None else float(step),
        max_steps=int(max_steps),
        target=target,
        reconstruct=reconstruct,
        threads=threads,
        progress=progress,
        checkpoint=check_checkpoint(checkpoint),
        events=read_events(system, events, followed=is_asked(reconstruct)),
        dense=check_dense(dense),
        stepwise=stepwise,
        seed=None if seed is None else int(seed),
        chosen=chosen,
        newton=bool(newton),
        of_waves=is_of_waves(system),
    )
    check_steps(request)
    if has_noise(system):
        check_samples(system, request)
    warn_of_shock(system, request)
    if isinstance(system, FamilySystem) and system.spectral and system.spectral.solved:
        from coadjoint.solve.spectral import check_means

        check_means(system, request.state)
    if isinstance(system, FamilySystem) and system.torus is not None:
        from coadjoint.solve.plane_waves import check_plane
        from coadjoint.solve.torus import TorusSystem

        assert isinstance(system, TorusSystem), system.name
        check_plane(system, request.state)
    elif system.obstacle:  # else there is nothing to load
        from coadjoint.solve.spectral import warn_of_jump

        warn_of_jump(system, request)
    if not request.method.startswith(SCIPY) and not system.obstacle:
        speeds = watch_waves(system, request)
        solution = generated.simulate(system, request)
        speeds(solution)
        return solution
    check_alone(system, request, obstacle)
    if request.state.ndim > 1:
        from coadjoint.solve.one_by_one import simulate_one_by_one

        return simulate_one_by_one(system, request, partial(simulate_alone, system))
    return simulate_alone(system, request)


def _explain_obstacle(system: System, name: str, obstacle: str) -> KernelArgumentError:
    """Why a motion with noise cannot be followed: there are generated solvers alone for it."""
    return KernelArgumentError(
        f"method {name!r} is a generated solver, which does not apply to {system.name} here: "
        f"{obstacle}.",
        found=name,
        reason=obstacle,
    )
