"""The equations of motion as two functions, in the convention of `scipy.integrate.solve_ivp`.

Comes in: a System with parameters and inputs. Goes out: ``fun(t, y)`` and ``jac(t, y)``, which any
integrator of that convention takes. All but the state is checked once, here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.arrays import as_float64, find_slopes, pack_parameters
from coadjoint.solve.driving import Function, Linear, Previous, make_signal
from coadjoint.solve.noisy import has_noise

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.solve.system import System


class Ode:
    """The equations of motion of a System.

    Args:
        system: The System.
        parameters: As in `System.rhs`, shared by all members.
        inputs: As in `System.simulate`.
        target: Kernel that computes them.

    Attributes:
        system: The System.
        parameters: Packed, ``(k,)``.

    Raises:
        KernelArgumentError: Parameters are of a batch, or something has a wrong name or shape.
    """

    def __init__(self, system: System, parameters: Any, inputs: Any, target: str) -> None:
        if has_noise(system):
            raise KernelArgumentError(
                f"Wiener processes move the state of {system.name}, and integrators of ordinary "
                "equations know none; expected a system without noise. System.simulate follows "
                "its paths.",
                found=system.name,
            )
        self.system, self._target = system, target
        self.parameters = pack_parameters(system, parameters).copy()
        if self.parameters.ndim != 1:
            raise KernelArgumentError(
                f"parameters have the shape {self.parameters.shape}; expected "
                f"({system.PARAMETERS.size},), which all members share.",
                found=list(self.parameters.shape),
            )
        self._signal = make_signal(system, inputs, *_span(inputs))

    def fun(self, t: float, y: Any) -> Array:
        """The rates at a time and a state ``(n,)``, or states ``(n, N)``."""
        return self._call("rhs", t, y)

    def jac(self, t: float, y: Any) -> Array:
        """Their derivatives by the state, ``(n, n)``."""
        return self._call("jacobian", t, y)

    def _call(self, function: str, t: float, y: Any) -> Array:
        driven: dict[str, Any] = {"time": float(t)} if self.system.TIME else {}
        if self._signal is not None:
            driven["inputs"] = self._take_inputs(float(t))
        state = as_float64(y, "y")
        given, driven = (state, self.parameters), {"target": self._target, **driven}
        if function == "jacobian" and function not in self.system.functions:
            return find_slopes(self.system, *given, **driven)
        values: Array = self.system.evaluate(function, *given, **driven)
        return values

    def _take_inputs(self, time: float) -> Array:
        """The inputs at a time.

        Raises:
            KernelArgumentError: They are sampled, and the time is before or after all samples.
        """
        signal = self._signal
        assert signal is not None, "asked for only where there are inputs"
        if isinstance(signal, Previous | Linear):
            first, last = float(signal.times[0]), float(signal.times[-1])
            clock = self.system.clock[0]
            if not first <= time <= last:
                raise KernelArgumentError(
                    f"inputs are sampled from {clock} = {first:g} to {last:g}, and asked for "
                    f"at {clock} = {time:g}; expected a time between, since interpolation beyond "
                    "the range is refused.",
                    found=time,
                    expected=[first, last],
                )
        if not isinstance(signal, Function):
            signal.enter(time)
        return signal.at(time)

    def __repr__(self) -> str:
        return f"<Ode of {self.system.name}: fun(t, y), jac(t, y), n = {self.system.STATE.size}>"


def _span(inputs: Any) -> tuple[float, float]:
    """A time at which inputs are known, twice: that of the first sample."""
    if isinstance(inputs, tuple) and inputs and np.ndim(inputs[0]) == 1 and len(inputs[0]):
        first = float(as_float64(inputs[0], "times of inputs")[0])
        return first, first
    return 0.0, 0.0
