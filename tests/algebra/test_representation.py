"""Representations: the homomorphism law, duals, diamond, semidirect products."""

import pytest

from coadjoint.algebra import Representation, algebra_by_name, semidirect_product
from coadjoint.algebra.catalogue import representation_by_name
from coadjoint.errors import AlgebraError
from tests.algebra.laws import vector
from tests.sources.components import cross


def test_vector_representation_of_so3_is_the_cross_product():
    """rho(xi) a = xi x a."""
    vectors = representation_by_name(algebra_by_name("so(3)"), "vector")
    xi, a = vector(3, 1), vector(3, 2)
    assert list(vectors.act(xi, a)) == cross(xi, a)


def test_diamond_of_so3_is_the_torque_of_the_book():
    """The diamond b <> a is b x a for vectors (Holm 2011, section 8.2)."""
    vectors = representation_by_name(algebra_by_name("so(3)"), "vector")
    b, a = vector(3, 3), vector(3, 4)
    assert list(vectors.diamond(b, a)) == cross(b, a)


def test_coadjoint_representation_is_minus_ad_star():
    """rho(xi) mu = -ad*_xi mu."""
    se3 = algebra_by_name("se(3)")
    xi, mu = vector(6, 8), vector(6, 9)
    acted = representation_by_name(se3, "coadjoint").act(xi, mu)
    assert list(acted) == [-x for x in se3.ad_star(xi, mu)]


def test_semidirect_product_of_so3_with_vectors_is_se3():
    """so(3) (s) R^3 by construction equals se(3) by its 4 x 4 matrices."""
    so3 = algebra_by_name("so(3)")
    built = semidirect_product(so3, [("P", representation_by_name(so3, "vector"))])
    assert built.constants == algebra_by_name("se(3)").constants
    assert built.basis == algebra_by_name("se(3)").basis


def test_matrices_that_do_not_commute_like_the_algebra_are_refused():
    """Flip one entry of the vector representation and the pair at fault is named."""
    so3 = algebra_by_name("so(3)")
    vectors = representation_by_name(so3, "vector")
    spoiled = [dict(matrix) for matrix in vectors.matrices]
    spoiled[0][2, 1] = -spoiled[0][2, 1]
    with pytest.raises(AlgebraError, match=r"'spoiled'.*do not commute like \[J1, J2\]"):
        Representation(so3, "spoiled", 3, tuple(spoiled))


def test_unknown_representation_lists_what_there_is():
    """The message offers the known names."""
    with pytest.raises(AlgebraError, match="'spinor'; expected 'vector', 'dual'"):
        representation_by_name(algebra_by_name("so(3)"), "spinor")
