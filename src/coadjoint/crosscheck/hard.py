"""Cross-check, hard points: the batches at which one function is compared with the equations.

Comes in: a `Subject` and a function. Goes out: batches of every family, as many of their members as
possible with a value.
Read next: `coadjoint.crosscheck.compare`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, Final

import numpy as np

from coadjoint.crosscheck.points import FAMILIES, Batch, move_to_cancellation
from coadjoint.crosscheck.subject import Subject

#: Points that are drawn, for each that is asked for, to find some at which a function has a value.
TRIES: Final = 64
#: Batches of a system that nothing drives.
BATCHES: Final = 6


def hard_batches(subject: Subject, function: str, share: int) -> Iterator[Batch]:
    """Each family, one with shared parameters, and one where one output nearly cancels.

    Of driven systems also one with shared inputs and time.

    They end in the middle of a vector register, as the sizes are odd.
    """
    size = share | 1
    for family in FAMILIES:
        yield _draw(subject, function, family, 0, size)
    start = _draw(subject, function, "random", 1, size)
    for seed, names in ((2, ("parameters",)), (4, start.driving)):
        if names:  # time and inputs of driven systems alone
            batch = subject.points.draw("random", seed, size).repeat(start, *names)
            others = partial(_draw_others, subject, "random", like=(start, *names))
            yield _complete(subject, function, batch, others).share(*names)
    yield move_to_cancellation(
        lambda batch: subject.evaluate(function, batch, "numpy"), start, seed=2
    )


def draw_usable(subject: Subject, function: str, count: int) -> Batch:
    """Other points at which the equations give numbers in doubles, at most so many."""
    more = _draw_others(subject, "random", 2 * count)
    return more.take(np.flatnonzero(subject.is_defined(function, more))[:count])


def _draw(subject: Subject, function: str, family: str, seed: int, size: int) -> Batch:
    """A batch of a family, as many of its members as possible with a value."""
    batch = subject.points.draw(family, seed, size)
    return _complete(subject, function, batch, partial(_draw_others, subject, family))


def _draw_others(subject: Subject, family: str, count: int, like: Any = ()) -> Batch:
    """More points of a family, apart from those that are taken first, and points of the domain.

    Args:
        subject: The system.
        family: Which family.
        count: How many of each.
        like: Another batch, and what its first member gives to all.
    """
    more = subject.points.draw(family, seed=3, count=count)
    if subject.inside.size:
        more = more.join(subject.points.draw_around(subject.inside, seed=3, count=count))
    return more.repeat(*like) if like else more


def _complete(
    subject: Subject, function: str, batch: Batch, others: Callable[[int], Batch]
) -> Batch:
    """A batch whose members without a value are replaced by others with one, as far as they go."""
    missing = np.flatnonzero(~subject.is_defined(function, batch))
    if not missing.size:
        return batch
    more = others(TRIES * batch.size)
    usable = np.flatnonzero(subject.is_defined(function, more))[: missing.size]
    return batch.with_members(missing[: usable.size], more.take(usable))
