"""Representations on matrices from the left and the right, and by name."""

import re

import pytest

from coadjoint.algebra import algebra_by_name
from coadjoint.algebra.catalogue import representation_by_name
from coadjoint.errors import CoadjointError
from tests.sources.components import hat, product
from tests.specs import shipped, spec

BODIES = """
title = "Two bodies"
routes = ["euler-poincare"]
[algebra]
direct_sum = ["so(3)", "so(3)"]
[variables]
Omega = { role = "velocity" }
Pi = { role = "momentum" }
A = { role = "advected", form = "matrix", representation = "relative" }
[representations.relative]
left = "rotation_1"
right = "rotation_2"
[lagrangian]
l = "dot(Omega, Omega)/2 + trace(A)"
"""


def test_both_sides_turn_a_matrix():
    """rho(xi) A = hat(xi1) A - A hat(xi2)."""
    (A,) = shipped("coupled_bodies").having_role("advected")
    xi, rows = [2, -3, 5, 7, 11, -13], [[1, 4, 9], [2, 0, -6], [3, 8, 5]]
    left, right = product(hat(xi[:3]), rows), product(rows, hat(xi[3:]))
    expected = [a - b for x, y in zip(left, right, strict=True) for a, b in zip(x, y, strict=True)]
    assert list(A.representation.act(xi, [x for row in rows for x in row])) == expected


def test_rows_move_as_the_attitude_of_a_left_invariant_system():
    """dA/dt = -rho(xi) A = A hat(xi)."""
    action = representation_by_name(algebra_by_name("so(3)"), "rows")
    rows = [[1, 4, 9], [2, 0, -6], [3, 8, 5]]
    moved = [-x for x in action.act([2, -3, 5], [x for row in rows for x in row])]
    assert moved == [x for row in product(rows, hat([2, -3, 5])) for x in row]


@pytest.mark.parametrize(
    ("old", "new", "found"),
    [
        ('left = "rotation_1"', 'left = "rotation_7"', "rotation_7"),
        ('left = "rotation_1"\nright = "rotation_2"\n', "", "relative"),
        ('left = "rotation_1"', 'left = "rotation_1"\nmatrices = { J1_1 = [[0]] }', "left"),
        ('left = "rotation_1"', 'left = ["J1_1", "J1_1"]', "J1_1"),
    ],
)
def test_mistakes_are_told(old, new, found):
    """An unknown block, none, both kinds, a doubled name: the offender stands in the text."""
    spec(BODIES)
    with pytest.raises(CoadjointError, match=re.escape(found)) as error:
        spec(BODIES, (old, new))
    assert "sample.toml:" in str(error.value)
