r"""Central differences on a circle: their coefficients, exactly.

.. math:: h^k (D_k f)_j = \sum_r c_r f_{j+r} = h^k \partial_s^k f + O(h^{k + p})

with the fewest points for an order p. Those of an odd derivative are antisymmetric,
:math:`c_{-r} = -c_r`, and those of an even one symmetric: so is the matrix on a circle, and sums by
parts are those of integrals. Comes in: a derivative and an order. Goes out: fractions.
Read next: `coadjoint.derive.fields.grid`.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from functools import cache
from math import cos, factorial, pi, sin
from typing import Final

from coadjoint.exact.linear import Span

#: Waves that are tried for the largest one, whose size is then right to 7 digits.
ANGLES: Final = 1 << 12


def width_of(derivative: int, order: int) -> int:
    """How many points a difference reads on each side.

    >>> [width_of(k, 4) for k in (0, 1, 2, 3)]
    [0, 2, 2, 3]
    """
    return (derivative + 1) // 2 + order // 2 - 1 if derivative else 0


def find_largest(derivative: int, order: int) -> float:
    """The most by which a difference times ``h^k`` multiplies a wave, to 6 digits.

    >>> find_largest(1, 2), find_largest(1, 4), find_largest(2, 4)
    (1.0, 1.37222, 5.33333)
    """
    turn, known = (cos, sin)[derivative % 2], stencil(derivative, order)
    angles = (pi * n / ANGLES for n in range(ANGLES + 1))
    sizes = (abs(sum(float(c) * turn(r * a) for r, c in known.items())) for a in angles)
    return float(f"{max(sizes):.6g}")


@cache
def stencil(derivative: int, order: int) -> Mapping[int, Fraction]:
    """The coefficients c_r, zeros left out.

    They solve ``sum c_r r^n = n!`` for n the derivative, and 0 for the other n up to twice the
    width, by which Taylor's expansion gives the derivative.

    >>> {r: str(c) for r, c in stencil(1, 4).items()}, stencil(0, 4)
    ({-2: '1/12', -1: '-2/3', 1: '2/3', 2: '-1/12'}, {0: Fraction(1, 1)})
    """
    width = width_of(derivative, order)
    places = range(-width, width + 1)
    # rows of the transposed system: what each point adds to the moments 0, 1, ..., 2 width
    span = Span({n: Fraction(r) ** n for n in range(2 * width + 1) if r or not n} for r in places)
    found = span.coordinates({derivative: Fraction(factorial(derivative))})
    assert found is not None, (derivative, order)
    return {r: c for n, r in enumerate(places) if (c := Fraction(found.get(n, 0)))}
