"""The group element as a quantity: rho(xi) g = -g xi from the left, xi g from the right."""

from fractions import Fraction

import pytest

from coadjoint.algebra import LieAlgebra, algebra_by_name, direct_sum
from coadjoint.algebra.attitudes import attitude, has_fixed_row, quaternion
from coadjoint.algebra.catalogue import inverse_by, representation_by_name
from coadjoint.errors import AlgebraError
from coadjoint.exact.dense import product
from coadjoint.groups.quaternions import Quaternion

G = tuple(tuple(Fraction(3 * i + j * j + 1, 1 + j) for j in range(3)) for i in range(3))


def dense(X, n):
    """A sparse matrix, row by row."""
    return tuple(tuple(X.get((i, j), 0) for j in range(n)) for i in range(n))


def entries(matrix):
    """The entries of a matrix, row by row."""
    return tuple(x for row in matrix for x in row)


@pytest.mark.parametrize("name", ["so(3)", "sl(3,R)", "so(2,1)"])
def test_attitudes_multiply_matrices(name):
    """Against matrix products: -g X from the left, X g from the right."""
    algebra = algebra_by_name(name)
    for k, X in enumerate(algebra.matrices):
        unit = [int(n == k) for n in range(algebra.dimension)]
        left = attitude(algebra).act(unit, entries(G))
        right = attitude(algebra, "right").act(unit, entries(G))
        assert left == tuple(-x for x in entries(product(G, dense(X, 3))))
        assert right == entries(product(dense(X, 3), G))
        assert left != right


@pytest.mark.parametrize(("name", "entries"), [("se(2)", 6), ("se(3)", 12), ("so(4)", 16)])
def test_a_last_row_that_stays_is_left_out(name, entries):
    """[R | x] of a motion; every entry of a rotation, and of a motion seen from the right."""
    algebra = algebra_by_name(name)
    assert attitude(algebra).dimension == entries
    assert has_fixed_row(algebra) == name.startswith("se")
    assert attitude(algebra, "right").dimension == {6: 9, 12: 16, 16: 16}[entries]


@pytest.mark.parametrize("name", ["so(3)", "su(2)"])
def test_quaternions_multiply(name):
    """Against products of quaternions: dq/dt = q [0, xi]/2, or [0, xi] q/2."""
    algebra, q, xi = algebra_by_name(name), Quaternion(1, -2, 3, 5), (2, 7, -4)
    pure = Quaternion.pure(xi)
    left = quaternion(algebra).act(xi, q.components)
    right = quaternion(algebra, "right").act(xi, q.components)
    assert left == (Fraction(-1, 2) * (q * pure)).components
    assert right == (Fraction(1, 2) * (pure * q)).components
    assert left != (Fraction(-1, 2) * (pure * q)).components


def test_quaternions_turn_by_the_rotations_of_a_larger_algebra():
    """Wheels and translations leave them alone; what brings translations among the rotations not.

    With [P1, P2] = J3 the rotations are no quotient: the action would not be one of the algebra.
    """
    q = (1, 2, -1, 3)
    for larger in (
        direct_sum([algebra_by_name("so(3)"), algebra_by_name("R^3")]),
        algebra_by_name("se(3)"),
    ):
        action = quaternion(larger)
        assert action.act((2, 7, -4, 5, 6, 1), q) == quaternion(algebra_by_name("so(3)")).act(
            (2, 7, -4), q
        )
    flat = algebra_by_name("se(3)")
    curved = {**flat.constants, (3, 4): {2: 1}, (3, 5): {1: -1}, (4, 5): {0: 1}}
    with pytest.raises(AlgebraError, match="no other bracket reaches"):
        quaternion(LieAlgebra("so(4)", flat.basis, curved, flat.blocks))


def test_attitudes_have_names():
    """Specs find them by name, and know which inverses are written out."""
    algebra = algebra_by_name("so(3)")
    assert representation_by_name(algebra, "quaternion", "right") == quaternion(algebra, "right")
    assert representation_by_name(algebra, "attitude") == attitude(algebra)
    known = {
        name: inverse_by(algebra_by_name(name)) for name in ("so(5)", "se(3)", "gl(2)", "h(1)")
    }
    assert known == {"so(5)": "transpose", "se(3)": "motion", "gl(2)": "cofactors", "h(1)": ""}
