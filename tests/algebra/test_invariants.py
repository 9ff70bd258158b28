"""Killing form, center, series and rank against the values that books give."""

import random
from fractions import Fraction

import pytest

from coadjoint.algebra import (
    CATALOGUE,
    LieAlgebra,
    Span,
    algebra_by_name,
    from_brackets,
    representation_by_name,
    semidirect_product,
)
from coadjoint.errors import AlgebraError
from coadjoint.exact import Field
from coadjoint.exact.linear import PRIME
from tests.algebra.laws import lie_poisson_tensor, pairing, vector


def sl2_with_plane():
    """sl(2,R) (s) R^2."""
    sl2 = algebra_by_name("sl(2,R)")
    return semidirect_product(sl2, [("e", representation_by_name(sl2, "defining"))])


@pytest.mark.parametrize("name", CATALOGUE)
def test_killing_form_is_the_trace_of_products_of_ad(name):
    """K(xi, eta) = tr(ad_xi ad_eta), the matrices of ad multiplied as written; K is symmetric."""
    algebra = algebra_by_name(name)
    form = algebra.killing_form()
    xi, eta = vector(algebra.dimension, 1), vector(algebra.dimension, 2)
    units = [[int(i == k) for i in range(algebra.dimension)] for k in range(algebra.dimension)]
    once = [algebra.bracket(eta, unit) for unit in units]
    trace = sum(algebra.bracket(xi, column)[k] for k, column in enumerate(once))
    assert pairing(xi, [pairing(row, eta) for row in form]) == trace
    assert form == tuple(zip(*form, strict=True))


@pytest.mark.parametrize(
    ("name", "signature"),
    [
        ("so(3)", (0, 3, 0)),
        ("su(2)", (0, 3, 0)),
        ("quaternions", (0, 3, 0)),
        ("sl(2,R)", (2, 1, 0)),
        ("so(2,1)", (2, 1, 0)),
        ("sp(2)", (2, 1, 0)),
        ("coquaternions", (2, 1, 0)),
        ("so(4)", (0, 6, 0)),
        ("so(3,1)", (3, 3, 0)),
        ("so(2,2)", (4, 2, 0)),
        ("su(3)", (0, 8, 0)),
        ("sl(3,R)", (5, 3, 0)),
        ("sp(4)", (6, 4, 0)),
        ("so(5)", (0, 10, 0)),
        ("gl(2)", (2, 1, 1)),
        ("u(2)", (0, 3, 1)),
        ("se(2)", (0, 1, 2)),
        ("se(3)", (0, 3, 3)),
        ("g(3)", (0, 3, 7)),
        ("h(1)", (0, 0, 3)),
        ("aff(1)", (1, 0, 1)),
        ("R^3", (0, 0, 3)),
    ],
)
def test_killing_signature_is_the_one_of_books(name, signature):
    """Compact algebras are negative definite, split ones as sl(n, R), ideals in the kernel."""
    assert algebra_by_name(name).killing_signature() == signature


def test_killing_signature_does_not_depend_on_the_basis():
    """A random change of basis of sl(2,R) and so(2,2) keeps the signature (Sylvester)."""
    source = random.Random(4)
    for name in ("sl(2,R)", "so(2,2)", "se(3)"):
        algebra = algebra_by_name(name)
        n = algebra.dimension
        rows = [[source.randint(-3, 3) for _ in range(n)] for _ in range(n)]
        new = [{i: Fraction(x) for i, x in enumerate(row) if x} for row in rows]
        span = Span(new)
        assert span.rank == n
        brackets = {
            (i, j): span.coordinates(algebra.sparse_bracket(new[i], new[j]))
            for i in range(n)
            for j in range(i + 1, n)
        }
        turned = from_brackets("turned", algebra.basis, brackets)
        assert turned.killing_signature() == algebra.killing_signature()
        assert turned.generic_rank() == algebra.generic_rank()
        assert turned.derived_series() == algebra.derived_series()


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("so(3)", 2),
        ("so(4)", 4),
        ("so(5)", 8),
        ("so(6)", 12),
        ("so(8)", 24),
        ("se(2)", 2),
        ("se(3)", 4),
        ("g(3)", 8),
        ("bargmann", 8),
        ("aff(1)", 2),
        ("h(1)", 2),
        ("h(2)", 4),
        ("sl(3,R)", 6),
        ("sp(4)", 8),
        ("gl(2)", 2),
        ("R^3", 0),
    ],
)
def test_generic_rank_is_the_dimension_of_generic_orbits(name, expected):
    """Dim so(n) - [n/2] and its like; dimension minus rank counts the Casimirs."""
    algebra = algebra_by_name(name)
    assert algebra.generic_rank() == expected


def test_generic_rank_of_sl2_with_the_plane_is_four():
    """sl(2,R) (s) R^2 has one Casimir, a cubic."""
    assert sl2_with_plane().generic_rank() == 4


@pytest.mark.parametrize("name", ["so(4)", "se(3)", "bargmann", "aff(1)"])
def test_rank_at_special_points_is_no_larger_than_the_generic_one(name):
    """The exact rank at small points never exceeds the generic one, and vanishes at the origin."""
    algebra = algebra_by_name(name)
    for seed in range(5):
        mu = vector(algebra.dimension, seed) if seed else [0] * algebra.dimension
        tensor = lie_poisson_tensor(algebra, mu)
        assert Span([dict(enumerate(row)) for row in tensor]).rank == (
            algebra.generic_rank() if seed else 0
        )


def test_center_derived_series_and_kinds():
    """What each kind of algebra is known for."""
    kinds = {
        "R^3": ((3, 0), True, True, False),
        "h(2)": ((5, 1, 0), True, True, False),
        "aff(1)": ((2, 1, 0), True, False, False),
        "se(2)": ((3, 2, 0), True, False, False),
        "se(3)": ((6,), False, False, False),
        "g(3)": ((10, 9), False, False, False),
        "bargmann": ((11, 10), False, False, False),
        "gl(2)": ((4, 3), False, False, False),
        "so(3)": ((3,), False, False, True),
        "sp(4)": ((10,), False, False, True),
        "so(3,1)": ((6,), False, False, True),
    }
    for name, expected in kinds.items():
        a = algebra_by_name(name)
        assert (a.derived_series(), a.is_solvable, a.is_nilpotent, a.is_semisimple) == expected
    assert [name for name in kinds if algebra_by_name(name).is_abelian] == ["R^3"]
    assert algebra_by_name("h(2)").lower_central_series() == (5, 1, 0)
    assert algebra_by_name("se(2)").lower_central_series() == (3, 2)
    assert [n for n in CATALOGUE if not algebra_by_name(n).is_unimodular] == ["aff(1)"]


@pytest.mark.parametrize(
    ("name", "center"),
    [
        ("bargmann", ((0,) * 10 + (1,),)),
        ("h(2)", ((0, 0, 0, 0, 1),)),
        ("gl(2)", ((1, 0, 0, 1),)),
        ("u(2)", ((0, 0, 1, 1),)),
        ("se(3)", ()),
        ("so(2)", ((1,),)),
    ],
)
def test_center_commutes_with_everything(name, center):
    """The identity of gl(2), the mass of Bargmann: they and their multiples alone."""
    algebra = algebra_by_name(name)
    assert algebra.center() == center
    for z in center:
        assert not any(algebra.bracket(z, vector(algebra.dimension, 3)))


# -- constants with parameters --------------------------------------------------------------------


def bianchi():
    """[e2, e3] = a e1, [e3, e1] = b e2, [e1, e2] = c e3 with parameters a, b, c."""
    field = Field(["a", "b", "c"])
    a, b, c = (field[name] for name in "abc")
    brackets = {(1, 2): {0: a}, (2, 0): {1: b}, (0, 1): {2: c}}
    return field, from_brackets("class A", ("e1", "e2", "e3"), brackets)


def test_constants_may_be_parameters():
    """A family with three parameters satisfies Jacobi identically and is simple in general."""
    field, algebra = bianchi()
    a, b, c = (field[name] for name in "abc")
    assert algebra.bracket((0, 1, 0), (0, 0, 1))[0] == a
    assert algebra.killing_form()[0][0] == -2 * b * c
    assert algebra.is_semisimple
    assert algebra.is_unimodular
    assert (algebra.generic_rank(), algebra.center(), algebra.derived_series()) == (2, (), (3,))
    assert algebra.ad_star((1, 0, 0), (0, 0, 1))[1] == c


def test_parameters_that_break_jacobi_are_refused_with_the_defect():
    """[e1, e2] = e2, [e1, e3] = a e3, [e2, e3] = e1 fails unless a = -1; the defect has a in it."""
    a = Field(["a"])["a"]
    brackets = {(0, 1): {1: 1}, (0, 2): {2: a}, (1, 2): {0: 1}}
    with pytest.raises(AlgebraError, match=r"\[e1, \[e2, e3\]\] \+ cyclic = \(.*a.*\) e1"):
        from_brackets("trial", ("e1", "e2", "e3"), brackets)
    from_brackets("trial", ("e1", "e2", "e3"), {**brackets, (0, 2): {2: -1}})


def test_killing_signature_refuses_parameters():
    """The signs of parameters are unknown: the message names the bracket and its coefficient."""
    _, algebra = bianchi()
    with pytest.raises(AlgebraError, match=r"\[e1, e2\] has the coefficient c of e3.*over"):
        algebra.killing_signature()


def test_over_puts_numbers_for_parameters_and_leaves_rationals():
    """(a, b, c) = (1, 1, 0) is se(2), (1, 1, -1) is so(2,1), by their signatures."""
    field, algebra = bianchi()

    def at(**values):
        numbers = {name: Fraction(value) for name, value in values.items()}
        return algebra.over(lambda x: field.evaluate(x, numbers, Fraction, lambda f, y: y))

    assert at(a=1, b=1, c=0).killing_signature() == (0, 1, 2)
    assert at(a=1, b=1, c=-1).killing_signature() == (2, 1, 0)
    assert at(a=1, b=1, c=1).constants == algebra_by_name("so(3)").constants
    so3 = algebra_by_name("so(3)")
    assert so3.over(lambda c: 1 / 0) == so3


def test_integral_constants_are_stored_as_integers():
    """Fractions that are whole become int, others stay, floats are refused."""
    algebra = from_brackets("a", ("e1", "e2"), {(0, 1): {0: Fraction(4, 2), 1: Fraction(1, 2)}})
    row = algebra.constants[0, 1]
    assert [type(value) for value in row.values()] == [int, Fraction]
    with pytest.raises(AlgebraError, match=r"0\.5 is a floating-point number"):
        from_brackets("a", ("e1", "e2"), {(0, 1): {1: 0.5}})


def test_check_matrices_sees_what_is_wrong():
    """None at all, a dependent one, and a commutator that is another."""
    so3 = algebra_by_name("so(3)")
    with pytest.raises(AlgebraError, match="carries 0 matrices; expected 3"):
        LieAlgebra("bare", so3.basis, so3.constants).check_matrices()
    double = (so3.matrices[0], so3.matrices[0], so3.matrices[2])
    with pytest.raises(AlgebraError, match=r"linearly dependent.*Remove J2"):
        LieAlgebra("double", so3.basis, so3.constants, {}, double).check_matrices()
    constants = {**so3.constants, (0, 1): {2: -1}}
    with pytest.raises(AlgebraError, match=r"J1 and J2 .*\(1, 2\): -1.*expected \(1, 2\): 1"):
        LieAlgebra("turned", so3.basis, constants, {}, so3.matrices).check_matrices()


def test_a_prime_among_the_constants_does_not_hide_a_rank():
    """[x_i, y_j] = z but for [x2, y2] = (1 + p) z: its determinant is p, at the first prime p."""
    constants = {(0, 2): {4: 1}, (0, 3): {4: 1}, (1, 2): {4: 1}, (1, 3): {4: 1 + PRIME}}
    algebra = LieAlgebra("nearly degenerate", ("x1", "x2", "y1", "y2", "z"), constants)
    assert algebra.generic_rank() == 4
    constants[1, 3] = {4: 1}
    assert LieAlgebra("degenerate", algebra.basis, constants).generic_rank() == 2
