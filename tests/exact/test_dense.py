"""Vectors and matrices as tuples: the products, against NumPy."""

import numpy as np
import pytest
import sympy

from coadjoint.exact.dense import (
    add,
    apply,
    combine,
    commutator,
    cross,
    determinant,
    diagonal,
    dot,
    hat,
    identity,
    inverse,
    minor,
    product,
    scale,
    subtract,
    total,
    trace,
    transpose,
    weighted_sum,
)


@pytest.fixture
def numbers():
    """Two integer vectors and two integer matrices."""
    source = np.random.default_rng(5)
    return [
        tuple(map(int, source.integers(-9, 9, 3))) if flat else integers(source)
        for flat in (True, True, False, False)
    ]


def integers(source):
    """A 3 x 3 matrix of integers."""
    return tuple(tuple(map(int, row)) for row in source.integers(-9, 9, (3, 3)))


def test_products_are_those_of_numpy(numbers):
    """Every operation on integers equals NumPy's, and the order of a product matters."""
    a, b, A, B = numbers
    assert dot(a, b) == np.dot(a, b)
    assert cross(a, b) == tuple(np.cross(a, b))
    assert cross(a, b) != cross(b, a)
    assert add(a, scale(-1, b)) == subtract(a, b) == tuple(np.subtract(a, b))
    assert np.array_equal(product(A, B), np.array(A) @ B)
    assert product(A, B) != product(B, A)
    assert np.array_equal(commutator(A, B), np.array(A) @ B - np.array(B) @ A)
    assert np.array_equal(apply(A, a), np.array(A) @ a)
    assert np.array_equal(transpose(A), np.transpose(A))
    assert np.array_equal(combine((1, A), (3, B)), np.array(A) + 3 * np.array(B))
    assert trace(A) == np.trace(A)
    assert product(A, identity(3)) == A


def test_determinants_and_inverses_are_those_of_sympy():
    """Of 1 to 4 rows, fractions throughout; a minor is the determinant of what is chosen."""
    source = np.random.default_rng(7)
    for size in range(1, 5):
        rows = tuple(tuple(map(int, row)) for row in source.integers(1, 9, (size, size)))
        reference = sympy.Matrix(rows)
        assert determinant(rows) == reference.det() != 0
        assert product(rows, inverse(rows)) == identity(size)
        assert inverse(rows) == tuple(map(tuple, reference.inv().tolist()))
    assert minor(rows, (0, 2), (1, 3)) == reference.extract([0, 2], [1, 3]).det()


def test_a_singular_matrix_has_no_inverse():
    """Its determinant is zero, and dividing by that is an error."""
    with pytest.raises(ZeroDivisionError):
        inverse(((1, 2), (2, 4)))


def test_sparse_matrices_are_weighted():
    """The sum of multiples, with the zero that is asked for elsewhere."""
    assert weighted_sum([2, 3], [{(0, 1): 1}, {(1, 1): 5, (0, 1): 1}], 2, "none") == (
        ("none", 5),
        ("none", 15),
    )
    assert diagonal((4, 5)) == ((4, 0), (0, 5))


def test_the_hat_of_a_vector_is_its_cross_product():
    """``hat(a) b = a x b``, against NumPy; and it is antisymmetric."""
    a, b = (2, 3, 5), (7, 11, 13)
    assert apply(hat(a), b) == tuple(np.cross(a, b))
    assert transpose(hat(a)) == scale(-1, hat(a))


def test_products_with_zero_are_passed_over():
    """What is skipped changes nothing, and a product of zeros is zero."""
    assert dot((0, 2, 0), (7, 3, 9)) == 6
    assert dot((0, 0), (1, 2)) == 0
    assert total(range(101)) == 5050


def test_different_lengths_are_refused():
    """A vector that is too short is an error, not a shorter sum."""
    with pytest.raises(ValueError, match="shorter"):
        dot((1, 2, 3), (1, 2))
