"""Laws of Lie algebras as checks that raise, and ways to spoil an algebra."""

import random
from fractions import Fraction

from coadjoint.algebra import LieAlgebra
from coadjoint.errors import AlgebraError
from coadjoint.exact import Field
from coadjoint.poisson import lie_poisson


def vector(n, seed):
    """A random rational vector without zeros."""
    source = random.Random(seed)
    numerators = [n for n in range(-20, 21) if n]
    return [Fraction(source.choice(numerators), source.randint(1, 9)) for _ in range(n)]


def pairing(mu, xi):
    """``<mu, xi>`` in dual bases."""
    return sum(m * x for m, x in zip(mu, xi, strict=True))


def lie_poisson_tensor(algebra, mu, sign=-1, number=Fraction):
    """The entries of the Lie-Poisson tensor at a point."""
    field = Field(algebra.basis)
    values = dict(zip(algebra.basis, mu, strict=True))
    tensor = lie_poisson(algebra, field, algebra.basis, sign).tensor
    return [[field.evaluate(entry, values, number) for entry in row] for row in tensor]


def every_constant(algebra):
    """Each place (pair, k) with its constant."""
    return [(pair, k, c) for pair, row in algebra.constants.items() for k, c in row.items()]


def spoiled_constants(algebra, pair, k, value):
    """The constants with one of them replaced."""
    constants = {p: dict(row) for p, row in algebra.constants.items()}
    constants[pair][k] = value
    return constants


def is_caught_by_jacobi(algebra, constants):
    """Whether the constants are refused as no Lie algebra."""
    try:
        LieAlgebra("spoiled", algebra.basis, constants)
    except AlgebraError:
        return True
    return False


def is_caught_by_matrices(algebra, constants):
    """Whether the matrices that the algebra carries contradict the constants."""
    try:
        LieAlgebra("spoiled", algebra.basis, constants, {}, algebra.matrices).check_matrices()
    except AlgebraError:
        return True
    return False
