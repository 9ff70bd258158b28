"""Hat, breve and tilde: inverse maps, dual maps, the catalogue's matrices, refusals."""

import pytest

from coadjoint.algebra import algebra_by_name
from coadjoint.errors import AlgebraError
from coadjoint.exact import Field
from coadjoint.exact.dense import add, apply, cross, dot, hat
from coadjoint.groups.complex_numbers import Complex
from coadjoint.theory.maps import breve, dual_tilde, pairing_so3, pairing_su2, tilde, unhat, untilde


@pytest.fixture
def symbols():
    """Two three-vectors and a 3 x 3 matrix of symbols."""
    field = Field([f"{letter}{n}" for letter in "abm" for n in range(9)])
    a, b = (tuple(field[f"{letter}{n}"] for n in range(3)) for letter in "ab")
    m = tuple(tuple(field[f"m{3 * i + j}"] for j in range(3)) for i in range(3))
    return a, b, m


def test_hat_is_the_cross_product(symbols):
    """hat(a) b = a x b, and the inverse gives a again."""
    a, b, _ = symbols
    assert apply(hat(a), b) == cross(a, b)
    assert apply(hat(a), b) != cross(b, a)
    assert unhat(hat(a)) == a


def test_hat_matrices_are_those_of_the_catalogue():
    """The basis of so(3) by name is the hat map of the axes."""
    for axis, matrix in zip(
        ((1, 0, 0), (0, 1, 0), (0, 0, 1)), algebra_by_name("so(3)").matrices, strict=True
    ):
        entries = {(i, j): x for i, row in enumerate(hat(axis)) for j, x in enumerate(row) if x}
        assert entries == matrix


def test_breve_is_dual_to_hat(symbols):
    """<mu, hat a> = breve(mu) . a for every matrix mu; symmetric parts do not count."""
    a, b, m = symbols
    assert pairing_so3(m, hat(a)) == dot(breve(m), a)
    assert breve(hat(b)) == b
    symmetric = tuple(tuple(m[min(i, j)][max(i, j)] for j in range(3)) for i in range(3))
    assert breve(add(m, symmetric)) == breve(m)
    transposed = tuple(zip(*m, strict=True))
    assert pairing_so3(transposed, hat(a)) != dot(breve(m), a)


def test_dual_tilde_is_dual_to_tilde(symbols):
    """<mu, tilde a> = dual_tilde(mu) . a, and tilde has an inverse."""
    a, b, _ = symbols
    mu = tilde(b)
    assert pairing_su2(mu, tilde(a)) == dot(dual_tilde(mu), a)
    assert untilde(mu) == b
    assert untilde(tilde(a)) != b


def test_a_matrix_outside_so3_is_refused():
    """Entries that are not opposite are named with their values."""
    with pytest.raises(AlgebraError) as caught:
        unhat(((0, -3, 2), (7, 0, -1), (-2, 1, 0)))
    assert caught.value.entry == [2, 1]
    assert caught.value.found == "7"
    assert "entries (2, 1) and (1, 2) are 7 and -3" in str(caught.value)


def test_a_matrix_outside_su2_is_refused():
    """A Hermitian entry is named with what would stand there."""
    spoiled = ((Complex(5), Complex(0)), (Complex(0), Complex(0)))
    with pytest.raises(AlgebraError) as caught:
        untilde(spoiled)
    assert caught.value.found == "5 + 0 i"
    assert "5 + 0 i where 0 + 0 i" in str(caught.value)
