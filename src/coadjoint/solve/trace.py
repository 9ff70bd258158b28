"""Pictures of a trace: the path of a point (x, y) on the plane, such as the contact of a ball.

Comes in: a `Solution` with ``x`` and ``y``, of the state or reconstructed. Goes out: a matplotlib
figure, or a picture file.
Read next: `coadjoint.solve.paths`, which finds the curve and its length.
"""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.labels import unit_label
from coadjoint.solve.panels import COLOURS
from coadjoint.solve.paths import Path
from coadjoint.solve.plot import begin_figure, finish

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.solve.solution import Solution
    from coadjoint.solve.system import System


def trace(solution: Solution, path: str | PathLike[str] | None = None) -> Any:
    """Draw the path of (x, y) on the plane, both axes to one scale.

    Args:
        solution: What to draw.
        path: File to write (PNG, PDF or SVG by its ending); None to return the figure.

    Raises:
        KernelArgumentError: There is no x or y, matplotlib is not installed, or it does not know
            the ending.
        OutputError: The file cannot be written.
    """
    check_traced(solution.system)
    figure = begin_figure(path)
    axes = figure.add_subplot()
    way = Path(solution)
    x, y = (part.reshape(-1, part.shape[-1]).T for part in way.find_points())  # (P, members)
    axes.plot(x, y, color=COLOURS[0], linewidth=1.1)
    axes.plot(x[0], y[0], "o", color=COLOURS[1], markersize=7, label="start")
    axes.plot(*_find_ends(x, y), "s", color=COLOURS[2], markersize=6, label="end")
    axes.set_aspect("equal", adjustable="datalim")
    plain = solution.unit("x")
    unit = unit_label(plain)
    axes.set_xlabel(f"x {unit}", fontsize=9)
    axes.set_ylabel(f"y {unit}", fontsize=9)
    axes.tick_params(labelsize=8)
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, frameon=False, loc="best")
    axes.set_title(
        f"Trace on the plane, length {_tell_length(way)} {plain if unit else ''}, "
        f"{solution.system.clock[0]} = {solution.time[0]:g} .. {solution.time_reached:g} "
        f"{solution.unit('time')}".rstrip(),
        fontsize=10,
    )
    return finish(figure, solution, path)


def _find_ends(x: Array, y: Array) -> tuple[Array, Array]:
    """The last finite point of each member."""
    finite = np.isfinite(x) & np.isfinite(y)
    last = len(x) - 1 - np.argmax(finite[::-1], axis=0)
    members = np.arange(x.shape[1])
    return x[last, members], y[last, members]


def _tell_length(way: Path) -> str:
    """The length of a path, or the least and greatest of several."""
    lengths = way.find_length()
    ends = sorted({f"{lengths.min():.4g}", f"{lengths.max():.4g}"}, key=float)
    return ("" if way.is_close else "about ") + " to ".join(ends)


def check_traced(system: System) -> None:
    """There is a point (x, y) whose path can be drawn.

    Raises:
        KernelArgumentError: There is none.
    """
    names = [*system.STATE, *system.RECONSTRUCTED, *system.OBSERVABLES]
    missing = [name for name in ("x", "y") if name not in names]
    if missing:
        raise KernelArgumentError(
            f"{system.name} leaves no trace: no {' and no '.join(missing)} among "
            f"{', '.join(names)}; expected x and y on a plane. "
            "Declare [rolling], or x and y in [reconstruction].",
            found=names,
            expected=["x", "y"],
        )
