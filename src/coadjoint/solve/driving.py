"""Driving: the inputs and the time along one trajectory.

Comes in: what `System.simulate` was given: constants, samples over time with their interpolation,
or a function of time. Goes out: arrays that bound kernels read in place, the values at many times,
and the times at which the inputs jump, where an integrator has to begin anew. Everything that can
be is checked before the first step.
Read next: `coadjoint.solve.simulate`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.errors import KernelArgumentError, KernelTypeError
from coadjoint.solve.arrays import as_float64, pack_inputs

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.solve.system import System

#: How samples say what inputs are between them.
INTERPOLATIONS: Final = ("previous", "linear")
_FORM = 'samples as (times, values, "previous") or (times, values, "linear")'


class Signal:
    """Inputs as a function of time; this one is constant.

    Args:
        values: Shape ``(m,)``.

    Attributes:
        breaks: Where they jump.
    """

    breaks: Sequence[float] = ()

    def __init__(self, values: Array) -> None:
        self.values = values

    def enter(self, time: float) -> None:
        """Begin a stretch between two jumps."""

    def at(self, _: float) -> Array:
        """The values at one time of the stretch, ``(m,)``."""
        return self.values

    def over(self, _: Array) -> Array:
        """The values at many times, ``(m, T)``, or ``(m,)`` if they are constant."""
        return self.values


class Previous(Signal):
    """Samples, each of which holds until the next one."""

    def __init__(self, times: Array, values: Array) -> None:
        self.times, self.values, self._place = times, values, 0
        jumps = (values[:, 1:] != values[:, :-1]).any(axis=0)
        self.breaks = times[1:][jumps].tolist()

    def enter(self, time: float) -> None:
        """Hold the sample of this time, also at the end of the stretch, where the next begins."""
        self._place = int(np.searchsorted(self.times, time, side="right")) - 1

    def at(self, _: float) -> Array:
        """The sample that is held."""
        return np.asarray(self.values[:, self._place])

    def over(self, times: Array) -> Array:
        """The sample before each time."""
        places = np.searchsorted(self.times, times, side="right") - 1
        return np.asarray(self.values[:, places])


class Linear(Signal):
    """Samples with straight lines between them."""

    def __init__(self, times: Array, values: Array) -> None:
        self.times, self.values = times, values

    def at(self, time: float | Array) -> Array:
        """The values at one time, or at many."""
        return np.array([np.interp(time, self.times, row) for row in self.values])

    def over(self, times: Array) -> Array:
        """The values at many times."""
        return self.at(times)


class Function(Signal):
    """Inputs by a function of time, whose values are checked at each call."""

    def __init__(self, system: System, function: Callable[[float], Any]) -> None:
        self.system, self.function = system, function

    def at(self, time: float) -> Array:
        """What the function returns.

        Raises:
            KernelArgumentError: Another shape than ``(m,)``, or no finite number.
        """
        place, given = f"at {self.system.clock[0]} = {time:.12g}", self.function(float(time))
        where = f"of the function inputs {place}"
        if given is None:
            size, wanted = self.system.INPUTS.size, self.system.INPUTS.listed
            raise KernelArgumentError(
                f"{self.system.name}: the function inputs returns None {place}; "
                f"expected ({size},): {wanted}, or values by name. Write return before its value.",
                found="None",
                expected=[size],
            )
        values = _pack(self.system, given, where)
        return _check_one(self.system, values, where)

    def over(self, times: Array) -> Array:
        """What it returns at each time."""
        return np.column_stack([self.at(time) for time in times.tolist()])


class Driving:
    """The inputs and the time of a System along one trajectory.

    Args:
        system: The System.
        given: Constants, samples, or a function of time.
        start: When the trajectory begins.
        end: When it ends.

    Attributes:
        now: Inputs and time as bound kernels read them, by name; as far as the System has them.
        breaks: Times between start and end at which inputs jump.

    Raises:
        KernelArgumentError: A name, shape, value or range that cannot be right.
        KernelTypeError: A type that cannot become float64 without loss.
    """

    def __init__(self, system: System, given: Any, start: float, end: float) -> None:
        self.system, self.now = system, dict[str, Any]()
        self._signal = make_signal(system, given, start, end)
        if self._signal is not None:
            self.now["inputs"] = np.empty(system.INPUTS.size)
        if system.TIME:
            self.now["time"] = np.empty(())
        jumps = self._signal.breaks if self._signal is not None else ()
        self.breaks = tuple(float(time) for time in jumps if start < time < end)
        self.enter(start)

    @property
    def signal(self) -> Signal | None:
        """The inputs as a function of time; None where a system has none."""
        return self._signal

    @property
    def is_constant(self) -> bool:
        """Whether inputs are constants, or there are none."""
        return self._signal is None or type(self._signal) is Signal

    def enter(self, time: float) -> None:
        """Begin a stretch between two jumps, with its values at that time."""
        if self._signal is not None:
            self._signal.enter(time)
        self.at(time)

    def at(self, time: float) -> None:
        """Give `now` the values at a time of this stretch.

        Raises:
            KernelArgumentError: The function of time returns another shape, or no finite number.
        """
        if "time" in self.now:
            self.now["time"][...] = time
        if self._signal is not None:
            self.now["inputs"][:] = self._signal.at(time)

    def over(self, times: Array) -> dict[str, Any]:
        """Inputs and time for functions at many times; a jump belongs to what follows it."""
        driven: dict[str, Any] = {"time": times} if "time" in self.now else {}
        if self._signal is not None:
            driven["inputs"] = self._signal.over(times)
        return driven


class Following:
    """A function of a System along one trajectory: what can be checked is checked once, here.

    Args:
        system: The System.
        function: Name of the function.
        parameters: Packed parameters, ``(k,)``.
        target: Kernel that computes it.
        driving: Inputs and time.

    Attributes:
        state: What it reads.
        values: What it has written last.
    """

    def __init__(
        self, system: System, function: str, parameters: Array, target: Any, driving: Driving
    ) -> None:
        self.state = np.empty(system.rows(function).size)
        self.values = np.empty(system.functions[function])
        named = {"out": self.values, "target": target, **driving.now}
        self._driving = driving
        self._evaluate = system.bind(function, self.state, parameters, **named)

    def __call__(self, time: float, state: Array) -> Array:
        """The values at a time of this stretch and a state; the next call overwrites them."""
        self._driving.at(time)
        return self.at(state)

    def at(self, state: Array) -> Array:
        """The same at the time of the driving; rows below those that are read are left out."""
        self.state[:] = state[: self.state.size]
        self._evaluate()
        return self.values


# -- what was given -----------------------------------------------------------------------------


def make_signal(system: System, given: Any, start: float, end: float) -> Signal | None:
    """The inputs as a function of time; None where a system has none."""
    if not system.INPUTS:
        if given is not None:
            pack_inputs(system, given)  # which refuses them
        return None
    if callable(given):
        return Function(system, given)
    if isinstance(given, tuple) and any(np.ndim(part) for part in given):
        return _sample(system, given, start, end)
    return Signal(_check_one(system, _pack(system, given, ""), "").copy())


def _sample(system: System, given: tuple[Any, ...], start: float, end: float) -> Signal:
    """Samples over the whole of a run.

    Raises:
        KernelArgumentError: The interpolation is not stated, a shape or order is wrong, a value is
            not finite, or the run begins before the first sample or ends after the last.
    """
    kind = given[2] if len(given) == 3 else None
    if kind not in INTERPOLATIONS:
        raise KernelArgumentError(
            f"inputs are a tuple of {len(given)} with the interpolation {kind!r}; expected "
            f"{_FORM}.",
            found=str(kind),
            expected=list(INTERPOLATIONS),
        )
    times = as_float64(given[0], "times of inputs")
    ordered = times.ndim == 1 and times.size > 1 and bool((np.diff(times) > 0).all())
    if not ordered or not np.isfinite(times).all():
        raise KernelArgumentError(
            f"times of inputs are {str(given[0])[:80]}; expected two or more increasing finite "
            "times.",
            found=str(given[0])[:80],
        )
    wanted = (system.INPUTS.size, times.size)
    _check_rows(given[1], wanted)
    values = _pack(system, given[1], "of the samples")
    if values.ndim == 1 and wanted[0] == 1:
        values = values[np.newaxis]
    if values.shape != wanted or not np.isfinite(values).all():
        problem = "are not all finite" if values.shape == wanted else f"have shape {values.shape}"
        raise KernelArgumentError(
            f"samples of inputs {problem}; expected finite numbers of shape {wanted}, one column "
            "for each time.",
            found=list(values.shape),
            expected=list(wanted),
        )
    if not times[0] <= start <= end <= times[-1]:
        raise KernelArgumentError(
            f"inputs are sampled from {system.clock[0]} = {times[0]:g} to {times[-1]:g}, and the "
            f"run is from {start:g} to {end:g}; expected samples over all of it, since "
            "interpolation beyond its range is refused. Add samples, or shorten the run.",
            found=[float(times[0]), float(times[-1])],
            expected=[start, end],
        )
    return Previous(times, values) if kind == "previous" else Linear(times, values)


def _check_rows(given: Any, wanted: tuple[int, int]) -> None:
    """Samples that come as an array have a row for each component.

    Raises:
        KernelArgumentError: They have other rows.
    """
    if not isinstance(given, str | dict) and np.ndim(given) == 2 and len(given) != wanted[0]:
        raise KernelArgumentError(
            f"samples of inputs have shape {np.shape(given)}; expected {wanted}, one row for each "
            "component and one column for each time.",
            found=list(np.shape(given)),
            expected=list(wanted),
        )


def _pack(system: System, given: Any, where: str) -> Array:
    """Inputs as an array, a number for the only one of a system; errors say where."""
    only = system.INPUTS.size == 1 and given is not None and np.ndim(given) == 0
    try:
        return pack_inputs(system, [given] if only and not isinstance(given, dict) else given)
    except (KernelArgumentError, KernelTypeError) as error:
        if not where:
            raise
        raise type(error)(f"values {where.strip()}: {error}", **error.parts) from error


def _check_one(system: System, values: Array, where: str) -> Array:
    """One finite value for each component.

    Raises:
        KernelArgumentError: There are more, or one is not finite.
    """
    size = system.INPUTS.size
    if values.shape != (size,):
        wanted = f"the shape {values.shape}, expected ({size},): "
        wanted += system.INPUTS.listed
        raise KernelArgumentError(
            f"values {where} have {wanted}, which all members share."
            if where
            else f"simulate follows one trajectory; values of inputs have {wanted}. For values "
            f"over time, pass {_FORM}.",
            found=list(values.shape),
            expected=[size],
        )
    if not np.isfinite(values).all():
        place = int(np.argmin(np.isfinite(values)))
        name, value = system.INPUTS.components[place], float(values[place])
        raise KernelArgumentError(
            f"{system.name}: the input {name}{f' {where}' if where else ''} is {value}; expected a "
            "finite number.",
            found=str(value),
            component=name,
        )
    return values
