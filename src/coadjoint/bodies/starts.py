r"""Where bodies begin: fields of the profiles, and attitudes that its strain turns into.

From the attitude 1 of the first body, :math:`\partial_s R = R\,\hat\Xi` is solved from body to body
by Magnus's steps of order 6. Around a ring this closes where the holonomy is 1 alone.

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

from coadjoint.derive.fields.profiles import evaluate_profile
from coadjoint.exact import dense
from coadjoint.solve.strands import NODES, find_steps

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.bodies.energy import Strand

    Array = NDArray[np.float64]

#: Steps along the strand, at least.
STEPS: Final = 64
#: How far from 1 the holonomy of a ring that closes may be, by rounding and by the error of steps.
CLOSED: Final = 1e-8


@dataclass(frozen=True)
class Starts:
    """Where bodies begin.

    Attributes:
        fields: Momenta and advected vectors ``(N, 3)`` by name, where they have profiles.
        attitudes: ``(N, 3, 3)``, or None where bodies stand alike.
        gap: How far the holonomy of the strain is from 1, where that keeps a ring from closing.
        wall: ``(3, 3)``, the attitude of the wall behind the last body, or None where it is 1.
    """

    fields: Mapping[str, Array]
    attitudes: Array | None = None
    gap: float = 0.0
    wall: Array | None = None


def find_starts(strand: Strand, bodies: int) -> Starts:
    """Momenta and attitudes of bodies, at equal distances, at defaults of the parameters.

    Bodies of a chain with free ends are in the middle of equal pieces. Between clamped ends they
    are at equal distances from one another and from the walls, the first of which has the attitude
    1.
    """
    spec, space = strand.spec, strand.spec.space
    assert space is not None, spec.name
    is_clamped = space.ends == "clamped"
    pieces = bodies + 1 if is_clamped else bodies
    first = Fraction(1, 2 * bodies) if space.ends == "free" else Fraction(0)
    places = [first + Fraction(n + is_clamped, pieces) for n in range(bodies)]
    fields = {
        each.name: _evaluate(strand, each.name, places)
        for each in (strand.momentum, *strand.advected)
        if each.name in spec.profiles
    }
    if strand.strain.name not in spec.profiles:
        return Starts(fields)
    links = bodies - 1 if space.ends == "free" else pieces  # a free chain has one less than a ring
    frames = _find_frames(strand, pieces, links, first)
    gap = 0.0 if space.has_ends else float(np.abs(frames[-1] - np.eye(3)).max())
    if gap > CLOSED:
        return Starts(fields, None, gap)
    if np.abs(frames - np.eye(3)).max() <= CLOSED:
        return Starts(fields)
    if is_clamped:
        return Starts(fields, frames[1:-1], wall=frames[-1])
    return Starts(fields, frames[:bodies])


def _evaluate(strand: Strand, name: str, places: Iterable[Fraction]) -> Array:
    """A field at parts of the way, a row for each."""
    rows = [evaluate_profile(strand.spec, name, part) for part in places]
    return np.array(rows, dtype=float)


def _find_frames(strand: Strand, equal: int, links: int, first: Fraction) -> Array:
    """Attitudes from the first place on, ``(links + 1, 3, 3)``, at distances of so many in all."""
    spec, space = strand.spec, strand.spec.space
    assert space is not None, spec.name
    (length,) = (each.default for each in spec.parameters if each.name == space.length)
    assert length is not None, space.length
    pieces = ceil(STEPS / equal)
    h = Fraction(1, equal * pieces)
    begins = [first + n * h for n in range(links * pieces)]
    nodes = []
    for node in NODES:
        strains = _evaluate(strand, strand.strain.name, (s + h * Fraction(node) for s in begins))
        turning: Array = np.array(dense.hat(tuple(strains.T)))
        # each matrix transposed
        nodes.append(float(h * length[0]) * turning.transpose(2, 1, 0))
    frames = [np.eye(3)]
    for step in find_steps(nodes) if begins else ():  # none of a single body
        frames.append(step @ frames[-1])
    # by columns: the transpose of R follows from the left
    return np.array(frames[::pieces]).transpose(0, 2, 1)
