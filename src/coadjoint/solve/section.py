"""Pictures of sections: states at events, one component over another.

Comes in: the events of a solution. Goes out: a matplotlib figure, or a picture file. Where the
event is the passage through a surface, the picture is a Poincare section.
"""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.events import TIME, explain_unknown
from coadjoint.solve.labels import unit_label
from coadjoint.solve.panels import COLOURS
from coadjoint.solve.plot import begin_figure, finish

if TYPE_CHECKING:
    from collections.abc import Sequence

    from coadjoint.solve.occurrences import Events, Occurrences
    from coadjoint.solve.system import System

#: The least part of its own size by which a component varies that is drawn by default.
VARIES = 1e-9


def draw_section(
    events: Events,
    path: str | PathLike[str] | None = None,
    axes: Sequence[str] | None = None,
) -> Any:
    """Draw the states at events.

    Args:
        events: What to draw: each event in a colour.
        path: File to write (PNG, PDF or SVG by its ending); None to return the figure.
        axes: The names of two components of state or observables. None for the two components of
            the state that vary most at the events, relative to their sizes.

    Raises:
        KernelArgumentError: There is no event, an axis is unknown, matplotlib is not installed, or
            it does not know the ending.
        OutputError: The file cannot be written.
    """
    drawn = [each for each in events.values() if len(each)]
    if not drawn:
        raise KernelArgumentError(
            "there is no event to draw; expected one or more. Simulate longer, or look for another "
            "formula.",
            found=0,
        )
    across, up = _check_axes(drawn, axes)
    figure = begin_figure(path)
    plane = figure.add_subplot()
    size = 9.0 if max(map(len, drawn)) < 500 else 2.0
    for number, each in enumerate(drawn):
        colour = COLOURS[number % len(COLOURS)]
        label = f"{each.event.name} ({len(each)})"
        plane.scatter(each[across], each[up], s=size, color=colour, linewidths=0, label=label)
    components = drawn[0].system.STATE
    for name, label in ((across, plane.set_xlabel), (up, plane.set_ylabel)):
        known = name in components.components
        unit = components.of_component(name).unit_of(name) if known else ""
        label(f"{name} {unit_label(unit)}".rstrip(), fontsize=9)
    plane.tick_params(labelsize=8)
    plane.grid(alpha=0.3)
    plane.legend(fontsize=8, frameon=False, loc="best")
    return finish(figure, drawn[0], path)


def _check_axes(drawn: Sequence[Occurrences], axes: Sequence[str] | None) -> tuple[str, str]:
    """The names of two axes.

    Raises:
        KernelArgumentError: There are not two, or one is no component.
    """
    if axes is None:
        return _choose_axes(drawn)
    system = drawn[0].system
    return check_axes(system, axes, followed=len(drawn[0].state) > system.STATE.size)


def check_axes(system: System, axes: Sequence[str], *, followed: bool) -> tuple[str, str]:
    """The names of two components, for axes.

    Args:
        system: Whose they are.
        axes: As given.
        followed: Whether something is reconstructed.

    Raises:
        KernelArgumentError: There are not two, or one is no component.
    """
    if isinstance(axes, str) or len(axes) != 2:
        raise KernelArgumentError(
            f"axes is {axes!r}; expected the names of two components.", found=str(axes)[:80]
        )
    tables = [system.STATE, *([system.RECONSTRUCTED] if followed else []), system.OBSERVABLES]
    known = [name for table in tables for name in table.components]
    vectors = {name: each for table in tables for name, each in table.items() if each.shape}
    for name in axes:
        if name in vectors and name not in known:
            raise KernelArgumentError(
                f"{name!r} has {len(vectors[name].components)} components; expected one of them "
                "for an axis.",
                found=name,
            )
        if name not in known and name not in TIME:
            raise explain_unknown(name, known)
    return axes[0], axes[1]


def _choose_axes(drawn: Sequence[Occurrences]) -> tuple[str, str]:
    """The two components of the state that vary most, in the order of the state."""
    names = drawn[0].system.STATE.components
    states = np.concatenate([each.state[: len(names)] for each in drawn], axis=1)
    size = np.maximum(np.abs(states).max(axis=1), np.finfo(float).tiny)
    # what is kept at zero by the event varies by its roundings alone
    spread = np.where(size > VARIES * size.max(), np.ptp(states, axis=1) / size, 0.0)
    first, second = sorted(np.argsort(-spread, kind="stable")[:2].tolist())
    return names[first], names[second]
