"""Trees that parts of equal members compute are compared as polynomials, divisors and roots out."""

from __future__ import annotations

import pytest
import sympy

from coadjoint.lower.equal_trees import are_equal, find_polynomials

x, y, z = sympy.symbols("x y z")
R = sympy.sqrt(x**2 + y**2)
#: Pairs of one value.
PAIRS = {
    "divisor": (x * (1 + y / x), x + y),
    "factors of a divisor": (1 / (x**2 - y**2), 1 / (x - y) / (x + y)),
    "nested divisors": (1 / (x + 1 / y), y / (x * y + 1)),
    "powers of a root": (x / R**5, x / (R * (x**2 + y**2) ** 2)),
    "root of an expanded square": (sympy.sqrt((x - y) ** 2 + z), sympy.sqrt((y - x) ** 2 + z)),
    "root of a number": (sympy.sqrt(2) * x / 2, x / sympy.sqrt(2)),
    "root in a divisor": ((R - 1) / (R**2 - 1), 1 / (R + 1)),
    "root of a quotient": (sympy.sqrt(1 + x / y) ** 3, sympy.sqrt((x + y) / y) * (1 + x / y)),
}


@pytest.mark.parametrize("name", PAIRS)
def test_equal_trees_are_told_without_expanding(name: str) -> None:
    """Polynomials alone tell that they are equal, and of spoiled ones that they are not."""
    one, other = PAIRS[name]
    polynomials = find_polynomials([one, other], roots=True)
    assert polynomials is not None
    assert polynomials.is_same() == (name != "root of a quotient")  # roots of two forms
    for wrong in (1, x, R):
        spoiled = find_polynomials([one, other + wrong / 1000], roots=True)
        assert spoiled is not None
        assert not spoiled.is_same()


@pytest.mark.parametrize("name", PAIRS)
def test_an_independent_evaluation_agrees(name: str) -> None:
    """The pairs are what they are said to be."""
    one, other = PAIRS[name]
    at = {x: sympy.Rational(7, 3), y: sympy.Rational(2, 5), z: sympy.Rational(1, 9)}
    assert abs((one - other).xreplace(at).evalf(40)) < sympy.Float(10) ** -35


def test_functions_in_divisors_are_compared_where_they_stand() -> None:
    """A divisor that calls a function is no polynomial, and stays what it is."""
    one = 1 / (1 + sympy.sin(x))
    assert are_equal(one + y, y + one)
    assert are_equal((x + y) ** 2 * one, (x**2 + 2 * x * y + y**2) * one)
    assert not are_equal(one + y, y + 2 * one)


def test_trees_without_a_value_on_one_side_of_a_kink_are_compared_on_the_other() -> None:
    """Members are in no order: both sides are seen, and a side without a value is left out."""
    gap = x - y
    largest = gap * (1 + sympy.sign(gap)) / 2
    slope = sympy.sin(z) / sympy.sqrt(largest)
    assert are_equal(slope, sympy.sin(z) * sympy.sqrt(largest) / gap * 2 / (1 + sympy.sign(gap)))
    for wrong in (1 + largest, 1 + largest.xreplace({x: y, y: x})):
        assert not are_equal(sympy.sin(z) * (1 + wrong), sympy.sin(z) * 2)
    assert not are_equal(slope, slope * 2)
    assert not are_equal(slope * sympy.nan, slope)
    nowhere = sympy.sin(z) / (sympy.sign(x) - 1)  # all points are positive
    assert not are_equal(nowhere, nowhere * (1 + x))


def test_slopes_see_what_roots_depend_on() -> None:
    """Where a tree is differentiated, nothing is hidden in a root, and divisors are told."""
    assert find_polynomials([R]) is None
    divided = find_polynomials([1 / x])
    assert divided is not None
    assert divided.divisors == {x}
