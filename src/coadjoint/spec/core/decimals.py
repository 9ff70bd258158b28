"""Numbers: exact values from the numbers of a TOML file.

Comes in: what tomllib returns, with floats kept as `Decimal`, or a decimal in quotes. Goes out: a
`Fraction`, or a ValueError that says why not. Digits are counted before anything is multiplied out,
so that 1e999999999 costs nothing.
"""

from __future__ import annotations

import re
from decimal import Decimal, InvalidOperation
from fractions import Fraction

from coadjoint.limits import DECIMAL_DIGITS, INTEGER_DIGITS

_TEXT = re.compile(r"([-+]?)(\d+)(?:\.(\d+))?(?:/(\d+))?", re.ASCII)


def read_float(text: str) -> Decimal:
    """A TOML float, for `tomllib.loads(parse_float=...)`; what Decimal cannot hold becomes NaN."""
    try:
        return Decimal(text)
    except InvalidOperation:
        return Decimal("NaN")


def is_number_text(text: str) -> bool:
    """Whether a text is meant as a number, such as ``9.81`` or ``1/3``."""
    return _TEXT.fullmatch(text) is not None


def read_number(value: object) -> Fraction:
    """An exact number.

    Raises:
        ValueError: Not a number, or too many digits.

    >>> read_number("9.81"), read_number(3), read_number("1/3")
    (Fraction(981, 100), Fraction(3, 1), Fraction(1, 3))
    """
    if isinstance(value, bool) or not isinstance(value, (int, Decimal, str)):
        raise ValueError("is not a number")
    if isinstance(value, int):
        if value.bit_length() > 4 * INTEGER_DIGITS or abs(value) >= 10**INTEGER_DIGITS:
            raise ValueError(f"has more than {INTEGER_DIGITS} digits (INTEGER_DIGITS)")
        return Fraction(value)
    if isinstance(value, str):
        return _from_text(value)
    digits, exponent = value.as_tuple()[1:]
    if not isinstance(exponent, int):
        raise ValueError("is not finite")
    _check_digits(len(digits) + exponent, -exponent)
    return Fraction(value)


def _from_text(text: str) -> Fraction:
    match = _TEXT.fullmatch(text)
    if match is None:
        raise ValueError("is not a decimal number")
    _, whole, decimals, divisor = match.groups(default="")
    _check_digits(max(len(whole), len(divisor)), len(decimals))
    if divisor and int(divisor) == 0:
        raise ValueError("divides by zero")
    sign = -1 if text.startswith("-") else 1
    value = Fraction(f"{whole}.{decimals}" if decimals else whole)
    return sign * value / (int(divisor) if divisor else 1)


def _check_digits(whole: int, decimals: int) -> None:
    if whole > INTEGER_DIGITS:
        raise ValueError(f"has more than {INTEGER_DIGITS} digits (INTEGER_DIGITS)")
    if decimals > DECIMAL_DIGITS:
        raise ValueError(f"has more than {DECIMAL_DIGITS} decimals (DECIMAL_DIGITS)")
