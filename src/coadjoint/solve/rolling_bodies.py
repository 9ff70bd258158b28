"""Bodies that roll or slide on a plane: their surface, their contact, their centre.

The arm s goes from the contact to the centre of mass, a function of the vertical Gamma seen from
the body; the surface of the body is where arms begin, ``-s``. Comes in: a `Solution`, with an
attitude and a contact of a body that rolls. Goes out: a `RollingBody`, and axes on which it is
drawn. Read next: `coadjoint.solve.plot`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.solve.arms import Arms, list_vectors
from coadjoint.solve.scenes import angles
from coadjoint.solve.sliding_bodies import follow_sliding

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.solve.solution import Solution

#: Rings of a surface and points of each.
ROWS, COLUMNS = 24, 48
#: Part of the height of the sphere that rings leave out at its poles: of a disk that lies flat, no
#: point is the contact.
POLE: Final = 0.004
#: Largest difference of the velocities of the centre by splines and by the generated functions,
#: over the largest of these and of the contact's: splines have errors of their own.
APART: Final = 0.05
#: Thickness, over its size, below which a body is flat.
FLAT: Final = 0.02
#: How many times the body is drawn along its path at the most, the end included, and how far
#: apart, in sizes of it.
PLACES, DISTANCE = 4, 2.5
#: Colours of the sectors of a surface and of its cap, by which its turning is seen; pale before its
#: end. All are opaque: pieces of a surface that let light through are seen one by one.
FIELDS: Final = ("#c9d6e4", "#6f8fb0", "#d95f02")
PALE: Final = ("#eef2f6", "#d6dfe8", "#f2c9a6")
#: Rings of the cap where the third axis of a body leaves it, by which its turning over is seen.
CAP: Final = 4
#: How wide the cap may be, over the width of the body.
WIDTH: Final = 0.5
#: Points of a ring in a sector.
SECTOR: Final = 6
#: Where the viewer stands.
TOWARD: Final = np.array([0.44, -0.76, 0.48])


@dataclass(frozen=True)
class RollingBody:
    """A body on a horizontal plane.

    Attributes:
        contact: On the plane, ``(3, T)``, the third component 0.
        centre: The centre of mass in space, ``(3, T)``.
        turned: From axes of the body to those of space, ``(3, 3, T)``.
        surface: Around the centre in axes of the body, ``(3, ROWS + 2, COLUMNS + 1)``; its ends,
            as those of a disk, are closed at their middles.
        unit: Of lengths.
    """

    contact: Array
    centre: Array
    turned: Array
    surface: Array
    unit: str

    @property
    def size(self) -> float:
        """The largest distance of its surface from its centre."""
        return float(np.linalg.norm(self.surface, axis=0).max())

    @property
    def is_flat(self) -> bool:
        """Whether it is a disk."""
        return float(np.ptp(self.surface[2])) < FLAT * self.size

    def surface_at(self, at: int) -> Array:
        """Its surface in space at a sample, of the form of ``surface``."""
        placed: Array = np.einsum("jk,krc->jrc", self.turned[:, :, at], self.surface)
        return placed + self.centre[:, at, None, None]


def find_rolling(solution: Solution) -> RollingBody | None:
    """The body that rolls or slides; None where nothing stands on a plane by an arm."""
    if solution.batch or len(solution) < 8 or not np.isfinite(solution.state).all():
        return None
    if solution.system.RECONSTRUCTED:
        return None if solution.reconstructed is None else _find_followed(solution)
    body = follow_sliding(solution)
    if body is None:
        return None
    return _place(solution, body.arms, body.turned, body.contact, body.unit)


def _find_followed(solution: Solution) -> RollingBody | None:
    """A body that rolls, whose attitude and contact are integrated with the motion."""
    followed = solution.system.RECONSTRUCTED
    attitudes = [name for name, each in followed.items() if each.shape == (4,) and each.upright]
    places = [name for name, each in followed.items() if each.shape == ()]
    if len(attitudes) != 1 or len(places) != 2 or len(followed) != 3:
        return None
    unit = followed[places[0]].unit
    values = np.asarray(solution.reconstructed)
    if followed[places[1]].unit != unit or not np.isfinite(values).all():
        return None
    turned, vertical = _turned(solution[attitudes[0]]), followed[attitudes[0]].upright
    contact = np.stack([*(np.ravel(solution[name]) for name in places), np.zeros(len(solution))])
    for turning in list_vectors(solution.system.STATE, but=[vertical]):
        for moving in list_vectors(solution.system.OBSERVABLES):
            body = _place(solution, Arms(vertical, turning, moving), turned, contact, unit)
            if body is not None:
                return body
    return None


def _place(
    solution: Solution, names: Arms, turned: Array, contact: Array, unit: str
) -> RollingBody | None:
    """The body on its contact; None where its centre does not move as it is known to."""
    arms = names.find(solution, solution[names.vertical])
    if arms is None:
        return None
    centre = contact + np.einsum("jkt,kt->jt", turned, arms)
    velocity = np.einsum("jkt,kt->jt", turned, solution[names.sliding or names.moving])
    if not _moves_so(np.asarray(solution.time), contact, centre, velocity):
        return None
    surface = _find_surface(solution, names)
    if surface is None:
        return None
    return RollingBody(contact=contact, centre=centre, turned=turned, surface=surface, unit=unit)


def draw_rolling(axes: Any, body: RollingBody) -> Callable[[int], None]:
    """The body where it ends, faint before, and the path of its centre.

    Returns:
        A function of a sample's number, that draws the last body there.
    """
    axes.computed_zorder = False  # seen from above, the body hides the plane, and never the reverse
    axes.view_init(*angles(TOWARD))
    axes.plot(*body.centre, color="#5b6570", linewidth=0.8, alpha=0.7, zorder=3)
    for at in _choose_places(body):
        _draw_surface(axes, body, at, PALE)
    shown = [_draw_surface(axes, body, body.contact.shape[1] - 1, FIELDS)]

    def move(at: int) -> None:
        shown.pop().remove()
        shown.append(_draw_surface(axes, body, at, FIELDS))

    return move


def box_of(body: RollingBody) -> tuple[Array, Array]:
    """The least and the largest coordinates of all that is drawn: ``(3,)`` each."""
    low = np.minimum(body.contact.min(axis=1), body.centre.min(axis=1) - body.size)
    high = np.maximum(body.contact.max(axis=1), body.centre.max(axis=1) + body.size)
    return np.array([*low[:2], 0.0]), high


def _choose_places(body: RollingBody) -> Iterator[int]:
    """Samples before the last at which the body stands apart from where else it is drawn."""
    last = body.centre.shape[1] - 1
    taken = [last]
    for at in np.linspace(0, last, PLACES).round().astype(int)[:-1]:
        far = np.linalg.norm(body.centre[:, taken] - body.centre[:, [at]], axis=0)
        if far.min() > DISTANCE * body.size:
            taken.append(int(at))
            yield int(at)


def _draw_surface(axes: Any, body: RollingBody, at: int, colours: tuple[str, ...]) -> Any:
    """The surface at a sample, in sectors of two colours, above those that are farther away."""
    from matplotlib.colors import to_rgb

    depths = TOWARD @ body.centre
    nearness = float((depths[at] - depths.min()) / (np.ptp(depths) or 1.0))
    surface = body.surface_at(at)
    sectors = np.tile(np.arange(COLUMNS) // SECTOR % 2, (ROWS + 1, 1))
    if not body.is_flat:  # of a disk all rings are its rim
        sectors[-_count_cap(surface) :] = 2
    return axes.plot_surface(
        *surface,
        facecolors=np.array([to_rgb(each) for each in colours])[sectors],
        rcount=ROWS + 2,
        ccount=COLUMNS + 1,
        linewidth=0,
        shade=not body.is_flat,  # light on the two sides of a disk, at the same place, would differ
        antialiased=False,
        zorder=4 + nearness,
        clip_on=False,  # at the border of a box seen from near
    )


def _count_cap(surface: Array) -> int:
    """Rings of the cap: few, and of a flat body, whose top is a few rings alone, the inner ones.

    Args:
        surface: ``(3, rings, points)``, of which the last ring is where the axis leaves it.
    """
    across = np.linalg.norm(surface - surface.mean(axis=2, keepdims=True), axis=0).max(axis=1)
    inside = int(np.argmax(across[::-1] > WIDTH * across.max())) - 1
    return int(np.clip(inside, 1, CAP))


def _turned(quaternions: Array) -> Array:
    """Matrices of unit quaternions with the real part first, ``(3, 3, T)``."""
    from scipy.spatial.transform import Rotation

    matrices: Array = Rotation.from_quat(np.roll(quaternions, -1, axis=0).T).as_matrix()
    return np.moveaxis(matrices, 0, -1)


def _moves_so(time: Array, contact: Array, centre: Array, velocity: Array) -> bool:
    """Whether a centre moves with a velocity, as far as samples tell."""
    from scipy.interpolate import CubicSpline

    slid, found = (CubicSpline(time, each, axis=-1)(time, 1) for each in (contact, centre))
    left = np.abs(found - velocity)[:, 2:-2]  # splines are least sure at their ends
    largest = max(float(np.abs(each).max()) for each in (slid, velocity))
    return bool(left.max() <= APART * max(largest, 1e-12))


def _find_surface(solution: Solution, names: Arms) -> Array | None:
    """Where arms begin, for verticals all around: rings about the third axis of the body."""
    height, angle = np.meshgrid(
        np.pi * np.linspace(POLE, 1 - POLE, ROWS),
        np.linspace(0, 2 * np.pi, COLUMNS + 1),
        indexing="ij",
    )
    flat = np.sin(height)
    verticals = np.stack([flat * np.cos(angle), flat * np.sin(angle), np.cos(height)])
    arms = names.find(solution, verticals.reshape(3, -1))
    if arms is None:
        return None
    rings = -arms.reshape(verticals.shape)
    ends = [rings[:, [row], :-1].mean(axis=2, keepdims=True) for row in (0, -1)]
    first, last = (np.repeat(end, COLUMNS + 1, axis=2) for end in ends)
    return np.concatenate([first, rings, last], axis=1)
