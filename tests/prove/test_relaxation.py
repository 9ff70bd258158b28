"""Double and metriplectic brackets: what makes them so is proved, and wrong ones are refuted."""

import importlib
import math

import numpy as np
import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.derive.mechanics import external
from coadjoint.errors import ClaimError, SpecError
from coadjoint.exact import Condition, Field, Region
from coadjoint.prove import Verdict
from coadjoint.prove.semidefinite import decide_semidefinite
from tests.specs import RIGID_BODY, prove_claims, shipped, spec, verdicts_of

PARAMETER = ("[parameters]", "[parameters]\na = { positive = true, default = 1 }")
#: Keeps the energy (Morrison 1986): G dh = G Omega = 0.
PROJECTION = "a*(dot(Omega, Omega)*diag(vector(1, 1, 1)) - outer(Omega, Omega))"


def double(G, *changes):
    """Verdicts of a body with a double bracket."""
    return verdicts(("[claims]", f'[double_bracket]\nG = "{G}"\n[claims]'), PARAMETER, *changes)


def metriplectic(G, S="dot(Pi, Pi)/2"):
    """Verdicts of a body with a metriplectic bracket."""
    table = f'[metriplectic]\nG = "{G}"\nS = "{S}"\n[claims]'
    return verdicts(("[claims]", table), PARAMETER)


def verdicts(*changes):
    """Verdict by statement."""
    return verdicts_of(RIGID_BODY, *changes)


def test_a_double_bracket_keeps_casimirs_and_loses_energy():
    """Each condition and each law is a claim, and proved."""
    found = double("a")
    assert set(found.values()) == {Verdict.PROVED}
    assert "dh/dt = -<P dh, G P dh>: the energy never grows" in found
    assert "dot(Pi, Pi) is conserved: forces and dissipation do not change it" in found
    assert "the energy is conserved" not in found


@pytest.mark.parametrize(
    ("table", "factor", "law"),
    [
        ("[inputs]\nu = { default = 0 }", "(1 + u^2)", "grows while the inputs are constant"),
        ("[time]\nname = 't'", "(1 + t^2)", "its explicit dependence on time"),
    ],
)
def test_a_driven_double_bracket_says_what_may_change_the_energy(table, factor, law):
    """An input or time in the energy makes it grow; no sentence says that it never does."""
    kinetic = "dot(Omega, diag(I)*Omega)/2"
    found = double("a", ("[claims]", f"{table}\n[claims]"), (kinetic, f"{kinetic}*{factor}"))
    assert set(found.values()) == {Verdict.PROVED}
    assert any(law in statement for statement in found)
    assert not any(statement.endswith("never grows") for statement in found)


def test_a_metriplectic_bracket_keeps_energy_and_gains_entropy():
    """The mirror image: the energy is kept, and the Casimir S changes."""
    found = metriplectic(PROJECTION)
    assert set(found.values()) == {Verdict.PROVED}
    assert "the energy is conserved" in found
    assert "dS/dt = <dS, G dS>: the entropy never falls" in found
    assert "dot(Pi, Pi) is conserved: forces and dissipation do not change it" not in found


@pytest.mark.parametrize(
    ("G", "statement"),
    [
        ("-a", "G is positive semidefinite"),
        ("Pi1", "G is positive semidefinite"),
        ("diag(vector(a, a, -a))", "G is positive semidefinite"),
        ("hat(vector(a, 0, 0))", "G is symmetric"),
        # of the Killing form of sl(2, R), which is not compact
        ("diag(vector(8, 8, -8))", "G is positive semidefinite"),
    ],
)
def test_what_is_no_metric_is_refuted(G, statement):
    """With a point at which it is none."""
    changes = (("[claims]", f'[double_bracket]\nG = "{G}"\n[claims]'), PARAMETER)
    certificate = prove_claims(spec(RIGID_BODY, *changes))
    (claim,) = [each for each in certificate.claims if each.statement == statement]
    assert claim.verdict is Verdict.REFUTED
    assert eval_fraction(claim.defect)
    with pytest.raises(ClaimError, match="refuted"):
        certificate.require()


@pytest.mark.parametrize(
    ("G", "S", "statement"),
    [
        (PROJECTION, "Pi1^2", "P dS = 0: S is a Casimir"),
        # the matrix of the double bracket: G dS = 0, so nothing relaxes, and G dh is not zero
        ("a*(dot(Pi, Pi)*diag(vector(1, 1, 1)) - outer(Pi, Pi))", "dot(Pi, Pi)", "G dh = 0"),
        ("a", "dot(Pi, Pi)", "G dh = 0"),
    ],
)
def test_what_does_not_keep_the_energy_is_refuted(G, S, statement):
    """Wrong twins: S that is no Casimir, and a G that does not annihilate dh."""
    assert metriplectic(G, S)[statement] is Verdict.REFUTED


UNSURE = "2 + sin(Pi1) + cos(Pi1*Pi2)"


@pytest.mark.parametrize("G", ["-a", "Pi1", UNSURE, "diag(vector(a, a, -a))"])
def test_no_sign_is_said_where_that_of_the_metric_is_not_proved(G):
    """A law whose terms have no proved sign is a law all the same, and says no more."""
    for found in (double(G), metriplectic(f"({G})*({PROJECTION})" if "diag" not in G else G)):
        said = " ".join(found)
        assert found["G is positive semidefinite"] is not Verdict.PROVED
        assert "dh/dt = -<P dh, G P dh>" in found or "dS/dt = <dS, G dS>" in found
        assert "never" not in said


def test_support_for_a_metric_is_no_proof_that_the_energy_falls():
    """Also where the spec accepts it: no sentence of the certificate says more than is proved."""
    table = f'[double_bracket]\nG = "{UNSURE}"\naccept = "numerical"\n[claims]'
    certificate = prove_claims(spec(RIGID_BODY, ("[claims]", table)))
    assert certificate.holds
    assert "never" not in " ".join(claim.statement for claim in certificate.claims)


def test_a_matrix_that_is_not_symmetric_is_decided_by_its_symmetric_part():
    """Principal minors of ``(1, 4; 0, 1)`` are 1, and ``v.Gv = x^2 + 4xy + y^2`` has no sign."""
    field = Field(["q"])
    one, zero = field.one, field.zero
    found = decide_semidefinite([[one, 4 * one], [zero, one]], field)
    assert found.verdict is Verdict.REFUTED
    assert float(eval_fraction(found.defect)) == pytest.approx(-1)  # 1 - 4/2, by hand
    assert decide_semidefinite([[one, one], [-one, one]], field).verdict is Verdict.PROVED


@pytest.mark.parametrize("spoil", [-1, 2, 0])
def test_a_spoiled_double_bracket_is_caught(spoil, monkeypatch):
    """The laws come from bracket, G and h, not from what the routes have added."""
    relaxed = external.relaxed_rates
    monkeypatch.setattr(external, "relaxed_rates", lambda free: [spoil * x for x in relaxed(free)])
    found = double("a")
    assert found["the rates are {x, h} + P G P dh"] is Verdict.REFUTED
    assert found["dh/dt = -<P dh, G P dh>: the energy never grows"] is Verdict.REFUTED


def test_a_matrix_is_semidefinite_by_its_minors():
    """``(1, q; q, q^2)`` is, ``(1, q; q, q)`` is not; with q >= 1 in the domain it is again."""
    field = Field(["q"])
    q, one = field["q"], field.one
    assert decide_semidefinite([[one, q], [q, q * q]], field).verdict is Verdict.PROVED
    refuted = decide_semidefinite([[one, q], [q, q]], field)
    assert refuted.verdict is Verdict.REFUTED
    value = float(eval_fraction(refuted.point["q"]))
    least = (1 + value - math.hypot(1 - value, 2 * value)) / 2  # of the 2 x 2 matrix, by hand
    assert float(refuted.defect) == pytest.approx(least)
    field.region = Region(frozenset(), {}, (Condition(q - 1, strict=False),))
    assert decide_semidefinite([[q, q], [q, q * q]], field).verdict is Verdict.PROVED


def eval_fraction(text):
    """A fraction as a number."""
    top, _, bottom = text.partition("/")
    return float(top) / float(bottom or 1)


def test_a_matrix_that_nobody_can_decide_is_only_supported():
    """``exp(q) - 1 - q`` is never negative, which no sum of squares shows."""
    field = Field(["q"], slots=1)
    q = field["q"]
    found = decide_semidefinite([[field.call("exp", q) - 1 - q]], field)
    assert found.verdict is Verdict.SUPPORTED
    assert "20" in found.method


def test_support_may_be_accepted():
    """Only where the spec says so."""
    G = 'G = "exp(Pi1) - 1 - Pi1"'
    table = f"[double_bracket]\n{G}\n[claims]"
    assert not prove_claims(spec(RIGID_BODY, ("[claims]", table))).holds
    accepted = table.replace(G, f'{G}\naccept = "numerical"')
    assert prove_claims(spec(RIGID_BODY, ("[claims]", accepted))).holds


REFUSED = [
    ('[double_bracket]\nG = "1"\n[metriplectic]\nG = "1"\nS = "Pi1"', "one of them"),
    ('[double_bracket]\nG = "vector(1, 2)"', "3 x 3 matrix"),
    ('[double_bracket]\nS = "1"', "unknown key 'S'"),
    ('[metriplectic]\nG = "1"\nS = "Pi"', "a scalar"),
    ('[metriplectic]\nG = "1"\nS = "dot(Omega, Omega)"', "'Omega' is a velocity"),
]


@pytest.mark.parametrize(("table", "message"), REFUSED)
def test_what_cannot_be_read_is_refused(table, message):
    """Before any work, at its place."""
    with pytest.raises(SpecError) as caught:
        spec(RIGID_BODY, ("[claims]", f"{table}\n[claims]"))
    assert message in str(caught.value)


def test_a_route_that_knows_no_bracket_is_refused():
    """With one that does."""
    table = ("[claims]", '[double_bracket]\nG = "1"\n[claims]')
    refusal = r"the route clebsch does not accept \[double_bracket\]"
    with pytest.raises(SpecError, match=refusal) as caught:
        spec(RIGID_BODY, table, ('"lie-poisson"]', '"clebsch"]'))
    assert 'Remove "clebsch"' in str(caught.value)


def test_a_spin_falls_into_the_field_as_landau_and_lifshitz_have_it():
    """``tan(theta/2)`` falls like ``exp(-lambda B t)`` and phi turns by ``gamma' B t``."""
    spin = importlib.import_module("coadjoint.systems.landau_lifshitz_gilbert")
    gamma, alpha, B, start = 2.0, 0.3, 1.5, 2.0
    state = [math.sin(start), 0, math.cos(start)]
    parameters = {"gamma": gamma, "alpha": alpha, "B": [0, 0, B], "K": 0}
    times = np.linspace(0, 3, 31)
    found = spin.simulate(state, (0, 3), parameters, samples=31)
    slower = gamma / (1 + alpha**2)
    theta = 2 * np.arctan(math.tan(start / 2) * np.exp(-alpha * slower * B * times))
    assert np.allclose(found["m3"], np.cos(theta), atol=1e-8)
    assert np.allclose(found["m1"], np.sin(theta) * np.cos(slower * B * times), atol=1e-8)
    assert set(found.drift) == {"casimir1"}


def test_a_body_falls_onto_its_largest_axis():
    """With I2 = I3: ``tan(theta) = tan(theta0) exp(-alpha Pi^2 (1/I2 - 1/I1) t)``."""
    body = importlib.import_module("coadjoint.systems.double_bracket_body")
    inertia, alpha, size, start = [3.0, 1.0, 1.0], 0.2, 2.0, 1.0
    state = [size * math.cos(start), size * math.sin(start), 0]
    times = np.linspace(0, 2, 21)
    found = body.simulate(state, (0, 2), {"I": inertia, "alpha": alpha}, samples=21)
    rate = alpha * size**2 * (1 / inertia[1] - 1 / inertia[0])
    theta = np.arctan(math.tan(start) * np.exp(-rate * times))
    assert np.allclose(found["Pi1"], size * np.cos(theta), atol=1e-8)


def relax_top(times, inertia, alpha, omega):
    """``(L1, L2, L3)`` of a top with the moments (I, I, J) by the closed form of its relaxation.

    ``dL/dt = L x omega + alpha omega x (L x omega)`` keeps ``2E = I (w1^2 + w2^2) + J w3^2``, so
    that ``u = w3^2`` follows Verhulst's equation ``du/dt = rate u (1 - u/U)`` with ``U = 2E/J`` and
    ``rate = 4 E alpha (J - I)/(I J)``; omega precesses by the angle ``(J - I)/I`` times that of w3.
    """
    one, other = inertia
    double = one * (omega[0] ** 2 + omega[1] ** 2) + other * omega[2] ** 2
    rate, full = 2 * double * alpha * (other - one) / (one * other), math.sqrt(double / other)
    left = (full / omega[2]) ** 2 - 1
    along = full / np.sqrt(1 + left * np.exp(-rate * times))
    grown = np.arcsinh(np.exp(rate * times / 2) / math.sqrt(left))
    turned = full * 2 / rate * (grown - math.asinh(1 / math.sqrt(left)))
    angle = math.atan2(omega[1], omega[0]) + (other - one) / one * turned
    across = np.sqrt(np.maximum(double - other * along**2, 0) / one)
    return np.array([one * across * np.cos(angle), one * across * np.sin(angle), other * along])


@pytest.mark.parametrize("method", [{}, {"method": "metriplectic_gradient", "step": 2.0**-7}])
@pytest.mark.parametrize("inertia", [(1.0, 2.5), (2.5, 1.0)])
def test_a_top_relaxes_by_its_closed_form(method, inertia):
    """To rotation about the axis where it is largest, or away from it where it is smallest."""
    body = importlib.import_module("coadjoint.systems.metriplectic_body")
    alpha, omega, times = 0.2, np.array([0.6, -0.3, 0.5]), np.linspace(0, 8, 33)
    moments = [inertia[0], *inertia]
    found = body.simulate(
        moments * omega, (0, 8), {"I": moments, "alpha": alpha}, samples=33, **method
    )
    expected = relax_top(times, inertia, alpha, omega)
    assert np.abs(expected[:, -1] - expected[:, 0]).max() > 0.3
    assert np.abs(found.state - expected).max() < (1e-4 if method else 1e-8)
    wrong = relax_top(times, inertia, 1.01 * alpha, omega)
    assert np.abs(found.state - wrong).max() > 1e-3


def test_a_body_relaxes_to_its_largest_moment_at_constant_energy():
    """The momentum ends at ``sqrt(2 E I3)`` along the third axis; its square grows as it should."""
    body = importlib.import_module("coadjoint.systems.metriplectic_body")
    found = body.simulate([1.0, 0.2, 0.1], (0, 400), method="gauss4", step=0.25, samples=1601)
    energy, end = 1 / 2 + 0.2**2 / 4 + 0.1**2 / 6, found.state[:, -1]
    assert np.abs(body.energy(found.state) - energy).max() < 1e-14
    assert np.abs(end[:2]).max() < 1e-6
    assert abs(end[2]) == pytest.approx(math.sqrt(2 * energy * 3), rel=1e-12)
    assert (np.diff((found.state**2).sum(0)) > -1e-14).all()
    assert "casimir1" not in found.drift
    L = found.state
    omega = L / np.array([[1.0], [2.0], [3.0]])
    produced = 0.1 * (np.cross(L, omega, axis=0) ** 2).sum(0)  # alpha |L x omega|^2
    assert np.allclose((L * body.rhs(L)).sum(0), produced, rtol=1e-12, atol=1e-15)


def test_shipped_motions_name_what_they_lose():
    """The heads of generated files and the certificate agree."""
    found = {c.statement for c in prove_claims(shipped("landau_lifshitz_gilbert")).claims}
    assert "dh/dt = -<P dh, G P dh>: the energy never grows" in found


#: A particle in a potential, whose phase space has a canonical bracket.
PARTICLE = """
title = "Particle in a quartic potential"
routes = ["canonical", "euler-lagrange"]
[variables]
q = { role = "coordinate", shape = [2] }
v = { role = "velocity", of = "q" }
p = { role = "momentum", of = "q" }
[parameters]
m = { positive = true, default = 2 }
k = { positive = true, default = 1 }
a = { positive = true, default = "0.1" }
[lagrangian]
l = "m*dot(v, v)/2 - k*dot(q, q)^2/4"
[double_bracket]
G = "a"
"""
#: Friction c v that heats a bath of the temperature T by c v^2.
HEATING = """
title = "Oscillator that heats a bath"
routes = ["canonical", "poisson"]
[poisson]
canonical = [["q", "p"]]
[variables]
q = { role = "coordinate" }
p = { role = "coordinate" }
s = { role = "coordinate" }
[parameters]
m = { positive = true, default = 1 }
k = { positive = true, default = 1 }
T = { positive = true, default = 300 }
c = { positive = true, default = "0.1" }
[hamiltonian]
h = "p^2/(2*m) + k*q^2/2 + T*s"
[metriplectic]
S = "s"
G = "c*rows(vector(0, 0, 0), vector(0, T, -p/m), vector(0, -p/m, p^2/(m^2*T)))"
[claims]
casimirs = ["s"]
conserved = ["energy"]
"""
ON_POSITIONS = ('G = "a"', 'G = "diag(vector(a, a, 0, 0))"')


def rates(text, *changes):
    """The rates by every route, as text, which must agree."""
    declared = spec(text, *changes)
    (found,) = {tuple(derive(declared, route).rates) for route in declared.routes}
    return found


@pytest.mark.parametrize(
    ("change", "descends"),
    [((), 1), ((ON_POSITIONS,), 0)],
    ids=["all", "positions"],
)
def test_a_double_bracket_on_a_canonical_phase_space(change, descends):
    """With G = a it descends the energy; with G on positions alone it is friction -a v."""
    q1, q2, p1, p2, m, k, a = sympy.symbols("q1 q2 p1 p2 m k a")
    down = [k * (q1**2 + q2**2) * q for q in (q1, q2)]
    along = [p / m - descends * a * f for p, f in zip((p1, p2), down, strict=True)]
    across = [-f - a * p / m for p, f in zip((p1, p2), down, strict=True)]
    for found, expected in zip(rates(PARTICLE, *change), (*along, *across), strict=True):
        assert sympy.simplify(found - expected) == 0
    found = verdicts_of(PARTICLE, *change)
    assert set(found.values()) == {Verdict.PROVED}
    law = "dh/dt = -<P dh, G P dh>: the energy never grows"
    same = "canonical and euler-lagrange give the same motion, through the Legendre transform"
    assert {law, same} <= set(found)


def test_friction_is_a_double_bracket_on_positions():
    """The same equations as Rayleigh's function gives, which is another road to them."""
    rayleigh = ('[double_bracket]\nG = "a"', '[dissipation]\nR = "a*dot(v, v)/2"')
    pairs = zip(rates(PARTICLE, ON_POSITIONS), rates(PARTICLE, rayleigh), strict=True)
    assert all(sympy.simplify(a - b) == 0 for a, b in pairs)


@pytest.mark.parametrize(
    "bracket", [(), (('canonical = [["q", "p"]]', 'brackets = { "{q, p}" = "1" }'),)]
)
def test_friction_heats_a_bath(bracket):
    """The energy is kept, entropy grows by ``c v^2/T``; a variable of its own holds it."""
    changes = (*bracket, *([('"canonical", "poisson"', '"poisson"')] if bracket else []))
    q, p, m, k, T, c = sympy.symbols("q p m k T c")
    expected = p / m, -k * q - c * p / m, c * (p / m) ** 2 / T
    for found, typed in zip(rates(HEATING, *changes), expected, strict=True):
        assert sympy.simplify(found - typed) == 0
    found = verdicts_of(HEATING, *changes)
    assert set(found.values()) == {Verdict.PROVED}
    assert {"the energy is conserved", "dS/dt = <dS, G dS>: the entropy never falls"} <= set(found)


@pytest.mark.parametrize(
    ("change", "statement"),
    [
        (("vector(0, -p/m, p^2/(m^2*T))", "vector(0, 0, p^2/(m^2*T))"), "G is symmetric"),
        (("p^2/(m^2*T)", "p^2/(2*m^2*T)"), "G is positive semidefinite"),
        (("c*rows", "-c*rows"), "G is positive semidefinite"),
        (("T*s", "2*T*s"), "G dh = 0"),
        (('S = "s"', 'S = "s + q"'), "P dS = 0: S is a Casimir"),
    ],
)
def test_wrong_baths_are_refuted(change, statement):
    """Each condition can fail."""
    assert verdicts_of(HEATING, change)[statement] is Verdict.REFUTED


@pytest.mark.parametrize("spoil", [-1, 2, 0])
@pytest.mark.parametrize(
    ("text", "laws"),
    [
        (
            PARTICLE,
            (
                "the rates are {x, h} + P G P dh",
                "dh/dt = -<P dh, G P dh>: the energy never grows",
            ),
        ),
        (HEATING, ("the rates are {x, h} + G dS",)),
    ],
)
def test_spoiled_brackets_on_phase_spaces_are_caught(text, laws, spoil, monkeypatch):
    """On every route, since they share what is added; the claims take it from the spec."""
    relaxed = external.relaxed_rates
    monkeypatch.setattr(external, "relaxed_rates", lambda free: [spoil * x for x in relaxed(free)])
    found = verdicts_of(text)
    assert all(found[law] is Verdict.REFUTED for law in laws)


def test_velocities_in_place_of_momenta_have_a_double_bracket_of_their_own():
    """G has a row for each component of the state, so that with v = p/m it is another metric."""
    momenta = 'p = { role = "momentum", of = "q" }\n'
    found = verdicts_of(
        PARTICLE.replace(momenta, "").replace('"canonical", "euler-lagrange"', '"euler-lagrange"')
    )
    assert found["the rates are {x, h} + P G P dh"] is Verdict.PROVED


def test_a_coordinate_without_a_partner_is_moved_by_more_than_the_bracket():
    """By [metriplectic] as above, or a force; else it would be constant."""
    alone = HEATING.replace("[metriplectic]", "[claims]").partition("[claims]")[0]
    with pytest.raises(SpecError, match=r"in no pair.*let a force or \[metriplectic\] move it"):
        spec(alone)
    c, p, m = sympy.symbols("c p m")
    found = rates(f'{alone}[forces]\ns = "c*p"\np = "-c*p/m"\n')
    assert found[2] == c * p
    assert sympy.simplify(found[1] + sympy.Symbol("k") * sympy.Symbol("q") + c * p / m) == 0
