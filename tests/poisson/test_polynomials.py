"""Polynomials for searches: normal form, gradients, and the way from and to elements."""

from fractions import Fraction

import pytest

from coadjoint.errors import AlgebraError
from coadjoint.exact import Field
from coadjoint.poisson.polynomials import primitive, read_terms, slopes_modulo

PRIME = 2**61 - 1


def mixed():
    """A polynomial with fractions and mixed terms, as an element."""
    field = Field(["x", "y"])
    x, y = field["x"], field["y"]
    return field, (x / 2 - y) ** 3 * (x + 4) / 3 - y


def test_elements_come_back_as_they_were():
    """Reading a polynomial and writing it again changes nothing."""
    field, element = mixed()
    assert field.polynomial(field.names, read_terms(field, element, field.names)) == element
    assert read_terms(field, field.zero, field.names) == {}


def test_what_is_no_polynomial_is_refused():
    """A parameter, a quotient and a function each have their message."""
    field = Field(["x", "m"], slots=1)
    x, m = field["x"], field["m"]
    wrong = {"'m' is not a coordinate": m * x, "a quotient": 1 / x, "'exp'": field.call("exp", x)}
    for message, element in wrong.items():
        with pytest.raises(AlgebraError, match=message):
            read_terms(field, element, ["x"])


def test_the_primitive_multiple_has_coprime_integers_and_a_positive_lead():
    """-x^2/2 + 3 y/4 becomes 2 x^2 - 3 y."""
    result = primitive({(2, 0): Fraction(-1, 2), (0, 1): Fraction(3, 4)})
    assert dict(result) == {(2, 0): 2, (0, 1): -3}


def test_slopes_modulo_a_prime_are_the_gradient():
    """The modular gradient is the exact one of the element, at a point without zeros."""
    field, element = mixed()
    p = primitive(read_terms(field, element, field.names))
    scale = field.polynomial(field.names, p) / element
    point = {"x": Fraction(3), "y": Fraction(-5)}
    exact = {}
    for place, slope in enumerate(field.gradient(scale * element, field.names)):
        exact[place] = int(field.evaluate(slope, point, Fraction, None)) % PRIME
    assert slopes_modulo(p, [3, -5 % PRIME], PRIME) == exact
    assert len(exact) == 2
