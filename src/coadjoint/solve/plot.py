"""Pictures of a trajectory: on its momentum sphere or in components, invariants' drift below.

Comes in: a `Solution`. Goes out: a matplotlib figure, or a picture file. matplotlib is an extra.
Read next: `coadjoint.solve.panels`.
"""

from __future__ import annotations

from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import CoadjointError, KernelArgumentError
from coadjoint.files import check_writable, write_whole
from coadjoint.solve.curves import Curves, draw_curves, find_curves
from coadjoint.solve.labels import symbol_label, time_axis, unit_label
from coadjoint.solve.maps import is_globe
from coadjoint.solve.panels import AT_RIGHT, COLOURS, draw_panels, list_panels
from coadjoint.solve.rolling_bodies import RollingBody, box_of, draw_rolling, find_rolling
from coadjoint.solve.scenes import (
    Paths,
    Sphere,
    angles,
    choose_view,
    draw_ball,
    draw_coloured,
    faces_viewer,
    find_paths,
    find_spheres,
    style_space,
)
from coadjoint.solve.smooth import add_times, has_corners
from coadjoint.solve.vehicles import Vehicle, draw_vehicle, find_vehicle

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.occurrences import Occurrences
    from coadjoint.solve.solution import Solution

    Array = NDArray[np.float64]

#: Heights in inches: of the strip of drift below a scene, and of curves above panels.
STRIP, CURVES = 0.9, 3.5
#: How much is seen of what is behind a sphere.
FAR = 0.6
#: Of a body that is drawn at several times, which a film does not.
PALE = ", pale before its end"


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
    scene = find_scene(solution, *others)
    fine = solution if others else _smooth(solution, scene)
    if fine is not solution:
        scene = find_scene(fine)
    if scene is None:
        if any(is_globe(solution, name) for name in solution.system.STATE):
            figure.set_size_inches(7.2, 5.6)  # maps of the sphere are half as high as wide
        draw_panels(figure, solution, list_panels(solution))
        return
    if isinstance(scene, Curves):
        panels = list_panels(solution, without=scene.drawn)
        draw_panels(
            figure, solution, panels, (CURVES,), lambda place: draw_curves(figure, place, scene)
        )
        return
    if isinstance(scene, tuple) and len(scene) > 1:
        figure.set_size_inches(7.2, 5.2)  # two spheres in a row
    elif isinstance(scene, tuple | RollingBody) or (
        isinstance(scene, Paths) and scene.members.shape[1] == 3
    ):
        figure.set_size_inches(7.2, 6.4)
    strip = STRIP * bool(solution.conserved)  # drift is no third of a picture
    height = figure.get_size_inches()[1] - strip

    def draw_scene(place: Any) -> None:
        match scene:
            case Paths():
                _draw_paths(figure, place, fine, scene)
            case RollingBody():
                _draw_rolling(figure, place, solution, scene)
            case tuple():
                _draw_spheres(figure, place, fine, scene)
            case Vehicle():
                _draw_vehicle(figure, place, solution, scene)

    draw_panels(figure, solution, [], (height,), draw_scene)


def _smooth(solution: Solution, scene: Scene | None) -> Solution:
    """The motion at more times, where paths through its samples would have corners."""
    from coadjoint.solve.noisy import has_noise

    if scene is None or has_noise(solution.system) or not any(map(has_corners, _paths_of(scene))):
        return solution
    try:
        return add_times(solution, lambda found: np.concatenate(_paths_of(find_scene(found))))
    except (CoadjointError, ValueError):  # between the samples its rates are not known
        return solution


def _paths_of(scene: Scene | None) -> list[Array]:
    """What is drawn as lines through the samples, ``(paths, d, T)`` each."""
    match scene:
        case Paths():
            return [scene.members]
        case tuple():
            return [sphere.paths for sphere in scene]
    return []


Scene = Paths | RollingBody | Vehicle | Curves | tuple[Sphere, ...]


def find_scene(solution: Solution, *others: Solution) -> Scene | None:
    """What a motion is drawn as: orbits, a body, vectors on their spheres, a vehicle.

    Curves are those of a strand, above components. None of what is drawn in components alone.
    """
    paths = find_paths(solution) if len(solution) > 1 else None
    return (
        paths
        or find_rolling(solution)
        or find_spheres(solution, *others)
        or find_vehicle(solution)
        or find_curves(solution)
        or None
    )


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
            label = symbol_label(paths.labels[n]) if paths.labels else paths.name_member(n)
            axes.plot(*path, color=colour, linewidth=1.1, label=label)
        else:
            lines = draw_coloured(axes, path, solution.time)
            _time_bar(figure, axes, lines, solution)
        own = {"color": colour} if several else {"color": "#000000"}
        axes.plot(*path[:, -1:], marker="o", markersize=5, linestyle="", **own)
        axes.plot(*path[:, :1], marker="o", markersize=5, fillstyle="none", linestyle="", **own)
    if paths.linked:
        origin = np.zeros((1, paths.members.shape[1]))
        rods = np.concatenate([origin, paths.members[:, :, -1]]).T  # (dimensions, joints)
        axes.plot(*rods, color="#000000", linewidth=2.0, zorder=4, label="rods at the end")
        axes.plot(*origin.T, marker="^", color="#000000", markersize=7, linestyle="")
    if paths.central:
        centre = np.zeros((paths.members.shape[1], 1))
        axes.plot(
            *centre,
            marker="+",
            color=COLOURS[1],
            markersize=10,
            linestyle="",
            label="centre of the force",
        )
        axes.legend(fontsize=8, frameon=False, loc="upper left")
    for radius in paths.radii:
        draw_ball(axes, radius, face=False)
    axes.coadjoint_path = solution.time, paths.members
    _limit_space(axes, paths)
    if several:
        # in space the letter of an axis is at the right
        place = {"bbox_to_anchor": (1.08, 0.5)} if in_space else {}
        axes.legend(fontsize=8, frameon=False, **{**AT_RIGHT, **place})
    spheres = ""
    if paths.radii:
        letter, (low, high) = symbol_label(paths.names[0][:-1]), paths.radii
        spheres = f"; between the spheres |{letter}| = {low:.4g} and {high:.4g}"
    axes.set_title(f"open circle: start, filled: end{spheres}", fontsize=9, color="#5b6570")


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
    style_space(axes, [f"{name} {unit_label(body.unit)}" for name in "xyz"])
    axes.set_box_aspect(high - low, zoom=1.15)
    axes.zaxis.get_major_locator().set_params(nbins=2)
    axes.set_title(
        "trace: the contact, coloured by time; gray line: the centre of mass\n"
        f"blue sectors: the body{PALE}"
        + ("" if body.is_flat else "; orange cap: where its third axis leaves it"),
        fontsize=9,
        color="#5b6570",
    )


def _limit_space(axes: Any, paths: Paths) -> None:
    """Equal scales, and a view of the plane of the motion."""
    low, high = paths.members.min(axis=(0, 2)), paths.members.max(axis=(0, 2))
    if paths.linked or paths.central:  # the fixed point is seen, too
        low, high = np.minimum(low, 0.0), np.maximum(high, 0.0)
    if paths.radii:
        low, high = (np.full(3, sign * max(paths.radii)) for sign in (-1, 1))
    middle, half = (low + high) / 2, 0.55 * float((high - low).max()) or 1.0
    limits = (axes.set_xlim, axes.set_ylim, *([axes.set_zlim] if len(middle) == 3 else []))
    for limit, centre in zip(limits, middle, strict=True):
        limit(centre - half, centre + half)
    labels = [f"{symbol_label(name)} {unit_label(paths.unit)}" for name in paths.names]
    if len(labels) == 3:
        whole = np.concatenate(list(paths.members), axis=1)
        axes.view_init(*angles(choose_view(whole - whole.mean(axis=1, keepdims=True))))
        style_space(axes, labels)
        return
    axes.set_aspect("equal")
    axes.set_xlabel(labels[0], fontsize=9)
    axes.set_ylabel(labels[1], fontsize=9)
    axes.tick_params(labelsize=8)
    axes.grid(alpha=0.3)


def _time_bar(figure: Any, axes: Any, lines: Any, solution: Solution) -> None:
    """What the colours mean."""
    bar = figure.colorbar(lines, ax=axes, shrink=0.6, pad=0.06, aspect=32)
    bar.set_label(time_axis(solution), fontsize=9)
    bar.ax.tick_params(labelsize=8)


def _draw_spheres(figure: Any, place: Any, solution: Solution, spheres: tuple[Sphere, ...]) -> None:
    """Spheres in a row; of vectors that time colours the last one has the bar."""
    panels, many = place.subgridspec(1, len(spheres)), len(spheres) > 1
    every = [figure.add_subplot(each, projection="3d") for each in panels]
    for axes, sphere in zip(every, spheres, strict=True):
        lines = _draw_sphere(axes, sphere, solution)
        if many:  # in a row there is less room
            axes.set_title(axes.get_title().replace(" |", "\n|", 1), fontsize=9)
            for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
                axis.set_label_text(axis.get_label_text().partition(" [")[0], fontsize=8)
    for axes in every[1:]:
        axes.get_legend().remove()
    if lines is not None:
        _time_bar(figure, every, lines, solution)


def _draw_sphere(axes: Any, sphere: Sphere, solution: Solution) -> Any:
    """Vectors on their sphere, the side that faces away drawn faint.

    Time is the colour of one vector; of several, each has a colour of its own.

    Returns:
        The lines that time colours; None without any.
    """
    toward, lines = choose_view(np.concatenate(list(sphere.paths), axis=1)), None
    axes.computed_zorder = False
    draw_ball(axes, sphere.radius, wires=not sphere.levels)
    for level in sphere.levels:
        near = np.where(faces_viewer(level, toward), level, np.nan)
        axes.plot(*near, color="#8fa3b5", linewidth=0.7, zorder=2.5)
    for n, path in enumerate(sphere.paths):
        near = faces_viewer(path, toward)
        own = {"color": COLOURS[n % len(COLOURS)]} if sphere.labels else {"color": "#56657a"}
        axes.plot(*np.where(near, np.nan, path), linewidth=0.9, alpha=FAR, zorder=2.2, **own)
        shown = np.where(near, path, np.nan)
        if sphere.labels:
            label = symbol_label(sphere.labels[n])
            axes.plot(*shown, linewidth=1.1, zorder=3, label=label, **own)
        elif len(solution) > 1:
            lines = draw_coloured(axes, shown, solution.time, zorder=3, linewidth=1.6)
    axes.coadjoint_path, axes.coadjoint_toward = (solution.time, sphere.paths), toward
    first = "#000000" if sphere.labels else COLOURS[1]  # a path may have that colour
    starts, ends = (np.stack([path[:, at] for path in sphere.paths], axis=1) for at in (0, -1))
    if np.ptp(starts, axis=1).max() == 0:
        starts = starts[:, :1]
    for points, colour, marker, label in (
        (starts, first, "o", "start"),
        (ends, "#000000", "s", "end"),
    ):
        near = toward @ points >= 0
        behind = {"facecolors": "none", "edgecolors": colour, "zorder": 2.6}
        axes.scatter(*points[:, ~near], marker=marker, s=30, **behind)
        axes.scatter(*points[:, near], color=colour, marker=marker, s=36, zorder=4, label=label)
    symbol, unit = sphere.symbol, unit_label(sphere.unit)
    letter = symbol if " " not in symbol else f"({symbol})"
    style_space(axes, [f"{letter}$_{n}$ {unit}".rstrip() for n in (1, 2, 3)])
    axes.set_proj_type("ortho")  # its horizon is where `faces_viewer` has it
    axes.view_init(*angles(toward))
    place = AT_RIGHT if sphere.labels else {"loc": "upper left"}  # where no colours of time stand
    for line in axes.legend(fontsize=8, frameon=False, **place).get_lines():
        line.set_linewidth(2.5)  # a thin one is blended with the paper
    curves = ", with levels of the energy" if sphere.levels else ""
    above = 6.0 if toward[2] > 0 else 24.0  # seen from below, ticks stand at the top
    length = f"{sphere.radius:.4g} {unit}".rstrip()
    title = f"{symbol} on the sphere |{symbol}| = {length}{curves}"
    axes.set_title(title, fontsize=10, pad=above)
    return lines
