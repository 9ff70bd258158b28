"""Simulation: by a generated solver, or of one trajectory by SciPy's integrators and the kernels.

Comes in: an initial state and times. Goes out: a `Solution`. Read next: `coadjoint.solve.request`,
which checks what was asked for, and `coadjoint.solve.generated`.
"""

from __future__ import annotations

from dataclasses import asdict
from functools import cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.methods import MAPPED, STRUCTURED
from coadjoint.solve import generated
from coadjoint.solve.arrays import find_slopes, pack_parameters
from coadjoint.solve.checkpoints import check_checkpoint
from coadjoint.solve.choices import GENERATED
from coadjoint.solve.constraints import Constraints, describe_projection
from coadjoint.solve.costs import LEAST, SHARE
from coadjoint.solve.course import Course, Start
from coadjoint.solve.dense_output import Trail
from coadjoint.solve.domain import Domain, Exit
from coadjoint.solve.driving import Driving, Following
from coadjoint.solve.events import read_events
from coadjoint.solve.family import FamilySystem
from coadjoint.solve.kernels import check_target
from coadjoint.solve.lookout import Ending, Lookout, explain_ending
from coadjoint.solve.noisy import check_no_noise, check_samples, choose_noisy, has_noise
from coadjoint.solve.occurrences import Events
from coadjoint.solve.reconstruct import check_asked, find_start, is_asked
from coadjoint.solve.request import (
    ATOL,
    IMPLICIT,
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
    is_chosen_by_structure,
    list_times,
    prefers_dop853,
    take_ends_of_steps,
)
from coadjoint.solve.shocks import warn_of_shock
from coadjoint.solve.solution import Solution
from coadjoint.solve.stability import is_of_waves, watch_waves
from coadjoint.solve.surroundings import Driven, Surroundings

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray
    from scipy.integrate import OdeSolver

    from coadjoint.solve.system import System
    from coadjoint.solve.wave_checkpoints import WaveCheckpoint
    from coadjoint.solve.wave_gauss import Made

    Array = NDArray[np.float64]
    Rates = Callable[[float, Array], Array]

#: Methods of SciPy that know no more of earlier steps than how long the next one is.
OF_ONE_STEP = ("RK23", "RK45", "DOP853")
#: The methods with steps of one length of fields by Fourier derivatives, and their orders.
_BY_WAVES = {"midpoint": 2, "gauss4": 4, "gauss6": 6, "gauss8": 8}
#: How the reason begins for which a step of it fails.
NOT_SOLVED = "the equation of a step is not solved"


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
    obstacle = generated.find_obstacle(system, target, reconstruct)
    recorded = bool(events or dense)
    stepwise = generated.find_stepwise(system, inputs, is_recorded=recorded)
    chosen = ""
    if has_noise(system):
        given = {"rtol or atol": tolerances, "dense": dense}
        given["reconstruct"] = is_asked(reconstruct)
        preferred = choose_noisy(system, method, step, seed, given)
        name, chosen = preferred.name, preferred.why
        if obstacle := obstacle or generated.find_noisy_obstacle(system, name):
            raise _explain_obstacle(system, name, obstacle)
    else:
        check_no_noise(system, method, seed)
        obstacles = dict.fromkeys((*GENERATED, *STRUCTURED, *MAPPED), obstacle) if obstacle else {}
        if is_chosen_by_structure(method, step) and not obstacle:
            obstacles |= generated.find_structure_obstacles(system, find_kind(reconstruct))
            obstacles |= generated.find_missing_maps(system, reconstruct)
        if stepwise and is_auto(method):
            obstacles |= dict.fromkeys(
                (*STRUCTURED, *MAPPED), f"Python leads the steps: {stepwise}"
            )
        if system.obstacle:  # whose methods are Python's, not generated ones
            for each in system.METHODS:
                obstacles.pop(each.name)
            reason = _explain_gradients(system)
            obstacles |= {name: reason for name in obstacles if "_gradient" in name}
        without = (
            ""
            if obstacle
            else generated.find_series_obstacle(
                system, stepwise, float(rtol), initial[0].size, is_auto=is_auto(method)
            )
        )
        obstacles |= {"taylor": without} if without else {}
        if not obstacle and not is_auto(method):
            obstacles |= generated.find_missing_maps(system, reconstruct)
        preferred = choose_method(system, method, step, obstacles, tolerances=tolerances)
        name, chosen = preferred.name, preferred.why
        within = "the path within steps is asked for" if recorded else obstacle or system.stepwise
        within = within or stepwise
        if prefers_dop853(system, find_kind(reconstruct), method, step, float(rtol), within):
            name, rtol, atol = "dop853", rtol * SHARE, atol * SHARE
        elif (
            name == "dop853" and step is None and is_auto(method) and without == generated.NO_SERIES
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
        generated.check_newton_applies(system, reconstruct)
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
        check_samples(request)
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
    _check_alone(system, request, obstacle)
    if request.state.ndim > 1:
        from coadjoint.solve.one_by_one import simulate_one_by_one

        return simulate_one_by_one(system, request, partial(_simulate_alone, system))
    return _simulate_alone(system, request)


def _explain_obstacle(system: System, name: str, obstacle: str) -> KernelArgumentError:
    """Why a motion with noise cannot be followed: there are generated solvers alone for it."""
    return KernelArgumentError(
        f"method {name!r} is a generated solver, which does not apply to {system.name} here: "
        f"{obstacle}.",
        found=name,
        reason=obstacle,
    )


def _explain_gradients(system: System) -> str:
    """Why discrete gradients are refused where Python leads the steps.

    Of a quadratic energy the mean of the gradient along a chord is that in its middle.
    """
    if any(each.name == "midpoint" and "energy" in each.exactly for each in system.METHODS):
        return (
            "its energy is quadratic, so that the mean of the gradient along a step is that in its "
            "middle: 'midpoint' is this method, and keeps the energy"
        )
    return (
        f"{system.obstacle} by rates as a whole, and a discrete gradient needs the bracket and the "
        "gradient of the energy apart"
    )


def _check_alone(system: System, request: Request, obstacle: str) -> None:
    """The methods of SciPy follow a batch where nothing else does, and keep no checkpoint then.

    Raises:
        KernelArgumentError: The state is a batch that other methods follow, or there is to be a
            checkpoint of what has none.
    """
    if request.checkpoint is not None and system.obstacle:
        _check_kept(system, request)
    elif request.checkpoint is not None:
        reason = f": {obstacle}" if obstacle else ""
        raise KernelArgumentError(
            f"checkpoint is given, and method {request.method!r} of SciPy keeps none; expected a "
            f"generated solver{', which does not apply here' if obstacle else ''}{reason}. Remove "
            "checkpoint.",
            found=str(request.checkpoint),
            reason=obstacle,
        )
    if request.state.ndim > 1 and not system.obstacle:
        advice = f"generated solvers do not apply: {obstacle}. Call it for each member"
        if not obstacle:
            advice = "leave method out, or take one of the generated ones, for a batch"
        raise KernelArgumentError(
            f"method {request.method!r} of simulate follows one trajectory; the state has the "
            f"shape {request.state.shape}, expected ({system.STATE.size},). "
            f"{advice[0].upper()}{advice[1:]}.",
            found=list(request.state.shape),
            expected=[system.STATE.size],
        )


def _check_kept(system: System, request: Request) -> None:
    """What a checkpoint by Fourier derivatives does not have.

    Raises:
        KernelArgumentError: The run has some of it.
    """
    known = [*_BY_WAVES, *(f"{SCIPY}{name}" for name in OF_ONE_STEP)]
    found = f"method {request.method!r}, of which SciPy keeps earlier steps,"
    advice = f"Take one of {', '.join(known)}"
    if request.method in known:
        found, advice = "a batch", "Call it for each member with a file of its own"
        if request.state.ndim == 1:
            found, advice = "events or dense output", "Leave them out"
            if not (request.events or request.dense):
                return
    raise KernelArgumentError(
        f"checkpoint is given, and {found} of {system.name} stands in none; expected one "
        "trajectory at samples, by a method that knows one step, since Python leads the steps. "
        f"{advice}, or remove checkpoint.",
        found=str(request.checkpoint),
        expected=known,
    )


def _simulate_alone(system: System, request: Request) -> Solution:
    """Integrate one trajectory with SciPy."""
    initial, target = request.state, request.target
    times = request.times if request.samples > 1 else np.append(request.start, request.times)
    packed = _pack_shared(system, request.parameters)
    name, rtol, atol = request.method.removeprefix(SCIPY), request.rtol, request.atol
    driving = Driving(system, request.inputs, float(times[0]), float(times[-1]))
    domain = Domain(system, packed, target, driving)
    domain.check_start(float(times[0]), initial)
    constraints = Constraints(system, packed, target, driving)
    initial = constraints.find_start(float(times[0]), initial, atol)
    followed = find_start(system, initial, request.reconstruct)
    initial = np.concatenate([initial, followed])
    rates, latest = _make_rates(system, packed, target, driving, followed.size)
    rates(times[0], initial)
    if not np.isfinite(latest).all():  # SciPy's choice of a first step would never end
        reason = f"the rates are not finite at t = {times[0]:g}"
        run = times[:1], initial[:, None], "NONFINITE", reason
        return _make_solution(system, packed, driving, run, request)
    with_slopes = name in IMPLICIT and not followed.size
    options = {"jac": _make_slopes(system, packed, target, driving)} if with_slopes else {}
    direct, made = None, None
    if name in _BY_WAVES:
        from coadjoint.solve.wave_gauss import Made  # by SciPy, which takes its time

        direct, made = _find_direction(system, packed), Made()

    def begin(time: float, state: Array, end: float) -> OdeSolver:
        import scipy.integrate  # which takes longer than a run of a generated solver

        driving.enter(time)
        if name in _BY_WAVES:
            from coadjoint.solve.wave_gauss import WaveGauss

            length, order = request.step or 0.0, _BY_WAVES[name]
            own: dict[str, Any] = {"step": length, "order": order, "direct": direct, "made": made}
            return WaveGauss(rates, time, state, end, **own)
        method: Callable[..., OdeSolver] = getattr(scipy.integrate, name)
        return method(rates, time, state, end, rtol=rtol, atol=atol, **options)

    checkpoint = None
    if request.checkpoint is not None:
        from coadjoint.solve.wave_checkpoints import WaveCheckpoint

        checkpoint = WaveCheckpoint(
            request.checkpoint, system, request, packed, times, followed, driving, made
        )
    stretches = _Stretches(begin, [times[0], *driving.breaks, times[-1]])
    trail = _make_trail(system, packed, driving, request, followed.size)
    most = request.max_steps
    with np.errstate(all="ignore"):
        run = _follow(
            stretches, initial, times, most, latest, domain, constraints, trail, checkpoint
        )
    ending = trail.finish()
    if ending is not None:
        run = _cut_at_event(*run[:2], ending)
    return _make_solution(system, packed, driving, run, request, trail, made)


def _find_direction(
    system: System, parameters: Array
) -> Callable[[Array, Array], Callable[[Array], Array]] | None:
    """What directs sweeps of Gauss's methods: the linear part of fields, where there is one."""
    from coadjoint.solve.stiff_waves import find_stiff_waves  # which reads formulas

    waves = find_stiff_waves(system, parameters)
    return None if waves is None else waves.direct


def _make_trail(
    system: System, parameters: Array, driving: Driving, request: Request, followed: int
) -> Trail:
    """Who looks at the steps."""
    driven = None if driving.signal is None else Driven(driving.signal)
    surroundings = Surroundings(system, parameters, driven, followed)
    lookout = None
    if request.events:
        lookout = Lookout(request.events, surroundings, request.rtol, request.atol, 1)
    return Trail(lookout, surroundings, keeps=request.dense)


#: Times that were reached, states there, status and reason.
_Run = tuple["Array", "Array", str, str]


def _make_solution(
    system: System,
    parameters: Array,
    driving: Driving,
    run: _Run,
    request: Request,
    trail: Trail | None = None,
    made: Made | None = None,
) -> Solution:
    """The Solution of a run, the state apart from what was reconstructed below it."""
    times, states, status, reason = run
    end = float(times[-1])
    n, start = system.STATE.size, None
    if request.samples == 1:
        steady = driving.is_constant
        given = driving.over(times[:1]).get("inputs")
        below = states[n:, 0].copy() if len(states) > n else None
        start = Start(
            time=request.start,
            state=states[:n, 0].copy(),
            inputs=given,
            varies=not steady,
            reconstructed=below,
        )
        times, states = times[-1:], states[:, -1:]
    followed = states[n:] if len(states) > n else None
    inputs = driving.over(times).get("inputs")
    by_waves = request.method in _BY_WAVES
    counts: dict[str, Any] = (
        {} if made is None else {k: np.asarray(n, np.uint64) for k, n in asdict(made).items()}
    )
    course = Course(
        method=request.method,
        order=_BY_WAVES.get(request.method),
        rtol=None if by_waves else request.rtol,
        atol=None if by_waves else request.atol,
        step=request.step,
        chosen=request.chosen,
        projection=describe_projection(system, request.method),
        start=start,
        **counts,
    )
    return Solution(
        system,
        times,
        states[:n],
        parameters,
        status,
        reason,
        followed,
        inputs,
        course=course,
        events=Events() if trail is None else trail.list_events(),
        dense=None if trail is None else trail.make_dense(end, driving.signal, request.start),
    )


class _Stretches:
    """The stretches between jumps of the inputs: an integrator for each, so that no step crosses.

    Args:
        begin: Makes an integrator at a time and state, up to another time.
        ends: The start, the jumps and the end.
    """

    def __init__(
        self,
        begin: Callable[[float, Array, float], OdeSolver],
        ends: list[float],
    ) -> None:
        self._begin, self._ends = begin, ends

    def skip(self, time: float) -> None:
        """Begin at a later time than the start."""
        self._ends = [time, *(end for end in self._ends[1:-1] if end > time), self._ends[-1]]

    def next(self, state: Array) -> OdeSolver | None:
        """The integrator of the next stretch; None after the last."""
        start, *self._ends = self._ends
        return self._begin(start, state, self._ends[0]) if self._ends else None


def _follow(
    stretches: _Stretches,
    initial: Array,
    times: Array,
    max_steps: int,
    latest: Array,
    domain: Domain,
    constraints: Constraints,
    trail: Trail,
    checkpoint: WaveCheckpoint | None,
) -> _Run:
    """The times that were reached, states there, status and reason.

    A loop of our own over SciPy's steps: its `solve_ivp` has no bound on their number, and keeps
    nothing of a trajectory that ends in an exception.
    """
    if checkpoint is not None and (time := checkpoint.find_time()) is not None:
        stretches.skip(time)
        initial = checkpoint.state
    solver = stretches.next(initial)
    assert solver is not None, "a run has an end"
    states = np.empty((solver.n, times.size))
    states[:, 0] = solver.y
    reached, steps, reason = 1, 0, ""
    if checkpoint is not None:
        reached, steps = checkpoint.resume(solver, states)
        if reached == times.size:
            return times, states, "OK", ""
    here = (solver.t, solver.y.copy())
    try:
        while solver.status == "running" and steps < max_steps:
            reason = solver.step() or ""
            if reason or not np.isfinite(solver.y).all():
                break
            before, here = here, (solver.t, constraints.move_onto(solver))
            dense = cache(solver.dense_output)
            path = partial(constraints.project_path, dense)
            after = int(np.searchsorted(times, solver.t, side="right"))
            if after > reached:
                states[:, reached:after] = path()(times[reached:after])
            points = zip(times[reached:after].tolist(), states.T[reached:after], strict=True)
            end = domain.find_exit(path, before, [*points, here])
            if trail.is_needed:
                ending = trail.add(dense(), before[0], here[0] if end is None else end.time)
                if ending is not None:
                    return _cut_at_event(times, states, ending)
            if end is not None:
                return *_cut_at_exit(times, states, end), "DOMAIN", domain.explain_exit(end)
            reached, steps = after, steps + 1
            if after < times.size and solver.status != "running":
                solver = stretches.next(here[1]) or solver
            if checkpoint is not None:
                is_end = reached == times.size
                checkpoint.write_sometimes(solver, states, reached, steps, now=is_end)
    except FloatingPointError:  # from the Jacobian
        latest[:] = np.nan
    place = f"near t = {solver.t:.6g}{domain.describe_nearest(solver.t, solver.y)}"
    came = (times[:reached], states[:, :reached])
    # An evaluation that is not finite spoils those after it in its step, the latest among them.
    if not (np.isfinite(solver.y).all() and np.isfinite(latest).all()):
        return *came, "NONFINITE", f"the rates are not finite {place}"
    if reason.startswith(NOT_SOLVED):
        return *came, "NOT_SOLVED", f"{reason} This is {place}."
    if solver.status == "failed":
        return *came, "STEP_UNDERFLOW", f"{reason} This is {place}."
    if solver.status == "running":
        reason = f"{max_steps} steps came only {place}; raise max_steps"
        return *came, "MAX_STEPS", reason
    return times, states, "OK", ""


def _cut_at_event(times: Array, states: Array, ending: Ending) -> _Run:
    """A run up to the event that ends it."""
    cut = _cut_at_exit(times, states, Exit(ending.time, ending.state, 0))
    return *cut, "EVENT", explain_ending(ending)


def _cut_at_exit(times: Array, states: Array, end: Exit) -> tuple[Array, Array]:
    """The samples before an exit, and the exit itself."""
    reached = int(np.searchsorted(times, end.time, side="right"))
    if times[reached - 1] == end.time:
        return times[:reached], states[:, :reached]
    samples = np.column_stack([states[:, :reached], end.state])
    return np.append(times[:reached], end.time), samples


def _make_rates(
    system: System, parameters: Array, target: Any, driving: Driving, followed: int
) -> tuple[Rates, Array]:
    """Rates for SciPy, all checks made once, and the array of the latest ones.

    Args:
        system: The System.
        parameters: ``(k,)``.
        target: Kernel that computes the rates.
        driving: Inputs and time.
        followed: How many components are reconstructed, below the state.
    """
    n, latest = system.STATE.size, np.empty(system.STATE.size + followed)
    own = Following(system, "rhs", parameters, target, driving)
    if followed:
        others = Following(system, "reconstruction", parameters, target, driving)

    def rates(t: float, y: Array) -> Array:
        latest[:n] = own(t, y)
        if followed:
            latest[n:] = others.at(y)
        return latest.copy()

    return rates, latest


def _make_slopes(system: System, parameters: Array, target: Any, driving: Driving) -> Rates:
    """The Jacobian for SciPy."""
    if "jacobian" in system.functions:
        evaluate: Rates = Following(system, "jacobian", parameters, target, driving)
    else:

        def evaluate(t: float, y: Array) -> Array:
            driving.at(t)
            return find_slopes(system, y, parameters, target=target, **driving.now)

    def jacobian(t: float, y: Array) -> Array:
        slopes = evaluate(t, y)
        if not np.isfinite(slopes).all():  # SciPy's solvers of linear systems do not take it
            raise FloatingPointError
        return slopes.copy()

    return jacobian


def _pack_shared(system: System, parameters: Any) -> Array:
    """One set of parameters."""
    packed = pack_parameters(system, parameters).copy()
    if packed.ndim != 1:
        raise KernelArgumentError(
            f"simulate follows one trajectory; parameters have the shape {packed.shape}, expected "
            f"({system.PARAMETERS.size},). Call it for each member.",
            found=list(packed.shape),
        )
    return packed
