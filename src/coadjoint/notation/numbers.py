"""Numbers of many digits, as a person reads them: ``about 3.491``, ``2^61 - 1``.

Records keep every digit for programs. Comes in: a text, such as the method of a claim. Goes out:
the same text with few digits. Read next: `coadjoint.chapter`.
"""

from __future__ import annotations

import re
from typing import Final

#: Significant digits beyond which a decimal is shortened, and how many are left of it.
MOST, LEFT = 6, 4
#: Digits beyond which a whole number is told by a power of two, and how far it may be from one.
LONG, NEAR = 16, 10_000
_NUMBER: Final = re.compile(
    r"(?P<lead>the value |= )?(?<![\w./])(?P<number>-?\d+(?:\.\d+)?(?:e[-+]?\d+)?)(?![\w/]|\.\d)"
)
_LEADS: Final = {"the value ": "a value of about ", "= ": "~= ", "": "about "}


def shorten_numbers(text: str) -> str:
    """A text with few digits, and a word where this rounds.

    Fractions stay, which are exact; so do whole numbers that are near no power of two.

    >>> shorten_numbers("the value 3.49148624377588 at x = -34.7083333333, y = 1/3")
    'a value of about 3.491 at x ~= -34.71, y = 1/3'
    >>> shorten_numbers("ranks modulo 2305843009213693951")
    'ranks modulo 2^61 - 1'
    """
    return _NUMBER.sub(_shorten, text)


def _shorten(found: re.Match[str]) -> str:
    lead, number = found["lead"] or "", found["number"]
    mantissa = number.lstrip("-").partition("e")[0]
    if "." in mantissa and len(mantissa.replace(".", "").lstrip("0")) > MOST:
        digits, _, exponent = f"{float(number):.{LEFT}g}".partition("e")
        return _LEADS[lead] + (f"{digits}*10^{int(exponent)}" if exponent else digits)
    if number.isdigit() and len(number) > LONG:
        bits = int(number).bit_length()
        if 0 < 2**bits - int(number) < NEAR:
            return f"{lead}2^{bits} - {2**bits - int(number)}"
    return found[0]
