"""Algebras by name: every one faithful, every changed constant caught, every bad name refused."""

import random
import re
from itertools import combinations

import pytest

from coadjoint.algebra import (
    CATALOGUE,
    algebra_by_name,
    from_brackets,
    from_matrices,
    same_constants,
)
from coadjoint.algebra.catalogue import ALIASES, FAMILIES, REPRESENTATIONS, representation_by_name
from coadjoint.errors import AlgebraError, LimitError
from tests.algebra.laws import (
    every_constant,
    is_caught_by_jacobi,
    is_caught_by_matrices,
    lie_poisson_tensor,
    pairing,
    spoiled_constants,
    vector,
)

BRACKETED = [name for name in CATALOGUE if not algebra_by_name(name).is_abelian]


@pytest.mark.parametrize("name", CATALOGUE)
def test_every_named_algebra_carries_faithful_matrices(name):
    """The matrices are independent and commute by the constants; the dimension is as announced."""
    algebra = algebra_by_name(name)
    algebra.check_jacobi()
    algebra.check_matrices()
    assert algebra.name == name
    assert len(set(algebra.basis)) == len(algebra.matrices) == algebra.dimension


def test_every_family_is_in_the_catalogue():
    """The laws are tried on each family, and the announced dimensions are the true ones."""
    seen = set()
    for name in CATALOGUE:
        for family in FAMILIES:
            found = re.fullmatch(family.pattern, name)
            if found:
                sizes = map(int, found.groups())
                assert algebra_by_name(name).dimension == family.dimension(*sizes)
                seen.add(family.form)
    assert seen == {family.form for family in FAMILIES}


@pytest.mark.parametrize("name", BRACKETED)
def test_every_flipped_sign_of_every_named_algebra_is_caught(name):
    """Flip the sign of any one constant: Jacobi fails, or the matrices disagree."""
    algebra = algebra_by_name(name)
    caught = 0
    for pair, k, c in every_constant(algebra):
        spoiled = spoiled_constants(algebra, pair, k, -c)
        assert is_caught_by_jacobi(algebra, spoiled) or is_caught_by_matrices(algebra, spoiled)
        caught += 1
    assert caught == len(every_constant(algebra)) > 0
    assert not is_caught_by_matrices(algebra, algebra.constants), "the true constants pass"


#: Algebras in which some constant may take another value: [J1, J2] = 3 J3 still makes so(3) an
#: algebra, since all simple brackets of a triple go through one product; nilpotent ones, the plane
#: and the line rescale too. Jacobi cannot see such a change, the matrices do.
RESCALE = {
    *("so(3)", "so(2,1)", "se(2)", "su(2)", "u(2)", "entries(2)", "quaternions"),
    "coquaternions",
    *("sl(2,R)", "sp(2)", "gl(2)", "h(1)", "h(2)", "aff(1)"),
}


@pytest.mark.parametrize("name", BRACKETED)
def test_every_changed_value_is_caught_by_jacobi_unless_the_algebra_rescales(name):
    """Triple any constant: Jacobi fails in every algebra that is not degenerate."""
    algebra = algebra_by_name(name)
    verdicts = {
        (pair, k): is_caught_by_jacobi(algebra, spoiled_constants(algebra, pair, k, 3 * c))
        for pair, k, c in every_constant(algebra)
    }
    assert all(verdicts.values()) == (name not in RESCALE)
    for (pair, k), caught in verdicts.items():
        c = algebra.constants[pair][k]
        assert caught or is_caught_by_matrices(algebra, spoiled_constants(algebra, pair, k, 3 * c))


@pytest.mark.parametrize("dimension", [5, 6, 8])
def test_random_antisymmetric_constants_are_no_algebra(dimension):
    """Random constants violate Jacobi in every dimension from 5 on."""
    source = random.Random(dimension)
    basis = [f"e{n}" for n in range(1, dimension + 1)]
    for _ in range(5):
        brackets = {
            pair: {k: source.randint(-3, 3) for k in range(dimension)}
            for pair in combinations(range(dimension), 2)
        }
        with pytest.raises(AlgebraError, match="violate the Jacobi identity"):
            from_brackets("random", basis, brackets)


@pytest.mark.parametrize("name", BRACKETED)
def test_ad_star_is_dual_to_ad_in_every_named_algebra(name):
    """<ad*_xi mu, eta> = <mu, [xi, eta]>; the tensor pairs the same way, with both signs."""
    algebra = algebra_by_name(name)
    n = algebra.dimension
    xi, eta, mu = vector(n, 9), vector(n, 10), vector(n, 11)
    bracket = algebra.bracket(xi, eta)
    assert any(bracket), "a zero bracket satisfies everything"
    value = pairing(mu, bracket)
    assert pairing(algebra.ad_star(xi, mu), eta) == value != 0
    for sign in (-1, 1):
        tensor = lie_poisson_tensor(algebra, mu, sign)
        assert pairing(xi, [pairing(row, eta) for row in tensor]) == sign * value


@pytest.mark.parametrize("name", BRACKETED)
def test_ad_star_moves_matrices_as_the_commutator_does(name):
    """The bracket of coordinates is the commutator of dense matrices, taken entry by entry."""
    algebra = algebra_by_name(name)
    n = algebra.dimension
    size = 1 + max(max(place) for matrix in algebra.matrices for place in matrix)

    def dense(x):
        return [
            [pairing(x, [m.get((r, c), 0) for m in algebra.matrices]) for c in range(size)]
            for r in range(size)
        ]

    def times(a, b):
        return [[pairing(row, column) for column in zip(*b, strict=True)] for row in a]

    xi, eta = vector(n, 1), vector(n, 2)
    x, y = dense(xi), dense(eta)
    left, right = times(x, y), times(y, x)
    expected = [
        [p - q for p, q in zip(*rows, strict=True)] for rows in zip(left, right, strict=True)
    ]
    assert dense(algebra.bracket(xi, eta)) == expected


@pytest.mark.parametrize(
    ("written", "canonical"),
    [
        ("sl(3)", "sl(3,R)"),
        ("sl(3, R)", "sl(3,R)"),
        ("gl(2,R)", "gl(2)"),
        ("sp(4,R)", "sp(4)"),
        ("so( 2, 1 )", "so(2,1)"),
        ("heisenberg", "h(1)"),
        ("galilei", "g(3)"),
        ("R ^ 3", "R^3"),
    ],
)
def test_other_spellings_are_the_same_algebra(written, canonical):
    """An alias gives the very algebra, and it is built once."""
    assert algebra_by_name(written) is algebra_by_name(canonical)
    assert algebra_by_name(canonical).name == canonical
    assert set(ALIASES) == {"heisenberg", "galilei"}


def test_bases_are_named_and_ordered_as_books_do():
    """The names of each basis, in order."""
    expected = {
        "so(3)": "J1 J2 J3",
        "so(4)": "E12 E13 E14 E23 E24 E34",
        "so(2,1)": "E12 E13 E23",
        "se(2)": "J P1 P2",
        "g(3)": "J1 J2 J3 K1 K2 K3 P1 P2 P3 E",
        "bargmann": "J1 J2 J3 K1 K2 K3 P1 P2 P3 E M",
        "sl(2,R)": "H X Y",
        "sl(3,R)": "H1 H2 E12 E13 E21 E23 E31 E32",
        "gl(2)": "E11 E12 E21 E22",
        "sp(4)": "A11 A12 A21 A22 B11 B12 B22 C11 C12 C22",
        "su(3)": "A12 A13 A23 S12 S13 S23 D1 D2",
        "harmonics(3)": "C1_0 C1_1 S1_1 C2_0 C2_1 S2_1 C2_2 S2_2",
        "u(2)": "A12 S12 D1 D2",
        "h(2)": "A1 A2 B1 B2 C",
        "R^3": "P1 P2 P3",
        "aff(1)": "e1 e2",
    }
    assert {name: " ".join(algebra_by_name(name).basis) for name in expected} == expected
    assert algebra_by_name("so(11)").basis[-1] == "E10_11"


#: Brackets as books write them; pairs left out commute.
BOOK = {
    "so(3)": {"J1 J2": {"J3": 1}, "J2 J3": {"J1": 1}, "J1 J3": {"J2": -1}},
    "su(2)": {"T1 T2": {"T3": 1}, "T2 T3": {"T1": 1}, "T1 T3": {"T2": -1}},
    "quaternions": {"i j": {"k": 2}, "j k": {"i": 2}, "i k": {"j": -2}},
    "coquaternions": {"i j": {"k": 2}, "j k": {"i": -2}, "i k": {"j": -2}},
    "so(2,1)": {"E12 E13": {"E23": -1}, "E12 E23": {"E13": 1}, "E13 E23": {"E12": 1}},
    "sl(2,R)": {"H X": {"X": 2}, "H Y": {"Y": -2}, "X Y": {"H": 1}},
    "sp(2)": {"A11 B11": {"B11": 2}, "A11 C11": {"C11": -2}, "B11 C11": {"A11": 1}},
    "se(2)": {"J P1": {"P2": 1}, "J P2": {"P1": -1}},
    "aff(1)": {"e1 e2": {"e2": 1}},
    "h(2)": {"A1 B1": {"C": 1}, "A2 B2": {"C": 1}},
    "u(2)": {
        "A12 S12": {"D1": 2, "D2": -2},
        "A12 D1": {"S12": -1},
        "A12 D2": {"S12": 1},
        "S12 D1": {"A12": 1},
        "S12 D2": {"A12": -1},
    },
    "R^3": {},
}


@pytest.mark.parametrize("name", BOOK)
def test_brackets_are_those_of_books(name):
    """The whole table of each small algebra, typed by hand."""
    algebra = algebra_by_name(name)
    table = {
        f"{algebra.basis[i]} {algebra.basis[j]}": {algebra.basis[k]: c for k, c in row.items()}
        for (i, j), row in algebra.constants.items()
    }
    assert table == BOOK[name]


# -- bad names ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("so(1)", r"'so\(1\)'; so\(n\) has n >= 2"),
        ("so(0,3)", r"'so\(0,3\)'; so\(p,q\) has p >= 1 and q >= 1"),
        ("sp(3)", r"'sp\(3\)'; sp\(2n,R\) has an even size"),
        ("sl(1)", r"'sl\(1\)'; sl\(n,R\) has n >= 2"),
        ("se(1)", r"'se\(1\)'"),
        ("R^0", r"'R\^0'"),
        ("g(4)", r"called 'g\(4\)'.*Did you mean '.*g\(3\)'"),
        ("SO(3)", r"called 'SO\(3\)'.*expected one of so\(n\), so\(p,q\)"),
        ("hiesenberg", r"'hiesenberg'.*Did you mean 'heisenberg'"),
        ("quaternion", r"Did you mean 'quaternions'"),
        ("so(3)\n", r"."),
        ("", r"no algebra is called ''"),
        ("so(" + "9" * 5000 + ")", r"no algebra is called"),
    ],
)
def test_a_name_or_size_that_is_none_is_refused(name, said):
    """The message has the name, what there is and the nearest known ones."""
    if name == "so(3)\n":  # blanks do not matter, and a line break is one
        assert algebra_by_name(name).name == "so(3)"
        return
    with pytest.raises(AlgebraError, match=said) as caught:
        algebra_by_name(name)
    assert caught.value.found == name


def test_an_explosion_is_refused_before_anything_is_built():
    """so(200) would have 19900 generators; the estimate is in the message."""
    with pytest.raises(LimitError, match=r"so\(200\) has 19900 generators and 197995050 brackets"):
        algebra_by_name("so(200)")
    with pytest.raises(LimitError, match="999999"):
        algebra_by_name("R^999999")  # its matrices alone would fill the memory


def test_the_bound_can_be_set():
    """A caller may ask for less; what was built before does not slip through."""
    assert algebra_by_name("so(5)", most=10).dimension == 10
    with pytest.raises(LimitError, match="at most 9 generators") as caught:
        algebra_by_name("so(5)", most=9)
    assert (caught.value.found, caught.value.limit, caught.value.brackets) == (10, 9, 45)


# -- representations ------------------------------------------------------------------------------


NAMES = ("so(3)", "se(2)", "se(3)", "g(3)", "bargmann", "sp(4)", "aff(1)")
#: A unit quaternion is turned by rotations alone; that others are refused has a test of its own.
ACTING = [(n, k) for n in NAMES for k in REPRESENTATIONS if k != "quaternion" or n == "so(3)"]


@pytest.mark.parametrize(("name", "kind"), ACTING)
def test_every_representation_has_its_dual_and_its_diamond(name, kind):
    """<b <> a, eta> = -<b, rho(eta) a>, and the dual action is minus the transpose."""
    algebra = algebra_by_name(name)
    acting = representation_by_name(algebra, kind)
    eta, b, a = (
        vector(algebra.dimension, 5),
        vector(acting.dimension, 6),
        vector(acting.dimension, 7),
    )
    moved = acting.act(eta, a)
    assert any(moved) == (kind != "trivial"), "a zero action satisfies everything"
    assert pairing(acting.diamond(b, a), eta) == -pairing(b, moved)
    assert pairing(acting.dual().act(eta, b), a) == -pairing(b, moved)


@pytest.mark.parametrize("name", ["so(3)", "se(3)", "g(3)", "bargmann"])
def test_vectors_of_space_are_turned_and_nothing_else(name):
    """'vector' is the rotation block on R^3: xi x a, whatever the other generators."""
    algebra = algebra_by_name(name)
    vectors = representation_by_name(algebra, "vector")
    xi, (a1, a2, a3) = vector(algebra.dimension, 1), vector(3, 2)
    x1, x2, x3 = xi[:3]
    assert vectors.act(xi, (a1, a2, a3)) == (
        x2 * a3 - x3 * a2,
        x3 * a1 - x1 * a3,
        x1 * a2 - x2 * a1,
    )


def test_vector_means_the_matrices_of_an_algebra_that_only_bears_the_name_of_a_block():
    """A declared algebra with a block called rotation has its own matrices as 'vector'."""
    se3 = algebra_by_name("se(3)")
    own = from_matrices("mine", se3.basis, se3.matrices, se3.blocks)
    assert representation_by_name(own, "vector").dimension == 4
    assert representation_by_name(se3, "vector").dimension == 3
    assert representation_by_name(se3, "defining").dimension == 4


def test_columns_and_symmetric_matrices_are_moved_as_the_formulas_say():
    """A -> X A and S -> X S + S X^T, entry by entry, for a random X of gl(2)."""
    gl2 = algebra_by_name("gl(2)")
    (p, q, r, s), (a, b, c, d) = x = vector(4, 1), vector(4, 2)
    moved = representation_by_name(gl2, "columns").act(*x)
    assert moved == (p * a + q * c, p * b + q * d, r * a + s * c, r * b + s * d)
    symmetric = representation_by_name(gl2, "symmetric").act((p, q, r, s), (a, b, d))
    assert symmetric == (
        2 * (p * a + q * b),
        p * b + q * d + r * a + s * b,
        2 * (r * b + s * d),
    )


def test_a_representation_by_matrices_of_an_algebra_without_is_refused():
    """The message names the representation that was asked for."""
    bare = from_brackets("bare", ("e1", "e2"), {(0, 1): {1: 1}})
    with pytest.raises(AlgebraError, match="has no matrices, so it has no 'symmetric'"):
        representation_by_name(bare, "symmetric")
    assert same_constants(bare, algebra_by_name("aff(1)"))
