"""Bodies and tops by mass points, gradients and cyclic coordinates: the book's rows, then spoiled.

Holm (2011), sections 2.1.2, 2.5.4, 7.1, 7.2 and chapter 8. The formulas are typed here; a wrong
sign or ratio beside each one is refuted.
"""

from dataclasses import replace
from fractions import Fraction
from itertools import combinations

import pytest
import sympy

from coadjoint.algebra import algebra_by_name
from coadjoint.derive import derive, make_setting
from coadjoint.derive.routes.nambu import distinguished_function
from coadjoint.derive.structure import momentum_algebra, poisson_structure
from coadjoint.prove import Verdict
from coadjoint.prove.charts import ChartMap
from tests.sources.components import cross, dot, plus, times
from tests.specs import emitted, prove_claims, shipped, spec, unitless

PI, GAMMA, OMEGA = (sympy.symbols(f"{name}1:4") for name in ("Pi", "Gamma", "Omega"))
INERTIA, CHI, P, V, C = (sympy.symbols(f"{name}1:4") for name in ("I", "chi", "P", "v", "c"))
M, G = sympy.symbols("m g")
TOPS = {
    "heavy_top_lagrange": "spin",
    "heavy_top_kovalevskaya": "K",
    "heavy_top_goryachev_chaplygin": "G",
}


def same(found, expected):
    """Whether two lists of rational functions are equal."""
    pairs = zip(found, expected, strict=True)
    return all(sympy.cancel(sympy.together(a - b)) == 0 for a, b in pairs)


def in_velocities(equations):
    """Rates with the velocities as symbols, as they are written by hand."""
    field = equations.setting.field
    return [field.to_sympy(rate) for rate in equations.exact.rates]


def changed(name, *changes):
    """A shipped system with pieces of its text replaced."""
    return spec(shipped(name).path.read_text(encoding="utf-8"), *changes)


def refuted(certificate):
    """What is refuted, as one text."""
    return "\n".join(claim.statement for claim in certificate.refuted)


# -- 2.1.2: a body with a moving origin -----------------------------------------------------------

BODY = """
title = "A body whose origin is not its centre of mass"
routes = ["newton-euler", "euler-poincare", "lie-poisson"]
[algebra]
name = "se(3)"
[variables]
Omega = { role = "velocity", block = "rotation" }
v = { role = "velocity", block = "translation" }
Pi = { role = "momentum", block = "rotation" }
P = { role = "momentum", block = "translation" }
Gamma = { role = "advected", representation = "vector" }
[parameters]
I = { shape = [3], positive = true, default = [3, 4, 5] }
m = { positive = true, default = 1 }
c = { shape = [3], default = [1, 2, 3] }
g = { default = 1 }
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2 + m*dot(v, v)/2 + m*dot(v, cross(Omega, c)) - m*g*dot(Gamma, c)"
"""
FREE = (
    (" - m*g*dot(Gamma, c)", ""),
    ('Gamma = { role = "advected", representation = "vector" }', ""),
)


def newton_euler(sign):
    """``dPi/dt = Pi x Omega + P x V + T``, ``dP/dt = P x Omega``, T the moment of gravity."""
    inertia = [i * w for i, w in zip(INERTIA, OMEGA, strict=True)]
    angular = plus(inertia, times(M, cross(C, V)))
    linear = times(M, plus(V, cross(OMEGA, C)))
    torque = times(sign * M * G, cross(GAMMA, C))
    turning = plus(plus(cross(angular, OMEGA), cross(linear, V)), torque)
    return [*turning, *cross(linear, OMEGA), *cross(GAMMA, OMEGA)]


def test_2_1_2_newton_euler_about_a_body_fixed_origin():
    """Summed over mass points, and equal to the routes by algebra; gravity the other way is not."""
    equations = derive(spec(BODY))
    found = [rate.subs({}) for rate in in_velocities(equations)]
    assert same(found, newton_euler(1))
    assert not same(found, newton_euler(-1))
    assert prove_claims(spec(BODY)).holds


def test_2_1_2_a_free_body_decouples_about_its_centre_of_mass():
    """With c = 0 the spin obeys Euler's equations and P turns; with c they are coupled."""
    coupled = ("m*dot(v, cross(Omega, c))", "0*dot(v, cross(Omega, c))")
    free = derive(spec(BODY, *FREE, coupled))
    names = [free.setting.field.reach(rate) for rate in free.exact.rates[:3]]
    assert all(not {"v1", "v2", "v3"} & name for name in names)
    whole = derive(spec(BODY, *FREE))
    assert any({"v1", "v2", "v3"} & whole.setting.field.reach(r) for r in whole.exact.rates[:3])


def test_2_1_2_momenta_are_sums_over_points():
    """Points at +-e_i: I and the equations from them are those of the book, sum by sum."""
    masses = [Fraction(n, 3) for n in (1, 2, 4)]
    omega = [Fraction(2), Fraction(-3), Fraction(5)]
    moment = [0, 0, 0]
    for mass, axis in zip(masses, ([1, 0, 0], [0, 1, 0], [0, 0, 1]), strict=True):
        moment = plus(moment, times(-2 * mass, cross(axis, cross(omega, cross(omega, axis)))))
    inertia = [2 * (sum(masses) - mass) for mass in masses]
    at = dict(
        zip(
            (*INERTIA, *PI),
            [*inertia, *[i * w for i, w in zip(inertia, omega, strict=True)]],
            strict=True,
        )
    )
    rates = emitted("rigid_body", "newton-euler").rates
    assert [rate.subs(at) for rate in rates] == moment
    assert any(moment)


# -- 2.5.4: Nambu's form, found -------------------------------------------------------------------


def test_2_5_4_the_rigid_body_has_c_and_h_of_the_book():
    """The book's c = Pi . Pi/2 and h = Pi . I^-1 Pi/2 are found; the motion is grad c x grad h."""
    equations = emitted("rigid_body", "nambu")
    c = distinguished_function(equations.setting)
    field = equations.setting.field
    assert same([field.to_sympy(c.function)], [dot(PI, PI) / 2])
    assert c.multiplier == 1
    slopes = [p / i for p, i in zip(PI, INERTIA, strict=True)]
    assert same(equations.rates, cross(PI, slopes))
    assert not same(equations.rates, cross(slopes, PI))


#: Rank and signature of C in c = x . Cx/2, by the algebra: section 2.5.4, exercise.
SIGNATURES = {
    "so(3)": (3, 0),
    "so(2,1)": (2, 1),
    "sl(2,R)": (2, 1),
    "se(2)": (2, 0),
    "heisenberg": (1, 0),
    "R^3": (0, 0),
}


def on(name, more=""):
    """A free motion on the dual of an algebra."""
    return spec(
        f'title = "free"\nroutes = ["lie-poisson", "nambu"]\n[algebra]\n{name}\n[variables]\n'
        f'x = {{ role = "momentum" }}\n[hamiltonian]\nh = "x1^2/2 + x2^2 + x3^2/3 + x1*x3{more}"\n'
    )


@pytest.mark.parametrize("name", SIGNATURES)
def test_2_5_4_the_signature_of_c_names_the_algebra(name):
    """{x_i, x_j} = -epsilon_ijk C_kl x_l with C of the tabled signature, up to its sign."""
    declared = on(f'name = "{name}"')
    assert prove_claims(declared).holds
    setting = make_setting(declared)
    c = setting.field.to_sympy(distinguished_function(setting).function)
    x = [sympy.Symbol(n) for n in setting.state]
    C = sympy.hessian(c, x)
    tensor = poisson_structure(setting).tensor
    for i, j in combinations(range(3), 2):
        sign, k = (-1, 3 - i - j) if (i, j) != (0, 2) else (1, 1)
        assert same([setting.field.to_sympy(tensor[i][j])], [sign * (C * sympy.Matrix(x))[k]])
    roots = [value for value, count in C.eigenvals().items() for _ in range(count)]
    signs = sum(bool(v > 0) for v in roots), sum(bool(v < 0) for v in roots)
    assert SIGNATURES[name] in (signs, signs[::-1])


def test_2_5_4_unimodular_algebras_alone_have_c_without_a_multiplier():
    """[e3, e1] = e1, [e3, e2] = k e2: k = -1 is e(1,1), k = 2 has c = x1^2/x2 and a multiplier."""
    basis = 'basis = ["e1", "e2", "e3"]\nbrackets = { "[e3, e1]" = "e1", "[e3, e2]" = "%s*e2" }'
    found = {k: distinguished_function(make_setting(on(basis % k))) for k in ("-1", "2")}
    assert found["-1"].multiplier == 1
    assert found["2"].multiplier != 1
    for k in found:
        assert prove_claims(on(basis % k, " + x2^3")).holds


def test_2_5_4_c_and_h_may_be_mixed():
    """(a c + b h, g c + d h) with a d - b g = 1 gives the same motion; 2 gives twice it."""
    body = unitless(shipped("nambu_body").path.read_text(encoding="utf-8"))
    for last, factor in (("3", 1), ("4", 2)):
        mixed = derive(
            spec(
                body,
                ('"dot(x, x)/2"', '"dot(x, x)/2 + 2*dot(x, inverse(diag(I))*x)/2"'),
                (
                    'h = "dot(x, inverse(diag(I))*x)/2"',
                    f'h = "dot(x, x)/2 + {last}*dot(x, inverse(diag(I))*x)/2"',
                ),
                ('casimirs  = ["dot(x, x)"]', "casimirs = []"),
            )
        )
        # 1*3 - 2*1 = 1 and 1*4 - 2*1 = 2
        assert same(mixed.rates, times(factor, emitted("nambu_body").rates))


# -- 7.1 and 7.2: motions on SE(3) ----------------------------------------------------------------


def test_7_1_euler_poincare_on_se3():
    """``dmu/dt = mu x xi + beta x alpha``, ``dbeta/dt = beta x xi``; not with alpha x beta."""
    equations = emitted("kirchhoff")
    found = in_velocities(equations)
    expected = [*plus(cross(PI, OMEGA), cross(P, V)), *cross(P, OMEGA)]
    assert same(found, expected)
    assert not same(found, [*plus(cross(PI, OMEGA), cross(V, P)), *cross(P, OMEGA)])


def test_7_1_1_legendre_transform_on_se3():
    """With h = <mu, xi> + <beta, alpha> - l, velocities are dh/dmu, dh/dbeta; half of it fails."""
    statements = [
        c.statement for c in prove_claims(shipped("kirchhoff")).claims if c.kind == "legendre"
    ]
    assert "dh/dmu = xi on the route lie-poisson" in statements
    half = changed("kirchhoff", ("(diag(M)*Pi - diag(D)*P))/2", "(diag(M)*Pi - diag(D)*P))/4"))
    assert "dh/dmu = xi on the route lie-poisson" in refuted(prove_claims(half))


def test_7_2_clebsch_case_of_kirchhoff():
    """``I1 (1/M2 - 1/M3) + ... = 0`` holds for the declared masses, and F is conserved."""
    declared = shipped("kirchhoff_clebsch")
    assert prove_claims(declared).holds
    field = make_setting(declared).field
    mass = [
        sympy.diff(field.to_sympy(derive(declared).setting.formula(declared.lagrangian)), v, 2)
        for v in V
    ]
    n = [1 / m for m in mass]
    condition = sum(INERTIA[i] * (n[(i + 1) % 3] - n[(i + 2) % 3]) for i in range(3))
    assert sympy.cancel(sympy.together(condition)) == 0


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('n3 = "1/M + theta/(I1*I2)"', 'n3 = "1/M + 2*theta/(I1*I2)"'),
        ("(dot(Pi, Pi) - theta*", "(dot(Pi, Pi) + theta*"),
    ],
)
def test_7_2_clebsch_integral_needs_its_condition_and_sign(old, new):
    """Another mass along the third axis, or the other sign of theta, and F is not conserved."""
    assert "F is conserved" in refuted(prove_claims(changed("kirchhoff_clebsch", (old, new))))


def test_7_2_1_kirchhoff_and_heavy_top_share_their_bracket():
    """se(3)* by translations and by an advected vector: equal tables, P for Gamma."""
    body, top = (make_setting(shipped(name)) for name in ("kirchhoff", "heavy_top"))
    assert momentum_algebra(top).constants == algebra_by_name("se(3)").constants
    tables = []
    for setting in (body, top):
        renamed = dict(zip(map(sympy.Symbol, setting.state), [*PI, *P], strict=True))
        tensor = poisson_structure(setting).tensor
        tables.append([setting.field.to_sympy(e).xreplace(renamed) for row in tensor for e in row])
    assert tables[0] == tables[1]
    assert any(tables[0])


# -- 8: heavy tops --------------------------------------------------------------------------------


@pytest.mark.parametrize("route", ["euler-poincare", "lie-poisson", "newton-euler"])
def test_8_2_heavy_top(route):
    """``dPi/dt = Pi x Omega + m g Gamma x chi``, ``dGamma/dt = Gamma x Omega``; not chi x Gamma."""
    equations = emitted("heavy_top", route)
    omega = [p / i for p, i in zip(PI, INERTIA, strict=True)]
    turning, torque = cross(PI, omega), times(M * G, cross(GAMMA, CHI))
    assert same(equations.rates, [*plus(turning, torque), *cross(GAMMA, omega)])
    assert not same(equations.rates[:3], plus(turning, times(-1, torque)))


def test_8_1_hamiltonian_of_the_heavy_top():
    """H = Pi . I^-1 Pi/2 + m g chi . Gamma, from the Lagrangian alone."""
    energy = emitted("heavy_top").energy
    kinetic = sum(p**2 / (2 * i) for p, i in zip(PI, INERTIA, strict=True))
    assert same([energy], [kinetic + M * G * dot(CHI, GAMMA)])
    assert not same([energy], [kinetic - M * G * dot(CHI, GAMMA)])


def test_8_3_2_bracket_of_the_heavy_top():
    """{Pi_i, Pi_j} = -eps Pi_k, {Pi_i, Gamma_j} = -eps Gamma_k, {Gamma, Gamma} = 0."""
    tensor = emitted("heavy_top", "lie-poisson").poisson_tensor
    assert tensor[0, 1] == -PI[2]
    assert tensor[0, 4] == -GAMMA[2]
    assert tensor[1, 3] == GAMMA[2]
    assert tensor[3:, 3:] == sympy.zeros(3, 3)


def test_8_5_kaluza_klein_heavy_top():
    """``dPi/dt = Pi x Omega + p x Gamma``, H = T + p.p/2 - p.Gamma, and p = -m g chi."""
    equations = emitted("heavy_top", "kaluza-klein")
    p = sympy.symbols("p1:4")
    omega = [x / i for x, i in zip(PI, INERTIA, strict=True)]
    expected = [*plus(cross(PI, omega), cross(p, GAMMA)), *cross(GAMMA, omega), 0, 0, 0]
    assert same(equations.rates, expected)
    assert not same(equations.rates[:3], plus(cross(PI, omega), cross(GAMMA, p)))
    kinetic = sum(x**2 / (2 * i) for x, i in zip(PI, INERTIA, strict=True))
    assert same([equations.energy], [kinetic + dot(p, p) / 2 - dot(p, GAMMA)])
    field = equations.setting.field
    relations = [field.to_sympy(r.element) for r in equations.chart.relations]
    assert same(relations, [a + M * G * b for a, b in zip(p, CHI, strict=True)])


@pytest.mark.parametrize("sign", [1, -1])
def test_8_5_the_level_set_matters(sign):
    """With p = + m g chi the motion is another one, and the comparison says so."""
    setting = make_setting(shipped("heavy_top"))
    first, other = (
        derive(setting.spec, r, setting=setting) for r in ("lie-poisson", "kaluza-klein")
    )
    names = other.chart.variables[6:]
    flipped = {name: sign * setting.field[name] for name in names}
    relations = tuple(
        replace(relation, element=setting.field.substitute(relation.element, flipped))
        for relation in other.chart.relations
    )
    spoiled = replace(other, chart=replace(other.chart, relations=relations))
    expected = Verdict.PROVED if sign == 1 else Verdict.REFUTED
    assert ChartMap(first, spoiled).decide_related().verdict is expected


@pytest.mark.parametrize("name", TOPS)
def test_8_special_tops_have_their_integral(name):
    """The extra integral is proved, and independent of energy and Casimirs at a random point."""
    declared = shipped(name)
    assert prove_claims(declared).holds
    found = derive(declared).observables
    state = [sympy.Symbol(n) for n in derive(declared).setting.state]
    kept = [found[n] for n in ("energy", "casimir1", "casimir2", TOPS[name])]
    at = dict(zip(state, (2, 3, 5, 7, 11, 13), strict=True))
    at |= dict.fromkeys(sympy.symbols("I1 I3 m g chi"), 1)
    assert sympy.Matrix([[sympy.diff(f, x).subs(at) for x in state] for f in kept]).rank() == 4


SPOILED = {
    "another ratio of Kovalevskaya's": (
        "heavy_top_kovalevskaya",
        ("I3*(Omega1^2 + Omega2^2 + Omega3^2/2)", "I3*(Omega1^2 + Omega2^2 + Omega3^2)"),
    ),
    "the other sign of gravity": ("heavy_top_kovalevskaya", ('c = "m', 'c = "-m')),
    "Goryachev's term with the other sign": (
        "heavy_top_goryachev_chaplygin",
        ("- 4*I3*m*g*chi*Pi1", "+ 4*I3*m*g*chi*Pi1"),
    ),
    "Goryachev's integral everywhere": (
        "heavy_top_goryachev_chaplygin",
        ('{ claim = "G", where = ["dot(Pi, Gamma)"] }', '"G"'),
    ),
    "a top without symmetry": ("heavy_top_lagrange", ("I1*(Omega1^2 +", "I1*(2*Omega1^2 +")),
}


@pytest.mark.parametrize("case", SPOILED)
def test_8_special_tops_are_refuted_otherwise(case):
    """A violated ratio, sign or level set: the integral is refuted with a point."""
    name, change = SPOILED[case]
    claims = [c for c in prove_claims(changed(name, change)).refuted if c.kind == "conserved"]
    assert any(c.statement.startswith(f"{TOPS[name]} is conserved") for c in claims)
    assert all(c.counterexample for c in claims)
