"""Semidefinite matrices: whether a symmetric matrix of functions has no negative eigenvalue.

Comes in: the matrix. Goes out: a decision. A symmetric matrix is positive semidefinite exactly if
no principal minor is negative; each minor is a sum of squares and positive terms, or has a sign by
`coadjoint.exact.signs`. Where that does not tell, eigenvalues at points do: a negative one refutes.
Read next: `coadjoint.prove.zero`.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from itertools import combinations

import mpmath

from coadjoint.derive.mechanics.configuration import coupled_blocks
from coadjoint.exact import Element, Field
from coadjoint.exact.dense import minor
from coadjoint.exact.signs import sign
from coadjoint.prove.certificate import Shown, Verdict
from coadjoint.prove.points import DIGITS, Points, real
from coadjoint.prove.zero import ADVICE, Decision, UndecidedError, show_point

Matrix = Sequence[Sequence[Element]]

#: Size of the largest block of coupled places whose minors are looked at.
LARGEST = 6
#: Points at which eigenvalues are looked at.
POINTS = 20
#: Size of an eigenvalue, relative to the largest entry, below which it counts as rounding.
ROUNDING = mpmath.mpf(10) ** -30


def decide_semidefinite(matrix: Matrix, ring: Field) -> Decision:
    """Whether no ``<v, G v>`` is negative, wherever a matrix G is defined.

    Args:
        matrix: G, of which only twice the symmetric part is looked at.
        ring: Where its entries live.

    Raises:
        UndecidedError: It is not proved, and no point is found at which it has a value.
    """
    size = range(len(matrix))
    named = "G" if all(matrix[i][j] == matrix[j][i] for i in size for j in range(i)) else "G + G^T"
    doubled = tuple(tuple(matrix[i][j] + matrix[j][i] for j in size) for i in size)
    blocks = coupled_blocks(doubled)
    if all(_has_no_negative_minor(ring, doubled, block) for block in blocks):
        method = f"no principal minor of {named} is negative: sums of squares and of positive terms"
        return Decision(verdict=Verdict.PROVED, method=method)
    entries = [entry for row in doubled for entry in row]
    points, seen = Points(ring, entries), 0
    for point in points:
        with mpmath.workdps(DIGITS), suppress(ZeroDivisionError, ValueError, OverflowError):
            values = mpmath.matrix([[real(points.value(e, point)) for e in row] for row in doubled])
            least = min(mpmath.eigsy(values / 2, eigvals_only=True))
            seen += 1
            if least < -ROUNDING * max(map(abs, values)):
                method = f"{DIGITS}-digit eigenvalues"
                shown = show_point(points, point)
                return Decision(
                    verdict=Verdict.REFUTED,
                    method=method,
                    point=shown,
                    defect=mpmath.nstr(least, 15),
                    shown=Shown.EIGENVALUE,
                )
        if seen == POINTS:
            break
    if not seen:
        raise UndecidedError(f"no point is found at which G has a value. {ADVICE}")
    return Decision(
        verdict=Verdict.SUPPORTED, method=f"{DIGITS}-digit eigenvalues at {seen} random points"
    )


def _has_no_negative_minor(ring: Field, matrix: Matrix, block: Sequence[int]) -> bool:
    """Whether each principal minor of a block is zero or has a positive sign."""
    if len(block) > LARGEST:
        return False
    for size in range(1, len(block) + 1):
        for chosen in combinations(block, size):
            value = minor(matrix, chosen, chosen)
            if not ring.is_zero(value) and sign(ring, value, strict=False) != 1:
                return False
    return True
