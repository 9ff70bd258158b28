"""Plain polynomials: arithmetic, normal form, and the way from and to elements."""

from fractions import Fraction

from coadjoint.exact import Field
from coadjoint.poisson.polynomials import Polynomial, read_polynomial

PRIME = 2**61 - 1


def mixed():
    """A polynomial with fractions and mixed terms, as an element."""
    field = Field(["x", "y"])
    x, y = field["x"], field["y"]
    return field, (x / 2 - y) ** 3 * (x + 4) / 3 - y


def test_elements_come_back_as_they_were():
    """Reading a polynomial and writing it again changes nothing."""
    field, element = mixed()
    assert read_polynomial(field, element, field.names).element(field, field.names) == element
    assert Polynomial({}).element(field, field.names) == 0


def test_the_primitive_multiple_has_coprime_integers_and_a_positive_lead():
    """-x^2/2 + 3 y/4 becomes 2 x^2 - 3 y."""
    found = Polynomial({(2, 0): Fraction(-1, 2), (0, 1): Fraction(3, 4)}).primitive()
    assert found.terms == {(2, 0): 2, (0, 1): -3}
    assert all(type(value) is int for value in found.terms.values())


def test_slopes_modulo_a_prime_are_the_gradient():
    """The modular gradient is the exact one of the element, at a point without zeros."""
    field, element = mixed()
    p = read_polynomial(field, element, field.names).primitive()
    scale = p.element(field, field.names) / element
    point = {"x": Fraction(3), "y": Fraction(-5)}
    exact = {}
    for place, slope in enumerate(field.gradient(scale * element, field.names)):
        exact[place] = int(field.evaluate(slope, point, Fraction, None)) % PRIME
    assert p.slopes_modulo([3, -5 % PRIME], PRIME) == exact
    assert len(exact) == 2
