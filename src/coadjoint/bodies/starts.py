r"""Where bodies begin: fields of the profiles, and attitudes that its strain turns into.

From the attitude 1 of the first body, :math:`\partial_s R = R\,\hat\Xi` is solved from body to body
by Magnus's steps of order 6. Around a ring this closes where the holonomy is 1 alone.

The strain of a rod is integrated as one matrix, of attitude and place. That the strain is periodic
says of the rod in space that :math:`g(s + L) = H g(s)`, where H is constant: a rigid motion, which
is 1 of a ring in space. Where H is a translation the rod is a period of an endless one. All is
turned so that this goes along the third axis, and places are counted from equal steps along it. So
bodies are equal members of a ring, whose links have one more constant.

Comes in: the Spec of a strand, and how many bodies there are. Goes out: their momenta,
advected vectors and attitudes.
Read next: `coadjoint.bodies.text`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import ceil
from typing import TYPE_CHECKING, Final

import numpy as np

from coadjoint.bodies.energy import refuse
from coadjoint.derive.fields.profiles import evaluate_profile
from coadjoint.exact import dense
from coadjoint.solve.strands import NODES, find_steps

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.bodies.energy import Strand

#: Steps along the strand, at least.
STEPS: Final = 64
#: How far from 1 the holonomy of a ring that closes may be, by rounding and by the error of steps.
CLOSED: Final = 1e-8


@dataclass(frozen=True)
class Starts:
    """Where bodies begin.

    Attributes:
        fields: Momenta and advected vectors ``(N, n)`` by name, where they have profiles.
        attitudes: ``(N, 3, 3)``, of a rod with places ``(N, 3, 4)``, or None where all are 1.
        gap: How far the holonomy of the strain is from 1, where that keeps a ring from closing.
        wall: ``(3, 3)``, the attitude of the wall behind the last body, of a rod with its place
            ``(3, 4)``, or None where it is 1.
        rise: Of an endless rod, how far it goes on along the third axis, per length.
    """

    fields: Mapping[str, Array]
    attitudes: Array | None = None
    gap: float = 0.0
    wall: Array | None = None
    rise: float = 0.0


def find_starts(strand: Strand, bodies: int) -> Starts:
    """Momenta and attitudes of bodies, at equal distances, at defaults of the parameters.

    Bodies of a chain with free ends are in the middle of equal pieces. Between clamped ends they
    are at equal distances from one another and from the walls, the first of which has the attitude
    1.

    Raises:
        SpecError: A rod around a circle ends with another attitude than it begins with.
    """
    spec, space = strand.spec, strand.spec.space
    assert space is not None, spec.name
    is_clamped = space.ends == "clamped"
    pieces = bodies + 1 if is_clamped else bodies
    first = Fraction(1, 2 * bodies) if space.ends == "free" else Fraction(0)
    places = [first + Fraction(n + is_clamped, pieces) for n in range(bodies)]
    fields = {
        each.name: _evaluate(strand, each.name, places)
        for each in (*strand.momenta, *strand.advected)
        if each.name in spec.profiles
    }
    if strand.strain.name not in spec.profiles:
        return Starts(fields=fields)
    links = bodies - 1 if space.ends == "free" else pieces  # a free chain has one less than a ring
    frames, rise = _find_frames(strand, pieces, links, first)[:, :3], 0.0
    one = np.eye(*frames[0].shape)
    gap = 0.0 if space.has_ends else float(np.abs((frames[-1] - one)[:, :3]).max())
    if gap > CLOSED and strand.is_rod:
        problem = f"its profile turns the rod around the circle, by a rotation {gap:.2g} from 1"
        expected = "a profile with which attitudes close, so that the rod goes on along a line"
        hint = f'Or write ends = "free" or "clamped" in [space], {space.name}.'
        raise refuse(spec, problem, expected, hint)
    if gap > CLOSED:
        return Starts(fields=fields, gap=gap)
    if strand.is_rod and not space.has_ends:
        frames, rise = _straighten(frames, _length_of(strand))
    if np.abs(frames - one).max() <= CLOSED:
        return Starts(fields=fields, rise=rise)
    if is_clamped:
        return Starts(fields=fields, attitudes=frames[1:-1], wall=frames[-1])
    return Starts(fields=fields, attitudes=frames[:bodies], rise=rise)


def _straighten(frames: Array, length: float) -> tuple[Array, float]:
    """Poses of an endless rod along the third axis, with places from equal steps along it.

    Args:
        frames: ``(N + 1, 3, 4)``, the last of which is a translation from the first.
        length: Of the rod.

    Returns:
        The poses, and how far the rod goes on, per length; those that are given, and 0, where the
        rod closes.
    """
    period = frames[-1, :, 3]
    far = float(np.linalg.norm(period))
    if far <= CLOSED * length:
        return frames, 0.0
    x, y, z = period / far
    if 1 + z > CLOSED:  # the least turn to the third axis
        turn = np.array([[1 - x * x / (1 + z), -x * y / (1 + z), -x], [0, 1 - y * y / (1 + z), -y]])
        turn[1, 0] = turn[0, 1]
        turn = np.vstack([turn, [x, y, z]])
    else:
        turn = np.diag([1.0, -1.0, -1.0])
    turned: Array = turn @ frames
    turned[:, 2, 3] -= far * np.arange(len(frames)) / (len(frames) - 1)
    return turned, far / length


def _length_of(strand: Strand) -> float:
    """The length of the strand by default."""
    spec, space = strand.spec, strand.spec.space
    assert space is not None, spec.name
    (length,) = (each.default for each in spec.parameters if each.name == space.length)
    assert length is not None, space.length
    return float(length[0])


def _evaluate(strand: Strand, name: str, places: Iterable[Fraction]) -> Array:
    """A field at parts of the way, a row for each."""
    rows = [evaluate_profile(strand.spec, name, part) for part in places]
    return np.array(rows, dtype=float)


def _find_frames(strand: Strand, equal: int, links: int, first: Fraction) -> Array:
    """Attitudes from the first place on, ``(links + 1, 3, 3)``, at distances of so many in all.

    Of a rod they are matrices of attitude and place, ``(links + 1, 4, 4)``.
    """
    length, size = _length_of(strand), 4 if strand.is_rod else 3
    pieces = ceil(STEPS / equal)
    h = Fraction(1, equal * pieces)
    begins = [first + n * h for n in range(links * pieces)]
    nodes = []
    for node in NODES:
        strains = _evaluate(strand, strand.strain.name, (s + h * Fraction(node) for s in begins))
        turning = np.zeros((size, size, len(begins)))
        turning[:3, :3] = dense.hat(tuple(strains.T[:3]))
        if strand.is_rod:
            turning[:3, 3] = strains.T[3:]
        # from the left by columns, since then R' = R X: its transpose follows from the right
        order = (2, 1, 0) if strand.side == "left" else (2, 0, 1)
        nodes.append(float(h) * length * turning.transpose(order))
    frames = [np.eye(size)]
    for step in find_steps(nodes) if begins else ():  # none of a single body
        frames.append(step @ frames[-1])
    found: Array = np.array(frames[::pieces])
    return found.transpose(0, 2, 1) if strand.side == "left" else found
