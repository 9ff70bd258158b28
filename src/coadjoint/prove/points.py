r"""Points of a domain: where the values of functions are looked at.

Comes in: functions of the symbols of a field, and a `Branch` of a zero set on which they are looked
at. Goes out: points of the branch at which every declared sign and every condition of ``[domain]``
holds and no square root or logarithm leaves its domain. Where random points do not do, they are
moved: by Newton's method onto the branch, and to where the conditions that fail hold. Points
where nothing has to be solved for are rational, all others have the working precision of mpmath.
The sequence is the same in every run.

`coadjoint.exact.witness` has other points, which lie strictly inside a domain, as intervals
prove. Here a point may lie where a value is 0 that need not be positive, it has to satisfy the
bounds of `Region` with the definitions that these name, and it moves along all that fails at once:
a level set leaves no room for one step after another.
Read next: `coadjoint.prove.zero`.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from itertools import islice
from typing import Any

import mpmath

from coadjoint.elementary import ELEMENTARY, Arithmetic, domain_of, jump_of
from coadjoint.exact import Condition, Element, Field

#: Digits of values at points.
DIGITS = 50
#: Random points that are tried as they are.
PLAIN = 60
#: Points that are tried in all; the others are moved.
TRIES = 150
#: Points that are moved onto a zero set.
ON_ZERO_SET = 50
#: Steps of Newton's method; near a singular point it takes many.
STEPS = 400
#: Steps after which those of Newton's method must have become small.
PATIENCE, LARGE = 40, mpmath.mpf(10) ** -3
#: Steps to where conditions hold.
MOVES = 12
#: What conditions that fail are to become, in turn; the middle of the domain comes first.
TARGETS = (Fraction(1), Fraction(1, 4), Fraction(4), Fraction(1, 32), Fraction(1, 1000))
#: Sizes of the points that are moved.
SCALES = (1, 1, 10, 100, 1000)
#: Part of a random point from which zero sets are reached from near the origin.
SMALL = Fraction(1, 16)
#: Parts of a default by which points near it differ from it.
NEAR = (Fraction(0), Fraction(1, 3), Fraction(1, 30), Fraction(1, 300))
#: Size of the last step of Newton's method, below which a point counts as one of the zero set.
ARRIVED = mpmath.mpf(10) ** (15 - DIGITS)
#: Size of a further step, with more digits and new slopes, below which it is one.
STAYED = 1000 * ARRIVED
#: Size below which a value counts as zero at points of a zero set found by iteration.
ON_BRANCH = mpmath.mpf(10) ** -20
#: How far a value must be from zero to have a sign, where functions occur.
SIGNED = mpmath.mpf(10) ** -30

#: What is added to slopes that may not be independent, relative to the square of what is left.
DAMPING = mpmath.mpf(10) ** -6

Values = dict[str, Any]
#: A function, and the value that it is to have.
Wanted = tuple[Element, Any]


@dataclass(frozen=True)
class Branch:
    """A part of a zero set.

    Attributes:
        solved: Symbols in terms of the others.
        rest: What else vanishes there.
        nonzero: What does not: that by which was divided.
        regular: What does not vanish at points that are shown: determinants that are zero where no
            motion is defined.
    """

    solved: Mapping[str, Element] = field(default_factory=dict)
    rest: tuple[Element, ...] = ()
    nonzero: tuple[Element, ...] = ()
    regular: tuple[Element, ...] = ()


class Numbers(dict[str, Any]):
    """A point in numbers of one kind.

    Args:
        values: Its coordinates.
        number: Takes a rational number into this kind.
    """

    def __init__(self, values: Mapping[str, Any], number: Callable[[Any], Any]) -> None:
        super().__init__(values)
        self.number = number
        self.factors: dict[int, Any] = {}  # of denominators, once they are evaluated


class Points:
    """Points at which functions are looked at.

    Args:
        ring: The field, with the region that is assumed of its symbols.
        elements: The functions, the solved symbols of the branch replaced.
        branch: Where they are looked at; by default everywhere.
        defined: Functions that must have values there, too: what a claim names, and not only its
            rate. They may be looked at where a square root is zero.

    Raises:
        ZeroDivisionError: One of these has a pole on all of the branch.
    """

    def __init__(
        self,
        ring: Field,
        elements: Sequence[Element],
        branch: Branch | None = None,
        defined: Sequence[Element] = (),
    ) -> None:
        self.ring, self.branch = ring, branch or Branch()
        self.elements = tuple(elements)
        self._defined = tuple(ring.substitute(each, self.branch.solved) for each in defined)
        self.plain = all(map(ring.is_function_free, self._involved))

    # -- what has a value -----------------------------------------------------------------

    @cached_property
    def _roots(self) -> tuple[Element, ...]:
        branch = self.branch
        return (*branch.solved.values(), *branch.rest, *branch.nonzero, *branch.regular)

    @cached_property
    def _conditions(self) -> tuple[Condition, ...]:
        """What is assumed of the symbols in addition to their signs."""
        return (*self.ring.region.conditions, *self.ring.region.bounds)

    @cached_property
    def definitions(self) -> dict[str, Element]:
        """What the conditions name other than symbols, in an order in which it can be computed."""
        region, definitions = self.ring.region, dict[str, Element]()
        own = (
            self._reachable((*self.elements, *self._defined, *self._roots))
            | self.branch.solved.keys()
        )
        # of functions of velocities the momenta follow, of others the velocities
        written = region.momenta if own & region.definitions.keys() else region.definitions

        def visit(name: str) -> None:
            if name in definitions or name in own or name not in written:
                return
            for inner in sorted(self.ring.reach(written[name])):
                visit(inner)
            definitions[name] = written[name]

        for name in sorted(self._reachable(each.element for each in self._conditions)):
            visit(name)
        return definitions

    @cached_property
    def _involved(self) -> tuple[Element, ...]:
        """Everything that has a value at a point."""
        conditions = (each.element for each in self._conditions)
        own = (*self.elements, *self._defined, *self._roots)
        loops = self.ring.region.loops
        names = frozenset[str]().union(*map(self.ring.names_in, self.definitions.values()))
        sides = (e for name in sorted(names & loops.keys()) for e in loops[name].sides)
        return (*own, *self.definitions.values(), *sides, *conditions)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The symbols that are free, in the order of the field."""
        given = self.definitions.keys() | self.branch.solved.keys() | self.ring.region.loops.keys()
        reached = self._reachable(self._involved) - given
        return tuple(name for name in self.ring.names if name in reached)

    @cached_property
    def _required(self) -> tuple[tuple[Element, bool], ...]:
        """What must be positive, or if not strict not negative; inner functions first."""
        written = [each for each in self._involved if each not in self._defined]
        strictly = {name for each in written for name in self.ring.functions_in(each)}
        called = {name for each in self._involved for name in self.ring.functions_in(each)}
        arguments = [
            (positive, known.generator in strictly or not ELEMENTARY[known.function].has_edge)
            for known in self.ring.adjoined.values()
            if known.generator in called and (positive := self.ring.domain_of(known)) is not None
        ]
        signs = [(self.ring[name], True) for name in self.names if name in self.ring.positive]
        solved = [
            (root, True) for name, root in self.branch.solved.items() if name in self.ring.positive
        ]
        stated = [(each.element, each.strict) for each in self._conditions]
        return (*arguments, *signs, *solved, *stated)

    def _reachable(self, elements: Iterable[Element]) -> frozenset[str]:
        return frozenset[str]().union(*map(self.ring.reach, elements))

    # -- values ---------------------------------------------------------------------------

    def complete(self, free: Mapping[str, Any]) -> Values:
        """A point with what is solved for and defined.

        Raises:
            ZeroDivisionError: A pole.
            ValueError: A function is not defined there.
        """
        numbers, dependent = self._numbers(free), Values()
        loops = self.ring.region.loops
        for name, element in (*self.branch.solved.items(), *self.definitions.items()):
            for symbol in self.ring.names_in(element) & loops.keys() - numbers.keys():
                numbers.update(loops[symbol].run_loop(symbol, lambda e: self.value(e, numbers)))
            numbers[name] = dependent[name] = self.value(element, numbers)
        return {**free, **dependent}

    def value(self, element: Element, values: Mapping[str, Any]) -> Any:
        """The value of an element: exact at exact points without functions, else a real number."""
        at = values if isinstance(values, Numbers) else self._numbers(values)
        return self.ring.evaluate(element, at, at.number, real_function, at.factors)

    def _numbers(self, values: Mapping[str, Any]) -> Numbers:
        """A point as `value` reads it, for many elements."""
        if self.plain and all(map(_is_rational, values.values())):
            return Numbers(values, Fraction)
        return Numbers({name: real(value) for name, value in values.items()}, real)

    def _list_violated(self, free: Mapping[str, Any]) -> list[Element]:
        """What fails at a point; where functions are not defined, their arguments alone.

        Raises:
            ZeroDivisionError: A pole.
        """
        values, failed = self._numbers(self._as_far_as_defined(free)), list[Element]()
        for element, strict in self._required:
            if not self.ring.reach(element) <= values.keys():
                continue
            try:
                value = self.value(element, values)
            except ValueError:  # that of an inner one has failed already
                break
            if not self._holds(value, strict):
                failed.append(element)
        return failed

    def _holds(self, value: Any, strict: bool) -> bool:
        if isinstance(value, Fraction):
            return value > 0 or (value == 0 and not strict)
        return bool(value > SIGNED or (not strict and value > -ARRIVED))

    # -- points ---------------------------------------------------------------------------

    def __iter__(self) -> Iterator[Values]:
        """Values of the free symbols; ends after `TRIES`."""
        with mpmath.workdps(DIGITS):
            tries = ON_ZERO_SET if self.branch.rest else TRIES
            for number, start in enumerate(islice(self._starts(), tries)):
                if number < PLAIN and not self.branch.rest:
                    point: Values | None = start
                else:
                    point = self._move(start, TARGETS[number % len(TARGETS)])
                with suppress(ZeroDivisionError, ValueError, OverflowError):
                    if point is not None and self._is_inside(point):
                        yield point

    def near_defaults(self) -> Iterator[Values]:
        """The defaults, moved onto the branch and into the domain."""
        with mpmath.workdps(DIGITS), suppress(ZeroDivisionError, ValueError, OverflowError):
            start = next(iter(random_points(self.names, self.ring.positive)))
            point = self._move(start | self._defaults, TARGETS[0])
            if point is not None and self._is_inside(point):
                yield point

    @cached_property
    def _defaults(self) -> dict[str, Fraction]:
        """The defaults of the free symbols."""
        known = self.ring.region.defaults
        return {name: known[name] for name in self.names if name in known}

    def _is_inside(self, free: Values) -> bool:
        """Whether all that is assumed holds, and no divisor and no determinant vanishes."""
        if self._list_violated(free):
            return False
        values = self._numbers(self.complete(free))
        for each in self._defined:
            self.value(each, values)
        least = ON_BRANCH if self.branch.rest else 0
        return all(abs(self.value(each, values)) > least for each in self._not_zero)

    @cached_property
    def _not_zero(self) -> tuple[Element, ...]:
        """What vanishes at no point: a pole looks like a large value where points are not exact."""
        elements = [*self.branch.nonzero, *self.branch.regular]
        if self.branch.rest:
            elements += self._divisors(
                (*self.elements, *self._defined, *self.branch.solved.values())
            )
        return tuple(elements)

    def _divisors(self, elements: Iterable[Element]) -> list[Element]:
        """The factors of all denominators, also of those in the arguments of functions."""
        known, collected, left = self.ring.adjoined, list[Element](), list(elements)
        seen = set[str]()
        while left:
            element = left.pop()
            new = set(self.ring.functions_in(element)) - seen
            seen |= new
            divisors = [d for part in self.ring.quotients(element) for d, _ in part.divisors]
            divisors = [each for each in divisors if each not in collected]
            collected += divisors
            left += [*divisors, *(each for name in sorted(new) for each in known[name].arguments)]
        return collected

    def _starts(self) -> Iterator[Values]:
        """Random points; after the plain ones every other one is near the defaults."""
        defaults, source = self._defaults, random.Random(2)  # noqa: S311 (no secrets)
        moved = bool(self.branch.rest)  # then the first is that of the defaults
        for number, point in enumerate(random_points(self.names, self.ring.positive)):
            if moved and number % 4 == 1:  # from inside: a set may have parts within each other
                yield {name: x * SMALL for name, x in point.items()}
            elif moved <= number < PLAIN // (1 + moved):
                yield point
            elif number % 2:
                scale = SCALES[number // 2 % len(SCALES)]
                yield {name: x * source.randint(1, scale) for name, x in point.items()}
            else:
                part = NEAR[number // 2 % len(NEAR)]
                yield {
                    name: defaults[name] + part * x if name in defaults else x
                    for name, x in point.items()
                }

    def _move(self, start: Values, target: Fraction) -> Values | None:
        """A point near another one at which everything holds; None if none is found."""
        free: Values = {name: real(value) for name, value in start.items()}
        zeros = [(each, mpmath.mpf(0)) for each in self.branch.rest]
        with suppress(ZeroDivisionError, ValueError, OverflowError), mpmath.workdps(2 * DIGITS):
            for _ in range(MOVES):
                failed = self._list_violated(free)
                if not failed:
                    return self._arrive(free, zeros) if zeros else self._round(free)
                free, _ = self._step(free, [*((each, real(target)) for each in failed), *zeros])
        return None

    def _arrive(self, free: Values, zeros: Sequence[Wanted]) -> Values | None:
        """Newton's method to where the rest vanishes; its last step says how near that is."""
        size = mpmath.mpf(1)
        for count in range(STEPS):
            free, size = self._step(free, zeros, size)
            scale = 1 + max(map(abs, free.values()))
            if size < ARRIVED * scale:
                return free if self._stays(free, zeros, STAYED * scale) else None
            if count > PATIENCE and size > LARGE * scale:
                return None
        return None

    def _stays(self, free: Values, zeros: Sequence[Wanted], most: Any) -> bool:
        """Whether a point is one of the zero set with twice as many digits, too.

        Near a zero of high order slopes drown in rounding, and steps become small anywhere.
        """
        with mpmath.workdps(4 * DIGITS):
            return bool(self._step(free, zeros)[1] < most)

    def _round(self, free: Values) -> Values | None:
        """A rational point near another one, of small numbers if these do."""
        for digits in (1, 2, 4, 8, 16):
            near = {name: _fraction(x).limit_denominator(10**digits) for name, x in free.items()}
            generic = all(bool(near[name]) or not x for name, x in free.items())
            if generic and not self._list_violated(near):
                return near
        return None

    def _step(self, free: Values, wanted: Sequence[Wanted], before: Any = 1) -> tuple[Values, Any]:
        """One step of Newton's method along the slopes of functions to wanted values; its size.

        Slopes are differences over a small part of the step before: values have twice the digits
        that are wanted. What is wanted may depend on each other, so that a multiple of 1 is added.
        """
        needed = self._reachable(each for each, _ in wanted)

        def values(at: Values) -> list[Any]:
            whole = self._numbers(at if needed <= free.keys() else self.complete(at))
            return [target - self.value(each, whole) for each, target in wanted]

        here = values(free)
        if not any(here):  # as on all of a half space where sqrt(x^2) = x
            return dict(free), mpmath.mpf(0)
        width = mpmath.mpf(10) ** -20 * min(max(before, ARRIVED**2), 1)
        slopes = mpmath.matrix(len(here), len(self.names))
        for column, name in enumerate(self.names):
            there = values(free | {name: free[name] + width})
            for row, (a, b) in enumerate(zip(here, there, strict=True)):
                slopes[row, column] = (a - b) / width
        square = slopes * slopes.T
        size = min(mpmath.norm(mpmath.matrix(here), 2), 1) ** 2
        largest = max(abs(square[n, n]) for n in range(len(here)))
        for n in range(len(here)):
            square[n, n] += largest * max(size * DAMPING, mpmath.eps)
        step = slopes.T * mpmath.lu_solve(square, mpmath.matrix(here))
        moved = {name: free[name] + by for name, by in zip(self.names, step, strict=True)}
        return moved, mpmath.norm(step, mpmath.inf)

    def _as_far_as_defined(self, free: Mapping[str, Any]) -> Values:
        """A point completed; as it is where a function is not defined there."""
        try:
            return self.complete(free)
        except ValueError:
            return dict(free)


def random_points(
    names: Sequence[str], positive: Set[str] = frozenset(), seed: int = 1
) -> Iterator[dict[str, Fraction]]:
    """Endless small nonzero rationals, the same in every run, with the assumed signs."""
    source = random.Random(seed)  # noqa: S311 (not for secrets)
    while True:
        sizes = [Fraction(source.randint(1, 9), source.randint(1, 5)) for _ in names]
        signs = [1 if name in positive else source.choice((-1, 1)) for name in names]
        yield {name: s * size for name, s, size in zip(names, signs, sizes, strict=True)}


def real(value: Any) -> Any:
    """A rational number in the working precision of mpmath; other numbers as they are."""
    return mpmath.mpf(value.numerator) / value.denominator if _is_rational(value) else value


def real_function(function: str, *arguments: Any) -> Any:
    """A real elementary function, to the working precision of mpmath.

    Raises:
        ValueError: An argument is outside the real domain, or where the function jumps.
    """
    positive = domain_of(function, arguments, _REAL)
    zero, side = jump_of(function, arguments)
    jumps, has_edge = zero == 0 and (side is None or side <= 0), ELEMENTARY[function].has_edge
    if jumps or (positive is not None and (positive < 0 or (positive == 0 and not has_edge))):
        raise ValueError(f"{function} of {arguments}")
    return getattr(mpmath, function)(*arguments)


_REAL = Arithmetic(number=real, call=real_function)


def _is_rational(value: Any) -> bool:
    return isinstance(value, Fraction | int)


def _fraction(value: Any) -> Fraction:
    """A binary number as it is."""
    sign, mantissa, exponent, _ = value._mpf_
    whole = -int(mantissa) if sign else int(mantissa)
    return Fraction(whole * 2**exponent) if exponent >= 0 else Fraction(whole, 2**-exponent)
