"""Cross-check, comparing: kernels against 50 digits, and NumPy against exact C bit for bit.

Comes in: a `Subject`, the functions of one system in every form. Goes out: figures, or a
`CrossCheckError` that shows the point and the two values. There is no absolute tolerance anywhere:
with one, 1e-9 and 2e-9 would be close.
Read next: `coadjoint.crosscheck.ladder`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from coadjoint.crosscheck.inside import points_inside
from coadjoint.crosscheck.oracle import (
    Bounded,
    OutsideDomain,
    Reference,
    distance_in_envelopes,
    error_in_envelopes,
    error_in_ulp,
    oracle,
)
from coadjoint.crosscheck.points import ODD_SIZES, Array, Batch, Points, cancelling, safe_exponent
from coadjoint.derive.reference import Reference as Derived
from coadjoint.errors import CoadjointError, CrossCheckError
from coadjoint.lower.program import Program, run
from coadjoint.render.kernels import elementary_functions

#: Largest k of + - * / sqrt, and of kernels that call other functions (measured: 2.8 and 7.1).
K_ARITHMETIC: Final = 4.0
K_ELEMENTARY: Final = 16.0
#: Members compared at a time: few enough for the cache.
BLOCK: Final = 10_000
#: What results hold before a kernel writes them: a member that it leaves out keeps this number.
UNTOUCHED: Final = -1.2345678901234567e-89
#: Points that are drawn, for each that is asked for, to find some at which a function has a value.
TRIES: Final = 64
#: Batches at which one function is compared with the equations.
BATCHES: Final = 6


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
class _Levels:
    """How many operations follow one another up to a value; an arithmetic for `run`."""

    count: int

    def __add__(self, other: _Levels) -> _Levels:
        return _Levels(max(self.count, other.count) + 1)

    __mul__ = __truediv__ = __add__

    def __neg__(self) -> _Levels:
        return self


def depth(program: Program) -> int:
    """The most operations that follow one another in a Program: no k is above it to first order.

    The error of a sum is at most those of its addends and one rounding, and its envelope is the sum
    of theirs: k grows by 1 at most. The same holds for a product, a quotient and a function.
    """
    inputs = dict.fromkeys(program.names, _Levels(0))
    outputs = run(program, inputs, _constant, lambda _, of: _Levels(of.count + 1))
    return max(output.count for output in outputs)


def _constant(value: Fraction) -> _Levels:
    """A constant is rounded once, unless it is a double."""
    return _Levels(int(Fraction(float(value)) != value))


@dataclass(frozen=True)
class Subject:
    """One system in every form that is compared.

    Attributes:
        programs: Its functions by name.
        reference: Its equations.
        system: The loaded system.
        targets: The targets to evaluate.
    """

    programs: Mapping[str, Program]
    reference: Reference
    system: Any
    targets: tuple[str, ...]

    @cached_property
    def elementary(self) -> bool:
        """Whether functions beyond sqrt are called anywhere."""
        return bool(elementary_functions(self.programs.values()))

    def has_equal_bits(self, function: str) -> bool:
        """Whether a function calls nothing beyond sqrt, so that its bits are promised."""
        return not elementary_functions([self.programs[function]])

    @cached_property
    def threshold(self) -> float:
        """The largest k allowed.

        A k above the `depth` is impossible to first order, and one near it is rare, so that short
        formulas are held to less.
        """
        allowed = K_ELEMENTARY if self.elementary else K_ARITHMETIC
        return max(allowed, *map(float, map(depth, self.programs.values())))

    @cached_property
    def points(self) -> Points:
        """Where the system is evaluated."""
        quantities = self.system.PARAMETERS.values()
        positive = tuple(each.positive for each in quantities for _ in each.components)
        states = len(self._widest.state)
        exponent = safe_exponent(self.programs, self.elementary)
        driving = {"inputs": len(self._widest.inputs), "time": len(self._widest.time)}
        counts = {name: count for name, count in driving.items() if count}
        return Points(states, positive, exponent, counts)

    @cached_property
    def inside(self) -> Array:
        """Points of the domain, each name of the widest function in a row; perhaps none."""
        names = self._widest.names
        if not isinstance(self.reference, Derived):
            return np.empty((len(names), 0))
        return points_inside(self.reference.equations, names)

    @property
    def _widest(self) -> Program:
        """A function with the most inputs; those of the others are the first of them."""
        return max(self.programs.values(), key=lambda program: len(program.state))

    def evaluate(self, function: str, batch: Batch, target: str) -> Array:
        """The outputs of one function, ``(rows, N)``.

        Raises:
            CrossCheckError: The kernel raised an error.
        """
        program, members = self.programs[function], batch.state.shape[1]
        given, named = batch.arguments(len(program.state))
        values = np.full((*program.shape, members), UNTOUCHED)
        try:
            getattr(self.system, function)(*given, **named, target=target, out=values)
        except CoadjointError:
            raise
        except Exception as error:
            raise CrossCheckError(
                f"rung 4: {self.system.name}.{function} of the target {target} does not run: "
                f"{type(error).__name__}: {error}. The printer or the template is wrong.",
                rung=4,
                system=self.system.name,
                function=function,
                target=target,
                found=f"{type(error).__name__}: {error}",
            ) from error
        return values.reshape(len(program.outputs), members)

    def is_defined(self, function: str, batch: Batch) -> NDArray[np.bool_]:
        """For each member, whether the equations, not a kernel, give numbers in doubles.

        So must the functions in them: the slope of ``log(x)`` has a value where x is negative.
        """
        known: dict[str, Any] = dict(zip(self._widest.names, batch.rows(), strict=True))
        called = list[Array]()

        def call(function: str, argument: Array) -> Array:
            called.append(np.asarray(getattr(np, function)(argument)))
            return called[-1]

        with np.errstate(all="ignore"):
            values = self.reference.evaluate(function, known, np.float64, call)
        found = np.ones(batch.state.shape[1], dtype=bool)
        for value in (*values, *called):
            found &= np.isfinite(value)
        return found

    def inputs(self, batch: Batch, member: int) -> dict[str, float]:
        """State, parameters, inputs and time of one member by name."""
        values = [float(row[member] if row.ndim else row) for row in batch.rows()]
        return dict(zip(self._widest.names, values, strict=True))

    def failure(
        self, function: str, row: int, batch: Batch, member: int, **parts: Any
    ) -> CrossCheckError:
        """A disagreement at one member; ``parts`` are the rung, the values and what was allowed."""
        output = self.programs[function].outputs[row].label
        point = {name: repr(value) for name, value in self.inputs(batch, member).items()}
        shown = ", ".join(f"{name} {value}" for name, value in parts.items() if name != "rung")
        where = ", ".join(f"{name} = {value}" for name, value in point.items())
        return CrossCheckError(
            f"rung {parts['rung']}: {self.system.name}.{function}, output {output}: {shown}; "
            f"at {where}. The kernel does not compute the equations: look at what changed last in "
            "lowering, printers, templates or compiler flags.",
            system=self.system.name,
            function=function,
            output=output,
            point=point,
            **parts,
        )


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
        return sum(batch.state.shape[1] for batch, _ in self.batches)


@dataclass(frozen=True)
class Agreement:
    """What comparing one function with the equations found.

    Attributes:
        figures: Errors by target.
        together: Points at which NumPy and exact C were compared with each other, where their bits
            may differ.
    """

    figures: Mapping[str, Figures]
    together: int


def exact_points(subject: Subject, function: str, count: int) -> ExactPoints:
    """The equations at random and at hard points, which needs no compiled kernel yet.

    Args:
        subject: The system.
        function: Which function.
        count: How many points, at the least.
    """
    batches = []
    for batch in _hard_batches(subject, function, -(-count // BATCHES)):
        exact = {}
        for member in range(batch.state.shape[1]):
            with suppress(OutsideDomain):
                inputs = subject.inputs(batch, member)
                exact[member] = oracle(subject.reference, function, inputs)
        batches.append((batch, exact))
    return ExactPoints(function, batches)


def against_oracle(subject: Subject, points: ExactPoints) -> Agreement:
    """Compare every target of one function with the equations.

    Args:
        subject: The system.
        points: What `exact_points` computed.

    Raises:
        CrossCheckError: An error is above the threshold, or fewer than half of the points can be
            evaluated at all.
    """
    function, together = points.function, 0
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
                worst[target] = _worse(worst[target], errors)
            if {"numpy", "c"} <= results.keys() and not subject.has_equal_bits(function):
                _check_together(subject, function, results, exact, batch, member)
                together += 1
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


def _hard_batches(subject: Subject, function: str, share: int) -> Iterator[Batch]:
    """Each family, one with shared parameters, and one where one output nearly cancels.

    Of driven systems also one with shared inputs and time.

    They end in the middle of a vector register, as the sizes are odd.
    """
    size = share | 1
    for family in subject.points.families(seed=0, count=1):
        yield _drawn(subject, function, family, 0, size)
    start = _drawn(subject, function, "random", 1, size)
    alike = _alike(subject.points.families(2, size)["random"], start)
    yield _completed(
        subject, function, alike, lambda count: _alike(_others(subject, "random", count), start)
    ).shared()
    if start.driving:
        calm = _calm(subject.points.families(4, size)["random"], start)
        yield _completed(
            subject, function, calm, lambda count: _calm(_others(subject, "random", count), start)
        ).steady()
    yield cancelling(lambda batch: subject.evaluate(function, batch, "numpy"), start, seed=2)


def _drawn(subject: Subject, function: str, family: str, seed: int, size: int) -> Batch:
    """A batch of a family, as many of its members as possible with a value."""
    batch = subject.points.families(seed, size)[family]
    return _completed(subject, function, batch, lambda count: _others(subject, family, count))


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


def _completed(
    subject: Subject, function: str, batch: Batch, others: Callable[[int], Batch]
) -> Batch:
    """A batch whose members without a value are replaced by others with one, as far as they go."""
    missing = np.flatnonzero(~subject.is_defined(function, batch))
    if not missing.size:
        return batch
    more = others(TRIES * batch.state.shape[1])
    found = np.flatnonzero(subject.is_defined(function, more))[: missing.size]
    return batch.with_members(missing[: found.size], more.members(found))


def _measure(exact: list[Bounded]) -> Callable[[int, float], tuple[float, float]]:
    """Measures k and ulp of a value in a row; targets mostly agree, so each value is done once."""

    @cache
    def measure(row: int, value: float) -> tuple[float, float]:
        if value == 0 and not exact[row].envelope:  # most entries of a large Jacobian
            return 0.0, 0.0
        return error_in_envelopes(value, exact[row]), error_in_ulp(value, exact[row])

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


def _worse(figures: Figures, errors: list[tuple[float, float]]) -> Figures:
    """Figures with one more point."""
    ks, ulps = zip(*errors, strict=True)
    return Figures(max(figures.k, *ks), max(figures.ulp, *ulps), figures.points + 1)


def _check_together(
    subject: Subject,
    function: str,
    results: Mapping[str, Array],
    exact: list[Bounded],
    batch: Batch,
    member: int,
) -> None:
    """Rung 5 where bits are not promised: NumPy and exact C are within the threshold.

    Rung 4 alone lets them be twice as far apart, one on either side of the exact value.
    """
    for row, bounded in enumerate(exact):
        one, other = (float(results[target][row, member]) for target in ("numpy", "c"))
        k = distance_in_envelopes(one, other, bounded)
        if not k <= subject.threshold:
            values = {"numpy": one, "c": other, "k": k, "threshold": subject.threshold}
            raise subject.failure(function, row, batch, member, rung=5, **values)


def equal_bits(subject: Subject, count: int) -> dict[str, int]:
    """Compare NumPy with exact C bit for bit; NaN equals NaN, and 0 is not -0.

    Args:
        subject: The system; what calls functions beyond sqrt is not compared, since their last
            bits belong to the libraries (`against_oracle` holds them to the threshold).
        count: How many points for each function, odd batches and special values beside them.

    Returns:
        Points compared by function, those where all is NaN left out; all of them were equal.

    Raises:
        CrossCheckError: Two results differ in a bit.
    """
    equal = dict.fromkeys(subject.programs, 0)
    functions = [function for function in equal if subject.has_equal_bits(function)]
    for batch in _bit_batches(subject.points, count) if functions else ():
        _compare_bits(subject, functions, batch, equal)
    if not all(equal[function] for function in functions) and subject.inside.size:
        _compare_bits(subject, functions, subject.points.around(subject.inside, 5, BLOCK), equal)
    return equal


def _compare_bits(
    subject: Subject, functions: Sequence[str], batch: Batch, equal: dict[str, int]
) -> None:
    """Compare one batch bit for bit, and count what was equal."""
    for function in functions:
        one, other = (subject.evaluate(function, batch, each) for each in ("numpy", "c"))
        different = differing(one, other)
        if different.any():
            row, member = np.argwhere(different)[0].tolist()
            values = {"numpy": float(one[row, member]), "c": float(other[row, member])}
            raise subject.failure(function, row, batch, member, rung=5, **values)
        equal[function] += int((~np.isnan(one)).any(axis=0).sum())


def _bit_batches(points: Points, count: int) -> Iterator[Batch]:
    """Blocks of every family, special values and odd sizes; parameters shared in every other."""
    yield from _both_ways(points.special(seed, size) for seed, size in enumerate(ODD_SIZES))
    yield from _both_ways(iter([points.special(99, BLOCK)]))
    for seed in range(-(-count // BLOCK)):
        quarter = -(-min(BLOCK, count - seed * BLOCK) // 4)
        for number, batch in enumerate(points.families(seed + 10, quarter).values()):
            yield batch.shared() if (seed + number) % 2 else batch


def _both_ways(batches: Iterator[Batch]) -> Iterator[Batch]:
    """Each batch with parameters of its own and with shared ones; inputs and time likewise."""
    for batch in batches:
        yield batch
        yield batch.shared()
        if batch.driving:
            yield batch.steady()
            yield batch.shared().steady()


def differing(one: Array, other: Array) -> NDArray[np.bool_]:
    """Where two arrays differ in their bits, NaN apart.

    >>> differing(np.array([0.0, np.nan, 1.0]), np.array([-0.0, -np.nan, 1.0])).tolist()
    [True, False, False]
    """
    different = one.view(np.int64) != other.view(np.int64)
    return np.asarray(different & ~(np.isnan(one) & np.isnan(other)))
