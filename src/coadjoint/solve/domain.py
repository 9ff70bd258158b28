"""The domain of a System along one trajectory: whether it begins there, and where it leaves.

Comes in: a System whose kernel has a function ``domain``, one set of parameters, and states. Goes
out: an error for a start outside; else the last point of a step that is still inside, and what is
violated beyond it. Read next: `coadjoint.solve.simulate`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.driving import Following

if TYPE_CHECKING:
    from collections.abc import Callable

    from coadjoint.array_types import Array
    from coadjoint.declared import Bound
    from coadjoint.solve.driving import Driving
    from coadjoint.solve.system import System

#: How closely the end of a trajectory is found, as a part of the last step.
RESOLUTION = 1e-12
#: Values that a message shows.
SHOWN = 12
#: What is wrong where surfaces do not touch at one point alone, and what the row is.
_LARGE = (
    "the body is too large for the surface at the point of contact, where it bends less than the "
    "surface does, so that the two cross each other there,"
)
_CONTACT = {
    "rolling_apart": (_LARGE, "the product of the differences of the principal curvatures"),
    "rolling_outside": (_LARGE, "the sum of the differences of the principal curvatures"),
    "rolling_facing": (
        "the body is on the wrong side of the surface, so that the normals at the point of contact "
        "agree",
        "how far the normals are opposite",
    ),
}
_SMALLER = (
    "take a smaller body, as a ball whose radius is less than the radii of curvature of the "
    "surface there, a wider surface, or a state on the other side of it"
)


def explain_bound(bound: Bound) -> tuple[str, str]:
    """What is wrong where a bound does not hold, and what to do, in a system at large."""
    if bound.kind == "contact":
        return _CONTACT[bound.name][0].removesuffix(","), _SMALLER
    what = f"the {bound.label} is not {'above 0' if bound.strict else '0 or more'}"
    return what, "give defaults at which it is"


@dataclass(frozen=True)
class Exit:
    """Where a trajectory leaves the domain.

    Attributes:
        time: The last time at which it is inside.
        state: The state there.
        row: The row that is violated right after it.
    """

    time: float
    state: Array
    row: int


class Domain:
    """Where a System with one set of parameters is defined; everywhere without bounds.

    Args:
        system: The System.
        parameters: Packed parameters, ``(k,)``.
        target: Kernel that computes the rows.
        driving: Inputs and time.
    """

    def __init__(self, system: System, parameters: Array, target: Any, driving: Driving) -> None:
        self.system, self.parameters, self.driving = system, parameters, driving
        self.bounds = system.DOMAIN
        # The least double that a row may be: whatever is above 0, or 0 itself.
        self._least = np.array([np.nextafter(0.0, 1.0) * bound.strict for bound in self.bounds])
        if self.bounds:
            self._evaluate = Following(system, "domain", parameters, target, driving)

    def find_violated(self, time: float, state: Array) -> int | None:
        """The first row that is violated or not finite at a state; None inside the domain."""
        if not self.bounds:
            return None
        rows = self._evaluate(time, state)
        held = (rows >= self._least) & (rows < np.inf)  # neither holds for a NaN
        return None if held.all() else int(np.argmin(held))

    def check_start(self, time: float, state: Array) -> None:
        """Refuse a state outside the domain.

        Raises:
            KernelArgumentError: A condition does not hold, or the motion is singular there.
        """
        row = self.find_violated(time, state)
        if row is None:
            return
        bound, value = self.bounds[row], self._value(row)
        expected = "a finite value above 0" if bound.strict else "a finite value, 0 or more"
        advice = _SMALLER if bound.kind == "contact" else "change one of them"
        raise KernelArgumentError(
            f"{self.system.name}: {self._problem(row)} at the given state: {self._meaning(row)} is "
            f"{value:.6g}; expected {expected}. {self._values(row, state)}: {advice}.",
            found=value,
            expected=expected,
            bound=bound.name,
        )

    def find_exit(
        self,
        path: Callable[[], Callable[[float], Array]],
        before: tuple[float, Array],
        points: Iterable[tuple[float, Array]],
    ) -> Exit | None:
        """Where a step leaves the domain.

        Args:
            path: Makes the interpolant of the step, if it is needed.
            before: Time and state at which the step begins, inside.
            points: Times and states of the step, in order, its end the last.

        Returns:
            The exit before the first point outside; None if all are inside.
        """
        if not self.bounds:
            return None
        start, inside = before[0], before
        for point in points:
            row = self.find_violated(*point)
            if row is not None:
                gap = RESOLUTION * (point[0] - start)
                return self._bisect(path(), inside, point[0], row, gap)
            inside = point
        return None

    def _bisect(
        self,
        path: Callable[[float], Array],
        inside: tuple[float, Array],
        outside: float,
        row: int,
        gap: float,
    ) -> Exit:
        """The last point inside, up to a gap."""
        time, state = inside
        while outside - time > gap:
            middle = (time + outside) / 2
            if not time < middle < outside:  # no double lies between
                break
            between = path(middle)
            beyond = self.find_violated(middle, between)
            if beyond is None:
                time, state = middle, between
            else:
                outside, row = middle, beyond
        return Exit(time, state, row)

    def find_leaving(self, time: float, state: Array, rates: Array) -> int:
        """The row that comes to its end first, from a state close to it on."""
        here, largest = self._evaluate(time, state).copy(), np.abs(rates).max()
        step = 2.0**-20 * max(np.abs(state).max(), 1e-9) / (largest or 1.0)
        loss = here - self._evaluate(time + step, state + step * rates)
        with np.errstate(all="ignore"):
            left = np.where(loss > 0, here / loss, np.where(loss <= 0, np.inf, 0.0))
        return int(np.argmin(left))

    # -- messages -----------------------------------------------------------------------

    def explain_exit(self, exit_: Exit) -> str:
        """Why a trajectory ends at an exit."""
        self.find_violated(exit_.time, exit_.state)
        value = self._value(exit_.row)
        return (
            f"{self._problem(exit_.row)} after {self.system.clock[0]} = {exit_.time:.12g}, where "
            f"{self._meaning(exit_.row)} is still {value:.6g} and "
            f"{self._values(exit_.row, exit_.state)}"
        )

    def describe_nearest(self, time: float, state: Array) -> str:
        """How close to a bound a state is, for trajectories that end inside; "" without bounds."""
        if self.find_violated(time, state) is not None or not self.bounds:
            return ""
        row = int(np.argmin(self._evaluate.values))
        value = self._value(row)
        return f"; there {self._meaning(row)} is {value:.6g} and {self._values(row, state)}"

    def _value(self, row: int) -> float:
        """The value of a row at the state that was looked at last."""
        return float(self._evaluate.values[row])

    def _problem(self, row: int) -> str:
        """What is wrong where a row is violated."""
        bound = self.bounds[row]
        if bound.kind == "condition":
            text = self.system.certificate.get("domain", {}).get(bound.name)
            return f"the condition {bound.name}{f', {text},' if text else ''} does not hold"
        if bound.kind == "contact":
            return _CONTACT[bound.name][0]
        if bound.kind in ("transform", "range"):
            return f"no {bound.name} has these momenta: the Legendre transform has no solution"
        if bound.kind == "iteration":
            return f"Newton's iteration from rest finds no {bound.name} of these momenta"
        if bound.kind == "acceleration":
            return "the reduced mass matrix is singular, or not positive,"
        return f"{bound.name} is undetermined, since constraints vanish or depend on each other,"

    def _meaning(self, row: int) -> str:
        """What the value of a row is."""
        bound = self.bounds[row]
        if bound.kind == "condition":
            return f"the larger side of {bound.name} minus the other"
        if bound.kind == "contact":
            return f"{bound.name}, {_CONTACT[bound.name][1]},"
        if bound.kind in ("transform", "range", "iteration"):
            return f"the {bound.label}"
        return f"the pivot of {bound.name}"

    def _values(self, row: int, state: Array) -> str:
        """The inputs of a row with their values."""
        system, now = self.system, [array.ravel() for array in self.driving.now.values()]
        tables = (system.STATE, system.PARAMETERS, system.INPUTS, system.TIME)
        names = [name for quantities in tables for name in quantities.components]
        values = np.concatenate([state[: system.STATE.size], self.parameters, *now]).tolist()
        known = dict(zip(names, values, strict=True))
        inputs = self.bounds[row].inputs
        told = [f"{name} = {known[name]:.6g}" for name in inputs[:SHOWN]]
        return ", ".join([*told, *(["..."] if len(inputs) > SHOWN else [])])
