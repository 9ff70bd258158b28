"""Poisson brackets of the book, typed in by hand, against those that the engine derives.

Section numbers are those of Holm (2011), Geometric Mechanics II. Beside each comparison stands one
with a sign changed, which must fail.
"""

import pytest

from coadjoint.algebra import algebra_by_name, from_brackets, semidirect_product
from coadjoint.algebra.catalogue import representation_by_name
from coadjoint.exact import Field
from coadjoint.poisson import (
    PoissonStructure,
    canonical,
    declare_bracket,
    lie_poisson,
    magnetic,
    nambu,
)
from coadjoint.poisson.casimirs import casimirs
from coadjoint.poisson.structure import antisymmetric
from tests.sources.bodies import rigid_body_rates
from tests.sources.components import cross, dot, hat, plus

CYCLIC = [(0, 1, 2), (1, 2, 0), (2, 0, 1)]


def symbols(field, *stems):
    """Vectors of three symbols, one for each stem."""
    return [[field[f"{stem}{n}"] for n in (1, 2, 3)] for stem in stems]


def structure_of(name, names, parameters=(), **options):
    """The minus Lie-Poisson bracket of a named algebra in the book's letters."""
    field = Field([*names, *parameters], **options)
    return field, lie_poisson(algebra_by_name(name), field, names)


def triples(*stems):
    """Names of vectors."""
    return [f"{stem}{n}" for stem in stems for n in (1, 2, 3)]


def check_table(structure, table):
    """Every bracket of two coordinates is the one of the table."""
    field = structure.field
    derived = [
        [structure.bracket(field[a], field[b]) for b in structure.names] for a in structure.names
    ]
    assert any(map(any, derived)), "a table of zeros says nothing"
    assert all(
        x == y
        for row, typed in zip(derived, table, strict=True)
        for x, y in zip(row, typed, strict=True)
    )


def check_table_and_spoiled(structure, table):
    """The table fits, and with the sign of any one entry changed it does not."""
    check_table(structure, table)
    for i, row in enumerate(table):
        for j, entry in enumerate(row):
            if entry != 0:
                spoiled = [list(line) for line in table]
                spoiled[i][j] = -entry
                with pytest.raises(AssertionError):
                    check_table(structure, spoiled)


def blocks(rows):
    """A table from 3 x 3 blocks."""
    return [[x for block in row for x in block[line]] for row in rows for line in range(3)]


ZERO = [[0, 0, 0]] * 3


def test_2_5_1_axioms():
    """Skew, bilinear, Leibniz and Jacobi for the bracket of the rigid body; a spoiled one fails."""
    field, structure = structure_of("so(3)", triples("Pi"), ["a", "b"])
    x, y, z = (field[name] for name in triples("Pi"))
    f, g, h, a, b = x * y, y**2 + z, x + z**3, field["a"], field["b"]
    bracket = structure.bracket
    assert bracket(f, g) == -bracket(g, f) != 0
    assert bracket(a * f + b * g, h) == a * bracket(f, h) + b * bracket(g, h)
    assert bracket(f * g, h) == bracket(f, h) * g + f * bracket(g, h)

    def cyclic(bracket):
        return bracket(f, bracket(g, h)) + bracket(g, bracket(h, f)) + bracket(h, bracket(f, g))

    assert cyclic(bracket) == 0
    tensor = antisymmetric(field, 3, {(0, 1): -z, (0, 2): y, (1, 2): -x * y})
    assert cyclic(PoissonStructure(field, structure.names, tensor).bracket) != 0


def test_2_5_2_bracket_of_the_rigid_body():
    """{f, h} = -Pi.(df x dh), with the printed table of Pi."""
    field, structure = structure_of("so(3)", triples("Pi"))
    p1, p2, p3 = Pi = symbols(field, "Pi")[0]
    check_table_and_spoiled(structure, [[0, -p3, p2], [p3, 0, -p1], [-p2, p1, 0]])
    f, h = p1 * p2 + p3**2, p1**2 - p2 * p3
    df, dh = (field.gradient(g, structure.names) for g in (f, h))
    assert structure.bracket(f, h) == -dot(Pi, cross(df, dh)) != dot(Pi, cross(df, dh))
    assert structure.is_casimir(dot(Pi, Pi))
    assert not structure.is_casimir(dot(Pi, Pi) - 2 * p1**2)


def test_2_5_4_nambu_bracket():
    """{f, h} = -dc.(df x dh) moves by dc x dh, for the rigid body by Euler's equations."""
    names, inertia = triples("x"), ["I1", "I2", "I3"]
    field = Field([*names, *inertia])
    x, i = [field[n] for n in names], [field[n] for n in inertia]
    h = x[0] ** 2 / (2 * i[0]) + x[1] ** 2 / (2 * i[1]) + x[2] ** 2 / (2 * i[2])
    structure = nambu(field, names, [dot(x, x) / 2])
    motion = list(structure.hamiltonian_vector_field(h))
    assert motion == cross(x, field.gradient(h, names))
    assert motion == rigid_body_rates(x, i)
    assert motion != [-rate for rate in rigid_body_rates(x, i)]
    assert structure.is_casimir(dot(x, x))


def test_2_5_4_exercise_quadratic_casimir():
    """For c = x.Cx/2 the bracket is linear: {x_i, x_j} = -eps_ijk C_kl x_l, for every C."""
    names = triples("x")
    entries = ["C11", "C12", "C13", "C22", "C23", "C33"]
    field = Field([*names, *entries])
    x = [field[n] for n in names]
    C = [[field[f"C{min(k, m)}{max(k, m)}"] for m in (1, 2, 3)] for k in (1, 2, 3)]
    Cx = [dot(row, x) for row in C]
    structure = nambu(field, names, [dot(x, Cx) / 2])
    # -eps_ijk (Cx)_k is the matrix hat(Cx)
    check_table_and_spoiled(structure, hat(Cx))
    assert structure.is_casimir(dot(x, Cx) ** 3)
    assert not structure.is_casimir(dot(x, x))
    structure.check_jacobi()


def test_4_3_4_heisenberg_bracket():
    """mu1' = -xi2 mu3, mu2' = xi1 mu3, mu3' = 0 with xi = dh/dmu; mu3 is the Casimir."""
    field, structure = structure_of("h(1)", triples("mu"))
    mu1, mu2, mu3 = (field[n] for n in triples("mu"))
    check_table_and_spoiled(structure, [[0, -mu3, 0], [mu3, 0, 0], [0, 0, 0]])
    motion = structure.hamiltonian_vector_field((mu1**2 + mu2**2) / 2)
    assert motion == (-mu2 * mu3, mu1 * mu3, 0)
    assert casimirs(structure).generators == (mu3,)
    assert not structure.is_casimir(mu1)


def test_6_4_bracket_of_se2():
    """{m, b1} = -b2, {m, b2} = b1, {b1, b2} = 0; Casimir b.b."""
    field, structure = structure_of("se(2)", ["m", "b1", "b2"])
    b1, b2 = field["b1"], field["b2"]
    check_table_and_spoiled(structure, [[0, -b2, b1], [b2, 0, 0], [-b1, 0, 0]])
    assert casimirs(structure).generators == (b1**2 + b2**2,)
    assert not structure.is_casimir(b1**2 - b2**2)


def test_6_5_cubic_casimir_of_sl2_with_vectors():
    """det(beta, mu beta) is the one Casimir, with tr(mu^T a) + beta.u as pairing."""
    sl2 = algebra_by_name("sl(2,R)")
    algebra = semidirect_product(sl2, [("p", representation_by_name(sl2, "defining"))])
    names = ["h", "x", "y", "p1", "p2"]
    field = Field(names)
    structure = lie_poisson(algebra, field, names)
    h, x, y, p1, p2 = (field[n] for n in names)
    mu = [[h / 2, x], [y, -h / 2]]  # tr(mu^T H) = h, tr(mu^T X) = x, tr(mu^T Y) = y

    def determinant(m):
        return p1 * (m[1][0] * p1 + m[1][1] * p2) - p2 * (m[0][0] * p1 + m[0][1] * p2)

    assert structure.is_casimir(determinant(mu))
    transposed = [[mu[0][0], mu[1][0]], [mu[0][1], mu[1][1]]]
    assert not structure.is_casimir(determinant(transposed))
    (found,) = casimirs(structure).generators
    assert found == -determinant(mu)


def test_7_1_2_bracket_of_se3():
    """The 6 x 6 matrix [[hat mu, hat beta], [hat beta, 0]]; Casimirs beta.beta, mu.beta; rank 4."""
    field, structure = structure_of("se(3)", triples("mu", "beta"))
    mu, beta = symbols(field, "mu", "beta")
    check_table_and_spoiled(structure, blocks([[hat(mu), hat(beta)], [hat(beta), ZERO]]))
    f, h = mu[0] * beta[1] + mu[2] ** 2, mu[1] * mu[0] - beta[2] * beta[0] + mu[2]
    fm, fb, hm, hb = (field.gradient(g, triples(v)) for g in (f, h) for v in ("mu", "beta"))
    moved = [a - b for a, b in zip(cross(fm, hb), cross(hm, fb), strict=True)]
    assert structure.bracket(f, h) == -dot(mu, cross(fm, hm)) - dot(beta, moved) != 0
    assert structure.generic_rank() == 4
    assert set(casimirs(structure).generators) == {dot(beta, beta), dot(mu, beta)}
    assert not structure.is_casimir(dot(mu, mu))


def test_7_2_1_heavy_top_and_vehicle_share_their_bracket():
    """se(3)* and so(3) (s) R^3 with advected Gamma have the same tensor, entry by entry."""
    names = triples("Pi", "P")
    field = Field(names)
    so3 = algebra_by_name("so(3)")
    vector = representation_by_name(so3, "vector")
    vehicle = lie_poisson(algebra_by_name("se(3)"), field, names)
    top = lie_poisson(semidirect_product(so3, [("Gamma", vector.dual())]), field, names)
    assert vehicle.tensor == top.tensor
    right = lie_poisson(semidirect_product(so3, [("Gamma", vector)]), field, names, sign=1)
    assert vehicle.tensor != right.tensor


def test_7_2_extended_vehicle_with_noncoincident_centres():
    """On nine dimensions P.P, P.Gamma and Gamma.Gamma are all Casimirs; P.Pi is none."""
    so3 = algebra_by_name("so(3)")
    vector = representation_by_name(so3, "vector")
    names = triples("Pi", "P", "Gamma")
    field = Field([*names, "mg", *triples("chi"), *triples("Omega"), *triples("v")])
    algebra = semidirect_product(so3, [("P", vector), ("Gamma", vector)])
    structure = lie_poisson(algebra, field, names)
    Pi, P, Gamma, chi, Omega, v = symbols(field, "Pi", "P", "Gamma", "chi", "Omega", "v")
    found = casimirs(structure, 2)
    assert set(found.generators) == {dot(P, P), dot(P, Gamma), dot(Gamma, Gamma)}
    assert (found.expected, found.missing) == (3, "")
    assert not structure.is_casimir(dot(P, Pi))
    assert not structure.is_casimir(dot(Pi, Gamma))
    # a Hamiltonian with dh/dPi = Omega, dh/dP = v and dh/dGamma = mg chi
    h = dot(Pi, Omega) + dot(P, v) + field["mg"] * dot(chi, Gamma)
    torque = [field["mg"] * t for t in cross(Gamma, chi)]
    book = plus(plus(cross(Pi, Omega), cross(P, v)), torque) + cross(P, Omega) + cross(Gamma, Omega)
    assert list(structure.hamiltonian_vector_field(h)) == book
    assert book != plus(plus(cross(Pi, Omega), cross(P, v)), cross(chi, Gamma)) + book[3:]


def test_8_3_2_bracket_of_the_heavy_top():
    """{Pi_i, Pi_j} = -eps Pi_k, {Pi_i, Gamma_j} = -eps Gamma_k, {Gamma, Gamma} = 0; Casimirs."""
    field, structure = structure_of("se(3)", triples("Pi", "Gamma"))
    Pi, Gamma = symbols(field, "Pi", "Gamma")
    for i, j, k in CYCLIC:
        assert structure.bracket(Pi[i], Pi[j]) == -Pi[k] != Pi[k]
        assert structure.bracket(Pi[i], Gamma[j]) == -Gamma[k] == structure.bracket(Gamma[i], Pi[j])
        assert structure.bracket(Pi[j], Gamma[i]) == Gamma[k]
        assert structure.bracket(Gamma[i], Gamma[j]) == 0
        assert structure.bracket(Pi[i], Gamma[i]) == 0
    assert structure.is_casimir(dot(Gamma, Gamma))
    assert structure.is_casimir(dot(Pi, Gamma))
    assert not structure.is_casimir(dot(Pi, Gamma) - 2 * Pi[0] * Gamma[0])


def so4():
    """so(4) by [J, J] = eps J, [J, K] = eps K, [K, K] = eps J."""
    brackets = {}
    for i, j, k in CYCLIC:
        brackets |= {(i, j): {k: 1}, (3 + i, 3 + j): {k: 1}}
        brackets |= {(i, 3 + j): {3 + k: 1}, (j, 3 + i): {3 + k: -1}}
    return from_brackets("so(4)", triples("J", "K"), brackets)


def test_c_1_3_motion_on_so4():
    """M' = M x Omega + N x Lambda, N' = N x Omega + M x Lambda; Casimirs M.M + N.N and M.N."""
    names = triples("M", "N")
    field = Field([*names, *triples("Omega"), *triples("Lambda")])
    structure = lie_poisson(so4(), field, names)
    M, N, Omega, Lambda = symbols(field, "M", "N", "Omega", "Lambda")
    motion = list(structure.hamiltonian_vector_field(dot(M, Omega) + dot(N, Lambda)))
    assert motion == plus(cross(M, Omega), cross(N, Lambda)) + plus(
        cross(N, Omega), cross(M, Lambda)
    )
    assert motion[:3] != plus(cross(M, Omega), cross(Lambda, N))
    assert set(casimirs(structure).generators) == {dot(M, M) + dot(N, N), dot(M, N)}
    assert not structure.is_casimir(dot(M, M) - dot(N, N))


def test_c_4_momentum_bracket_of_sp2():
    """X = (q.q, p.p, q.p) on R^6: {X1,X2} = 4 X3, {X2,X3} = -2 X2, {X3,X1} = -2 X1."""
    pairs = [(f"q{n}", f"p{n}") for n in (1, 2, 3)]
    field = Field([*triples("q"), *triples("p"), *triples("X")])
    plane = canonical(field, pairs)
    q, p, X = symbols(field, "q", "p", "X")
    named = [dot(q, q), dot(p, p), dot(q, p)]
    assert plane.bracket(named[0], named[1]) == 4 * named[2]
    assert plane.bracket(named[1], named[2]) == -2 * named[1]
    assert plane.bracket(named[2], named[0]) == -2 * named[0]
    reduced = {(0, 1): 4 * X[2], (1, 2): -2 * X[1], (2, 0): -2 * X[0]}
    structure = declare_bracket(field, triples("X"), reduced)
    (found,) = casimirs(structure).generators
    assert found == X[0] * X[1] - X[2] ** 2
    assert not structure.is_casimir(X[0] * X[1] + X[2] ** 2)
    values = dict(zip(triples("X"), named, strict=True))
    assert field.substitute(found, values) == dot(cross(q, p), cross(q, p))
    # the declared bracket is that of the momentum map, by the chain rule
    for (i, j), value in reduced.items():
        assert plane.bracket(named[i], named[j]) == field.substitute(value, values)


def test_c_4_a_momentum_bracket_with_another_sign_has_another_casimir():
    """{X1, X2} = -4 X3 is a Lie-Poisson bracket too, but not of (q.q, p.p, q.p)."""
    field = Field(triples("X"))
    X = symbols(field, "X")[0]
    brackets = {(0, 1): -4 * X[2], (1, 2): -2 * X[1], (2, 0): -2 * X[0]}
    assert not declare_bracket(field, field.names, brackets).is_casimir(X[0] * X[1] - X[2] ** 2)


def test_3_1_39_monopole():
    """P = L - lam r/|r|, A = v x P - mu r/|r| and E are conserved by the magnetic bracket."""
    field = Field([*triples("r"), *triples("v"), "lam", "mu"], slots=1)
    r, v = symbols(field, "r", "v")
    lam, mu = field["lam"], field["mu"]
    size = field.call("sqrt", dot(r, r))
    two_form = {(f"v{i + 1}", f"v{j + 1}"): lam * r[k] / size**3 for i, j, k in CYCLIC}
    pairs = [(f"r{n}", f"v{n}") for n in (1, 2, 3)]
    structure = magnetic(field, pairs, two_form)
    H = dot(v, v) / 2 - mu / size + lam**2 / (2 * size**2)
    L, unit = cross(r, v), [x / size for x in r]

    def conserved(vector):
        return all(field.is_zero(structure.bracket(x, H)) for x in vector)

    P = [a - lam * b for a, b in zip(L, unit, strict=True)]
    A = [a - mu * b for a, b in zip(cross(v, P), unit, strict=True)]
    assert conserved(P)
    assert conserved(A)
    assert conserved([dot(L, L)])
    assert not conserved(L)
    assert not conserved([a + lam * b for a, b in zip(L, unit, strict=True)])
    assert not conserved([a + mu * b for a, b in zip(cross(v, P), unit, strict=True)])
    motion = structure.hamiltonian_vector_field(H)
    assert list(motion[:3]) == v
    for rate, turn, x in zip(motion[3:], L, r, strict=True):
        book = -lam / size**3 * turn - (mu / size**3 - lam**2 / size**4) * x
        assert field.is_zero(rate - book)
        assert not field.is_zero(rate - book - 2 * lam / size**3 * turn)


def test_3_2_6_hopf_bracket():
    """With {a, a*} = -2i, that is {q, p} = 1: {n_i, n_j} = 4 eps_ijk n_k and {n_0, n} = 0."""
    field = Field(["q1", "q2", "p1", "p2"])
    structure = canonical(field, [("q1", "p1"), ("q2", "p2")])
    q1, q2, p1, p2 = (field[name] for name in field.names)
    # n1 + i n2 = 2 a1* a2 with a = q + i p
    n = [
        2 * (q1 * q2 + p1 * p2),
        2 * (q1 * p2 - p1 * q2),
        q1**2 + p1**2 - q2**2 - p2**2,
    ]
    n0 = q1**2 + p1**2 + q2**2 + p2**2
    assert dot(n, n) == n0**2
    for i, j, k in CYCLIC:
        assert structure.bracket(n[i], n[j]) == 4 * n[k] != -4 * n[k]
        assert structure.bracket(n0, n[k]) == 0
    assert structure.bracket(n0, q1) != 0
