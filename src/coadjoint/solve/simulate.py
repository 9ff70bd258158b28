"""Simulation of one trajectory with SciPy's integrators and the kernels of a System.

Comes in: an initial state and times. Goes out: a `Solution`. Read next: `coadjoint.solve.solution`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.integrate import solve_ivp

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.arrays import as_float64, pack, pack_parameters
from coadjoint.solve.solution import Solution

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from coadjoint.solve.system import System

METHODS = ("DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA")

class _NotFinite(Exception):
    """The rates stopped being finite."""

    def __init__(self, time: float) -> None:
        super().__init__(time)
        self.time = time


def simulate(
    system: System,
    state: Any,
    t: Any,
    parameters: Any,
    *,
    method: str,
    rtol: float,
    atol: float,
    samples: int,
    target: Any,
) -> Solution:
    """Integrate one trajectory; arguments as in `System.simulate`."""
    initial = pack(state, system.STATE, "state")
    _check_initial(system, initial)
    packed = pack_parameters(system, parameters)
    if packed.ndim != 1:
        raise KernelArgumentError(
            f"simulate follows one trajectory; parameters have the shape {packed.shape}, expected "
            f"({system.PARAMETERS.size},). Call it for each member.",
            found=list(packed.shape),
        )
    times = _times(t, samples)
    name = "DOP853" if method == "auto" else method
    if name not in METHODS:
        raise KernelArgumentError(
            f"method is {method!r}; expected 'auto' or one of {', '.join(METHODS)}.",
            found=method,
            expected=["auto", *METHODS],
        )
    rates, slopes = _bound(system, packed, target)
    options: dict[str, Any] = {"jac": slopes} if name in ("Radau", "BDF", "LSODA") else {}
    time, states, status, message = _integrate(rates, times, initial, name, rtol, atol, options)
    return Solution(system, time, states, packed, status, message)


def _integrate(
    rates: Callable[..., Any],
    times: NDArray[np.float64],
    initial: NDArray[np.float64],
    method: str,
    rtol: float,
    atol: float,
    options: dict[str, Any],
) -> list[Any]:
    """Times reached, states there, status and message."""
    try:
        with np.errstate(all="ignore"):
            found = solve_ivp(
                rates,
                (times[0], times[-1]),
                initial,
                method=method,
                t_eval=times,
                rtol=rtol,
                atol=atol,
                **options,
            )
    except _NotFinite as stop:
        message = f"the rates are not finite near t = {stop.time:.17g}"
        before = times[times < stop.time]
        if len(before) > 1 and len(before) < len(times):
            # The samples that were reached are worth having: run again up to there.
            again = _integrate(rates, before, initial, method, rtol, atol, options)
            return [again[0], again[1], "NONFINITE", message]
        return [times[:1], initial[:, None], "NONFINITE", message]
    status = "OK" if found.status == 0 else "STEP_UNDERFLOW"
    if not len(found.t):  # not even one step was made
        return [times[:1], initial[:, None], status, found.message]
    return [found.t, found.y, status, "" if found.status == 0 else found.message]


def _bound(
    system: System, parameters: NDArray[np.float64], target: Any
) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Rates and Jacobian for SciPy, with all checks made once."""
    state, out = np.empty(system.STATE.size), np.empty(system.STATE.size)
    slopes = np.empty((system.STATE.size, system.STATE.size))
    evaluate = system.bind("rhs", state, parameters, out, target)
    differentiate = system.bind("jacobian", state, parameters, slopes, target)

    def rates(time: float, y: NDArray[np.float64]) -> NDArray[np.float64]:
        state[:] = y
        evaluate()
        if not np.isfinite(out).all() and np.isfinite(y).all():
            raise _NotFinite(time)
        return out.copy()

    def jacobian(time: float, y: NDArray[np.float64]) -> NDArray[np.float64]:
        state[:] = y
        differentiate()
        return slopes.copy()

    return rates, jacobian


def _check_initial(system: System, initial: NDArray[np.float64]) -> None:
    """One finite state."""
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


def _times(t: Any, samples: int) -> NDArray[np.float64]:
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
