"""Configuration spaces: Newton, Lagrange, Hamilton and alignment, typed from Holm (2011), part II.

Sections 2.1, 2.2, 2.2.1, 2.2.4, 2.5, 3.1.4, 3.1.5 with exercise 3.1.39, and 12.2.2; beside each law
stands a change of one sign or term that is refuted.
"""

from fractions import Fraction

import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.derive.assembly import make_setting
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.routes.euler_lagrange import christoffel, christoffel_first
from coadjoint.prove import Verdict
from coadjoint.resources import derivations_folder
from tests.specs import prove_claims, spec, unitless


def text_of(name):
    """The text of a shipped spec, without units, which wrong laws would not fit."""
    return unitless((derivations_folder() / f"{name}.toml").read_text(encoding="utf-8"))


def refuted(sample):
    """Statements of a certificate that are refuted, each at a point."""
    claims = [c for c in prove_claims(sample).claims if c.verdict is Verdict.REFUTED]
    assert all(c.counterexample for c in claims), claims
    return [c.statement for c in claims]


def check_proved(sample, *statements):
    """Everything holds, and these statements are among what was proved."""
    certificate = prove_claims(sample)
    assert certificate.holds, str(certificate)
    proved = {c.statement for c in certificate.claims if c.verdict is Verdict.PROVED}
    assert set(statements) <= proved, sorted(proved)


def check_rates(sample, expected, route=None):
    """The rates equal formulas typed by hand, as rational functions of sines and cosines."""
    equations = derive(sample, route)
    assert len(equations.rates) == len(expected)
    for found, value in zip(equations.rates, expected, strict=True):
        assert sympy.simplify(found - sympy.sympify(value, locals={"I": sympy.Symbol("I")})) == 0


# -- 2.1 Newton's law ------------------------------------------------------------------------------

LAWS = [
    f"Newton's law is the same after a {g} of space and time"
    for g in ("rotation", "translation", "boost", "time shift")
]


def test_2_1_central_pair_forces_keep_momentum_and_angular_momentum():
    """P, J and E of three particles are conserved, and every Galilean observer has their law."""
    proved = ("P is conserved", "J is conserved", "the energy is conserved", *LAWS)
    check_proved(spec(text_of("n_particles")), *proved)


def test_2_1_the_centre_of_mass_moves_uniformly():
    """d/dt sum m r = P, which is constant."""
    equations = derive(spec(text_of("n_particles")))
    rates = dict(zip(map(str, equations.state), equations.rates, strict=True))
    m = sympy.symbols("m1:4")
    for k in "123":
        P = equations.observables[f"P{k}"]
        moved = sum(mass * rates[f"r{n}{k}"] for n, mass in enumerate(m, 1))
        assert sympy.expand(moved - P) == 0
        pulled = sum(mass * rates[f"v{n}{k}"] for n, mass in enumerate(m, 1))
        assert sympy.cancel(sympy.together(pulled)) == 0


@pytest.mark.parametrize(
    ("force", "broken"),
    [
        ("- m1*r[1]", {"translation", "boost"}),  # an absolute position
        ("- m1*v[1]", {"boost"}),  # an absolute velocity
        ("+ m1*e", {"rotation"}),  # a preferred direction
        ("- m1*dot(v[1] - v[2], v[1] - v[2])*(v[1] - v[2])", set()),  # friction between the two
    ],
)
def test_1_2_1_laws_that_name_a_place_a_motion_or_a_direction_are_refuted(force, broken):
    """The transformation that shows it is named, with a point in the spec's own names."""
    text = text_of("n_particles")
    text = text[: text.index("[symmetries.P]")] + "[claims]\ngalilean = true\n"
    changes = [
        ('routes  = ["newton", "euler-lagrange", "canonical"]', 'routes = ["newton"]'),
        ("m1*m3*f(r[3] - r[1]),\n  m2", f"m1*m3*f(r[3] - r[1]) {force},\n  m2"),
        ("[definitions]", "e = { shape = [3] }\n[definitions]"),
    ]
    text = text[: text.index("[lagrangian]")] + text[text.index("[claims]") :]
    certificate = prove_claims(spec(text, *changes))
    found = [c for c in certificate.claims if c.verdict is Verdict.REFUTED]
    assert {c.statement for c in found} == {law for law in LAWS if any(b in law for b in broken)}
    for claim in found:
        assert any(name.startswith(("turn", "boost", "to")) for name in claim.counterexample)
        assert not any("spec" in name for name in claim.counterexample)


def test_2_1_a_force_that_has_no_reaction_breaks_the_total_momentum():
    """Without Newton's third law P drifts, and Lagrange's equations are other ones."""
    sample = spec(text_of("n_particles"), ("- m1*m2*f(r[2] - r[1]),", "+ m1*m2*f(r[2] - r[1]),"))
    found = refuted(sample)
    assert "P is conserved" in found
    assert "newton and euler-lagrange give the same motion" in found


# -- 2.2 Euler and Lagrange ------------------------------------------------------------------------

PENDULUM = """
title = "Pendulum"
routes = ["euler-lagrange", "canonical"]
[variables]
q = { role = "coordinate" }
v = { role = "velocity", of = "q" }
[parameters]
m = { positive = true }
l = { positive = true }
g = { positive = true }
[lagrangian]
l = "m*l^2*v^2/2 + m*g*l*cos(q)"
[claims]
conserved = ["energy", "v^2/2 - g*cos(q)/l"]
"""


def test_2_2_1_the_pendulum_obeys_its_equation():
    """Q'' = -(g/l) sin q, with the energy m l^2 v^2/2 - m g l cos q."""
    check_rates(spec(PENDULUM), ["v", "-g*sin(q)/l"])
    check_proved(spec(PENDULUM), "the energy is conserved")
    energy = derive(spec(PENDULUM)).energy
    assert sympy.expand(energy - sympy.sympify("m*l**2*v**2/2 - m*g*l*cos(q)")) == 0
    found = refuted(spec(PENDULUM, ("v^2/2 - g", "v^2/2 + g")))
    assert "v^2/2 + g*cos(q)/l is conserved" in found


CHARGE = """
title = "Charge in the plane"
routes = ["euler-lagrange", "canonical"]
[variables]
q = { role = "coordinate", shape = [2] }
v = { role = "velocity", of = "q" }
[parameters]
B = {}
[lagrangian]
l = "dot(v, v)/2 + B*q1*v2"
[claims]
conserved = ["energy"]
[claims.brackets]
"{v1, v2}" = "B"
"""


def test_2_2_gyroscopic_terms_turn_velocities_and_their_bracket():
    """L = v^2/2 + B q1 v2: v1' = B v2, v2' = -B v1, {v1, v2} = B."""
    sample = spec(CHARGE)
    check_rates(sample, ["v1", "v2", "B*v2", "-B*v1"])
    check_proved(sample, "{v1, v2} = B")
    assert refuted(spec(CHARGE, ('"B"', '"-B"'))) == ["{v1, v2} = -B"]


def test_2_2_coupled_velocities_are_solved_for():
    """The double pendulum: M v' = forces, M = [[2, cos], [cos, 1]], typed by hand."""
    text = """
title = "Double pendulum"
routes = ["euler-lagrange", "canonical"]
[variables]
a = { role = "coordinate" }
b = { role = "coordinate" }
u = { role = "velocity", of = "a" }
w = { role = "velocity", of = "b" }
[lagrangian]
l = "u^2 + w^2/2 + u*w*cos(a - b) + 2*cos(a) + cos(b)"
"""
    sample = spec(text)
    check_proved(sample, "euler-lagrange and canonical give the same motion, through p = dl/dv")
    equations = derive(sample)
    a, b, u, w = sympy.symbols("a b u w")
    rates = dict(zip(equations.state, equations.rates, strict=True))
    c, s = sympy.cos(a - b), sympy.sin(a - b)
    left = sympy.Matrix([[2, c], [c, 1]]) * sympy.Matrix([rates[u], rates[w]])
    right = sympy.Matrix([-(w**2) * s - 2 * sympy.sin(a), u**2 * s - sympy.sin(b)])
    assert (left - right).applyfunc(sympy.simplify) == sympy.zeros(2, 1)


# -- 2.2.4 geodesics -------------------------------------------------------------------------------

SPHERE = """
title = "Sphere"
routes = ["euler-lagrange", "canonical"]
[variables]
a = { role = "coordinate", doc = "angle from the pole" }
b = { role = "coordinate", doc = "angle about the axis" }
u = { role = "velocity", of = "a" }
w = { role = "velocity", of = "b" }
[lagrangian]
l = "(u^2 + sin(a)^2*w^2)/2"
[observables]
J1 = "-sin(b)*u - sin(a)*cos(a)*cos(b)*w"
J2 = "cos(b)*u - sin(a)*cos(a)*sin(b)*w"
J3 = "sin(a)^2*w"
[claims]
conserved = ["energy", "J1", "J2", "J3"]
"""
PLANE = """
title = "Hyperbolic plane"
routes = ["euler-lagrange", "canonical"]
[variables]
x = { role = "coordinate" }
y = { role = "coordinate" }
u = { role = "velocity", of = "x" }
w = { role = "velocity", of = "y" }
[lagrangian]
l = "(u^2 + w^2)/(2*y^2)"
[claims]
conserved = ["energy", "x + y*w/u", "y^2 + (y*w/u)^2"]
"""


def symbols_of(sample):
    """Christoffel symbols of the second kind as SymPy expressions, by ``c, a, b`` from 1."""
    setting = make_setting(sample)
    table = christoffel(mechanics(setting))
    return {
        (c + 1, a + 1, b + 1): setting.field.to_sympy(setting.field.normal(entry))
        for c, rows in enumerate(table)
        for a, row in enumerate(rows)
        for b, entry in enumerate(row)
        if entry != 0
    }


def check_symbols(found, expected):
    """The same symbols, none missing."""
    assert found.keys() == expected.keys()
    for place, text in expected.items():
        assert sympy.simplify(found[place] - sympy.sympify(text)) == 0, place


def test_2_2_4_christoffel_symbols_of_the_sphere():
    """Gamma^a_bb = -sin a cos a and Gamma^b_ab = cot a; with the other sign it is no sphere."""
    expected = {(1, 2, 2): "-sin(a)*cos(a)", (2, 1, 2): "cot(a)", (2, 2, 1): "cot(a)"}
    check_symbols(symbols_of(spec(SPHERE)), expected)
    with pytest.raises(AssertionError):
        check_symbols(symbols_of(spec(SPHERE)), {**expected, (1, 2, 2): "sin(a)*cos(a)"})


def test_2_2_4_christoffel_symbols_of_the_hyperbolic_plane():
    """Gamma^x_xy = -1/y, Gamma^y_xx = 1/y, Gamma^y_yy = -1/y."""
    expected = {(1, 1, 2): "-1/y", (1, 2, 1): "-1/y", (2, 1, 1): "1/y", (2, 2, 2): "-1/y"}
    check_symbols(symbols_of(spec(PLANE)), expected)


def test_2_2_4_the_first_kind_is_half_the_slopes_of_the_metric():
    """Gamma_abb = -sin a cos a and Gamma_bab = sin a cos a on the sphere."""
    setting = make_setting(spec(SPHERE))
    table, field = christoffel_first(mechanics(setting)), setting.field
    product = sympy.sin(sympy.Symbol("a")) * sympy.cos(sympy.Symbol("a"))
    assert field.to_sympy(table[0][1][1]) + product == 0
    assert field.to_sympy(table[1][0][1]) - product == 0


@pytest.mark.parametrize("text", [SPHERE, PLANE], ids=["sphere", "plane"])
def test_2_2_4_motion_is_the_geodesic_equation(text):
    """dv_c/dt = -Gamma^c_ab v_a v_b."""
    equations, symbols = derive(spec(text)), symbols_of(spec(text))
    v = sympy.symbols("u w")
    for c, found in enumerate(equations.rates[2:], 1):
        expected = -sum(g * v[a - 1] * v[b - 1] for (k, a, b), g in symbols.items() if k == c)
        assert found != 0
        assert sympy.simplify(found - expected) == 0


def test_2_2_4_geodesics_of_the_sphere_are_great_circles():
    """J = x cross dx/dt is constant, and x . J = 0: a plane through the centre cuts the sphere."""
    check_proved(spec(SPHERE), "J1 is conserved", "J2 is conserved", "J3 is conserved")
    found = derive(spec(SPHERE)).observables
    a, b = sympy.symbols("a b")
    x = (sympy.sin(a) * sympy.cos(b), sympy.sin(a) * sympy.sin(b), sympy.cos(a))
    assert sympy.simplify(sum(c * found[f"J{n}"] for n, c in enumerate(x, 1))) == 0
    wrong = spec(SPHERE, ('J1 = "-sin(b)*u -', 'J1 = "-sin(b)*u +'))
    assert "J1 is conserved" in refuted(wrong)


def test_2_2_4_geodesics_of_the_hyperbolic_plane_are_half_circles():
    """Their centre on the axis and their radius are constant; with the other sign they are not."""
    check_proved(spec(PLANE), "x + y*w/u is conserved", "y^2 + (y*w/u)^2 is conserved")
    assert refuted(spec(PLANE, ("x + y*w/u", "x - y*w/u"))) == [
        "x - y*w/u is conserved",
        "the flow of x - y*w/u takes motions to motions, a hidden symmetry: its flow is not a "
        "transformation of positions alone",
    ]


# -- 2.5 Hamilton ----------------------------------------------------------------------------------

OSCILLATORS = """
title = "Two coupled masses"
routes = ["euler-lagrange", "canonical"]
[variables]
q = { role = "coordinate", shape = [2] }
v = { role = "velocity", of = "q" }
p = { role = "momentum", of = "q" }
[parameters]
m = { positive = true, default = 2 }
k = { default = 1 }
[lagrangian]
l = "m*v1^2/2 + v1*v2/2 + v2^2/2 + k*v1 - k*q1*q2"
[hamiltonian]
h = "((p1 - k)^2 - (p1 - k)*p2 + m*p2^2)/(2*(m - 1/4)) + k*q1*q2"
"""
BACK = "p . v - h(p), at v = dh/dp, is l on the route canonical"


def test_2_5_the_legendre_transform_leads_there_and_back():
    """H of l, typed by hand, and l of h: both are what was declared."""
    sample = spec(OSCILLATORS)
    there = "h(dl/dxi) = <dl/dxi, xi> - l on the route canonical"
    check_proved(sample, there, BACK, "dh/dmu = xi on the route canonical")
    for change in (("m*p2^2", "p2^2"), ("(p1 - k)^2", "(p1 + k)^2"), ("+ k*q1*q2", "- k*q1*q2")):
        found = refuted(spec(OSCILLATORS, change))
        assert {there, BACK} <= set(found)


def test_2_5_without_a_hamiltonian_the_transform_of_l_is_taken():
    """The derived h equals the one typed by hand."""
    text = OSCILLATORS[: OSCILLATORS.index("[hamiltonian]")]
    check_proved(spec(text), BACK)
    p1, p2, q1, q2, m, k = sympy.symbols("p1 p2 q1 q2 m k")
    quarter = sympy.Rational(1, 4)
    h = ((p1 - k) ** 2 - (p1 - k) * p2 + m * p2**2) / (2 * (m - quarter)) + k * q1 * q2
    assert sympy.cancel(derive(spec(text), "canonical").energy - h) == 0


SO3 = """
title = "Rigid body on T*SO(3)"
routes = ["canonical", "poisson"]
[poisson]
canonical = [["O", "P"]]
[variables]
O = { role = "coordinate", shape = [9], form = "matrix" }
P = { role = "coordinate", shape = [9], form = "matrix" }
[parameters]
I = { shape = [3], positive = true }
[definitions]
N = "transpose(O)*P"
a = "N[3, 2] - N[2, 3]"
b = "N[1, 3] - N[3, 1]"
c = "N[2, 1] - N[1, 2]"
[hamiltonian]
h = "a^2/(2*I1) + b^2/(2*I2) + c^2/(2*I3)"
[symmetries.J]
algebra = "so(3)"
vector = "xi"
generators = { O = "hat(xi)*O" }
[observables]
x = "a"
y = "b"
z = "c"
[claims]
conserved = ["energy", "J", "O*transpose(O)"]
[claims.brackets]
"{x, y}" = "-z"
"{y, z}" = "-x"
"{z, x}" = "-y"
"{x, energy}" = "b*c/I3 - c*b/I2"
"{y, energy}" = "c*a/I1 - a*c/I3"
"{z, energy}" = "a*b/I2 - b*a/I1"
"""


def test_2_5_exercise_left_invariant_motion_on_rotations_reduces_to_euler():
    """Pi of O^T P obeys dPi/dt = Pi x Omega and the minus bracket; J = spatial momentum is kept."""
    proved = ("{x, y} = -z", "{x, energy} = b*c/I3 - c*b/I2", "J is conserved")
    check_proved(spec(SO3), *proved, "O*transpose(O) is conserved")
    assert refuted(spec(SO3, ('"{x, y}" = "-z"', '"{x, y}" = "z"'))) == ["{x, y} = z"]
    wrong = spec(SO3, ("b*c/I3 - c*b/I2", "c*b/I2 - b*c/I3"))
    assert refuted(wrong) == ["{x, energy} = c*b/I2 - b*c/I3"]


# -- 3.1.4 alignment -------------------------------------------------------------------------------

FORCED = """
title = "A point under forces along and across"
routes = ["newton", "alignment"]
[variables]
r = { role = "coordinate", shape = [3] }
v = { role = "velocity", of = "r" }
[parameters]
k = {}
B = { shape = [3] }
[newton]
r = { mass = "2", force = "k*r + cross(v, B)" }
"""


def test_3_1_4_alignment_obeys_the_riccati_equation():
    """Alpha' = beta - alpha^2 + chi . chi and chi' = psi - 2 alpha chi, F typed by hand."""
    check_proved(spec(FORCED), "the route alignment keeps chi . r = 0")
    equations = derive(spec(FORCED), "alignment")
    r, B = (sympy.Matrix(sympy.symbols(f"{name}1:4")) for name in "rB")
    chi, (alpha, k) = sympy.Matrix(sympy.symbols("chi1:4")), sympy.symbols("alpha k")
    v = alpha * r + chi.cross(r)
    F = (k * r + v.cross(B)) / 2
    beta, psi = r.dot(F) / r.dot(r), r.cross(F) / r.dot(r)
    expected = [*v, beta - alpha**2 + chi.dot(chi), *(psi - 2 * alpha * chi)]
    assert len(equations.rates) == len(expected) == 7
    for found, value in zip(equations.rates, expected, strict=True):
        assert sympy.cancel(found - value) == 0
    for spoiled in (alpha**2 + chi.dot(chi), -(alpha**2) - chi.dot(chi)):
        assert sympy.cancel(equations.rates[3] - beta - spoiled) != 0


# -- 3.1.5 Kepler and the monopole -----------------------------------------------------------------


def test_3_1_5_integrals_of_kepler_and_their_brackets():
    """{L, L} = L, {L, A} = A, {A, A} = -2E L with eps_ijk; the other sign of E is refuted."""
    brackets = ("{L, L} = -hat(L)", "{L, A} = -hat(A)", "{A, A} = 2*energy*hat(L)")
    check_proved(spec(text_of("kepler")), "A is conserved", *brackets)
    wrong = spec(text_of("kepler"), ('"2*energy*hat(L)"', '"-2*energy*hat(L)"'))
    assert refuted(wrong) == ["{A, A} = -2*energy*hat(L)"]


def test_3_1_5_the_orbit_is_a_conic_section():
    """R . A = L^2 - mu |r|, A . L = 0 and A^2 = mu^2 + 2 E L^2 follow from the definitions."""
    found = derive(spec(text_of("kepler"))).observables
    r = sympy.Matrix(sympy.symbols("r1:4"))
    L, A = (sympy.Matrix([found[f"{name}{n}"] for n in "123"]) for name in "LA")
    mu, d = sympy.Symbol("mu"), sympy.sqrt(r.dot(r))
    assert sympy.simplify(r.dot(A) - (L.dot(L) - mu * d)) == 0
    assert sympy.simplify(A.dot(L)) == 0
    assert sympy.simplify(A.dot(A) - mu**2 - 2 * found["energy"] * L.dot(L)) == 0


def test_3_1_5_a_repelling_force_is_another_motion():
    """With the sign of the force turned every equality of routes is refuted."""
    found = refuted(spec(text_of("kepler"), ('force = "-mu*r', 'force = "mu*r')))
    assert "poisson and newton give the same motion" in found
    assert any(statement.startswith("poisson and alignment") for statement in found)


def test_3_1_39_integrals_of_the_monopole_and_their_brackets():
    """P = L - lam r/|r|; with the other sign neither P is conserved nor A."""
    brackets = ("{P, P} = -hat(P)", "{P, A} = -hat(A)", "{A, A} = 2*energy*hat(P)")
    sample = spec(text_of("monopole_kepler"))
    check_proved(sample, "P is conserved", "A is conserved", "dot(L, L) is conserved", *brackets)
    wrong = spec(text_of("monopole_kepler"), ("cross(r, v) - lam*r", "cross(r, v) + lam*r"))
    assert {"P is conserved", "A is conserved", "{P, P} = -hat(P)"} <= set(refuted(wrong))
    claimed = spec(text_of("monopole_kepler"), ('"energy", "P"', '"energy", "L"'))
    assert "L is conserved" in refuted(claimed)  # only its length is


def test_3_1_39_the_other_sign_of_the_magnetic_bracket_is_another_motion():
    """{v_i, v_j} = -lam eps_ijk r_k/r^3 does not give equation 3.1.39."""
    changes = [(f'"lam*r{n}/norm', f'"-lam*r{n}/norm') for n in "123"]
    found = refuted(spec(text_of("monopole_kepler"), *changes))
    assert "poisson and newton give the same motion" in found


def test_3_1_39_without_monopole_it_is_kepler():
    """Lam = 0 gives the rates, the energy, L and A of Kepler's problem."""
    monopole, kepler = (derive(spec(text_of(name))) for name in ("monopole_kepler", "kepler"))
    off = {sympy.Symbol("lam"): 0}
    assert [sympy.simplify(rate.xreplace(off)) for rate in monopole.rates] == [
        sympy.simplify(rate) for rate in kepler.rates
    ]
    for name in ("energy", *(f"{letter}{n}" for letter in "LA" for n in "123")):
        difference = monopole.observables[name].xreplace(off) - kepler.observables[name]
        assert sympy.simplify(difference) == 0
    P, L = (monopole.observables[f"{name}1"] for name in "PL")
    assert sympy.simplify(P.xreplace(off) - L) == 0
    assert P != L


DIRAC = """
title = "Monopole with a Dirac string"
routes = ["euler-lagrange", "newton"]
[variables]
r = { role = "coordinate", shape = [3] }
v = { role = "velocity", of = "r" }
[parameters]
mu = { default = 1 }
lam = { default = 1 }
[lagrangian]
l = '''dot(v, v)/2 + lam*(r1*v2 - r2*v1)/(norm(r)*(norm(r) + r3))
  + mu/norm(r) - lam^2/(2*dot(r, r))'''
[newton]
r = { force = "-lam*cross(r, v)/norm(r)^3 - (mu/norm(r)^3 - lam^2/dot(r, r)^2)*r" }
[claims.brackets]
"{r, v}" = "norm(r)*diag(r)*inverse(diag(r))/norm(r)"
"{v, v}" = "-lam*hat(r)/norm(r)^3"
"""


def test_3_1_39_a_lagrangian_with_a_dirac_string_gives_the_same_motion():
    """Curl of the potential is r/r^3: the motion, and {v_i, v_j} = lam eps_ijk r_k/r^3."""
    same = "euler-lagrange and newton give the same motion"
    check_proved(spec(DIRAC), same, "{v, v} = -lam*hat(r)/norm(r)^3")
    found = refuted(spec(DIRAC, ("+ lam*(r1*v2", "- lam*(r1*v2")))
    assert {same, "{v, v} = -lam*hat(r)/norm(r)^3"} <= set(found)


# -- 12.2.2 the rocking disk -----------------------------------------------------------------------


def test_12_2_2_the_rocking_disk():
    """(I + m(r^2 + l^2 - 2 r l cos phi)) phi'' + m r l sin(phi) phi'^2 + m g l sin(phi) = 0."""
    sample = spec(text_of("rocking_disk"))
    torque = "-m*l*sin(phi)*(r*phidot**2 + g)"
    inertia = "(I + m*(r**2 + l**2 - 2*r*l*cos(phi)))"
    check_rates(sample, ["phidot", f"{torque}/{inertia}"])
    for spoiled in (torque.replace("+ g", "- g"), torque.replace("(r*", "(2*r*")):
        with pytest.raises(AssertionError):
            check_rates(sample, ["phidot", f"{spoiled}/{inertia}"])


def test_12_2_2_small_oscillations_are_those_of_the_lowest_point():
    """omega^2 = m g l/(I + m (r - l)^2): 1 x 9.81 x 0.5 / (0.25 + 0.25) at the defaults."""
    sample = spec(text_of("rocking_disk"))
    phi, speed = sympy.symbols("phi phidot")
    slope = sympy.diff(derive(sample).rates[1], phi).subs({phi: 0, speed: 0})
    values = {sympy.Symbol(p.name): sympy.Rational(p.default[0]) for p in sample.parameters}
    assert Fraction(str(-slope.xreplace(values))) == Fraction("9.81")


def test_12_2_2_without_an_offset_the_disk_rolls_uniformly():
    """L = 0: phi'' = 0."""
    rate = derive(spec(text_of("rocking_disk"))).rates[1]
    assert rate.subs(sympy.Symbol("l"), 0) == 0
    assert rate != 0
