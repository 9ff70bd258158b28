"""Vectors and matrices as tuples: the products, against NumPy."""

import numpy as np
import pytest

from coadjoint.groups.vectors import (
    add,
    apply,
    combine,
    commutator,
    cross,
    dot,
    identity,
    matmul,
    scale,
    subtract,
    trace,
    transpose,
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
    assert np.array_equal(matmul(A, B), np.array(A) @ B)
    assert matmul(A, B) != matmul(B, A)
    assert np.array_equal(commutator(A, B), np.array(A) @ B - np.array(B) @ A)
    assert np.array_equal(apply(A, a), np.array(A) @ a)
    assert np.array_equal(transpose(A), np.transpose(A))
    assert np.array_equal(combine(A, B, 3), np.array(A) + 3 * np.array(B))
    assert trace(A) == np.trace(A)
    assert matmul(A, identity(3)) == A


def test_different_lengths_are_refused():
    """A vector that is too short is an error, not a shorter sum."""
    with pytest.raises(ValueError, match="shorter"):
        dot((1, 2, 3), (1, 2))
