"""Cross-check, series: the motion as a power series in 60 digits, straight from the equations.

Comes in: equations that any arithmetic can evaluate. Goes out: their solution as power series in
time, by Picard's iteration: each round integrates the rates of the round before, and gives one more
order. No recurrence of a solver is used: a quotient is a product with a Newton iteration, a
function is differentiated numerically.
Read next: `coadjoint.crosscheck.recurrences`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import lru_cache
from operator import mul
from typing import Any

from coadjoint.crosscheck.oracle import (
    CONTEXT,
    DIGITS_OF_MPMATH,
    Bounded,
    OutsideDomain,
    exact,
    from_digits,
    is_inside,
    to_digits,
)
from coadjoint.derive.mechanics.iteration import SETTLE, SETTLE_LAST

#: Coefficients that are found at once: those of most rounds.
ROUNDS = 8
#: Evaluates rates in any arithmetic: values by name, numbers, functions.
Rates = Callable[
    [Mapping[str, "Series"], Callable[[Fraction], "Series"], Callable[..., "Series"]],
    Sequence["Series"],
]


@dataclass(frozen=True, slots=True)
class Series:
    """A power series up to some order.

    Attributes:
        of: Its coefficients.
    """

    of: tuple[Decimal, ...]

    def __add__(self, other: Series) -> Series:
        return Series(tuple(a + b for a, b in zip(self.of, other.of, strict=True)))

    def __neg__(self) -> Series:
        return Series(tuple(-a for a in self.of))

    def __mul__(self, other: Series) -> Series:
        a, b = self.of, other.of
        if not any(a[1:]):  # a number, as most factors are
            return Series(tuple(a[0] * each for each in b))
        if not any(b[1:]):
            return Series(tuple(each * b[0] for each in a))
        return Series(tuple(sum(map(mul, a[: k + 1], b[k::-1])) for k in range(len(a))))

    def __truediv__(self, other: Series) -> Series:
        if not other.of[0]:
            raise OutsideDomain
        inverse = constant(1 / other.of[0], len(self.of))
        two, known = constant(Decimal(2), len(self.of)), 1
        while known < len(self.of):  # Newton: twice as many coefficients in each round
            inverse, known = inverse * (two + -(other * inverse)), 2 * known
        return self * inverse


def constant(value: Decimal, length: int) -> Series:
    """A series of one coefficient."""
    return Series((value, *[Decimal(0)] * (length - 1)))


def apply(function: str, *arguments: Series) -> Series:
    """A function of series, differentiated numerically with as many digits as that takes.

    Raises:
        OutsideDomain: It has no value there, or no slope.
    """
    if function in (SETTLE, SETTLE_LAST):
        return arguments[0]
    if not is_inside(function, tuple(Bounded(each.of[0], Decimal(0)) for each in arguments)):
        raise OutsideDomain
    digits, length = DIGITS_OF_MPMATH, len(arguments[0].of)
    if len(arguments) == 1:
        return _compose(_differentiate(function, arguments[0].of[0], length), arguments[0])
    of = [[to_digits(c) for c in reversed(each.of)] for each in arguments]

    def value(time: Any) -> Any:
        return getattr(digits, function)(*(digits.polyval(each, time) for each in of))

    return Series(tuple(map(from_digits, digits.taylor(value, 0, length - 1))))


def _differentiate(function: str, at: Decimal, length: int) -> Sequence[Decimal]:
    """So many Taylor coefficients of a function of one number."""
    return _list_coefficients(function, at, max(length, ROUNDS))[:length]


@lru_cache(maxsize=4096)  # rounds of the iteration begin at the same values
def _list_coefficients(function: str, at: Decimal, length: int) -> tuple[Decimal, ...]:
    """The same, remembered."""
    digits = DIGITS_OF_MPMATH
    found = digits.taylor(getattr(digits, function), to_digits(at), length - 1)
    return tuple(map(from_digits, found))


def _compose(coefficients: Sequence[Decimal], argument: Series) -> Series:
    """A function with these Taylor coefficients, of a series that begins where they are taken."""
    rise = Series((Decimal(0), *argument.of[1:]))
    total = constant(Decimal(0), len(argument.of))
    for each in reversed(coefficients):
        total = total * rise + constant(each, len(argument.of))
    return total


def solve(
    rates: Rates,
    state: Mapping[str, float],
    given: Mapping[str, tuple[float, ...]],
    order: int,
) -> dict[str, tuple[Decimal, ...]]:
    """The motion from a state on, by component: coefficients up to an order.

    Args:
        rates: The equations.
        state: Where it begins.
        given: First coefficients of parameters, inputs and time.
        order: The last order.

    Raises:
        OutsideDomain: The equations have no value there.
    """
    with localcontext(CONTEXT):
        motion: dict[str, tuple[Decimal, ...]]
        motion = {name: (Decimal(value),) for name, value in state.items()}
        for length in range(1, order + 1):
            known = {name: Series(each) for name, each in motion.items()}
            for name, first in given.items():
                whole = [Decimal(value) for value in first] + [Decimal(0)] * length
                known[name] = Series(tuple(whole[:length]))

            def number(value: Fraction, length: int = length) -> Series:
                return constant(exact(value).value, length)

            found = rates(known, number, apply)
            motion = {
                name: (motion[name][0], *(c / (k + 1) for k, c in enumerate(rate.of)))
                for name, rate in zip(motion, found, strict=True)
            }
        return motion
