"""The Solution: trajectories with names, units, observables and the drift of what is conserved.

Comes in: times and states, of one trajectory or of a batch. Goes out: a record that people index by
name, print, plot and export.
"""

from __future__ import annotations

from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.course import UNTOLD, Course
from coadjoint.solve.ensemble import Status
from coadjoint.solve.occurrences import Events

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from coadjoint.solve.dense_output import Dense
    from coadjoint.solve.kinks import Kinks
    from coadjoint.solve.system import System

    Array = NDArray[np.float64]


class Solution:
    """One trajectory, or a batch of them.

    ``solution["Pi"]`` is ``(3, T)`` or ``(3, *batch, T)``; ``solution["energy"]`` is ``(T,)`` or
    ``(*batch, T)``; a matrix ``solution["R"]`` of shape ``(3, 3)`` is ``(3, 3, T)``. A field
    ``solution["Xi"]`` is ``(3, N, T)`` at the places ``solution["s"]``, ``(N,)``.

    Attributes:
        system: The System that was simulated.
        time: Sample times, ``(T,)``; of one trajectory up to where the integration came.
        state: States, ``(n, T)`` or ``(n, *batch, T)``; NaN where one of a batch did not come.
        parameters: Packed parameters, ``(k,)`` or ``(k, *batch)``.
        course: How they were computed: method, tolerances, steps of each.
        status: ``OK``, ``DOMAIN`` (the motion left where the system is defined; the last sample is
            the last point inside), ``NONFINITE`` (rates or steps are not finite),
            ``STEP_UNDERFLOW`` (no step was small enough), ``MAX_STEPS``, ``EVENT`` (terminal) or
            ``SLIDING`` (both sides of a kink push the motion back to it).
        message: Where it stopped and why, or how many of a batch did; empty if all is well.
        reconstructed: What follows from the motion, ``(k, T)`` or ``(k, *batch, T)``; None if it
            was not asked for.
        inputs: Inputs, ``(m,)`` if they are constant, else ``(m, T)``, or ``(m, *batch, 1)`` if
            each trajectory has constants of its own; None if there are none.
        events: The events that were looked for, by name: times, states and members of each.
        dense: The steps, by which `at` knows the state at any time; None without ``dense=True``.
    """

    def __init__(
        self,
        system: System,
        time: Array,
        state: Array,
        parameters: Array,
        status: str,
        message: str,
        reconstructed: Array | None = None,
        inputs: Array | None = None,
        *,
        course: Course | None = None,
        events: Events | None = None,
        dense: Dense | None = None,
    ) -> None:
        self.system = system
        self.time = time
        self.state = np.ascontiguousarray(state)
        self.parameters = parameters
        self.course = course or UNTOLD
        self._status = status
        self.message = message
        self.reconstructed = None if reconstructed is None else np.ascontiguousarray(reconstructed)
        self.inputs = inputs
        self.events = events or Events()
        self.dense = dense

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled: all but what is computed from the rest on demand."""
        kind = type(self)
        computed = {
            name for name in vars(self) if isinstance(getattr(kind, name, None), cached_property)
        }
        return {name: value for name, value in vars(self).items() if name not in computed}

    def __len__(self) -> int:
        return len(self.time)

    @property
    def batch(self) -> tuple[int, ...]:
        """The shape of the batch; empty for one trajectory."""
        return self.state.shape[1:-1]

    @property
    def status(self) -> Any:
        """How the trajectory ended; of a batch an array of that."""
        if not self.batch:
            return self._status
        names = np.array([each.name for each in Status])
        return names[self.course.codes]

    @property
    def method(self) -> str:
        """The method that computed it: ``taylor``, ``dop853``, ``rk4`` or ``scipy:NAME``."""
        return self.course.method

    @property
    def settings(self) -> dict[str, Any]:
        """How it was made: method, order, tolerances and step, as far as they apply.

        Of a motion with noise there is its seed, and what the method keeps, by its own update, of
        what each path keeps. ``projection`` says onto what states are moved in addition, and when.
        ``stepwise`` says why the steps of a generated method were made in Python, and ``chosen``
        why a method with a fixed step was taken where that was left to us. ``newton`` is there
        where Newton's method solved the equations of steps, and ``derivatives`` where those of
        fields are no differences.
        """
        course = self.course
        names = ("method", "order", "rtol", "atol", "step", "stepwise", "seed")
        told = {name: getattr(course, name) for name in (*names, "keeps", "projection", "chosen")}
        told |= {"newton": True} if course.newton else {}
        told["derivatives"] = self.system.derivatives
        return {name: value for name, value in told.items() if value not in (None, "")}

    @property
    def steps(self) -> Any:
        """Steps that were taken, of a batch an array; None by methods of SciPy."""
        return None if self.course.steps is None else self.course.steps[()]

    @property
    def rejected(self) -> Any:
        """Steps that were tried in vain, of a batch an array; None where SciPy took them."""
        return None if self.course.rejected is None else self.course.rejected[()]

    @property
    def sweeps(self) -> Any:
        """Sweeps of implicit steps, of a batch an array; None of explicit ones.

        Members that C computes together may have some more than each of them needs.
        """
        return None if self.course.sweeps is None else self.course.sweeps[()]

    @property
    def kinks(self) -> Kinks | None:
        """Where the kinks of the rates were met; None where they have none, or from SciPy."""
        return self.course.kinks

    def member(self, *place: int) -> Solution:
        """One trajectory of a batch, as long as it came.

        Args:
            place: Its place in the batch, one number for each axis.

        Raises:
            KernelArgumentError: There is no such member.
        """
        from coadjoint.solve.members import take_member

        return take_member(self, place)

    def at(self, t: ArrayLike) -> Solution:
        """The same motion at other times, by its steps; NaN where one of a batch did not come.

        Args:
            t: A time, or several in any order, within the span of the solution.

        Raises:
            KernelArgumentError: It was simulated without ``dense=True``, or a time is outside.
        """
        from coadjoint.solve.dense_output import evaluate_at

        return evaluate_at(self, t)

    def _check_alone(self, what: str) -> None:
        """Refuse what is of one trajectory.

        Raises:
            KernelArgumentError: This is a batch.
        """
        if self.batch:
            first = ", ".join("0" for _ in self.batch)
            raise KernelArgumentError(
                f"{what} is of one trajectory, and this solution has a batch of the shape "
                f"{self.batch}; expected one of them. Take solution.member({first}).",
                found=list(self.batch),
            )

    def __getitem__(self, name: str) -> Array:
        if name in self.system.names_of_time:
            return self.time
        # A name of the state first: observables may repeat it, never contradict it.
        for quantities, values in self._tables:
            if quantities.has(name):
                rows: Array = values[quantities.rows(name)]
                whole = quantities[name].shape if name in quantities else ()
                return rows.reshape(*whole, *rows.shape[1:]) if len(whole) > 1 else rows
        places = self.system.find_coordinates(self.parameters)
        if name in places:
            return places[name]
        names = [each for quantities, _ in self._tables for each in quantities] + list(places)
        tables = (self.system.RECONSTRUCTED, self.system.RECONSTRUCTED_OBSERVABLES)
        left = [x for table in tables for x in table] if self.reconstructed is None else []
        hint = f" Simulate with reconstruct=True for {', '.join(left)}." if left else ""
        raise KernelArgumentError(
            f"{name!r} is not in this solution; expected one of {', '.join(names)} or "
            f"{self.system.column_of_time!r}.{hint}",
            found=name,
            expected=names,
        )

    def __contains__(self, name: str) -> bool:
        """Whether ``solution[name]`` is there."""
        return (
            name in self.system.names_of_time
            or any(quantities.has(name) for quantities, _ in self._tables)
            or name in self.system.find_coordinates(self.parameters)
        )

    def unit(self, name: str) -> str:
        """The unit of a quantity or component, of the time, or of places along space.

        ``"1"`` if it is dimensionless, ``""`` if the spec does not tell.
        """
        if name in self.system.names_of_time:
            return self.system.unit_of_time
        if name in self.system.lengths:
            return str(self.system.PARAMETERS[self.system.lengths[name]].unit)
        return next(
            str(quantities.of_component(name).unit_of(name))
            for quantities, _ in self._tables
            if quantities.has(name)
        )

    @property
    def _tables(self) -> list[tuple[Any, Array]]:
        followed, inputs = self.reconstructed, self.inputs
        return [
            (self.system.STATE, self.state),
            *([] if followed is None else [(self.system.RECONSTRUCTED, followed)]),
            (self.system.OBSERVABLES, self.observables),
            *self._of_followed,
            *([] if inputs is None else [(self.system.INPUTS, self._over_samples(inputs))]),
        ]

    def _over_samples(self, rows: Array) -> Array:
        """Constants ``(m,)``, series ``(m, T)`` or ``(m, *batch, 1)`` at every sample of each."""
        given = rows.shape[1:] or (1,)
        lead = (1,) * (len(self.batch) + 1 - len(given))
        whole = rows.reshape(len(rows), *lead, *given)
        return np.broadcast_to(whole, (len(rows), *self.batch, len(self)))

    @cached_property
    def attitude_drift(self) -> dict[str, float]:
        """Largest ``| |q|^2 - 1 |`` of each attitude that was reconstructed.

        Nothing but the tolerances of the integration keeps a quaternion at unit length; this says
        how well they did.
        """
        from coadjoint.solve.drift import find_attitude_drift

        return find_attitude_drift(self)

    @cached_property
    def _of_followed(self) -> list[tuple[Any, Array]]:
        """The observables of what is reconstructed, where it is and there are some."""
        name, followed = "reconstructed_observables", self.reconstructed
        if followed is None or name not in self.system.functions:
            return []
        rows = self.evaluate(name, np.concatenate([self.state, followed]))
        return [(self.system.RECONSTRUCTED_OBSERVABLES, rows)]

    @cached_property
    def observables(self) -> Array:
        """Observables along the trajectory, one row per component."""
        if "observables" not in self.system.functions:  # forces alone, and nothing declared
            return self.state[:0]
        return self.evaluate("observables", self.state)

    def evaluate(self, function: str, state: Array, time: Array | None = None) -> Array:
        """A function of the System at states on the way, with the parameters, inputs and times.

        Args:
            function: Its name.
            state: What it takes, ``(n, *batch, T)``.
            time: When they are, if not at the samples.
        """
        shape, inputs, parameters = state.shape[1:], self.inputs, self.parameters
        if self.batch:
            inputs = None if inputs is None else self._over_samples(inputs)[..., : shape[-1]]
            if parameters.ndim > 1:
                wide = parameters[..., np.newaxis]
                parameters = np.broadcast_to(wide, (len(parameters), *shape))
        now = self.time if time is None else time
        times = np.broadcast_to(now, shape) if self.system.TIME else None
        return self.system.evaluate(function, state, parameters, inputs, time=times)

    @cached_property
    def _at_start(self) -> Any:
        """The Solution of the initial states alone, where no sample has them; else None."""
        start = self.course.start
        if start is None:
            return None
        state, time = start.state[..., np.newaxis], np.array([start.time])
        below = None if start.reconstructed is None else start.reconstructed[..., np.newaxis]
        return Solution(self.system, time, state, self.parameters, "", "", below, start.inputs)

    @cached_property
    def drift(self) -> dict[str, Any]:
        """Largest change of each conserved observable, relative to its largest size.

        ``max |q(t) - q(0)| / max |q(t)|``, and 0 for what is zero throughout. Of what is named in
        `absolute_drift` it is ``max |q(t) - q(0)|``, in the unit of q. Of a batch it is an array;
        what a trajectory did not reach is left out.
        """
        from coadjoint.solve.drift import find_drift

        return find_drift(self)

    @property
    def absolute_drift(self) -> tuple[str, ...]:
        """Names of what changes by more than its size at the start, as what begins at 0.

        Its `drift` is the change itself, since the ratio of that to its values says nothing. Of a
        batch it is what does so in one trajectory at least.
        """
        from coadjoint.solve.drift import begins_small

        return tuple(name for name in self.conserved if begins_small(self, name))

    @property
    def conserved(self) -> tuple[str, ...]:
        """Names of the observables that the motion conserves; some only if inputs are constant."""
        from coadjoint.solve.drift import list_conserved

        return list_conserved(self)

    def first(self, name: str) -> Array:
        """The value at the start, ``(..., 1)``, also where no sample has it."""
        return self[name][..., :1] if self._at_start is None else self._at_start[name]

    def change(self, name: str) -> Array:
        """``q(t) - q(0)`` of an observable or state component, ``(T,)`` or ``(*batch, T)``."""
        with np.errstate(invalid="ignore"):  # infinite values give NaN, as they should
            return self[name] - self.first(name)

    @property
    def time_reached(self) -> Any:
        """The last time that was reached; of a batch an array."""
        return self.course.reached if self.batch else float(self.time[-1])

    @property
    def final(self) -> dict[str, Any]:
        """The last state by component; of a batch arrays, of what could be followed to there."""
        names = self.system.STATE.components
        if self.batch:
            last = self.state[..., -1] if self.course.last is None else self.course.last
            return dict(zip(names, last, strict=True))
        return dict(zip(names, self.state[:, -1].tolist(), strict=True))

    def frames(self, *, moving: bool = False) -> Array:
        """The group elements along a strand, ``(n, n, N + 1, *batch, T)``, from 1 at s = 0 on.

        The last one is the holonomy, whose trace is conserved up to the order of the differences.
        Between ends there are N of them, and the holonomy is conserved where they are clamped.

        Args:
            moving: Whether the element at s = 0 is 1 at the first sample alone and moves by the
                velocity there: g(s, t), as of a rod in space. It is followed from sample to sample,
                with an error of the sixth power of their distance.

        Raises:
            KernelArgumentError: The system is no strand, or has no velocities to move by.
        """
        from coadjoint.solve.strands import find_frames

        return find_frames(self, moving=moving)

    def traces(self) -> dict[str, Array]:
        """The traces of holonomies around a circle of fields, ``(*batch, T)`` each, by their names.

        Of a strand that of its strain, ``dpsi/ds = psi Xi``; of a Lax pair that of L for each of
        the declared values of its spectral parameter, ``L(1/2)``. They are conserved by the fields,
        and by N points up to the order of the differences.

        Raises:
            KernelArgumentError: The system has no connection around a circle.
        """
        from coadjoint.solve.strands import find_traces

        return find_traces(self)

    def summary(self) -> dict[str, Any]:
        """Final state and drift as plain JSON values, of one trajectory."""
        from coadjoint.solve.summary import summarize

        self._check_alone("a summary")
        return summarize(self)

    def to_xarray(self) -> Any:
        """The solution as an `xarray.Dataset` with units; see `coadjoint.solve.datasets`.

        Raises:
            KernelArgumentError: xarray is not installed; the message has the pip command.
        """
        from coadjoint.solve.datasets import to_xarray

        return to_xarray(self)

    def to_netcdf(self, path: str | PathLike[str]) -> None:
        """Write `to_xarray` as a NetCDF 3 file, whole or not at all.

        Raises:
            KernelArgumentError: xarray is not installed; the message has the pip command.
            OutputError: The file cannot be written.
        """
        from coadjoint.solve.datasets import to_netcdf

        to_netcdf(self, Path(path))

    @classmethod
    def from_netcdf(cls, system: System, path: str | PathLike[str]) -> Solution:
        """The solution that `to_netcdf` wrote, to the last bit.

        Args:
            system: The System that it is of.
            path: The file.

        Raises:
            KernelArgumentError: xarray is not installed, the file cannot be read, or it is not a
                solution of this System.
        """
        from coadjoint.solve.datasets import read_netcdf

        return read_netcdf(system, Path(path))

    def to_pandas(self) -> Any:
        """A `pandas.DataFrame` of one row per time and one column per component.

        A batch has one row per member and time. ``attrs`` has what `to_csv` writes above the table.

        Raises:
            KernelArgumentError: pandas is not installed; the message has the pip command.
        """
        from coadjoint.solve.tables import to_pandas

        return to_pandas(self)

    def to_csv(self, path: str | PathLike[str]) -> None:
        """Write a table of one row per time, whole or not at all.

        Lines that begin with ``#`` stand above it: system, parameters, settings and units. Numbers
        have the digits that read back to the same bits.

        Raises:
            OutputError: The file cannot be written.
        """
        from coadjoint.solve.tables import to_csv

        to_csv(self, Path(path))

    @classmethod
    def from_csv(cls, system: System, path: str | PathLike[str]) -> Solution:
        """The solution that `to_csv` wrote, to the last bit.

        Args:
            system: The System that it is of.
            path: The file.

        Raises:
            KernelArgumentError: The file cannot be read or is not a solution of this System.
        """
        from coadjoint.solve.tables import read_csv

        return read_csv(system, Path(path))

    def plot(self, path: str | PathLike[str] | None = None) -> Any:
        """Draw the trajectory and the drift of its invariants below; see `coadjoint.solve.plot`.

        Args:
            path: Picture file to write; None to return the figure for showing.
        """
        from coadjoint.solve.plot import plot

        self._check_alone("a picture")
        return plot(self, path)

    def animate(
        self,
        path: str | PathLike[str],
        *,
        seconds: float = 8.0,
        progress: Callable[[int, int], object] = lambda done, total: None,
    ) -> None:
        """Draw the trajectory as a film, evenly in time; see `coadjoint.solve.animation`.

        Args:
            path: File to write; its ending is .gif, .mp4 or .html.
            seconds: How long the film is.
            progress: Told of every picture: pictures done, pictures in all.
        """
        from coadjoint.solve.animation import animate

        self._check_alone("a film")
        animate(self, path, seconds=seconds, progress=progress)

    def trace(self, path: str | PathLike[str] | None = None) -> Any:
        """Draw the path of (x, y) on the plane; see `coadjoint.solve.trace`.

        Args:
            path: Picture file to write; None to return the figure for showing.
        """
        from coadjoint.solve.trace import trace

        self._check_alone("a picture")
        return trace(self, path)

    def __repr__(self) -> str:
        from coadjoint.solve.drift import describe_drift

        first, *others = self.describe()
        lines = [f"<Solution of {first}>", *(f"  {each}" for each in others)]
        return "\n".join([*lines, *describe_drift(self)])

    def describe(self) -> list[str]:
        """What it is of and how it ended, and what is to be said of how it was computed."""
        last = f" .. {self.time[-1]:g}" if len(self) > 1 else ""
        count = f"{len(self)} samples" if last else "1 sample"
        span = f"{count}, {self.system.clock[0]} = {self.time[0]:g}{last}"
        if self.batch:
            whole = "x".join(map(str, self.batch))
            lines = [f"{self.system.name}: {whole} trajectories, {span}"]
            lines += [self.message] if self.message else []
        else:
            lines = [f"{self.system.name}: {self.status}, {span}"]
        course = self.course
        told = (course.tell_stepwise(), course.tell_chosen(), course.tell_keeps())
        return [*lines, *filter(None, told)]

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        from coadjoint.notebook import show_solution

        return show_solution(self)
