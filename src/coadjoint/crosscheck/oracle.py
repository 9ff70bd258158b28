"""Cross-check, oracle: equations to 50 digits, with the envelope of their rounding errors.

Comes in: a `Reference`, which evaluates the *equations* in any arithmetic, and exact doubles. Goes
out: for each output the exact value and its envelope: to first order, the sum of what a relative
change of 1 in each input and each intermediate result does to it. The error of a floating-point
kernel is measured against the envelope, k = |computed - exact| / (2^-53 envelope): raw ulp say
nothing where terms cancel. No formula of d operations one after the other has a k above d, however
much it cancels (docs/decisions/envelope.md); a wrong sign gives a k of about 1e16.
Read next: `coadjoint.crosscheck.points`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from decimal import MAX_EMAX, MIN_EMIN, Context, Decimal, localcontext
from fractions import Fraction
from functools import lru_cache
from operator import add, mul
from typing import Any, Final, Protocol, TypeVar

from mpmath import MPContext

from coadjoint.derive.mechanics.iteration import SETTLE, SETTLE_LAST
from coadjoint.elementary import ELEMENTARY, Arithmetic, domain_of, jump_of, slopes_of
from coadjoint.exact.factored import Loop, place_of, row_of, rows_of

Value = TypeVar("Value")

#: Decimal digits carried: 50 are promised of each output relative to its envelope, and even a
#: million operations lose no more than 6 of these.
DIGITS: Final = 60

#: Above this ratio of envelope to magnitude, a divisor may be nothing but rounding error, and a
#: bound of first order says nothing about the quotient.
LARGEST_CONDITION: Final = Decimal(2**40)

# `decimal` is written in C and 10 times as fast as `mpmath`, which has the other functions.
# Contexts of our own: a check changes the precision of no other code.
CONTEXT: Final = Context(prec=DIGITS, Emax=MAX_EMAX, Emin=MIN_EMIN)
DIGITS_OF_MPMATH: Final = MPContext()
DIGITS_OF_MPMATH.dps = DIGITS
_UNIT: Final = Decimal(2.0**-53)
_FLOOR: Final = Decimal(2.0**-1074)
#: By fewer powers of ten than these an envelope is above a value that is more than a unit of it.
_KNOWN: Final = 15


class Reference(Protocol):
    """Evaluates the equations, not the Program, in any arithmetic that has ``+ * /`` and ``-u``."""

    def evaluate(
        self,
        function: str,
        inputs: Mapping[str, Value],
        number: Callable[[Fraction], Value],
        call: Callable[..., Value],
    ) -> list[Value]:
        """All outputs of one function, row by row."""
        ...


class OutsideDomain(Exception):  # noqa: N818  # not an error: a point that says nothing
    """The equations have no value at a point, or none that doubles could find."""


@dataclass(slots=True)
class Bounded:
    """A value to 50 digits and the envelope of what rounding may do to it; neither ever changes.

    Attributes:
        value: The exact value, up to 60 digits.
        envelope: At least ``|value|``; how far cancellation and steep functions amplify errors.
    """

    value: Decimal
    envelope: Decimal

    def __add__(self, other: Bounded) -> Bounded:
        return Bounded(self.value + other.value, self.envelope + other.envelope)

    def __mul__(self, other: Bounded) -> Bounded:
        one, two, mine, theirs = self.value, other.value, self.envelope, other.envelope
        size = one.copy_abs() * theirs + two.copy_abs() * mine
        if one and mine.adjusted() - one.adjusted() < _KNOWN:  # what follows is smaller
            return Bounded(one * two, size)
        both = _UNIT * mine * theirs  # where both factors cancel to nothing
        return Bounded(one * two, size if size >= both else both)

    def __truediv__(self, other: Bounded) -> Bounded:
        size = abs(other.value)
        if other.envelope >= LARGEST_CONDITION * size:
            raise OutsideDomain
        value = self.value / other.value
        return Bounded(value, (self.envelope + abs(value) * other.envelope) / size)

    def __neg__(self) -> Bounded:
        return Bounded(-self.value, self.envelope)

    def settled(self) -> Bounded:
        """The value as if it were given, however rounding errors came into it."""
        return Bounded(self.value, abs(self.value))

    @staticmethod
    def zero() -> Bounded:
        """0, exactly."""
        return Bounded(Decimal(0), Decimal(0))

    @staticmethod
    def factor(entries: Sequence[Bounded]) -> BoundedEquations:
        """What solves symmetric equations; see `coadjoint.exact.factored`."""
        return BoundedEquations(entries)


class BoundedEquations:
    r"""Symmetric equations ``A x = b`` to 60 digits, with the envelope of their solution.

    .. math:: |x| + |A^{-1}| \left( E_b + (E_A + 2 |L| |D| |L^T|) |x| \right)

    To first order it is what a relative change of 1 in each entry, in each product that elimination
    takes from an entry, and in those of both substitutions does to x. Carried through elimination
    step by step, envelopes of envelopes would grow as a power of the number of unknowns.

    Args:
        entries: Of A, on and below the diagonal, row by row.

    Source:
        Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., sec. 7.2, 10.1 and 11.3.
    """

    def __init__(self, entries: Sequence[Bounded]) -> None:
        size = range(rows_of(len(entries)))
        self._loop = Loop([each.value for each in entries])
        lower = [[self._loop[place_of(i, j)] for j in range(i)] for i in size]
        self._pivots: list[Decimal] = [self._loop[place_of(i, i)] for i in size]
        self._left = _invert_lower(lower)  # L^-1
        whole = [[*map(abs, row), Decimal(1)] for row in lower]
        weights = [[abs(d) * x for x, d in zip(row, self._pivots, strict=False)] for row in whole]
        taken = [[sum(map(mul, weights[i], whole[j])) for j in range(i + 1)] for i in size]
        self._entries = [
            [entries[place_of(i, j)].envelope + 2 * taken[i][j] for j in range(i + 1)] for i in size
        ]
        columns = list(zip(*(_pad(row, len(size)) for row in self._left), strict=True))
        scaled = [[x / d for x, d in zip(c, self._pivots, strict=True)] for c in columns]
        self._inverse = [[abs(sum(map(mul, a, b))) for b in columns] for a in scaled]
        one = self._spread([Decimal(1)] * len(size))
        if max(one) >= LARGEST_CONDITION:
            raise OutsideDomain

    def __getitem__(self, place: int) -> Bounded:
        """An entry of D."""
        row = row_of(place)
        own = list(map(abs, self._left[row]))
        moved = self._times(_pad(own, len(self._pivots)))
        return Bounded(self._pivots[row], sum(map(mul, own, moved), abs(self._pivots[row])))

    def solve(self, known: Sequence[Bounded]) -> list[Bounded]:
        """The x of ``A x = b``."""
        x: list[Decimal] = self._loop.solve([each.value for each in known])
        sizes = list(map(abs, x))
        sides = map(add, self._times(sizes), (each.envelope for each in known))
        wide = map(add, sizes, self._divide(list(sides)))
        return list(map(Bounded, x, wide))

    def _times(self, vector: Sequence[Decimal]) -> list[Decimal]:
        """What rounding in the matrix does to its product with a vector."""
        size, rows = range(len(vector)), self._entries
        return [
            sum((rows[max(i, j)][min(i, j)] * vector[j] for j in size), Decimal(0)) for i in size
        ]

    def _divide(self, vector: Sequence[Decimal]) -> list[Decimal]:
        """``|A^-1|`` times a vector."""
        return [sum(map(mul, row, vector), Decimal(0)) for row in self._inverse]

    def _spread(self, vector: Sequence[Decimal]) -> list[Decimal]:
        """How rounding in the matrix moves a solution of such a size."""
        return self._divide(self._times(vector))


def _invert_lower(rows: Sequence[Sequence[Decimal]]) -> list[list[Decimal]]:
    """The inverse of a matrix that has these rows below a diagonal of ones."""
    inverse = list[list[Decimal]]()
    for i, row in enumerate(rows):
        own = [-sum((row[k] * inverse[k][j] for k in range(j, i)), Decimal(0)) for j in range(i)]
        inverse.append([*own, Decimal(1)])
    return inverse


def _pad(row: Sequence[Decimal], size: int) -> list[Decimal]:
    """A row with zeros behind it."""
    return [*row, *[Decimal(0)] * (size - len(row))]


def exact(value: float | Fraction) -> Bounded:
    """A double or a rational constant in this arithmetic.

    >>> exact(Fraction(-1, 4)).envelope
    Decimal('0.25')
    """
    if isinstance(value, Fraction):
        taken = CONTEXT.divide(Decimal(value.numerator), Decimal(value.denominator))
    else:
        taken = CONTEXT.create_decimal(value)
    return Bounded(taken, abs(taken))


def take(value: float) -> Bounded:
    """A double in this arithmetic; those of a point are asked for by each function of a system.

    >>> take(-0.0).value, take(0.0).value  # which are equal, and would have one place
    (Decimal('-0'), Decimal('0'))
    """
    return _known(value) if value else exact(value)


@lru_cache(maxsize=2**14)
def _known(value: float) -> Bounded:
    """A double that is not zero."""
    return exact(value)


def call(function: str, *arguments: Bounded) -> Bounded:
    """``f(u)``, with envelope ``|f(u)| + |f'(u)| envelope(u)``.

    Raises:
        OutsideDomain: Rounding may move an argument out of the domain or across a jump, as that of
            a square root or logarithm below 0, or the value is one that no double holds.
    """
    if function == SETTLE:
        return arguments[0].settled()
    if function == SETTLE_LAST:
        return arguments[0]
    if function == "sqrt" and arguments[0].value == arguments[0].envelope == 0:
        return arguments[0]
    if not is_inside(function, arguments):
        raise OutsideDomain
    values = tuple(argument.value for argument in arguments)
    value = _value(function, *values)
    slopes = slopes_of(function, values, value, _DECIMALS)
    parts = (abs(s) * u.envelope for s, u in zip(slopes, arguments, strict=True))
    return Bounded(value, sum(parts, abs(value)))


def is_inside(function: str, arguments: tuple[Bounded, ...]) -> bool:
    """Whether a function certainly has a value, for all that rounding may do to its arguments."""
    largest, first = ELEMENTARY[function].largest, arguments[0]
    if largest and abs(first.value) > largest:
        return False
    positive = domain_of(function, arguments, Arithmetic(number=exact, call=call))
    if positive is not None and positive.envelope >= LARGEST_CONDITION * positive.value:
        return False
    zero, side = jump_of(function, arguments)
    near = zero is not None and zero.envelope >= LARGEST_CONDITION * abs(zero.value)
    return not (near and (side is None or side.envelope >= LARGEST_CONDITION * side.value))


@lru_cache(maxsize=4096)  # a sine and the slope of a cosine are one value
def _value(function: str, *arguments: Decimal) -> Decimal:
    """A function of numbers."""
    if function in _BY_DECIMAL:
        return _BY_DECIMAL[function](*arguments)
    if function in ("cos", "sin"):
        return _cosine_and_sine(*arguments)[function == "sin"]
    return from_digits(getattr(DIGITS_OF_MPMATH, function)(*map(to_digits, arguments)))


@lru_cache(maxsize=4096)  # one reduction of the angle gives both, and mostly both are asked for
def _cosine_and_sine(angle: Decimal) -> tuple[Decimal, Decimal]:
    """Cosine and sine of an angle."""
    cosine, sine = DIGITS_OF_MPMATH.cos_sin(to_digits(angle))
    return from_digits(cosine), from_digits(sine)


def to_digits(value: Decimal) -> Any:
    """A number in the arithmetic of mpmath."""
    return DIGITS_OF_MPMATH.mpf(str(value))


def from_digits(value: Any) -> Decimal:
    """A number of mpmath as a decimal."""
    return Decimal(DIGITS_OF_MPMATH.nstr(value, DIGITS))


#: Functions that `decimal` has.
_BY_DECIMAL: Final[dict[str, Callable[[Decimal], Decimal]]] = {
    "sqrt": Decimal.sqrt,
    "exp": Decimal.exp,
    "log": Decimal.ln,
}
#: Where slopes are computed, of which only the sizes are used.
_DECIMALS: Final = Arithmetic(number=lambda number: exact(number).value, call=_value)


def oracle(reference: Reference, function: str, inputs: Mapping[str, float]) -> list[Bounded]:
    """The outputs of one function at one point, exact, with their envelopes.

    Args:
        reference: The equations.
        function: Which function.
        inputs: State and parameter components by name; doubles, taken as exact.

    Raises:
        OutsideDomain: The equations have no value there.
    """
    with localcontext(CONTEXT):
        try:
            known = {name: take(value) for name, value in inputs.items()}
            return reference.evaluate(function, known, exact, call)
        except ArithmeticError as error:  # e.g. the exponential of 1e300
            raise OutsideDomain from error


def error_in_envelopes(computed: float, bounded: Bounded) -> float:
    """The error k = |computed - exact| / (2^-53 envelope + 2^-1074).

    The floor of one smallest subnormal stands for results that no double is near.

    >>> error_in_envelopes(1.0, exact(1.0)), error_in_envelopes(float("nan"), exact(1.0))
    (0.0, inf)
    """
    return errors(computed, bounded)[0]


def distance_in_envelopes(one: float, other: float, bounded: Bounded) -> float:
    """How far two computed values are apart, in the unit of `error_in_envelopes`.

    >>> distance_in_envelopes(1.0, 1.0 + 2.0**-52, exact(1.0))
    2.0
    """
    if not (math.isfinite(one) and math.isfinite(other)):
        return math.inf
    with localcontext(CONTEXT):
        return float(abs(Decimal(one) - Decimal(other)) / (_UNIT * bounded.envelope + _FLOOR))


def errors(computed: float, bounded: Bounded) -> tuple[float, float]:
    """The error as of `error_in_envelopes`, and in units of the last place; 0 where terms cancel.

    Cancelling means an envelope of more than twice the magnitude: an error in units of the last
    place would say nothing there (6e11 of them with a perfect kernel).

    >>> errors(1.0 + 2.0**-52, exact(1.0))
    (2.0, 1.0)
    """
    value, envelope = bounded.value, bounded.envelope
    if not math.isfinite(computed):
        return math.inf, math.inf
    with localcontext(CONTEXT):
        error = abs(Decimal(computed) - value)
        k = float(error / (_UNIT * envelope + _FLOOR))
        if not error or envelope > 2 * abs(value):
            return k, 0.0
        return k, float(error / Decimal(math.ulp(float(value))))
