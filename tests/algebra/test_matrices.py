"""Sparse matrices: products, blocks, real forms of complex matrices."""

import random

from coadjoint.algebra.matrices import (
    block_diagonal,
    combination,
    commutator,
    entries_text,
    kronecker,
    product,
    realify,
    size,
    transpose,
)


def random_matrix(source, n):
    """A dense matrix with some zeros."""
    return [[source.randint(-2, 2) for _ in range(n)] for _ in range(n)]


def sparse(rows):
    """Its nonzero entries."""
    return {(r, c): x for r, row in enumerate(rows) for c, x in enumerate(row) if x}


def times(a, b):
    """The product of dense matrices."""
    return [
        [sum(x * y for x, y in zip(row, col, strict=True)) for col in zip(*b, strict=True)]
        for row in a
    ]


def test_product_and_commutator_are_those_of_dense_matrices():
    """Entry by entry on random matrices; what vanishes is left out."""
    source = random.Random(1)
    for _ in range(20):
        a, b = random_matrix(source, 3), random_matrix(source, 3)
        ab, ba = times(a, b), times(b, a)
        assert product(sparse(a), sparse(b)) == sparse(ab)
        difference = [
            [x - y for x, y in zip(*rows, strict=True)] for rows in zip(ab, ba, strict=True)
        ]
        assert commutator(sparse(a), sparse(b)) == sparse(difference)
        assert transpose(sparse(a)) == sparse(zip(*a, strict=True))
    assert combination([(2, {(0, 0): 1}), (-1, {(0, 0): 2})]) == {}


def test_real_forms_multiply_as_complex_matrices_do():
    """(A + iB)(C + iD) has the real form of the product."""
    source = random.Random(2)
    a, b, c, d = (random_matrix(source, 2) for _ in range(4))

    def plus(p, q, sign):
        return sparse(
            [[x + sign * y for x, y in zip(*r, strict=True)] for r in zip(p, q, strict=True)]
        )

    real, imaginary = plus(times(a, c), times(b, d), -1), plus(times(a, d), times(b, c), 1)
    left, right = realify(sparse(a), sparse(b), 2), realify(sparse(c), sparse(d), 2)
    assert product(left, right) == realify(real, imaginary, 2) != {}


def test_blocks_and_kronecker_products():
    """Places of the entries, and the mixed-product rule."""
    source = random.Random(3)
    a, b, c, d = (sparse(random_matrix(source, 2)) for _ in range(4))
    left = product(kronecker(a, b, 2), kronecker(c, d, 2))
    assert left == kronecker(product(a, c), product(b, d), 2) != {}
    assert block_diagonal([[{(0, 0): 1}, {}], [{}, {(0, 1): 2}]]) == ({(0, 0): 1}, {(1, 2): 2})
    assert (size([{(0, 3): 1}, {}]), size([{}])) == (4, 0)
    assert entries_text({(1, 0): 2, (0, 1): -1}) == "(1, 2): -1, (2, 1): 2"
