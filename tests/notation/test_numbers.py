"""Numbers that people read are short, and what is printed of them stays true."""

from __future__ import annotations

import re

import pytest

from coadjoint.notation.numbers import shorten_numbers
from coadjoint.notation.prose import Formula, read_prose


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("the value -1.77103219668773 at xi = -3/5", "a value of about -1.771 at xi = -3/5"),
        ("x = -34.708333333333333, y = 2", "x ~= -34.71, y = 2"),
        ("it is 123456.789", "it is about 1.235*10^5"),
        ("the value 1.23456789e-7", "a value of about 1.235*10^-7"),
        ("modulo 2305843009213693723, twice", "modulo 2^61 - 229, twice"),
    ],
)
def test_long_numbers_are_told_in_few_digits(text, expected):
    """With a word or a sign where that rounds."""
    assert shorten_numbers(text) == expected


@pytest.mark.parametrize(
    "text",
    [
        "the value 2490503569808149/6320239627680 at r = 6",
        "x = 2.5, y = 0.125",
        "1773323503435947839 at a random point",
        "Holm 2011, section 9.1",
        "ranks at 105 points, dh/dOmega1 = 1/3",
        "the value 7 at x = 2",
    ],
)
def test_exact_numbers_and_short_ones_stay(text):
    """What is not rounded is told as it was."""
    assert shorten_numbers(text) == text


def test_what_is_about_equal_is_a_formula():
    """The sign of it is read, and the power of ten."""
    parts = read_prose(shorten_numbers("at x = -34.708333333333333, y = 1234567.89"))
    written = [each.written.latex for each in parts if isinstance(each, Formula)]
    assert written == [r"x \approx -34.71", r"y \approx 1.235 \times {10}^{6}"]
    assert not re.search("~", "".join(each for each in parts if isinstance(each, str)))
