"""One trajectory by SciPy's integrators and the kernels.

Comes in: a System and a Request that names a method of SciPy, or one with steps of one length of
fields by Fourier derivatives. Goes out: a `Solution`. Read next: `coadjoint.solve.wave_gauss`.
"""

from __future__ import annotations

from dataclasses import asdict
from functools import cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.arrays import find_slopes, pack_parameters
from coadjoint.solve.constraints import Constraints, describe_projection
from coadjoint.solve.course import Course, Start
from coadjoint.solve.dense_output import Trail
from coadjoint.solve.domain import Domain, Exit
from coadjoint.solve.driving import Driving, Following
from coadjoint.solve.lookout import Ending, Lookout, explain_ending
from coadjoint.solve.occurrences import Events
from coadjoint.solve.reconstruct import find_start
from coadjoint.solve.request import (
    IMPLICIT,
    SCIPY,
    Request,
)
from coadjoint.solve.solution import Solution
from coadjoint.solve.surroundings import Driven, Surroundings

if TYPE_CHECKING:
    from collections.abc import Callable

    from scipy.integrate import OdeSolver

    from coadjoint.array_types import Array
    from coadjoint.solve.system import System
    from coadjoint.solve.wave_checkpoints import WaveCheckpoint
    from coadjoint.solve.wave_gauss import Made

    Rates = Callable[[float, Array], Array]

#: Methods of SciPy that know no more of earlier steps than how long the next one is.
OF_ONE_STEP = ("RK23", "RK45", "DOP853")
#: The methods with steps of one length of fields by Fourier derivatives, and their orders.
_BY_WAVES = {"midpoint": 2, "gauss4": 4, "gauss6": 6, "gauss8": 8}
#: How the reason begins for which a step of it fails.
NOT_SOLVED = "the equation of a step is not solved"


def check_alone(system: System, request: Request, obstacle: str) -> None:
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


def simulate_alone(system: System, request: Request) -> Solution:
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
        reason = f"the rates are not finite at {system.clock[0]} = {times[0]:g}"
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
        run = _cut_at_event(*run[:2], ending, system.clock[0])
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
                    return _cut_at_event(times, states, ending, domain.system.clock[0])
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
    clock = domain.system.clock[0]
    place = f"near {clock} = {solver.t:.6g}{domain.describe_nearest(solver.t, solver.y)}"
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


def _cut_at_event(times: Array, states: Array, ending: Ending, clock: str) -> _Run:
    """A run up to the event that ends it."""
    cut = _cut_at_exit(times, states, Exit(ending.time, ending.state, 0))
    return *cut, "EVENT", explain_ending(ending, clock)


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
