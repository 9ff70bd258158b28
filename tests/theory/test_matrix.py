"""Matrices over exact values: adjugates, inverses, logarithms, coordinates."""

from fractions import Fraction

import pytest
import sympy

from coadjoint.exact import Field
from coadjoint.exact.dense import (
    apply,
    commutator,
    identity,
    inverse,
    product,
    scale,
    subtract,
    trace,
    transpose,
    weighted_sum,
)
from coadjoint.theory import matrix as m

A = ((2, 1, 0), (3, -1, 4), (1, 1, 5))
J = ((0, 0, -1, 0), (0, 0, 0, -1), (1, 0, 0, 0), (0, 1, 0, 0))


def exactly(matrix):
    """Integers as fractions, so that division is exact."""
    return tuple(tuple(map(Fraction, row)) for row in matrix)


def complex_matrix(real, imaginary):
    """``A + i B`` as ``[[A, -B], [B, A]]``."""
    top = [(*a, *(-x for x in b)) for a, b in zip(real, imaginary, strict=True)]
    return (*top, *((*b, *a) for a, b in zip(real, imaginary, strict=True)))


def test_determinant_and_inverse_are_those_of_sympy():
    """The traces give the determinant and inverse that an independent program gives."""
    reference = sympy.Matrix(A)
    assert m.determinant(exactly(A)) == (reference.det(), 0)
    assert product(A, inverse(exactly(A))) == identity(3)
    assert inverse(exactly(A)) != exactly(A)


def test_the_complex_determinant_is_that_of_sympy():
    """With a complex structure the determinant is that of half the size."""
    real, imaginary = ((1, 2), (0, 3)), ((4, 0), (1, -1))
    reference = (sympy.Matrix(real) + sympy.I * sympy.Matrix(imaginary)).det()
    a, b = m.determinant(exactly(complex_matrix(real, imaginary)), J)
    assert sympy.expand(reference) == a + b * sympy.I
    assert b != 0


@pytest.mark.parametrize("structure", [None, J])
def test_the_resolvent_inverts(structure):
    """``(1 - a) adj = det`` with ``det`` a complex number where there is a structure."""
    a = exactly(complex_matrix(((1, 2), (0, 3)), ((4, 0), (1, -1))))
    adjugate, d = m.resolvent(a, structure)
    expected = scale(d[0], identity(4))
    if structure:
        expected = m.complex_multiple(d, J)
    one_less_a = subtract(identity(4), a)
    assert product(one_less_a, adjugate) == expected
    assert product(a, adjugate) != expected


def test_exponential_logarithm_and_inverse_of_unipotents():
    """Exp and log undo one another on nilpotent matrices, and exp(-n) is the inverse."""
    field = Field(["a", "b", "c"])
    a, b, c = (field[name] for name in "abc")
    n = ((0, a, c), (0, 0, b), (0, 0, 0))
    u = m.exponential(n)
    assert u[0][2] == c + a * b / 2
    assert m.unipotent_logarithm(u) == n
    assert product(u, m.unipotent_inverse(u)) == identity(3)
    assert m.unipotent_inverse(u) == m.exponential(scale(-1, n))


def test_coordinates_of_overlapping_matrices():
    """Readers give the coordinates also where no entry belongs to one matrix alone."""
    basis = [{(0, 0): 1, (1, 1): -1}, {(0, 0): 1, (1, 1): 1}, {(0, 1): 2}]
    readers = m.coordinate_readers(basis)
    matrix = weighted_sum([5, 7, -3], basis, 2)
    assert [sum(matrix[r][c] * w for (r, c), w in reader.items()) for reader in readers] == [
        *(5, 7, -3)
    ]


def test_dependent_matrices_have_no_coordinates():
    """None is the answer where the matrices are linearly dependent."""
    assert m.coordinate_readers([{(0, 0): 1}, {(0, 0): 2}]) is None


def test_the_rest_of_the_arithmetic():
    """Commutator, trace, transpose and application to a vector, by hand."""
    X, Y = ((0, 1), (0, 0)), ((0, 0), (1, 0))
    assert commutator(X, Y) == ((1, 0), (0, -1))
    assert (trace(A), transpose(X), apply(A, (1, 2, 3))) == (6, Y, (4, 13, 18))
