"""Budgets: how much work one derivation, or one search inside it, may cost.

Comes in: a number of seconds, from a caller, the environment variable ``COADJOINT_SECONDS`` or
`coadjoint.limits`. Goes out: seconds of processor time for a bounded child (`allowed_seconds`), or
an object that a search asks whether to go on (`Budget`). Wall time enters neither, so that a
machine that is busy with other work changes no result.
"""

from __future__ import annotations

import math
import os
from time import thread_time
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


class Budget:
    """What one search may cost; it asks `spent` between its steps and then ends in order.

    Two bounds, the first that is reached counts. ``steps`` counts units of work that the search
    names itself (`take`): the same search stops at the same place everywhere, so prefer it.
    ``seconds`` is processor time of the calling thread: it differs between machines and runs.
    Therefore nothing that depends on ``seconds`` may enter a generated file, except the remark that
    something was "not searched further".

    Args:
        seconds: Processor time from now on.
        steps: Units of work, or None for no such bound.

    >>> budget = Budget(seconds=60, steps=2)
    >>> [budget.take() for _ in range(3)]
    [True, True, False]
    >>> budget.spent()
    True
    """

    def __init__(self, seconds: float, steps: int | None = None) -> None:
        self.seconds, self.steps = seconds, steps
        self.taken = 0
        self._start = thread_time()
        self._spent = False

    def take(self, steps: int = 1) -> bool:
        """Ask for units of work before doing them; False if they would pass a bound."""
        if self.steps is not None and self.taken + steps > self.steps:
            self._spent = True
        if self.spent():
            return False
        self.taken += steps
        return True

    def used(self) -> float:
        """Seconds of processor time since the budget was made."""
        return thread_time() - self._start

    def spent(self) -> bool:
        """Whether a bound was reached; what is spent stays spent."""
        self._spent = self._spent or self.used() >= self.seconds
        return self._spent
