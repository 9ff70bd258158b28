"""The request: what `System.simulate` was asked for, checked, and the method that will do it.

Comes in: arguments of a person. Goes out: a `Request`, or an error before any work starts. Read
next: `coadjoint.solve.generated`, and `coadjoint.solve.scipy_steps` for the methods of SciPy.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cached_property
from numbers import Integral, Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.methods import MAPPED, STRUCTURED
from coadjoint.solve.arrays import as_float64, check_rows, pack, tell_member
from coadjoint.solve.choices import GENERATED, Choice
from coadjoint.solve.costs import choose_order
from coadjoint.solve.family import check_profiles
from coadjoint.solve.preferences import Preferred, find_default, grant_wish, is_wish
from coadjoint.solve.reconstruct import is_asked
from coadjoint.solver_kinds import RECONSTRUCTION, SOLVER, SolverKind

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.solve.events import Sought
    from coadjoint.solve.system import System

#: Explicit methods of SciPy, then those that use the Jacobian; each is ``scipy:NAME``.
EXPLICIT, IMPLICIT = ("DOP853", "RK45", "RK23"), ("Radau", "BDF", "LSODA")
SCIPY = "scipy:"
#: Tolerances where none are given.
RTOL, ATOL = 1e-10, 1e-12
#: Orders of the generated methods whose order is fixed.
_FIXED_STEP = {**STRUCTURED, **MAPPED}
_ORDER = {"dop853": 8, "rk4": 4, "heun": 2} | {n: each.order for n, each in _FIXED_STEP.items()}


@dataclass(frozen=True)
class Request:
    """What is to be done.

    Attributes:
        state: ``(n, *batch)``.
        start: When it begins.
        times: Sample times; the last is the end.
        samples: 1 where the end alone is wanted.
        parameters: As given.
        inputs: As given.
        method: ``scipy:NAME``, or one of `GENERATED`.
        rtol: Relative tolerance.
        atol: Absolute tolerance.
        step: A fixed step; None to have steps follow the tolerances.
        max_steps: The most of a trajectory.
        target: Who computes.
        reconstruct: As given.
        threads: How many threads, at the most; None for all processors.
        progress: Whether to show a bar, or whom to tell.
        checkpoint: Where a run on its way is kept; None for nowhere.
        events: What to look for.
        dense: Whether the steps are kept.
        stepwise: Why a generated method makes its steps in Python; empty where it does not.
        chosen: Why the method was taken, where it was left to us and keeps structure or could.
        seed: Of the noise; None where there is none.
        newton: Whether Newton's method solves the equations of implicit steps.
        of_waves: Whether the system has fields, whose waves a method of Taylor is not to make grow.
    """

    state: Array
    start: float
    times: Array
    samples: int
    parameters: Any
    inputs: Any
    method: str
    rtol: float
    atol: float
    step: float | None
    max_steps: int
    target: str
    reconstruct: Any
    threads: int | None
    progress: bool | Callable[[float], object]
    checkpoint: Path | None
    events: tuple[Sought, ...]
    dense: bool
    stepwise: str
    seed: int | None = None
    chosen: str = ""
    newton: bool = False
    of_waves: bool = False

    @cached_property
    def choice(self) -> Choice:
        """The generated method."""
        order = _ORDER.get(self.method) or choose_order(self.rtol, of_waves=self.of_waves)
        kind = find_kind(self.reconstruct)
        return Choice(
            name=self.method,
            order=order,
            kind=kind,
            is_noisy=self.seed is not None,
            newton=self.newton,
        )


def check_state(system: System, state: Any) -> Array:
    """Finite states, ``(n, *batch)``, with the defaults of the spec for what is left out by name.

    Raises:
        KernelArgumentError: Another shape, or a number that is not finite.
    """
    given = {} if state is None else state
    if isinstance(given, Mapping):
        check_profiles(system, given)
    packed = pack(given, system.STATE, "state", system.STATE.defaults)
    check_rows(packed, system.STATE, "state", system.name)
    if not packed.size:
        raise KernelArgumentError(
            f"the state has the shape {packed.shape}, which holds no member; expected one or more.",
            found=list(packed.shape),
        )
    finite = np.isfinite(packed)
    if not finite.all():
        place = np.argwhere(~finite)[0]
        component = system.STATE.components[place[0]]
        raise KernelArgumentError(
            f"the initial {component}{tell_member(place)} is {packed[tuple(place)]}; expected a "
            "finite number.",
            found=component,
        )
    return packed


def list_times(t: Any, samples: Any, size: int) -> tuple[float, Array]:
    """The start and the sample times from a pair or a sequence.

    Args:
        t: As given.
        samples: As given.
        size: Numbers in the states of all members.

    Raises:
        KernelArgumentError: They do not increase, there are to be too few samples, or so many that
            memory does not hold them.
    """
    times = as_float64(t, "t")
    _check_increasing(times, t)
    start = float(times[0])
    if times.size > 2:
        _check_memory(size, times.size)
        return start, times.copy()
    check_count(samples=samples)
    if samples == 1:
        return start, times[1:].copy()
    _check_memory(size, int(samples))
    spread = np.linspace(times[0], times[1], int(samples))
    if not (spread[1:] > spread[:-1]).all():
        raise KernelArgumentError(
            f"samples is {samples}, and there are not so many different numbers from {start!r} to "
            f"{float(times[1])!r}; expected fewer samples, or a longer time.",
            found=int(samples),
        )
    return start, spread


def take_ends_of_steps(start: float, times: Array, step: float) -> Array:
    """Those ends of steps that are nearest to evenly spaced times, and the last time.

    What a method keeps it keeps there; between them a path is a cubic, which keeps nothing.

    >>> take_ends_of_steps(0.0, np.linspace(0.0, 1.0, 4), 0.1)
    array([0. , 0.3, 0.7, 1. ])
    >>> take_ends_of_steps(0.0, np.linspace(0.0, 1.0, 1001), 0.25)
    array([0.  , 0.25, 0.5 , 0.75, 1.  ])
    """
    ends = start + np.unique(np.round((times - start) / step)) * step
    return np.append(ends[ends < times[-1] - 0.5 * step], times[-1])


def _check_increasing(times: Array, given: Any) -> None:
    """Times are finite and increase.

    Raises:
        KernelArgumentError: They do not.
    """
    row = times.ndim == 1 and times.size >= 2
    # those between the first and the last are finite where these are
    good = row and bool((times[1:] > times[:-1]).all())
    if not (good and math.isfinite(float(times[-1]) - float(times[0]))):
        falls = row and bool((times[1:] < times[:-1]).all())
        advice = " Runs go forward in time: for the past, give System.ode to an integrator."
        raise KernelArgumentError(
            f"t is {str(given)[:80]}; expected (start, end) or increasing finite times."
            + advice * falls,
            found=str(given)[:80],
        )


def _check_memory(size: int, samples: int) -> None:
    """The states at all samples have room in this machine.

    Raises:
        KernelArgumentError: They have not.
    """
    needed, memory = 8 * size * samples, os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    if needed > memory:
        raise KernelArgumentError(
            f"states of {size} numbers at {samples} samples take {needed / 1e9:.3g} GB, and this "
            f"machine has {memory / 1e9:.3g} GB; expected fewer of them. samples=1 keeps the end "
            "alone.",
            found=needed,
            expected=memory,
        )


def check_positive(**numbers: Any) -> None:
    """Tolerances and steps.

    Raises:
        KernelArgumentError: One is no positive number, or a relative tolerance is 1 or more.
    """
    for name, value in numbers.items():
        most = 1 if name == "rtol" else math.inf
        good = isinstance(value, Real) and not isinstance(value, bool)
        if not good or not 0 < value < most:
            below = " below 1" if name == "rtol" else ""
            raise KernelArgumentError(
                f"{name} is {value!r}; expected a positive number{below}.",
                found=str(value),
                name=name,
            )


def check_steps(request: Request) -> None:
    """Fixed steps reach the end.

    Raises:
        KernelArgumentError: There would be more of them than a trajectory may take.
    """
    if request.step is None:
        return
    count = (float(request.times[-1]) - request.start) / request.step
    if count > request.max_steps * (1 + 1e-6):  # the last step may be longer by so much
        raise KernelArgumentError(
            f"step is {request.step:g}, which makes {count:.4g} steps to the end, and max_steps is "
            f"{request.max_steps}; expected longer steps, or more of them.",
            found=request.step,
            expected=request.max_steps,
        )


def check_count(**numbers: Any) -> None:
    """Numbers of things, which solvers count in floating point.

    Raises:
        KernelArgumentError: One is no integer, less than 1, or more than 2^53.
    """
    for name, value in numbers.items():
        good = isinstance(value, Integral) and not isinstance(value, bool)
        if not good or not 1 <= value <= 2**53:
            raise KernelArgumentError(
                f"{name} is {value!r}; expected a whole number from 1 to 2^53.",
                found=str(value),
                name=name,
            )


def check_progress(progress: Any) -> None:
    """Whether to show a bar, or whom to tell.

    Raises:
        KernelArgumentError: It is neither.
    """
    if not (progress is None or isinstance(progress, bool) or callable(progress)):
        raise KernelArgumentError(
            f"progress is {progress!r}; expected True, False, or a function of the part done.",
            found=str(progress)[:80],
        )


def check_dense(dense: Any) -> bool:
    """Whether steps are to be kept.

    Raises:
        KernelArgumentError: It is neither True nor False.
    """
    if not isinstance(dense, bool | np.bool_):
        raise KernelArgumentError(
            f"dense is {str(dense)[:80]!r}; expected True or False.", found=str(dense)[:80]
        )
    return bool(dense)


def check_newton(newton: Any, name: str) -> bool:
    """Whether Newton's method is to solve the equations of steps.

    Args:
        newton: As given.
        name: The method.

    Raises:
        KernelArgumentError: It is neither True nor False, or steps have no equations.
    """
    if not isinstance(newton, bool | np.bool_):
        raise KernelArgumentError(
            f"newton is {str(newton)[:80]!r}; expected True or False.", found=str(newton)[:80]
        )
    if newton and name not in STRUCTURED:
        raise KernelArgumentError(
            f"newton is True, and the steps of method {name!r} have no equation that Newton's "
            "method could solve; expected an implicit method such as 'midpoint' or 'gauss4', with "
            "step=.",
            found=name,
        )
    return bool(newton)


def find_kind(reconstruct: Any) -> SolverKind:
    """What is integrated: with what is reconstructed below the state where that is asked for."""
    return RECONSTRUCTION if is_asked(reconstruct) else SOLVER


def prefers_dop853(
    system: System, kind: SolverKind, method: Any, step: float | None, rtol: float, obstacle: str
) -> bool:
    """Whether ``"auto"`` is ``dop853`` with tolerances that are `SHARE` of those given.

    Args:
        system: The System.
        kind: What is integrated.
        method: As given.
        step: As given.
        rtol: As given, or the default.
        obstacle: Why generated solvers do not apply or their polynomials are asked for, or "".
    """
    solvers = system._solvers
    if not is_auto(method) or step is not None or obstacle or not solvers.has_files(kind):
        return False
    return solvers.find_costs(kind).is_dop853_faster(rtol)


def choose_method(
    system: System,
    method: Any,
    step: float | None,
    obstacles: Mapping[str, str],
    *,
    tolerances: bool,
) -> Preferred:
    """The method that does it, ``scipy:NAME`` or a generated one, and why it was chosen.

    Args:
        system: The System.
        method: As given.
        step: As given.
        obstacles: Why generated methods do not apply, by name, as far as they do not.
        tolerances: Whether some were given.

    Raises:
        KernelArgumentError: There is no such method, or it does not apply.
    """
    chosen = _prefer(system, method, step, obstacles)
    name = chosen.name
    if name in obstacles:
        asked = f"method {method!r}" if step is None else f"method {method!r} with a fixed step"
        without = " without step" if len(obstacles) == len(_generated()) else ""
        raise KernelArgumentError(
            f"{asked} is a generated solver, which does not apply to {system.name} here: "
            f"{obstacles[name]}. Expected {_list(obstacles)}{without}.",
            found=str(method),
            reason=obstacles[name],
        )
    if name not in _generated() and name not in _scipy():
        raise KernelArgumentError(
            f"method is {method!r}; expected one of {_list(obstacles)} for {system.name}."
            + _suggest(name),
            found=str(method)[:80],
            expected=["auto", *_generated(), *_scipy()],
        )
    _check_step(name, step, tolerances=tolerances)
    return chosen


def _prefer(
    system: System, method: Any, step: float | None, obstacles: Mapping[str, str]
) -> Preferred:
    """The method that is named, or that is taken for a person, whether or not it applies."""
    if is_wish(method):
        return grant_wish(system, method, obstacles)
    if not is_auto(method):
        return Preferred(_normal(method), "")
    if step is not None:
        return find_default(system, obstacles)
    fit = [each for each in ("taylor", "dop853") if each not in obstacles]
    return Preferred((fit or [SCIPY + "DOP853"])[0], "")


def is_chosen_by_structure(method: Any, step: float | None) -> bool:
    """Whether the method may be one of those that keep structure."""
    return (
        is_wish(method) or _normal(method) in _FIXED_STEP or (is_auto(method) and step is not None)
    )


def is_auto(method: Any) -> bool:
    """Whether a method is left to us."""
    return _normal(method) == "auto"


def _normal(method: Any) -> str:
    """The name of a method as it is listed; letters of either case are the same."""
    if not isinstance(method, str):
        return str(method)
    listed, plain = ("auto", *_generated(), *_scipy()), method.lower().replace("-", "_")
    return next((each for each in listed if each.lower() == plain), method)


def _generated() -> tuple[str, ...]:
    """The methods that are generated, those that keep structure the last ones."""
    return (*GENERATED, *_FIXED_STEP)


def _scipy() -> tuple[str, ...]:
    """The methods of SciPy."""
    return tuple(SCIPY + each for each in EXPLICIT + IMPLICIT)


def _list(obstacles: Mapping[str, str]) -> str:
    """The methods that fit."""
    fit = ("auto", *(name for name in _generated() if name not in obstacles), *_scipy())
    return ", ".join(repr(each) for each in fit)


def _suggest(name: str) -> str:
    """The spelling of a method of SciPy, or the nearest name."""
    meant = [each for each in _scipy() if each.lower() == (SCIPY + name).lower()]
    if meant:
        return f" Write method={meant[0]!r} for that of SciPy."
    near = get_close_matches(name, ("auto", *_generated(), *_scipy()), n=1)
    return f" Did you mean {near[0]!r}?" if near else ""


def _check_step(name: str, step: float | None, *, tolerances: bool) -> None:
    """A fixed step where a method needs one, and none where it takes none.

    Raises:
        KernelArgumentError: It is missing, or does not go with the method.
    """
    if step is None and (name == "rk4" or name in _FIXED_STEP):
        raise KernelArgumentError(
            f"method {name!r} has no estimate of its error; expected step=, the length of its "
            "steps.",
            found=None,
        )
    if step is not None and name.startswith(SCIPY):
        raise KernelArgumentError(
            f"step is {step!r}, and method {name!r} chooses its steps by the tolerances; expected "
            "step=None, or one of the methods " + ", ".join(map(repr, _generated())) + ".",
            found=str(step),
        )
    if step is not None and tolerances and name != "taylor":
        raise KernelArgumentError(
            f"step is {step!r}, and tolerances are given, which method {name!r} does not look at "
            "with a fixed step; expected one or the other.",
            found=str(step),
        )
