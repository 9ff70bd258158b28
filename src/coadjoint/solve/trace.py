"""Pictures of a trace: the path of a point (x, y) on the plane, such as the contact of a ball.

Comes in: a `Solution` with ``x`` and ``y``, of the state or reconstructed. Goes out: a matplotlib
figure, or a picture file.
"""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.plot import COLOURS, finish, new_figure, unit_label

if TYPE_CHECKING:
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
    figure = new_figure(headless=path is not None)
    axes = figure.add_subplot()
    x, y = solution["x"], solution["y"]
    axes.plot(x, y, color=COLOURS[0], linewidth=1.1)
    axes.plot(x[:1], y[:1], "o", color=COLOURS[1], markersize=7, label="start")
    axes.plot(x[-1:], y[-1:], "s", color=COLOURS[2], markersize=6, label="end")
    axes.set_aspect("equal", adjustable="datalim")
    plain = solution.unit("x")
    unit = unit_label(plain)
    axes.set_xlabel(f"x {unit}", fontsize=9)
    axes.set_ylabel(f"y {unit}", fontsize=9)
    axes.tick_params(labelsize=8)
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, frameon=False, loc="best")
    length = float(np.hypot(np.diff(x), np.diff(y)).sum())
    axes.set_title(
        f"Trace on the plane, length {length:.4g} {plain if unit else ''}, "
        f"t = {solution.time[0]:g} .. {solution.time_reached:g} s",
        fontsize=10,
    )
    return finish(figure, solution, path)


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
