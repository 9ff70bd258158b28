"""Gradings of a bracket: one shift for all entries, and the reflections of so(4)."""

import pytest

from coadjoint.algebra import algebra_by_name
from coadjoint.poisson.casimirs import lie_poisson_dual
from coadjoint.poisson.gradings import Gradings
from coadjoint.poisson.polynomial_bracket import PolynomialBracket

#: Products of coordinates by their places.
PRODUCTS = [*((n,) for n in range(6)), (0, 5), (1, 4), (2, 3), (0, 0), (3, 3)]


def product(size, *places):
    """The exponents of a product of coordinates."""
    return tuple(places.count(n) for n in range(size))


def check_graded(entries, gradings):
    """Terms of {x_i, x_j} have the weight of x_i x_j, up to one shift."""
    shifts = set()
    for (i, j), entry in entries.items():
        for exponents in entry:
            term = gradings.weight(exponents)
            pair = gradings.weight(product(len(exponents), i, j))
            difference = tuple(a - b for a, b in zip(term[0], pair[0], strict=True))
            shifts.add((difference, term[1] ^ pair[1]))
    assert len(shifts) == 1


@pytest.mark.parametrize("name", ["so(4)", "g(3)", "su(3)"])
def test_gradings_are_gradings(name):
    """Every entry of the bracket has the weight of its pair, up to one shift."""
    bracket = PolynomialBracket(lie_poisson_dual(algebra_by_name(name)))
    check_graded(bracket.entries, Gradings(bracket.entries, bracket.size))


def test_the_check_of_gradings_sees_a_changed_entry():
    """The check above can fail: {E12, E13} = E34 has another weight."""
    bracket = PolynomialBracket(lie_poisson_dual(algebra_by_name("so(4)")))
    gradings = Gradings(bracket.entries, bracket.size)
    with pytest.raises(AssertionError):
        check_graded({**bracket.entries, (0, 1): {(0, 0, 0, 0, 0, 1): 1}}, gradings)


def test_gradings_split_the_monomials():
    """so(4) is graded by the degree and by three reflections."""
    bracket = PolynomialBracket(lie_poisson_dual(algebra_by_name("so(4)")))
    gradings = Gradings(bracket.entries, bracket.size)
    weight = {places: gradings.weight(product(6, *places)) for places in PRODUCTS}
    assert len({weight[place,] for place in range(6)}) == 6
    assert weight[0, 5] == weight[1, 4] == weight[2, 3]
    assert weight[0, 0] == weight[3, 3] != weight[0, 5]
