"""Cross-check, comparing: kernels against the equations to 50 digits.

Comes in: a `Subject`, the functions of one system in every form. Goes out: figures, or a
`CrossCheckError` that shows the point and the two values. There is no absolute tolerance anywhere:
with one, 1e-9 and 2e-9 would be close.
Read next: `coadjoint.crosscheck.bits`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from coadjoint.array_types import Array
from coadjoint.crosscheck.columns import find_exact
from coadjoint.crosscheck.hard import BATCHES, draw_usable, hard_batches
from coadjoint.crosscheck.oracle import Bounded, distance_in_envelopes, errors
from coadjoint.crosscheck.points import Batch
from coadjoint.crosscheck.subject import Subject
from coadjoint.errors import CrossCheckError

#: Points that are drawn in addition, for each without a value, where half of all have none.
OTHERS: Final = 4


@dataclass(frozen=True)
class Figures:
    """Errors of one function of one target against 50 digits.

    Attributes:
        k: Largest error in units of 2^-53 times the envelope.
        ulp: Largest error in units of the last place, where terms do not cancel.
        points: Points at which the equations have a value.
    """

    k: float
    ulp: float
    points: int


@dataclass(frozen=True)
class ExactPoints:
    """Points of one function with its outputs to 50 digits there.

    Attributes:
        function: Which function.
        batches: Points with the exact outputs of each member that has a value.
    """

    function: str
    batches: Sequence[tuple[Batch, Mapping[int, list[Bounded]]]]

    @property
    def count(self) -> int:
        """How many points were drawn."""
        return sum(batch.size for batch, _ in self.batches)


@dataclass(frozen=True)
class Agreement:
    """What comparing one function with the equations found.

    Attributes:
        figures: Errors by target.
        together: Points at which each exact target was compared with NumPy, where their bits may
            differ; none where bits are promised.
    """

    figures: Mapping[str, Figures]
    together: Mapping[str, int]


def exact_points(subject: Subject, function: str, count: int) -> ExactPoints:
    """The equations at random and at hard points, which needs no compiled kernel yet.

    Args:
        subject: The system.
        function: Which function.
        count: How many points, at the least.
    """
    batches = list(hard_batches(subject, function, -(-count // BATCHES)))
    parts = [subject.columns(batch) for batch in batches]
    rows = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    known, first, found = find_exact(subject.reference, function, rows), 0, []
    for batch in batches:
        members = {n: known[first + n] for n in range(batch.size) if first + n in known}
        found.append((batch, members))
        first += batch.size
    missing = first - len(known)
    if missing > len(known):  # rounding decides whether there is a value, as beyond a clamp
        others = draw_usable(subject, function, OTHERS * missing)
        more = find_exact(subject.reference, function, subject.columns(others))
        usable = sorted(more)[:missing]
        members = {n: more[member] for n, member in enumerate(usable)}
        found.append((others.take(np.array(usable, dtype=np.intp)), members))
    return ExactPoints(function, found)


def against_oracle(subject: Subject, points: ExactPoints) -> Agreement:
    """Compare every target of one function with the equations.

    Args:
        subject: The system.
        points: What `exact_points` computed.

    Raises:
        CrossCheckError: An error is above the threshold, or fewer than half of the points can be
            evaluated at all.
    """
    function = points.function
    apart = () if subject.has_equal_bits(function) else subject.exact
    together = dict.fromkeys(apart, 0)
    worst = {target: Figures(0.0, 0.0, 0) for target in subject.targets}
    for batch, known in points.batches:
        results = {each: subject.evaluate(function, batch, each) for each in subject.targets}
        for member, exact in known.items():
            measure = _measure(exact)
            for target, values in results.items():
                errors = [
                    measure(row, value) for row, value in enumerate(values[:, member].tolist())
                ]
                _check_threshold(subject, function, target, values, errors, exact, batch, member)
                worst[target] = _add_point(worst[target], errors)
            for target in apart:
                _check_together(subject, function, target, results, exact, batch, member)
                together[target] += 1
    _check_reached(subject, points, min((each.points for each in worst.values()), default=0))
    return Agreement(worst, together)


def _check_reached(subject: Subject, points: ExactPoints, reached: int) -> None:
    """Rung 4 rests on points: half of those that were drawn, and never on none."""
    if 2 * reached < points.count or not reached:
        raise CrossCheckError(
            f"rung 4: {subject.system.name}.{points.function} has a value at only {reached} of "
            f"{points.count} points; expected half of them at least. Declare which parameters are "
            "positive, say in [domain] where the formulas have values, or give defaults there.",
            rung=4,
            system=subject.system.name,
            function=points.function,
            found=reached,
            expected=points.count,
        )


def _measure(exact: list[Bounded]) -> Callable[[int, float], tuple[float, float]]:
    """Measures k and ulp of a value in a row; targets mostly agree, so each value is done once."""

    @cache
    def measure(row: int, value: float) -> tuple[float, float]:
        if value == 0 and not exact[row].envelope:  # most entries of a large Jacobian
            return 0.0, 0.0
        return errors(value, exact[row])

    return measure


def _check_threshold(
    subject: Subject,
    function: str,
    target: str,
    values: Array,
    errors: list[tuple[float, float]],
    exact: list[Bounded],
    batch: Batch,
    member: int,
) -> None:
    """Rung 4 for one member: no k is above the threshold; the failure shows the largest."""
    k, row = max((k, row) for row, (k, _) in enumerate(errors))
    if not k <= subject.threshold:
        pair = {target: float(values[row, member]), "exact": float(exact[row].value)}
        limits = {"k": k, "threshold": subject.threshold}
        raise subject.failure(function, row, batch, member, rung=4, **pair, **limits)


def _add_point(figures: Figures, errors: list[tuple[float, float]]) -> Figures:
    """Figures with one more point."""
    ks, ulps = zip(*errors, strict=True)
    return Figures(max(figures.k, *ks), max(figures.ulp, *ulps), figures.points + 1)


def _check_together(
    subject: Subject,
    function: str,
    target: str,
    results: Mapping[str, Array],
    exact: list[Bounded],
    batch: Batch,
    member: int,
) -> None:
    """Rung 5 where bits are not promised: NumPy and a target are within the threshold.

    Rung 4 alone lets them be twice as far apart, one on either side of the exact value.
    """
    for row, bounded in enumerate(exact):
        one, other = (float(results[each][row, member]) for each in ("numpy", target))
        k = distance_in_envelopes(one, other, bounded)
        if not k <= subject.threshold:
            values = {"numpy": one, target: other, "k": k, "threshold": subject.threshold}
            raise subject.failure(function, row, batch, member, rung=5, **values)
