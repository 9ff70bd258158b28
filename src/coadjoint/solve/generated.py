"""Simulation of one trajectory or many with the generated solvers of a System.

Comes in: states, times and parameters of one member or of a batch. Goes out: a `Solution`. All that
can be is checked before the first step. Read next: `coadjoint.solve.march`.
"""

from __future__ import annotations

import math
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.methods import NOISY, STRUCTURED
from coadjoint.solve.arrays import pack_inputs, pack_parameters, tell_member
from coadjoint.solve.checkpoints import Checkpoint
from coadjoint.solve.comparison import count_rows, has_same_bits, list_kinks
from coadjoint.solve.constraints import describe_projection
from coadjoint.solve.course import Course, Start
from coadjoint.solve.domain import Domain, Exit
from coadjoint.solve.driving import Driving, Function, Linear, Previous, Signal, make_signal
from coadjoint.solve.ensemble import Ensemble, Inputs, Status, tell_endings
from coadjoint.solve.family import FamilySystem
from coadjoint.solve.family_steps import find_stepper
from coadjoint.solve.kinks import describe_sliding, list_kinks_met
from coadjoint.solve.march import count_threads, march, progress_bar
from coadjoint.solve.noisy import check_knots
from coadjoint.solve.obstacles import NO_SERIES, find_newton_obstacle, has_roots_at_kinks
from coadjoint.solve.reconstruct import find_start
from coadjoint.solve.recording import Recording
from coadjoint.solve.solution import Solution
from coadjoint.solve.starts import check_starts
from coadjoint.solve.stochastic import find_bound
from coadjoint.solve.surroundings import Driven, Surroundings
from coadjoint.solve.twins import StepwiseStepper

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.solve.choices import Choice
    from coadjoint.solve.quantities import Quantities
    from coadjoint.solve.request import Request
    from coadjoint.solve.solvers import Stepper
    from coadjoint.solve.system import System

#: Inputs that change on the way.
_VARYING = Previous | Linear | Function


def simulate(system: System, request: Request) -> Solution:
    """Integrate a trajectory or many by a generated solver.

    Args:
        system: The System.
        request: What is to be done, its times, method and tolerances checked.
    """
    batch, n = request.state.shape[1:], system.STATE.size
    run, driven = _gather(system, request)
    if request.seed is not None:
        check_knots(system, request, run.inputs.knots)
    now = _drive(system, run, request.start, driven)
    check_starts(system, request, run, now)
    below = find_start(system, run.state[:n].reshape(n, *batch), request.reconstruct)
    run.state[n:] = below.reshape(len(below), run.state.shape[1])
    recording = _make_recording(system, request, run, driven)
    stepper = _find_stepper(system, request, driven)
    run.begin(request.start)
    _end_undefined(system, request, run, now)
    checkpoint = _make_checkpoint(system, request, run, stepper, recording, driven)
    with ExitStack() as stack:
        told = request.progress if callable(request.progress) else None
        if request.progress is True:
            told = stack.enter_context(progress_bar())
        # a function of Python may not be ready to be called by several threads
        threads = 1 if request.stepwise else request.threads or count_threads()
        march(stepper, run, request.start, threads, told, checkpoint, recording)
    if recording is not None:
        recording.finish()
    course = _make_course(system, request, run, driven, below)
    return _make_solution(system, request, run, course, driven, recording)


def _tell_keeps(choice: Choice) -> str:
    """What a method keeps by itself, of a motion with noise on each path; "" for nothing."""
    known = NOISY if choice.is_noisy else STRUCTURED
    return known[choice.name].keeps if choice.name in known else ""


def _make_course(
    system: System, request: Request, run: Ensemble, signal: Signal | Array | None, below: Array
) -> Course:
    """How a run went; ``below`` is where what is reconstructed began, ``(k, *batch)``."""
    batch, n = request.state.shape[1:], len(request.state)
    return Course(
        method=request.choice.name,
        order=None if request.seed is not None else request.choice.order,
        seed=request.seed,
        keeps=_tell_keeps(request.choice),
        chosen=request.chosen,
        projection=describe_projection(system, request.choice.name),
        rtol=None if request.step and request.choice.name != "taylor" else request.rtol,
        atol=None if request.step else request.atol,
        step=request.step,
        codes=run.status.reshape(batch),
        steps=run.steps.reshape(batch),
        rejected=run.rejected.reshape(batch),
        newton=request.newton,
        sweeps=None if run.sweeps is None else run.sweeps.reshape(batch),
        reached=run.time.reshape(batch),
        last=run.state[:n].reshape(-1, *batch),
        below=run.state[n:].reshape(below.shape) if len(below) else None,
        driven=_find_driven(signal, run, batch),
        stepwise=request.stepwise,
        kinks=list_kinks_met(run, list_kinks(system, request.choice), batch),
        start=_find_start(request, signal, below) if request.samples == 1 else None,
    )


def _make_recording(
    system: System, request: Request, run: Ensemble, signal: Signal | Array | None
) -> Recording | None:
    """Who looks at the steps; None where nobody has to."""
    if not (request.events or request.dense):
        return None
    followed = len(run.state) - system.STATE.size
    driven = None if signal is None else Driven(signal)
    surroundings = Surroundings(system, run.parameters, driven, followed)
    return Recording(run, request.events, surroundings, keeps=request.dense)


def _find_stepper(system: System, request: Request, signal: Signal | Array | None) -> Stepper:
    """Who makes the steps."""
    function = signal if isinstance(signal, Function) else None
    if isinstance(system, FamilySystem):
        return find_stepper(system, request.choice, request.target, function)
    if not request.stepwise:
        members = math.prod(request.state.shape[1:])
        return system._solvers.get(request.choice, request.target, members)
    return StepwiseStepper(system, request.choice, request.target, function)


# -- before the first step ----------------------------------------------------------------------


def _gather(system: System, request: Request) -> tuple[Ensemble, Signal | Array | None]:
    """The ensemble of a request, and its inputs."""
    n, batch = system.STATE.size, request.state.shape[1:]
    is_family = isinstance(system, FamilySystem)
    rows, members = count_rows(system, request.choice), math.prod(batch)
    quick = system._solvers.pack(request.parameters)
    parameters = pack_parameters(system, request.parameters) if quick is None else np.array(quick)
    check_batch(parameters, batch, system.PARAMETERS, "parameters")
    if parameters.ndim > 1:
        parameters = parameters.reshape(-1, members)
    signal = _find_signal(system, request, batch)
    times = request.times
    state = np.full((rows, members), np.nan)  # what is reconstructed begins later
    state[:n] = request.state.reshape(n, members)
    run = Ensemble(
        state=state,
        parameters=parameters,
        inputs=_lay_out(signal, system.INPUTS.size, members, request.start),
        has_time=bool(system.TIME),
        samples=times,
        out=None if request.samples == 1 else np.full((rows, members, times.size), np.nan),
        rtol=request.rtol,
        atol=request.atol,
        size=request.step or 0.0,
        max_steps=request.max_steps,
        sides=len(list_kinks(system, request.choice)),
        remembered=request.choice.count_memory(rows, searches=not is_family),
        is_implicit=request.choice.is_implicit,
        has_clock=not is_family,
    )
    if request.seed is not None and request.step is not None:
        run.seed, run.bound = request.seed, find_bound(request.choice.name, request.step)
    return run, signal


def check_batch(array: Array, batch: tuple[int, ...], quantities: Quantities, name: str) -> None:
    """What is given for each member has to be so for the members of the state.

    Raises:
        KernelArgumentError: It is of another batch, or not finite.
    """
    if array.shape[1:] not in ((), batch):
        alone = "simulate follows one trajectory for a state without a batch; " if not batch else ""
        raise KernelArgumentError(
            f"{alone}{name} have the batch shape {array.shape[1:]}, the state {batch}; expected "
            f"the same, or {name} shared by all members.",
            found=list(array.shape[1:]),
            expected=list(batch),
        )
    if not np.isfinite(array).all():
        place = np.argwhere(~np.isfinite(array))[0]
        raise KernelArgumentError(
            f"{quantities.components[place[0]]}{tell_member(place)} of the {name} is "
            f"{array[tuple(place)]}; expected a finite number.",
            found=str(array[tuple(place)]),
        )


def _find_signal(system: System, request: Request, batch: tuple[int, ...]) -> Signal | Array | None:
    """Inputs over time, or constants of each member; None where a system has none."""
    given = request.inputs
    sampled = isinstance(given, tuple) and any(np.ndim(part) for part in given)
    if batch and system.INPUTS and not sampled and not callable(given):
        packed = pack_inputs(system, given)
        check_batch(packed, batch, system.INPUTS, "inputs")
        if packed.ndim > 1:
            return packed
    return make_signal(system, given, request.start, float(request.times[-1]))


def _lay_out(signal: Signal | Array | None, rows: int, members: int, start: float) -> Inputs:
    """Inputs as straight lines between knots."""
    knots = np.array([start])
    if isinstance(signal, np.ndarray):
        values = signal.reshape(rows, members).copy()
        return Inputs(knots, values, np.zeros(values.shape), own=True)
    if isinstance(signal, Previous):
        values = signal.values
        first = np.append(True, (values[:, 1:] != values[:, :-1]).any(axis=0))
        held = np.ascontiguousarray(values[:, first])
        return Inputs(signal.times[first].copy(), held, np.zeros(held.shape))
    if isinstance(signal, Linear):
        slopes = np.diff(signal.values) / np.diff(signal.times)
        return Inputs(signal.times[:-1].copy(), signal.values[:, :-1].copy(), slopes)
    values = np.zeros((rows, 1))  # of a function, which is asked on the way
    if signal is not None and not isinstance(signal, Function):
        values = signal.values[:, np.newaxis].copy()
    return Inputs(knots, values, np.zeros(values.shape))


def _drive(
    system: System, run: Ensemble, start: float, signal: Signal | Array | None
) -> dict[str, Any]:
    """Inputs and time at the start, as functions of the System take them."""
    inputs, driving = run.inputs, dict[str, Any]()
    if isinstance(signal, Function):
        driving["inputs"] = signal.at(start)
    elif system.INPUTS:
        piece = int(np.searchsorted(inputs.knots[1:], start, side="right"))
        here = slice(None) if inputs.own else piece
        after = start - inputs.knots[piece]
        driving["inputs"] = inputs.values[:, here] + after * inputs.slopes[:, here]
    if system.TIME:
        driving["time"] = start
    return driving


def _end_undefined(system: System, request: Request, run: Ensemble, now: dict[str, Any]) -> None:
    """Members whose rates are not finite at the start end there."""
    for name in request.choice.kind.rates:
        state = run.state[: system.rows(name).size]
        rates = system.evaluate(name, state, run.parameters, target="numpy", **now)
        run.status[~np.isfinite(rates).all(axis=0)] = Status.NONFINITE


def _make_checkpoint(
    system: System,
    request: Request,
    run: Ensemble,
    stepper: Stepper,
    recording: Recording | None,
    signal: Signal | Array | None,
) -> Checkpoint | None:
    """The checkpoint of a run, which stands where it was broken off; None if none was asked for."""
    if request.checkpoint is None:
        return None
    same_bits = request.target != "c-fast" and has_same_bits(system, request.method)
    checkpoint = Checkpoint(
        path=request.checkpoint,
        system=system,
        request=request,
        run=run,
        build="" if same_bits else stepper.key,
        recording=recording,
        signal=signal,
    )
    checkpoint.resume(run)
    return checkpoint


# -- after the last step ------------------------------------------------------------------------


def _make_solution(
    system: System,
    request: Request,
    run: Ensemble,
    course: Course,
    signal: Signal | Array | None,
    recording: Recording | None,
) -> Solution:
    """The Solution of a run."""
    batch, times, n = request.state.shape[1:], request.times, system.STATE.size
    states = run.state[..., np.newaxis] if run.out is None else run.out
    states = states.reshape(-1, *batch, times.size)
    if not batch:
        times, states = _cut(times, states, run)
    parameters = run.parameters
    if parameters.ndim > 1:
        parameters = parameters.reshape(-1, *batch)
    if isinstance(signal, np.ndarray):
        inputs: Array | None = signal[..., np.newaxis]
    else:
        inputs = None if signal is None else signal.over(times)
    status = "" if batch else Status(int(run.status[0])).name
    if recording is not None and status == "EVENT":
        message = recording.explain_end(system.clock[0])
    else:
        message = tell_endings(run.status) if batch else _explain(system, request, run, course)
    return Solution(
        system,
        times,
        states[:n],
        parameters.copy(),
        status,
        message,
        states[n:] if len(states) > n else None,
        inputs,
        course=course,
        events=None if recording is None else recording.list_events(batch),
        dense=None if recording is None else recording.make_dense(signal, request.start),
    )


def _find_driven(
    signal: Signal | Array | None, run: Ensemble, batch: tuple[int, ...]
) -> Array | None:
    """The inputs where each member came, if they change."""
    if not isinstance(signal, _VARYING):
        return None
    return signal.over(run.time).reshape(-1, *batch)


def _find_start(request: Request, signal: Signal | Array | None, below: Array) -> Start:
    """Where a run began."""
    varies = isinstance(signal, _VARYING)
    if isinstance(signal, np.ndarray):
        inputs: Array | None = signal[..., np.newaxis]
    else:
        inputs = None if signal is None else signal.over(np.array([request.start]))
    return Start(
        time=request.start,
        state=request.state.copy(),
        inputs=inputs,
        varies=varies,
        reconstructed=below if len(below) else None,
    )


def _cut(times: Array, states: Array, run: Ensemble) -> tuple[Array, Array]:
    """The samples that one trajectory reached, then where it came if that is not the end."""
    if run.status[0] == Status.OK:
        return times, states
    reached, came = 0 if run.out is None else int(run.next[0]), float(run.time[0])
    times, states = times[:reached], states[:, :reached]
    if not reached or times[-1] < came:
        times, states = np.append(times, came), np.column_stack([states, run.state[:, 0]])
    return times, states


def _explain(system: System, request: Request, run: Ensemble, course: Course) -> str:
    """Where one trajectory stopped and why; "" at its end."""
    status, time, state = Status(int(run.status[0])), float(run.time[0]), run.state[:, 0].copy()
    state = state[: system.STATE.size]
    if status == Status.OK:
        return ""
    parameters = run.parameters if run.parameters.ndim == 1 else run.parameters[:, 0].copy()
    inputs = run.inputs.values[:, 0].copy() if run.inputs.own else request.inputs
    driving = Driving(system, inputs, request.start, float(request.times[-1]))
    driving.enter(time)
    domain = Domain(system, parameters, request.target, driving)
    if status == Status.DOMAIN:
        rates = system.rhs(state, parameters, target="numpy", **driving.now)
        return domain.explain_exit(Exit(time, state, domain.find_leaving(time, state, rates)))
    if status == Status.SLIDING and course.kinks is not None:
        return (
            f"the motion slides along {describe_sliding(course.kinks)} from "
            f"{system.clock[0]} = {time:.12g} on: "
            "both sides of the kink push it back, or kinks follow one another without end. What it "
            "does there the rates do not say: describe it by a system with this constraint"
        )
    place = f"near {system.clock[0]} = {time:.6g}{domain.describe_nearest(time, state)}"
    return {
        Status.NONFINITE: f"rates, or what a step makes of them, are not finite {place}",
        Status.STEP_UNDERFLOW: f"no step was small enough {place}{_advise_dop853(system, request)}"
        if request.step is None
        else f"the motion cannot be followed by a step of {request.step:.12g} {place}",
        Status.NOT_SOLVED: f"the equation of a step of {request.step or 0.0:.12g} was not solved "
        f"{place}; take shorter steps{_advise_newton(system, request)}",
        Status.MAX_STEPS: f"{request.max_steps} steps came only {place}; raise max_steps",
    }[status]


def _advise_dop853(system: System, request: Request) -> str:
    """What else may go on where rates have no series; "" for nothing."""
    is_it = request.method == "taylor" and not request.stepwise and has_roots_at_kinks(system)
    return f": {NO_SERIES}; take method='dop853'" if is_it else ""


def _advise_newton(system: System, request: Request) -> str:
    """What else may solve the equations of steps; "" for nothing."""
    has_it = not (request.newton or find_newton_obstacle(system, request.reconstruct))
    return ", or newton=True, which solves stiff ones" if has_it else ""
