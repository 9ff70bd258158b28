"""Products of algebras: what they must equal, what they carry, what is refused."""

import pytest

from coadjoint.algebra import (
    Representation,
    algebra_by_name,
    direct_sum,
    from_brackets,
    representation_by_name,
    same_constants,
    semidirect_product,
    semidirect_sum,
)
from coadjoint.errors import AlgebraError, LimitError
from tests.algebra.laws import vector


def named(name, prefix, algebra, kind):
    """The abelian ideal that an algebra acts on, and the action."""
    action = representation_by_name(algebra, kind)
    basis = [f"{prefix}{n + 1}" for n in range(action.dimension)]
    return from_brackets(name, basis, {}), action


def iterated_galilei(sign=1):
    """(so(3) (s) R^3 of boosts) (s) R^4 of space-time, a boost moving x by v t."""
    so3 = algebra_by_name("so(3)")
    boosts, turning = named("R^3", "K", so3, "vector")
    homogeneous = semidirect_sum(so3, boosts, turning)
    events = from_brackets("R^4", ("P1", "P2", "P3", "E"), {})
    matrices = (*so3.matrices, *({(i, 3): sign} for i in range(3)))
    on_events = Representation(homogeneous, "events", 4, matrices)
    return semidirect_sum(homogeneous, events, on_events)


def test_iterated_semidirect_product_equals_the_galilei_algebra():
    """Same constants in the same order and the same names; the other sign of the boosts differs."""
    built, g3 = iterated_galilei(), algebra_by_name("g(3)")
    assert built.constants == g3.constants
    assert built.basis == g3.basis
    assert not same_constants(iterated_galilei(sign=-1), g3)
    built.check_matrices()


def test_semidirect_sum_with_vectors_is_the_semidirect_product():
    """Two roads to se(4), and the one by name."""
    so4 = algebra_by_name("so(4)")
    ideal, action = named("R^4", "P", so4, "vector")
    product = semidirect_product(so4, [("P", action)])
    assert semidirect_sum(so4, ideal, action).constants == product.constants
    assert product.constants == algebra_by_name("se(4)").constants


def test_direct_sum_commutes_between_its_parts():
    """Each part keeps its brackets, the parts commute, names that clash get numbers."""
    so3, aff = algebra_by_name("so(3)"), algebra_by_name("aff(1)")
    both = direct_sum([so3, aff, so3])
    assert both.basis == ("J1_1", "J2_1", "J3_1", "e1", "e2", "J1_3", "J2_3", "J3_3")
    assert both.blocks == {"rotation_1": (0, 1, 2), "rotation_3": (5, 6, 7)}
    x, y = vector(8, 1), vector(8, 2)
    parts = (so3.bracket(x[:3], y[:3]), aff.bracket(x[3:5], y[3:5]), so3.bracket(x[5:], y[5:]))
    assert both.bracket(x, y) == sum(parts, ())
    both.check_matrices()


def test_matrices_of_semidirect_products_are_faithful():
    """Affine where the action tells all apart, with the algebra's own beside it where not."""
    so3, se3 = algebra_by_name("so(3)"), algebra_by_name("se(3)")
    product = semidirect_product(
        so3,
        [
            ("a", representation_by_name(so3, "vector")),
            ("S", representation_by_name(so3, "symmetric")),
        ],
    )
    product.check_matrices()
    idle = semidirect_product(se3, [("a", representation_by_name(se3, "vector"))])
    idle.check_matrices()  # translations of se(3) do not act on vectors
    bare = from_brackets("bare", ("e",), {})
    scalar = semidirect_product(bare, [("a", Representation(bare, "zero", 1, ({},)))])
    assert scalar.matrices == ()


def test_a_sum_with_an_algebra_that_is_not_abelian():
    """so(3) acting on so(3) by ad: [(X1, Y1), (X2, Y2)] as the sheet writes it, with matrices."""
    so3 = algebra_by_name("so(3)")
    whole = semidirect_sum(so3, so3, representation_by_name(so3, "adjoint"))
    x, y = vector(6, 3), vector(6, 4)
    b = so3.bracket
    moved = zip(b(x[:3], y[3:]), b(y[:3], x[3:]), b(x[3:], y[3:]), strict=True)
    assert whole.bracket(x, y) == b(x[:3], y[:3]) + tuple(p - q + r for p, q, r in moved)
    whole.check_matrices()


def test_a_center_left_alone_leaves_a_sum_without_matrices():
    """sl(2,R) acting on h(1) by automorphisms: neither ad nor sl(2,R) sees the center."""
    sl2, h1 = algebra_by_name("sl(2,R)"), algebra_by_name("h(1)")
    whole = semidirect_sum(sl2, h1, Representation(sl2, "squeeze", 3, sl2.matrices))
    assert whole.matrices == ()
    assert whole.center() == ((0, 0, 0, 0, 0, 1),)


def test_an_action_that_is_no_derivation_is_refused():
    """Scaling A alone and not C contradicts [A, B] = C; the triple and the defect are named."""
    line, h1 = from_brackets("R", ("D",), {}), algebra_by_name("h(1)")
    scale = Representation(line, "scale", 3, ({(0, 0): 2},))
    with pytest.raises(AlgebraError, match=r"D\.\[A1, B1\].* = \(-2\) C; expected 0") as caught:
        semidirect_sum(line, h1, scale)
    assert caught.value.triple == ["D", "A1", "B1"]
    rightly = Representation(line, "scale", 3, ({(0, 0): 2, (2, 2): 2},))
    semidirect_sum(line, h1, rightly)


def test_an_action_of_another_algebra_is_refused():
    """The action must be one of the first on the second."""
    so3, se3 = algebra_by_name("so(3)"), algebra_by_name("se(3)")
    vectors = representation_by_name(se3, "vector")
    with pytest.raises(
        AlgebraError, match=r"'vector' is one of se\(3\) on R\^3; expected one of so"
    ):
        semidirect_sum(so3, so3, vectors)
    with pytest.raises(AlgebraError, match=r"on h\(2\), which has 5 dimensions"):
        semidirect_sum(se3, algebra_by_name("h(2)"), vectors)


def test_a_product_with_a_representation_of_another_algebra_is_refused():
    """se(3) acts on vectors, but so(3) was to act."""
    so3, se3 = algebra_by_name("so(3)"), algebra_by_name("se(3)")
    with pytest.raises(AlgebraError, match=r"one of se\(3\) on R\^3; expected one of so\(3\)\."):
        semidirect_product(so3, [("a", representation_by_name(se3, "vector"))])


def test_a_sum_that_explodes_is_refused_before_it_is_built():
    """The message has the number of generators."""
    large = algebra_by_name("R^2600")
    with pytest.raises(LimitError, match="the direct sum has 5200 generators"):
        direct_sum([large, large])


def test_the_sum_of_nothing_is_the_zero_algebra():
    """No parts, no generators."""
    assert direct_sum([]).dimension == 0
