"""The Solution: one trajectory with names, units, observables and the drift of what is conserved.

Comes in: times and states. Goes out: a record that people index by name, print, plot and export.
"""

from __future__ import annotations

from functools import cached_property
from html import escape
from os import PathLike
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
    ) -> None:
        self.system = system
        self.time = time
        self.state = np.ascontiguousarray(state)
        self.parameters = parameters
        self.status = status
        self.message = message
        self.reconstructed = None if reconstructed is None else np.ascontiguousarray(reconstructed)
        self.inputs = inputs

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
        time = self.time if self.system.TIME else None
        return self.system.observables(self.state, self.parameters, self.inputs, time=time)

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
        """The solution as an `xarray.Dataset` with units.

        Raises:
            KernelArgumentError: xarray is not installed; the message has the pip command.
        """
        try:
            import xarray
        except ImportError as error:
            raise KernelArgumentError(
                "to_xarray needs xarray, which is not installed. "
                "Run `pip install 'coadjoint[data]'`.",
                found="xarray",
            ) from error
        variables: dict[str, Any] = {}
        for quantities, _ in reversed(self._tables):
            for name, quantity in quantities.items():
                lead = [name + "_component"] if quantity.shape else []
                dims = ([*lead, "time"], self[name], {"units": quantity.unit})
                variables[name] = dims
        attributes = {"system": self.system.name, "title": self.system.title, "id": self.system.id}
        return xarray.Dataset(variables, coords={"time": self.time}, attrs=attributes)

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
