"""Motion in a group: translations, velocities, coadjoint motion and invariant vector fields."""

import pytest

from coadjoint.errors import AlgebraError
from coadjoint.exact import Field
from coadjoint.theory import MatrixGroup, matrix_group
from coadjoint.theory.actions import (
    body_velocity,
    coadjoint_motion_defect,
    conjugation,
    derivation,
    element_rates,
    left_invariant_field,
    left_translation,
    matrix_rate,
    right_invariant_field,
    right_translation,
    space_velocity,
)
from tests.theory.exactly import same

#: Groups on which motion is proved for a generic curve.
MOVING = ("SO(3)", "SE(2)", "SE(3)", "H(1)", "SL(2,R)", "SU(2)", "Aff(1)", "G(3)", "SL(2,R)(s)R^2")


def moving(name):
    """A group, its generic element on a curve with free rates, and free mu with free rate."""
    spare = matrix_group(name)
    rates = [f"rate_{symbol}" for symbol in spare.symbols]
    group = matrix_group(name, "g", ["mu", "mudot", "eta"], rates)
    g, mu, mu_dot = group.element("g"), group.vector("mu"), group.vector("mudot")
    rates = element_rates(group, "g", "rate")
    rates |= {f"mu_{n}": m for n, m in zip(group.algebra.basis, mu_dot, strict=True)}
    return group, g, matrix_rate(group, g, rates), mu, mu_dot, rates


@pytest.mark.parametrize("name", MOVING)
def test_coadjoint_motion(name):
    """Proposition 4.2.2 of Holm (2011) for every curve in the group and every mu."""
    group, g, g_dot, mu, mu_dot, rates = moving(name)
    defect = coadjoint_motion_defect(group, g, g_dot, mu, mu_dot, rates)
    assert all(group.field.is_zero(d) for d in defect)


@pytest.mark.parametrize("name", ["SO(3)", "SE(2)", "H(1)", "Aff(1)"])
def test_coadjoint_motion_sees_a_wrong_rate(name):
    """With the opposite rate of mu, or with g held while its velocity is not 0, it fails."""
    group, g, g_dot, mu, mu_dot, rates = moving(name)
    opposite = tuple(-m for m in mu_dot)
    held = {symbol: speed for symbol, speed in rates.items() if symbol.startswith("mu_")}
    for change, moved in ((opposite, rates), (mu_dot, held)):
        defect = coadjoint_motion_defect(group, g, g_dot, mu, change, moved)
        assert not all(group.field.is_zero(d) for d in defect)


@pytest.mark.parametrize("name", MOVING)
def test_velocities_are_related_by_Ad(name):
    """The space velocity is Ad_g of the body velocity, not the body velocity itself."""
    group, g, g_dot, *_ = moving(name)
    body, space = body_velocity(group, g, g_dot), space_velocity(group, g, g_dot)
    assert same(group.field, space, group.Ad(g, body))
    assert not same(group.field, space, body)


def test_a_rate_that_is_not_tangent_is_refused():
    """G itself is no velocity of a rotation."""
    group = matrix_group("SO(3)", "g")
    with pytest.raises(AlgebraError, match=r"is not in so\(3\): entry \(1, 1\) .* is 1"):
        body_velocity(group, group.element("g"), group.element("g"))


@pytest.mark.parametrize("name", ["SO(3)", "SE(2)", "H(1)", "SL(2,R)"])
def test_B_4_1_translations_commute(name):
    """L_g R_h = R_h L_g, while L_g L_h is not L_h L_g; I_g undoes one by the other."""
    group = matrix_group(name, ["g", "h", "k"])
    g, h, k = (group.element(e) for e in "ghk")
    L, R = left_translation, right_translation
    assert same(group.field, L(g)(R(h)(k)), R(h)(L(g)(k)))
    assert not same(group.field, L(g)(L(h)(k)), L(h)(L(g)(k)))
    assert same(group.field, conjugation(group, g)(h), L(g)(R(group.inverse(g))(h)))


def operators(name):
    """A group whose elements are matrices of free entries, and the derivation of a field on it.

    Invariant fields are tangent to the group, so what holds for all matrices holds on it.
    """
    spare = matrix_group(name)
    n = spare.size
    entries = [f"x{r}{c}" for r in range(n) for c in range(n)]
    vectors = [f"{prefix}_{e}" for prefix in ("xi", "eta") for e in spare.algebra.basis]
    field = Field([*entries, *vectors])
    group = MatrixGroup(name, spare.algebra, spare.linear, spare.nilpotent, field)
    x = tuple(tuple(field[f"x{r}{c}"] for c in range(n)) for r in range(n))
    return group, x


@pytest.mark.parametrize("name", ["SO(3)", "SE(3)", "H(1)", "SL(2,R)", "SU(2)", "Bargmann"])
@pytest.mark.parametrize(
    ("invariant", "sign"), [(left_invariant_field, 1), (right_invariant_field, -1)]
)
def test_B_5_brackets_of_invariant_fields(name, invariant, sign):
    """As operators, [X_xi, X_eta] is X_[xi, eta] for left-invariant fields, else minus that."""
    group, x = operators(name)
    xi, eta = group.vector("xi"), group.vector("eta")
    X, Y = (derivation(group.field, x, invariant(group, v)(x)) for v in (xi, eta))
    expected = invariant(group, tuple(sign * e for e in group.ad(xi, eta)))(x)
    found = [[X(Y(entry)) - Y(X(entry)) for entry in row] for row in x]
    assert same(group.field, found, expected)
    assert not same(group.field, found, [[-e for e in row] for row in expected])
