"""Events: where a formula of the state has a value, as a person asks for them.

Comes in: names of quantities, formulas such as ``"Gamma3 == 0.5"``, or `Event` records. Goes out:
the same, checked.
Read next: `coadjoint.solve.surroundings`, which makes functions of the steps of an integration of
them, and `coadjoint.solve.lookout`, which looks for them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from numbers import Integral, Real
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.errors import KernelArgumentError

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.solve.formulas import Formula, Rows
    from coadjoint.solve.system import System

#: Names of the time where a system does not declare one of its own.
TIME: Final = ("t", "time")


@dataclass(frozen=True)
class Event:
    """What to look for along trajectories: where a formula has a value.

    Attributes:
        formula: A component, a scalar quantity, or a formula of these, of parameters, inputs and
            the time ``t``, in the language of specs. It may be an equation, ``"a == b"``.
        value: What the formula is to be, if it is no equation.
        direction: 1 for those where the left side rises through the right one, -1 where it falls;
            0 for all, those where it touches among them.
        terminal: Whether the first one ends the trajectory; or a number, of which the last does.
        name: Under which a Solution has them; the formula as given if it is empty.
        tolerance: Differences of both sides that count as zero. None for that of the integration,
            ``atol + rtol * size``, the size of both sides being the sum of the magnitudes of their
            terms.
    """

    formula: str
    value: float = 0.0
    direction: int = 0
    terminal: bool | int = False
    name: str = ""
    tolerance: float | None = None


@dataclass(frozen=True)
class Sought:
    """An event of one run, checked.

    Attributes:
        event: As given, its name filled in.
        formula: Left side minus right side; the value of the event is left out.
    """

    event: Event
    formula: Formula

    @property
    def limit(self) -> int:
        """The number of the occurrence that ends a trajectory; 0 for none."""
        return int(self.event.terminal)

    def make_band(self, rtol: float, atol: float) -> Callable[[Array], Array]:
        """What counts as zero, by the size of the terms."""
        given = self.event.tolerance
        if given is not None:
            return lambda size: np.full(size.shape, given)
        return lambda size: atol + rtol * size


# -- what was asked for ---------------------------------------------------------------------------


def read_events(system: System, given: Any, *, followed: bool = False) -> tuple[Sought, ...]:
    """The events that were asked for, checked.

    Args:
        system: The System.
        given: None, one of them, or several: texts and `Event` records.
        followed: Whether what is reconstructed may be named.

    Raises:
        KernelArgumentError: One cannot be right.
    """
    if given is None:
        return ()
    listed = [given] if isinstance(given, str | Event) else _list(given)
    sought = tuple(_read(system, each, followed=followed) for each in listed)
    names = [each.event.name for each in sought]
    for name in names:
        if names.count(name) > 1:
            raise KernelArgumentError(
                f"two events have the name {name!r}; expected names of their own. Give "
                'Event(..., name="...").',
                found=name,
            )
    return sought


def _list(given: Any) -> list[Any]:
    """Several events.

    Raises:
        KernelArgumentError: It is something else.
    """
    if not isinstance(given, list | tuple):
        raise KernelArgumentError(
            f"events is {str(given)[:80]!r}; expected a formula such as 'x == 0', an Event, or a "
            "list of these.",
            found=str(given)[:80],
        )
    return list(given)


def _read(system: System, given: Any, *, followed: bool) -> Sought:
    """One event.

    Raises:
        KernelArgumentError: A type, number, name or formula that cannot be right.
    """
    event = Event(formula=given) if isinstance(given, str) else given
    if not isinstance(event, Event) or not isinstance(event.formula, str):
        raise KernelArgumentError(
            f"an event is {str(given)[:80]!r}; expected a formula such as 'x == 0', or an Event.",
            found=str(given)[:80],
        )
    event = replace(event, name=event.name or event.formula.strip())
    label = f"event {event.name!r}"
    _check_numbers(event, label)
    text, is_equation = _subtract(event.formula, label)
    if is_equation and event.value:
        raise KernelArgumentError(
            f"{label} is an equation, and its value is {event.value!r}; expected one or the other.",
            found=event.formula,
        )
    from coadjoint.solve.formulas import Formula  # the reader of specs, for events alone
    from coadjoint.solve.units import check_units

    members = _list_members(list_named(system, followed=followed))
    formula = Formula(text, list_names_of(system, followed=followed), label, members)
    _check_moves(system, formula, label)
    check_units(formula, list_named(system, followed=followed), system.unit_of_time, label)
    return Sought(event, formula)


def _check_numbers(event: Event, label: str) -> None:
    """The fields of an event that are numbers.

    Raises:
        KernelArgumentError: One is out of range, or no number.
    """
    positive = event.tolerance is None or (_is_real(event.tolerance) and event.tolerance > 0)
    is_count = isinstance(event.terminal, Integral) and event.terminal >= 0
    for name, good, expected in (
        ("value", _is_real(event.value), "a finite number"),
        ("direction", event.direction in (-1, 0, 1), "-1, 0 or 1"),
        ("terminal", is_count, "True, False, or which occurrence ends the trajectory, 1 or more"),
        ("tolerance", positive, "a positive number, or None"),
    ):
        if not good:
            found = getattr(event, name)
            raise KernelArgumentError(
                f"{label}: {name} is {found!r}; expected {expected}.", found=str(found), name=name
            )


def _is_real(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)


def _subtract(text: str, label: str) -> tuple[str, bool]:
    """Left side minus right side of a text, and whether it was an equation.

    Raises:
        KernelArgumentError: An inequality, or two signs.
    """
    if any(sign in text for sign in "<>!"):
        raise KernelArgumentError(
            f"{label}: an event is where two sides are equal; expected a formula, or 'a == b'. For "
            'those in one direction give Event("a == b", direction=1).',
            found=text,
        )
    sides = text.replace("==", "=").split("=")
    if len(sides) == 1:
        return text, False
    if len(sides) > 2 or not all(side.strip() for side in sides):
        raise KernelArgumentError(
            f"{label}: expected one equals sign with a formula on each side, as in 'a == b'.",
            found=text,
        )
    return f"{sides[0]} - ({sides[1]})", True


def list_named(system: System, *, followed: bool) -> list[Any]:
    """The quantities that an event of a System may name."""
    tables = [system.STATE, *([system.RECONSTRUCTED] if followed else []), system.OBSERVABLES]
    tables += [system.PARAMETERS, system.INPUTS, system.TIME]
    return [quantity for table in tables for quantity in table.values()]


def _list_members(quantities: Iterable[Any]) -> dict[str, Rows]:
    """What the names of quantities of equal members stand for; empty for other systems."""
    from coadjoint.solve.formulas import Rows

    found: dict[str, Rows] = {}
    for each in quantities:
        if each.shape and each.components[0].endswith("[0,0]"):  # of a plane, one component
            found.setdefault(each.name, Rows(each.name, numbers=2))
        if each.shape and each.components[0].endswith("[0]"):
            found.setdefault(each.name, Rows(each.name))
            firsts = each.components[:: each.shape[-1]]
            for place, first in zip(np.ndindex(*each.shape[:-1]), firsts, strict=True):
                found.setdefault(first.removesuffix("[0]"), Rows(each.name, place))
    return found


def list_names_of(system: System, *, followed: bool) -> dict[str, tuple[int, ...]]:
    """The shape of each name that an event of a System may use."""
    scope = list_scope(list_named(system, followed=followed))
    return scope | {name: () for name in TIME if name not in scope}


def _check_moves(system: System, formula: Formula, label: str) -> None:
    """Refuse what is constant along every motion.

    Raises:
        KernelArgumentError: It depends on nothing that changes.
    """
    from coadjoint.spec.core.faults import list_names

    fixed = list_scope(system.PARAMETERS.values())
    steady = (q for q in system.OBSERVABLES.values() if q.conserved and not q.while_constant)
    own = list_scope(system.STATE.values())
    kept = {name: shape for name, shape in list_scope(steady).items() if name not in own}
    if formula.names <= fixed.keys() | kept.keys():
        told = sorted(formula.names & kept.keys())
        reason = f"the motion conserves {list_names(told)}" if told else "it names no variable"
        raise KernelArgumentError(
            f"{label} is constant along each trajectory, since {reason}; expected a formula of "
            f"what changes, such as {system.STATE.components[0]!r}.",
            found=formula.text,
        )


def list_scope(quantities: Iterable[Any]) -> dict[str, tuple[int, ...]]:
    """The shape of each quantity and component, by name; the first of a name counts."""
    scope: dict[str, Any] = {}
    for quantity in quantities:
        scope.setdefault(quantity.name, quantity.shape)
        for component in quantity.components:
            scope.setdefault(component, ())
    return scope


def explain_unknown(name: str, names: list[str]) -> KernelArgumentError:
    """What to say of a name that has no value at events."""
    from coadjoint.spec.core.faults import did_you_mean, list_names

    return KernelArgumentError(
        f"{name!r} is not known at events; expected one of {list_names(names)} or 'time'. "
        f"{did_you_mean(name, names)}".rstrip(),
        found=name,
        expected=names,
    )
