"""Frozen brackets: the Lie-Poisson bracket with the momentum fixed, compatible with it.

Comes in: an algebra and a point of its dual. Goes out: a `PoissonStructure` with constant entries.
Read next: `coadjoint.poisson.brackets`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from coadjoint.algebra import LieAlgebra
from coadjoint.exact import Field
from coadjoint.poisson.brackets import Number, lie_poisson
from coadjoint.poisson.structure import PoissonStructure, antisymmetric


def freeze_bracket(
    algebra: LieAlgebra,
    field: Field,
    names: Sequence[str],
    point: Sequence[Number],
    sign: int = -1,
    cocycle: Mapping[tuple[int, int], Number] | None = None,
) -> PoissonStructure:
    """``{mu_i, mu_j} = -+ c_ij^k p_k + w_ij`` with a fixed point p: the frozen-argument bracket.

    It is compatible with the Lie-Poisson bracket of the same sign, where w is a 2-cocycle or left
    out; `compatible_sum` proves it.
    """
    moving = lie_poisson(algebra, field, names, sign).tensor
    fixed = dict(zip(names, field.vector(point), strict=True))
    entries = {
        (i, j): field.substitute(moving[i][j], fixed) + (cocycle or {}).get((i, j), 0)
        for i in range(len(names))
        for j in range(i + 1, len(names))
    }
    tensor = antisymmetric(field, len(names), entries)
    return PoissonStructure(field, tuple(names), tensor, f"frozen bracket of {algebra.name}")
