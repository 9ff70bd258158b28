"""Forces and dissipation on motions without constraints, against equations typed by hand."""

import importlib
from dataclasses import replace

import numpy as np
import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.derive.mechanics import external
from coadjoint.errors import DerivationError, SpecError
from coadjoint.prove import Verdict
from coadjoint.prove.energy import Balance
from tests.sources.test_multipliers import written_out
from tests.specs import RIGID_BODY, prove_claims, shipped, spec, verdicts_of

OSCILLATORS = """
title = "Two coupled masses"
routes = ["euler-lagrange", "canonical"]
[variables]
q = { role = "coordinate", shape = [2] }
v = { role = "velocity", of = "q" }
[parameters]
m = { positive = true, default = 1 }
k = { positive = true, default = 1 }
c = { positive = true, default = 1 }
[lagrangian]
l = "m*(v1^2 + v1*v2 + v2^2) - k*dot(q, q)/2"
[forces]
v = "vector(k, -c*v1*q2)"
[dissipation]
R = "c*(v1 - v2)^2/2"
"""
MATRIX = """
title = "A symmetric matrix that is pulled"
routes = ["euler-lagrange", "canonical"]
[variables]
S = { role = "coordinate", shape = [3], form = "symmetric" }
V = { role = "velocity", of = "S", form = "symmetric" }
P = { role = "momentum", of = "S", form = "symmetric" }
[parameters]
f = { shape = [3], default = 1 }
[lagrangian]
l = "trace(V*V)/2"
[forces]
V = "f"
"""
PLANAR = """
title = "A particle in the plane"
routes = ["canonical"]
[variables]
q = { role = "coordinate", shape = [2] }
p = { role = "momentum", of = "q" }
[parameters]
k = { positive = true, default = 1 }
[hamiltonian]
h = "dot(p, p)/2 + k*dot(q, q)/2"
[forces]
p = "FORCE"
[symmetries.J]
algebra = "so(2)"
vector = "a"
generators = { q = "a*vector(-q2, q1)", p = "a*vector(-p2, p1)" }
"""


def same(found, expected):
    """Whether expressions agree as rational functions."""
    return all(sympy.simplify(a - b) == 0 for a, b in zip(found, expected, strict=True))


def test_a_mass_matrix_turns_forces_into_accelerations():
    """``(2 m, m; m, 2 m) v' = F - k q - c (v1 - v2) (1, -1)``, solved by Cramer's rule by hand."""
    q1, q2, v1, v2, m, k, c = sympy.symbols("q1 q2 v1 v2 m k c")
    one, two = k - k * q1 - c * (v1 - v2), -c * v1 * q2 - k * q2 + c * (v1 - v2)
    expected = [v1, v2, (2 * one - two) / (3 * m), (2 * two - one) / (3 * m)]
    assert same(derive(spec(OSCILLATORS)).rates, expected)


def test_two_routes_meet_with_forces():
    """Euler-Lagrange in velocities, and Hamilton's equations in momenta of their own."""
    found = verdicts_of(OSCILLATORS)
    assert set(found.values()) == {Verdict.PROVED}
    assert any("euler-lagrange and canonical give the same motion" in each for each in found)
    assert "the energy changes by the power of the forces and -2 R" in found


def test_a_force_on_a_symmetric_matrix_pulls_both_entries_beside_the_diagonal():
    """Of ``l = (V11^2 + 2 V12^2 + V22^2)/2`` the force f2 along V12 gives V12' = f2/2.

    The momentum of S12 is V12, since {S12, P12} = 1/2; so P12' = f2/2 as well.
    """
    f1, f2, f3, p1, p2, p3 = sympy.symbols("f1 f2 f3 P11 P12 P22")
    for route in ("euler-lagrange", "canonical"):
        found = derive(spec(MATRIX), route)
        by_name = dict(zip(found.variables, found.rates, strict=True))
        names = ("S11", "S12", "S22", "P11", "P12", "P22")
        assert same([by_name[n] for n in names], [p1, p2, p3, f1, f2 / 2, f3])
    assert verdicts_of(MATRIX)["the energy changes by the power of the forces"] is Verdict.PROVED


@pytest.mark.parametrize(
    ("force", "kept"),
    [("-k*q*dot(q, p)", True), ("-k*p", False), ("vector(-p1, 0)", False)],
)
def test_noether_needs_forces_without_moment(force, kept):
    """A central force keeps angular momentum whatever its power; drag does not."""
    found = verdicts_of(PLANAR.replace("FORCE", force))
    law = "J is conserved by Noether's theorem, since its flow keeps h and forces"
    assert any(law in each for each in found) == kept
    assert set(found.values()) == {Verdict.PROVED}


@pytest.mark.parametrize(
    ("torque", "kept"),
    [("cross(Pi, Omega)", True), ("-Pi", False)],
)
def test_a_casimir_survives_what_is_tangent_to_its_levels(torque, kept):
    """``d Pi^2/dt = 2 Pi . f``: double brackets keep it, friction does not."""
    found = verdicts_of(RIGID_BODY, ("[claims]", f'[forces]\nOmega = "{torque}"\n[claims]'))
    law = "dot(Pi, Pi) is conserved: forces and dissipation do not change it"
    assert (law in found) == kept
    assert found["dot(Pi, Pi) is a Casimir"] is Verdict.PROVED


def test_a_damped_motion_does_not_keep_its_energy():
    """The claim is refuted, with a point; without the friction it is proved."""
    claimed = ("[claims]", '[claims]\nconserved = ["energy"]')
    damped = ("[claims]", '[dissipation]\nR = "dot(Omega, Omega)"\n[claims]')
    assert verdicts_of(RIGID_BODY, claimed)["the energy is conserved"] is Verdict.PROVED
    assert verdicts_of(RIGID_BODY, claimed, damped)["energy is conserved"] is Verdict.REFUTED


def test_only_what_is_kept_is_shown_as_kept():
    """The drift of a simulation lists what the forces leave alone."""
    top = importlib.import_module("coadjoint.systems.heavy_top_damped")
    assert set(top.simulate([0.1, 0.2, 1, 0, 0, 1], (0, 1)).drift) == {"casimir1"}


def test_a_sleeping_top_that_is_driven_keeps_its_spin():
    """With d the same for all axes and tau = d w along e3, Omega = w e3 and Gamma = e3 rest."""
    top = importlib.import_module("coadjoint.systems.heavy_top_damped")
    state = [0, 0, 2 * 10, 0, 0, 1]  # I3 = 2, w = 10 = tau3/d
    assert np.abs(top.rhs(np.array(state, float))).max() < 1e-15


SPOILED = {
    "twice": lambda added: [2 * f for f in added],
    "turned": lambda added: [*added[1:3], added[0], *added[3:]],
    "lost": lambda added: [0 * f for f in added],
}


@pytest.mark.parametrize("spoil", SPOILED.values(), ids=SPOILED)
def test_spoiled_forces_break_the_balance_of_energy(spoil, monkeypatch):
    """The power is taken from the spec, not from what the routes have added."""
    added = external.added_rates
    monkeypatch.setattr(external, "added_rates", lambda setting: spoil(added(setting)))
    declared = shipped("heavy_top_damped")
    found = verdicts_of(declared)
    assert found["the energy changes by the power of the forces and -2 R"] is Verdict.REFUTED


def test_friction_in_velocities_is_friction_in_momenta():
    """Nonholonomic without constraints, and Euler and Poincare: ``I Omega' = Pi'``, by hand."""
    top = shipped("heavy_top_damped")
    in_momenta = derive(top)
    variables = tuple(
        replace(each, independent=True) if each.role == "velocity" else each
        for each in top.variables
        if each.role != "momentum"
    )
    routes = ("nonholonomic", "hamel")
    in_frame = replace(
        top, variables=variables, routes=routes, hamiltonian=None, casimirs=(), conserved=()
    )
    certificate = prove_claims(in_frame)
    assert certificate.holds, str(certificate)
    statements = {claim.statement for claim in certificate.claims}
    assert "nonholonomic and hamel give the same motion" in statements
    assert "the energy changes by the power of the forces and -2 R" in statements
    assert not any("constraint" in each for each in statements)
    symbol = sympy.Symbol
    momenta = {f"Pi{n}": symbol(f"I{n}") * symbol(f"Omega{n}") for n in (1, 2, 3)}
    rates = dict(zip(in_momenta.variables, in_momenta.rates, strict=True))
    found = written_out(derive(in_frame))
    for n in (1, 2, 3):
        turned = symbol(f"I{n}") * found[f"Omega{n}"]
        assert sympy.simplify(turned - rates[f"Pi{n}"].subs(momenta)) == 0


REFUSED = [
    (
        RIGID_BODY,
        ('"lie-poisson"]', '"clebsch"]'),
        '[forces]\nOmega = "-Omega"',
        "the route clebsch does not accept [forces]",
    ),
    (
        RIGID_BODY,
        (),
        '[forces]\nPi = "-Pi"',
        "'Pi' is a momentum; expected one of Omega. Write Omega in its place.",
    ),
    (RIGID_BODY, (), '[forces]\nOmega = "1"', "a 3-vector, as 'Omega' is"),
    (RIGID_BODY, (), '[dissipation]\nR = "dot(Pi, Pi)"', "names no velocity"),
    (RIGID_BODY, (), '[forces]\nspin = "Pi1"', "expected one of Omega"),
]


@pytest.mark.parametrize(("text", "change", "table", "message"), REFUSED)
def test_what_cannot_act_is_refused(text, change, table, message):
    """Before any work; the message names what may stand there."""
    changes = [("[claims]", f"{table}\n[claims]"), *([change] if change else [])]
    with pytest.raises(SpecError) as caught:
        spec(text, *changes)
    assert message in str(caught.value)


def test_the_advice_about_routes_works():
    """The route that the message names derives the forced motion."""
    forced = ("[claims]", '[forces]\nOmega = "-Omega"\n[claims]')
    with pytest.raises(SpecError, match='Remove "clebsch"'):
        spec(RIGID_BODY, forced, ('"lie-poisson"]', '"clebsch"]'))
    assert derive(spec(RIGID_BODY, forced)).exact.forces


def test_a_force_asks_for_a_mass_matrix_that_can_be_inverted():
    """A velocity without kinetic energy has no acceleration, with forces as without."""
    with pytest.raises(DerivationError, match="determinant 0"):
        derive(spec(OSCILLATORS, ("m*(v1^2 + v1*v2 + v2^2)", "m*v1^2")))


def with_force(text, force):
    """A declaration whose matrix has another force along it."""
    return spec(text, ('V = "f"', f'V = "{force}"'), ("f = { shape = [3], default = 1 }", FORCE))


FORCE = 'F = { shape = [3], form = "symmetric", default = 1 }\nA = { shape = [2, 2], default = 1 }'


def test_a_force_along_a_matrix_is_a_matrix_or_a_vector_along_its_components():
    """What is neither is refused with what is expected; the advice is followed and leads on."""
    with pytest.raises(SpecError) as caught:
        with_force(MATRIX, "hat(vector(1, 2, 3))")
    said = str(caught.value)
    assert "the value is a 3 by 3 matrix; expected a 3-vector, along the components" in said
    assert "V11, V12, V22 of the matrix 'V', or a 2 by 2 matrix that is symmetric" in said
    advice = said.partition("Write ")[2].partition(" for ")[0]
    assert advice == "vector(V11, 0, 0)"
    with pytest.raises(DerivationError, match="the value is not symmetric"):
        derive(with_force(MATRIX, "A"))
    assert with_force(MATRIX, advice)


@pytest.mark.parametrize("route", ["euler-lagrange", "canonical"])
def test_a_matrix_force_is_added_to_the_rate_of_the_momentum_matrix(route):
    """``dP/dt = F`` where ``tr(P dS/dt)`` pairs; its power ``tr(F V)`` is that of the energy."""
    declared = with_force(MATRIX, "F - P")
    found = derive(declared, route)
    rates = dict(zip(found.variables, found.rates, strict=True))
    names = ("11", "12", "22")
    forces = [sympy.Symbol(f"F{n}") - sympy.Symbol(f"P{n}") for n in names]
    assert same([rates[f"P{n}"] for n in names], forces)
    certificate = prove_claims(declared)
    (law,) = [c for c in certificate.claims if "changes by the power" in c.statement]
    assert law.verdict is Verdict.PROVED
    motion = Balance(found)
    field, P = motion.field, [found.setting.field[f"P{n}"] for n in names]
    p11, p12, p22 = (field[f"F{n}"] - p for n, p in zip(names, P, strict=True))
    by_hand = p11 * field["V11"] + 2 * p12 * field["V12"] + p22 * field["V22"]
    assert field.is_zero(motion.power - by_hand)


BODY = """
title = "A body in four dimensions, pushed"
routes = ["euler-poincare", "lie-poisson"]
[algebra]
name = "so(4)"
[variables]
Omega = { role = "velocity", form = "antisymmetric" }
M = { role = "momentum", form = "antisymmetric" }
[parameters]
J = { shape = [4], positive = true, default = [1, 2, 3, 4] }
[inputs]
T = { shape = [6], form = "antisymmetric", default = 0 }
[lagrangian]
l = "trace(Omega*diag(J)*transpose(Omega))/2"
[forces]
Omega = "FORCE"
"""


def test_a_matrix_force_along_an_algebra_is_the_vector_of_its_entries():
    """On so(4), declared both ways; and a force that is not antisymmetric is refused."""
    vector = "vector(T12 - M12, T13 - M13, T14 - M14, T23 - M23, T24 - M24, T34 - M34)"
    whole, along = (derive(spec(BODY, ("FORCE", force))).rates for force in ("T - M", vector))
    assert same(whole, along)
    with pytest.raises(DerivationError, match="the value is not antisymmetric"):
        derive(spec(BODY, ("FORCE", "T + diag(J)")))
