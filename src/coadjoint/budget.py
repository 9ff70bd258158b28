"""Budgets: how much processor time one derivation may take.

Comes in: a number of seconds, from a caller, the environment variable ``COADJOINT_SECONDS`` or
`coadjoint.limits`. Goes out: whole seconds for a bounded child (`coadjoint.sandbox`). A search in
a derivation is bounded by its work instead, counted in operations: time differs between machines,
and nothing that depends on it may enter a generated file.
"""

from __future__ import annotations

import math
import os
from typing import Final

from coadjoint import limits
from coadjoint.errors import ResourceError

#: The environment variable that raises the limit of every derivation.
VARIABLE: Final = "COADJOINT_SECONDS"
#: The most that can be asked for: four months, within what systems count in.
MOST: Final = 10_000_000


def allowed_seconds(given: float | None = None) -> int:
    """Whole seconds of processor time that one derivation may take.

    Args:
        given: What a caller asks for; None leaves it to ``COADJOINT_SECONDS``, else to
            ``WORKER_SECONDS`` of docs/limits.md. Fractions are rounded up.

    Raises:
        ResourceError: The number is none, not above 0, or above 10 000 000.

    >>> allowed_seconds(90.5)
    91
    """
    text = str(given) if given is not None else os.environ.get(VARIABLE, "").strip()
    if not text:
        return limits.WORKER_SECONDS
    try:
        seconds = float(text)
    except ValueError:
        seconds = math.nan
    if not 0 < seconds <= MOST:
        where = VARIABLE if given is None else "the limit of time"
        raise ResourceError(
            f"{where} is {text[:40]!r}; expected seconds of processor time, a number above 0 "
            f"and at most {MOST}.",
            found=text[:40],
            limit=MOST,
        )
    return math.ceil(seconds)
