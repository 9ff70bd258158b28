"""Witness points: proof that an element is not zero, by interval arithmetic at a rational point.

Comes in: an element. Goes out: a rational point inside the domain at which bounds of the value
exclude zero, or nothing. A normal form that is not 0 proves nothing where functions occur, since
their field does not know every relation; a witness does. The points are the same in every run.
Normal forms, divisors, brackets and ranks ask here: what is not zero at one point is not zero at
almost every point. Claims are looked at by `coadjoint.prove.points`, which knows zero sets, bounds
and definitions too.
Read next: `coadjoint.exact.signs`, which knows signs at all points of a domain.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import islice
from typing import Any, cast

import mpmath

from coadjoint.elementary import ELEMENTARY, Arithmetic, by_name, domain_of, evaluate, jump_of
from coadjoint.exact.element import Element
from coadjoint.exact.field import Field

#: A value for each symbol.
Point = dict[str, Fraction]

#: Interval arithmetic with 200 binary digits, apart from mpmath's own, whose precision others set.
INTERVALS = mpmath.ctx_iv.MPIntervalContext()
INTERVALS.prec = 200
#: Points at which a value is tried, and how many are drawn to find each.
TRIES = 12
DRAWN = 12
#: Steps from a point outside a domain towards it.
STEPS = 20
#: Largest arguments; of more, numbers would have millions of digits, or no digit would be certain.
LARGEST = {"exp": 10**6, "sin": 10**30, "cos": 10**30}
#: Where a value is undefined: poles, roots and logarithms of what is not positive, huge numbers.
UNDEFINED = (ZeroDivisionError, ValueError, OverflowError)


@dataclass(frozen=True, slots=True)
class Enclosure:
    """An interval that contains a real value, with what evaluation in a `Field` needs.

    Attributes:
        bounds: The interval of mpmath.
    """

    bounds: Any

    @staticmethod
    def of(number: Fraction | int) -> Enclosure:
        """The smallest interval around a rational number."""
        exact = Fraction(number)
        return Enclosure(INTERVALS.mpf(exact.numerator) / INTERVALS.mpf(exact.denominator))

    @property
    def size(self) -> Any:
        """The largest absolute value in the interval."""
        return abs(self.bounds).b

    @property
    def sign(self) -> int:
        """+1 or -1 where the whole interval has that sign, else 0."""
        if self.bounds.a > 0:
            return 1
        return -1 if self.bounds.b < 0 else 0

    def __add__(self, other: Enclosure) -> Enclosure:
        return Enclosure(self.bounds + other.bounds)

    def __mul__(self, other: Enclosure) -> Enclosure:
        return Enclosure(self.bounds * other.bounds)

    def __neg__(self) -> Enclosure:
        return Enclosure(-self.bounds)

    def __truediv__(self, other: Enclosure) -> Enclosure:
        if not other.sign:
            raise ZeroDivisionError("a divisor that may be zero")
        return Enclosure(self.bounds / other.bounds)


def enclose_function(function: str, *arguments: Enclosure) -> Enclosure:
    """Bounds of an elementary function.

    Raises:
        ValueError: An argument may be outside the open domain, or where it jumps, or is huge.
    """
    positive = domain_of(function, arguments, _ENCLOSED)
    zero, side = jump_of(function, arguments)
    may_jump = zero is not None and not zero.sign and (side is None or side.sign <= 0)
    if may_jump or (positive is not None and positive.sign <= 0):
        shown = ", ".join(str(each.bounds) for each in arguments)
        raise ValueError(f"{function} of {shown}, where it may have no value")
    if function in LARGEST and not arguments[0].size < LARGEST[function]:
        raise ValueError(f"{function} of {arguments}")
    if text := ELEMENTARY[function].enclosed:
        return cast(Enclosure, evaluate(text, _ENCLOSED, **by_name(arguments)))
    return Enclosure(getattr(INTERVALS, function)(*(each.bounds for each in arguments)))


_ENCLOSED = Arithmetic(number=Enclosure.of, call=enclose_function)


def enclosure(field: Field, element: Element, point: Mapping[str, Fraction]) -> Enclosure:
    """Bounds of an element at a point.

    Raises:
        ZeroDivisionError: It may have a pole there.
        ValueError: A function in it may be undefined there.
    """
    return enclosures(field, [element], point)[0]


def enclosures(
    field: Field, elements: Iterable[Element], point: Mapping[str, Fraction]
) -> list[Enclosure]:
    """Bounds of several elements at a point; errors as for one."""
    numbers = {name: Enclosure.of(value) for name, value in point.items()}
    factors: dict[int, Enclosure] = {}
    return [
        field.evaluate(each, numbers, Enclosure.of, enclose_function, factors) for each in elements
    ]


def witness_nonzero(
    field: Field, element: Element, defined: Iterable[Element] = (), *, tries: int = TRIES
) -> Point | None:
    """A point of the domain at which an element is certainly not zero.

    Args:
        field: Where the element lives; its declared signs and conditions hold at the point.
        element: What should not be zero.
        defined: What else has to have a value at the point.
        tries: At how many points.

    Returns:
        Values of the symbols that the element depends on; None where no point was found, which
        proves nothing.

    >>> field = Field(["q"], slots=2)
    >>> double, single = field.call("exp", 2 * field["q"]), field.call("exp", field["q"])
    >>> witness_nonzero(field, double - single**2)
    >>> witness_nonzero(field, double - single)
    {'q': Fraction(-3, 5)}
    """
    names = field.reach(element)
    for point in islice(points_inside(field, [element, *defined], tries * DRAWN), tries):
        with suppress(*UNDEFINED):
            if enclosure(field, element, point).sign:
                return {name: value for name, value in point.items() if name in names}
    return None


def is_nonzero(field: Field, element: Element) -> bool:
    """Whether an element is certainly not identically zero.

    Without functions the normal form decides; with them a witness point does.
    """
    if field.is_zero(element):
        return False
    return field.is_function_free(element) or witness_nonzero(field, element) is not None


def is_entire(field: Field, elements: Iterable[Element]) -> bool:
    """Whether elements are quotients of functions that are analytic at all real points.

    Then a numerator that is not zero at one point is not zero at almost every point. Roots and
    logarithms are analytic on each connected part of their domain alone.
    """
    called = frozenset[str]().union(*map(field.functions_in, elements))
    return all(
        ELEMENTARY[known.function].entire
        and not any(q.divisors for each in known.arguments for q in field.quotients(each))
        for known in map(field.adjoined.__getitem__, called)
    )


def point_text(point: Mapping[str, Fraction]) -> str:
    """A point for people: ``m = 1, q = -3/5``."""
    return ", ".join(f"{name} = {value}" for name, value in point.items())


def points_inside(
    field: Field, elements: Iterable[Element], drawn: int = TRIES * DRAWN
) -> Iterator[Point]:
    """Rational points at which elements are defined and the conditions of the field hold.

    Random points of several sizes; one outside the domain is moved towards it first.

    Args:
        field: Where the elements live.
        elements: What should be defined.
        drawn: How many points are drawn; there may be none inside the domain. Elements that are
            analytic everywhere are then looked at outside: what is not zero there is not zero at
            almost every point.
    """
    domain = Domain(field, tuple(elements))
    result = False
    for start in islice(_starts(field, domain.names), drawn):
        point = domain.move_inside(start)
        if point is not None:
            result = True
            yield point
    if not result and is_entire(field, domain.elements):
        yield from islice(_starts(field, domain.names), TRIES)


def _starts(field: Field, names: Iterable[str]) -> Iterator[Point]:
    """Endless nonzero rationals with the declared signs: small ones first, then of any size.

    After the first ones, every other point is at or near the defaults, as far as there are some.
    """
    source, names = random.Random(1), list(names)  # noqa: S311 (not for secrets)
    defaults = {name: x for name, x in field.region.defaults.items() if x}
    for count in range(10**9):
        scale = Fraction(10) ** (0 if count < TRIES else source.choice((-2, -1, 0, 1, 2, 3)))
        sizes = [scale * Fraction(source.randint(1, 9), source.randint(1, 5)) for _ in names]
        signs = [1 if name in field.positive else source.choice((-1, 1)) for name in names]
        point = {name: s * size for name, s, size in zip(names, signs, sizes, strict=True)}
        if count >= TRIES and count % 2:
            near = 1 + source.choice((0, 1)) * Fraction(source.randint(-9, 9), 1000)
            point |= {name: defaults[name] * near for name in names if name in defaults}
        yield point


@dataclass(frozen=True)
class Domain:
    """Where elements are defined and the conditions of their field hold.

    Attributes:
        field: Where they live.
        elements: What should be defined.
    """

    field: Field
    elements: tuple[Element, ...]

    @cached_property
    def positive(self) -> tuple[Element, ...]:
        """What must be positive: symbols, what functions ask for, and conditions.

        Inner arguments come first. A condition that allows 0 is asked for more: points lie inside.
        """
        conditions = [condition.element for condition in self.field.region.conditions]
        reached = (*self.elements, *conditions)
        called = frozenset[str]().union(*map(self.field.functions_in, reached))
        inner = [
            positive
            for name, known in self.field.adjoined.items()
            if name in called and (positive := self.field.domain_of(known)) is not None
        ]
        names = frozenset[str]().union(*map(self.field.reach, (*reached, *inner)))
        signed = [
            self.field[name] for name in self.field.names if name in names & self.field.positive
        ]
        return (*signed, *inner, *conditions)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The symbols that the elements and the conditions depend on, in the field's order."""
        reached = map(self.field.reach, (*self.elements, *self.positive))
        present = frozenset[str]().union(*reached)
        return tuple(name for name in self.field.names if name in present)

    @cached_property
    def slopes(self) -> tuple[tuple[Element, ...], ...]:
        """The gradients of what must be positive."""
        return tuple(self.field.gradient(each, self.names) for each in self.positive)

    def contains(self, point: Mapping[str, Fraction]) -> bool:
        """Whether all that must be positive certainly is."""
        with suppress(*UNDEFINED):
            return all(enclosure(self.field, each, point).sign > 0 for each in self.positive)
        return False

    def move_inside(self, start: Point) -> Point | None:
        """The point itself where it is inside, else one reached by steps along gradients."""
        if self.contains(start):
            return start
        place = {name: float(value) for name, value in start.items()}
        with suppress(*UNDEFINED):
            for _ in range(STEPS):
                if (step := self._step(place)) is None:
                    break
                place = {name: place[name] + step[name] for name in self.names}
            point = {name: Fraction(x).limit_denominator(1000) for name, x in place.items()}
            return point if self.contains(point) else None
        return None

    def _step(self, place: Mapping[str, float]) -> dict[str, float] | None:
        """Towards the side where the first value that is not positive is; None without one."""
        for each, slopes in zip(self.positive, self.slopes, strict=True):
            value = _float(self.field, each, place)
            if value <= 0:
                gradient = [_float(self.field, slope, place) for slope in slopes]
                target = max(abs(value) / 4, 0.01)
                factor = (target - value) / sum(x * x for x in gradient)
                return dict(zip(self.names, (factor * x for x in gradient), strict=True))
        return None


def _float(field: Field, element: Element, place: Mapping[str, float]) -> float:
    """The value of an element to double precision."""
    return field.evaluate(element, place, float, _float_of)


def _float_of(function: str, *arguments: float) -> float:
    """A function in double precision."""
    if function == "sign":
        return math.copysign(1.0, *arguments)
    return float(getattr(math, function)(*arguments))
