"""Attitudes, quaternions and poses: what their roles declare, and what is refused."""

import re
from fractions import Fraction

import pytest

from coadjoint.derive.mechanics.turning import rational_rotation
from coadjoint.errors import CoadjointError
from coadjoint.exact.dense import determinant, identity, product, transpose
from coadjoint.spec.model import Variable
from tests.specs import spec
from tests.turning import BY_QUATERNION, TIED, TOP


@pytest.mark.parametrize(
    ("declared", "shape", "components"),
    [
        (spec(TOP), (3, 3), "R11 R12 R13 R21 R22 R23 R31 R32 R33"),
        (spec(TOP, *BY_QUATERNION), (4,), "q0 q1 q2 q3"),
        (spec(TIED), (3, 4), "g11 g12 g13 g14 g21 g22 g23 g24 g31 g32 g33 g34"),
    ],
    ids=["attitude", "quaternion", "pose"],
)
def test_each_role_is_a_quantity_of_the_state_and_begins_at_the_identity(
    declared, shape, components
):
    """With the shape that it has in formulas."""
    (own,) = declared.turning
    assert own.value_shape == shape
    assert list(own.components) == components.split()
    ones = {"attitude": "100010001", "quaternion": "1000", "pose": "100001000010"}
    assert own.default == tuple(Fraction(x) for x in ones[own.turning])


def test_an_attitude_is_that_of_the_rotations():
    """On se(3) translations leave it alone, and a body that is tied by R alone feels no force."""
    declared = spec(TIED, ('"pose" }', '"attitude" }\nq = { role = "quaternion" }'), *NO_PLACE)
    for own in declared.turning:
        assert [bool(matrix) for matrix in own.representation.matrices] == [True] * 3 + [False] * 3


NO_PLACE = (
    ('R = "rotation(g)"\nx = "translation(g)"\ns = "x + R*a"\n', 's = "g*a"\n'),
    (', "R*Pi + cross(x, R*P)"', ""),
)
ROTATED = 'default = [["0.6", 0, "-0.8"], [0, 1, 0], ["0.8", 0, "0.6"]]'


def test_a_start_is_a_rotation():
    """Given row by row, as it is in formulas."""
    (own,) = spec(TOP, ('"attitude" }', f'"attitude", {ROTATED} }}')).turning
    assert own.default == tuple(map(Fraction, ("0.6", 0, "-0.8", 0, 1, 0, "0.8", 0, "0.6")))


@pytest.mark.parametrize(
    ("text", "changes", "found"),
    [
        (TOP, [('"attitude" }', '"attitude", default = 1 }')], "'R' is no rotation"),
        (  # a reflection
            TOP,
            [('"attitude" }', '"attitude", default = [[1, 0, 0], [0, 1, 0], [0, 0, -1]] }')],
            "orthonormal rows and determinant 1",
        ),
        (
            TOP,
            [*BY_QUATERNION, ('"quaternion" }', '"quaternion", default = [1, 1, 0, 0] }')],
            "length 1",
        ),
        (TOP, [('"attitude" }', '"pose" }')], "so(3) has no pose"),
        (TOP, [('name = "so(3)"', 'name = "sl(2,R)"')], "sl(2,R) has no attitude"),
        (TIED, [('name = "se(3)"', 'name = "se(3)"\ninvariance = "right"')], "no pose"),
        (TOP, [('"attitude" }', '"attitude", form = "matrix" }')], "has a form"),
        (TOP, [('"attitude" }', '"attitude", representation = "rows" }')], "representation"),
        (TOP, [("w = {", "R_gram = { default = 1 }\nw = {")], "R_gram"),
        (
            'title = "x"\nroutes = ["canonical"]\n[variables]\nq = { role = "quaternion" }\n'
            'x = { role = "coordinate" }\np = { role = "momentum", of = "x" }\n'
            '[hamiltonian]\nh = "p^2/2"\n',
            [],
            "'q' has the role 'quaternion' without [algebra]",
        ),
    ],
    ids=lambda value: value if isinstance(value, str) and len(value) < 60 else "",
)
def test_what_is_no_rotation_is_refused(text, changes, found):
    """In words that name it."""
    with pytest.raises(CoadjointError, match=re.escape(found)):
        spec(text, *changes)


@pytest.mark.parametrize("turning", ["attitude", "pose"])
def test_the_rotation_at_which_claims_are_looked_at_is_one(turning):
    """Of any number of rows: rows are orthonormal and the determinant is 1."""
    for rows in (2, 3, 4):
        shape = (rows, rows + (turning == "pose"))
        own = Variable(name="R", role="advected", shape=shape, turning=turning)
        found = rational_rotation(own)
        R = [[found[f"R{i}{j}"] for j in range(1, rows + 1)] for i in range(1, rows + 1)]
        assert product(R, transpose(R)) == identity(rows)
        assert determinant(R) == 1
