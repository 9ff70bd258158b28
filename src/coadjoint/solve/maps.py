"""Maps: a field in a plane, on the sphere or on the torus, as colours at some times.

Comes in: a `Solution` and the name of a quantity. Goes out: panels of a figure, all with the same
colours about zero. A map of the sphere is Mollweide's, on which areas are those of the sphere.
Read next: `coadjoint.solve.matrix_functions`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.solve.labels import symbol_label, tell_time, unit_label

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.families import Index, Torus
    from coadjoint.solve.solution import Solution

#: How many times are shown.
SHOWN: Final = 4
#: How many points are drawn along each coordinate for each one, or each row of a matrix.
FINER: Final = 4


@dataclass(frozen=True)
class Map:
    """What is drawn of a field.

    Attributes:
        x: Where points stand along the horizontal coordinate, evenly.
        y: Along the vertical one.
        show: Values ``(len(y), len(x))`` at a sample, by its number.
        names: Of the coordinates, none where the map has lines of its own.
        projection: matplotlib's name for the map; None for a plane.
    """

    x: Array
    y: Array
    show: Callable[[int], Array]
    names: tuple[str, ...]
    projection: str | None


def find_map(solution: Solution, name: str) -> Map | None:
    """The map of a quantity; None if it is no field on a surface."""
    torus: Torus | None = getattr(solution.system, "torus", None)
    if torus is not None:
        return _find_plane(solution, name, torus)
    index: Index | None = getattr(solution.system, "index", None)
    finders = {"sphere": _find_sphere, "torus": _find_torus}
    find = finders.get(index.surface) if index is not None else None
    return find(solution, name, index) if find is not None and index is not None else None


def is_globe(solution: Solution, name: str) -> bool:
    """Whether the map of a quantity is one of the sphere."""
    surface = find_map(solution, name)
    return surface is not None and surface.projection is not None


def _find_plane(solution: Solution, name: str, torus: Torus) -> Map:
    """A field at points of a plane."""
    values = solution[name]
    lengths = (solution.system.PARAMETERS.rows(length) for length in torus.lengths)
    x, y = (
        np.arange(FINER * n) * (np.ravel(solution.parameters[row])[0] / (FINER * n))
        for n, row in zip(values.shape, lengths, strict=False)
    )
    return Map(
        x=x,
        y=y,
        show=lambda at: refine(values[..., at]).T,
        names=torus.coordinates,
        projection=None,
    )


def _find_sphere(solution: Solution, name: str, index: Index) -> Map:
    """A function on the sphere for which entries of a matrix stand, by longitude and latitude."""
    from coadjoint.solve.matrix_functions import show_on_sphere

    n = index.size
    assert n is not None, "a system has a size"
    entries = solution[name].reshape(n, n, -1)
    half = FINER * n
    x, y = (np.pi * ((np.arange(k) + 0.5) / half - k / (2 * half)) for k in (2 * half, half))
    return Map(
        x=x,
        y=y,
        show=lambda at: show_on_sphere(entries[..., at], np.sin(y), x),
        names=("", ""),
        projection="mollweide",
    )


def _find_torus(solution: Solution, name: str, index: Index) -> Map:
    """A function on the torus for which entries of a matrix stand."""
    from coadjoint.solve.matrix_functions import show_on_torus

    n = index.size
    assert n is not None, "a system has a size"
    entries = solution[name].reshape(n, n, -1)
    x = 2 * np.pi * np.arange(FINER * n) / (FINER * n)
    return Map(
        x=x,
        y=x,
        show=lambda at: refine(show_on_torus(entries[..., at])).T,
        names=("x", "y"),
        projection=None,
    )


def draw_map(figure: Any, place: Any, solution: Solution, name: str, surface: Map) -> None:
    """A field at some times, all with the same colours."""
    shown = np.unique(np.linspace(0, len(solution) - 1, SHOWN).round().astype(int))
    fields = [surface.show(int(at)) for at in shown]
    largest = float(np.nanmax(np.abs(fields))) or 1.0
    rows = -(-len(shown) // 2)
    panels = place.subgridspec(rows, min(len(shown), 2))
    every = []
    for n, (at, field) in enumerate(zip(shown, fields, strict=True)):
        axes = figure.add_subplot(panels[n // 2, n % 2], projection=surface.projection)
        every.append(axes)
        colours = axes.pcolormesh(
            surface.x,
            surface.y,
            field,
            cmap="PuOr",
            vmin=-largest,
            vmax=largest,
            shading="nearest",
        )
        colours.set_rasterized(True)
        axes.set_title(tell_time(solution, int(at)), fontsize=9)
        if surface.projection is not None:
            axes.set_xticks(np.pi * np.arange(-2, 3) / 3, [])
            axes.set_yticks(np.pi * np.arange(-2, 3) / 6, [])
            axes.grid(color="#56657a", linewidth=0.4, alpha=0.5)
            continue
        axes.set_aspect("equal")
        axes.tick_params(labelsize=8, labelleft=n % 2 == 0, labelbottom=n + 2 >= len(shown))
        axes.set_xlabel(surface.names[0] * (n + 2 >= len(shown)), fontsize=9)
        axes.set_ylabel(surface.names[1] * (n % 2 == 0), fontsize=9)
    axes.coadjoint_field = colours, surface.show  # in a film the last one moves
    bar = figure.colorbar(colours, ax=every, pad=0.02, aspect=40)
    unit = unit_label(solution.system.STATE[name].unit)
    bar.set_label(f"{symbol_label(name)} {unit}".strip(), fontsize=9)
    bar.ax.tick_params(labelsize=8)


def refine(field: Array) -> Array:
    """The same trigonometric polynomial at more points."""
    from scipy import fft

    waves, shape = fft.fftshift(fft.fft2(field)), [FINER * n for n in field.shape]
    room = [
        (new // 2 - n // 2, (new + 1) // 2 - (n + 1) // 2)
        for new, n in zip(shape, field.shape, strict=True)
    ]
    found: Array = fft.ifft2(fft.ifftshift(np.pad(waves, room))).real * FINER**2
    return found
