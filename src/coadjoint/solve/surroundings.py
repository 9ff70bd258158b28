"""Surroundings: the values of the names of formulas, at points of steps and over whole steps.

Comes in: the steps of an integration, with its parameters and inputs. Goes out: an event as a
function of steps, by `make_function`, and as an enclosure over each of them, by `enclose`.
Read next: `coadjoint.solve.crossings`, which finds the events.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from coadjoint.render.targets.modules import KernelModule
from coadjoint.solve.driving import Function as InputFunction
from coadjoint.solve.driving import Previous, Signal
from coadjoint.solve.enclosures import Enclosure, as_enclosure
from coadjoint.solve.taken import Enclosed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.events import Sought
    from coadjoint.solve.roots import Function
    from coadjoint.solve.system import System
    from coadjoint.solve.taken import Steps

    Array = NDArray[np.float64]
    Places = NDArray[np.intp]


@dataclass(frozen=True)
class Driven:
    """Inputs of members along their steps.

    Attributes:
        signal: Inputs over time, or constants of each member, ``(m, *batch)``.
    """

    signal: Signal | Array

    @property
    def are_lines(self) -> bool:
        """Whether they are straight lines over each step."""
        return not isinstance(self.signal, InputFunction)

    def __call__(self, member: Places, start: Array, time: Array) -> Array:
        """Inputs ``(m, P)`` of members at times of steps that began at others."""
        signal = self.signal
        if isinstance(signal, np.ndarray):
            return np.ascontiguousarray(signal.reshape(len(signal), -1)[:, member])
        # a jump at the end of a step belongs to the next
        values = signal.over(start if isinstance(signal, Previous) else time)
        values = values[:, np.newaxis] if values.ndim == 1 else values
        return np.ascontiguousarray(np.broadcast_to(values, (len(values), len(time))))


@dataclass(frozen=True)
class Surroundings:
    """What the names of a formula mean besides the state.

    Attributes:
        system: The System.
        parameters: ``(k,)``, or ``(k, N)``.
        driven: Inputs; None where there are none.
        followed: Rows of what is reconstructed, which stand below the state.
    """

    system: System
    parameters: Array
    driven: Driven | None
    followed: int = 0

    def list_rows(self, names: Iterable[str]) -> Places:
        """The rows of the state that names of a formula depend on."""
        system, n = self.system, self.system.STATE.size
        chosen = np.zeros(n + self.followed, bool)
        for name in names:
            if name in system.STATE or name in system.STATE.components:
                chosen[:n][system.STATE.rows(name)] = True
            elif name in system.OBSERVABLES or name in system.OBSERVABLES.components:
                chosen[:n] = True
            elif name in system.RECONSTRUCTED or name in system.RECONSTRUCTED.components:
                chosen[n:] = True
        return np.flatnonzero(chosen)

    def find_values(self, names: Iterable[str], place: Place) -> dict[str, Array]:
        """The value of each name at a place, ``(*shape, P)``."""
        system, wanted = self.system, set(names)
        n = system.STATE.size
        tables: list[tuple[Any, Callable[[], Array]]] = [
            (system.STATE, lambda: place.states[:n]),
            (system.RECONSTRUCTED, lambda: place.states[n:]),
            (system.OBSERVABLES, lambda: place.observe(self)),
            (system.PARAMETERS, lambda: place.find_parameters(self)),
            (system.INPUTS, lambda: place.find_inputs(self)),
            (system.TIME, lambda: place.time[np.newaxis]),
        ]
        found: dict[str, Array] = {}
        for quantities, rows in tables:
            if quantities is system.RECONSTRUCTED and not self.followed:
                continue
            here = [name for name in wanted if name in quantities or name in quantities.components]
            values = rows() if here else place.time
            for name in here:
                found[name] = _shape(values[quantities.rows(name)], quantities, name)
            wanted -= set(here)
        return found | dict.fromkeys(wanted, place.time)

    @cached_property
    def _observables(self) -> Callable[..., None]:
        """The observables of the NumPy kernel, for numbers of any kind."""
        return KernelModule(self.system, "kernel.py").function("_observables")


def _shape(rows: Array, quantities: Any, name: str) -> Array:
    """Rows of a quantity as its vector or matrix; of a component as they are."""
    if name in quantities and len(quantities[name].shape) > 1:
        return rows.reshape(*quantities[name].shape, -1)
    return rows


# -- where values are asked for -------------------------------------------------------------------


class Place(Protocol):
    """Where values are asked for.

    Attributes:
        states: States, below them what is reconstructed, ``(n, P)``.
        time: When it is, ``(P,)``.
    """

    states: Array
    time: Array

    def find_parameters(self, around: Surroundings) -> Array:
        """Parameters, ``(k, P)`` or ``(k, 1)``."""
        ...

    def find_inputs(self, around: Surroundings) -> Array:
        """Inputs, ``(m, P)``."""
        ...

    def observe(self, around: Surroundings) -> Array:
        """Observables, ``(r, P)``."""
        ...


@dataclass
class Points:
    """Points of steps.

    Attributes:
        states: As `Place` has them.
        time: Likewise.
        member: Whose each is, ``(P,)``.
        start: When the step began in which it is, ``(P,)``.
    """

    states: Array
    time: Array
    member: Places
    start: Array

    def find_parameters(self, around: Surroundings) -> Array:
        """As `Place.find_parameters`."""
        own = around.parameters
        return own[:, np.newaxis] if own.ndim == 1 else own[:, self.member]

    def find_inputs(self, around: Surroundings) -> Array:
        """As `Place.find_inputs`."""
        assert around.driven is not None, "asked for only where there are inputs"
        return around.driven(self.member, self.start, self.time)

    def observe(self, around: Surroundings) -> Array:
        """As `Place.observe`."""
        shared = around.parameters.ndim == 1
        return observe(
            around.system,
            self.states[: around.system.STATE.size],
            around.parameters if shared else self.find_parameters(around),
            None if around.driven is None else self.find_inputs(around),
            self.time,
        )


def observe(
    system: System, states: Array, parameters: Array, inputs: Array | None, time: Array
) -> Array:
    """Observables of states ``(n, P)``, by the NumPy kernel, so that all targets agree."""
    return system.evaluate(
        "observables",
        np.ascontiguousarray(states),
        parameters,
        inputs,
        time=time if system.TIME else None,
        target="numpy",
    )


class Stretches:
    """Whole steps: all values are enclosures, ``(..., 1)``.

    Args:
        steps: The steps.
        states: The enclosures of the components that a formula reads, by row.
        total: How many rows there are.
    """

    def __init__(self, steps: Steps, states: dict[int, Enclosure], total: int) -> None:
        self._steps = steps
        self.states = _as_column(states.get(row) for row in range(total))
        self.time = _as_column([Enclosure.of_line(steps.start, steps.size)])[0]

    def find_parameters(self, around: Surroundings) -> Array:
        """As `Place.find_parameters`."""
        own = around.parameters
        if own.ndim == 1:
            return own[:, np.newaxis]
        return _as_column(Enclosure(row) for row in own[:, self._steps.member])

    def find_inputs(self, around: Surroundings) -> Array:
        """As `Place.find_inputs`."""
        assert around.driven is not None, "asked for only where there are inputs"
        member, start = self._steps.member, self._steps.start
        first = around.driven(member, start, start)
        last = around.driven(member, start, start + self._steps.size)
        return _as_column(map(Enclosure.of_line, first, last - first))

    def observe(self, around: Surroundings) -> Array:
        """As `Place.observe`."""
        system = around.system
        given = [self.states[: system.STATE.size, 0], self.find_parameters(around)[:, 0]]
        given += [self.find_inputs(around)[:, 0]] if system.INPUTS else []
        given += [self.time] if system.TIME else []
        out = np.empty((system.OBSERVABLES.size, 1), object)
        around._observables(*given, out[:, 0])
        return out


def _as_column(values: Iterable[Any]) -> Array:
    """Objects as the rows of an array of one column."""
    listed = list(values)
    column = np.empty((len(listed), 1), object)
    column[:, 0] = listed
    return column


# -- events ---------------------------------------------------------------------------------------


def make_function(sought: Sought, around: Surroundings, steps: Steps) -> Function:
    """The left side of an event minus the right side along steps, with the size of both."""
    level, names = float(sought.event.value), sought.formula.names
    only = around.list_rows(names)
    total = around.system.STATE.size + around.followed

    def function(rows: Places) -> Callable[[Array], tuple[Array, Array]]:
        follow, size = steps.follow(rows, only), steps.size[rows]
        member, start = steps.member[rows], steps.start[rows]

        def evaluate(part: Array) -> tuple[Array, Array]:
            after = part * size
            states = np.empty((total, after.size))
            states[only] = follow(after).reshape(len(only), after.size)
            begun = np.broadcast_to(start, after.shape).ravel()
            whose = np.broadcast_to(member, after.shape).ravel()
            points = Points(states, begun + after.ravel(), whose, begun)
            found, terms = sought.formula.evaluate(around.find_values(names, points))
            value = np.broadcast_to(found - level, after.size).reshape(after.shape)
            return value, np.broadcast_to(terms + abs(level), after.size).reshape(after.shape)

        return evaluate

    return function


def enclose(sought: Sought, around: Surroundings, steps: Steps) -> Enclosed | None:
    """The left side of an event minus the right side over steps; None where nothing is known."""
    if around.driven is not None and not around.driven.are_lines:
        return None
    states: dict[int, Enclosure] = {}
    for row in around.list_rows(sought.formula.names).tolist():
        enclosure = steps.enclose(row)
        if enclosure is None:
            return None
        states[row] = enclosure
    whole = Stretches(steps, states, around.system.STATE.size + around.followed)
    with np.errstate(all="ignore"):
        values = around.find_values(sought.formula.names, whole)
        found, terms = (as_enclosure(each[0]) for each in sought.formula.evaluate(values))
        level = float(sought.event.value)
        return Enclosed(found - level, (terms + abs(level)).top)
