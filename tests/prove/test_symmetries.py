"""Symmetries of integrals, of configuration spaces, and what has no bracket."""

import pytest
import sympy

from coadjoint.derive import Equations, derive
from coadjoint.errors import DerivationError
from tests.specs import prove_claims, spec

KEPLER = """
title = "Kepler"
routes = ["poisson"]
[poisson]
canonical = [["r", "v"]]
[variables]
r = { role = "coordinate", shape = [3] }
v = { role = "coordinate", shape = [3] }
[parameters]
mu = { positive = true, default = 1 }
lam = { default = 1 }
[hamiltonian]
h = "dot(v, v)/2 - mu/norm(r)"
[observables]
A = "cross(v, cross(r, v)) - mu*r/norm(r)"
[symmetries.L]
algebra    = "so(3)"
vector     = "xi"
generators = { r = "cross(xi, r)" }
[transformations.reversal]
map           = { v = "-v" }
reverses_time = true
exchanges     = { L = "-L", A = "A" }
[claims]
conserved = ["energy", "L", "A"]
[claims.brackets]
"{L, A}" = "-hat(A)"
"{A, A}" = "2*energy*hat(L)"
"""
MONOPOLE = (
    (
        '[["r", "v"]]',
        '[["r", "v"]]\nmagnetic = { "{v1, v2}" = "lam*r3/norm(r)^3", '
        '"{v2, v3}" = "lam*r1/norm(r)^3", "{v3, v1}" = "lam*r2/norm(r)^3" }',
    ),
    ('mu/norm(r)"\n[obs', 'mu/norm(r) + lam^2/(2*dot(r, r))"\n[obs'),
    ("cross(v, cross(r, v)) -", "cross(v, cross(r, v) - lam*r/norm(r)) -"),
    (
        '{ r = "cross(xi, r)" }',
        '{ r = "cross(xi, r)", v = "cross(xi, v)" }\nmap = "dot(cross(r, v) - lam*r/norm(r), xi)"',
    ),
)
#: The monopole force is odd in v: reversal fails, which is not the question here.
WITHOUT_REVERSAL = (
    '[transformations.reversal]\nmap           = { v = "-v" }\nreverses_time = true\n'
    'exchanges     = { L = "-L", A = "A" }\n',
    "",
)


def statements(certificate):
    """What is claimed."""
    return [claim.statement for claim in certificate.claims]


def test_the_eccentricity_vector_is_a_hidden_symmetry():
    """L comes from turning positions; the flow of A commutes with the motion, and moves q by p."""
    found = statements(prove_claims(spec(KEPLER)).require())
    assert "the flow of L takes motions to motions, a transformation of positions" in found
    hidden = "a hidden symmetry: its flow is not a transformation of positions alone"
    assert f"the flow of A takes motions to motions, {hidden}" in found
    assert "reversal takes the motion to its reverse" in found


@pytest.mark.parametrize(
    ("change", "culprit"),
    [
        (('"2*energy*hat(L)"', '"-2*energy*hat(L)"'), "{A, A} = -2*energy*hat(L)"),
        (('mu/norm(r)"\n[obs', 'mu/dot(r, r)"\n[obs'), "the flow of A takes motions to motions"),
        (('A = "A" }', 'A = "-A" }'), "reversal takes A to -A"),
        (("reverses_time = true", ""), "reversal takes the motion to itself"),
    ],
)
def test_a_wrong_claim_is_refuted(change, culprit):
    """A sign of {A, A}, another force, and what reversal does to A are seen."""
    refuted = [claim.statement for claim in prove_claims(spec(KEPLER, change)).refuted]
    assert any(culprit in statement for statement in refuted), refuted


def test_the_monopole_has_a_declared_map():
    """L - lam r/|r| generates rotations of r and v in the magnetic bracket, and is conserved."""
    found = statements(prove_claims(spec(KEPLER, *MONOPOLE, WITHOUT_REVERSAL)).require())
    assert "L is their momentum map: {x, L} = dx/ds" in found
    assert "L is conserved by Noether's theorem, since its flow keeps h" in found


def test_the_monopole_sees_a_wrong_sign_of_its_spin():
    """With + lam r/|r| the map does not generate the rotations of v."""
    change = ("cross(r, v) - lam*r/norm(r), xi", "cross(r, v) + lam*r/norm(r), xi")
    wrong = prove_claims(spec(KEPLER, *MONOPOLE, WITHOUT_REVERSAL, change))
    assert "L is their momentum map: {x, L} = dx/ds" in statements_of_refuted(wrong)


def statements_of_refuted(certificate):
    """What is refuted."""
    return [claim.statement for claim in certificate.refuted]


def test_a_map_that_cannot_be_found_is_asked_for():
    """Rotations of r and v with the square root of a monopole need a declared map."""
    text = ('\nmap = "dot(cross(r, v) - lam*r/norm(r), xi)"', "")
    with pytest.raises(DerivationError, match=r"symmetries.L|generators.r") as caught:
        prove_claims(spec(KEPLER, *MONOPOLE, WITHOUT_REVERSAL, text))
    assert "expected the momentum map together with it" in str(caught.value)


def test_a_generator_that_leaves_the_form_is_refused():
    """A symmetric S cannot move by A S."""
    text = KEPLER.replace("shape = [3] }", 'shape = [3], form = "symmetric" }', 2)
    text = text.replace("dot(v, v)/2 - mu/norm(r)", "trace(v*v)/2 + mu*det(r) + lam")
    text = text[: text.index("[observables]")] + (
        '[symmetries.J]\nalgebra = "gl(2,R)"\nmatrix = "B"\ngenerators = { r = "B*r" }\n'
    )
    with pytest.raises(DerivationError, match=r"generators.r: the value is not symmetric"):
        prove_claims(spec(text))


#: A charge in the field B w: its state is (q, v), or (q, p) with a momentum declared.
CHARGE = """
title = "charge"
routes = ["euler-lagrange"]
[variables]
q = { role = "coordinate", shape = [3] }
v = { role = "velocity", of = "q" }
[parameters]
m = { positive = true, default = 1 }
w = { shape = [3], default = [0, 0, 1] }
B = { default = 1 }
[lagrangian]
l = "m*dot(v, v)/2 + B*dot(v, cross(w, q))/2 - dot(q, q)^2"
[symmetries.J]
algebra    = "so(2)"
vector     = "phi"
generators = { q = "phi*cross(w, q)" }
[claims]
conserved = ["J"]
"""
WITH_MOMENTUM = (
    ('routes = ["euler-lagrange"]', 'routes = ["canonical"]'),
    ("[parameters]", 'p = { role = "momentum", of = "q" }\n[parameters]'),
)


@pytest.mark.parametrize("changes", [(), WITH_MOMENTUM], ids=["velocities", "momenta"])
def test_noether_on_configuration_spaces(changes):
    """J = dl/dv . (w x q), in velocities m v . (w x q) + B |w x q|^2/2, in momenta p . (w x q)."""
    declared = spec(CHARGE, *changes)
    w, q, v, p = (sympy.Matrix(sympy.symbols(f"{name}1:4")) for name in "wqvp")
    m, B = sympy.symbols("m B")
    turned = w.cross(q)
    expected = p.dot(turned) if changes else m * v.dot(turned) + B * turned.dot(turned) / 2
    assert sympy.expand(derive(declared).observables["J"] - expected) == 0
    found = statements(prove_claims(declared).require())
    assert "J is their momentum map: {x, J} = dx/ds" in found
    assert "J is conserved by Noether's theorem, since its flow keeps h" in found
    assert "the flow of J takes motions to motions, a transformation of positions" in found


@pytest.mark.parametrize("changes", [(), WITH_MOMENTUM], ids=["velocities", "momenta"])
def test_noether_on_configuration_spaces_sees_a_potential(changes):
    """A potential that turns with nothing breaks the claim."""
    wrong = prove_claims(spec(CHARGE, *changes, ("dot(q, q)^2", "q1*q2")))
    assert "J is conserved" in statements_of_refuted(wrong)
    assert not any("Noether" in statement for statement in statements(wrong))


DRAGGED = """
title = "A particle in the plane, with drag and a push"
routes = ["canonical"]
[variables]
q = { role = "coordinate", shape = [2] }
p = { role = "momentum", of = "q" }
[parameters]
c = { default = 1 }
f = { default = 1 }
[hamiltonian]
h = "dot(p, p)/2 + dot(q, q)^2"
[forces]
p = "f*vector(q1, q2) - c*p"
[symmetries.J]
algebra    = "so(2)"
vector     = "s"
generators = { q = "s*vector(-q2, q1)" }
"""


def test_noether_under_forces():
    """A push away from the centre has no moment; drag takes c J, and is told with its sign."""
    found = statements(prove_claims(spec(DRAGGED)).require())
    law = {each for each in found if each.startswith("dJ/dt")}
    assert len(law) == 1
    right = law.pop().removeprefix("dJ/dt = ").removesuffix(", since its flow keeps h")
    q1, q2, p1, p2, c = sympy.symbols("q1 q2 p1 p2 c")
    assert sympy.expand(sympy.sympify(right) + c * (q1 * p2 - q2 * p1)) == 0
    free = statements(prove_claims(spec(DRAGGED, ("f*vector(q1, q2) - c*p", "f*q"))).require())
    assert f"{NOETHER} and forces and dissipation do not change it" in free


def test_a_wrong_law_of_a_momentum_map_is_refuted(monkeypatch):
    """The law is that of the emitted rates: forces that are counted twice do not fit them."""
    once = Equations.work
    monkeypatch.setattr(Equations, "work", lambda self, of: once(self, of) + once(self, of))
    assert any(
        each.startswith("dJ/dt") for each in statements_of_refuted(prove_claims(spec(DRAGGED)))
    )


#: Time moves with a shift along the first axis, which no force is along.
PLANE = """
title = "a particle in the plane"
routes = ["euler-lagrange"]
[variables]
q = { role = "coordinate", shape = [2] }
v = { role = "velocity", of = "q" }
[parameters]
m = { positive = true, default = 1 }
k = { default = 1 }
c = { default = 1 }
[lagrangian]
l = "m*(1 + q2^2)*v1^2/2 + m*v2^2/2 + m*v1*v2/3 - k*q2^2"
[symmetries.J]
algebra    = "so(2)"
vector     = "s"
generators = { q = "s*vector(1, 0)" }
time       = "c*s"
[claims]
conserved = ["J"]
"""
WITH_P = (
    ('routes = ["euler-lagrange"]', 'routes = ["canonical"]'),
    ("[parameters]", 'p = { role = "momentum", of = "q" }\n[parameters]'),
)
TURN = ("s*vector(1, 0)", "s*vector(-q2, q1)")
ROUND = ("m*(1 + q2^2)*v1^2/2 + m*v2^2/2 + m*v1*v2/3 - k*q2^2", "m*dot(v, v)/2 - k*dot(q, q)^2")
STILL = ("s*vector(1, 0)", "s*vector(0, 0)")
NOETHER = "J is conserved by Noether's theorem, since its flow keeps h"
STATES = pytest.mark.parametrize("state", [(), WITH_P], ids=["velocities", "momenta"])


@STATES
@pytest.mark.parametrize("changes", [(), (STILL,), (TURN, ROUND)], ids=["shift", "still", "turn"])
def test_noether_with_moving_time(state, changes):
    """J = <dl/dv, xi_Q> - E c, by hand, generates what is declared, and is conserved."""
    declared = spec(PLANE, *state, *changes)
    q, v, p = (sympy.Matrix(sympy.symbols(f"{name}1:3")) for name in "qvp")
    m, k, c = sympy.symbols("m k c")
    mass = sympy.Matrix([[1 + q[1] ** 2, sympy.Rational(1, 3)], [sympy.Rational(1, 3), 1]])
    potential = k * q[1] ** 2
    if ROUND in changes:
        mass, potential = sympy.eye(2), k * q.dot(q) ** 2
    momentum = p if state else m * mass * v
    velocity = mass.inv() * p / m if state else v
    moves = sympy.Matrix({(): [1, 0], (STILL,): [0, 0]}.get(changes, [-q[1], q[0]]))
    energy = momentum.dot(velocity) / 2 + potential
    expected = momentum.dot(moves) - c * energy
    assert sympy.simplify(derive(declared).observables["J"] - expected) == 0
    certificate = prove_claims(declared)
    assert certificate.holds
    assert {NOETHER, "J is their momentum map: {x, J} = dx/ds"} <= {*statements(certificate)}


@STATES
@pytest.mark.parametrize("changes", [(TURN,), (ROUND,)], ids=["turn", "shift"])
def test_moving_time_does_not_make_symmetries(state, changes):
    """Turned in a well along one axis, or shifted in a round one, J changes, and E does not."""
    wrong = prove_claims(spec(PLANE, *state, *changes))
    assert "J is conserved" in statements_of_refuted(wrong)
    assert not any("Noether" in statement for statement in statements(wrong))


@STATES
def test_a_declared_map_is_that_without_time(state):
    """<dl/dv, xi_Q> declared is J, with the part of time; twice of it moves positions twice."""
    momentum = "p1" if state else "(m*(1 + q2^2)*v1 + m*v2/3)"
    right, wrong = (('"c*s"', f'"c*s"\nmap = "{factor}s*{momentum}"') for factor in ("", "2*"))
    assert prove_claims(spec(PLANE, *state, right)).holds
    refuted = statements_of_refuted(prove_claims(spec(PLANE, *state, wrong)))
    assert "J is their momentum map: {x, J} = dx/ds" in refuted


@STATES
def test_time_may_move_by_the_place(state):
    """With tau = q2 the lift to momenta has E dtau/dq; J = p1 - E q2 is conserved by nothing."""
    local = ('"c*s"', '"s*q2"'), ('["J"]', '["energy"]')
    certificate = prove_claims(spec(PLANE, *state, *local))
    assert certificate.holds
    assert "J is their momentum map: {x, J} = dx/ds" in statements(certificate)
    assert NOETHER not in statements(certificate)


#: Shifts, boosts and time of a free motion: [b, h] = a, and {J_a, J_b} has the mass.
GALILEI = """[symmetries.J]
algebra    = { basis = ["a", "b", "h"], brackets = { "[b, h]" = "a" } }
vector     = "s"
generators = { q = "s[1]*vector(1, 0)", v = "s[2]*vector(1, 0)" }
time       = "s[3]"
[claims]
conserved = ["J1", "J3"]
"""


def boosts(state, *changes):
    """A particle that is free along the first axis, its momentum moved by m times the boost."""
    text = PLANE[: PLANE.index("[symmetries.J]")] + GALILEI
    change = ('v = "s[2]*vector(1, 0)"', 'p = "m*s[2]*vector(1, 0)"')
    force = (ROUND[0], "m*dot(v, v)/2 - k*q2^2")
    return prove_claims(spec(text, *state, force, *([change] if state else []), *changes))


@STATES
def test_boosts_have_the_mass_as_their_cocycle(state):
    """Galilei's algebra acts; J = (p1, -m q1, -E) is a map to its extension by the mass."""
    certificate = boosts(state)
    assert certificate.holds
    law = "{J_xi, J_eta} = J_[xi, eta] + Sigma(xi, eta) with the constant 2-cocycle Sigma(a, b) = m"
    assert law in statements(certificate)
    assert any("J1, J3" in each and "Noether" in each for each in statements(certificate))


@STATES
def test_boosts_against_the_algebra_are_seen(state):
    """With [b, h] = -a the generators are no action."""
    wrong = boosts(state, ('"[b, h]" = "a"', '"[b, h]" = "-a"'))
    assert any("act as" in statement for statement in statements_of_refuted(wrong))


FORCED = """
title = "a particle with friction"
routes = ["newton"]
[variables]
x = { role = "coordinate", shape = [3] }
u = { role = "velocity", of = "x" }
[poisson]
canonical = [["x", "u"]]
[newton]
x = { force = "-u" }
[symmetries.J]
algebra = "so(3)"
vector = "xi"
generators = { x = "cross(xi, x)" }
[claims.brackets]
"{J, J}" = "-hat(J)"
"""


def test_claims_about_a_bracket_are_made_without_an_energy():
    """Forces with a bracket and no energy: maps and brackets are examined, nothing is conserved."""
    claims = prove_claims(spec(FORCED)).claims
    assert {claim.kind for claim in claims} >= {"symmetry", "bracket"}
    assert prove_claims(spec(FORCED)).holds
    assert not any("Noether" in claim.statement for claim in claims)
    (wrong,) = prove_claims(spec(FORCED, ('"-hat(J)"', '"hat(J)"'))).refuted
    assert wrong.statement == "{J, J} = hat(J)"
