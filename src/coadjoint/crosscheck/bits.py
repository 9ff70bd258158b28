"""Cross-check, bits: targets against NumPy, bit for bit.

Comes in: a `Subject`. Goes out: at how many points each target was equal, or a `CrossCheckError`
that shows the point and the two values.
Read next: `coadjoint.crosscheck.ladder`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from coadjoint.array_types import Array
from coadjoint.crosscheck.points import ODD_SIZES, Batch, Points
from coadjoint.crosscheck.subject import Subject
from coadjoint.elementary import ELEMENTARY
from coadjoint.lower.evaluation import evaluate, settled
from coadjoint.render.kernels import find_chunk
from coadjoint.render.solvers import count_unknowns
from coadjoint.render.targets import BUILDS

#: Members of a family compared at a time: few enough for the cache.
BLOCK: Final = 5000
#: Numbers that a function may give for the members of one batch: of those with more rows, such as
#: the Jacobian of a hundred masses, the first members are compared.
NUMBERS: Final = 8_000_000
#: Operations and outputs of a slow target in each batch, all its members together.
SLOW_WORK: Final = 4000
#: The last of many members, which are compared; one of them is beyond a chunk of NumPy's.
LAST: Final = 64


def equal_bits(subject: Subject, count: int) -> dict[str, dict[str, int]]:
    """Compare every exact target with NumPy bit for bit; NaN equals NaN, and 0 is not -0.

    Args:
        subject: The system; what calls functions beyond sqrt is not compared, since their last
            bits belong to the libraries (`against_oracle` holds them to the threshold).
        count: How many points for each function, besides odd batches and special values; of a
            slow target the first members of each batch.

    Returns:
        Points compared by function and target, those where all is NaN left out; all of them were
        equal.

    Raises:
        CrossCheckError: Two results differ in a bit.
    """
    equal = {function: dict.fromkeys(subject.exact, 0) for function in subject.programs}
    functions = [function for function in equal if subject.has_equal_bits(function)]
    for batch in _bit_batches(subject.points, count) if functions and subject.exact else ():
        _compare_bits(subject, functions, batch, equal)
    missing = [function for function in functions if not all(equal[function].values())]
    if missing and subject.inside.size:
        _compare_bits(subject, missing, subject.points.draw_around(subject.inside, 5, BLOCK), equal)
    return equal


def _compare_bits(
    subject: Subject, functions: Sequence[str], batch: Batch, equal: dict[str, dict[str, int]]
) -> None:
    """Compare one batch bit for bit, and count what was equal."""
    for function in functions:
        most = max(1, NUMBERS // len(subject.programs[function].outputs))
        held = batch.take(slice(most)) if batch.size > most else batch
        one = subject.evaluate(function, held, "numpy")
        for target in subject.exact:
            own, expected = _expect(subject, function, target, held, one)
            other = subject.evaluate(function, own, target)
            different = find_differing_bits(expected, other)
            if different.any():
                row, member = np.argwhere(different)[0].tolist()
                pair = {"numpy": float(expected[row, member]), target: float(other[row, member])}
                raise subject.failure(function, row, own, member, rung=5, **pair)
            equal[function][target] += int((~np.isnan(other)).any(axis=0).sum())


def compare_chunks(subject: Subject) -> int:
    """Compare members beyond those that NumPy evaluates at a time with the same members alone.

    Returns:
        Members compared, those without a value left out; the functions share one loop, so that of
        the rates is compared.

    Raises:
        CrossCheckError: A member has other rates among many, by more than roundings.
    """
    size = find_chunk(count_unknowns(subject.programs.values())) + 1
    points = subject.points
    compared = _compare_chunks(subject, points.draw("random", 77, size))
    if not compared and subject.inside.size:
        compared = _compare_chunks(subject, points.draw_around(subject.inside, 77, size))
    return compared


def _compare_chunks(subject: Subject, batch: Batch) -> int:
    compared = 0
    for varied in _vary_sharing(iter([batch])):
        few = varied.take(slice(-LAST, None))
        among = subject.evaluate("rhs", varied, "numpy")[:, -LAST:]
        alone = subject.evaluate("rhs", few, "numpy")
        most = np.abs(alone[np.isfinite(alone)]).max(initial=0.0)
        close = np.isclose(among, alone, rtol=1e-9, atol=1e-9 * most, equal_nan=True)
        if not close.all():
            row, member = np.argwhere(~close)[0].tolist()
            pair = {"among": float(among[row, member]), "alone": float(alone[row, member])}
            raise subject.failure("rhs", row, few, member, rung=5, **pair)
        compared += int((~np.isnan(alone)).any(axis=0).sum())
    return compared


def _expect(
    subject: Subject, function: str, target: str, batch: Batch, numpy: Array
) -> tuple[Batch, Array]:
    """The members of a batch that a target computes, and what it is to have there."""
    language = BUILDS[target]
    if language.is_slow:
        most = max(1, SLOW_WORK // subject.work[function])
        batch, numpy = batch.take(slice(most)), numpy[:, :most]
    if language.stops_at_poles:
        numpy = np.where(_has_numbers(subject, function, batch), numpy, np.nan)
    return batch, np.ascontiguousarray(numpy)


@dataclass(slots=True)
class _Stopping:
    """A value that notes where its language would stop; an arithmetic for `evaluate`.

    Attributes:
        value: For each member, or of all.
        goes_on: For each member, whether every operation up to now has a number.
    """

    value: Any
    goes_on: NDArray[np.bool_]

    def __add__(self, other: _Stopping) -> _Stopping:
        return _Stopping(self.value + other.value, self.goes_on)

    def __mul__(self, other: _Stopping) -> _Stopping:
        return _Stopping(self.value * other.value, self.goes_on)

    def __truediv__(self, other: _Stopping) -> _Stopping:
        self.goes_on[...] &= other.value != 0
        return _Stopping(self.value / other.value, self.goes_on)

    def __neg__(self) -> _Stopping:
        return _Stopping(-self.value, self.goes_on)


def _has_numbers(subject: Subject, function: str, batch: Batch) -> NDArray[np.bool_]:
    """For each member, whether nothing is divided by zero and no root is of a negative number.

    A quotient by zero stops a language that has no infinity even where it is infinity's
    reciprocal that is wanted.
    """
    goes_on = np.ones(batch.size, dtype=bool)
    statements, others = subject.stopping[function]

    def number(value: Fraction) -> _Stopping:
        return _Stopping(np.float64(value), goes_on)

    def apply(function: str, of: _Stopping) -> _Stopping:
        if function == "sqrt":
            goes_on[...] &= ~(of.value < 0)
        return _Stopping(getattr(np, ELEMENTARY[function].numpy_name)(of.value), goes_on)

    rows = subject.values(batch) if statements or others else {}
    known: dict[str, Any] = {name: _Stopping(row, goes_on) for name, row in rows.items()}
    with np.errstate(all="ignore"):
        for each in statements:
            value = evaluate(each.value, known, number, apply)
            known[each.name] = settled(each.name, value)
        for node in others:
            evaluate(node, known, number, apply)
    return goes_on


def _bit_batches(points: Points, count: int) -> Iterator[Batch]:
    """Blocks of every family, special values and odd sizes; parameters shared in every other."""
    yield from _vary_sharing(points.draw_special(seed, size) for seed, size in enumerate(ODD_SIZES))
    yield from _vary_sharing(iter([points.draw_special(99, BLOCK)]))
    quarter = -(-count // 4)
    for seed in range(-(-quarter // BLOCK)):
        size = min(BLOCK, quarter - seed * BLOCK)
        for number, batch in enumerate(points.families(seed + 10, size).values()):
            yield batch.share("parameters") if (seed + number) % 2 else batch


def _vary_sharing(batches: Iterator[Batch]) -> Iterator[Batch]:
    """Each batch with parameters of its own and with shared ones; inputs and time likewise."""
    for batch in batches:
        yield batch
        yield batch.share("parameters")
        if batch.driving:
            yield batch.share(*batch.driving)
            yield batch.share("parameters", *batch.driving)


def find_differing_bits(one: Array, other: Array) -> NDArray[np.bool_]:
    """Where two arrays differ in their bits, NaN apart.

    >>> find_differing_bits(np.array([0.0, np.nan, 1.0]), np.array([-0.0, -np.nan, 1.0])).tolist()
    [True, False, False]
    """
    different = one.view(np.int64) != other.view(np.int64)
    return np.asarray(different & ~(np.isnan(one) & np.isnan(other)))
