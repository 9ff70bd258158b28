"""Cross-check, points of a domain: where kernels are compared if few random points have values.

Comes in: Equations. Goes out: points at which ``[domain]`` holds and every square root and
logarithm has a value, as `coadjoint.prove.points` finds them.
Read next: `coadjoint.crosscheck.points`, which draws others near them.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain, islice
from typing import Any

import numpy as np

from coadjoint.array_types import Array
from coadjoint.derive import Equations
from coadjoint.derive.domain import region
from coadjoint.derive.setting import once
from coadjoint.prove.points import Points

#: Points that are found; others are drawn near them.
CENTRES = 8


@once
def list_centres(equations: Equations) -> list[dict[str, Any]]:
    """Points of a domain, which are looked for once."""
    field = equations.setting.field
    field.region = region(equations)
    source = Points(field, ())
    return list(islice(chain(source.near_defaults(), source), CENTRES))


def points_inside(equations: Equations, names: Sequence[str]) -> Array:
    """Points of a domain, shape ``(names, N)``; NaN for what the domain does not depend on."""
    rows = [[float(at.get(name, np.nan)) for name in names] for at in list_centres(equations)]
    return np.array(rows, dtype=np.float64).reshape(-1, len(names)).T
