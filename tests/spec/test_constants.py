"""Defaults by formulas of numbers: exact where they are rational, else the nearest double, once."""

from fractions import Fraction
from math import nextafter

import mpmath
import pytest

from coadjoint.derive import derive
from coadjoint.errors import SpecError
from coadjoint.prove.candidates import about_candidates
from coadjoint.prove.constrained import motion_of
from coadjoint.spec.core.constants import Rounded, read_constant
from tests.specs import RIGID_BODY, spec

DEFAULT = "default = [1, 2, 3]"


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("cos(pi/3)", Fraction(1, 2)),
        ("sqrt(4)/3", Fraction(2, 3)),
        ("(sqrt(5) + 1)*(sqrt(5) - 1)", 4),
        ("sqrt(2)*sqrt(3) - sqrt(6)", 0),
        ("cos(2*pi/7) + cos(4*pi/7) + cos(6*pi/7)", Fraction(-1, 2)),
    ],
)
def test_what_is_rational_is_exact(text, value):
    """Also where floats are not: relations of functions are known."""
    found = read_constant(text)
    assert found == value
    assert not isinstance(found, Rounded)


@pytest.mark.parametrize(
    ("text", "digits"),
    [
        ("sqrt(5)", lambda: mpmath.sqrt(5)),
        ("2*cos(2*pi/7)", lambda: 2 * mpmath.cos(2 * mpmath.pi / 7)),
        ("-pi/1000000007", lambda: -mpmath.pi / 1000000007),
        ("exp(1) - 2.718281828459045", lambda: mpmath.e - mpmath.mpf("2.718281828459045")),
    ],
)
def test_what_is_irrational_is_the_nearest_double(text, digits):
    """Closer to the value, in 50 digits, than the doubles next to it."""
    found = read_constant(text)
    assert isinstance(found, Rounded)
    with mpmath.workdps(50):
        value = digits()
        sides = [nextafter(float(found), end) for end in (-1e9, 1e9)]
        assert abs(value - float(found)) < min(abs(value - side) for side in sides)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("sqrt(-2)", "not a real number"),
        ("1/(sqrt(2)*sqrt(3) - sqrt(6))", "has no value"),
        ("tan(pi/2)", "has no value"),
        ("a", "'a' is not declared"),
        ("norm(vector(1, 2))", "calls norm"),
        ("sqrt(2", "never closed"),
    ],
)
def test_what_has_no_value_is_refused_at_its_key(text, says):
    """With what is wrong, and what would be accepted."""
    with pytest.raises(SpecError, match="'sqrt\\(2\\)/2'") as caught:
        spec(RIGID_BODY, (DEFAULT, f'default = [1, 2, "{text}"]'))
    assert says in str(caught.value)


#: A rigid body with one symmetry, whose third structure constant is a parameter.
SYMMETRIC = """
title = "A body"
routes = ["lie-poisson"]
[algebra]
basis = ["e1", "e2", "e3"]
brackets = { "[e1, e2]" = "a*e3", "[e2, e3]" = "e1", "[e3, e1]" = "e2" }
[variables]
x = { role = "momentum" }
[parameters]
a = { default = 2 }
[hamiltonian]
h = "dot(x, x)/2"
"""


def test_no_statement_takes_a_rounded_number_for_the_constant():
    """What is said at irrational default parameters is said of doubles, and says so."""
    for text, said in (("sqrt(4)", ""), ("sqrt(5)", " as doubles")):
        declared = spec(SYMMETRIC, ("default = 2", f'default = "{text}"'))
        statements = [
            statement for statement, _, _ in about_candidates(motion_of(derive(declared)))
        ]
        assert f"x3 is conserved at the default parameters{said}" in statements
