"""Exact numbers: decimals stay decimals, digits are counted before they cost anything."""

import tomllib
from decimal import Decimal
from fractions import Fraction
from time import process_time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadjoint.spec.core.decimals import read_float, read_number


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (3, Fraction(3)),
        (-(10**39), Fraction(-(10**39))),
        (Decimal("9.81"), Fraction(981, 100)),
        (Decimal("1e5"), Fraction(100000)),
        (Decimal("-2.5e-3"), Fraction(-1, 400)),
        (Decimal(0), Fraction(0)),
        ("0.1", Fraction(1, 10)),
        ("+3", Fraction(3)),
        ("-1/3", Fraction(-1, 3)),
        ("0.5/2", Fraction(1, 4)),
    ],
)
def test_numbers_are_exact(value, expected):
    """0.1 is one tenth, in quotes or without."""
    assert read_number(value) == expected


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (True, "is not a number"),
        (None, "is not a number"),
        (0.5, "is not a number"),
        ([], "is not a number"),
        ("abc", "is not a decimal number"),
        ("1e5", "is not a decimal number"),
        ("0x10", "is not a decimal number"),
        ("\u0663", "is not a decimal number"),
        ("1/0", "divides by zero"),
        (10**40, "INTEGER_DIGITS"),
        ("1" * 41, "INTEGER_DIGITS"),
        ("1/" + "1" * 41, "INTEGER_DIGITS"),
        ("0." + "1" * 41, "DECIMAL_DIGITS"),
        (Decimal("1e999999"), "INTEGER_DIGITS"),
        (Decimal("1e-999999"), "DECIMAL_DIGITS"),
        (read_float("1e99999999999999999999999"), "is not finite"),
        (read_float("nan"), "is not finite"),
        (read_float("-inf"), "is not finite"),
    ],
)
def test_what_is_no_number_is_refused_at_once(value, said):
    """Huge exponents and huge integers are refused without being multiplied out."""
    start = process_time()
    with pytest.raises(ValueError, match=said):
        read_number(value)
    assert process_time() - start < 2  # multiplied out it would never end


def test_integer_too_long_to_be_printed_is_refused():
    """Python refuses to print it, so the message must do without."""
    with pytest.raises(ValueError, match="INTEGER_DIGITS"):
        read_number(1 << 100_000)


@given(
    st.decimals(allow_nan=False, allow_infinity=False, places=6, min_value=-9999, max_value=9999)
)
def test_toml_floats_are_read_exactly(number):
    """A float of a file is the decimal that stands there."""
    value = tomllib.loads(f"x = {number:.6f}", parse_float=read_float)["x"]
    assert read_number(value) == Fraction(number)
