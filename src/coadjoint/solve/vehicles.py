"""Vehicles in the plane, as a motion shows them: where their axles are, and what they pull.

A wheel stands where the body never moves sideways, and a trailer hangs where that holds of its own
axle at its own angle. Both are linear conditions on lengths, which samples of the motion decide; no
name of a variable is known. Comes in: a `Solution` with a place and a direction in the plane. Goes
out: a `Vehicle`, and lines that draw it. Read next: `coadjoint.solve.plot`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.solve.solution import Solution

#: Largest sideways velocity over the size of its terms at which a wheel is said to roll: splines
#: through the samples have errors of their own.
SIDEWAYS: Final = 1e-3
#: Where a vehicle is drawn along its path, the end included.
PLACES: Final = 5
#: Part of the extent of a picture below which a vehicle is drawn larger than it is.
SMALLEST: Final = 0.12


@dataclass(frozen=True)
class Trailer:
    """A carriage behind a joint of the body.

    Attributes:
        angle: To the direction of the body at each sample, ``(T,)``, radians.
        joint: From the place of the body forward to the joint.
        length: From the joint back to the axle of the carriage.
    """

    angle: Array
    joint: float
    length: float


@dataclass(frozen=True)
class Vehicle:
    """A body in the plane with a wheel.

    Attributes:
        place: ``(2, T)``.
        heading: Direction of the body, ``(T,)``, radians.
        wheel: From the place forward to the axle.
        trailers: What it pulls.
        unit: Of lengths.
    """

    place: Array
    heading: Array
    wheel: float
    trailers: tuple[Trailer, ...]
    unit: str

    @property
    def size(self) -> float:
        """The extent of what the motion shows of it; of a wheel at its place, that of the picture.

        A wheel alone has no size that a motion could show.
        """
        ends = [0.0, self.wheel, *(each.joint for each in self.trailers)]
        found = max(max(ends) - min(ends), *(each.length for each in self.trailers), 0.0)
        extent = float(np.ptp(self.place, axis=1).max()) or 1.0
        return found if found > SIDEWAYS * extent else SMALLEST * extent

    def list_lines(self, at: int, larger: float = 1.0) -> Iterator[Array]:
        """Lines that draw it at a sample, each ``(2, P)``: bars, axles and wheels."""
        heading, here = self.heading[at], self.place[:, at]
        width = 0.3 * self.size * larger

        def along(angle: float, *points: tuple[float, float]) -> Array:
            forward, left = np.array(points).T
            cosine, sine = np.cos(angle), np.sin(angle)
            return np.stack([cosine * forward - sine * left, sine * forward + cosine * left])

        def axle(angle: float, forward: float) -> Iterator[Array]:
            yield along(angle, (forward, -width), (forward, width))
            for side in (-width, width):
                yield along(angle, (forward - 0.4 * width, side), (forward + 0.4 * width, side))

        ends = [0.0, self.wheel, *(each.joint for each in self.trailers)]
        low, high = larger * min(ends), larger * max(ends)
        yield here[:, None] + along(heading, (low, 0.0), (high, 0.0))
        for line in axle(heading, larger * self.wheel):
            yield here[:, None] + line
        for each in self.trailers:
            hinge = here[:, None] + along(heading, (larger * each.joint, 0.0))
            own = heading + each.angle[at]
            yield hinge + along(own, (0.0, 0.0), (-larger * each.length, 0.0))
            for line in axle(own, -larger * each.length):
                yield hinge + line


def find_vehicle(solution: Solution) -> Vehicle | None:
    """The vehicle that moves; None where nothing is a place and a direction, or no wheel is found.

    Of a motion without turning no axle is found: each point then moves straight ahead.
    """
    followed = solution.system.RECONSTRUCTED
    if solution.batch or len(solution) < 8 or solution.reconstructed is None:
        return None
    units = {name: each.unit for name, each in followed.items()}
    angles = [name for name, unit in units.items() if unit == "1" and not followed[name].shape]
    if set(units) != {"x", "y", *angles} or len(angles) != 1 or units["x"] != units["y"]:
        return None
    x, y, heading = (np.ravel(solution[name]) for name in ("x", "y", *angles))
    place = np.stack([x, y])
    time = np.asarray(solution.time)
    if not (np.isfinite(place).all() and np.isfinite(heading).all()):
        return None
    forward, across = _in_body(_rate(time, place), heading)
    turning = _rate(time, heading)
    wheel = _fit([turning], -across, forward)
    if wheel is None:
        return None
    trailers = []
    for name, quantity in solution.system.STATE.items():
        if quantity.unit != "1" or quantity.shape:
            continue
        angle = np.ravel(solution[name])
        sideways = np.sin(angle) * forward - np.cos(angle) * across
        columns = [np.cos(angle) * turning, -(turning + _rate(time, angle))]
        found = _fit(columns, sideways, forward)
        if found is not None and found[1] > 0:
            trailers.append(Trailer(angle, found[0], found[1]))
    return Vehicle(
        place=place,
        heading=heading,
        wheel=wheel[0],
        trailers=tuple(trailers),
        unit=units["x"],
    )


def draw_vehicle(axes: Any, vehicle: Vehicle) -> Any:
    """The vehicle along its path, faint before its end, and the function that moves it.

    Returns:
        A function of a sample's number, that draws the last vehicle there.
    """
    extent = float(np.ptp(vehicle.place, axis=1).max()) or 1.0
    larger = max(1.0, SMALLEST * extent / vehicle.size)
    samples = np.unique(np.linspace(0, len(vehicle.heading) - 1, PLACES).round().astype(int))
    for at in samples[:-1]:
        for line in vehicle.list_lines(int(at), larger):
            axes.plot(*line, color="#5b6570", linewidth=1.0, alpha=0.45, zorder=2.5)
    last = [
        axes.plot(*line, color="#000000", linewidth=1.8, zorder=5)[0]
        for line in vehicle.list_lines(int(samples[-1]), larger)
    ]
    if f"{larger:.2g}" != "1":
        axes.set_title(
            f"the vehicle is drawn {larger:.2g} times its size", fontsize=9, color="#5b6570"
        )

    def move(at: int) -> None:
        for drawn, line in zip(last, vehicle.list_lines(at, larger), strict=True):
            drawn.set_data(*line)

    return move


def _in_body(velocity: Array, heading: Array) -> Array:
    """A velocity in axes of the body, forward and across."""
    cosine, sine = np.cos(heading), np.sin(heading)
    return np.stack(
        [cosine * velocity[0] + sine * velocity[1], cosine * velocity[1] - sine * velocity[0]]
    )


def _rate(time: Array, values: Array) -> Array:
    """Time derivative of samples."""
    from scipy.interpolate import CubicSpline

    found: Array = CubicSpline(time, values, axis=-1)(time, 1)
    return found


def _fit(columns: list[Array], right: Array, speed: Array) -> list[float] | None:
    """Lengths that satisfy a condition at all samples; None where none do, or many."""
    matrix = np.stack(columns, axis=1)  # (T, n)
    if np.linalg.matrix_rank(matrix, tol=1e-6 * np.sqrt(len(matrix))) < len(columns):
        return None
    found, *_ = np.linalg.lstsq(matrix, right, rcond=None)
    size = max(float(np.abs(speed).max()), float(np.abs(matrix * found).max()), 1e-12)
    left = np.abs(matrix @ found - right)[2:-2]  # splines are least sure at their ends
    return found.tolist() if left.max() <= SIDEWAYS * size else None
