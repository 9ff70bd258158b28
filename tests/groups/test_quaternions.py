"""Quaternion algebras: laws with generic components, matrices, zero divisors."""

from fractions import Fraction

import pytest

from coadjoint.errors import AlgebraError
from coadjoint.exact import Field
from coadjoint.exact.dense import apply, product, transpose
from coadjoint.groups.quaternions import Hypercomplex, Quaternion
from coadjoint.theory.coquaternions import Coquaternion, left_matrix, right_matrix


def check_associative(a, b, c):
    """(a b) c = a (b c)."""
    assert (a * b) * c == a * (b * c)


@pytest.fixture(params=[Quaternion, Coquaternion], ids=lambda kind: kind.__name__)
def generic(request):
    """Three generic members of each algebra."""
    field = Field([f"{letter}{n}" for letter in "abc" for n in range(4)])
    return [request.param(*(field[f"{letter}{n}"] for n in range(4))) for letter in "abc"]


def test_multiplication_is_associative(generic):
    """The product of three does not depend on the parentheses, in both algebras."""
    check_associative(*generic)


def test_the_check_sees_a_table_with_one_wrong_sign():
    """With j^2 = 1 and k^2 = 1 but j k = + i the algebra is not associative."""

    class Mixed(Hypercomplex):
        square = -1

        def __mul__(self, other):
            product = super().__mul__(other)
            return type(self)(product.w + 2 * self.y * other.y, *product.vector)

    with pytest.raises(AssertionError):
        check_associative(Mixed(0, 1, 2, 3), Mixed(1, 0, 1, 0), Mixed(2, 0, 1, 1))


def test_multiplication_distributes_and_is_not_commutative(generic):
    """``a (b + c) = a b + a c``, a - a = 0, and a b != b a."""
    a, b, c = generic
    assert a * (b + c) == a * b + a * c
    assert (a - a).components == (0, 0, 0, 0)
    assert a * b != b * a
    assert 2 * a == a + a == a * 2


def test_left_and_right_matrices(generic):
    """``q r = L(q) r = R(r) q``; L is a homomorphism, R reverses, and they commute."""
    a, b, c = generic
    assert apply(left_matrix(a), b.components) == (a * b).components
    assert apply(right_matrix(b), a.components) == (a * b).components
    assert left_matrix(a * b) == product(left_matrix(a), left_matrix(b))
    assert right_matrix(a * b) == product(right_matrix(b), right_matrix(a))
    assert product(left_matrix(a), right_matrix(c)) == product(right_matrix(c), left_matrix(a))
    assert left_matrix(a * b) != product(left_matrix(b), left_matrix(a))


def test_conjugation_is_transposition_for_quaternions_only():
    """L(q*) = L(q)^T for quaternions; for coquaternions the metric is not the unit matrix."""
    assert left_matrix(Quaternion(1, 2, 3, 4).conjugate) == transpose(
        left_matrix(Quaternion(1, 2, 3, 4))
    )
    assert left_matrix(Coquaternion(1, 2, 3, 4).conjugate) != transpose(
        left_matrix(Coquaternion(1, 2, 3, 4))
    )


def test_integers_stay_exact():
    """The inverse of a quaternion of integers has fractions, not floats."""
    assert Quaternion(1, 2, 3, 4).inverse().x == Fraction(-2, 30)
    assert isinstance(Quaternion(1, 2, 3, 4).inverse().x, Fraction)


@pytest.mark.parametrize("null", [(1, 0, 1, 0), (3, 4, 5, 0), (0, 1, 0, -1), (0, 0, 0, 0)])
def test_zero_divisors_have_no_inverse(null):
    """A coquaternion of norm 0 is refused, and times its conjugate it is 0, as the message says."""
    q = Coquaternion(*null)
    assert (q * q.conjugate).components == (0, 0, 0, 0)
    with pytest.raises(AlgebraError) as caught:
        q.inverse()
    assert caught.value.found == str(q)
    assert "w^2 + x^2 - y^2 - z^2 is 0" in str(caught.value)
    assert str(q.conjugate) in str(caught.value)


def test_the_zero_quaternion_has_no_inverse():
    """Only 0 is refused among quaternions, with their own norm in the message."""
    with pytest.raises(AlgebraError, match=r"w\^2 \+ x\^2 \+ y\^2 \+ z\^2 is 0"):
        Quaternion(0, 0, 0, 0).inverse()
    assert Quaternion(1, 0, 1, 0).inverse() * Quaternion(1, 0, 1, 0) == Quaternion.units()[0]


def test_the_two_algebras_do_not_mix():
    """A quaternion times a coquaternion is refused, and neither equals the other."""
    with pytest.raises(AlgebraError, match=r"a Quaternion and .* a Coquaternion"):
        Quaternion(1, 2, 3, 4) * Coquaternion(1, 2, 3, 4)
    assert Quaternion(1, 2, 3, 4) != Coquaternion(1, 2, 3, 4)
