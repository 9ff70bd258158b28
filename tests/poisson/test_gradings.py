"""Gradings of a bracket: one shift for all entries, and the reflections of so(4)."""

import pytest

from coadjoint.algebra import algebra_by_name
from coadjoint.poisson.casimirs import lie_poisson_dual
from coadjoint.poisson.gradings import Gradings
from coadjoint.poisson.polynomial_bracket import PolynomialBracket
from coadjoint.poisson.polynomials import coordinate


def check_graded(entries, gradings):
    """Terms of {x_i, x_j} have the weight of x_i x_j, up to one shift."""
    shifts = set()
    for (i, j), entry in entries.items():
        for exponents in entry.terms:
            term = gradings.weight([k for k, e in enumerate(exponents) for _ in range(e)])
            pair = gradings.weight([i, j])
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
        check_graded({**bracket.entries, (0, 1): coordinate(5, 6)}, gradings)


def test_gradings_split_the_monomials():
    """so(4) is graded by the degree and by three reflections."""
    bracket = PolynomialBracket(lie_poisson_dual(algebra_by_name("so(4)")))
    gradings = Gradings(bracket.entries, bracket.size)
    assert len({gradings.weight([i]) for i in range(6)}) == 6
    assert gradings.weight([0, 5]) == gradings.weight([1, 4]) == gradings.weight([2, 3])
    assert gradings.weight([0, 0]) == gradings.weight([3, 3]) != gradings.weight([0, 5])
