"""Lie algebras of the sheet: each row typed from the book, compared with structure constants.

Beside each row stands a variant with one change, which must differ. The products of matrices here
are dense and taken entry by entry; the engine's are sparse.
"""

import random
from fractions import Fraction
from itertools import combinations, product

import pytest

from coadjoint.algebra import (
    CATALOGUE,
    Representation,
    Span,
    algebra_by_name,
    direct_sum,
    from_brackets,
    nullspace,
    representation_by_name,
    same_constants,
    semidirect_sum,
    subalgebra,
)
from tests.algebra.laws import lie_poisson_tensor, pairing, vector
from tests.sources.components import cross


def minus(a, b):
    """``a - b`` in components."""
    return [x - y for x, y in zip(a, b, strict=True)]


def plus(*vectors):
    """The sum of vectors."""
    return [sum(column) for column in zip(*vectors, strict=True)]


def times(number, a):
    """``number a``."""
    return [number * x for x in a]


def unit(n, i, value=1):
    """A basis vector."""
    return [value if j == i else 0 for j in range(n)]


def matmul(a, b):
    """The product of dense matrices."""
    return [[pairing(row, column) for column in zip(*b, strict=True)] for row in a]


def commutator(a, b):
    """``a b - b a`` of dense matrices."""
    return [minus(*rows) for rows in zip(matmul(a, b), matmul(b, a), strict=True)]


def flat(a):
    """The entries row by row."""
    return [x for row in a for x in row]


def dense(algebra, xi):
    """The matrix of a vector of the algebra."""
    size = 1 + max(max(place) for matrix in algebra.matrices for place in matrix)
    return [
        [pairing(xi, [m.get((r, c), 0) for m in algebra.matrices]) for c in range(size)]
        for r in range(size)
    ]


def levi_civita(i, j, k):
    """epsilon_ijk for 0, 1, 2."""
    return (i - j) * (j - k) * (k - i) // 2


# -- chapter 1: the Galilei group and its subgroups -----------------------------------------------


def part(algebra, *blocks):
    """The subalgebra of named blocks."""
    places = [place for block in blocks for place in algebra.blocks[block]]
    vectors = {algebra.basis[i]: unit(algebra.dimension, i) for i in places}
    return subalgebra(algebra, vectors)


def is_ideal(algebra, blocks):
    """Whether the brackets of everything with the blocks stay in the blocks."""
    inside = {place for block in blocks for place in algebra.blocks[block]}
    return all(k in inside for i, j, k, _ in algebra.structure() if i in inside or j in inside)


def test_1_3_subgroups_of_the_galilei_group():
    """Dimensions 3, 3, 3, 1, 6, 3; the constants of g(3) restrict to those of each."""
    g3, se3 = algebra_by_name("g(3)"), algebra_by_name("se(3)")
    assert same_constants(part(g3, "rotation"), algebra_by_name("so(3)"))
    for block in ("translation", "boost"):
        assert same_constants(part(g3, block), algebra_by_name("R^3"))
    assert part(g3, "time").dimension == 1
    assert same_constants(part(g3, "rotation", "translation"), se3)
    assert same_constants(part(g3, "rotation", "boost"), se3)
    plane = {"J": unit(6, 2), "P1": unit(6, 3), "P2": unit(6, 4)}
    assert same_constants(subalgebra(se3, plane), algebra_by_name("se(2)"))
    assert not same_constants(
        subalgebra(se3, {**plane, "J": unit(6, 2, -1)}), algebra_by_name("se(2)")
    )


def test_1_3_normal_chain():
    """Translations, with boosts, with time too are ideals; boosts or time alone are not."""
    g3 = algebra_by_name("g(3)")
    chain = [["translation"], ["translation", "boost"], ["translation", "boost", "time"]]
    assert all(is_ideal(g3, blocks) for blocks in (*chain, ["translation", "time"]))
    assert not is_ideal(g3, ["boost"]), "time turns boosts to translations"
    assert not is_ideal(g3, ["time"])


def se3_bracket(x, y, sign=-1):
    """[(xi, alpha), (xi', alpha')] = (xi x xi', xi x alpha' - xi' x alpha)."""
    moved = plus(cross(x[:3], y[3:]), times(sign, cross(y[:3], x[3:])))
    return (*cross(x[:3], y[:3]), *moved)


def test_1_6_bracket_of_se3():
    """The bracket, the table with epsilon_ijk, and rank 4."""
    se3 = algebra_by_name("se(3)")
    x, y = vector(6, 1), vector(6, 2)
    assert se3.bracket(x, y) == se3_bracket(x, y)
    assert se3.bracket(x, y) != se3_bracket(x, y, sign=1)
    for i, j in product(range(3), repeat=2):
        epsilon = [levi_civita(i, j, k) for k in range(3)]
        assert se3.bracket(unit(6, i), unit(6, j)) == (*epsilon, 0, 0, 0)
        assert se3.bracket(unit(6, i), unit(6, 3 + j)) == (0, 0, 0, *epsilon)
        assert not any(se3.bracket(unit(6, 3 + i), unit(6, 3 + j)))
    assert se3.generic_rank() == 4


def galilei_bracket(x, y, sign=1):
    """(xi x xi', xi x nu' - xi' x nu, xi x alpha' - xi' x alpha + nu tau' - nu' tau, 0)."""
    (xi1, nu1, alpha1, tau1), (xi2, nu2, alpha2, tau2) = (
        (v[:3], v[3:6], v[6:9], v[9]) for v in (x, y)
    )
    shift = times(sign, minus(times(tau2, nu1), times(tau1, nu2)))
    turned = minus(cross(xi1, alpha2), cross(xi2, alpha1))
    boosted = minus(cross(xi1, nu2), cross(xi2, nu1))
    return (*cross(xi1, xi2), *boosted, *plus(turned, shift), 0)


def test_1_7_bracket_of_the_galilei_algebra():
    """The bracket of the 5 x 5 matrices; [K_i, E] = +P_i, [K_i, P_j] = 0, E commutes with J, P."""
    g3 = algebra_by_name("g(3)")
    x, y = vector(10, 1), vector(10, 2)
    assert g3.bracket(x, y) == galilei_bracket(x, y)
    assert g3.bracket(x, y) != galilei_bracket(x, y, sign=-1)
    e = {name: unit(10, i) for i, name in enumerate(g3.basis)}
    for i, j in product("123", repeat=2):
        assert list(g3.bracket(e[f"K{i}"], e["E"])) == e[f"P{i}"]
        assert not any(g3.bracket(e[f"K{i}"], e[f"P{j}"]))
        assert not any(g3.bracket(e["E"], e[f"J{i}"]))
        assert not any(g3.bracket(e["E"], e[f"P{j}"]))


# -- sections 2.5.4 and 3.2.7 ---------------------------------------------------------------------


def nambu_algebra(c1, c2, c3):
    """The algebra whose minus bracket is {x_i, x_j} = -epsilon_ijk C_kl x_l, C diagonal."""
    brackets = {(1, 2): {0: c1}, (2, 0): {1: c2}, (0, 1): {2: c3}}
    return from_brackets("Nambu", ("x1", "x2", "x3"), brackets)


def test_2_5_4_algebra_of_a_quadratic_casimir_goes_by_its_signature():
    """so(3), se(2), Heisenberg and R^3 by their constants, so(2,1) and e(1,1) by a basis."""
    so21 = algebra_by_name("so(2,1)")
    assert same_constants(nambu_algebra(1, 1, 1), algebra_by_name("so(3)"))
    turned = {"x1": unit(3, 2), "x2": unit(3, 1), "x3": unit(3, 0)}  # E23, E13, E12
    assert same_constants(nambu_algebra(1, 1, -1), subalgebra(so21, turned))
    assert not same_constants(nambu_algebra(1, 1, 1), subalgebra(so21, turned))
    assert same_constants(nambu_algebra(0, 1, 1), algebra_by_name("se(2)"))
    assert same_constants(nambu_algebra(0, 0, 1), algebra_by_name("h(1)"))
    assert same_constants(nambu_algebra(0, 0, 0), algebra_by_name("R^3"))
    # e(1,1): a boost acting on two translations, of Killing signature (1, 0, 2).
    boost = algebra_by_name("so(1,1)")
    plane = from_brackets("R^2", ("P1", "P2"), {})
    e11 = semidirect_sum(boost, plane, representation_by_name(boost, "defining"))
    assert same_constants(nambu_algebra(0, -1, 1), e11)
    assert nambu_algebra(0, -1, 1).killing_signature() == (1, 0, 2)
    assert nambu_algebra(0, 1, 1).killing_signature() == (0, 1, 2)


def test_2_5_4_minus_bracket_of_the_casimir():
    """The Lie-Poisson tensor has the entries -epsilon_ijk C_kl x_l, and grad c is in its kernel."""
    c, x = vector(3, 1), vector(3, 2)
    tensor = lie_poisson_tensor(nambu_algebra(*c), x)
    for i, j in product(range(3), repeat=2):
        assert tensor[i][j] == -sum(levi_civita(i, j, k) * c[k] * x[k] for k in range(3))
    gradient = [a * b for a, b in zip(c, x, strict=True)]
    assert [pairing(row, gradient) for row in tensor] == [0, 0, 0]
    assert any(pairing(row, [gradient[0], gradient[1], -gradient[2]]) for row in tensor)


def test_3_2_7_coquaternions():
    """i^2 = -1, j^2 = k^2 = +1, ij = k = -ji, jk = -i = -kj, ki = j = -ik; the norm is det."""
    algebra = algebra_by_name("coquaternions")
    i, j, k = (dense(algebra, unit(3, n)) for n in range(3))
    one = [[1, 0], [0, 1]]

    def negative(a):
        return [times(-1, row) for row in a]

    assert matmul(i, i) == negative(one)
    assert matmul(j, j) == matmul(k, k) == one
    assert matmul(i, j) == k == negative(matmul(j, i))
    assert matmul(j, k) == negative(i) == negative(matmul(k, j))
    assert matmul(k, i) == j == negative(matmul(i, k))
    w, x, y, z = vector(4, 5)
    rows = zip(*(times(n, flat(m)) for n, m in ((w, one), (x, i), (y, j), (z, k))), strict=True)
    a, b, c, d = map(sum, rows)
    assert a * d - b * c == w * w + x * x - y * y - z * z


def test_3_2_7_imaginary_coquaternions_are_sl2():
    """I = Y - X, j = H, k = X + Y inside sl(2,R); the invariant form is x^2 - y^2 - z^2."""
    sl2, imaginary = algebra_by_name("sl(2,R)"), algebra_by_name("coquaternions")
    inside = {"i": [0, -1, 1], "j": [1, 0, 0], "k": [0, 1, 1]}
    assert subalgebra(sl2, inside).constants == imaginary.constants
    assert subalgebra(sl2, {**inside, "i": [0, 1, -1]}).constants != imaginary.constants
    assert imaginary.killing_form() == ((-8, 0, 0), (0, 8, 0), (0, 0, 8))
    # Multiplication of pure quaternions gives [i, j] = 2 k.
    assert algebra_by_name("quaternions").bracket((1, 0, 0), (0, 1, 0)) == (0, 0, 2)


# -- section 6.7: iterated semidirect products ----------------------------------------------------


def iterated_bracket(first, second, sign=1):
    """([X1, X2], X1.Y2 - X2.Y1 + [Y1, Y2], (X1 + Y1) v2 - (X2 + Y2) v1) for rotations X, boosts Y.

    [Y1, Y2] = 0, X.Y = X x Y, and (X + Y)(r, t) = (X x r + Y t, 0).
    """
    (X1, Y1, r1, t1), (X2, Y2, r2, t2) = ((v[:3], v[3:6], v[6:9], v[9]) for v in (first, second))
    moved = plus(cross(X1, r2), times(sign * t2, Y1))
    back = plus(cross(X2, r1), times(sign * t1, Y2))
    boosts = minus(cross(X1, Y2), cross(X2, Y1))
    return (*cross(X1, X2), *boosts, *minus(moved, back), 0)


def test_6_7_iterated_semidirect_product():
    """(SO(3) (s) R^3 of boosts) (s) R^4 of space-time: the sheet's bracket, and it equals g(3)."""
    so3 = algebra_by_name("so(3)")
    boosts = from_brackets("R^3", ("K1", "K2", "K3"), {})
    inner = semidirect_sum(so3, boosts, representation_by_name(so3, "vector"))
    matrices = (*so3.matrices, *({(i, 3): 1} for i in range(3)))
    events = from_brackets("R^4", ("P1", "P2", "P3", "E"), {})
    whole = semidirect_sum(inner, events, Representation(inner, "events", 4, matrices))
    first, second = vector(10, 1), vector(10, 2)
    assert whole.bracket(first, second) == iterated_bracket(first, second)
    assert whole.bracket(first, second) != iterated_bracket(first, second, sign=-1)
    assert whole.constants == algebra_by_name("g(3)").constants
    assert whole.basis == algebra_by_name("g(3)").basis


# -- appendix B -----------------------------------------------------------------------------------


def preserving(K):
    """Equations for the entries of X, row by row: ``X^T K + K X = 0``."""
    n = len(K)
    rows = []
    for a, b in product(range(n), repeat=2):
        row = {}
        for m in range(n):
            row[m * n + a] = row.get(m * n + a, 0) + K[m][b]
            row[m * n + b] = row.get(m * n + b, 0) + K[a][m]
        rows.append(row)
    return rows


def commuting(J):
    """Equations ``X J = J X``."""
    n = len(J)
    rows = []
    for a, b in product(range(n), repeat=2):
        row = {}
        for m in range(n):
            row[a * n + m] = row.get(a * n + m, 0) + J[m][b]
            row[m * n + b] = row.get(m * n + b, 0) - J[a][m]
        rows.append(row)
    return rows


def diagonal(*entries):
    """A diagonal matrix."""
    return [unit(len(entries), i, x) for i, x in enumerate(entries)]


def symplectic(n):
    """[[0, 1], [-1, 0]] in blocks of n."""
    return [unit(2 * n, i + n) if i < n else unit(2 * n, i - n, -1) for i in range(2 * n)]


def traceless(n):
    """Tr X = 0; and for a real form [[A, -B], [B, A]] also tr B = 0, by the second half."""
    return [{i * n + i: 1 for i in range(n)}]


def complex_traceless(n):
    """Tr A = tr B = 0 for A + iB as [[A, -B], [B, A]]."""
    return [
        {i * 2 * n + i: 1 for i in range(n)},
        {(n + i) * 2 * n + i: 1 for i in range(n)},
    ]


GROUPS = [
    ("gl(2)", 2, [], 4),
    ("gl(3)", 3, [], 9),
    ("sl(2,R)", 2, traceless(2), 3),
    ("sl(3,R)", 3, traceless(3), 8),
    *((f"so({n})", n, preserving(diagonal(*[1] * n)), n * (n - 1) // 2) for n in (2, 3, 4, 5, 6)),
    ("so(2,1)", 3, preserving(diagonal(1, 1, -1)), 3),
    ("so(3,1)", 4, preserving(diagonal(1, 1, 1, -1)), 6),
    ("so(2,2)", 4, preserving(diagonal(1, 1, -1, -1)), 6),
    *((f"sp({2 * n})", 2 * n, preserving(symplectic(n)), n * (2 * n + 1)) for n in (1, 2, 3)),
    *(
        (
            f"u({n})",
            2 * n,
            preserving(diagonal(*[1] * 2 * n)) + commuting(symplectic(n)),
            n * n,
        )
        for n in (1, 2, 3)
    ),
    *(
        (
            f"su({n})",
            2 * n,
            preserving(diagonal(*[1] * 2 * n)) + commuting(symplectic(n)) + complex_traceless(n),
            n * n - 1,
        )
        for n in (2, 3)
    ),
]


@pytest.mark.parametrize(("name", "n", "equations", "dimension"), GROUPS, ids=str)
def test_b_1_matrix_lie_algebras_are_what_their_equations_say(name, n, equations, dimension):
    """The solutions of X^T K + K X = 0 and its like are spanned by the named basis."""
    solutions = nullspace(equations, n * n)
    assert len(solutions) == dimension == algebra_by_name(name).dimension
    span = Span(solutions)
    for matrix in algebra_by_name(name).matrices:
        assert span.coordinates({r * n + c: x for (r, c), x in matrix.items()}) is not None


def test_b_1_equations_see_a_wrong_form():
    """The solutions for another signature do not hold so(3)."""
    span = Span(nullspace(preserving(diagonal(1, 1, -1)), 9))
    matrices = [
        {r * 3 + c: x for (r, c), x in m.items()} for m in algebra_by_name("so(3)").matrices
    ]
    assert [span.coordinates(m) is not None for m in matrices] == [False, False, True]


@pytest.mark.parametrize("n", [2, 3, 4])
def test_b_1_dimension_of_the_euclidean_group(n):
    """E(n) has n (n + 1) / 2 dimensions."""
    assert algebra_by_name(f"se({n})").dimension == n * (n + 1) // 2


def projected(algebra, i, j):
    """Coefficients of [e_i, e_j] by projection: sum_k c^k tr(e_k^T e_l) = tr([e_i, e_j]^T e_l)."""
    d = algebra.dimension
    members = [flat(dense(algebra, unit(d, k))) for k in range(d)]
    e = [dense(algebra, unit(d, k)) for k in (i, j)]
    bracket = flat(commutator(*e))
    gram = Span({k: pairing(members[k], members[m]) for k in range(d)} for m in range(d))
    found = gram.coordinates({k: pairing(members[k], bracket) for k in range(d)})
    return {k: c for k, c in found.items() if c != 0}


@pytest.mark.parametrize("name", CATALOGUE)
def test_b_2_b_3_structure_constants_by_projection(name):
    """The constants are those that projection by the trace pairing gives, and satisfy Jacobi."""
    algebra = algebra_by_name(name)
    pairs = list(combinations(range(algebra.dimension), 2))
    random.Random(1).shuffle(pairs)
    for i, j in pairs[:12]:
        assert projected(algebra, i, j) == dict(algebra.constants.get((i, j), {}))
    assert algebra.jacobi_violation() is None


def test_b_2_b_3_projection_sees_a_sign():
    """[J2, J1] is not [J1, J2]."""
    so3 = algebra_by_name("so(3)")
    assert projected(so3, 1, 0) == {2: -1} != dict(so3.constants[0, 1])


# -- appendix C -----------------------------------------------------------------------------------


def hat_basis_of_so4():
    """J_i the rotations of the first three axes, K_i those with the fourth."""
    so4 = algebra_by_name("so(4)")
    place = {name: i for i, name in enumerate(so4.basis)}
    return subalgebra(
        so4,
        {
            "J1": unit(6, place["E23"], -1),
            "J2": unit(6, place["E13"]),
            "J3": unit(6, place["E12"], -1),
            "K1": unit(6, place["E14"], -1),
            "K2": unit(6, place["E24"], -1),
            "K3": unit(6, place["E34"], -1),
        },
    )


def test_c_1_3_brackets_of_so4():
    """[J, J] = eps J, [J, K] = eps K, [K, K] = eps J; so(3,1) has the other sign in the last."""
    so4 = hat_basis_of_so4()
    for i, j in product(range(3), repeat=2):
        epsilon = [levi_civita(i, j, k) for k in range(3)]
        assert so4.bracket(unit(6, i), unit(6, j)) == (*epsilon, 0, 0, 0)
        assert so4.bracket(unit(6, i), unit(6, 3 + j)) == (0, 0, 0, *epsilon)
        assert so4.bracket(unit(6, 3 + i), unit(6, 3 + j)) == (*epsilon, 0, 0, 0)
    assert algebra_by_name("so(4)").killing_signature() == (0, 6, 0)
    assert algebra_by_name("so(3,1)").killing_signature() == (3, 3, 0)


def test_c_1_3_ad_star_of_so4():
    """(M x Omega + N x Lambda, N x Omega + M x Lambda), the rates of M and N."""
    so4 = hat_basis_of_so4()
    Omega, Lambda, M, N = (vector(3, seed) for seed in range(4))
    rates = so4.ad_star((*Omega, *Lambda), (*M, *N))
    M_dot = plus(cross(M, Omega), cross(N, Lambda))
    N_dot = plus(cross(N, Omega), cross(M, Lambda))
    assert list(rates) == M_dot + N_dot
    assert list(rates) != M_dot + plus(cross(N, Omega), cross(Lambda, M))


def test_c_1_3_so4_is_two_copies_of_so3():
    """(J + K)/2 and (J - K)/2 commute with each other, and each triple is so(3)."""
    so4, half = hat_basis_of_so4(), Fraction(1, 2)

    def halves(factor):
        return subalgebra(
            so4,
            {
                f"{side}{i + 1}": times(factor, plus(unit(6, i), unit(6, 3 + i, sign)))
                for side, sign in (("L", 1), ("R", -1))
                for i in range(3)
            },
        )

    so3 = algebra_by_name("so(3)")
    assert same_constants(halves(half), direct_sum([so3, so3]))
    assert not same_constants(halves(1), direct_sum([so3, so3]))


def test_c_4_bracket_of_symmetric_matrices():
    """X J Y - Y J X = -J [m, n] for X = J m, Y = J n symmetric, m and n in sp(2)."""
    sp2 = algebra_by_name("sp(2)")
    J = [[0, -1], [1, 0]]
    x, y = vector(3, 1), vector(3, 2)
    X, Y, bracket = (matmul(J, dense(sp2, v)) for v in (x, y, sp2.bracket(x, y)))
    assert X[0][1] == X[1][0]
    assert Y[0][1] == Y[1][0]
    left, right = matmul(matmul(X, J), Y), matmul(matmul(Y, J), X)
    commuted = [minus(*rows) for rows in zip(left, right, strict=True)]
    assert commuted == [times(-1, row) for row in bracket]
    assert commuted != bracket


def test_c_4_bracket_of_the_quadratic_momenta():
    """{X1, X2} = 4 X3, {X2, X3} = -2 X2, {X3, X1} = -2 X1 is sp(2), and X1 X2 - X3^2 a Casimir."""
    brackets = {(0, 1): {2: 4}, (1, 2): {1: -2}, (2, 0): {0: -2}}
    momenta = from_brackets("momenta", ("X1", "X2", "X3"), brackets)
    sp2 = algebra_by_name("sp(2)")
    inside = {"X1": [0, 2, 0], "X2": [0, 0, -2], "X3": [-1, 0, 0]}
    assert same_constants(momenta, subalgebra(sp2, inside))
    assert not same_constants(momenta, subalgebra(sp2, {**inside, "X3": [1, 0, 0]}))
    X1, X2, X3 = X = vector(3, 3)
    tensor = lie_poisson_tensor(momenta, X, sign=1)
    assert tensor[0][1] == 4 * X3
    assert [pairing(row, [X2, X1, -2 * X3]) for row in tensor] == [0, 0, 0]
    assert any(pairing(row, [X2, X1, 2 * X3]) for row in tensor)


def test_c_4_momenta_in_phase_space_have_that_bracket():
    """q.q, p.p and q.p on R^6 with {f, h} = f_q . h_p - f_p . h_q, their gradients by hand."""
    q, p = vector(3, 1), vector(3, 2)
    zero = [0, 0, 0]
    gradients = [(times(2, q), zero), (zero, times(2, p)), (p, q)]  # (f_q, f_p)

    def canonical(f, h):
        return pairing(f[0], h[1]) - pairing(f[1], h[0])

    X1, X2, X3 = gradients
    assert canonical(X1, X2) == 4 * pairing(q, p)
    assert canonical(X2, X3) == -2 * pairing(p, p)
    assert canonical(X3, X1) == -2 * pairing(q, q)
