"""Simulation of one trajectory with SciPy's integrators and the kernels of a System.

Comes in: an initial state and times. Goes out: a `Solution`. Read next: `coadjoint.solve.solution`.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.integrate

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.arrays import as_float64, pack, pack_parameters
from coadjoint.solve.constraints import Constraints
from coadjoint.solve.domain import Domain, Exit
from coadjoint.solve.driving import Driving, Following
from coadjoint.solve.reconstruct import find_start
from coadjoint.solve.solution import Solution

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from coadjoint.solve.system import System

    Array = NDArray[np.float64]
    Rates = Callable[[float, Array], Array]

#: Explicit methods of SciPy, then those that use the Jacobian.
EXPLICIT, IMPLICIT = ("DOP853", "RK45", "RK23"), ("Radau", "BDF", "LSODA")


def simulate(
    system: System,
    state: Any,
    t: Any,
    parameters: Any,
    *,
    inputs: Any,
    method: str,
    rtol: float,
    atol: float,
    samples: int,
    max_steps: int,
    target: Any,
    reconstruct: Any,
) -> Solution:
    """Integrate one trajectory; arguments as in `System.simulate`."""
    initial = _check_initial(system, state)
    packed = _pack_shared(system, parameters)
    times = _list_times(t, samples)
    name = _check_method(method)
    _check_positive(rtol=rtol, atol=atol, max_steps=max_steps)
    settings = {"method": name, "rtol": float(rtol), "atol": float(atol), "target": str(target)}
    driving = Driving(system, inputs, float(times[0]), float(times[-1]))
    domain = Domain(system, packed, target, driving)
    domain.check_start(float(times[0]), initial)
    constraints = Constraints(system, packed, target, driving)
    initial = constraints.find_start(float(times[0]), initial, atol)
    followed = find_start(system, initial, reconstruct)
    initial = np.concatenate([initial, followed])
    rates, latest = _make_rates(system, packed, target, driving, followed.size)
    rates(times[0], initial)
    if not np.isfinite(latest).all():  # SciPy's choice of a first step would never end
        reason = f"the rates are not finite at t = {times[0]:g}"
        run = times[:1], initial[:, None], "NONFINITE", reason
        return _make_solution(system, packed, driving, run, settings)
    with_slopes = name in IMPLICIT and not followed.size
    options = {"jac": _make_slopes(system, packed, target, driving)} if with_slopes else {}

    def begin(time: float, state: Array, end: float) -> scipy.integrate.OdeSolver:
        driving.enter(time)
        method: Callable[..., scipy.integrate.OdeSolver] = getattr(scipy.integrate, name)
        return method(rates, time, state, end, rtol=rtol, atol=atol, **options)

    stretches = _Stretches(begin, [times[0], *driving.breaks, times[-1]])
    with np.errstate(all="ignore"):
        run = _follow(stretches, initial, times, max_steps, latest, domain, constraints)
    return _make_solution(system, packed, driving, run, settings)


#: Times that were reached, states there, status and reason.
_Run = tuple["Array", "Array", str, str]


def _make_solution(
    system: System, parameters: Array, driving: Driving, run: _Run, settings: dict[str, Any]
) -> Solution:
    """The Solution of a run, the state apart from what was reconstructed below it."""
    times, states, status, reason = run
    n = system.STATE.size
    followed = states[n:] if len(states) > n else None
    inputs = driving.over(times).get("inputs")
    return Solution(
        system=system,
        time=times,
        state=states[:n],
        parameters=parameters,
        status=status,
        message=reason,
        reconstructed=followed,
        inputs=inputs,
        settings=settings,
    )


class _Stretches:
    """The stretches between jumps of the inputs: an integrator for each, so that no step crosses.

    Args:
        begin: Makes an integrator at a time and state, up to another time.
        ends: The start, the jumps and the end.
    """

    def __init__(
        self,
        begin: Callable[[float, Array, float], scipy.integrate.OdeSolver],
        ends: list[float],
    ) -> None:
        self._begin, self._ends = begin, ends

    def next(self, state: Array) -> scipy.integrate.OdeSolver | None:
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
) -> _Run:
    """The times that were reached, states there, status and reason.

    A loop of our own over SciPy's steps: its `solve_ivp` has no bound on their number, and keeps
    nothing of a trajectory that ends in an exception.
    """
    solver = stretches.next(initial)
    assert solver is not None, "a run has an end"
    states = np.empty((solver.n, times.size))
    states[:, 0] = solver.y
    reached, steps, reason = 1, 0, ""
    here = (solver.t, solver.y.copy())
    try:
        while solver.status == "running" and steps < max_steps:
            reason = solver.step() or ""
            if reason or not np.isfinite(solver.y).all():
                break
            before, here = here, (solver.t, constraints.move_onto(solver))
            path = partial(constraints.project_path, solver.dense_output)
            after = int(np.searchsorted(times, solver.t, side="right"))
            if after > reached:
                states[:, reached:after] = path()(times[reached:after])
            points = zip(times[reached:after].tolist(), states.T[reached:after], strict=True)
            end = domain.find_exit(path, before, [*points, here])
            if end is not None:
                return *_cut_at_exit(times, states, end), "DOMAIN", domain.explain_exit(end)
            reached, steps = after, steps + 1
            if after < times.size and solver.status != "running":
                solver = stretches.next(here[1]) or solver
    except FloatingPointError:  # from the Jacobian
        latest[:] = np.nan
    place = f"near t = {solver.t:.6g}{domain.describe_nearest(solver.t, solver.y)}"
    came = (times[:reached], states[:, :reached])
    # An evaluation that is not finite spoils those after it in its step, the latest among them.
    if not (np.isfinite(solver.y).all() and np.isfinite(latest).all()):
        return *came, "NONFINITE", f"the rates are not finite {place}"
    if solver.status == "failed":
        return *came, "STEP_UNDERFLOW", f"{reason} This is {place}."
    if solver.status == "running":
        reason = f"{max_steps} steps came only {place}; raise max_steps"
        return *came, "MAX_STEPS", reason
    return times, states, "OK", ""


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
    evaluate = Following(system, "jacobian", parameters, target, driving)

    def jacobian(t: float, y: Array) -> Array:
        slopes = evaluate(t, y)
        if not np.isfinite(slopes).all():  # SciPy's solvers of linear systems do not take it
            raise FloatingPointError
        return slopes.copy()

    return jacobian


def _check_initial(system: System, state: Any) -> Array:
    """One finite state."""
    initial = pack(state, system.STATE, "state").copy()
    if initial.shape != (system.STATE.size,):
        raise KernelArgumentError(
            f"simulate follows one trajectory; the state has the shape {initial.shape}, expected "
            f"({system.STATE.size},): {', '.join(system.STATE.components)}. "
            "For a batch, call it for each member.",
            found=list(initial.shape),
            expected=[system.STATE.size],
        )
    if not np.isfinite(initial).all():
        bad = system.STATE.components[int(np.argmin(np.isfinite(initial)))]
        raise KernelArgumentError(
            f"the initial {bad} is {initial[system.STATE.rows(bad)]}; expected a finite number.",
            found=bad,
        )
    return initial


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


def _check_method(method: str) -> str:
    """The name of SciPy's class."""
    name = "DOP853" if method == "auto" else method
    if name not in EXPLICIT + IMPLICIT:
        raise KernelArgumentError(
            f"method is {method!r}; expected 'auto' or one of {', '.join(EXPLICIT + IMPLICIT)}.",
            found=method,
            expected=["auto", *EXPLICIT, *IMPLICIT],
        )
    return name


def _check_positive(**numbers: float) -> None:
    """Tolerances and bounds: a tolerance of zero has SciPy divide by it and never end."""
    for name, value in numbers.items():
        if not 0 < value < np.inf:
            raise KernelArgumentError(
                f"{name} is {value}; expected a positive number.", found=value, name=name
            )


def _list_times(t: Any, samples: int) -> Array:
    """Sample times from a pair or a sequence."""
    times = as_float64(t, "t")
    increasing = times.ndim == 1 and times.size >= 2 and bool((np.diff(times) > 0).all())
    if not increasing or not np.isfinite(times).all():
        raise KernelArgumentError(
            f"t is {t!r}; expected (start, end) or increasing finite times.", found=str(t)[:80]
        )
    if times.size > 2:
        return times
    if samples < 2:
        raise KernelArgumentError(f"samples is {samples}; expected 2 or more.", found=samples)
    return np.linspace(times[0], times[1], samples)
