"""Routes on configuration spaces: every choice of state, and refusals that name the way out."""

from fractions import Fraction

import numpy as np
import pytest
import sympy

from coadjoint import pipeline
from coadjoint.derive import derive, make_setting
from coadjoint.derive.domain import bounds
from coadjoint.derive.reference import Reference
from coadjoint.derive.routes import euler_lagrange
from coadjoint.errors import DerivationError
from coadjoint.prove import Verdict
from tests.specs import prove_claims, spec, verdicts_of

FREE = """
title = "Free points"
routes = ["euler-lagrange", "canonical"]
[variables]
q = { role = "coordinate", shape = [4] }
v = { role = "velocity", of = "q" }
p = { role = "momentum", of = "q" }
[lagrangian]
l = "dot(v, v)/2 - dot(q, q)/2"
"""
WITHOUT_MOMENTA = ('p = { role = "momentum", of = "q" }\n', "")
SYMMETRIC = """
title = "Symmetric matrices"
routes = ["euler-lagrange", "canonical"]
[variables]
S = { role = "coordinate", shape = [3], form = "symmetric" }
V = { role = "velocity", of = "S" }
P = { role = "momentum", of = "S" }
[parameters]
A = { shape = [3], form = "symmetric" }
[lagrangian]
l = "trace(V*V)/2 - trace(A*S)"
[claims.brackets]
"{S12, P12}" = "1/2"
"""
LAW = """
title = "Two points"
routes = ["newton"]
[variables]
x = { role = "coordinate", shape = [3] }
y = { role = "coordinate", shape = [3] }
u = { role = "velocity", of = "x" }
w = { role = "velocity", of = "y" }
[parameters]
m = { positive = true, default = 1 }
k = { default = 1 }
[newton]
x = { mass = "m", force = "k*(y - x)" }
y = { force = "k*(x - y)" }
[observables]
P = "m*u + w"
[claims]
conserved = ["P"]
galilean = true
"""


def test_momenta_and_velocities_give_the_same_motion():
    """The Hamiltonian flow of (q, p) and the accelerations of (q, v): both are oscillators."""
    for sample in (spec(FREE), spec(FREE, WITHOUT_MOMENTA)):
        equations = derive(sample)
        names = equations.setting.state
        q = sympy.symbols("q1:5")
        assert equations.rates[4:] == tuple(-each for each in q)
        assert equations.rates[:4] == tuple(map(sympy.Symbol, names[4:]))
        assert prove_claims(sample).holds


def test_four_coupled_velocities_are_solved_in_the_kernel_beside_momenta():
    """dp/dt = dl/dq with v from a solve; both routes agree and the energy is conserved."""
    sample = spec(FREE, ("dot(v, v)/2", "dot(v, v)/2 + q1*v1*v2 + v2*v3/3 + v3*v4/5"))
    equations = derive(sample)
    assert equations.exact.solves
    certificate = prove_claims(sample)
    assert certificate.holds, str(certificate)
    same = [c for c in certificate.claims if c.kind == "equivalence"]
    assert len(same) >= 2


COUPLED = ("dot(v, v)/2", "dot(v, v)/2 + q1*v1*v2 + v2*v3/3 + v3*v4/5")
ALONE = [WITHOUT_MOMENTA, ('"euler-lagrange", "canonical"', '"euler-lagrange"')]


def check_accelerations(equations, mass, force):
    """M(q, v) dv/dt = F(q, v) of four velocities at a point, both written by hand."""
    q, v = np.array([0.1, -0.4, 0.7, 0.3]), np.array([0.5, 0.2, -0.6, 0.9])
    names = equations.setting.state
    point = dict(zip(names, map(Fraction, (*q, *v)), strict=True))
    values = Reference(equations).evaluate("rhs", point, Fraction, None)
    assert list(map(float, values[:4])) == list(v)
    np.testing.assert_allclose(
        np.array(values[4:], dtype=float), np.linalg.solve(mass(q, v), force(q, v)), rtol=1e-12
    )


def coupled_mass(q, v):
    """d2l/dv2 of COUPLED."""
    matrix = np.eye(4)
    for i, j, entry in ((0, 1, q[0]), (1, 2, 1 / 3), (2, 3, 1 / 5)):
        matrix[i, j] = matrix[j, i] = entry
    return matrix


def coupled_force(q, v):
    """dl/dq - d2l/dvdq v of COUPLED: q1*v1*v2 gives v1*v2 along q1 and takes q1'*(v2, v1)."""
    return -q + np.array([v[0] * v[1], 0, 0, 0]) - v[0] * np.array([v[1], v[0], 0, 0])


def test_four_coupled_velocities_of_the_state_are_solved_for_in_the_kernel():
    """M dv/dt is what a hand finds, the energy is conserved, and the bracket is one."""
    sample = spec(FREE, COUPLED, *ALONE)
    equations = derive(sample)
    (solve,) = equations.exact.solves
    assert list(solve.names) == [f"dv{n}_dt" for n in range(1, 5)]
    check_accelerations(equations, coupled_mass, coupled_force)
    with pytest.raises(AssertionError):
        check_accelerations(equations, coupled_mass, lambda q, v: -q)
    certificate = prove_claims(sample)
    assert certificate.holds, str(certificate)
    proved = {c.statement for c in certificate.claims if c.verdict is Verdict.PROVED}
    assert {"the energy is conserved", "the bracket satisfies the Jacobi identity"} <= proved


def test_four_coupled_velocities_need_no_quadratic_lagrangian():
    """L = v.v/2 + (v.v)^2/4 - q.q/2 has M = (1 + v.v) + 2 v v^T, and F = -q."""
    quartic = ("dot(v, v)/2", "dot(v, v)/2 + dot(v, v)^2/4")
    equations = derive(spec(FREE, quartic, *ALONE))
    assert len(equations.exact.solves) == 1
    check_accelerations(
        equations, lambda q, v: (1 + v @ v) * np.eye(4) + 2 * np.outer(v, v), lambda q, v: -q
    )


def test_a_kinetic_energy_of_either_sign_bounds_no_free_motion():
    """Its mass matrix is regular all the same; so it is of fewer coupled velocities."""
    indefinite = ("dot(v, v)/2", "dot(v, v)/2 - 3*v1^2 + v1*v2 + v2*v3/3 + v3*v4/5")
    equations = derive(spec(FREE, indefinite, *ALONE))
    assert len(equations.exact.solves) == 1
    assert bounds(equations) == ()


def test_forces_on_four_coupled_velocities_act_along_their_momenta():
    """A force and friction go into the right side of M dv/dt, before the solve."""
    forces = (
        '[forces]\nv = "vector(1, 0, 0, 2)"\n[dissipation]\nR = "3*(v1^2 + v2^2 + v3^2 + v4^2)/2"\n'
    )
    equations = derive(spec(FREE + forces, COUPLED, *ALONE))

    def force(q, v):
        return coupled_force(q, v) + np.array([1, 0, 0, 2]) - 3 * v

    check_accelerations(equations, coupled_mass, force)


def test_two_routes_that_solve_in_the_kernel_give_the_same_motion(monkeypatch):
    """Along a frame without constraints it is the motion of d'Alembert's principle."""
    routes = ('"euler-lagrange"', '"nonholonomic", "euler-lagrange"')
    sample = spec(FREE, COUPLED, *ALONE, routes)
    statement = "nonholonomic and euler-lagrange give the same motion"
    verdicts = verdicts_of(sample)
    assert verdicts[statement] is Verdict.PROVED
    right = euler_lagrange.explicit_rate
    monkeypatch.setattr(euler_lagrange, "explicit_rate", lambda *given: right(*given) + 1)
    verdicts = verdicts_of(sample)
    assert verdicts[statement] is Verdict.REFUTED


def test_entries_beside_the_diagonal_of_symmetric_matrices_are_paired_twice():
    """L = tr V^2/2 - tr(A S): P = V and dP/dt = -A, entry by entry."""
    sample = spec(SYMMETRIC)
    for route in sample.routes:
        equations = derive(sample, route)
        p, a = sympy.symbols("P11 P12 P22"), sympy.symbols("A11 A12 A22")
        velocities = tuple(equations.velocities.values())
        assert velocities == p
        assert equations.rates[3:] == tuple(-each for each in a)
    certificate = prove_claims(sample)
    assert certificate.holds, str(certificate)


def test_symmetric_momenta_are_paired_twice_by_a_declared_bracket():
    """The route poisson with named velocities moves as the other two."""
    bracket = (
        '[poisson]\ncanonical = [["S", "P"]]\n[hamiltonian]\nh = "trace(P*P)/2 + trace(A*S)"\n'
    )
    certificate = prove_claims(
        spec(SYMMETRIC + bracket, ('"canonical"]', '"canonical", "poisson"]'))
    )
    assert certificate.holds, str(certificate)
    assert any("poisson" in claim.statement for claim in certificate.claims)


def test_a_wrong_weight_of_symmetric_matrices_is_refuted():
    """{S12, P12} = 1 is not the bracket of tr(P dS/dt)."""
    certificate = prove_claims(spec(SYMMETRIC, ('"1/2"', '"1"')))
    refuted = [c.statement for c in certificate.claims if c.verdict is Verdict.REFUTED]
    assert refuted == ["{S12, P12} = 1"]


def test_a_lagrangian_not_quadratic_in_velocities_has_accelerations():
    """L = -sqrt(1 - v^2): the mass matrix depends on v, and a free particle keeps v."""
    text = FREE.replace("shape = [4]", "shape = [2]").replace(', "canonical"', "")
    changes = [WITHOUT_MOMENTA, ("dot(v, v)/2 - dot(q, q)/2", "-sqrt(1 - dot(v, v)) - q1")]
    sample = spec(text, *changes)
    a1, a2 = derive(sample).rates[2:]
    v1, v2 = sympy.symbols("v1 v2")
    root = sympy.sqrt(1 - v1**2 - v2**2)  # d(v/root)/dt = (-1, 0)
    assert sympy.simplify(a1 + root * (1 - v1**2)) == 0
    assert sympy.simplify(a2 - root * v1 * v2) == 0
    assert prove_claims(sample).holds


@pytest.mark.parametrize("route", ["euler-lagrange", "canonical"])
def test_a_missing_kinetic_term_is_named(route):
    """v4 has no mass."""
    changes = [WITHOUT_MOMENTA, ("dot(v, v)/2", "(v1^2 + v2^2 + v3^2)/2")]
    with pytest.raises(DerivationError, match=r"determinant 0.*Add the missing kinetic .*v4") as e:
        derive(spec(FREE, *changes), route)
    assert e.value.parts["found"] == "v4"


def test_a_hamiltonian_of_velocities_needs_a_bracket():
    """Nothing says what is conjugate to q."""
    text = FREE.replace('"euler-lagrange", ', "").replace("[lagrangian]\nl", "[hamiltonian]\nh")
    with pytest.raises(DerivationError, match=r"finds no momenta.*canonical = \[\[") as caught:
        derive(spec(text, WITHOUT_MOMENTA))
    assert "dot(v, v)" in caught.value.parts["found"]


def test_every_row_has_its_mass():
    """M dv/dt = F column by column, for two particles in the plane and F = -k q."""
    sample = spec("""
title = "Two particles in the plane, the mass of one felt by the other"
routes = ["newton"]
[variables]
q = { role = "coordinate", shape = [4], form = "matrix" }
v = { role = "velocity", of = "q" }
[parameters]
M = { shape = [3], form = "symmetric" }
k = {}
[newton.q]
mass = "M"
force = "-k*q"
""")
    q = sympy.Matrix(2, 2, sympy.symbols("q11 q12 q21 q22"))
    m1, c, m2, k = sympy.symbols("M11 M12 M22 k")
    det = m1 * m2 - c**2
    expected = [
        -k * (m2 * q[0, 0] - c * q[1, 0]) / det,
        -k * (m2 * q[0, 1] - c * q[1, 1]) / det,
        -k * (m1 * q[1, 0] - c * q[0, 0]) / det,
        -k * (m1 * q[1, 1] - c * q[0, 1]) / det,
    ]
    assert all(
        sympy.cancel(a - b) == 0 for a, b in zip(derive(sample).rates[4:], expected, strict=True)
    )


def test_alignment_is_of_one_particle():
    """Two particles have no common quaternion."""
    with pytest.raises(DerivationError, match=r"one particle in three dimensions.*x1, .*y3"):
        derive(spec(LAW, ('["newton"]', '["newton", "alignment"]')), "alignment")


@pytest.mark.parametrize("mass", ["m - m", "rows(0*x, 0*x, 0*x)"])
def test_a_mass_of_zero_is_refused(mass):
    """No acceleration follows."""
    with pytest.raises(DerivationError, match="determinant 0; expected one of every") as caught:
        derive(spec(LAW, ('"m"', f'"{mass}"')))
    assert caught.value.parts["found"] == mass


def test_a_matrix_of_masses_multiplies_the_acceleration():
    """M a = F with a coupled M."""
    text = LAW.replace("galilean = true", "").replace('conserved = ["P"]', "")
    matrix = "m*x1*hat(x)*hat(x) + diag(x)"
    equations = derive(spec(text, ('"m"', f'"{matrix}"')))
    (m, k), x = sympy.symbols("m k"), sympy.symbols("x1:4")
    hat = sympy.Matrix([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])
    M = m * x[0] * hat * hat + sympy.diag(*x)
    y = sympy.Matrix(sympy.symbols("y1:4"))
    left = M * sympy.Matrix(equations.rates[6:9]) - k * (y - sympy.Matrix(x))
    assert left.applyfunc(sympy.cancel) == sympy.zeros(3, 1)


def test_a_law_without_energy_is_proved_and_rendered():
    """Neither energy nor bracket are emitted, and what is claimed is proved."""
    sample = spec(LAW)
    equations = derive(sample)
    assert equations.energy is None
    assert equations.poisson_tensor is None
    assert list(equations.observables) == ["P1", "P2", "P3"]
    certificate = prove_claims(sample)
    assert certificate.holds, str(certificate)
    assert [c.kind for c in certificate.claims].count("galilean") == 4
    assert "energy" not in pipeline.render(sample).texts["kernel.c"]


def test_own_momenta_have_free_names():
    """Where p_q1 is a parameter the momenta are called otherwise."""
    changes = [WITHOUT_MOMENTA, ("[lagrangian]", "[parameters]\np_q1 = {}\n[lagrangian]")]
    sample = spec(FREE, *changes)
    setting = make_setting(sample)
    chart = derive(sample, "canonical", setting=setting).chart
    assert len(set(chart.variables) & set(setting.field.names)) == 8
    assert "p_q1" not in chart.variables
    assert prove_claims(sample).holds
