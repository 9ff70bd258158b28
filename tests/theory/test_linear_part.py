"""Charts of the linear parts: where they start, and that they fill the group."""

import re
from fractions import Fraction

import pytest

from coadjoint.exact import Field
from coadjoint.exact.dense import identity
from coadjoint.exact.linear import Span
from coadjoint.theory import MatrixGroup, matrix_group
from coadjoint.theory.matrix import complex_multiple, determinant
from tests.theory.exactly import random_point, same
from tests.theory.test_group import EVERY


def speeds(name):
    """The tangent vectors at 1 of the lines on which one coordinate of the chart changes."""
    spare, field = matrix_group(name), Field(["e"])
    group = MatrixGroup(name, spare.algebra, spare.linear, spare.nilpotent, field)
    start = [int(bool(re.fullmatch(r"(\d+)_\1", symbol))) for symbol in group.symbols]
    assert same(field, group.point(start), identity(group.size)), "the chart does not start at 1"
    found = []
    for moving in range(len(start)):
        g = group.point([x + field["e"] * (n == moving) for n, x in enumerate(start)])
        g_dot = [
            [field.substitute(field.derivative(x, "e"), {"e": field.zero}) for x in row]
            for row in g
        ]
        found.append([field.as_number(x) for x in group.coordinates(g_dot)])
    return found


@pytest.mark.parametrize("name", EVERY)
def test_charts_cover_a_neighbourhood_of_1(name):
    """The derivative of each chart at 1 is invertible, so an open set of elements is reached."""
    vectors = [dict(enumerate(vector)) for vector in speeds(name)]
    assert Span(vectors).rank == len(vectors) == matrix_group(name).algebra.dimension
    assert Span([*vectors[1:], vectors[-1]]).rank < len(vectors) or len(vectors) == 1


def test_the_cayley_transform_starts_at_twice_the_generators():
    """The derivative of (1 - X)^-1 (1 + X) at 0 is 2 X."""
    assert speeds("SO(3)") == [[2, 0, 0], [0, 2, 0], [0, 0, 2]]


def test_the_cayley_transform_of_a_plane_rotation():
    """[[1 - t^2, -2 t], [2 t, 1 - t^2]] / (1 + t^2), t the tangent of half the angle."""
    group = matrix_group("SO(2)", "g")
    t = group.field["g_E12"]
    c, s = (1 - t**2) / (1 + t**2), 2 * t / (1 + t**2)
    assert same(group.field, group.element("g"), ((c, s), (-s, c)))  # E12 turns clockwise
    assert not same(group.field, group.element("g"), ((c, -s), (s, c)))


def test_the_last_entry_of_sl2_follows():
    """[[a, b], [c, (1 + b c) / a]]."""
    group = matrix_group("SL(2,R)", "g")
    a, b, c = (group.field[f"g_{s}"] for s in ("1_1", "1_2", "2_1"))
    assert group.element("g") == ((a, b), (c, (1 + b * c) / a))
    assert group.element("g")[1][1] != (1 - b * c) / a


@pytest.mark.parametrize(("name", "one"), [("SU(3)", True), ("SU(2)", True), ("U(3)", False)])
def test_the_phase_makes_the_determinant_1(name, one):
    """Det is 1 on SU(n), by the phase of one column; on U(n) it is not."""
    group = matrix_group(name)
    real, imaginary = determinant(random_point(group, 3), group.linear.structure)
    assert (real == 1 and imaginary == 0) == one
    assert real**2 + imaginary**2 == 1


def test_complex_matrices_commute_with_their_structure():
    """The structure of U(2) is multiplication by i: its square is -1."""
    J = matrix_group("U(2)").linear.structure
    assert complex_multiple((0, 1), J) == J
    assert J[2][0] == 1
    assert determinant(tuple(tuple(map(Fraction, row)) for row in J), J) == (-1, 0)  # i^2
