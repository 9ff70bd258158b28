"""Trace pairings: components to matrices and back, and degenerate ones refused."""

import pytest

from coadjoint.algebra import algebra_by_name
from coadjoint.errors import AlgebraError
from coadjoint.exact.dense import product, trace, transpose
from coadjoint.theory import matrix_group, trace_pairing

PAIRS = [
    ("so(3)", "tr(mu^T xi)/2", "algebra"),
    ("so(3)", "tr(mu xi)", "algebra"),
    ("sl(2,R)", "tr(mu^T xi)", "algebra"),
    ("sl(3,R)", "tr(mu^T xi)", "algebra"),
    ("su(3)", "tr(mu^T xi)", "algebra"),
    ("sl(2,R)", "tr(mu xi)", "algebra"),
    ("se(3)", "tr(mu^T xi)", "algebra"),
    ("se(3)", "tr(mu xi)", "transposed"),
    ("h(1)", "tr(mu xi)", "transposed"),
    ("g(3)", "tr(mu^T xi)", "algebra"),
]


def check_pairing(group, form, pairing):
    """The trace of the matrix of mu and the matrix of xi is ``mu_i xi^i``."""
    mu, xi = group.vector("mu"), group.vector("xi")
    m, x = pairing.matrix(mu), group.matrix(xi)
    left = group.field.zero + trace(product(transpose(m) if "^T" in form else m, x))
    left = left / (2 if "/2" in form else 1)
    assert group.field.is_zero(left - sum(a * b for a, b in zip(mu, xi, strict=True)))
    assert pairing.components(m) == mu


@pytest.mark.parametrize(("name", "form", "space"), PAIRS)
def test_the_trace_is_the_pairing(name, form, space):
    """Matrices of covectors pair by the stated trace; a pairing twice as large is caught."""
    group = matrix_group(name.upper(), vectors=["mu", "xi"])
    pairing = trace_pairing(group.algebra, form, space)
    check_pairing(group, form, pairing)
    other = "tr(mu^T xi)" if form == "tr(mu^T xi)/2" else "tr(mu^T xi)/2"
    with pytest.raises(AssertionError):
        check_pairing(group, other, pairing)


def test_a_degenerate_pairing_is_refused_with_a_vector():
    """tr(mu xi) vanishes on the algebra of H(1): A1 pairs to zero with all of it."""
    with pytest.raises(AlgebraError, match="xi = A1 gives 0 for every mu") as refused:
        trace_pairing(algebra_by_name("h(1)"), "tr(mu xi)")
    assert (refused.value.algebra, refused.value.vector) == ("h(1)", "A1")


def test_a_degenerate_pairing_of_rigid_motions_is_refused():
    """tr(mu xi) does not see the translations of se(3)."""
    with pytest.raises(AlgebraError, match="degenerate") as refused:
        trace_pairing(algebra_by_name("se(3)"), "tr(mu xi)")
    assert refused.value.vector == "P1"


@pytest.mark.parametrize("word", ["tr(mu xi)/3", "trace(mu xi)"])
def test_an_unknown_form_is_refused(word):
    """The message has the word and the nearest form."""
    with pytest.raises(AlgebraError, match=r"Did you mean 'tr\(mu") as refused:
        trace_pairing(algebra_by_name("so(3)"), word)
    assert refused.value.found == word


def test_an_unknown_space_is_refused():
    """The message has the word and the nearest space."""
    with pytest.raises(AlgebraError, match=r"'transpose' is not a .* Did you mean 'transposed'"):
        trace_pairing(algebra_by_name("so(3)"), "tr(mu xi)", "transpose")
