"""Casimirs are found: as many as the rank predicts, each one proved, none by luck."""

from fractions import Fraction

import pytest

from coadjoint.algebra import algebra_by_name, direct_sum, from_brackets, semidirect_product
from coadjoint.algebra.representation import defining
from coadjoint.errors import AlgebraError
from coadjoint.exact import Field, element_text
from coadjoint.exact.linear import PRIME
from coadjoint.exact.ranks import generic_rank
from coadjoint.limits import MONOMIALS
from coadjoint.poisson import PoissonStructure, declare_bracket, lie_poisson, nambu
from coadjoint.poisson.casimirs import casimirs
from coadjoint.poisson.polynomials import primitive, read_terms
from coadjoint.poisson.search import independent_polynomials
from coadjoint.poisson.summands import restrict_algebra, summands

#: Algebras of dimension at most 11, with the degrees of their Casimirs.
DEGREES = {
    "so(3)": [2],
    "so(4)": [2, 2],
    "so(5)": [2, 4],
    "so(2,1)": [2],
    "so(3,1)": [2, 2],
    "so(2,2)": [2, 2],
    "so(3,2)": [2, 4],
    "se(2)": [2],
    "se(3)": [2, 2],
    "se(4)": [2, 4],
    "sl(2,R)": [2],
    "sl(3,R)": [2, 3],
    "gl(2)": [1, 2],
    "gl(3)": [1, 2, 3],
    "su(2)": [2],
    "su(3)": [2, 3],
    "harmonics(3)": [2, 3],
    "u(2)": [1, 2],
    "u(3)": [1, 2, 3],
    "sp(2)": [2],
    "sp(4)": [2, 4],
    "h(1)": [1],
    "h(5)": [1],
    "g(3)": [2, 4],
    "bargmann": [1, 2, 4],
    "aff(1)": [],
    "quaternions": [2],
    "coquaternions": [2],
    "R^3": [1, 1, 1],
}


def degree(structure, element):
    """The degree of a polynomial element."""
    return max(map(sum, read_terms(structure.field, element, structure.names)))


def check_casimirs(structure, generators):
    """Each generator commutes with every coordinate, and their gradients are independent."""
    for element in generators:
        defects = structure.casimir_defects(element)
        assert not any(defects), element_text(structure.field, element)
    slopes = [structure.gradient(element) for element in generators]
    assert generic_rank(structure.field, slopes) == len(generators)


@pytest.mark.parametrize("name", DEGREES)
def test_every_casimir_of_the_catalogue_is_found(name):
    """As many independent Casimirs as dimension - rank, of the degrees that books give."""
    algebra = algebra_by_name(name)
    assert algebra.dimension <= 11
    search = casimirs(algebra, 4)
    assert len(search.generators) == search.expected == len(DEGREES[name])
    assert search.missing == ""
    check_casimirs(search.structure, search.generators)
    assert [degree(search.structure, c) for c in search.generators] == DEGREES[name]


def test_casimir_check_sees_one_wrong_sign_and_a_repetition():
    """The check above can fail: for a function that is none, and for a dependent one."""
    search = casimirs(algebra_by_name("se(3)"), 2)
    structure, (first, second) = search.structure, search.generators
    with pytest.raises(AssertionError):
        check_casimirs(structure, [first - 2 * structure.field["J1"] * structure.field["P1"]])
    with pytest.raises(AssertionError):
        check_casimirs(structure, [first, second, first * second])


def test_casimirs_have_a_readable_normal_form():
    """Small coprime integers, the leading coefficient positive."""
    search = casimirs(algebra_by_name("bargmann"), 2)
    field = search.structure.field
    assert [element_text(field, c) for c in search.generators] == [
        "M",
        "P1^2 + P2^2 + P3^2 - 2*E*M",
    ]


def test_a_degree_too_small_is_said():
    """g(3) has a Casimir of degree 4; a search up to 3 names one missing and why."""
    search = casimirs(algebra_by_name("g(3)"), 3)
    assert (len(search.generators), search.expected) == (1, 2)
    assert search.missing == "1 not found among all polynomials of degree <= 3"
    assert search.degree == 3


@pytest.mark.parametrize(
    ("weights", "casimir"), [((1, 1), "e2/e3"), ((1, Fraction(3, 2)), "e2^3/e3^2")]
)
def test_rational_casimirs_are_quotients_of_semi_invariants(weights, casimir):
    """[e1, e2] = a e2, [e1, e3] = b e3 has no polynomial Casimir but e2^b/e3^a."""
    rows = {(0, 1): {1: weights[0]}, (0, 2): {2: weights[1]}}
    search = casimirs(from_brackets("scaling", ("e1", "e2", "e3"), rows))
    assert [element_text(search.structure.field, c) for c in search.generators] == [casimir]
    assert search.missing == ""
    assert search.method == "quotients of semi-invariants"
    check_casimirs(search.structure, search.generators)


def test_a_casimir_that_is_not_rational_is_missing():
    """A Jordan block has the Casimir e2 exp(-e3/e2) or the like, which is not found, and said."""
    rows = {(0, 1): {1: 1, 2: 1}, (0, 2): {2: 1}}
    search = casimirs(from_brackets("spiral", ("e1", "e2", "e3"), rows))
    assert (search.generators, search.expected) == ((), 1)
    assert "1 not found" in search.missing


def test_the_cubic_casimir_of_sl2_with_vectors():
    """sl(2,R) (s) R^2 has one Casimir, of degree 3 (Holm 2011, section 6.5)."""
    sl2 = algebra_by_name("sl(2,R)")
    search = casimirs(semidirect_product(sl2, [("p", defining(sl2))]))
    assert [degree(search.structure, c) for c in search.generators] == [3]
    assert search.expected == 1


def test_casimirs_of_a_bracket_that_is_not_linear():
    """The Nambu bracket of a quartic c has just c, found by inhomogeneous monomials."""
    field = Field(["x", "y", "z"])
    x, y, z = (field[name] for name in field.names)
    c = x**4 + x * y + z**2 - 3 * z
    structure = nambu(field, field.names, [c])
    (found,) = casimirs(structure, 4).generators
    assert found == c


@pytest.mark.parametrize(
    ("name", "degrees"),
    [
        ("so(6)", [2, 3, 4]),
        ("so(8)", [2, 4, 4, 6]),
        ("so(4,4)", [2, 4, 4, 6]),
        ("sp(6)", [2, 4, 6]),
    ],
)
def test_larger_algebras_are_completed_by_matrix_invariants(name, degrees):
    """so(6), so(8) and sp(6) have all their Casimirs, counted by independent gradients."""
    search = casimirs(algebra_by_name(name), 4)
    assert sorted(degree(search.structure, c) for c in search.generators) == degrees
    assert search.missing == ""
    slopes = [search.structure.gradient(c) for c in search.generators]
    assert generic_rank(search.structure.field, slopes) == len(degrees)
    check_casimirs(search.structure, search.generators[:2])


def test_a_search_beyond_the_limit_is_made_to_a_lower_degree():
    """se(8) has 91389 monomials up to degree 4: degree 3 is searched, and what was not is told."""
    search = casimirs(algebra_by_name("se(8)"), 4)
    assert (len(search.generators), search.expected, search.degree) == (1, 4, 3)
    assert search.missing == (
        "3 not found among all polynomials of degree <= 3; polynomials of degree 4 were not "
        f"searched: 91389 monomials up to degree 4, more than {MONOMIALS} (MONOMIALS)"
    )


def test_casimirs_of_a_direct_sum_are_those_of_its_parts():
    """so(4) + h(1) + R^2: four summands, whose Casimirs have the names of their own coordinates."""
    parts = [algebra_by_name(name) for name in ("so(4)", "h(1)", "R^2")]
    algebra = direct_sum(parts)
    search = casimirs(algebra)
    assert summands(search.structure) == [tuple(range(6)), (6, 7, 8), (9,), (10,)]
    texts = [element_text(search.structure.field, c) for c in search.generators]
    assert texts[2:] == ["C", "P1", "P2"]
    alone = casimirs(parts[0])
    assert texts[:2] == [element_text(alone.structure.field, c) for c in alone.generators]
    check_casimirs(search.structure, search.generators)


def test_a_term_between_the_summands_joins_them():
    """x1 times a bracket of the second spin: the structure is no product, whatever the names."""
    field = Field([f"{letter}{n}" for letter in "xyz" for n in (1, 2)])
    x1, y1, z1, x2, y2, z2 = (field[f"{letter}{n}"] for n in (1, 2) for letter in "xyz")
    names = ("x1", "y1", "z1", "x2", "y2", "z2")
    entries = {(0, 1): z1, (1, 2): x1, (0, 2): -y1, (3, 4): z2, (4, 5): x2, (3, 5): -y2}
    apart = declare_bracket(field, names, entries)
    assert summands(apart) == [(0, 1, 2), (3, 4, 5)]
    square = x1**2 + y1**2 + z1**2
    joined = declare_bracket(
        field, names, {pair: e * square if pair[0] > 2 else e for pair, e in entries.items()}
    )
    assert summands(joined) == [tuple(range(6))]
    assert [degree(joined, c) for c in casimirs(joined, 2).generators] == [2, 2]


def test_a_summand_in_another_order_keeps_its_algebra():
    """so(3) with its basis reversed: constants change their signs, the matrices go along."""
    so3 = algebra_by_name("so(3)")
    turned = restrict_algebra(so3, (2, 1, 0))
    assert turned.basis == ("J3", "J2", "J1")
    assert dict(turned.constants[0, 1]) == {2: -1}
    turned.check_matrices()


def test_casimirs_have_functions_of_parameters_and_pi_as_coefficients():
    """``b x^2 + y^2 + a z^2``, its first coefficient 1; the same with pi and pi sqrt(2)."""
    field = Field(["x", "y", "z", "a", "b"], slots=2)
    x, y, z, a, b = (field[name] for name in "xyzab")
    pi = 4 * field.call("atan", field.one)
    names = ("x", "y", "z")
    for one, other in ((a, b), (pi, b), (pi * field.call("sqrt", field.number(2)), a + 2)):
        brackets = {(0, 1): one * z, (1, 2): other * x, (0, 2): -y}
        structure = declare_bracket(field, names, brackets)
        (found,) = casimirs(structure, 2).generators
        assert field.is_zero(found - (x**2 + y**2 / other + one * z**2 / other))
        assert not structure.is_casimir(found + z**2)


def test_the_casimir_of_a_plane_with_a_scale():
    """``p^2 + a q^2``, which no search with rational coefficients finds."""
    field = Field(["m", "p", "q", "a"])
    p, q, a = (field[name] for name in "pqa")
    structure = declare_bracket(field, ("m", "p", "q"), {(0, 1): a * q, (0, 2): -p})
    (found,) = casimirs(structure, 2).generators
    assert field.is_zero(found - (p**2 + a * q**2)) or field.is_zero(found - (p**2 / a + q**2))


def test_a_search_refuses_quotients_and_functions():
    """Coefficients must be numbers and parameters; what is in the way is named."""
    field = Field(["x", "y", "z", "a"], slots=1)
    z = field["z"]
    root = field.call("sqrt", z)
    for entry, found in ((1 / z, "quotient"), (root, "'sqrt'")):
        structure = declare_bracket(field, ("x", "y", "z"), {(0, 1): entry})
        with pytest.raises(AlgebraError, match=found):
            casimirs(structure, 2)


def test_a_search_refuses_a_bracket_that_is_not_poisson():
    """Asking only generating coordinates rests on the Jacobi identity."""
    field = Field(["x", "y", "z"])
    x, y, zero = field["x"], field["y"], field.zero
    tensor = ((zero, x, y), (-x, zero, zero), (-y, zero, zero))
    with pytest.raises(AlgebraError, match="Jacobi"):
        casimirs(PoissonStructure(field, field.names, tensor), 2)


def test_both_signs_of_the_bracket_have_the_same_casimirs():
    """The plus bracket of se(3)* has the Casimirs of the minus bracket."""
    algebra = algebra_by_name("se(3)")
    field = Field(algebra.basis)
    texts = [
        [element_text(field, c) for c in casimirs(structure, 2).generators]
        for structure in (lie_poisson(algebra, field, algebra.basis, s) for s in (-1, 1))
    ]
    assert texts[0] == texts[1] != []


def test_a_prime_among_coefficients_does_not_hide_independence():
    """X + y and x + (1 + p) y agree modulo the first prime p, and are independent."""
    first, second = (primitive({(1, 0): 1, (0, 1): 1 + n}) for n in (0, PRIME))
    assert independent_polynomials([first, first, second], 2, 2) == [first, second]
