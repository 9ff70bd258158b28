"""What the tests of groups share: comparison in the field, and vectors typed as in a book."""

from fractions import Fraction
from random import Random


def flat(values):
    """All numbers of a nest of tuples."""
    if isinstance(values, tuple | list):
        return [number for value in values for number in flat(value)]
    return [values]


def same(field, a, b):
    """Whether two nests of exact values are equal, number by number."""
    left, right = flat(a), flat(b)
    assert len(left) == len(right), "different shapes"
    return all(field.is_zero(field.zero + x - y) for x, y in zip(left, right, strict=True))


def check_agrees(field, found, book):
    """The engine's values equal the book's, ``book(1)``, and not the spoiled ``book(-1)``."""
    assert not all(field.is_zero(field.zero + x) for x in flat(found)), "nothing was computed"
    assert same(field, found, book(1))
    assert not same(field, found, book(-1)), "the comparison does not see the spoiled sign"


def random_point(group, seed):
    """An element at random small rational coordinates of the chart."""
    source = Random(seed)
    return group.point(
        [Fraction(source.choice((-1, 1)) * source.randint(1, 9), 5) for _ in group.symbols]
    )


def random_vector(group, seed):
    """Random nonzero rational components."""
    source = Random(seed)
    return group.field.vector(
        Fraction(source.choice((-1, 1)) * source.randint(1, 9), source.randint(1, 5))
        for _ in group.algebra.basis
    )


def dot(a, b):
    """``a . b``."""
    return sum(x * y for x, y in zip(a, b, strict=True))


def cross(a, b):
    """``a x b``."""
    (a1, a2, a3), (b1, b2, b3) = a, b
    return (a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1)


def plus(*vectors):
    """The sum of vectors."""
    return tuple(map(sum, zip(*vectors, strict=True)))


def times(factor, vector):
    """``factor v``."""
    return tuple(factor * x for x in vector)


def on(matrix, vector):
    """``A v``."""
    return tuple(dot(row, vector) for row in matrix)


def mul(a, b):
    """``A B``, by rows and columns."""
    return tuple(tuple(dot(row, column) for column in zip(*b, strict=True)) for row in a)


def turned(a):
    """``A^T``."""
    return tuple(zip(*a, strict=True))


def block(matrix, rows, columns):
    """The entries in ranges of rows and columns."""
    return tuple(tuple(matrix[r][c] for c in columns) for r in rows)
