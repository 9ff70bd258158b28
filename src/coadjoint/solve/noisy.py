"""Runs with noise: what `System.simulate` was asked for, where Wiener processes move the state.

Comes in: arguments of a person. Goes out: the method that does it, or an error before any work
starts. Read next: `coadjoint.solve.stochastic`, the methods.
"""

from __future__ import annotations

from numbers import Integral
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.methods import NOISY, PLAIN_WITH_NOISE, STRUCTURED
from coadjoint.solve.preferences import Preferred, find_default

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.request import Request
    from coadjoint.solve.system import System

#: Seeds are below this, members of a batch below the other.
SEEDS, MEMBERS = 2**64, 2**32
#: How far a sample may be from the end of a step, in steps.
_NEAR = 1e-6


def has_noise(system: System) -> bool:
    """Whether Wiener processes move the state."""
    return not {"noise", "noise_vector"}.isdisjoint(system.functions)


def choose_noisy(
    system: System, method: Any, step: float | None, seed: Any, refused: dict[str, Any]
) -> Preferred:
    """The method of a run with noise, and why it was chosen.

    Args:
        system: The System.
        method: As given.
        step: As given.
        seed: As given.
        refused: What else was given that does not go with noise, by the names of arguments.

    Raises:
        KernelArgumentError: It is none for noise, or something is missing or does not go with it.
    """
    name = method.lower() if isinstance(method, str) else method
    chosen = Preferred(name, "")
    if name == "auto":
        chosen = find_default(system, {}, PLAIN_WITH_NOISE)
        name = chosen.name
    listed = ", ".join(map(repr, ("auto", *NOISY)))
    if name not in NOISY:
        raise KernelArgumentError(
            f"method is {method!r}, and Wiener processes move the state of {system.name}; expected "
            f"one of {listed}.",
            found=str(method)[:80],
            expected=["auto", *NOISY],
        )
    for argument, value in refused.items():
        if value:
            raise KernelArgumentError(
                f"{argument} is given, and the paths of {system.name} have noise, for which there "
                f"is no such thing; expected no {argument}.",
                found=str(value)[:80],
                name=argument,
            )
    if step is None:
        raise KernelArgumentError(
            f"method {name!r} has no estimate of its error; expected step=, the length of its "
            "steps.",
            found=None,
        )
    whole = isinstance(seed, Integral) and not isinstance(seed, bool)
    if not (whole and 0 <= int(seed) < SEEDS):
        raise KernelArgumentError(
            f"seed is {seed!r}, and Wiener processes move the state of {system.name}; expected "
            "seed=, a whole number from 0 to 2^64 - 1: the same one gives the same paths.",
            found=str(seed)[:80],
        )
    return chosen


def check_no_noise(system: System, method: Any, seed: Any) -> None:
    """A system without noise has no seed, and no method for it.

    Raises:
        KernelArgumentError: One is given.
    """
    named = isinstance(method, str) and method.lower() in set(NOISY).difference(STRUCTURED)
    if seed is not None or named:
        given = f"method is {method!r}" if named else f"seed is {seed!r}"
        raise KernelArgumentError(
            f"{given}, which is for systems with noise; {system.name} has none. Expected "
            f"{'another method' if named else 'no seed'}.",
            found=str(method if named else seed)[:80],
        )


def check_knots(system: System, request: Request, knots: NDArray[np.float64]) -> None:
    """Inputs change their lines at the ends of steps: a step that ended elsewhere would be another.

    Raises:
        KernelArgumentError: One does not.
    """
    step, times = request.step, knots[(knots > request.start) & (knots < request.times[-1])]
    assert step is not None, "checked before"
    places = (times - request.start) / step
    off = np.abs(places - np.round(places)) > _NEAR
    if off.any():
        time = float(times[int(off.argmax())])
        raise KernelArgumentError(
            f"inputs change at {system.clock[0]} = {time:.12g}, between the ends of steps of "
            f"{step:.12g}, and noise has increments of whole steps; expected inputs at times "
            f"of whole steps after {request.start:g}, or a function of time.",
            found=time,
        )


def check_samples(system: System, request: Request) -> None:
    """Samples lie at the ends of steps, between which nothing is known of a path.

    Raises:
        KernelArgumentError: One does not, or there are too many members.
    """
    step, times = request.step, request.times
    assert step is not None, "checked before"
    places = (times - request.start) / step
    off = np.abs(places - np.round(places)) > _NEAR
    off[-1] = False  # the last step may be shorter
    if off.any():
        time = float(times[int(off.argmax())])
        raise KernelArgumentError(
            f"the sample at {system.clock[0]} = {time:.12g} lies between the ends of steps of "
            f"{step:.12g}, where nothing is known of a path with noise; expected times "
            f"that are whole numbers of steps after {request.start:g}. "
            "Or give t as a pair (start, end).",
            found=time,
        )
    if request.state[0].size > MEMBERS:
        raise KernelArgumentError(
            f"there are {request.state[0].size} members; expected at most 2^32 with noise.",
            found=request.state[0].size,
        )
