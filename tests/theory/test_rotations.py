"""Rotations by quaternions: orthogonality, generic units, actions of coquaternions."""

import pytest

from coadjoint.exact import Field
from coadjoint.exact.dense import cross, dot, identity, product, transpose
from coadjoint.groups.quaternions import Quaternion, euler_rodrigues
from coadjoint.theory.coquaternions import Coquaternion
from coadjoint.theory.rotations import AD, Ad_star, ad, unit_quaternion


@pytest.fixture
def field():
    """Symbols of four quaternions."""
    return Field([f"{letter}{n}" for letter in "pqrs" for n in range(4)])


def generic(field, letter, kind=Quaternion):
    """A generic member of an algebra."""
    return kind(*(field[f"{letter}{n}"] for n in range(4)))


def check_rotation(matrix):
    """R^T R = 1 and det R = +1."""
    assert product(transpose(matrix), matrix) == identity(3)
    assert dot(matrix[0], cross(matrix[1], matrix[2])) == 1


def test_euler_rodrigues_matrices_are_rotations(field):
    """R^T R = 1 and det R = 1 for every quaternion but 0."""
    check_rotation(euler_rodrigues(generic(field, "p")))


def test_the_check_sees_a_reflection(field):
    """The check above can fail: minus a rotation has determinant -1."""
    with pytest.raises(AssertionError):
        check_rotation(
            tuple(tuple(-x for x in row) for row in euler_rodrigues(generic(field, "p")))
        )


def test_half_turns_need_no_limit():
    """The quaternion of a half turn, where Cayley's transform has its pole, is no exception."""
    check_rotation(euler_rodrigues(Quaternion(0, 1, 2, 2)))
    assert euler_rodrigues(Quaternion(0, 0, 0, 1)) == ((-1, 0, 0), (0, -1, 0), (0, 0, 1))


@pytest.mark.parametrize("kind", [Quaternion, Coquaternion])
def test_unit_quaternions_have_norm_one(field, kind):
    """``p (p*)^-1`` has norm 1 in both algebras; p p^-1 would be 1 itself."""
    p = generic(field, "p", kind)
    assert unit_quaternion(p).norm == 1
    assert unit_quaternion(p) != kind(1, 0, 0, 0)
    assert p.norm != 1


@pytest.mark.parametrize("kind", [Quaternion, Coquaternion])
def test_conjugation_is_an_automorphism(field, kind):
    """AD_q (r s) = AD_q r AD_q s, AD_(pq) = AD_p AD_q, and Ad* undoes it."""
    p, q, r, s = (generic(field, letter, kind) for letter in "pqrs")
    assert AD(q, r * s) == AD(q, r) * AD(q, s)
    assert AD(p * q, r) == AD(p, AD(q, r))
    assert AD(p * q, r) != AD(q, AD(p, r))
    assert Ad_star(q, AD(q, r)) == r
    assert AD(q, ad(r, s)) == ad(AD(q, r), AD(q, s))
