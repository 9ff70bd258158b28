"""The constraints that a System keeps, along one trajectory: where it begins, and how it stays.

Comes in: a System whose kernel has a function ``projection``, one set of parameters, and states.
Goes out: an error for a start off the constraints; else states on them. An integrator keeps a
residual to its own accuracy in each step, and without the projection that adds up: the wheels
of the snakeboard slip by 3e-11 m/s after ten seconds, and by more after a hundred.
Read next: `coadjoint.derive.mechanics.projection`.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.driving import Following

if TYPE_CHECKING:
    from collections.abc import Callable

    from coadjoint.array_types import Array
    from coadjoint.declared import Quantity
    from coadjoint.solve.driving import Driving
    from coadjoint.solve.system import System

#: How far off the constraints a start may be, for digits that were typed; as for attitudes.
TYPED = 1e-9
#: Projections after which a state is on the constraints, or will not be.
SETTLING = 20
#: Methods that go on from the last state and its rate alone; others hold earlier steps as well.
ONE_STEP = ("DOP853", "RK45", "RK23", "Radau")


def describe_projection(system: System, method: str) -> str:
    """Onto what states are moved, and when; "" for a System whose states are not.

    Args:
        system: The System.
        method: As `Course.method` has it.
    """
    if "projection" not in system.functions:
        return ""
    kept = dict.fromkeys(system.certificate.get("constraints", {}).values())
    name = method.removeprefix("scipy:")
    when = "at each sample"
    if name == method or name in ONE_STEP:
        when = f"after each step and {when}"
    return f"{when}, onto {', '.join(kept) or 'the constraints'}"


def find_excess(
    system: System, state: Array, residuals: Callable[[Array], Array], atol: float
) -> Array:
    """How much farther off the constraints states are than by roundings; not positive on them.

    Roundings of a residual are what it comes to where each component is off by `TYPED` of those of
    its unit. A velocity that is 0 has no roundings of its own size; it has those of its fellows.

    Args:
        system: Whose constraints they are.
        state: ``(n, ...)``.
        residuals: Of the constraints at states of this shape.
        atol: What the run takes for nothing.
    """
    units = np.array([unit for q in system.STATE.values() for unit in _list_units(system, q)])
    largest = {unit: np.abs(state[units == unit]).max(axis=0) for unit in dict.fromkeys(units)}
    here = residuals(state)
    with np.errstate(invalid="ignore"):
        off = np.abs(here)
        for row in range(0, len(state), system.members):  # equal members have equal units
            size = largest[units[row]]
            step = 2.0**-20 * np.where(size > 0, size, 1.0)
            moved = state.copy()
            moved[row : row + system.members] += step
            off -= np.abs(residuals(moved) - here) / step * (TYPED * size + atol)
    return off


def _list_units(system: System, quantity: Quantity) -> list[str]:
    """The unit of each row of a quantity, which equal members share."""
    units = [part.strip() for part in quantity.unit.split(",")]
    count = len(quantity.components)
    if len(units) * system.members == count:
        return [unit for unit in units for _ in range(system.members)]
    return [quantity.unit] * count


def settle(
    system: System,
    state: Array,
    residuals: Callable[[Array], Array],
    project: Callable[[Array], Array],
) -> Array | None:
    """States on the constraints, by as many projections as it takes; None where they do not help.

    One is enough but for attitudes that are far from rotations.
    """
    for _ in range(SETTLING):
        if not (find_excess(system, state, residuals, 0.0) > 0).any():
            return state
        state = project(state)
    return None


class Constraints:
    """What a System with one set of parameters keeps; nothing for most systems.

    Args:
        system: The System.
        parameters: Packed parameters, ``(k,)``.
        target: Kernel that computes residuals and projections.
        driving: Inputs and time.
    """

    def __init__(self, system: System, parameters: Array, target: Any, driving: Driving) -> None:
        self.system, self.parameters, self.target = system, parameters, target
        self.driving = driving
        self.any = "projection" in system.functions
        if self.any:
            self._project = Following(system, "projection", parameters, target, driving)

    # -- along the way ------------------------------------------------------------------

    def project(self, time: Any, state: Array) -> Array:
        """New states on the constraints, ``(n, ...)``, at a time or at one for each of them.

        What is reconstructed may follow, and stays.

        Where constraints come to depend on each other there is no nearest state, and the given one
        is returned.
        """
        if not self.any:
            return state.copy()
        moved, own = state.copy(), state[: self.system.STATE.size]
        if state.ndim > 1:
            driving = self.driving.over(time)
            nearest = self.system.projection(own, self.parameters, target=self.target, **driving)
        else:  # at each step: without the checks, which take as long as five evaluations
            nearest = self._project(time, own)
        moved[: len(own)] = np.where(np.isfinite(nearest).all(axis=0), nearest, own)
        return moved

    def move_onto(self, solver: Any) -> Array:
        """The state after a step of SciPy, on the constraints; a one-step method goes on there."""
        state = self.project(solver.t, solver.y)
        if self.any and type(solver).__name__ in ONE_STEP:
            solver.y, solver.f = state, solver.fun(solver.t, state)
        return state

    def project_path(self, dense: Callable[[], Callable[[Any], Array]]) -> Callable[[Any], Array]:
        """The interpolant of a step, its states on the constraints."""
        path = dense()
        return lambda t: self.project(t, path(t))

    # -- the start ----------------------------------------------------------------------

    def find_start(self, time: float, state: Array, atol: float) -> Array:
        """A start on the constraints, from one that is off them by roundings at the most.

        Args:
            time: When it is.
            state: The given start.
            atol: What the run takes for nothing.

        Raises:
            KernelArgumentError: It is farther off.
        """
        if not self.any:
            return state
        off = find_excess(self.system, state, self._residuals, atol)
        row = int(np.argmax(off))
        if off[row] > 0:
            raise self._refusal(time, state, row, atol)
        return self.project(time, state)

    def _residuals(self, states: Array) -> Array:
        now = self.driving.now
        return self.system.constraint_residual(states, self.parameters, target=self.target, **now)

    def _refusal(self, time: float, state: Array, row: int, atol: float) -> KernelArgumentError:
        """What is wrong with a start, and where it would be right."""
        residual = float(self._residuals(state)[row])
        listed = list(self.system.certificate.get("constraints", {}).items())
        kind, member = divmod(row, self.system.members)
        constraint = " {}, {},".format(*listed[kind]) if kind < len(listed) else f" {row + 1}"
        constraint += f" of member {member}," if self.system.members > 1 else ""
        return KernelArgumentError(
            f"{self.system.name}: the constraint{constraint} does not hold at the given state: "
            f"left minus right is {residual:.6g}; expected 0.{self._advise(time, state)}",
            found=residual,
            expected=0,
        )

    def _advise(self, time: float, state: Array) -> str:
        """A state on the constraints that is near, if there is one."""
        once = self.project(time, state)
        near = settle(self.system, once, self._residuals, partial(self.project, time))
        if near is None:
            return " Give a state that is on them."
        moved = zip(self.system.STATE.components, state, near, strict=True)
        told = ", ".join(f"{name} = {to:.12g}" for name, given, to in moved if to != given)
        how = " (System.projection gives it)" if near is once else ""
        return f" The nearest state on the constraints has {told}: begin there{how}."
