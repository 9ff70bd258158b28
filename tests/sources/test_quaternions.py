"""Quaternions, chapters 3 and 4.1 to 4.2.1: what the package computes is what the book states.

The right sides are typed from Holm (2011), Geometric Mechanics II; beside each stands a spoiled
variant that the same comparison must refuse.
"""

import math
from itertools import product

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from coadjoint.exact import Field
from coadjoint.exact.dense import (
    add,
    apply,
    combine,
    commutator,
    cross,
    dot,
    hat,
    identity,
    scale,
    subtract,
    transpose,
)
from coadjoint.exact.dense import product as matmul
from coadjoint.groups.complex_numbers import Complex, I, adjoint
from coadjoint.groups.quaternions import Quaternion, euler_rodrigues
from coadjoint.groups.vector_fields import VectorField
from coadjoint.theory.central_forces import (
    alignment,
    alignment_defect,
    hamilton_vector,
    kepler_energy,
    kepler_force,
    laplace_runge_lenz,
    magnetic_vector_field,
    monopole_energy,
    monopole_force,
    monopole_laplace_runge_lenz,
    poincare_vector,
    point_motion,
)
from coadjoint.theory.charts import north_point
from coadjoint.theory.coquaternions import Coquaternion, pauli
from coadjoint.theory.hopf import (
    amplitudes,
    canonical_bracket,
    coherence_matrix,
    from_sphere,
    hopf_map,
    reduced_motion,
)
from coadjoint.theory.maps import PAULI, dual_tilde, pairing_so3, pairing_su2, su2, tilde, untilde
from coadjoint.theory.rotations import (
    AD,
    Ad_star,
    ad,
    ad_star,
    body_angular_velocity,
    cayley_klein,
    parallel_and_perpendicular,
    quaternion_rate,
    unit_quaternion,
)
from coadjoint.theory.vector_fields import curl, hamiltonian_vector_field

NAMES = [f"{letter}{n}" for letter in "qruv" for n in range(4)]


@pytest.fixture
def field():
    """Symbols q0..q3, r0..r3, u0..u3, v0..v3 and place for two functions."""
    return Field([*NAMES, "a", "b", "theta"], slots=2)


def symbols(field, letter, kind=Quaternion):
    """A generic quaternion."""
    return kind(*(field[f"{letter}{n}"] for n in range(4)))


def vector(field, letter):
    """A generic three-vector."""
    return tuple(field[f"{letter}{n}"] for n in (1, 2, 3))


def unit_vector(field):
    """A generic unit vector, rational in a and b."""
    return north_point(Complex(field["a"], field["b"]))


def determinant(m):
    """Of a 2 x 2 matrix."""
    return m[0][0] * m[1][1] - m[0][1] * m[1][0]


def scaled_matrix(factor, m):
    """``factor * m``."""
    return tuple(scale(factor, row) for row in m)


def epsilon(i, j, k):
    """The sign of a permutation of 0, 1, 2, or 0."""
    return (i - j) * (j - k) * (k - i) // 2


def all_zero(field, values):
    """Whether all of some elements are zero; there must be some."""
    values = tuple(values)
    assert values
    return all(field.is_zero(field.zero + value) for value in values)


# -- 3.1 ------------------------------------------------------------------------------------------


def test_3_1_the_product_of_quaternions(field):
    """[q0, q][r0, r] = [q0 r0 - q.r, q0 r + r0 q + q x r]; the other order of q x r is refused."""
    q, r = symbols(field, "q"), symbols(field, "r")
    straight = add(scale(q.w, r.vector), scale(r.w, q.vector))
    found = q * r
    assert found.w == q.w * r.w - dot(q.vector, r.vector)
    assert found.vector == add(straight, cross(q.vector, r.vector))
    assert found.vector != add(straight, cross(r.vector, q.vector))


def test_3_1_the_table_of_quaternions():
    """J_a^2 = J1 J2 J3 = -1, J_a = -i sigma_a, and the 4 x 4 table; J1 J3 J2 is +1."""
    one, *J = Quaternion.units()
    assert J[0] * J[1] * J[2] == -one
    assert J[0] * J[2] * J[1] == one
    for a, sigma in zip(J, PAULI, strict=True):
        assert a * a == -one
        assert pauli(a) == scaled_matrix(-I, sigma)
    for a, b in product(range(3), repeat=2):
        expected = [epsilon(a, b, c) for c in range(3)]
        assert (J[a] * J[b]).components == (-int(a == b), *expected)


def test_3_1_1_pauli_isomorphism(field):
    """q0 sigma_0 - i q.sigma preserves products; with + i it would reverse them."""
    for a, b in product(range(3), repeat=2):
        expected = scaled_matrix(int(a == b), identity(2))
        for c in range(3):
            expected = add(expected, scale(epsilon(a, b, c) * I, PAULI[c]))
        assert matmul(PAULI[a], PAULI[b]) == expected
    q, r = symbols(field, "q"), symbols(field, "r")
    by_hand = scaled_matrix(q.w, identity(2))
    for component, sigma in zip(q.vector, PAULI, strict=True):
        by_hand = add(by_hand, scale(-I * component, sigma))
    assert pauli(q) == by_hand
    assert pauli(q * r) == matmul(pauli(q), pauli(r))
    mirrored = [pauli(x.conjugate) for x in (q, r, q * r)]
    assert mirrored[2] != matmul(mirrored[0], mirrored[1])


def test_3_1_2_conjugate_norm_and_inverse(field):
    """``q q*`` = q.q, (q r)* = r* q*, |q r|^2 = |q|^2 |r|^2, q^-1 = q*/|q|^2, not (qr)* = q* r*."""
    q, r = symbols(field, "q"), symbols(field, "r")
    squares = dot(q.components, q.components)
    assert (q * q.conjugate).components == (squares, 0, 0, 0)
    assert (q * r).conjugate == r.conjugate * q.conjugate
    assert (q * r).conjugate != q.conjugate * r.conjugate
    assert (q * r).norm == q.norm * r.norm
    assert q.inverse() == q.conjugate.scale(1 / squares)
    assert q * q.inverse() == Quaternion(1, 0, 0, 0)


def test_3_1_3_decomposition_of_three_vectors(field):
    """``n v n`` = -v_par + v_perp with v_par = (v.n) n, for pure n with n.n = 1 and no other."""
    n, v = unit_vector(field), vector(field, "v")
    parallel = scale(dot(v, n), n)
    across = subtract(v, parallel)
    assert parallel_and_perpendicular(v, n) == (parallel, across)
    turned = Quaternion.pure(n) * Quaternion.pure(v) * Quaternion.pure(n)
    assert turned.components == (0, *subtract(across, parallel))
    longer = scale(2, n)
    assert parallel_and_perpendicular(v, longer)[0] != parallel


def test_3_1_4_alignment_dynamics():
    """``alpha'`` + alpha^2 - chi.chi = beta, chi' + 2 alpha chi = psi, r' = alpha r + chi x r."""
    motion = point_motion(parameters=("F1", "F2", "F3"))
    force = tuple(motion.field[name] for name in ("F1", "F2", "F3"))
    r, v = motion.r, motion.v
    r2 = dot(r, r)
    alpha, chi = dot(r, v) / r2, scale(1 / r2, cross(r, v))
    beta, psi = dot(r, force) / r2, scale(1 / r2, cross(r, force))
    X = motion.under(force)
    assert X.derivative(alpha) + alpha**2 - dot(chi, chi) == beta
    chi_dot = X.rates(chi)
    assert add(chi_dot, scale(2 * alpha, chi)) == psi
    assert v == add(scale(alpha, r), cross(chi, r))
    assert alignment_defect(motion, force).components == (0, 0, 0, 0)
    assert alignment(r, v).components == (alpha, *chi)
    # Spoiled: half the stretching term, and the wrong order in r' = alpha r + chi x r.
    assert add(chi_dot, scale(alpha, chi)) != psi
    assert v != add(scale(alpha, r), cross(r, chi))


def test_3_1_5_kepler_alignment():
    """``beta`` = -mu/r^3, psi = 0 and d|r|/dt = alpha |r|; another power is refused."""
    motion = point_motion()
    field, distance, mu = motion.field, motion.distance, motion.field["mu"]
    q = alignment(motion.r, motion.v)
    X = motion.under(kepler_force(motion))
    alpha_rate = X.derivative(q.w)
    riccati = alpha_rate + q.w**2 - dot(q.vector, q.vector)
    assert all_zero(field, [riccati + mu / distance**3])
    assert all_zero(field, add(X.rates(q.vector), scale(2 * q.w, q.vector)))
    assert all_zero(field, [X.derivative(distance) - q.w * distance])
    assert not all_zero(field, [riccati + mu / distance**2])


def test_3_1_5_kepler_vectors_and_orbit():
    """E, L, K, A are conserved, A = K x L, A.r = L^2 - mu r, A.A = mu^2 + 2 E L^2."""
    motion = point_motion()
    field, mu, r, v = motion.field, motion.field["mu"], motion.r, motion.v
    L, d = cross(r, v), motion.distance
    K = subtract(v, scale(mu / dot(L, L), cross(L, scale(1 / d, r))))
    A = subtract(cross(v, L), scale(mu / d, r))
    E = dot(v, v) / 2 - mu / d
    assert all_zero(field, subtract(hamilton_vector(motion), K))
    assert all_zero(field, subtract(laplace_runge_lenz(motion), A))
    assert all_zero(field, [kepler_energy(motion) - E])
    assert all_zero(field, subtract(A, cross(K, L)))
    assert all_zero(field, [dot(A, r) - (dot(L, L) - mu * d)])
    assert all_zero(field, [dot(A, A) - mu**2 - 2 * E * dot(L, L)])
    X = motion.under(scale(-mu / d**3, r))
    assert all_zero(field, X.rates([E, *L, *K, *A]))
    # Spoiled: A with the opposite sign of mu, K with the factors of its product exchanged.
    assert not all_zero(field, X.rates(add(cross(v, L), scale(mu / d, r))))
    assert not all_zero(field, subtract(A, cross(L, K)))


def kepler_return(period):
    """How far a Kepler orbit with mu = 2 is from its start after a time."""
    start = np.array([1.0, 0.0, 0.2, 0.1, 1.1, 0.0])

    def rate(t, y):
        return np.concatenate([y[3:], -2 * y[:3] / np.linalg.norm(y[:3]) ** 3])

    energy = start[3:] @ start[3:] / 2 - 2 / np.linalg.norm(start[:3])
    run = solve_ivp(rate, (0, period(energy)), start, method="DOP853", rtol=1e-12, atol=1e-13)
    return np.abs(run.y[:, -1] - start).max()


def test_3_1_5_kepler_period():
    """T = 2 pi mu / (-2E)^(3/2); the power 1/2 in its place does not close the orbit."""
    # DOP853 at rtol 1e-12 keeps about ten digits over one turn.
    assert kepler_return(lambda E: 2 * math.pi * 2 / (-2 * E) ** 1.5) < 1e-9
    assert kepler_return(lambda E: 2 * math.pi * 2 / (-2 * E) ** 0.5) > 1e-2


def test_3_1_39_monopole_kepler():
    """``r''`` + (lam/r^3) L + (mu/r^3 - lam^2/r^4) r = 0 conserves P, A, E and L.L, and not L."""
    motion = point_motion()
    field, r, v, d = motion.field, motion.r, motion.v, motion.distance
    lam, mu = field["lam"], field["mu"]
    L = cross(r, v)
    force = subtract(scale(-lam / d**3, L), scale(mu / d**3 - lam**2 / d**4, r))
    assert all_zero(field, subtract(monopole_force(motion), force))
    P = subtract(L, scale(lam / d, r))
    A = subtract(cross(v, P), scale(mu / d, r))
    E = dot(v, v) / 2 - mu / d + lam**2 / (2 * d**2)
    assert all_zero(field, subtract(poincare_vector(motion), P))
    assert all_zero(field, subtract(monopole_laplace_runge_lenz(motion), A))
    assert all_zero(field, [monopole_energy(motion) - E])
    X = motion.under(force)
    assert all_zero(field, X.rates([*P, *A, E, dot(L, L)]))
    assert not all_zero(field, X.rates(L))
    assert not all_zero(field, X.rates(add(L, scale(lam / d, r))))
    assert all_zero(field, subtract(magnetic_vector_field(motion, E).components, X.components))


def test_3_1_39_monopole_alignment():
    """``beta`` = -mu/r^3 + lam^2/r^4 and chi' + 2 alpha chi = -(lam/r^3) r x chi; + is refused."""
    motion = point_motion()
    field, r, d = motion.field, motion.r, motion.distance
    lam, mu = field["lam"], field["mu"]
    force = monopole_force(motion)
    q = alignment(r, motion.v)
    X = motion.under(force)
    stretched = add(X.rates(q.vector), scale(2 * q.w, q.vector))
    turned = scale(lam / d**3, cross(r, q.vector))
    assert all_zero(field, add(stretched, turned))
    assert not all_zero(field, subtract(stretched, turned))
    riccati = X.derivative(q.w) + q.w**2 - dot(q.vector, q.vector)
    assert all_zero(field, [riccati + mu / d**3 - lam**2 / d**4])


def test_3_1_39_monopole_lagrangian():
    """v^2/2 + lam A.v + mu/r - lam^2/(2 r^2) with curl A = r/r^3 gives the same motion."""
    motion = point_motion()
    field, r, v, d = motion.field, motion.r, motion.v, motion.distance
    lam, names, speeds = field["lam"], ("r1", "r2", "r3"), ("v1", "v2", "v3")
    below = d * (d + r[2])
    A = (-r[1] / below, r[0] / below, field.zero)
    magnetic = curl(VectorField(field, names, A)).components
    assert all_zero(field, subtract(magnetic, scale(1 / d**3, r)))
    potential = field["mu"] / d - lam**2 / (2 * d**2)

    def euler_lagrange(charge):
        L = dot(v, v) / 2 + charge * dot(A, v) + potential
        X = motion.under(monopole_force(motion))
        return subtract(X.rates(field.gradient(L, speeds)), field.gradient(L, names))

    assert all_zero(field, euler_lagrange(lam))
    assert not all_zero(field, euler_lagrange(-lam))


# -- 3.2 ------------------------------------------------------------------------------------------


def test_3_2_euler_rodrigues(field):
    """R v = q v q* with R = 1 + 2 q0 hat q + 2 hat q^2 for unit q; R(q)R(p) = R(qp), R(-q) = R(q).

    Unit quaternions are p/p* with p generic, so nothing is assumed beside p != 0.
    """
    p, r = symbols(field, "q"), symbols(field, "r")
    q, v = unit_quaternion(p), vector(field, "v")
    assert q.norm == 1
    Q = hat(q.vector)
    R = combine((1, identity(3)), (2 * q.w, Q), (2, matmul(Q, Q)))
    assert euler_rodrigues(q) == R
    assert (q * Quaternion.pure(v) * q.conjugate).components == (0, *apply(R, v))
    assert euler_rodrigues(-q) == R
    together = matmul(euler_rodrigues(p), euler_rodrigues(r))
    assert together == euler_rodrigues(p * r)
    assert together != euler_rodrigues(r * p)
    assert apply(transpose(R), v) == (q.conjugate * Quaternion.pure(v) * q).vector


def test_3_2_1_cayley_klein_parameters(field):
    """``q`` = [cos theta/2, sin theta/2 n] is exp(-i theta n.sigma/2), a turn by theta about n."""
    theta, n, v = field["theta"], unit_vector(field), vector(field, "v")
    q = cayley_klein(field, theta, n)
    U = pauli(q)

    def by_theta(z):
        return Complex(*(field.derivative(part, "theta") for part in (z.re, z.im)))

    def parts(generator):
        right = matmul(generator, U)
        defects = [by_theta(U[i][j]) - right[i][j] for i in (0, 1) for j in (0, 1)]
        return [part for z in defects for part in (z.re, z.im)]

    assert all_zero(field, parts(su2(n)))
    assert not all_zero(field, parts(tilde(n)))
    cosine = q.w**2 - dot(q.vector, q.vector)
    sine = 2 * q.w * field.call("sin", theta / 2)
    rodrigues = add(
        add(scale(cosine, v), scale(sine, cross(n, v))), scale((1 - cosine) * dot(n, v), n)
    )
    assert all_zero(field, subtract(apply(euler_rodrigues(q), v), rodrigues))


@pytest.mark.parametrize("theta", [0.0, 1e-9, 0.7, math.pi, 4.0])
def test_3_2_1_rotation_against_expm(theta):
    """The numbers are those of expm(theta hat n); the whole angle in place of half is refused."""
    n = (0.6, -0.48, 0.64)
    expected = expm(theta * np.array(hat(n)))

    def turn(angle):
        return np.array(euler_rodrigues(Quaternion(math.cos(angle), *scale(math.sin(angle), n))))

    # Entries of size one; expm squares a few times and loses two digits by it.
    assert np.abs(turn(theta / 2) - expected).max() < 2e-13
    if abs(math.sin(theta)) > 0.1:
        assert np.abs(turn(theta) - expected).max() > 0.1


def test_3_2_2_3_tilde_map(field):
    """p~ q~ = -p.q + (p x q)~, [p~, q~] = 2 (p x q)~, and -(i/2) sigma is an isomorphism."""
    p, q = vector(field, "q"), vector(field, "r")
    assert tilde(p) == pauli(Quaternion.pure(p))
    by_hand = combine((1, tilde(cross(p, q))), (-dot(p, q), identity(2)))
    assert matmul(tilde(p), tilde(q)) == by_hand
    bracket = commutator(tilde(p), tilde(q))
    assert untilde(bracket) == scale(2, cross(p, q))
    assert untilde(bracket) != cross(p, q)
    assert commutator(su2(p), su2(q)) == su2(cross(p, q))
    assert commutator(hat(p), hat(q)) == hat(cross(p, q))


def test_3_2_4_dual_tilde_map(field):
    """-tr(p~ q~)/2 = p.q = tr(hat p^T hat q)/2; tr(p~ q~)/2 has the other sign."""
    p, q = vector(field, "q"), vector(field, "r")
    assert pairing_su2(tilde(p), tilde(q)) == dot(p, q)
    assert pairing_so3(hat(p), hat(q)) == dot(p, q)
    assert dual_tilde(tilde(p)) == p
    assert pairing_su2(tilde(p), adjoint(tilde(q))) == -dot(p, q)


@pytest.fixture
def plane():
    """The field of C^2 with a unit complex number in x and a Hamiltonian's slopes."""
    return Field(["q1", "q2", "p1", "p2", "x", "c0", "c1", "c2", "c3"])


def test_3_2_5_poincare_sphere(plane):
    """n1 + i n2 = 2 a1* a2, n3 = |a1|^2 - |a2|^2, Q = a (x) a* = (n0 + n.sigma)/2, n.n = n0^2."""
    a1, a2 = a = amplitudes(plane)
    n0, n1, n2, n3 = n = hopf_map(a)
    assert Complex(n1, n2) == 2 * (a1.conjugate * a2)
    assert Complex(n3) == a1 * a1.conjugate - a2 * a2.conjugate
    assert Complex(n0) == a1 * a1.conjugate + a2 * a2.conjugate
    assert n1**2 + n2**2 + n3**2 == n0**2
    assert coherence_matrix(a) == from_sphere(n)
    assert coherence_matrix(a) != from_sphere((n0, n1, -n2, n3))


def test_3_2_6_hopf_brackets(plane):
    """{n_i, n_j} = 4 eps_ijk n_k and {n0, n} = 0 from {a_j, a_k*} = -2i delta_jk."""
    n0, *n = hopf_map(amplitudes(plane))

    def bracket(f, h):
        return canonical_bracket(plane, f, h)

    for j, k in product((1, 2), repeat=2):
        re_re = bracket(plane[f"q{j}"], plane[f"q{k}"]) + bracket(plane[f"p{j}"], plane[f"p{k}"])
        mixed = bracket(plane[f"q{j}"], -plane[f"p{k}"]) + bracket(plane[f"p{j}"], plane[f"q{k}"])
        assert (re_re, mixed) == (0, -2 * int(j == k))
    for i, j in product(range(3), repeat=2):
        expected = sum((4 * epsilon(i, j, k) * n[k] for k in range(3)), plane.zero)
        assert bracket(n[i], n[j]) == expected
        assert bracket(n[i], n[j]) != expected / 2 or i == j
    assert [bracket(n0, component) for component in n] == [0, 0, 0]


def test_3_2_6_hopf_motion(plane):
    """``n'`` = {n, H} = -4 n x dH/dn for H of any slope; the other sign is refused."""
    n = hopf_map(amplitudes(plane))
    slope = tuple(plane[f"c{k}"] for k in range(4))
    X = hamiltonian_vector_field(plane, ("q1", "q2"), ("p1", "p2"), dot(slope, n))
    assert X.derivative(n[0]) == 0
    assert X.rates(n[1:]) == reduced_motion(n[1:], slope[1:])
    assert X.rates(n[1:]) == scale(-4, cross(n[1:], slope[1:]))
    assert X.rates(n[1:]) != scale(4, cross(n[1:], slope[1:]))


def test_3_2_6_hopf_fibres_are_phase_orbits(plane):
    """A common phase leaves n, and n0 generates it; a phase of a1 alone moves n."""
    a1, a2 = amplitudes(plane)
    z = Complex(1, plane["x"])
    phase = z / z.conjugate
    assert phase.norm == 1
    assert hopf_map((phase * a1, phase * a2)) == hopf_map((a1, a2))
    assert hopf_map((phase * a1, a2)) != hopf_map((a1, a2))
    X = hamiltonian_vector_field(plane, ("q1", "q2"), ("p1", "p2"), hopf_map((a1, a2))[0])
    rates = [Complex(*X.rates((a.re, a.im))) for a in (a1, a2)]
    assert rates == [-2 * I * a1, -2 * I * a2]


def test_3_2_6_hopf_map_is_equivariant(plane):
    """``a`` -> U a turns n by the rotation of U in SU(2), not by its inverse."""
    q = Quaternion(*(plane[f"c{k}"] for k in range(4)))
    n0, *n = hopf_map(amplitudes(plane))
    turned = hopf_map(apply(pauli(q), amplitudes(plane)))
    assert turned[0] == q.norm * n0
    assert turned[1:] == scale(q.norm, apply(euler_rodrigues(q), n))
    assert turned[1:] != scale(q.norm, apply(transpose(euler_rodrigues(q)), n))


def test_3_2_7_the_table_of_coquaternions():
    """i^2 = -1, j^2 = k^2 = 1, ij = k = -ji, jk = -i = -kj, ki = j = -ik; quaternions differ."""
    one, i, j, k = Coquaternion.units()
    assert [i * i, j * j, k * k] == [-one, one, one]
    assert [i * j, j * k, k * i] == [k, -i, j]
    assert [j * i, k * j, i * k] == [-k, i, -j]
    assert [ad(i, j), ad(j, k), ad(k, i)] == [k.scale(2), i.scale(-2), j.scale(2)]
    _, i, j, k = Quaternion.units()
    assert j * k != -i


def test_3_2_7_coquaternion_norm_and_matrices(field):
    """Norm w^2 + x^2 - y^2 - z^2 = determinant in SL(2,R) and SU(1,1); products are preserved."""
    q, r = (symbols(field, letter, Coquaternion) for letter in "qr")
    w, x, y, z = q.components
    assert q.norm == w**2 + x**2 - y**2 - z**2
    assert (q * r).norm == q.norm * r.norm
    for form in (Coquaternion.real_matrix, Coquaternion.complex_matrix):
        assert form(q * r) == matmul(form(q), form(r))
        assert form(q * r) != matmul(form(r), form(q))
        assert determinant(form(q)) == q.norm
    signs = ((Complex(1), Complex(0)), (Complex(0), Complex(-1)))
    M = q.complex_matrix()
    assert matmul(adjoint(M), matmul(signs, M)) == scaled_matrix(q.norm, signs)
    assert matmul(adjoint(M), M) != scaled_matrix(q.norm, identity(2))


def test_3_2_7_imaginary_coquaternions_are_sl2(field):
    """Imaginary ones are the traceless matrices, and x^2 - y^2 - z^2 is invariant, not + + +."""
    q, xi = symbols(field, "q", Coquaternion), Coquaternion.pure(vector(field, "r"))
    m = xi.real_matrix()
    assert m[0][0] + m[1][1] == 0
    turned = AD(q, xi)
    assert turned.w == 0
    x, y, z = turned.vector
    assert x**2 - y**2 - z**2 == xi.x**2 - xi.y**2 - xi.z**2
    assert x**2 + y**2 + z**2 != xi.x**2 + xi.y**2 + xi.z**2


# -- 4.1 and 4.2.1 --------------------------------------------------------------------------------


def along(field, q, q_dot, element):
    """The rate of a function of the quaternion along a curve."""
    names = [f"q{n}" for n in range(4)]
    return dot(field.gradient(element, names), q_dot.components)


def test_4_1_quaternion_kinematics(field):
    """Omega = 2 Im(q* q') and q' = q [0, Omega]/2 give R' = R hat(Omega) and keep the norm."""
    q, Omega = symbols(field, "q"), vector(field, "u")
    q_dot = quaternion_rate(q, Omega)
    assert q_dot == (q * Quaternion(0, *Omega)).scale(field.one / 2)
    assert body_angular_velocity(q, q_dot) == Omega
    R = euler_rodrigues(q)
    R_dot = tuple(tuple(along(field, q, q_dot, entry) for entry in row) for row in R)
    assert R_dot == matmul(R, hat(Omega))
    assert R_dot != matmul(hat(Omega), R)
    assert along(field, q, q_dot, q.norm) == 0


def test_4_1_kinematics_of_unit_quaternions(field):
    """On p/p*, which has norm 1, the book's forms without a division hold for every motion of p."""
    p, p_dot = symbols(field, "q"), symbols(field, "r")
    q = unit_quaternion(p)
    q_dot = Quaternion(*(along(field, p, p_dot, component) for component in q.components))
    Omega = scale(2, (q.conjugate * q_dot).vector)
    assert (q.conjugate * q_dot).w == 0
    assert body_angular_velocity(q, q_dot) == Omega
    assert q_dot == quaternion_rate(q, Omega)
    assert q_dot != quaternion_rate(q, scale(2, Omega))


def test_4_1_3_spatial_angular_momentum(field):
    """``q`` Pi q* is constant along q' = q Omega/2, Pi' = Pi x Omega, and not with Omega x Pi."""
    q, Omega, Pi = symbols(field, "q"), vector(field, "u"), vector(field, "v")
    q_dot = quaternion_rate(q, Omega)

    def rate(Pi_dot):
        pure, moving = Quaternion.pure(Pi), Quaternion.pure(Pi_dot)
        return (
            q_dot * pure * q.conjugate + q * moving * q.conjugate + q * pure * q_dot.conjugate
        ).components

    assert rate(cross(Pi, Omega)) == (0, 0, 0, 0)
    assert rate(cross(Omega, Pi)) != (0, 0, 0, 0)


def test_4_2_1_actions_of_quaternions(field):
    """AD = q r q*, ad = 2 xi x eta, Ad* = q* mu q, ad* = -2 xi x mu, for unit q."""
    q = unit_quaternion(symbols(field, "q"))
    r = symbols(field, "r")
    xi, mu = (Quaternion.pure(vector(field, letter)) for letter in "uv")
    assert AD(q, r) == q * r * q.conjugate
    assert AD(q, xi).vector == apply(euler_rodrigues(q), xi.vector)
    assert Ad_star(q, mu) == q.conjugate * mu * q
    assert ad(xi, mu).components == (0, *scale(2, cross(xi.vector, mu.vector)))
    assert ad_star(xi, mu).components == (0, *scale(-2, cross(xi.vector, mu.vector)))
    halved = [part.scale(field.one / 2) for part in (xi, mu)]
    assert ad(*halved) == Quaternion.pure(cross(xi.vector, mu.vector)).scale(field.one / 2)


def test_4_2_1_coactions_are_dual(field):
    """<Ad*_q mu, eta> = <mu, Ad_q eta>, <ad*_xi mu, eta> = <mu, ad_xi eta>; signs matter."""
    q = symbols(field, "q")
    xi, mu, eta = (Quaternion.pure(vector(field, letter)) for letter in "ruv")
    assert dot(Ad_star(q, mu).vector, eta.vector) == dot(mu.vector, AD(q, eta).vector)
    assert dot(AD(q, mu).vector, eta.vector) != dot(mu.vector, AD(q, eta).vector)
    right = dot(mu.vector, ad(xi, eta).vector)
    assert dot(ad_star(xi, mu).vector, eta.vector) == right
    assert dot(ad(xi, mu).vector, eta.vector) != right
