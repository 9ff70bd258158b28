"""What a picture of a system shows: a path in space, a sphere with level curves, or components.

Particles move in space; a vector of constant length moves on a sphere, where the other levels of
the energy are its neighbours. Colour is time. Comes in: a `Solution` and axes. Goes out: drawn
axes. Read next: `coadjoint.solve.plot`.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import isqrt
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.errors import CoadjointError
from coadjoint.solve.family import FamilySystem
from coadjoint.solve.labels import symbol_label
from coadjoint.solve.linkages import find_lengths, find_pendulum

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.array_types import Array
    from coadjoint.solve.solution import Solution

#: A map of colours that is even in lightness and stays apart for colour-blind readers.
TIME_MAP: Final = "viridis"
#: Relative change of |m|^2 below which a three-vector is drawn on its sphere.
ON_SPHERE: Final = 1e-6
#: Members whose paths are drawn one by one.
MOST_PATHS: Final = 12
#: Levels of the energy on a sphere, and points of it along and across.
LEVELS, ALONG, ACROSS = 9, 90, 45
#: Sines of the lowest and the highest elevation of a viewer.
STEEPEST: Final = (-0.6, 0.72)
#: Sine of the elevation below which circles are seen from their edge.
LEAST: Final = 0.3
#: Least angle between a horizontal axis and where a viewer stands, radians.
ASIDE: Final = np.pi / 8
#: Extent along an axis, over the largest one, below which a motion is in a plane.
FLAT: Final = 1e-9
#: Length of a coordinate in units of the spec.
_LENGTH: Final = "m"
#: Samples at which the rate of a vector is compared with others, and by which part it may be off.
_ASKED, _ROUNDED = 7, 1e-9


@dataclass(frozen=True)
class Paths:
    """Positions in the plane or in space over time.

    Attributes:
        names: Names of the axes.
        unit: Their unit.
        members: ``(members, dimensions, T)``.
        labels: Names of the members; none where they are numbered.
        counted: What is numbered: equal members, or components of vectors.
        first: The first number.
        linked: Whether each hangs on the one before by a rod, the first on the origin.
        central: Whether the origin attracts or repels it.
        radii: Of spheres about the origin between which it moves.
    """

    names: tuple[str, ...]
    unit: str
    members: Array
    labels: tuple[str, ...] = ()
    counted: str = "member"
    first: int = 0
    linked: bool = False
    central: bool = False
    radii: tuple[float, ...] = ()

    def name_member(self, n: int) -> str:
        """What one of those is called that are numbered."""
        return f"{self.counted} {self.first + n}"


@dataclass(frozen=True)
class Sphere:
    """Vectors of one length.

    Attributes:
        symbol: What they are called.
        unit: Of their length.
        paths: ``(vectors, 3, T)``.
        labels: Of each; none of one alone, which time colours.
        levels: Curves of the energy on it, ``(3, P)`` each.
    """

    symbol: str
    unit: str
    paths: Array
    labels: tuple[str, ...] = ()
    levels: tuple[Array, ...] = ()

    @property
    def radius(self) -> float:
        """The length."""
        return float(np.linalg.norm(self.paths[0, :, 0]))


def find_paths(solution: Solution) -> Paths | None:
    """What moves in the plane or in space; None where nothing of the state is a position."""
    state = solution.system.STATE
    for name, quantity in state.items():
        places = _find_places(solution, name)
        if places is not None:
            names = tuple(f"{name}{n + 1}" for n in range(places.shape[1]))
            names = names if len(quantity.shape) < 2 or len(places) > 1 else ("x", "y", "z")
            found = _paths(names, _LENGTH, places)
            return found and replace(found, central=_is_central(solution, name))
    x, y, z = (state.get(name) for name in "xyz")
    if x and y and (x.unit, x.shape) == (y.unit, y.shape) and len(x.shape) <= 1:
        names = ("x", "y", "z") if z and (x.unit, x.shape) == (z.unit, z.shape) else ("x", "y")
        values = np.stack([np.asarray(solution[n]).reshape(-1, len(solution)) for n in names])
        found = _paths(names, x.unit, values.swapaxes(0, 1))
        if found and not isinstance(solution.system, FamilySystem):
            return replace(found, counted="component", first=1)
        return found
    return _find_links(solution) or _find_moving(solution) or _find_orbit(solution)


def _find_places(solution: Solution, name: str) -> Array | None:
    """Places in the plane or in space that a quantity holds, ``(members, dimensions, T)``.

    Those are a vector, columns of a matrix, as of a pose, or its rows where a shift of all rows
    changes no rate; None of what holds none.
    """
    quantity = solution.system.STATE[name]
    count, units = len(quantity.components), quantity.unit.split(", ")
    held = np.array([each == _LENGTH for each in (units if len(units) > 1 else units * count)])
    values = np.asarray(solution[name])
    if _are_rows(solution, name) and held.all():
        return values.reshape(isqrt(count), isqrt(count), -1)
    if not held.any() or not 1 <= len(quantity.shape) <= 2 or quantity.shape[0] not in (2, 3):
        return None
    columns = held.reshape(quantity.shape[0], -1)  # (dimensions, members)
    if not (columns == columns[0]).all():
        return None
    return values.reshape(*columns.shape, -1)[:, columns[0]].swapaxes(0, 1)


def _are_rows(solution: Solution, name: str) -> bool:
    """Whether rows of a square matrix, component by component, are places that can be shifted."""
    system = solution.system
    quantity = system.STATE[name]
    width = isqrt(len(quantity.components))
    is_matrix = quantity.shape == (width**2,) and f"{name}12" in quantity.components
    if not is_matrix or width not in (2, 3):
        return False
    rows, shifted = system.STATE.rows(name), solution.state[:, :1].copy()
    shifted[rows] += np.tile([0.3, -0.2, 0.5][:width], width)[:, None]
    try:
        rates, others = (
            np.asarray(system.rhs(each, solution.parameters, target="numpy"))
            for each in (solution.state[:, :1], shifted)
        )
    except (CoadjointError, TypeError, ValueError):
        return False  # time or inputs
    return bool(np.abs(others - rates).max() <= _ROUNDED * np.abs(rates).max())


def _find_links(solution: Solution) -> Paths | None:
    """The masses of a pendulum of links in the plane."""
    pendulum = find_pendulum(solution)
    if pendulum is None:
        return None
    angles, lengths, names, unit = pendulum
    turned = np.stack([np.asarray(solution[name]) for name in angles])  # (links, T)
    ends = lengths[:, None, None] * np.stack([np.sin(turned), -np.cos(turned)], axis=1)
    masses = np.cumsum(ends, axis=0)
    return Paths(names=names, unit=unit, members=masses, labels=angles, linked=True)


def _find_orbit(solution: Solution) -> Paths | None:
    """The state as a point in space, where it is one vector whose length changes."""
    (name, quantity), *more = solution.system.STATE.items()
    if more or quantity.shape != (3,) or solution.batch:
        return None
    values = np.asarray(solution[name])
    size = np.linalg.norm(values, axis=0)
    if not np.isfinite(size).all() or find_sphere(solution):
        return None
    steps = np.diff(size)
    one_way = bool((steps >= 0).all() or (steps <= 0).all())
    radii = (float(size[0]), float(size[-1])) if one_way and size.min() > 0 else ()
    return Paths(names=quantity.components, unit=quantity.unit, members=values[None], radii=radii)


def _is_central(solution: Solution, name: str) -> bool:
    """Whether a place alone is accelerated along the line to the origin, at some samples."""
    system, rate = solution.system, _find_rate(solution, name)
    if rate not in system.STATE or len(system.STATE[name].shape) != 1:
        return False
    at = np.unique(np.linspace(0, len(solution) - 1, _ASKED).astype(int))
    found = np.asarray(system.rhs(solution.state[:, at], solution.parameters, target="numpy"))
    force, place = found[system.STATE.rows(rate)], np.asarray(solution[name])[:, at]
    if len(place) not in (2, 3):
        return False
    if len(place) == 2:
        force, place = (np.vstack([each, np.zeros(len(at))]) for each in (force, place))
    size = np.linalg.norm(force, axis=0) * np.linalg.norm(place, axis=0)
    across = np.linalg.norm(np.cross(force, place, axis=0), axis=0)
    return bool((size > 0).all() and (across <= _ROUNDED * size).all())


def _find_moving(solution: Solution) -> Paths | None:
    """Vectors whose rates are vectors that the system names: places in any unit, or rods.

    One alone whose length is one is a point of a sphere, and no path.
    """
    rates = {name: rate for name in solution.system.STATE if (rate := _find_rate(solution, name))}
    vectors = {name: np.asarray(solution[name]) for name in rates}
    places = [name for name, values in vectors.items() if not _is_direction(values)]
    if not places:
        return _find_rods(solution, rates) if len(rates) > 1 else None
    first = solution.system.STATE[places[0]]
    alike = [
        name
        for name in places
        if (solution.system.STATE[name].shape, solution.system.STATE[name].unit)
        == (first.shape, first.unit)
    ]
    dimensions = range(1, 1 + first.shape[0])
    names = "xyz"[: len(dimensions)] if len(alike) > 1 else [f"{alike[0]}{n}" for n in dimensions]
    found = _paths(tuple(names), first.unit, np.stack([vectors[name] for name in alike]))
    return found and replace(found, labels=tuple(alike) if len(alike) > 1 else ())


def _is_direction(values: Array) -> bool:
    """Whether a vector has length one."""
    return bool(np.allclose((values**2).sum(axis=0), 1.0, rtol=0.0, atol=ON_SPHERE))


def _find_rods(solution: Solution, rates: Mapping[str, str]) -> Paths:
    """Directions as rods that hang on each other; as points of one sphere where they do not."""
    of_state = all(rate in solution.system.STATE for rate in rates.values())
    lengths = find_lengths(solution, list(rates.values())) if of_state else None
    members = np.stack([np.asarray(solution[name]) for name in rates])  # (members, 3, T)
    if lengths is not None:
        members = np.cumsum(lengths[:, None, None] * members, axis=0)
    return Paths(
        names=("x", "y", "z"),
        unit="1",
        members=members,
        labels=tuple(rates),
        linked=lengths is not None,
    )


def _find_rate(solution: Solution, name: str) -> str:
    """A vector of the state or the observables that is a positive multiple of the rate, or ""."""
    system = solution.system
    shape = system.STATE[name].shape
    if shape not in ((2,), (3,)):
        return ""
    at = np.unique(np.linspace(0, len(solution) - 1, _ASKED).astype(int))
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            found = system.rhs(solution.state[:, at], solution.parameters, target="numpy")
    except (CoadjointError, TypeError, ValueError):
        return ""  # time or inputs
    own = np.asarray(found)[system.STATE.rows(name)]
    size = float(np.abs(own).max())
    for other, quantity in {**system.STATE, **system.OBSERVABLES}.items():
        if quantity.shape != shape or not 0 < size < np.inf:
            continue
        values = np.asarray(solution[other])[:, at]
        factor = float((own * values).sum() / ((values**2).sum() or 1.0))
        if factor > 0 and np.abs(factor * values - own).max() <= _ROUNDED * size:
            return other
    return ""


def _paths(names: tuple[str, ...], unit: str, members: Array) -> Paths | None:
    """Paths that can be told apart, without an axis along which nothing moves."""
    if len(members) > MOST_PATHS or not np.isfinite(members).all():
        return None
    extents = np.ptp(members, axis=(0, 2))
    moving = [n for n, extent in enumerate(extents) if extent > FLAT * extents.max()]
    if len(names) == 3 and len(moving) == 2:
        names, members = tuple(names[n] for n in moving), members[:, moving]
    return Paths(names=names, unit=unit, members=members)


def find_spheres(solution: Solution, *others: Solution) -> tuple[Sphere, ...]:
    """Spheres on which vectors move; with others, paths of one vector from all solutions.

    That of a vector of the state, of those of few equal members, or of the sum and the difference
    of two vectors, as of the momenta of so(4), which is two copies of so(3).
    """
    state, name = solution.system.STATE, find_sphere(solution)
    if name:
        paths = np.stack([each[name] for each in (solution, *others)])
        sphere = Sphere(
            symbol=symbol_label(name),
            unit=state[name].unit,
            paths=paths,
            labels=tuple(f"path {n + 1}" for n in range(len(paths))) if others else (),
        )
        levels = energy_levels(solution, name, sphere.radius)
        return (replace(sphere, levels=tuple(levels)),)
    return _find_members(solution) or _find_halves(solution)


def _find_members(solution: Solution) -> tuple[Sphere, ...]:
    """The sphere of vectors of few equal members, all of one length."""
    system = solution.system
    if not isinstance(system, FamilySystem) or not system.spheres or system.size > MOST_PATHS:
        return ()
    for name, quantity in system.STATE.items():
        paths = np.moveaxis(np.asarray(solution[name]), 1, 0)  # (members, 3, T)
        if quantity.shape == (3, system.size) and _have_one_length(paths):
            first = system.index.first_name
            labels = tuple(f"{name}[{first + n}]" for n in range(system.size))
            symbol = symbol_label(name)
            return (Sphere(symbol=symbol, unit=quantity.unit, paths=paths, labels=labels),)
    return ()


def _find_halves(solution: Solution) -> tuple[Sphere, ...]:
    """The sum and the difference of the two vectors that a state is made of."""
    quantities = list(solution.system.STATE.values())
    if [each.shape for each in quantities] != [(3,), (3,)]:
        return ()
    first, second = quantities
    a, b = (np.asarray(solution[each.name]) for each in quantities)
    if first.unit != second.unit:
        return ()
    spheres = []
    for sign, path in (("+", a + b), ("\N{MINUS SIGN}", a - b)):
        if not (_have_one_length(path[None]) and _moves(path)):
            return ()
        symbol = f"{symbol_label(first.name)} {sign} {symbol_label(second.name)}"
        spheres.append(Sphere(symbol=symbol, unit=first.unit, paths=path[None]))
    return tuple(spheres)


def _have_one_length(paths: Array) -> bool:
    """Whether vectors ``(vectors, 3, T)`` have the same length at all times, and not 0."""
    with np.errstate(over="ignore", invalid="ignore"):  # what is infinite has no sphere
        square = (paths**2).sum(axis=1)
        return bool(square.min() > 0 and np.ptp(square) <= ON_SPHERE * square.max())


def _moves(path: Array) -> bool:
    """Whether a vector ``(3, T)`` of more than one sample does not stand still."""
    return path.shape[1] < 2 or bool(np.ptp(path, axis=1).max() > ON_SPHERE * np.abs(path).max())


def find_sphere(solution: Solution) -> str:
    """The first three-vector of the state that moves and whose length is conserved, or ""."""
    for name, quantity in solution.system.STATE.items():
        if quantity.shape != (3,):
            continue
        values = np.asarray(solution[name])
        if _have_one_length(values[None]) and _moves(values) and _is_leaf(solution, name):
            return name
    return ""


def _is_leaf(solution: Solution, name: str) -> bool:
    """Whether a sphere is where the bracket lets a vector go, where that is the whole state.

    A motion may keep the length by its energy alone: on the Heisenberg group it goes in planes.
    """
    system, radius = solution.system, float(np.linalg.norm(np.asarray(solution[name])[:, 0]))
    casimirs = [each for each in system.OBSERVABLES if re.fullmatch(r"casimir\d+", each)]
    if set(system.STATE) != {name} or not casimirs:
        return True
    longitude, latitude = np.mgrid[-3.0:3.0:5j, -1.5:1.5:5j].reshape(2, -1)
    points = _on_sphere(longitude, latitude, radius)
    try:
        found = np.asarray(system.observables(points, solution.parameters, target="numpy"))
    except (CoadjointError, TypeError, ValueError):
        return True  # time, inputs or a domain that the whole sphere is not in
    values = np.stack([found[system.OBSERVABLES.rows(each)] for each in casimirs])
    return bool((np.ptp(values, axis=1) <= ON_SPHERE * np.abs(values).max(axis=1)).all())


def choose_view(vector: Array) -> Array:
    """The direction from which a curve around the origin is on the near side.

    Args:
        vector: ``(3, T)``.

    >>> choose_view(np.array([[1.0, 1.0], [0.1, -0.1], [0.0, 0.0]])).round(6).tolist()
    [0.881325, 0.365057, 0.3]
    """
    mean = vector.mean(axis=1)
    size = float(np.linalg.norm(vector, axis=0).max()) or 1.0
    toward = mean / size
    if np.linalg.norm(toward) < 0.2:  # it goes around: seen along the axis that it goes around
        _, _, axes = np.linalg.svd((vector - mean[:, None]).T, full_matrices=False)
        toward = axes[-1] * (1 if axes[-1][2] >= 0 else -1)
    toward = toward / np.linalg.norm(toward)
    across = np.hypot(toward[0], toward[1])
    sideways = _aside(toward[:2] if across > 0.2 else np.array([0.8, -0.6]))
    height = float(np.clip(toward[2] + 0.3, *STEEPEST))
    if abs(height) < LEAST:
        height = LEAST
    return np.array([*(np.sqrt(1 - height**2) * sideways), height])


def _aside(direction: Array) -> Array:
    """The nearest horizontal direction that is not along an axis: ticks would lie on each other."""
    azimuth = float(np.arctan2(direction[1], direction[0]))
    axis = np.round(azimuth / (np.pi / 2)) * (np.pi / 2)
    off = azimuth - axis
    if abs(off) < ASIDE:
        azimuth = axis + np.copysign(ASIDE, off)
    return np.array([np.cos(azimuth), np.sin(azimuth)])


def angles(toward: Array) -> tuple[float, float]:
    """Elevation and azimuth of a direction, degrees."""
    x, y, z = toward
    return float(np.degrees(np.arctan2(z, np.hypot(x, y)))), float(np.degrees(np.arctan2(y, x)))


def faces_viewer(vector: Array, toward: Array) -> NDArray[np.bool_]:
    """Which points lie on the near side of the sphere, ``(T,)``."""
    side: NDArray[np.bool_] = toward @ vector >= 0  # (T,)
    # A sample beyond the edge joins the parts; they would be drawn with a gap between them.
    near = side.copy()
    near[:-1] |= side[1:]
    near[1:] |= side[:-1]
    return near


def style_space(axes: Any, labels: Sequence[str]) -> None:
    """Axes in space: labels, few ticks, no walls."""
    for axis, label in zip((axes.xaxis, axes.yaxis, axes.zaxis), labels, strict=True):
        axis.set_label_text(label, fontsize=9)
        axis.labelpad = 2
        axis.get_major_locator().set_params(nbins=4)
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
        axis._axinfo["grid"].update(color="#e3e6ea", linewidth=0.6)
    axes.zaxis.set_rotate_label(False)  # along the axis it may stand on its head
    axes.zaxis.label.set_rotation(90)
    axes.set_box_aspect((1, 1, 1), zoom=1.0)
    axes.tick_params(labelsize=7, pad=0)


def draw_ball(axes: Any, radius: float, *, face: bool = True, wires: bool = True) -> None:
    """A sphere that shows what is behind it, and its circles of longitude and latitude."""
    angle, height = np.meshgrid(np.linspace(0, 2 * np.pi, 49), np.linspace(0, np.pi, 25))
    ball = radius * np.stack(
        [np.sin(height) * np.cos(angle), np.sin(height) * np.sin(angle), np.cos(height)]
    )
    if face:
        axes.plot_surface(*ball, color="#d9e2ec", alpha=0.35, linewidth=0, shade=False, zorder=2)
    if wires:
        axes.plot_wireframe(
            *ball, rstride=4, cstride=6, color="#8fa3b5", linewidth=0.3, alpha=0.6, zorder=2
        )


def draw_coloured(axes: Any, path: Array, time: Array, **options: Any) -> Any:
    """A path in the plane or in space, coloured by time; marks at its start and its end."""
    from matplotlib.collections import LineCollection

    points = path.T  # (T, d)
    pieces: Any = np.stack([points[:-1], points[1:]], axis=1)
    shown = {"cmap": TIME_MAP, "linewidth": 1.3, "capstyle": "round", **options}
    if path.shape[0] == 3:
        from mpl_toolkits.mplot3d.art3d import (  # type: ignore[import-untyped]
            Line3DCollection,
        )

        lines: Any = Line3DCollection(pieces, **shown)
        lines.set_array(time[:-1])
        axes.add_collection3d(lines)
    else:
        lines = LineCollection(pieces, **shown)
        lines.set_array(time[:-1])
        axes.add_collection(lines)
    return lines


def energy_levels(solution: Solution, name: str, radius: float) -> list[Array]:
    """Level curves of the energy on the sphere of a vector.

    Each is ``(3, T)``; none where the energy depends on what else moves.
    """
    system = solution.system
    if "energy" not in system.OBSERVABLES:
        return []
    longitude = np.linspace(-np.pi, np.pi, ALONG)
    latitude = np.linspace(-np.pi / 2, np.pi / 2, ACROSS)
    grid = _on_sphere(*np.meshgrid(longitude, latitude), radius)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            energy, *later = (
                _find_energy(solution, name, at, grid) for at in (0, len(solution) // 2, -1)
            )
    except (CoadjointError, TypeError, ValueError):
        return []  # time, inputs or a domain that the whole sphere is not in
    if not np.isfinite(energy).all() or np.ptp(energy) == 0:
        return []
    if any(np.abs(each - energy).max() > _ROUNDED * np.ptp(energy) for each in later):
        return []
    from contourpy import contour_generator

    maker = contour_generator(longitude, latitude, energy)
    heights = np.linspace(energy.min(), energy.max(), LEVELS + 2)[1:-1]
    lines: list[Any] = [line for height in heights for line in maker.lines(height)]
    return [_on_sphere(line[:, 0], line[:, 1], 1.002 * radius) for line in lines]


def _find_energy(solution: Solution, name: str, at: int, vectors: Array) -> Array:
    """The energy of vectors ``(3, ...)`` where what else moves is as in a sample."""
    system = solution.system
    states = np.repeat(solution.state[:, at, None], vectors[0].size, axis=1)
    states[system.STATE.rows(name)] = vectors.reshape(3, -1)
    values = np.asarray(system.observables(states, solution.parameters, target="numpy"))
    energy: Array = values[system.OBSERVABLES.rows("energy")].reshape(vectors.shape[1:])
    return energy


def _on_sphere(longitude: Array, latitude: Array, radius: float) -> Array:
    """Points of a sphere, ``(3, ...)``."""
    flat = np.cos(latitude)
    return radius * np.stack([flat * np.cos(longitude), flat * np.sin(longitude), np.sin(latitude)])
