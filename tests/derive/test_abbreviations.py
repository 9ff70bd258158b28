"""Abbreviated formulas are equal to what they stand for, and shorter."""

from __future__ import annotations

import pytest
import sympy

from coadjoint.derive.abbreviations import LONGEST, abbreviate, number_names

x, y, a = sympy.symbols("x y a")
LONG = tuple(sum((x - a * y) ** n * (x + n) for n in range(1, 12)) * each for each in (x, y))


def put_back(parts, values):
    """Formulas without abbreviations, from the last one on."""
    for part, value in reversed(parts):
        values = [each.subs(part, value) for each in values]
    return values


def check_same(parts, short, values):
    """Each abbreviated formula is the given one, in exact arithmetic."""
    assert parts, "nothing was abbreviated"
    for given, found in zip(values, put_back(parts, short), strict=True):
        assert sympy.expand(given - found) == 0, given


def test_abbreviated_formulas_are_the_given_ones():
    """And take fewer operations; every name is read after it is defined."""
    parts, short = abbreviate(LONG, number_names(["x", "y", "a"]))
    check_same(parts, short, LONG)
    own = [part for part, _ in parts]
    for n, (_, value) in enumerate(parts):
        assert value.free_symbols <= {x, y, a, *own[:n]}
    count = sum(value.count_ops() for value in (*short, *(value for _, value in parts)))
    assert count < 0.6 * sum(value.count_ops() for value in LONG)


def test_a_wrong_abbreviation_is_seen():
    """The check above can fail."""
    ((part, value), *others), short = abbreviate(LONG, number_names(["x", "y", "a"]))
    with pytest.raises(AssertionError):
        check_same([(part, value + 1), *others], short, LONG)


def test_short_formulas_stay_as_they_are():
    """Up to the bound on operations."""
    values = (x + x * y, (x * y) ** 2)
    assert max(value.count_ops() for value in values) <= LONGEST
    assert abbreviate(values, number_names([])) == ((), values)


def test_names_of_parts_begin_with_a_letter_of_their_own():
    """No other name does."""
    assert next(number_names(["x"])).name == "w1"
    assert next(number_names(["w_1", "x"])).name == "u1"
