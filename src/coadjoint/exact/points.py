"""Real points at which elements are defined, and their values there with bounds.

Comes in: a field and elements. Goes out: rational points where every logarithm and square root has
a positive argument and the conditions of the field hold, and enclosures of values: intervals that
hold the true value whatever is rounded, so that one without zero proves that a value is not zero.
Read next: `coadjoint.poisson.ranks`.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from math import cos, exp, inf, log, sin, sqrt
from typing import Any, NamedTuple

from mpmath import libmp

from coadjoint.exact.element import Element
from coadjoint.exact.field import Field

#: Bits of the bounds of an enclosure.
BITS = 240
#: How often a point is looked for, and the steps from each start.
STARTS = 60
STEPS = 60
#: Sizes of the coordinates of starts, and whether they may be negative.
SCALES = ((2, False), (3, True), (10, True), (100, True), (1, False), (1000, True))
#: How far inside its conditions a point lies, so that rounding decides nothing.
MARGIN = 1e-6

_FLOATS = {"sqrt": sqrt, "log": log, "sin": sin, "cos": cos, "exp": exp}


def real_points(field: Field, elements: Iterable[Element]) -> Iterator[dict[str, Fraction]]:
    """Rational points where elements are real, the same in every run; as many as are found.

    From a random start, steps along single coordinates are kept that bring the arguments of
    logarithms and of square roots, and the conditions of the field, nearer to being positive.

    >>> field = Field(["x"], slots=1)
    >>> point = next(real_points(field, [field.call("log", field["x"] - 40)]))
    >>> point["x"] > 40
    True
    """
    present = list(elements)
    conditions = _conditions(field, [*present, *field.conditions()])
    reached = frozenset[str]().union(*map(field.reach, [*present, *conditions]))
    names = [name for name in field.names if name in reached]
    source = random.Random(2)  # noqa: S311 (not for secrets)
    for start in range(STARTS):
        size, signed = SCALES[start % len(SCALES)]
        point = {
            name: _coordinate(source, size, signed and name not in field.positive) for name in names
        }
        if _descended(field, conditions, point, source, size):
            yield point


def _conditions(field: Field, elements: Sequence[Element]) -> list[Element]:
    """What must be positive, arguments before what they are arguments of."""
    used = frozenset[str]().union(*map(field.functions_in, elements))
    known = [field.adjoined[name] for name in field.adjoined if name in used]
    arguments = [each.argument for each in known if each.function in ("sqrt", "log")]
    return [*arguments, *field.conditions()]


def _coordinate(source: random.Random, size: int, signed: bool) -> Fraction:
    """A random number that is not zero."""
    number = Fraction(source.randint(250 * size, 1000 * size), 1000)
    return -number if signed and source.random() < 0.5 else number


def _descended(
    field: Field,
    conditions: Sequence[Element],
    point: dict[str, Fraction],
    source: random.Random,
    size: int,
) -> bool:
    """Move a point until the conditions hold; whether they do."""
    distance = _distance(field, conditions, point)
    for _ in range(STEPS if point else 0):
        if not distance:
            break
        name = source.choice(list(point))
        step = Fraction(source.gauss(0, 1) * size * 10 ** source.uniform(-1, 1)).limit_denominator(
            1000
        )
        moved = point | {name: point[name] + step}
        if moved[name] == 0 or (name in field.positive and moved[name] < 0):
            continue
        found = _distance(field, conditions, moved)
        if found < distance:
            point[name], distance = moved[name], found
    return not distance


def _distance(field: Field, conditions: Sequence[Element], point: dict[str, Fraction]) -> float:
    """How far a point is from having all conditions; 0 inside, infinite where one is undefined."""
    values = {name: float(x) for name, x in point.items()}
    total = 0.0
    for condition in conditions:
        try:
            value = field.evaluate(condition, values, float, lambda f, x: _FLOATS[f](x))
        except (ArithmeticError, ValueError):
            value = -1e30
        total += 0.0 if value > MARGIN else MARGIN - value if value > -inf else inf
    return total


class Enclosure(NamedTuple):
    """An interval that holds a value; sums, products and quotients are rounded outwards.

    Attributes:
        low: The lower bound, a number of mpmath in its raw form.
        high: The upper bound.
    """

    low: Any
    high: Any

    @classmethod
    def of(cls, value: Fraction) -> Enclosure:
        """The bounds of a rational number."""
        p, q = value.numerator, value.denominator
        return cls(libmp.from_rational(p, q, BITS, "f"), libmp.from_rational(p, q, BITS, "c"))

    def __add__(self, other: Enclosure) -> Enclosure:  # type: ignore[override]
        return Enclosure(*libmp.mpi_add(self, other, BITS))

    def __sub__(self, other: Enclosure) -> Enclosure:
        return Enclosure(*libmp.mpi_sub(self, other, BITS))

    def __mul__(self, other: Enclosure) -> Enclosure:  # type: ignore[override]
        return Enclosure(*libmp.mpi_mul(self, other, BITS))

    def __truediv__(self, other: Enclosure) -> Enclosure:
        if not other.excludes_zero():
            raise ZeroDivisionError("a denominator may be zero")
        return Enclosure(*libmp.mpi_div(self, other, BITS))

    @property
    def is_positive(self) -> bool:
        """Whether the value is certainly positive."""
        return bool(libmp.mpf_gt(self.low, libmp.fzero))

    def excludes_zero(self) -> bool:
        """Whether the value is certainly not zero."""
        return self.is_positive or bool(libmp.mpf_lt(self.high, libmp.fzero))

    def least(self) -> Any:
        """The least absolute value, by which pivots are compared."""
        return libmp.mpi_abs(self, BITS)[0]


def enclosed(field: Field, element: Element, point: Mapping[str, Fraction]) -> Enclosure:
    """The bounds of the value of an element at a rational point.

    Raises:
        ValueError: The argument of a logarithm or of a square root may not be positive there.
        ZeroDivisionError: A denominator may be zero there.
    """
    values = {name: Enclosure.of(x) for name, x in point.items()}
    return field.evaluate(element, values, Enclosure.of, _called)


def _called(function: str, argument: Enclosure) -> Enclosure:
    """Bounds of an elementary function."""
    if function in ("sqrt", "log") and not argument.is_positive:
        raise ValueError(f"{function} of what may not be positive")
    return Enclosure(*getattr(libmp, f"mpi_{function}")(argument, BITS))
