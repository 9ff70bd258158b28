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
from coadjoint.solve.family import FamilySystem
from coadjoint.solve.taken import Enclosed
from coadjoint.solve.terms import Kind, Term, list_components

if TYPE_CHECKING:
    from coadjoint.array_types import Array, Places
    from coadjoint.solve.events import Sought
    from coadjoint.solve.formulas import Formula
    from coadjoint.solve.roots import Function
    from coadjoint.solve.system import System
    from coadjoint.solve.taken import Steps


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

    @property
    def total(self) -> int:
        """All rows."""
        return self.system.STATE.size + self.followed

    def list_rows(self, formula: Formula) -> Places:
        """The rows of the state that a formula depends on."""
        if not self.is_plain(formula):
            return np.arange(self.total)
        found, size = formula.evaluate(self.find_values(formula.names, self.name_all()))
        return np.array(sorted(list_components(found[0]) | list_components(size[0])), np.intp)

    def is_plain(self, formula: Formula) -> bool:
        """Whether no observable that a formula names is computed by loops over a table."""
        observed = self.system.OBSERVABLES
        names = {*observed, *observed.components}
        is_looped = isinstance(self.system, FamilySystem)
        is_looped |= "jacobian_vector" in self.system.functions
        return not (is_looped and names & formula.names)

    def name_all(self) -> Columns:
        """A term for all that a formula may read."""
        own = self.parameters[:, np.newaxis]
        if self.parameters.ndim > 1:
            own = as_column(Term(Kind.PARAMETER, row=row) for row in range(len(own)))
        return Columns(
            states=as_column(Term(Kind.COMPONENT, row=row) for row in range(self.total)),
            time=as_column([Term(Kind.TIME)])[0],
            parameters=own,
            inputs=as_column(Term(Kind.INPUT, row=row) for row in range(self.system.INPUTS.size)),
        )

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
    def observables(self) -> Callable[..., None]:
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


@dataclass
class Columns:
    """Values that are objects which compute as numbers do, such as enclosures over whole steps.

    Attributes:
        states: As `Place` has them, ``(n, 1)``.
        time: Likewise.
        parameters: ``(k, 1)``.
        inputs: ``(m, 1)``.
    """

    states: Array
    time: Array
    parameters: Array
    inputs: Array

    def find_parameters(self, _: Surroundings) -> Array:
        """As `Place.find_parameters`."""
        return self.parameters

    def find_inputs(self, _: Surroundings) -> Array:
        """As `Place.find_inputs`."""
        return self.inputs

    def observe(self, around: Surroundings) -> Array:
        """As `Place.observe`."""
        system = around.system
        given = [self.states[: system.STATE.size, 0], self.parameters[:, 0]]
        given += [self.inputs[:, 0]] if system.INPUTS else []
        given += [self.time] if system.TIME else []
        out = np.empty((system.OBSERVABLES.size, 1), object)
        around.observables(*given, out[:, 0])
        return out


def as_column(values: Iterable[Any]) -> Array:
    """Objects as the rows of an array of one column."""
    listed = list(values)
    column = np.empty((len(listed), 1), object)
    column[:, 0] = listed
    return column


# -- events ---------------------------------------------------------------------------------------


def make_function(sought: Sought, around: Surroundings, steps: Steps) -> Function:
    """The left side of an event minus the right side along steps, with the size of both."""
    level, names = float(sought.event.value), sought.formula.names
    only = around.list_rows(sought.formula)

    def function(rows: Places) -> Callable[[Array], tuple[Array, Array]]:
        follow, size = steps.follow(rows, only), steps.size[rows]
        member, start = steps.member[rows], steps.start[rows]

        def evaluate(part: Array) -> tuple[Array, Array]:
            after = part * size
            states = np.full((around.total, after.size), np.nan)
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
    curved = around.driven is not None and not around.driven.are_lines
    if curved or not around.is_plain(sought.formula):
        return None
    states: dict[int, Enclosure] = {}
    for row in around.list_rows(sought.formula).tolist():
        enclosure = steps.enclose(row)
        if enclosure is None:
            return None
        states[row] = enclosure
    with np.errstate(all="ignore"):
        values = around.find_values(sought.formula.names, _enclose_all(around, steps, states))
        found, terms = (as_enclosure(each[0]) for each in sought.formula.evaluate(values))
        level = float(sought.event.value)
        return Enclosed(found - level, (terms + abs(level)).top)


def _enclose_all(around: Surroundings, steps: Steps, states: dict[int, Enclosure]) -> Columns:
    """The enclosures of all that a formula may read over steps."""
    member, start, own = steps.member, steps.start, around.parameters
    driven: Iterable[Enclosure] = ()
    if around.driven is not None:
        first = around.driven(member, start, start)
        driven = map(
            Enclosure.of_line, first, around.driven(member, start, start + steps.size) - first
        )
    return Columns(
        states=as_column(states.get(row, Enclosure(np.nan)) for row in range(around.total)),
        time=as_column([Enclosure.of_line(start, steps.size)])[0],
        parameters=own[:, np.newaxis]
        if own.ndim == 1
        else as_column(map(Enclosure, own[:, member])),
        inputs=as_column(driven),
    )
