"""Lattices: one basis for a set of vectors, whatever their order."""

import random
from fractions import Fraction

from coadjoint.exact import Field
from coadjoint.exact.lattices import Lattice, coordinates, lattice_basis


def drawn(source):
    """A few random vectors with small rational entries."""
    rows, columns = source.randint(1, 5), source.randint(1, 4)
    return [
        tuple(Fraction(source.randint(-4, 4), source.randint(1, 3)) for _ in range(columns))
        for _ in range(rows)
    ]


def test_coordinates_are_whole_and_give_the_vectors_back():
    """Each vector is a combination of basis vectors with integers."""
    source = random.Random(0)
    for _ in range(100):
        vectors = drawn(source)
        basis = lattice_basis(vectors)
        for vector in vectors:
            (whole,) = coordinates([vector], basis)
            sums = (sum(k * basis[n][m] for n, k in whole.items()) for m in range(len(vector)))
            assert tuple(sums) == vector
            assert all(type(count) is int for count in whole.values())


def test_the_basis_belongs_to_the_lattice():
    """The order of the vectors, and adding a multiple of one to another, change nothing."""
    source = random.Random(1)
    for _ in range(100):
        vectors = drawn(source)
        other = random.Random(2).sample(vectors, len(vectors))
        if len(other) > 1:
            other[0] = tuple(a - 3 * b for a, b in zip(other[0], other[-1], strict=True))
        assert lattice_basis(other) == lattice_basis(vectors)
        assert lattice_basis(lattice_basis(vectors)) == lattice_basis(vectors)


def test_arguments_are_combinations_of_elements():
    """2x + y, x - y and halves of them: the basis elements add up to the arguments."""
    field = Field(["x", "y", "m"])
    x, y, m = (field[name] for name in field.names)
    arguments = [(2 * x + y) / m, (x - y) / m, x / (2 * m)]
    lattice = Lattice(field, arguments)
    assert len(lattice.basis) == 2
    for argument, row in zip(arguments, lattice.rows, strict=True):
        assert field.sum(k * b for k, b in zip(row, lattice.basis, strict=True)) == argument
