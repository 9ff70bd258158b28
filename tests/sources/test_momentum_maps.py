"""Momentum maps and Noether's theorem: Holm (2011), 2.3, 9.4.1, 11.1 to 11.3, C.2 to C.4, by hand.

The engine's maps come from specs; the formulas are the book's, and brackets are canonical
derivatives taken by SymPy. Each law stands beside a spoiled twin.
"""

from itertools import combinations, product

import pytest
import sympy

from coadjoint.derive import derive
from tests.specs import prove_claims, shipped, spec

#: One particle with a momentum map and a potential to be filled in; dimensions of q and p by shape.
PARTICLE = """
title = "particle"
routes = ["poisson"]
[poisson]
canonical = [["q", "p"]]
[variables]
q = { role = "coordinate", shape = [3] }
p = { role = "coordinate", shape = [3] }
[parameters]
m = { positive = true, default = 2 }
k = { default = 3 }
[hamiltonian]
h = "dot(p, p)/(2*m) + k*dot(q, q)^2"
[symmetries.J]
algebra    = "so(3)"
vector     = "xi"
generators = { q = "cross(xi, q)" }
[claims]
conserved = ["energy", "J"]
brackets  = { "{J, J}" = "-hat(J)", "{J, q}" = "-hat(q)" }
"""
ROTATIONS = PARTICLE[PARTICLE.index("[symmetries.J]") : PARTICLE.index("[claims]")]
CLAIMS = PARTICLE[PARTICLE.index("[claims]") :]


def acting(symmetry, claims="", **changes):
    """The particle with another action, and claims that go with it."""
    text = PARTICLE.replace(ROTATIONS, symmetry).replace(CLAIMS, f"[claims]\n{claims}\n")
    return spec(text, *changes.values())


def symbols(name, count=3):
    """``name1, name2, ...`` as a column."""
    return sympy.Matrix(sympy.symbols(f"{name}1:{count + 1}"))


def square(name, size):
    """``name11, name12, ...`` as a matrix."""
    return sympy.Matrix(size, size, lambda i, j: sympy.Symbol(f"{name}{i + 1}{j + 1}"))


def emitted(declared, *names):
    """Emitted observables by name."""
    found = derive(declared).observables
    return [found[name] for name in names]


def equal(found, expected):
    """Whether polynomials are equal, one by one, and there are any."""
    assert len(found) == len(expected) > 0
    return all(sympy.expand(a - b) == 0 for a, b in zip(found, expected, strict=True))


def canonical(f, g, q, p):
    """``{F, G} = F_q . G_p - F_p . G_q``."""
    return sympy.expand(
        sum(f.diff(x) * g.diff(y) - f.diff(y) * g.diff(x) for x, y in zip(q, p, strict=True))
    )


def stated(declared):
    """The statements of a certificate that holds."""
    return [claim.statement for claim in prove_claims(declared).require().claims]


def refuted(declared):
    """The statements that are refuted."""
    return [claim.statement for claim in prove_claims(declared).refuted]


def any_of(statements, piece):
    """Whether a statement has a piece."""
    return any(piece in statement for statement in statements)


# -- 2.3: Noether's theorem ------------------------------------------------------------------------


def test_2_3_noether():
    """J = L_v . xi_Q = q x p is conserved where h is invariant."""
    q, p = symbols("q"), symbols("p")
    assert equal(emitted(spec(PARTICLE), "J1", "J2", "J3"), q.cross(p))
    assert "J is conserved by Noether's theorem, since its flow keeps h" in stated(spec(PARTICLE))


def test_2_3_noether_speaks_of_invariant_directions_alone():
    """With gravity along the third axis only J3 is conserved; a claim of all of J is refuted."""
    gravity = ("k*dot(q, q)^2", "k*q3")
    axial = stated(spec(PARTICLE, gravity, ('"J"]', '"J3"]')))
    assert "J3 is conserved by Noether's theorem, since its flow keeps h" in axial
    assert not any_of(axial, "J1")
    assert refuted(spec(PARTICLE, gravity)) == [
        "J is conserved",
        "the flow of J takes motions to motions, a transformation of positions",
    ]


TIME = """
[symmetries.F]
algebra    = "R^2"
vector     = "c"
generators = { q = "c[1]*u" }
time       = "c[2]"
"""
ALONG = ("[hamiltonian]", "u = { shape = [3], default = [1, 2, 3] }\n[hamiltonian]")
SHEET = ("k*dot(q, q)^2", "k*dot(cross(u, q), cross(u, q))")


def test_2_3_1_noether_with_moving_time():
    """J = p . xi_Q - E tau: the shift along u gives p . u, that of time -E, both conserved."""
    declared = acting(TIME, 'conserved = ["F"]', u=ALONG, h=SHEET)
    energy = derive(declared).energy
    p, u = symbols("p"), symbols("u")
    assert equal(emitted(declared, "F1", "F2"), [p.dot(u), -energy])
    assert "F is conserved by Noether's theorem, since its flow keeps h" in stated(declared)


def test_2_3_1_a_shift_that_h_feels_is_no_symmetry():
    """In a potential k (q . u)^2 the energy alone is conserved, and the shifts do not commute."""
    felt = acting(TIME, 'conserved = ["F"]', u=ALONG, h=("k*dot(q, q)^2", "k*dot(u, q)^2"))
    found = refuted(felt)
    assert "F is conserved" in found
    assert "the generators of F act as R^2 from the left" in found
    statements = [claim.statement for claim in prove_claims(felt).claims]
    assert "F2 is conserved by Noether's theorem, since its flow keeps h" in statements


# -- 9.4.1, 11.1, 11.2: what a momentum map is -----------------------------------------------------


def test_9_4_1_and_11_2_the_cotangent_lift_is_a_poisson_map():
    """{J_i, J_j} = +epsilon_ijk J_k and {f, J^xi} = xi_P f, by derivatives taken here."""
    q, p = symbols("q"), symbols("p")
    J = emitted(spec(PARTICLE), "J1", "J2", "J3")
    for i, j in product(range(3), repeat=2):
        plus = sum(sympy.LeviCivita(i, j, k) * J[k] for k in range(3))
        assert canonical(J[i], J[j], q, p) == sympy.expand(plus)
        axis = sympy.eye(3)[:, i]
        assert canonical(q[j], J[i], q, p) == sympy.expand(axis.cross(q)[j])  # 11.1
        assert canonical(p[j], J[i], q, p) == sympy.expand(axis.cross(p)[j])
    assert "{J_xi, J_eta} = J_[xi, eta]: J is a Poisson map" in stated(spec(PARTICLE))


@pytest.mark.parametrize(
    ("change", "culprit"),
    [
        (('"-hat(J)"', '"hat(J)"'), "{J, J} = hat(J)"),
        (('"cross(xi, q)"', '"cross(q, xi)"'), "generators of J act as so(3) from the left"),
        (("generators =", 'side = "right"\ngenerators ='), "act as so(3) from the right"),
        (("generators =", 'map = "2*dot(cross(q, p), xi)"\ngenerators ='), "their momentum map"),
        (('{ q = "cross(xi, q)" }', '{ q = "cross(xi, q)", p = "2*cross(xi, p)" }'), "J"),
    ],
)
def test_11_1_and_11_2_spoiled(change, culprit):
    """The signs of bracket, generators and side, and the size of a declared map, are seen."""
    if culprit == "J":
        with pytest.raises(Exception, match="does not preserve the bracket"):
            prove_claims(spec(PARTICLE, change))
        return
    assert any_of(refuted(spec(PARTICLE, change)), culprit)


# -- 11.3: examples --------------------------------------------------------------------------------


PAIR = (
    ('canonical = [["q", "p"]]', 'canonical = [["q", "p"], ["x", "y"]]'),
    (
        "[parameters]",
        'x = { role = "coordinate", shape = [3] }\ny = { role = "coordinate", shape = [3] }\n'
        "[parameters]",
    ),
    ("dot(p, p)/(2*m) + k*dot(q, q)^2", "dot(p, p)/(2*m) + dot(y, y) + k*dot(q - x, q - x)^2"),
)
SHIFTS = '[symmetries.T]\nalgebra = "R^3"\nvector = "xi"\ngenerators = { q = "xi", x = "xi" }\n'


def test_11_3_translations():
    """Translations of two particles have the sum of their momenta; one force law breaks it."""
    declared = acting(SHIFTS, 'conserved = ["T"]', a=PAIR[0], b=PAIR[1], c=PAIR[2])
    assert equal(emitted(declared, "T1", "T2", "T3"), symbols("p") + symbols("y"))
    assert "{T_xi, T_eta} = T_[xi, eta]: T is a Poisson map" in stated(declared)
    absolute = (PAIR[2][0], PAIR[2][1].replace("q - x, q - x", "q + x, q - x"))
    broken = acting(SHIFTS, 'conserved = ["T"]', a=PAIR[0], b=PAIR[1], c=absolute)
    assert "T is conserved" in refuted(broken)


GALILEI = """
[symmetries.G]
vector     = "xi"
generators = { q = "cross(xi_rotation, q) + xi_P", p = "cross(xi_rotation, p) + m*xi_K" }
[symmetries.G.algebra]
semidirect = { algebra = "so(3)", representations = { K = "vector", P = "vector" } }
"""


def test_11_3_boosts_break_equivariance_by_a_cocycle():
    """{K_i, P_j} = -m delta_ij for K = -m q: a constant 2-cocycle, 0 elsewhere."""
    declared = acting(GALILEI)
    names = [f"G{n}" for n in range(1, 10)]
    q, p, m = symbols("q"), symbols("p"), sympy.Symbol("m")
    G = emitted(declared, *names)
    assert equal(G, [*q.cross(p), *(-m * q), *p])
    for i, j in product(range(3), repeat=2):
        assert canonical(G[3 + i], G[6 + j], q, p) == -m * int(i == j)
    (law,) = [text for text in stated(declared) if "cocycle" in text]
    assert law.endswith("Sigma(K1, P1) = -m, Sigma(K2, P2) = -m, Sigma(K3, P3) = -m")


def test_11_3_what_is_no_cocycle_is_refuted():
    """A declared map with a wrong term leaves a defect that is not constant."""
    wrong = GALILEI.replace(
        'vector     = "xi"',
        'vector = "xi"\nmap = "dot(cross(q, p), xi_rotation) + dot(p, xi_P) - 2*q1*dot(q, xi_K)"',
    )
    found = refuted(acting(wrong))
    assert any_of(found, "with the constant 2-cocycle")
    assert any_of(found, "G is their momentum map")


LINEAR = '[symmetries.J]\nalgebra = "gl(3,R)"\nmatrix = "A"\nform = "matrix"\n'


def test_11_3_general_linear_maps():
    """GL(n) on R^n has J = p q^T, paired by tr(J^T A)."""
    q, p = symbols("q"), symbols("p")
    declared = acting(LINEAR + 'generators = { q = "A*q" }\n')
    assert equal(emitted(declared, *map(str, square("J", 3))), p * q.T)
    prove_claims(declared).require()
    assert any_of(refuted(acting(LINEAR + 'generators = { q = "transpose(A)*q" }\n')), "act as")


SP2 = """
[symmetries.J]
algebra    = "sp(2)"
matrix     = "A"
generators = { q = "A[1, 1]*q + A[1, 2]*p", p = "A[2, 1]*q + A[2, 2]*p" }
"""


def test_11_3_and_C_4_symplectic_maps():
    """Sp(2,R) on T*R^n has (q.p, p.p/2, -q.q/2); X = (q.q, p.p, q.p) has the brackets of C.4."""
    q, p = symbols("q"), symbols("p")
    declared = acting(SP2)
    J = emitted(declared, "J1", "J2", "J3")
    assert equal(J, [q.dot(p), p.dot(p) / 2, -q.dot(q) / 2])
    assert "{J_xi, J_eta} = J_[xi, eta]: J is a Poisson map" in stated(declared)
    x1, x2, x3 = -2 * J[2], 2 * J[1], J[0]
    brackets = [canonical(a, b, q, p) for a, b in ((x1, x2), (x2, x3), (x3, x1))]
    assert equal(brackets, [4 * x3, -2 * x2, -2 * x1])
    assert equal([x1 * x2 - x3**2], [q.cross(p).dot(q.cross(p))])  # the Casimir
    with pytest.raises(Exception, match="does not preserve the bracket"):
        derive(acting(SP2.replace("A[2, 2]*p", "2*A[2, 2]*p")))


PLANE = (("shape = [3]", "shape = [2]"), ("k*dot(q, q)^2", "k*q1"))
SU2 = '[symmetries.J]\nalgebra = "su(2)"\nlinear = ["q", "p"]\n'


def test_11_3_hopf_map():
    """J = n/4 with n1 + i n2 = 2 a1^* a2, n3 = |a1|^2 - |a2|^2: {n_i, n_j} = 4 epsilon n_k."""
    declared = acting(SU2, a=PLANE[0], b=PLANE[1])
    q, p = symbols("q", 2), symbols("p", 2)
    a1, a2 = (
        sympy.Symbol(f"q{n}", real=True) + sympy.I * sympy.Symbol(f"p{n}", real=True)
        for n in (1, 2)
    )
    plain = {sympy.Symbol(str(x), real=True): x for x in (*q, *p)}
    n12 = sympy.expand(2 * sympy.conjugate(a1) * a2)
    n = [sympy.re(n12), sympy.im(n12), sympy.expand(a1 * a1.conjugate() - a2 * a2.conjugate())]
    n = [sympy.expand(x.subs(plain)) for x in n]
    J = emitted(declared, "J1", "J2", "J3")
    assert equal([4 * x for x in J], n)
    for i, j in combinations(range(3), 2):
        expected = 4 * sum(sympy.LeviCivita(i, j, k) * n[k] for k in range(3))
        assert canonical(n[i], n[j], q, p) == sympy.expand(expected)
    assert "{J_xi, J_eta} = J_[xi, eta]: J is a Poisson map" in stated(declared)
    exchanged = SU2.replace('["q", "p"]', '["p", "q"]')  # the conjugate representation
    assert (
        equal([-4 * J[1]], [4 * emitted(acting(exchanged, a=PLANE[0], b=PLANE[1]), "J2")[0]])
        is False
    )


MATRIX = (
    (
        'q = { role = "coordinate", shape = [3] }',
        'q = { role = "coordinate", shape = [4], form = "matrix" }',
    ),
    (
        'p = { role = "coordinate", shape = [3] }',
        'p = { role = "coordinate", shape = [4], form = "matrix" }',
    ),
    ("dot(p, p)/(2*m) + k*dot(q, q)^2", "trace(p*p)/(2*m) + k*det(q)"),
)
CONJUGATION = '[symmetries.J]\nalgebra = "gl(2,R)"\nmatrix = "A"\nform = "matrix"\n'


def test_11_3_conjugation():
    """GL(n) acting by A q - q A has J = p q^T - q^T p, conserved where h is built of traces."""
    moves = 'generators = { q = "A*q - q*A" }\n'
    declared = acting(
        CONJUGATION + moves,
        'conserved = ["J"]',
        a=MATRIX[0],
        b=MATRIX[1],
        c=(MATRIX[2][0], "trace(p*transpose(p))*0 + trace(q*transpose(p))/m + k*det(q)"),
    )
    q, p = square("q", 2), square("p", 2)
    assert equal(emitted(declared, *map(str, square("J", 2))), p * q.T - q.T * p)
    assert "J is conserved by Noether's theorem, since its flow keeps h" in stated(declared)
    wrong = acting(
        CONJUGATION + moves.replace("- q*A", "+ q*A"), a=MATRIX[0], b=MATRIX[1], c=MATRIX[2]
    )
    assert any_of(refuted(wrong), "act as gl(2) from the left")


# -- C.2: oscillators on C^3 -----------------------------------------------------------------------


def hermitian():
    """Q = R + i N as emitted."""
    found = emitted(shipped("c3_oscillators"), *map(str, square("R", 3)), *map(str, square("N", 3)))
    R, N = sympy.Matrix(3, 3, found[:9]), sympy.Matrix(3, 3, found[9:])
    return R + sympy.I * N


def check_bracket_of_Q(Q, factor=2):
    """{Q_ij, Q_kl} = 2i (delta_kj Q_il - delta_il Q_kj)."""
    q, p = symbols("q"), symbols("p")
    assert any(x != 0 for x in Q)
    for i, j, k, l in product(range(3), repeat=4):  # noqa: E741 (the book's index)
        expected = factor * sympy.I * (int(k == j) * Q[i, l] - int(i == l) * Q[k, j])
        assert sympy.expand(canonical(Q[i, j], Q[k, l], q, p) - expected) == 0, (i, j, k, l)


def test_C_2_the_momentum_map_of_U3():
    """Q = a a^* has the bracket of u(3); Q^2 = (tr Q) Q; Im Q_jk = -epsilon_jkl L_l."""
    Q = hermitian()
    a = symbols("q") + sympy.I * symbols("p")
    star = symbols("q") - sympy.I * symbols("p")
    assert equal(list(Q), list(a * star.T))
    check_bracket_of_Q(Q)
    assert (Q * Q - Q.trace() * Q).expand() == sympy.zeros(3)
    L = emitted(shipped("c3_oscillators"), "L1", "L2", "L3")
    for j, k in product(range(3), repeat=2):
        expected = -sum(sympy.LeviCivita(j, k, n) * L[n] for n in range(3))
        assert sympy.expand((Q[j, k] - Q[k, j]) / (2 * sympy.I) - expected) == 0
    assert any_of(stated(shipped("c3_oscillators")), "J is a Poisson map")


def test_C_2_spoiled():
    """The transpose of Q has the opposite bracket, -i in the place of -2i half of it."""
    with pytest.raises(AssertionError):
        check_bracket_of_Q(hermitian().T)
    with pytest.raises(AssertionError):
        check_bracket_of_Q(hermitian(), factor=1)


def changed(name, *changes):
    """A shipped spec with pieces replaced."""
    return spec(shipped(name).path.read_text(encoding="utf-8"), *changes)


def test_C_2_resonance():
    """In 1:1:1 resonance, h = tr Q/2, all of Q is conserved; not so with other frequencies."""
    resonant = ("[1, 2, 3]", "[1, 1, 1]")
    conserved = ('conserved = ["energy", "n0"]', 'conserved = ["energy", "n0", "R", "N", "J"]')
    plain = ('"dot(w, diag(Qr))/2 + c*Qr[1, 2] - k*trace(Qi*Qi)/4"', '"trace(Qr)/2"')
    assert "J is conserved by Noether's theorem, since its flow keeps h" in stated(
        changed("c3_oscillators", resonant, conserved, plain)
    )
    assert {"R is conserved", "N is conserved", "J is conserved"} <= set(
        refuted(changed("c3_oscillators", conserved))
    )


# -- C.3.1: positive symmetric matrices ------------------------------------------------------------


@pytest.mark.parametrize(("name", "size"), [("spd_motion", 2), ("spd_motion_3", 3)])
def test_C_3_1_legendre_and_momentum_map(name, size):
    """H = <P, dS/dt> + p . dq/dt - L at P = S^-1 dS/dt S^-1, p = S^-1 dq/dt; J = 2 P S + p q^T."""
    equations = derive(shipped(name))
    S, P = (
        sympy.Matrix(
            size, size, lambda i, j, x=x: sympy.Symbol(f"{x}{min(i, j) + 1}{max(i, j) + 1}")
        )
        for x in "SP"
    )
    q, p = symbols("q", size), symbols("p", size)
    rates = dict(zip(map(str, equations.state), equations.rates, strict=True))
    S_dot = S.applyfunc(lambda x: rates[str(x)])
    q_dot = q.applyfunc(lambda x: rates[str(x)])
    assert (S_dot - S * P * S).expand() == sympy.zeros(size)
    assert (q_dot - S * p).expand() == sympy.zeros(size, 1)
    # with dS/dt = S P S the Lagrangian tr(S^-1 dS/dt S^-1 dS/dt)/2 + dq/dt . S^-1 dq/dt / 2 is
    lagrangian = (P * S * P * S).trace() / 2 + (p.T * S * p)[0] / 2
    legendre = (P * S_dot).trace() + p.dot(q_dot) - lagrangian
    assert sympy.expand(equations.energy - legendre) == 0
    J = [equations.observables[str(x)] for x in square("J", size)]
    assert equal(J, list(2 * P * S + p * q.T))
    assert "J is conserved by Noether's theorem, since its flow keeps h" in stated(shipped(name))


def test_C_3_1_spoiled():
    """Without the factor 1/2 of the pairing, or with one factor S missing, J is not conserved."""
    assert "J is conserved" in refuted(
        changed("spd_motion", ("trace(P*S*P*S)/2", "trace(P*S*P)/2"))
    )
    assert any_of(
        refuted(changed("spd_motion", ('"{S12, P12}" = "1/2"', '"{S12, P12}" = "1"'))), "{S12, P12}"
    )


def test_C_3_1_symmetric_gradients_are_not_doubled():
    """Pairs of single entries, with {S12, P12} = 1, make another motion: S12 moves doubly."""
    # as three pairs of scalars the off-diagonal entries of P are twice those of the pairing
    text = shipped("spd_motion").path.read_text(encoding="utf-8")
    plain = text.replace(
        '[["S", "P"], ["q", "p"]]',
        '[["S11", "P11"], ["S12", "P12"], ["S22", "P22"], ["q", "p"]]',
    )
    halves, wholes = derive(shipped("spd_motion")), derive(spec(plain, ('"J", ', "")))
    assert halves.rates[0] == wholes.rates[0]
    assert sympy.expand(2 * halves.rates[1] - wholes.rates[1]) == 0 != halves.rates[1]


# -- C.3.2: ellipsoids -----------------------------------------------------------------------------


def test_C_3_2_two_momentum_maps():
    """J^A = tr(P^T A Q) and tr(P^T Q A): {J_L, J_L} = +, {J_R, J_R} = -, {J_L, J_R} = 0."""
    Q, P = square("Q", 3), square("P", 3)
    found = [
        emitted(shipped("ellipsoidal_motion"), *(f"{J}{n}" for n in (1, 2, 3)))
        for J in ("J_L", "J_R")
    ]
    hats = [sympy.Matrix(3, 3, lambda i, j, k=k: -sympy.LeviCivita(i, j, k)) for k in range(3)]
    left, right = found
    assert equal(left, [(P.T * A * Q).trace() for A in hats])
    assert equal(right, [(P.T * Q * A).trace() for A in hats])
    for i, j in product(range(3), repeat=2):
        for J, sign in ((left, 1), (right, -1)):
            expected = sign * sum(sympy.LeviCivita(i, j, k) * J[k] for k in range(3))
            assert canonical(J[i], J[j], list(Q), list(P)) == sympy.expand(expected)
        assert canonical(left[i], right[j], list(Q), list(P)) == 0


def test_C_3_2_flow():
    """dQ/dt = P, dP/dt = -(2 V_1 Q + V_2 det(Q) Q^-T), and Dedekind's transposition keeps it."""
    equations = derive(shipped("ellipsoidal_motion"))
    Q, (k, b) = square("Q", 3), sympy.symbols("k b")
    s, d = sympy.symbols("s d")
    V = k * s / 2 + b / d
    at = {s: (Q.T * Q).trace(), d: Q.det()}
    force = -(2 * V.diff(s).subs(at) * Q + V.diff(d).subs(at) * Q.cofactor_matrix())
    rates = list(equations.rates)
    assert rates[:9] == list(square("P", 3))
    point = {x: sympy.Rational(3 * n % 7 + 1, n + 2) for n, x in enumerate((*Q, k, b))}
    expected = list(force.subs(point))
    assert [rate.subs(point) for rate in rates[9:]] == expected
    assert any(expected)
    statements = stated(shipped("ellipsoidal_motion"))
    assert "Dedekind takes the motion to itself" in statements
    assert "Dedekind takes J_L to -J_R" in statements


@pytest.mark.parametrize(
    ("change", "culprit"),
    [
        (('exchanges = { J_L = "-J_R"', 'exchanges = { J_L = "J_R"'), "Dedekind takes J_L to J_R"),
        (('P = "transpose(P)"', 'P = "P"'), "Dedekind takes the motion to itself"),
        (("reverses_time = true", "reverses_time = false"), "reversal takes the motion to itself"),
        (('side       = "right"', 'side       = "left"'), "J_R act as so(3) from the left"),
        (('"{J_L, J_R}" = "0*hat(J_L)"', '"{J_L, J_R}" = "hat(J_L)"'), "{J_L, J_R} = hat(J_L)"),
        (("V(trace(transpose(Q)*Q), det(Q))", "V(trace(Q*Q), det(Q))"), "J_L is conserved"),
    ],
)
def test_C_3_2_spoiled(change, culprit):
    """Each sign, side and claim of the spec is seen; a potential of tr Q^2 is not invariant."""
    assert any_of(refuted(changed("ellipsoidal_motion", change)), culprit)
