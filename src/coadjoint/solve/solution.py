"""The Solution: one trajectory with names, units, observables and the drift of what is conserved.

Comes in: times and states. Goes out: a record that people index by name, print, plot and export.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from html import escape
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.system import System

    Array = NDArray[np.float64]


class Solution:
    """One trajectory.

    ``solution["Pi"]`` is ``(3, T)``, ``solution["Pi1"]`` and ``solution["energy"]`` are ``(T,)``.

    Attributes:
        system: The System that was simulated.
        time: Sample times, ``(T,)``, up to where the integration came.
        state: States, ``(n, T)``.
        parameters: Packed parameters, ``(k,)``.
        status: ``OK``, ``DOMAIN`` (the motion left where the system is defined; the last sample is
            the last point inside), ``NONFINITE`` (the rates stopped being finite),
            ``STEP_UNDERFLOW`` (no step was small enough for the tolerances) or ``MAX_STEPS``.
        message: Where it stopped and why, empty if all is well.
        reconstructed: What follows from the motion, ``(k, T)``; None if it was not asked for.
        inputs: Inputs, ``(m,)`` if they are constant, else ``(m, T)``; None if there are none.
        settings: How it was made: method, tolerances and target, plain JSON values by name.
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
        settings: Mapping[str, Any] | None = None,
    ) -> None:
        self.system = system
        self.time = time
        self.state = np.ascontiguousarray(state)
        self.parameters = parameters
        self.status = status
        self.message = message
        self.reconstructed = None if reconstructed is None else np.ascontiguousarray(reconstructed)
        self.inputs = inputs
        self.settings = dict(settings or {})

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled: all but what is computed from the rest on demand."""
        kind = type(self)
        computed = {
            name for name in vars(self) if isinstance(getattr(kind, name, None), cached_property)
        }
        return {name: value for name, value in vars(self).items() if name not in computed}

    def __len__(self) -> int:
        return len(self.time)

    def __getitem__(self, name: str) -> Array:
        if name in ("t", "time"):
            return self.time
        # A name of the state first: observables may repeat it, never contradict it.
        for quantities, values in self._tables:
            if name in quantities or name in quantities.components:
                rows: Array = values[quantities.rows(name)]
                return rows
        names = [each for quantities, _ in self._tables for each in quantities]
        left = self.system.RECONSTRUCTED if self.reconstructed is None else ()
        hint = f" Simulate with reconstruct=True for {', '.join(left)}." if left else ""
        raise KernelArgumentError(
            f"{name!r} is not in this solution; expected one of {', '.join(names)} or 'time'."
            f"{hint}",
            found=name,
            expected=names,
        )

    def __contains__(self, name: str) -> bool:
        """Whether ``solution[name]`` is there."""
        return name in ("t", "time") or any(
            name in quantities or name in quantities.components for quantities, _ in self._tables
        )

    def unit(self, name: str) -> str:
        """The unit of a quantity or component; ``"1"`` if dimensionless, ``""`` if not stated."""
        return next(
            str(quantities.of_component(name).unit_of(name))
            for quantities, _ in self._tables
            if name in quantities or name in quantities.components
        )

    @property
    def _tables(self) -> list[tuple[Any, Array]]:
        followed = self.reconstructed
        return [
            (self.system.STATE, self.state),
            *([] if followed is None else [(self.system.RECONSTRUCTED, followed)]),
            (self.system.OBSERVABLES, self.observables),
            *([] if self.inputs is None else [(self.system.INPUTS, self._inputs_over_time)]),
        ]

    @property
    def _inputs_over_time(self) -> Array:
        """The inputs at every sample, ``(m, T)``."""
        assert self.inputs is not None, "asked for only where there are some"
        whole = self.inputs[:, np.newaxis] if self.inputs.ndim == 1 else self.inputs
        return np.broadcast_to(whole, (len(whole), len(self)))

    @cached_property
    def attitude_drift(self) -> dict[str, float]:
        """Largest ``| |q|^2 - 1 |`` of each attitude that was reconstructed.

        Nothing but the tolerances of the integration keeps a quaternion at unit length; this says
        how well they did.
        """
        if self.reconstructed is None:
            return {}
        turning = (q for q in self.system.RECONSTRUCTED.values() if q.shape == (4,))
        return {q.name: float(np.abs((self[q.name] ** 2).sum(axis=0) - 1).max()) for q in turning}

    @cached_property
    def observables(self) -> Array:
        """Observables along the trajectory, one row per component."""
        if "observables" not in self.system.functions:  # forces alone, and nothing declared
            return self.state[:0]
        return self.evaluate("observables", self.state)

    def evaluate(self, function: str, state: Array) -> Array:
        """A function of the System at states on the way, with the parameters, inputs and times.

        Args:
            function: Its name.
            state: What it takes, ``(n, *batch, T)``.
        """
        batch = state.shape[1:]
        parameters, inputs = self.parameters, self.inputs
        if parameters.ndim > 1:  # of each member, at all its samples
            parameters = np.broadcast_to(parameters[..., np.newaxis], (len(parameters), *batch))
        if inputs is not None and inputs.ndim == state.ndim - 1 > 1:
            inputs = np.broadcast_to(inputs[..., np.newaxis], (len(inputs), *batch))
        time = np.broadcast_to(self.time, batch) if self.system.TIME else None
        return self.system.evaluate(function, state, parameters, inputs, time=time)

    @cached_property
    def drift(self) -> dict[str, float]:
        """Largest change of each conserved observable, relative to its largest size.

        ``max |q(t) - q(0)| / max |q(t)|``, and 0 for what is zero throughout.
        """
        return {name: _relative(self.change(name), self[name]) for name in self.conserved}

    @property
    def conserved(self) -> tuple[str, ...]:
        """Names of the observables that the motion conserves; some only if inputs are constant."""
        inputs = self.inputs
        steady = inputs is None or inputs.ndim == 1 or bool((inputs == inputs[:, :1]).all())
        quantities = self.system.OBSERVABLES.values()
        return tuple(q.name for q in quantities if q.conserved and (steady or not q.while_constant))

    def change(self, name: str) -> Array:
        """``q(t) - q(0)`` of an observable or state component, ``(T,)``."""
        values = self[name]
        with np.errstate(invalid="ignore"):  # infinite values give NaN, as they should
            return values - values[..., :1]

    @property
    def time_reached(self) -> float:
        """The last time that was reached."""
        return float(self.time[-1])

    @property
    def final(self) -> dict[str, float]:
        """The last state by component."""
        names = self.system.STATE.components
        return dict(zip(names, self.state[:, -1].tolist(), strict=True))

    @property
    def _last_inputs(self) -> dict[str, float]:
        """The last inputs by component."""
        names = self.system.INPUTS.components
        return dict(zip(names, self._inputs_over_time[:, -1].tolist(), strict=True))

    def summary(self) -> dict[str, Any]:
        """Final state and drift as plain JSON values."""
        parameters = zip(self.system.PARAMETERS.components, self.parameters.tolist(), strict=True)
        return {
            "system": self.system.name,
            "status": self.status,
            "message": self.message,
            "time": self.time_reached,
            "samples": len(self),
            "parameters": dict(parameters),
            "final": self.final,
            "drift": self.drift,
            **({} if self.inputs is None else {"inputs": self._last_inputs}),
        } | ({"attitude_drift": self.attitude_drift} if self.attitude_drift else {})

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

        return plot(self, path)

    def trace(self, path: str | PathLike[str] | None = None) -> Any:
        """Draw the path of (x, y) on the plane; see `coadjoint.solve.trace`.

        Args:
            path: Picture file to write; None to return the figure for showing.
        """
        from coadjoint.solve.trace import trace

        return trace(self, path)

    def __repr__(self) -> str:
        lines = [
            f"<Solution of {self.system.name}: {self.status}, {len(self)} samples, "
            f"t = {self.time[0]:g} .. {self.time_reached:g}>"
        ]
        lines += [f"  drift of {name}: {value:.1e}" for name, value in self.drift.items()]
        lines += [f"  |{name}|^2 - 1: {value:.1e}" for name, value in self.attitude_drift.items()]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        return f"<pre>{escape(repr(self))}</pre>"


def _relative(change: Array, values: Array) -> float:
    """Largest change over largest size."""
    size = float(np.abs(values).max())
    with np.errstate(invalid="ignore"):
        return float(np.abs(change).max() / size) if size else 0.0
