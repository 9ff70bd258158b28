"""Structure constants: brackets, ad, ad*, and the Jacobi identity that can fail."""

import random
from fractions import Fraction
from itertools import combinations

import pytest

from coadjoint.algebra import algebra_by_name, from_brackets, from_matrices
from coadjoint.errors import AlgebraError, LimitError
from coadjoint.limits import GENERATORS
from tests.algebra.laws import vector
from tests.sources.components import cross


def test_so3_bracket_is_the_cross_product():
    """[xi, eta] on so(3) is xi x eta (Holm 2011, section 5.1.1)."""
    so3 = algebra_by_name("so(3)")
    xi, eta = vector(3, 1), vector(3, 2)
    assert list(so3.bracket(xi, eta)) == cross(xi, eta)


def test_so3_ad_star_is_mu_cross_xi():
    """ad*_xi mu on so(3) is mu x xi (Holm 2011, section 5.1.3)."""
    so3 = algebra_by_name("so(3)")
    xi, mu = vector(3, 3), vector(3, 4)
    assert list(so3.ad_star(xi, mu)) == cross(mu, xi)


def test_se3_bracket_is_the_one_of_the_book():
    """[(xi, a), (eta, b)] = (xi x eta, xi x b - eta x a) (Holm 2011, section 1.6)."""
    se3 = algebra_by_name("se(3)")
    x, y = vector(6, 5), vector(6, 6)
    moved = [a - b for a, b in zip(cross(x[:3], y[3:]), cross(y[:3], x[3:]), strict=True)]
    assert list(se3.bracket(x, y)) == cross(x[:3], y[:3]) + moved


def test_se3_ad_star_is_the_one_of_the_book():
    """ad*_(xi, a) (mu, b) = (mu x xi + b x a, b x xi) (Holm 2011, section 6.3.2)."""
    se3 = algebra_by_name("se(3)")
    x, m = vector(6, 7), vector(6, 8)
    turned = [a + b for a, b in zip(cross(m[:3], x[:3]), cross(m[3:], x[3:]), strict=True)]
    assert list(se3.ad_star(x, m)) == turned + cross(m[3:], x[:3])


def test_every_changed_constant_of_se3_violates_jacobi():
    """Flip the sign of any one structure constant of se(3) and the algebra is refused."""
    se3 = algebra_by_name("se(3)")
    refused = 0
    for pair, row in se3.constants.items():
        for k, c in row.items():
            spoiled = {p: dict(r) for p, r in se3.constants.items()}
            spoiled[pair][k] = -c
            with pytest.raises(AlgebraError, match=r"violate the Jacobi identity"):
                from_brackets("spoiled", se3.basis, spoiled)
            refused += 1
    assert refused == 9


def test_random_antisymmetric_constants_are_no_algebra():
    """Random constants in dimension 5 violate Jacobi, and the message names the triple."""
    source = random.Random(13)
    basis = [f"e{n}" for n in range(1, 6)]
    brackets = {
        (i, j): {k: source.randint(-3, 3) for k in range(5)} for i, j in combinations(range(5), 2)
    }
    with pytest.raises(AlgebraError, match=r"\[e1, \[e2, e3\]\] \+ cyclic = ") as caught:
        from_brackets("random", basis, brackets)
    assert caught.value.triple == [0, 1, 2]


def test_a_matrix_basis_that_does_not_close_is_refused():
    """The offending bracket is named with its entries."""
    e = {(0, 1): Fraction(1)}
    f = {(1, 0): Fraction(1)}
    with pytest.raises(AlgebraError, match=r"bracket of e and f .* \(1, 1\): 1, \(2, 2\): -1"):
        from_matrices("open", ("e", "f"), (e, f))


def test_dependent_matrices_are_refused():
    """A basis must be independent."""
    e = {(0, 1): Fraction(1)}
    with pytest.raises(AlgebraError, match="linearly dependent"):
        from_matrices("double", ("e", "f"), (e, {(0, 1): Fraction(2)}))


def test_sl2_from_matrices_has_the_known_brackets():
    """[h, e] = 2e, [h, f] = -2f, [e, f] = h."""
    e, f = {(0, 1): Fraction(1)}, {(1, 0): Fraction(1)}
    h = {(0, 0): Fraction(1), (1, 1): Fraction(-1)}
    sl2 = from_matrices("sl(2, R)", ("h", "e", "f"), (h, e, f))
    assert {pair: dict(row) for pair, row in sl2.constants.items()} == {
        (0, 1): {1: 2},
        (0, 2): {2: -2},
        (1, 2): {0: 1},
    }


def test_a_bracket_given_twice_or_with_itself_is_refused():
    """Each pair is declared once, in either order, and never a vector with itself."""
    with pytest.raises(AlgebraError, match="declared twice"):
        from_brackets("a", ("e1", "e2"), {(0, 1): {0: 1}, (1, 0): {0: 1}})
    with pytest.raises(AlgebraError, match=r"\[e2, e2\]"):
        from_brackets("a", ("e1", "e2"), {(1, 1): {0: 1}})


def test_too_many_generators_are_refused():
    """The limit is named before any bracket is looked at."""
    basis = [f"e{n}" for n in range(GENERATORS + 1)]
    with pytest.raises(LimitError, match=r"5001 generators and 12502500 brackets.*at most 5000"):
        from_brackets("large", basis, {})


def test_a_bracket_may_be_given_in_either_order():
    """[e2, e1] = -e3 declares the same algebra as [e1, e2] = e3."""
    basis = ("e1", "e2", "e3")
    forward = from_brackets("a", basis, {(0, 1): {2: 1}})
    assert from_brackets("a", basis, {(1, 0): {2: -1}}).constants == forward.constants
    assert from_brackets("a", basis, {(1, 0): {2: 1}}).constants != forward.constants


def test_rational_constants_work_in_every_arithmetic():
    """A constant of 1/2 multiplies integers, fractions and floats."""
    half = from_brackets("half", ("e1", "e2"), {(0, 1): {1: Fraction(1, 2)}})
    assert half.bracket([1, 0], [0, 1]) == (0, Fraction(1, 2))
    assert half.bracket([1.0, 0.0], [0.0, 1.0])[1] == 0.5


def test_unknown_algebra_names_the_nearest():
    """so3 is answered with so(3)."""
    with pytest.raises(AlgebraError, match=r"'so3'.*Did you mean 'so\(3\)'\? Or 'so\(3,1\)'\?"):
        algebra_by_name("so3")
