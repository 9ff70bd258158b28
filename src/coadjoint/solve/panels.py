"""Panels over time: lines of components, colours of many rows, and the drift below; one time axis.

All stand in one grid, whose margins they share: so each begins and ends where the others do. Names
of lines and bars of colours are parts of their axes, in the margin at the right.
Comes in: a `Solution`, what is drawn of it, and a figure. Goes out: its panels.
Read next: `coadjoint.solve.plot`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.solve.drift import begins_small, tell_drift
from coadjoint.solve.family import FamilySystem
from coadjoint.solve.labels import (
    number_label,
    observable_label,
    symbol_label,
    time_axis,
    unit_label,
)
from coadjoint.solve.maps import Map, draw_map, find_map

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.solution import Solution

    Array = NDArray[np.float64]

#: Colours that stay apart for colour-blind readers (Okabe and Ito, 2008).
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
STYLES = ("solid", "dashed", "dotted", "dashdot")
#: Names in one column of a legend, and lines of one panel.
LEGEND_ROWS, LINES = 14, 28
#: Names in one column at the least, and the height of one, inches.
LEAST_ROWS, LEGEND_ROW = 3, 0.18
#: Names of the drift in one column, and columns of them.
SHORT_LEGEND = 4
#: Where a legend stands: its left edge at the right end of the axes, in the middle of their height.
AT_RIGHT: Final[Mapping[str, Any]] = {"loc": "center left", "bbox_to_anchor": (1.0, 0.5)}
#: Largest change of what is drawn as constant, over its size.
CONSTANT: Final = 1e-7
#: Panels in one column at the most, and the least height of a row, inches.
STACKED, LEAST_HEIGHT = 8, 0.8
#: Parts of the time, of each of which a strip shows the largest change.
PARTS: Final = 200


@dataclass(frozen=True)
class Lines:
    """Components of a quantity as lines."""

    name: str


@dataclass(frozen=True)
class Rows:
    """Values ``(rows, T)`` as colours over time.

    Attributes:
        label: What stands at the bar of colours.
        values: The values.
        places: Where the rows stand, ``(rows,)``.
        axis: What that is.
    """

    label: str
    values: Array
    places: Array
    axis: str


@dataclass(frozen=True)
class Fan:
    """A number of each of many members as lines, the colour of each its place in the row.

    Attributes:
        name: The quantity.
    """

    name: str


Panel = Lines | Rows | Fan | tuple[str, Map]


def list_panels(solution: Solution, without: Sequence[str] = ()) -> list[Panel]:
    """What is drawn over time: the quantities of the state, and the energy density of fields.

    Args:
        solution: The motion.
        without: Quantities that are drawn otherwise.
    """
    found: list[Panel] = []
    most = LEGEND_ROWS if isinstance(solution.system, FamilySystem) else LINES
    for name, quantity in solution.system.STATE.items():
        if name in without:
            continue
        surface = find_map(solution, name)
        if surface is not None:
            found.append((name, surface))
        elif len(quantity.components) <= most:
            found.append(Lines(name))
        elif _are_numbers(solution, name):
            found.append(Fan(name))
        else:
            found.extend(_list_rows(solution, name))
    if any(isinstance(each, Rows) for each in found):
        found.extend(_list_density(solution))
    return found


def _are_numbers(solution: Solution, name: str) -> bool:
    """Whether a quantity is one number of each member, and not a field or a vector."""
    system = solution.system
    if not isinstance(system, FamilySystem) or system.counted != "members":
        return False
    return system.STATE[name].shape == (system.size,)


def _list_rows(solution: Solution, name: str) -> Iterator[Rows]:
    """The rows of a quantity: of equal members and of fields, those of each of its components."""
    system, quantity = solution.system, solution.system.STATE[name]
    if not isinstance(system, FamilySystem):
        places = np.arange(len(quantity.components), dtype=float)
        label = _join(symbol_label(name), unit_label(quantity.unit))
        yield Rows(label, solution[name], places, "component")
        return
    places, axis = place_rows(solution)
    parts = solution[name].reshape(-1, system.size, len(solution))
    names, units = quantity.components[:: system.size], quantity.unit.split(", ")
    if len(units) != len(names):
        units = [quantity.unit] * len(names)
    for part, component, unit in zip(parts, names, units, strict=True):
        symbol = symbol_label(component.partition("[")[0])
        yield Rows(_join(symbol, unit_label(unit)), part, places, axis)


def place_rows(solution: Solution) -> tuple[Array, str]:
    """Where the members of a family stand, and what that is: points of a field at their places."""
    system = solution.system
    assert isinstance(system, FamilySystem), system.name
    places = system.find_coordinates(solution.parameters).get(system.index.name)
    if places is None:
        counted = "member" if system.counted == "members" else "point"
        return np.arange(system.size, dtype=float), counted
    unit = unit_label(solution.unit(system.index.name))
    return places, f"{system.index.name} {unit}".strip()


def _list_density(solution: Solution) -> Iterator[Rows]:
    """The energy of fields along a line, per length."""
    from coadjoint.solve.spectral import find_densities

    system = solution.system
    density = find_densities(solution).get("energy")
    if density is None or not isinstance(system, FamilySystem):
        return
    units = (solution.unit("energy"), solution.unit(system.index.name))
    unit = "/".join(each for each in units if each != "1") if units[0] != "1" else ""
    unit = f"1/{units[1]}" if units[0] == "1" != units[1] else unit
    places, axis = place_rows(solution)
    yield Rows(_join("energy\ndensity", unit_label(unit)), density, places, axis)


def _join(symbol: str, unit: str) -> str:
    return f"{symbol}\n{unit}".rstrip()


def draw_panels(
    figure: Any,
    solution: Solution,
    panels: Sequence[Panel],
    above: tuple[float, ...] = (),
    draw_above: Callable[[Any], object] = lambda place: None,
) -> None:
    """Draw panels, and the drift of invariants below.

    Args:
        figure: An empty figure.
        solution: The motion.
        panels: What is drawn.
        above: The height in inches of what stands above them, if anything does.
        draw_above: Draws that at its place.
    """
    conserved = bool(solution.conserved)
    columns = 1 + (len(panels) > STACKED)
    count = -(-len(panels) // columns)
    width, height = figure.get_size_inches()
    strip = (max(LEAST_HEIGHT, 0.11 * height),) * conserved
    room = height - 0.4 - sum(above) - sum(strip)
    each = max(LEAST_HEIGHT, room / max(count, 1))
    heights = (*above, *(each,) * count, *strip)
    figure.set_size_inches(width, 0.4 + sum(heights))
    grid = figure.add_gridspec(len(heights), columns, height_ratios=heights)
    lead, shared = len(above), None
    if above:
        draw_above(grid[0, :])
    for n, panel in enumerate(panels):
        row, column = n % count, n // count
        place = grid[lead + row, column if columns > 1 else slice(None)]
        if isinstance(panel, tuple):
            draw_map(figure, place, solution, *panel)
            continue
        axes = figure.add_subplot(place, sharex=shared)
        shared = shared or axes
        if isinstance(panel, Rows):
            _draw_rows(axes, solution, panel, named=column == 0)
        elif isinstance(panel, Fan):
            _draw_fan(axes, solution, panel.name)
        else:
            _draw_lines(axes, solution, panel.name, room=each)
        is_last = n == len(panels) - 1 or row == count - 1
        has_strip = conserved and column == 0
        axes.tick_params(labelsize=8, labelbottom=is_last and not has_strip)
        if is_last and not has_strip:
            axes.set_xlabel(time_axis(solution), fontsize=9)
            axes.xaxis.set_in_layout(columns == 1)  # below is room: next to the strip
        _limit_time(axes, solution)
    if conserved:
        axes = figure.add_subplot(grid[-1, 0], sharex=shared)
        draw_drift(axes, solution, is_wide=columns > 1)
        if columns > 1:  # its names stand below the other column
            axes.get_legend().set_in_layout(False)


def _draw_lines(axes: Any, solution: Solution, name: str, room: float) -> None:
    """Components of a quantity against time; a legend stays within the room, inches."""
    quantity = solution.system.STATE[name]
    for stroke, component in zip(_strokes(), quantity.components, strict=False):
        label = symbol_label(component)
        axes.plot(solution.time, solution[component], linewidth=1.0, label=label, **stroke)
    axes.set_ylabel(f"{symbol_label(name)} {unit_label(quantity.unit)}".rstrip(), fontsize=9)
    rows = min(LEGEND_ROWS, max(LEAST_ROWS, int(room / LEGEND_ROW)))
    columns = -(-len(quantity.components) // rows)
    size = 8 if columns == 1 else 7
    axes.legend(fontsize=size, ncols=columns, frameon=False, **AT_RIGHT)
    axes.grid(alpha=0.3)


def _draw_rows(axes: Any, solution: Solution, rows: Rows, *, named: bool) -> None:
    """Values as colours over time, and what the colours mean."""
    low, high = _choose_limits(rows.values)
    colours = axes.pcolormesh(
        solution.time,
        rows.places,
        rows.values,
        cmap="cividis",
        shading="nearest",
        vmin=low,
        vmax=high,
    )
    colours.set_rasterized(True)
    _add_bar(axes, colours, rows.label)
    if named:
        axes.set_ylabel(rows.axis, fontsize=9)


def _draw_fan(axes: Any, solution: Solution, name: str) -> None:
    """A number of each of many members as lines."""
    from matplotlib.collections import LineCollection

    values = np.asarray(solution[name])  # (N, T)
    pieces = [np.stack([solution.time, row], axis=1) for row in values]
    lines = LineCollection(pieces, cmap="viridis", linewidth=0.7)
    lines.set_array(np.arange(len(values)))
    axes.add_collection(lines)
    axes.autoscale_view()
    _add_bar(axes, lines, "member")
    unit = unit_label(solution.system.STATE[name].unit)
    axes.set_ylabel(f"{symbol_label(name)} {unit}".rstrip(), fontsize=9)
    axes.grid(alpha=0.3)


def _add_bar(axes: Any, colours: Any, label: str) -> None:
    """What colours mean, in the margin at the right."""
    margin = axes.inset_axes((1.015, 0.0, 0.018, 1.0))
    bar = axes.figure.colorbar(colours, cax=margin)
    bar.set_label(label, fontsize=8, rotation=0, ha="left", va="center")
    bar.ax.tick_params(labelsize=7)
    bar.ax.yaxis.get_major_locator().set_params(nbins=4)


def _choose_limits(part: Array) -> tuple[float, float]:
    """The values of the first and the last colour: roundings of what is constant have none."""
    low, high = float(np.nanmin(part)), float(np.nanmax(part))
    size = max(abs(low), abs(high)) or 1.0
    if high - low > CONSTANT * size:
        return low, high
    return (low + high - size) / 2, (low + high + size) / 2


def draw_drift(axes: Any, solution: Solution, *, is_wide: bool = False) -> None:
    """Change of each conserved observable relative to its largest size, on a logarithmic axis.

    That of what begins at 0 is drawn as it is: its ratio to its own roundings would be 1. Of each
    part of the time the largest change is drawn, and 0 at the lower edge.

    Args:
        axes: To draw on.
        solution: What is drawn.
        is_wide: Whether there is room for many names at the right.
    """
    curves = {name: _find_change(solution, name) for name in solution.conserved}
    shown = np.concatenate([change for _, change in curves.values()])
    above = shown[np.isfinite(shown) & (shown > 0)]
    low, high = _list_decades(above)
    for n, (stroke, (name, (time, change))) in enumerate(
        zip(_strokes(), curves.items(), strict=False)
    ):
        drift = tell_drift(solution, name)
        largest = number_label(drift) if solution.drift[name] else "no change"
        width = max(0.7, 1.9 - 0.5 * n)  # often equal: the first stays visible below the others
        label = f"{observable_label(solution.system, name)} ({largest})"
        drawn = np.where(change == 0, 10.0**low, change)
        axes.plot(time, drawn, linewidth=width, label=label, **stroke)
    axes.set_yscale("log")
    axes.set_ylim(10.0**low, 10.0**high)
    step = -(-(high - low) // 3)
    decades = range(high, low, -step)
    axes.set_yticks(
        [10.0**low, *(10.0**n for n in decades)], ["0", *(f"$10^{{{n}}}$" for n in decades)]
    )
    axes.yaxis.set_minor_formatter("")
    _limit_time(axes, solution)
    axes.set_xlabel(time_axis(solution), fontsize=9)
    axes.set_ylabel("relative\nchange", fontsize=8)
    axes.tick_params(labelsize=8)
    axes.grid(alpha=0.3)
    names = len(solution.conserved)
    if names > SHORT_LEGEND and not is_wide:  # at the right it would take half of the width
        below = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.6)}
        axes.legend(fontsize=7, ncols=SHORT_LEGEND, frameon=False, **below)
        return
    columns = -(-names // SHORT_LEGEND)
    axes.legend(fontsize=7 if columns == 1 else 6, ncols=columns, frameon=False, **AT_RIGHT)


def _find_change(solution: Solution, name: str) -> tuple[Array, Array]:
    """Times, and the largest change of an observable about each of them over its size."""
    size = float(np.abs(solution[name]).max())
    if not size or begins_small(solution, name):
        size = 1.0
    with np.errstate(invalid="ignore"):  # of what is infinite
        # of a vector or matrix, the largest of the components
        moved = np.abs(solution.change(name)).reshape(-1, len(solution.time))
        change = moved.max(axis=0) / size
    parts = np.array_split(np.arange(len(change)), min(len(change), PARTS))
    at = [part[np.argmax(np.nan_to_num(change[part], nan=-1.0))] for part in parts]
    return solution.time[at], change[at]


def _list_decades(values: Array) -> tuple[int, int]:
    """Powers of ten between which positive values lie: one more below, where 0 is drawn.

    >>> _list_decades(np.array([2e-16, 3e-15])), _list_decades(np.array([]))
    ((-17, -14), (-17, -15))
    """
    if not len(values):
        return -17, -15
    low, high = np.floor(np.log10(values.min())), np.ceil(np.log10(values.max()))
    return int(low) - 1, int(max(high, low + 1))


def _limit_time(axes: Any, solution: Solution) -> None:
    """The time axis from the first sample to the last."""
    axes.coadjoint_time = True
    if len(solution) > 1:
        axes.set_xlim(solution.time[0], solution.time_reached)


def _strokes() -> Iterator[dict[str, str]]:
    """Colours of solid lines, then of dashed ones and so on, again and again."""
    while True:
        for style in STYLES:
            yield from ({"color": colour, "linestyle": style} for colour in COLOURS)
