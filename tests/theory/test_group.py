"""Actions of every group: the defining identities, each proved exactly and each spoiled."""

from fractions import Fraction

import pytest

from coadjoint.errors import AlgebraError
from coadjoint.exact import Field
from coadjoint.exact.dense import commutator, identity, product, subtract
from coadjoint.theory import MatrixGroup, matrix_group
from tests.theory.exactly import check_agrees, dot, random_point, random_vector, same

#: Groups whose actions are compared with the generic element, in its symbols.
GENERIC = (
    *("SO(2)", "SO(3)", "SO(4)", "SO(2,1)", "SO(1,2)", "SU(2)", "U(1)", "SL(2,R)"),
    *("SL(3,R)", "GL(1)", "GL(2)", "GL(3)", "Sp(2)", "SE(2)", "SE(3)", "H(1)", "H(2)"),
    *("R^3", "G(3)", "Bargmann", "Aff(1)", "SL(2,R)(s)R^2", "unit quaternions"),
    "unit coquaternions",
)
#: Groups whose generic element has too many terms to multiply out: tried at rational points.
POINTWISE = (
    *("SO(5)", "SO(3,1)", "SO(3,2)", "SU(3)", "U(2)", "U(3)", "SL(4,R)", "GL(4)", "Sp(4)", "Sp(6)"),
    "SE(4)",
)
EVERY = (*GENERIC, *POINTWISE)


def any_element(group):
    """The generic element, or one at a random point where that is too large."""
    return group.element("g") if group.name in GENERIC else random_point(group, 0)


def check_inverse(group, g, inverse):
    """``g inverse = 1 = inverse g``."""
    one = identity(group.size)
    assert same(group.field, product(g, inverse), one)
    assert same(group.field, product(inverse, g), one)


def check_pairing(group, g, Ad_star):
    """``<Ad*_g mu, eta> = <mu, Ad_g eta>`` for free mu and eta."""
    mu, eta = group.vector("mu"), group.vector("eta")
    left, right = dot(Ad_star(g, mu), eta), dot(mu, group.Ad(g, eta))
    assert not group.field.is_zero(right)
    assert group.field.is_zero(left - right)


def check_homomorphism(group, g, h, gh):
    """``Ad_(gh) = Ad_g Ad_h``."""
    xi = random_vector(group, 3)
    assert same(group.field, group.Ad(gh, xi), group.Ad(g, group.Ad(h, xi)))


def check_automorphism(group, g, bracket):
    """``Ad_g [xi, eta] = [Ad_g xi, Ad_g eta]``."""
    xi, eta = random_vector(group, 4), random_vector(group, 5)
    left, right = group.Ad(g, bracket(xi, eta)), bracket(group.Ad(g, xi), group.Ad(g, eta))
    assert same(group.field, left, right)


@pytest.mark.parametrize("name", EVERY)
def test_elements_are_in_the_group(name):
    """The generic element (or a random one) satisfies the conditions of its group."""
    group = matrix_group(name, "g")
    group.check_element(any_element(group))


@pytest.mark.parametrize("name", EVERY)
def test_the_inverse_is_two_sided(name):
    """Each group's own inverse is the inverse; the matrix itself is not taken for one."""
    group = matrix_group(name, "g")
    g = any_element(group)
    check_inverse(group, g, group.inverse(g))
    with pytest.raises(AssertionError):
        check_inverse(group, g, g)


@pytest.mark.parametrize("name", EVERY)
def test_Ad_star_is_defined_by_the_pairing(name):
    """Ad* is the dual of Ad; that of the inverse element is caught where they differ."""
    group = matrix_group(name, "g", ["mu", "eta"])
    g = any_element(group)
    check_pairing(group, g, group.Ad_star)
    if group.algebra.constants:
        with pytest.raises(AssertionError):
            check_pairing(
                group, random_point(group, 1), lambda g, mu: group.Ad_star(group.inverse(g), mu)
            )


@pytest.mark.parametrize("name", EVERY)
def test_ad_is_the_commutator_of_the_matrices(name):
    """The structure constants and the matrices give one ad, and ad* is its dual."""
    group = matrix_group(name, vectors=["xi", "eta", "mu"])
    xi, eta, mu = (group.vector(v) for v in ("xi", "eta", "mu"))
    found = group.coordinates(commutator(group.matrix(xi), group.matrix(eta)))
    assert same(group.field, found, group.ad(xi, eta))
    assert group.field.is_zero(
        group.field.zero + dot(group.ad_star(xi, mu), eta) - dot(mu, group.ad(xi, eta))
    )
    if group.algebra.constants:
        assert not same(group.field, found, group.ad(eta, xi))


@pytest.mark.parametrize("name", EVERY)
def test_Ad_is_a_homomorphism(name):
    """Ad of a product is the product of Ad, in that order."""
    group = matrix_group(name)
    g, h = random_point(group, 1), random_point(group, 2)
    group.check_element(product(g, h))
    check_homomorphism(group, g, h, product(g, h))
    if group.algebra.constants:
        with pytest.raises(AssertionError):
            check_homomorphism(group, g, h, product(g, g, h))


@pytest.mark.parametrize("name", EVERY)
def test_Ad_is_an_automorphism(name):
    """Ad keeps the bracket; it does not keep the bracket plus one of its arguments."""
    group = matrix_group(name)
    g = random_point(group, 1)
    check_automorphism(group, g, group.ad)
    if group.algebra.constants:
        odd = (1, *[0] * (group.algebra.dimension - 1))

        def spoiled(xi, eta):
            return tuple(a + b for a, b in zip(group.ad(xi, eta), odd, strict=True))

        with pytest.raises(AssertionError):
            check_automorphism(group, g, spoiled)


@pytest.mark.parametrize("name", GENERIC)
def test_AD_and_Ad_agree(name):
    """``AD_g (1 + eps xi + ...) = 1 + eps Ad_g xi + ...``: both are one conjugation."""
    group = matrix_group(name, "g", ["xi"])
    g, xi = group.element("g"), group.vector("xi")
    one = identity(group.size)
    near = tuple(
        tuple(a + b for a, b in zip(row, other, strict=True))
        for row, other in zip(one, group.matrix(xi), strict=True)
    )
    assert same(group.field, subtract(group.AD(g, near), one), group.matrix(group.Ad(g, xi)))


@pytest.mark.parametrize(
    ("name", "places"),
    [
        ("H(1)", {"A1": (0, 1), "B1": (1, 2), "C": (0, 2)}),
        ("SE(3)", {"P1": (0, 3), "P2": (1, 3), "P3": (2, 3)}),
        ("G(3)", {"K1": (0, 3), "P1": (0, 4), "P3": (2, 4), "E": (3, 4)}),
        ("Aff(1)", {"1_1": (0, 0), "e2": (0, 1)}),
        ("SL(2,R)(s)R^2", {"1_1": (0, 0), "P1": (0, 2), "P2": (1, 2)}),
    ],
)
def test_symbols_stand_where_the_book_puts_them(name, places):
    """(a, b, c), (R, v), (R, v, r, tau), (A, v) are entries of the generic matrix."""
    group = matrix_group(name, "g")
    g = group.element("g")
    for symbol, (r, c) in places.items():
        assert g[r][c] == group.field[f"g_{symbol}"]


def test_a_field_of_ones_own():
    """A group may be made over any field that has the symbols, functions included."""
    spare = matrix_group("SO(3)")
    field = Field(["theta"], slots=1)
    group = MatrixGroup(spare.name, spare.algebra, spare.linear, spare.nilpotent, field)
    c, s = (field.call(name, field["theta"]) for name in ("cos", "sin"))
    R = ((c, -s, 0), (s, c, 0), (0, 0, 1))
    group.check_element(R)
    check_agrees(field, group.Ad(R, (1, 0, 0)), lambda sign: (c, sign * s, 0))


#: The boost by (1, 0, 0) on (x, t, s, 1) without the mass term 1/2 at (s, t).
BOOST = tuple(tuple(int(r == c or (r, c) in {(0, 3), (4, 0)}) for c in range(6)) for r in range(6))


@pytest.mark.parametrize(
    ("name", "matrix", "entry"),
    [
        ("SO(3)", ((1, 0, 0), (0, 1, 0), (0, 0, 2)), (3, 3)),
        ("SO(3)", ((1, 0, 0), (0, 1, 0), (0, 0, -1)), (1, 1)),
        ("SE(3)", ((1, 0, 0, 5), (0, 1, 0, 6), (0, 0, 1, 7), (0, 0, 0, 2)), (4, 4)),
        ("SE(3)", ((1, 0, 0, 5), (0, 1, 0, 6), (0, 0, 1, 7), (3, 0, 0, 1)), (4, 1)),
        ("SL(2,R)", ((2, 0), (0, 2)), (1, 1)),
        ("Sp(2)", ((2, 0), (0, 3)), (1, 2)),
        ("SU(2)", ((0, 1, 0, 0), (1, 0, 0, 0), (0, 0, 0, 1), (0, 0, 1, 0)), (1, 1)),
        ("U(2)", ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, -1)), (2, 4)),
        ("unit quaternions", ((-1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)), (1, 2)),
        ("H(1)", ((1, 2, 3), (0, 1, 4), (5, 0, 1)), (3, 1)),
        ("H(1)", ((1, 2, 3), (0, 2, 4), (0, 0, 1)), (2, 2)),
        ("H(1)", ((1, 2, 3), (0, -1, 4), (0, 0, 1)), (2, 2)),
        ("SE(3)", ((1, 0, 0, 5), (0, 1, 0, 6), (0, 0, -1, 7), (0, 0, 0, 1)), (1, 1)),
        ("Bargmann", BOOST, (5, 4)),
        ("Aff(1)", ((2, 1), (0, 2)), (2, 2)),
        ("SL(2,R)(s)R^2", ((2, 0, 1), (0, 1, 1), (0, 0, 1)), (1, 1)),
    ],
)
def test_what_is_not_in_the_group_is_refused(name, matrix, entry):
    """The refusal names the group, the entry and what stands there."""
    group = matrix_group(name)
    with pytest.raises(AlgebraError, match="is not in") as refused:
        group.check_element(matrix)
    assert refused.value.group == name
    assert refused.value.found in str(refused.value)
    assert refused.value.entry == list(entry)


def test_a_singular_matrix_is_refused():
    """GL(2) has no matrix of determinant 0."""
    with pytest.raises(AlgebraError, match="determinant 0"):
        matrix_group("GL(2)").check_element(((1, 2), (2, 4)))


def test_what_is_not_in_the_algebra_is_refused():
    """A matrix outside the algebra is refused with the entry and its defect."""
    group = matrix_group("so(3)".upper())
    with pytest.raises(AlgebraError, match=r"is not in so\(3\).*entry \(1, 1\).*is 7") as refused:
        group.coordinates(((7, -3, 2), (3, 0, -1), (-2, 1, 0)))
    assert (refused.value.entry, refused.value.found) == ([1, 1], "7")
    assert group.coordinates(((0, -3, 2), (3, 0, -1), (-2, 1, 0))) == (1, 2, 3)


def test_Ad_refuses_what_is_not_in_the_group():
    """A conjugation that leaves the algebra is noticed, not projected."""
    with pytest.raises(AlgebraError, match=r"SO\(3\).*entry \(1, 1\) of g\^T K g - K is 3"):
        matrix_group("SO(3)").Ad(((2, 0, 0), (0, 1, 0), (0, 0, 1)), (1, 2, 3))


def test_wrong_sizes_are_refused():
    """Matrices, vectors and coordinates of the wrong size are refused with both numbers."""
    group = matrix_group("SE(3)")
    with pytest.raises(AlgebraError, match="3 x 3; expected 4 x 4"):
        group.check_element(identity(3))
    with pytest.raises(AlgebraError, match="2 components of a vector; expected 6"):
        group.Ad(identity(4), (1, 2))
    with pytest.raises(AlgebraError, match="7 components of a covector; expected 6"):
        group.Ad_star(identity(4), range(7))
    with pytest.raises(AlgebraError, match="1 coordinates of an element; expected 6"):
        group.point([1])


def test_a_hole_of_the_chart_is_refused():
    """Where the Cayley transform or the solved entry has no value, the message says so."""
    with pytest.raises(AlgebraError, match=r"no element at 0, 2, 3"):
        matrix_group("SL(2,R)").point([0, 2, 3])
    with pytest.raises(AlgebraError, match=r"no element at 1"):
        matrix_group("SO(1,1)").point([Fraction(1)])
