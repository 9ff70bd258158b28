"""Pictures of a trajectory: on its momentum sphere or in components, invariants' drift below.

Comes in: a `Solution`. Goes out: a matplotlib figure, or a picture file. matplotlib is an extra and
is imported here alone.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.files import check_writable, write_whole
from coadjoint.solve.family import FamilySystem

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
#: Pictures of members, one above the other.
STACKED = 3
#: Relative change of |m|^2 below which a three-vector is drawn on its sphere.
ON_SPHERE = 1e-6
#: From where the sphere is seen: elevation and azimuth, degrees.
VIEW = (22, -50)


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
    sphere = _sphere_quantity(solution)
    heights = [3.0, 1.0] if sphere else [2.2, 1.0]
    grid = figure.add_gridspec(2, 1, height_ratios=heights)
    if sphere:
        _draw_sphere(figure.add_subplot(grid[0], projection="3d"), solution, sphere)
    else:
        _draw_components(figure, grid[0], solution)
    _draw_drift(figure.add_subplot(grid[1]), solution)
    return finish(figure, solution, path)


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


def _sphere_quantity(solution: Solution) -> str:
    """The first three-vector of the state whose length is conserved, or ""."""
    for name, quantity in solution.system.STATE.items():
        if quantity.shape == (3,):
            with np.errstate(over="ignore", invalid="ignore"):  # what is infinite has no sphere
                square = (solution[name] ** 2).sum(axis=0)
                if square[0] > 0 and np.ptp(square) <= ON_SPHERE * square.max():
                    return name
    return ""


def _draw_sphere(axes: Any, solution: Solution, name: str) -> None:
    """The trajectory of a vector on its sphere, the side that faces away drawn faint."""
    vector = solution[name]
    radius = float(np.sqrt((vector[:, 0] ** 2).sum()))
    angle, height = np.meshgrid(np.linspace(0, 2 * np.pi, 49), np.linspace(0, np.pi, 25))
    ball = (
        radius * np.sin(height) * np.cos(angle),
        radius * np.sin(height) * np.sin(angle),
        radius * np.cos(height),
    )
    axes.computed_zorder = False
    axes.plot_surface(*ball, color="#d9e2ec", alpha=0.3, linewidth=0, shade=False, zorder=2)
    axes.plot_wireframe(
        *ball, rstride=4, cstride=6, color="#8fa3b5", linewidth=0.3, alpha=0.6, zorder=2
    )
    near = _faces_viewer(vector)
    for shown, strength, order in ((~near, 0.3, 1), (near, 1.0, 3)):
        part = np.where(shown, vector, np.nan)
        axes.plot(*part, color=COLOURS[0], linewidth=1.1, alpha=strength, zorder=order)
    axes.scatter(*vector[:, :1], color=COLOURS[1], s=36, zorder=4, label="start")
    axes.scatter(*vector[:, -1:], color=COLOURS[2], s=36, marker="s", zorder=4, label="end")
    _label_sphere(axes, solution, name, radius)


def _faces_viewer(vector: Array) -> NDArray[np.bool_]:
    """Which points lie on the near side of the sphere, ``(T,)``."""
    elevation, azimuth = np.radians(VIEW)
    toward = np.array(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ]
    )
    side: NDArray[np.bool_] = toward @ vector >= 0  # (T,)
    # A sample beyond the edge joins the parts; they would be drawn with a gap between them.
    near = side.copy()
    near[:-1] |= side[1:]
    near[1:] |= side[:-1]
    return near


def _label_sphere(axes: Any, solution: Solution, name: str, radius: float) -> None:
    """Axes, ticks, legend and title of the sphere."""
    unit, symbol = unit_label(solution.system.STATE[name].unit), _symbol(name)
    for n, axis in enumerate((axes.xaxis, axes.yaxis, axes.zaxis), 1):
        axis.set_label_text(f"{symbol}$_{n}$ {unit}", fontsize=9)
        axis.labelpad = 0
        axis.get_major_locator().set_params(nbins=5)
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
        axis._axinfo["grid"].update(color="#e3e6ea", linewidth=0.6)
    axes.set_box_aspect((1, 1, 1), zoom=1.0)
    axes.tick_params(labelsize=7, pad=0)
    axes.set_proj_type("ortho")  # its horizon is where `_faces_viewer` has it
    axes.view_init(*VIEW)
    axes.legend(loc="upper left", fontsize=8, frameon=False)
    axes.set_title(
        f"{symbol} on the sphere |{symbol}| = {radius:.4g}, "
        f"t = {solution.time[0]:g} .. {solution.time_reached:g} s",
        fontsize=10,
    )


def _draw_components(figure: Any, place: Any, solution: Solution) -> None:
    """Components of each state quantity against time, one panel for each."""
    quantities = list(solution.system.STATE.items())
    panels = place.subgridspec(len(quantities), 1)
    shared = None
    for n, (name, quantity) in enumerate(quantities):
        if len(quantity.components) > LINES:
            _draw_rows(figure, panels[n], solution, name, ends=n == len(quantities) - 1)
            continue
        axes = figure.add_subplot(panels[n], sharex=shared)
        shared = shared or axes
        for stroke, component in zip(_strokes(), quantity.components, strict=False):
            axes.plot(solution.time, solution[component], linewidth=1.0, label=component, **stroke)
        axes.set_ylabel(f"{_symbol(name)} {unit_label(quantity.unit)}", fontsize=9)
        axes.tick_params(labelsize=8, labelbottom=n == len(quantities) - 1)
        columns = -(-len(quantity.components) // LEGEND_ROWS)
        right = {"loc": "center left", "bbox_to_anchor": (1.0, 0.5), "ncols": columns}
        axes.legend(fontsize=8 if columns == 1 else 6.5, frameon=False, **right)
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
        colours = axes.pcolormesh(
            solution.time, np.arange(rows), part, cmap="cividis", shading="nearest"
        )
        colours.set_rasterized(True)
        lower = str(n + 1) * (len(parts) > 1)
        bar = figure.colorbar(colours, ax=axes, pad=0.01)
        bar.set_label(f"{_symbol(name)}$_{{{lower}}}$ {unit_label(quantity.unit)}", fontsize=9)
        bar.ax.tick_params(labelsize=8)
        if columns == 1:
            axes.set_ylabel("member" if of_members else "component", fontsize=9)
        axes.tick_params(labelsize=8, labelbottom=ends and n + columns >= len(parts))


def _draw_drift(axes: Any, solution: Solution) -> None:
    """Change of each conserved observable relative to its largest size, on a logarithmic axis."""
    for n, (stroke, name) in enumerate(zip(_strokes(), solution.conserved, strict=False)):
        size = float(np.abs(solution[name]).max()) or 1.0
        with np.errstate(invalid="ignore"):  # of what is infinite
            # of a vector or matrix, the largest of the components
            moved = np.abs(solution.change(name)).reshape(-1, len(solution.time))
            change = moved.max(axis=0) / size
        change[change == 0] = np.nan  # no place on a logarithmic axis
        largest = f"{solution.drift[name]:.0e}" if solution.drift[name] else "none"
        width = max(0.7, 1.9 - 0.5 * n)  # often equal: the first stays visible below the others
        label = f"{name} ({largest})"
        axes.plot(solution.time, change, linewidth=width, label=label, **stroke)
    axes.set_yscale("log")
    _limit_time(axes, solution)
    axes.set_xlabel(f"time {unit_label(solution.unit('time'))}", fontsize=9)
    axes.set_ylabel("relative change", fontsize=9)
    axes.set_title("Invariants: change since the start (in parentheses: the largest)", fontsize=10)
    axes.tick_params(labelsize=8)
    axes.grid(alpha=0.3)
    if solution.conserved:
        below = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.3)}
        axes.legend(fontsize=8, ncols=min(4, len(solution.conserved)), frameon=False, **below)


def _limit_time(axes: Any, solution: Solution) -> None:
    """The time axis from the first sample to the last."""
    if len(solution) > 1:
        axes.set_xlim(solution.time[0], solution.time_reached)


def _strokes() -> Iterator[dict[str, str]]:
    """Colours of solid lines, then of dashed ones and so on, again and again."""
    while True:
        for style in STYLES:
            yield from ({"color": colour, "linestyle": style} for colour in COLOURS)


def unit_label(unit: str) -> str:
    """A unit for an axis, its exponents raised."""
    raised = re.sub(r"\^(-?\d+)", r"$^{\1}$", unit)
    return "" if unit in ("", "1") else f"[{raised}]"


def _symbol(name: str) -> str:
    """A Greek name as its letter, in matplotlib's own TeX; other names as they are."""
    greek = {
        "Pi", "Gamma", "Omega", "Xi", "Lambda", "Sigma", "Phi", "Psi", "Theta", "Delta",
        "alpha", "beta", "gamma", "delta", "mu", "nu", "xi", "eta", "chi", "phi", "psi", "theta",
    }  # fmt: skip
    return rf"$\{name}$" if name in greek else name
