r"""Curves of strands at some times: sections in space, or a direction on the sphere.

Sections of a strand are where its strain and its velocities take them, from the frame of the first
one at the first sample on; as that section sees them where velocities do not follow from the state.
Those of a chain of bodies are where their attitudes and places are.
A vector of constant length at each point of a field is a curve on its sphere.
Comes in: a `Solution`. Goes out: a `Curves`, and its picture.
Read next: `coadjoint.solve.strands`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.solve.family import FamilySystem
from coadjoint.solve.labels import symbol_label, tell_time, unit_label
from coadjoint.solve.scenes import TIME_MAP, angles, choose_view, draw_ball, style_space

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.solve.solution import Solution

#: How many times are shown.
SHOWN: Final = 5
#: How far matrices may be from rotations, and squares of lengths from equal ones.
ROUNDED: Final = 1e-6
#: Points at the most that are marked one by one.
MARKED: Final = 32


@dataclass(frozen=True)
class Curves:
    """Curves in space, or on a sphere.

    Attributes:
        points: ``(times, 3, points)``.
        show: The same at a sample, ``(3, points)``, by its number.
        times: What each is called.
        radius: Of the sphere; 0 in space.
        title: What is drawn.
        names: Of the axes, with their units.
        drawn: Quantities of the state that need no panels besides.
    """

    points: Array
    show: Callable[[int], Array]
    times: tuple[str, ...]
    radius: float
    title: str
    names: tuple[str, ...]
    drawn: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Found:
    """What is found: a function of samples' numbers, and the rest as above."""

    show: Callable[[Array], Array]
    radius: float
    title: str
    names: tuple[str, ...]
    drawn: tuple[str, ...] = ()


def find_curves(solution: Solution) -> Curves | None:
    """The curve of a field, a strand or a chain; None without one, and of a batch."""
    system = solution.system
    if (
        not isinstance(system, FamilySystem)
        or solution.batch
        or not np.isfinite(solution.state).all()
    ):
        return None
    found = next((each for find in _FINDERS for each in find(solution, system)), None)
    if found is None:
        return None
    samples = np.unique(np.linspace(0, len(solution) - 1, SHOWN).round().astype(int))
    return Curves(
        points=np.moveaxis(found.show(samples), -1, 0),
        show=lambda at: found.show(np.array([at]))[..., 0],
        times=tuple(tell_time(solution, int(at)) for at in samples),
        radius=found.radius,
        title=found.title,
        names=found.names,
        drawn=found.drawn,
    )


def _find_strand(solution: Solution, system: FamilySystem) -> Iterator[_Found]:
    """Sections of a strand of rotations, or of rotations and places."""
    strands = [each for each in system.connections if each.name in system.STATE]
    if not strands or strands[0].side != "left" or strands[0].size not in (3, 4):
        return

    from coadjoint.solve.strands import FEWEST, find_first, find_frames, move

    strand, first = strands[0], None
    if strand.velocity and len(solution) >= FEWEST:
        first = find_first(solution, strand)  # at all samples: between few it turns too far

    def frames(samples: Array) -> Array:
        from coadjoint.solve.solution import Solution

        time, state = solution.time[samples], solution.state[:, samples]
        along = find_frames(Solution(system, time, state, solution.parameters, "OK", ""))
        return along if first is None else move(first[..., samples], along, strand.side)

    if not _are_turning(frames(np.array([len(solution) - 1]))):
        return
    length, index = system.PARAMETERS[strand.length].unit, system.index.name
    seen = f", seen from that at {index} = 0" * (first is None)
    if strand.size == 4:
        yield _Found(
            show=lambda samples: frames(samples)[:3, 3],
            radius=0.0,
            title="the strand in space" + seen.replace("that", "its section"),
            names=tuple(f"{name} {unit_label(length)}".strip() for name in "xyz"),
        )
        return
    yield _Found(
        show=lambda samples: frames(samples)[:, 2],
        radius=1.0,
        title="the third axes of all sections" + seen,
        names=("x", "y", "z"),
    )


def _find_chain(solution: Solution, system: FamilySystem) -> Iterator[_Found]:
    """Bodies in a row: the last columns of their frames, places or third axes."""
    for name, quantity in system.STATE.items():
        sizes = quantity.shape
        if len(sizes) != 3 or sizes[0] != 3 or sizes[1] not in {3, 4}:
            continue
        values = np.asarray(solution[name])  # (3, 3 or 4, N, T)
        if not _are_turning(values[:, :3]):
            continue
        has_places = sizes[1] == 4
        units = quantity.unit.split(", ")
        unit = unit_label(units[3]) if has_places and len(units) == 12 else ""
        closed = _close if system.index.periodic else _as_is

        def show(
            samples: Array, values: Array = values, closed: Callable[[Array], Array] = closed
        ) -> Array:
            return closed(values[:, -1][..., samples])

        yield _Found(
            show=show,
            radius=0.0 if has_places else 1.0,
            title="the chain in space" if has_places else "the third axes of all bodies",
            names=tuple(f"{each} {unit}".strip() for each in "xyz"),
            drawn=(name,),
        )


def _find_field(solution: Solution, system: FamilySystem) -> Iterator[_Found]:
    """A vector of the same constant length at all points of a field."""
    if not system.spheres or not system.lengths:
        return
    for name, quantity in system.STATE.items():
        if quantity.shape != (3, system.size):
            continue
        values = np.asarray(solution[name])  # (3, N, T)
        square = (values**2).sum(axis=0)
        if square.min() <= 0 or np.ptp(square) > ROUNDED * square.max():
            continue
        closed = _close if system.index.periodic else _as_is
        symbol, radius = symbol_label(name), float(np.sqrt(square[0, 0]))

        def show(
            samples: Array, values: Array = values, closed: Callable[[Array], Array] = closed
        ) -> Array:
            return closed(values[..., samples])

        yield _Found(
            show=show,
            radius=radius,
            title=f"{symbol} at all points on the sphere |{symbol}| = {radius:.4g}",
            names=tuple(f"{symbol}$_{n}$ {unit_label(quantity.unit)}".strip() for n in (1, 2, 3)),
        )


_FINDERS: Final = (_find_strand, _find_chain, _find_field)


def _close(values: Array) -> Array:
    """The points of a circle, the first one again behind the last."""
    return np.concatenate([values, values[:, :1]], axis=1)


def _as_is(values: Array) -> Array:
    return values


def _are_turning(matrices: Array) -> bool:
    """Whether the first three rows and columns of all matrices ``(n, n, ...)`` are rotations.

    Of four, the last row is (0, 0, 0, 1).
    """
    whole = np.moveaxis(matrices, (0, 1), (-2, -1))
    last = whole[..., 3:, :]
    turning = whole[..., :3, :3]
    off = np.abs(np.swapaxes(turning, -1, -2) @ turning - np.eye(3)).max()
    if last.size:
        off = max(off, np.abs(last - [0.0, 0.0, 0.0, 1.0]).max())
    return bool(off < 100 * ROUNDED)


def draw_curves(figure: Any, place: Any, curves: Curves) -> Any:
    """Curves at some times, each with a colour of its own."""
    import matplotlib as mpl

    axes = figure.add_subplot(place, projection="3d")
    axes.computed_zorder = False
    count = len(curves.points)
    whole = np.concatenate(list(curves.points), axis=1)
    low, high = whole.min(axis=1), whole.max(axis=1)
    middle = np.zeros((3, 1)) if curves.radius else ((low + high) / 2)[:, None]
    toward = choose_view(whole - middle)
    if curves.radius:
        draw_ball(axes, curves.radius)
    colours = mpl.colormaps[TIME_MAP](np.linspace(0.0, 0.92, count))
    marked = {"marker": "o", "markersize": 3} if curves.points.shape[-1] <= MARKED else {}
    for path, time, colour in zip(curves.points, curves.times, colours, strict=True):
        (last,) = axes.plot(*path, color=colour, linewidth=1.5, label=time, zorder=3, **marked)
        if curves.radius:  # a curve may turn along itself
            axes.plot(*path[:, :1], color=colour, marker="o", markersize=6, zorder=4)
    if not curves.radius:
        half = 0.5 * np.maximum(high - low, 0.6 * (high - low).max() or 1.0)
        for limit, centre, size in zip(
            (axes.set_xlim, axes.set_ylim, axes.set_zlim), middle[:, 0], half, strict=True
        ):
            limit(centre - size, centre + size)
    style_space(axes, curves.names)
    axes.set_box_aspect((1, 1, 1) if curves.radius else half, zoom=0.85)  # labels need room below
    if not curves.radius:
        for axis, size in zip((axes.xaxis, axes.yaxis, axes.zaxis), half, strict=True):
            axis.get_major_locator().set_params(nbins=4 if size == half.max() else 2)
            axis.labelpad = -2 if size < half.max() else 1
    axes.set_proj_type("ortho")
    axes.view_init(*angles(toward))
    axes.legend(fontsize=8, frameon=False, loc="center left", bbox_to_anchor=(1.2, 0.5))
    dots = "; dots: the first point" if curves.radius else ""
    axes.set_title(curves.title + dots, fontsize=10)

    def move(at: int) -> None:
        last.set_data_3d(*curves.show(at))

    axes.coadjoint_body = move
    return axes
