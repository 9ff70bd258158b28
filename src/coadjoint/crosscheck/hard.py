"""Cross-check, hard points: the batches at which one function is compared with the equations.

Comes in: a `Subject` and a function. Goes out: batches of every family, as many of their members as
possible with a value.
Read next: `coadjoint.crosscheck.compare`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from coadjoint.crosscheck.points import Batch, cancelling
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
    for family in subject.points.families(seed=0, count=1):
        yield _draw(subject, function, family, 0, size)
    start = _draw(subject, function, "random", 1, size)
    alike = _alike(subject.points.families(2, size)["random"], start)
    yield _complete(
        subject, function, alike, lambda count: _alike(_others(subject, "random", count), start)
    ).with_shared_parameters()
    if start.driving:
        calm = _calm(subject.points.families(4, size)["random"], start)
        yield _complete(
            subject, function, calm, lambda count: _calm(_others(subject, "random", count), start)
        ).steady()
    yield cancelling(lambda batch: subject.evaluate(function, batch, "numpy"), start, seed=2)


def _draw(subject: Subject, function: str, family: str, seed: int, size: int) -> Batch:
    """A batch of a family, as many of its members as possible with a value."""
    batch = subject.points.families(seed, size)[family]
    return _complete(subject, function, batch, lambda count: _others(subject, family, count))


def _others(subject: Subject, family: str, count: int) -> Batch:
    """More points of a family, apart from those that are taken first, and points of the domain."""
    more = subject.points.families(seed=3, count=count)[family]
    if not subject.inside.size:
        return more
    near = subject.points.around(subject.inside, seed=3, count=count)
    return Batch(
        np.concatenate([more.state, near.state], axis=1),
        np.concatenate([more.parameters, near.parameters], axis=1),
        {name: np.concatenate([a, near.driving[name]], axis=1) for name, a in more.driving.items()},
    )


def _alike(batch: Batch, start: Batch) -> Batch:
    """The states of a batch, all with the parameters of one member of another."""
    members = batch.state.shape[1]
    return replace(batch, parameters=np.repeat(start.parameters[:, :1], members, axis=1))


def _calm(batch: Batch, start: Batch) -> Batch:
    """The states and parameters of a batch, all with inputs and time of one member of another."""
    members = batch.state.shape[1]
    driving = {name: np.repeat(a[:, :1], members, axis=1) for name, a in start.driving.items()}
    return replace(batch, driving=driving)


def _complete(
    subject: Subject, function: str, batch: Batch, others: Callable[[int], Batch]
) -> Batch:
    """A batch whose members without a value are replaced by others with one, as far as they go."""
    missing = np.flatnonzero(~subject.is_defined(function, batch))
    if not missing.size:
        return batch
    more = others(TRIES * batch.state.shape[1])
    found = np.flatnonzero(subject.is_defined(function, more))[: missing.size]
    return batch.with_members(missing[: found.size], more.members(found))
