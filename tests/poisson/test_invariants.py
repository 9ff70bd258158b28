"""Invariants of the matrix that stands for a covector, counted and proved."""

import pytest

from coadjoint.algebra import algebra_by_name
from coadjoint.errors import AlgebraError
from coadjoint.exact.ranks import generic_rank
from coadjoint.limits import INVARIANT_TERMS
from coadjoint.poisson.casimirs import casimirs, lie_poisson_dual
from coadjoint.poisson.invariants import dual_matrix, has_trace_form, matrix_invariants
from coadjoint.poisson.polynomial_bracket import PolynomialBracket
from coadjoint.poisson.polynomials import ring_of


@pytest.mark.parametrize(
    "name",
    ["so(4)", "so(5)", "so(3,1)", "so(4,2)", "su(2)", "su(3)", "u(2)", "gl(2)", "sl(3,R)", "sp(4)"],
)
def test_matrix_invariants_are_as_many_as_the_search_finds(name):
    """Traces, sums of Pfaffians and the Pfaffian alone give every Casimir of these algebras."""
    algebra = algebra_by_name(name)
    structure = lie_poisson_dual(algebra)
    invariants = matrix_invariants(algebra, PolynomialBracket(structure))
    elements = [structure.field.polynomial(structure.names, p) for p in invariants]
    assert all(map(structure.is_casimir, elements))
    slopes = [structure.gradient(element) for element in elements]
    assert generic_rank(structure.field, slopes) == algebra.dimension - algebra.generic_rank() > 0


def test_the_polynomial_test_of_casimirs_can_fail():
    """A wrong coefficient in a matrix invariant is caught by the proof beside it."""
    algebra = algebra_by_name("so(4)")
    bracket = PolynomialBracket(lie_poisson_dual(algebra))
    good = matrix_invariants(algebra, bracket)[0]
    assert bracket.is_casimir(good)
    assert not bracket.is_casimir(good - 2 * good.leading_term())


def test_the_dual_matrix_pairs_with_the_basis():
    """tr(M e_i) is the same multiple of mu_i for all generators of sp(4)."""
    algebra = algebra_by_name("sp(4)")
    dual, factors = dual_matrix(algebra), set()
    for i, matrix in enumerate(algebra.matrices):
        trace = sum(dual[c, r] * value for (r, c), value in matrix.items() if (c, r) in dual)
        factors.add(trace.LC)
        assert trace == ring_of(10).gens[i] * trace.LC
    assert len(factors) == 1


def test_a_degenerate_trace_form_is_refused_with_a_vector():
    """In se(3) the translations are orthogonal to everything."""
    algebra = algebra_by_name("se(3)")
    assert not has_trace_form(algebra)
    with pytest.raises(AlgebraError, match=r"trace form is degenerate: .*P1") as caught:
        dual_matrix(algebra)
    assert caught.value.vector == {"P1": "1"}


def test_invariants_beyond_the_limit_are_left_out_and_said():
    """so(10) has Casimirs of degree 6 and 8 that are not multiplied out."""
    search = casimirs(algebra_by_name("so(10)"), 2)
    assert (len(search.generators), search.expected, search.degree) == (3, 5, 2)
    assert f"take at most {INVARIANT_TERMS} products" in search.missing
