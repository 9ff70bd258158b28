"""Pictures of a trajectory: on its momentum sphere or in components, invariants' drift below.

Comes in: a `Solution`. Goes out: a matplotlib figure, or a picture file. matplotlib is an extra and
is imported here alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.files import check_writable, write_whole
from coadjoint.solve.drift import begins_small, tell_drift
from coadjoint.solve.family import FamilySystem
from coadjoint.solve.labels import observable_label, symbol_label, unit_label
from coadjoint.solve.maps import draw_map, find_map, is_globe
from coadjoint.solve.rolling_bodies import RollingBody, box_of, draw_rolling, find_rolling
from coadjoint.solve.scenes import (
    Paths,
    angles,
    choose_view,
    draw_coloured,
    energy_levels,
    faces_viewer,
    find_paths,
    find_sphere,
)
from coadjoint.solve.vehicles import Vehicle, draw_vehicle, find_vehicle

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.occurrences import Occurrences
    from coadjoint.solve.solution import Solution

    Array = NDArray[np.float64]

#: Colours that stay apart for colour-blind readers (Okabe and Ito, 2008).
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
STYLES = ("solid", "dashed", "dotted", "dashdot")
#: Names in one column of a legend, and lines of one panel.
LEGEND_ROWS, LINES = 14, 28
#: Where a legend stands: its left edge at the right end of the axes, in the middle of their height.
AT_RIGHT: Final[Mapping[str, Any]] = {"loc": "center left", "bbox_to_anchor": (1.0, 0.5)}
#: Largest change of what is drawn as constant, over its size.
CONSTANT: Final = 1e-7
#: Pictures of members, one above the other.
STACKED = 3


def plot(solution: Solution, path: str | PathLike[str] | None = None) -> Any:
    """Draw a solution.

    Args:
        solution: What to draw.
        path: File to write (PNG, PDF or SVG by its ending); None to return the figure.

    Raises:
        KernelArgumentError: matplotlib is not installed, or does not know the ending.
        OutputError: The file cannot be written.
    """
    figure = begin_figure(path)
    _draw_all(figure, solution)
    if path is None:
        figure = _shown_once(figure)
    return finish(figure, solution, path)


def draw(solution: Solution, *others: Solution) -> Any:
    """The figure alone, which no display knows of; on a sphere other paths, too."""
    figure = new_figure(headless=True)
    _draw_all(figure, solution, *others)
    figure.suptitle(solution.system.title, fontsize=13)
    return figure


def _draw_all(figure: Any, solution: Solution, *others: Solution) -> None:
    """The motion, as the system asks for it, and the drift of its invariants in a strip below."""
    scene = find_scene(solution)
    strip = 0.2 if scene is None else 0.14  # drift is no third of a picture
    if isinstance(scene, str | RollingBody) or (
        isinstance(scene, Paths) and scene.members.shape[1] == 3
    ):
        figure.set_size_inches(7.2, 6.4)
    elif any(is_globe(solution, name) for name in solution.system.STATE):
        figure.set_size_inches(7.2, 5.6)  # maps of the sphere are half as high as they are wide
    conserved = bool(solution.conserved)
    grid = figure.add_gridspec(1 + conserved, 1, height_ratios=[1.0, strip][: 1 + conserved])
    match scene:
        case Paths():
            _draw_paths(figure, grid[0], solution, scene)
        case RollingBody():
            _draw_rolling(figure, grid[0], solution, scene)
        case str():
            _draw_sphere(figure.add_subplot(grid[0], projection="3d"), scene, solution, *others)
        case Vehicle():
            _draw_vehicle(figure, grid[0], solution, scene)
        case None:
            _draw_components(figure, grid[0], solution)
    if conserved:
        _draw_drift(figure.add_subplot(grid[1]), solution)


def find_scene(solution: Solution) -> Paths | RollingBody | Vehicle | str | None:
    """What a motion is drawn as: orbits, a body, the name of a vector on its sphere, a vehicle.

    None of what is drawn in components.
    """
    paths = find_paths(solution) if len(solution) > 1 else None
    return paths or find_rolling(solution) or find_sphere(solution) or find_vehicle(solution)


def _shown_once(figure: Any) -> Any:
    """A figure that a notebook shows as the value of a cell, and not at the end of it again."""
    from matplotlib import pyplot as plt

    if "inline" in plt.get_backend():
        plt.close(figure)
    return figure


def begin_figure(path: str | PathLike[str] | None) -> Any:
    """An empty figure for a path, which is checked first; for None, one that pyplot can show."""
    if path is not None:
        check_picture(Path(fspath(path)))
    return new_figure(headless=path is not None)


def new_figure(*, headless: bool) -> Any:
    """An empty figure; without a path, one that pyplot can show."""
    try:
        if headless:
            from matplotlib.figure import Figure

            return Figure(figsize=(7.2, 7.6), layout="constrained", dpi=150)
        from matplotlib import pyplot as plt

        return plt.figure(figsize=(7.2, 7.6), layout="constrained")
    except ImportError as error:
        raise KernelArgumentError(
            "plot needs matplotlib, which is not installed. Run `pip install 'coadjoint[plot]'`.",
            found="matplotlib",
        ) from error


def finish(figure: Any, solution: Solution | Occurrences, path: str | PathLike[str] | None) -> Any:
    """The figure under the title of the system; or None, once it is written to a path."""
    figure.suptitle(solution.system.title, fontsize=13)
    return figure if path is None else _save(figure, Path(fspath(path)))


def _save(figure: Any, path: Path) -> None:
    """Write the picture, whole or not at all."""
    with write_whole(path) as place:
        figure.savefig(place, format=path.suffix.removeprefix(".").lower())


def check_picture(path: Path) -> None:
    """A picture can be written at a path, as far as that shows without drawing it.

    Raises:
        KernelArgumentError: matplotlib is not installed, or does not know the ending.
        OutputError: The folder is missing or not writable, or the path is a folder.
    """
    figure = new_figure(headless=True)
    endings = sorted(figure.canvas.get_supported_filetypes())
    if path.suffix.removeprefix(".").lower() not in endings:
        raise KernelArgumentError(
            f"{path} cannot be drawn: its ending is {path.suffix!r}. "
            "Expected an ending such as .png, .pdf or .svg.",
            found=path.suffix,
            expected=endings,
        )
    check_writable(path)


def _draw_paths(figure: Any, place: Any, solution: Solution, paths: Paths) -> None:
    """Orbits in the plane or in space; of several members each has a colour of its own."""
    in_space = paths.members.shape[1] == 3
    axes = figure.add_subplot(place, projection="3d" if in_space else None)
    several = len(paths.members) > 1
    for n, path in enumerate(paths.members):
        colour = COLOURS[n % len(COLOURS)]
        if several:
            label = symbol_label(paths.labels[n]) if paths.labels else f"member {n}"
            axes.plot(*path, color=colour, linewidth=1.1, label=label)
        else:
            lines = draw_coloured(axes, path, solution.time)
            _time_bar(figure, axes, lines, solution)
        own = {"color": colour} if several else {"color": "#000000"}
        axes.plot(*path[:, -1:], marker="o", markersize=5, linestyle="", **own)
        axes.plot(*path[:, :1], marker="o", markersize=5, fillstyle="none", linestyle="", **own)
    if paths.linked:
        rods = np.concatenate([np.zeros((1, 3)), paths.members[:, :, -1]]).T  # (3, joints)
        axes.plot(*rods, color="#000000", linewidth=2.0, zorder=1, label="rods at the end")
    axes.coadjoint_path = paths.members
    _limit_space(axes, paths)
    if several:
        axes.legend(fontsize=8, frameon=False, **AT_RIGHT)
    axes.set_title("open circle: start, filled: end", fontsize=9, color="#5b6570")


def _draw_vehicle(figure: Any, place: Any, solution: Solution, vehicle: Vehicle) -> None:
    """A vehicle in the plane, and the trace of the point that its place is."""
    axes = figure.add_subplot(place)
    lines = draw_coloured(axes, vehicle.place, solution.time)
    _time_bar(figure, axes, lines, solution)
    axes.coadjoint_body = draw_vehicle(axes, vehicle)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel(f"x {unit_label(vehicle.unit)}", fontsize=9)
    axes.set_ylabel(f"y {unit_label(vehicle.unit)}", fontsize=9)
    axes.tick_params(labelsize=8)
    axes.grid(alpha=0.3)


def _draw_rolling(figure: Any, place: Any, solution: Solution, body: RollingBody) -> None:
    """A body on its plane with the trace of its contact, all lengths to one scale."""
    axes = figure.add_subplot(place, projection="3d")
    lines = draw_coloured(axes, body.contact, solution.time, zorder=2, linewidth=1.6)
    _time_bar(figure, axes, lines, solution)
    axes.coadjoint_body = draw_rolling(axes, body)
    low, high = box_of(body)
    for limit, least, most in zip(
        (axes.set_xlim, axes.set_ylim, axes.set_zlim), low, high, strict=True
    ):
        limit(least, most)
    _style_space(axes, [f"{name} {unit_label(body.unit)}" for name in "xyz"])
    axes.set_box_aspect(high - low, zoom=1.15)
    axes.zaxis.get_major_locator().set_params(nbins=2)
    axes.set_title(
        "trace: the contact, coloured by time; gray line: the centre of mass\n"
        "blue sectors: the body, pale before its end"
        + ("" if body.is_flat else "; orange cap: where its third axis leaves it"),
        fontsize=9,
        color="#5b6570",
    )


def _limit_space(axes: Any, paths: Paths) -> None:
    """Equal scales, and a view of the plane of the motion."""
    low, high = paths.members.min(axis=(0, 2)), paths.members.max(axis=(0, 2))
    if paths.linked:  # the fixed point is seen, too
        low, high = np.minimum(low, 0.0), np.maximum(high, 0.0)
    middle, half = (low + high) / 2, 0.55 * float((high - low).max()) or 1.0
    limits = (axes.set_xlim, axes.set_ylim, *([axes.set_zlim] if len(middle) == 3 else []))
    for limit, centre in zip(limits, middle, strict=True):
        limit(centre - half, centre + half)
    labels = [f"{symbol_label(name)} {unit_label(paths.unit)}" for name in paths.names]
    if len(labels) == 3:
        whole = np.concatenate(list(paths.members), axis=1)
        axes.view_init(*angles(choose_view(whole - whole.mean(axis=1, keepdims=True))))
        _style_space(axes, labels)
        return
    axes.set_aspect("equal")
    axes.set_xlabel(labels[0], fontsize=9)
    axes.set_ylabel(labels[1], fontsize=9)
    axes.tick_params(labelsize=8)
    axes.grid(alpha=0.3)


def _time_bar(figure: Any, axes: Any, lines: Any, solution: Solution) -> None:
    """What the colours mean."""
    bar = figure.colorbar(lines, ax=axes, shrink=0.6, pad=0.06, aspect=32)
    bar.set_label(f"time {unit_label(solution.unit('time'))}", fontsize=9)
    bar.ax.tick_params(labelsize=8)


def _draw_sphere(axes: Any, name: str, solution: Solution, *others: Solution) -> None:
    """The trajectory of a vector on its sphere, the side that faces away drawn faint.

    Time is its colour; with others, each has a colour of its own.
    """
    vector, paths = solution[name], [each[name] for each in (solution, *others)]
    radius = float(np.sqrt((vector[:, 0] ** 2).sum()))
    toward = choose_view(np.concatenate(paths, axis=1))
    angle, height = np.meshgrid(np.linspace(0, 2 * np.pi, 49), np.linspace(0, np.pi, 25))
    ball = (
        radius * np.sin(height) * np.cos(angle),
        radius * np.sin(height) * np.sin(angle),
        radius * np.cos(height),
    )
    axes.computed_zorder = False
    axes.plot_surface(*ball, color="#d9e2ec", alpha=0.35, linewidth=0, shade=False, zorder=2)
    levels = energy_levels(solution, name, radius)
    for level in levels:
        near = np.where(faces_viewer(level, toward), level, np.nan)
        axes.plot(*near, color="#8fa3b5", linewidth=0.7, zorder=2.5)
    if not levels:
        axes.plot_wireframe(
            *ball, rstride=4, cstride=6, color="#8fa3b5", linewidth=0.3, alpha=0.6, zorder=2
        )
    for n, path in enumerate(paths):
        near = faces_viewer(path, toward)
        own = {"color": COLOURS[n]} if others else {"color": "#56657a"}
        axes.plot(*np.where(near, np.nan, path), linewidth=0.9, alpha=0.35, zorder=1, **own)
        shown = np.where(near, path, np.nan)
        if others:
            axes.plot(*shown, linewidth=1.1, zorder=3, label=f"path {n + 1}", **own)
        elif len(solution) > 1:
            lines = draw_coloured(axes, shown, solution.time, zorder=3, linewidth=1.6)
            _time_bar(axes.figure, axes, lines, solution)
    axes.coadjoint_path = np.stack(paths)
    first = "#000000" if others else COLOURS[1]  # a path may have that colour
    axes.scatter(*vector[:, :1], color=first, s=36, zorder=4, label="start")
    ends = np.stack([path[:, -1] for path in paths], axis=1)
    axes.scatter(*ends, color="#000000", s=36, marker="s", zorder=4, label="end")
    symbol, unit = symbol_label(name), unit_label(solution.system.STATE[name].unit)
    _style_space(axes, [f"{symbol}$_{n}$ {unit}" for n in (1, 2, 3)])
    axes.set_proj_type("ortho")  # its horizon is where `faces_viewer` has it
    axes.view_init(*angles(toward))
    place = AT_RIGHT if others else {"loc": "upper left"}  # where no colours of time stand
    for line in axes.legend(fontsize=8, frameon=False, **place).get_lines():
        line.set_linewidth(2.5)  # a thin one is blended with the paper
    curves = ", with levels of the energy" if levels else ""
    above = 6.0 if toward[2] > 0 else 24.0  # seen from below, ticks stand at the top
    title = f"{symbol} on the sphere |{symbol}| = {radius:.4g}{curves}"
    axes.set_title(title, fontsize=10, pad=above)


def _style_space(axes: Any, labels: Sequence[str]) -> None:
    """Axes in space: labels, few ticks, no walls."""
    for axis, label in zip((axes.xaxis, axes.yaxis, axes.zaxis), labels, strict=True):
        axis.set_label_text(label, fontsize=9)
        axis.labelpad = 2
        axis.get_major_locator().set_params(nbins=4)
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
        axis._axinfo["grid"].update(color="#e3e6ea", linewidth=0.6)
    axes.set_box_aspect((1, 1, 1), zoom=1.0)
    axes.tick_params(labelsize=7, pad=0)


def _draw_components(figure: Any, place: Any, solution: Solution) -> None:
    """Components of each state quantity against time, one panel for each."""
    quantities = list(solution.system.STATE.items())
    panels = place.subgridspec(len(quantities), 1)
    shared = None
    for n, (name, quantity) in enumerate(quantities):
        surface = find_map(solution, name)
        if surface is not None:
            draw_map(figure, panels[n], solution, name, surface)
            continue
        most = LEGEND_ROWS if isinstance(solution.system, FamilySystem) else LINES
        if len(quantity.components) > most:
            _draw_rows(figure, panels[n], solution, name, ends=n == len(quantities) - 1)
            continue
        axes = figure.add_subplot(panels[n], sharex=shared)
        shared = shared or axes
        for stroke, component in zip(_strokes(), quantity.components, strict=False):
            label = symbol_label(component)
            axes.plot(solution.time, solution[component], linewidth=1.0, label=label, **stroke)
        axes.set_ylabel(f"{symbol_label(name)} {unit_label(quantity.unit)}", fontsize=9)
        axes.tick_params(labelsize=8, labelbottom=n == len(quantities) - 1)
        columns = -(-len(quantity.components) // LEGEND_ROWS)
        size = 8 if columns == 1 else 6.5
        axes.legend(fontsize=size, ncols=columns, frameon=False, **AT_RIGHT)
        _limit_time(axes, solution)
        axes.grid(alpha=0.3)


def _draw_rows(figure: Any, place: Any, solution: Solution, name: str, *, ends: bool) -> None:
    """A quantity of many rows as colours over time: of equal members, one panel a component."""
    quantity, of_members = solution.system.STATE[name], isinstance(solution.system, FamilySystem)
    rows = quantity.shape[-1] if of_members else len(quantity.components)
    parts = solution[name].reshape(-1, rows, len(solution))
    columns = -(-len(parts) // STACKED)
    panels = place.subgridspec(-(-len(parts) // columns), columns)
    for n, part in enumerate(parts):
        axes = figure.add_subplot(panels[n // columns, n % columns])
        low, high = _choose_limits(part)
        colours = axes.pcolormesh(
            solution.time,
            np.arange(rows),
            part,
            cmap="cividis",
            shading="nearest",
            vmin=low,
            vmax=high,
        )
        colours.set_rasterized(True)
        lower = str(n + 1) * (len(parts) > 1)
        bar = figure.colorbar(colours, ax=axes, pad=0.01)
        unit = unit_label(_unit_of(quantity.unit, n, len(parts)))
        if n and unit == unit_label(_unit_of(quantity.unit, n - 1, len(parts))):
            unit = ""  # that of the panel before; panels are low
        label = f"{symbol_label(name)}$_{{{lower}}}$" if lower else symbol_label(name)
        bar.set_label(f"{label} {unit}".rstrip(), fontsize=9 if len(parts) < STACKED else 7)
        bar.ax.tick_params(labelsize=8)
        if columns == 1:
            axes.set_ylabel(_tell_rows(solution), fontsize=9)
        axes.tick_params(labelsize=8, labelbottom=ends and n + columns >= len(parts))


def _choose_limits(part: Array) -> tuple[float, float]:
    """The values of the first and the last colour: roundings of what is constant have none."""
    low, high = float(np.nanmin(part)), float(np.nanmax(part))
    size = max(abs(low), abs(high)) or 1.0
    if high - low > CONSTANT * size:
        return low, high
    return (low + high - size) / 2, (low + high + size) / 2


def _unit_of(unit: str, place: int, count: int) -> str:
    """The unit of a component, where a quantity has one for each; else that of all."""
    units = unit.split(", ")
    return units[place] if len(units) == count else unit


def _tell_rows(solution: Solution) -> str:
    """What the rows of a quantity are numbers of."""
    if not isinstance(solution.system, FamilySystem):
        return "component"
    system = solution.system
    if system.counted != "points":
        return "member"
    return f"point {system.index.name}" if system.torus is None else "point"


def _draw_drift(axes: Any, solution: Solution) -> None:
    """Change of each conserved observable relative to its largest size, on a logarithmic axis.

    That of what begins at 0 is drawn as it is: its ratio to its own roundings would be 1.
    """
    for n, (stroke, name) in enumerate(zip(_strokes(), solution.conserved, strict=False)):
        size = float(np.abs(solution[name]).max())
        if not size or begins_small(solution, name):
            size = 1.0
        with np.errstate(invalid="ignore"):  # of what is infinite
            # of a vector or matrix, the largest of the components
            moved = np.abs(solution.change(name)).reshape(-1, len(solution.time))
            change = moved.max(axis=0) / size
        change[change == 0] = np.nan  # no place on a logarithmic axis
        largest = tell_drift(solution, name) if solution.drift[name] else "none"
        width = max(0.7, 1.9 - 0.5 * n)  # often equal: the first stays visible below the others
        label = f"{observable_label(solution.system, name)} ({largest})"
        axes.plot(solution.time, change, linewidth=width, label=label, **stroke)
    axes.set_yscale("log")
    _limit_time(axes, solution)
    axes.set_xlabel(f"time {unit_label(solution.unit('time'))}", fontsize=9)
    axes.set_ylabel("relative\nchange", fontsize=8)
    axes.yaxis.get_major_locator().set_params(numticks=4)
    axes.yaxis.set_minor_formatter("")
    axes.tick_params(labelsize=8)
    axes.grid(alpha=0.3)
    if solution.conserved:
        columns = -(-len(solution.conserved) // 4)
        size = 7 if columns == 1 else 6
        axes.legend(fontsize=size, ncols=columns, frameon=False, **AT_RIGHT)


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
