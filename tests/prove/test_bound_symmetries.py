"""Symmetries under constraints: what they keep, and momentum equations written by hand."""

import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.errors import DerivationError
from coadjoint.prove import Verdict, bound_symmetries, prove
from coadjoint.prove.bound_symmetries import about_motion_symmetries
from tests.constrained import BALL, PARTICLE, SLEIGH, motion
from tests.prove.test_momenta import AXIAL
from tests.specs import spec

MOVED = """
[symmetries.J]
algebra = "R^2"
vector = "a"
generators = { x = "a[1]", z = "a[2]" }
"""
#: A blade in the plane: no constraint gives a velocity. A wheel spins on it, in no constraint.
BLADE = """
title = "A blade"
routes = ["nonholonomic", "hamel"]
[variables]
x = { role = "coordinate" }
y = { role = "coordinate" }
theta = { role = "coordinate" }
u = { role = "velocity", of = "x" }
v = { role = "velocity", of = "y" }
w = { role = "velocity", of = "theta" }
[parameters]
m = { positive = true, default = 1 }
I = { positive = true, default = 1 }
[lagrangian]
l = "m*(u^2 + v^2)/2 + I*w^2/2"
[constraints]
blade = "sin(theta)*u - cos(theta)*v == 0"
[symmetries.J]
algebra = "se(2)"
vector = "a"
"""
LIFTED = """generators.x = "a_translation[1] - a_rotation*y"
generators.y = "a_translation[2] + a_rotation*x"
generators.theta = "a_rotation"
"""
ON_STATE = """generators.u = "-a_rotation*v"
generators.v = "a_rotation*u"
map = "dot(a_translation, vector(m*u, m*v)) + a_rotation*(m*(x*v - y*u) + I*w)"
"""
SPIN = """[symmetries.spin]
algebra = "so(2)"
vector = "a"
generators.Omega = "a*cross(vector(0, 0, 1), Omega)"
generators.Gamma = "a*cross(vector(0, 0, 1), Gamma)"
map = "a*I3*Omega3"
"""
#: A rotor on the sleigh, which nothing binds.
ROTOR = (
    ("u = {", 'phi = { role = "coordinate" }\nrho = { role = "velocity", of = "phi" }\nu = {'),
    ("\na = {", "\nK = { positive = true, default = 1 }\na = {"),
    ("I*omega^2/2", "I*omega^2/2 + K*(omega + rho)^2/2"),
)
TURNED = '[symmetries.J]\nalgebra = "so(2)"\nvector = "b"\ngenerators = { phi = "b" }\n'


def examined(text, *changes):
    """Verdict by statement."""
    claims = list(about_motion_symmetries(motion(text, *changes)))
    assert {kind for _, kind, _ in claims} <= {"symmetry", "momentum"}
    return {statement: examine().verdict for statement, _, examine in claims}


def refuted(found):
    """The statements that do not hold."""
    assert set(found.values()) <= {Verdict.PROVED, Verdict.REFUTED}
    return {statement for statement, verdict in found.items() if verdict is Verdict.REFUTED}


def test_translations_of_the_particle():
    """By hand m u' = -y lambda and m w' = lambda: both momenta change by reactions."""
    assert examined(PARTICLE + MOVED) == {
        "the generators of J act as R^2 from the left": Verdict.PROVED,
        "the flow of J keeps the constraints": Verdict.PROVED,
        "the flow of J takes motions to motions": Verdict.PROVED,
        "dJ1/dt = -y*blade_reaction": Verdict.PROVED,
        "dJ2/dt = blade_reaction": Verdict.PROVED,
    }


def test_the_momenta_of_the_particle_by_hand():
    """With ``lambda = m u v/(1 + y^2)``, which follows from ``w' = v u + y u'``."""
    equations = derive(spec(PARTICLE + MOVED))
    y, u, v, m = sympy.symbols("y u v m")
    reaction = m * u * v / (1 + y**2)
    rates = dict(zip(equations.state, equations.rates, strict=True))
    for name, by_hand in {"J1": -y * reaction, "J2": reaction}.items():
        value = equations.observables[name]
        rate = sum(sympy.diff(value, x) * rate for x, rate in rates.items())
        assert sympy.simplify(rate - by_hand) == 0, name


def test_a_conserved_momentum_is_no_symmetry():
    """The particle keeps m v, and to move y changes the constraint w = y u."""
    found = examined(PARTICLE + MOVED, ('x = "a[1]"', 'y = "a[1]"'))
    assert found["J1 is conserved, by its momentum equation"] is Verdict.PROVED
    assert refuted(found) == {
        "the flow of J keeps the constraints",
        "the flow of J takes motions to motions",
    }


def test_motions_of_the_plane_move_a_blade():
    """By hand m u' = lambda sin(theta), m v' = -lambda cos(theta), I w' = 0."""
    found = examined(BLADE + LIFTED)
    assert refuted(found) == set()
    laws = {statement for statement in found if "dt" in statement}
    turned = "-x*blade_reaction*cos(theta) - y*blade_reaction*sin(theta)"
    assert laws == {
        f"dJ1/dt = {turned}",
        "dJ2/dt = blade_reaction*sin(theta)",
        "dJ3/dt = -blade_reaction*cos(theta)",
    }


@pytest.mark.parametrize(
    ("changes", "false"),
    [
        ([('vector = "a"', 'vector = "a"\nside = "right"')], {"act as se(2)"}),
        ([('generators.theta = "a_rotation"\n', "")], {"keeps the", "takes motions"}),
        (
            [('generators.theta = "a_rotation"', 'generators.theta = "2*a_rotation"')],
            {"keeps the", "takes motions"},
        ),
        ([("m*(u^2 + v^2)/2", "m*(u^2 + v^2)/2 - m*x")], {"takes motions"}),
        ([("sin(theta)*u", "x*sin(theta)*u")], {"keeps the", "takes motions"}),
    ],
)
def test_what_is_no_symmetry_is_refuted(changes, false):
    """The wrong side, a blade that does not turn or twice as fast, a slope, another constraint."""
    found = refuted(examined(BLADE + LIFTED, *changes))
    assert {next(f for f in false if f in each) for each in found} == false
    assert len(found) == len(false)


def test_generators_of_the_whole_state_are_taken_as_they_are():
    """The lift written out, and momenta declared, none of which the blade conserves."""
    found = examined(BLADE + LIFTED + ON_STATE)
    assert refuted(found) == set()
    assert {f"J{n} is not conserved" for n in (1, 2, 3)} <= found.keys()
    wrong = refuted(examined(BLADE + LIFTED + ON_STATE, ('generators.v = "a_rotation*u"\n', "")))
    assert {each.split(" J ")[1] for each in wrong} == {
        "keeps the constraints",
        "takes motions to motions",
    }


def test_a_rotor_keeps_its_momentum():
    """The constraints allow it to turn, so Noether's theorem holds: K (omega + rho)."""
    found = examined(SLEIGH + TURNED, *ROTOR)
    assert refuted(found) == set()
    assert "J is conserved, by its momentum equation" in found
    omega, rho, K = sympy.symbols("omega rho K")
    value = derive(spec(SLEIGH + TURNED, *ROTOR)).observables["J"]
    assert sympy.expand(value - K * (omega + rho)) == 0


def test_a_force_works_along_a_symmetry():
    """A motor of the rotor, and a force along x of the particle."""
    assert "dJ/dt = k" in examined(SLEIGH + TURNED + '[forces]\nrho = "k"\n', *ROTOR)
    found = examined(PARTICLE + MOVED + '[forces]\nu = "k"\n')
    assert refuted(found) == set()
    assert "dJ1/dt = -y*blade_reaction + k" in found


def test_constraints_may_move():
    """The particle is lifted at a speed that depends on time."""
    rise = ("w == y*u", "w == y*u + k*t"), ("[claims]\n", ""), ('conserved = ["energy"]\n', "")
    found = examined(PARTICLE + '[time]\nname = "t"\n' + MOVED, *rise)
    assert refuted(found) == set()
    assert "dJ1/dt = -y*blade_reaction" in found
    grown = ('z = "a[2]"', 'z = "a[2]*t"')  # z + s t moves with w + s
    found = examined(PARTICLE + '[time]\nname = "t"\n' + MOVED, *rise, grown)
    assert {each.split(" J ")[1] for each in refuted(found)} == {
        "keeps the constraints",
        "takes motions to motions, at all times",
    }


def test_a_symmetry_may_depend_on_time():
    """To a moving observer x has another speed, which the constraint w = y v does not name."""
    changes = (('"w == y*u"', '"w == y*v"'), ('x = "a[1]"', 'x = "a[1]*t"'))
    found = examined(PARTICLE + '[time]\nname = "t"\n' + MOVED, *changes)
    assert refuted(found) == set()
    assert "dJ1/dt = u*m" in found


def test_a_body_of_revolution_turns_about_its_axis():
    """Its spin is not conserved where it rolls; other moments of inertia break the symmetry."""
    found = examined(BALL + SPIN, *AXIAL)
    assert refuted(found) == set()
    assert "spin is not conserved" in found
    broken = [AXIAL[0], ("vector(I1*Omega1, I1*Omega2", "vector(I1*Omega1, I2*Omega2"), *AXIAL[1:]]
    assert refuted(examined(BALL + SPIN, *broken)) == {"the flow of spin takes motions to motions"}


@pytest.mark.parametrize("factor", [0, -1])
def test_without_the_reaction_the_law_is_refuted(factor, monkeypatch):
    """The rate is taken along the motion, the law from the Lagrangian and the reactions."""
    law = bound_symmetries.law_along

    def spoiled(equations, along):
        field = equations.setting.field
        change = {"blade_reaction": factor * field["blade_reaction"]}
        return field.substitute(law(equations, along), change)

    monkeypatch.setattr(bound_symmetries, "law_along", spoiled)
    assert len(refuted(examined(PARTICLE + MOVED))) == 2


def test_the_certificate_has_them_and_claims_may_name_momenta():
    """As observables; where the rotor turns, its momentum is claimed to be conserved."""
    text = SLEIGH + TURNED + '[claims]\nconserved = ["J", "energy"]\n'
    found = {claim.statement: claim.verdict for claim in prove(spec(text, *ROTOR)).claims}
    assert set(found.values()) == {Verdict.PROVED}
    assert {"J is conserved", "the flow of J takes motions to motions"} <= found.keys()


def test_brackets_under_constraints_claim_no_flow():
    """The flow of an integral need not commute with the motion: the bracket is no Poisson one."""
    claims = ('["energy"]', '["energy", "v"]\nbrackets = { "{x, u}" = "1/(m*(1 + y^2))" }')
    found = {claim.statement: claim.verdict for claim in prove(spec(PARTICLE, claims)).claims}
    assert set(found.values()) == {Verdict.PROVED}
    assert "v is conserved" in found


def test_a_momentum_that_nothing_gives_is_declared():
    """Over an algebra no bracket generates it."""
    with pytest.raises(DerivationError, match="Declare the momentum map as map"):
        derive(spec(BALL + SPIN, *AXIAL, ('map = "a*I3*Omega3"\n', "")))


STILL = """
[symmetries.J]
algebra = "so(2)"
vector = "a"
generators = { x = "0*a" }
time = "a"
"""
CONSTRAINTS = ["w == y*u", "2*w == 2*y*u", "w == y*u + k", "2*w == 2*y*u + 2*k"]


@pytest.mark.parametrize("constraint", CONSTRAINTS)
def test_a_shift_of_time_has_minus_the_energy_for_a_momentum(constraint):
    """The energy is conserved, or changes by the work k lambda of the surface that moves."""
    found = examined(PARTICLE + STILL, ("w == y*u", constraint))
    assert set(found.values()) == {Verdict.PROVED}
    conserved = "J is conserved, by its momentum equation" in found
    assert conserved == ("k" not in constraint)
    if not conserved:
        (law,) = (text for text in found if text.startswith("dJ/dt"))
        factor = "2*" if constraint.startswith("2") else ""
        assert law.replace("blade_reaction*k", "k*blade_reaction") == (
            f"dJ/dt = -{factor}k*blade_reaction"
        )


TIMED = ("[lagrangian]", '[time]\nname = "t"\n[lagrangian]')
SLOWER = (TIMED, ('time = "a"', 'time = "a*t"'))


@pytest.mark.parametrize("constraint", CONSTRAINTS[:2])
def test_motions_of_kinetic_energy_alone_may_be_slower(constraint):
    """Velocities change by -xi; J = -E t has the rate -E."""
    found = examined(PARTICLE + STILL, ("w == y*u", constraint), *SLOWER)
    assert set(found.values()) == {Verdict.PROVED}
    assert "the flow of J keeps the constraints" in found
    assert any(text.startswith("dJ/dt = -") for text in found)


@pytest.mark.parametrize(
    ("change", "statement"),
    [
        (("(u^2 + v^2 + w^2)/2", "(u^2 + v^2 + w^2)/2 - k*x"), "takes motions to motions"),
        (("w == y*u", "w == y*u + k"), "keeps the constraints"),
        (("w == y*u", "2*w == 2*y*u + k"), "keeps the constraints"),
    ],
)
def test_slower_motions_in_a_field_or_on_a_moving_surface_are_others(change, statement):
    """A potential and an affine term have scales of their own."""
    found = refuted(examined(PARTICLE + STILL, change, *SLOWER))
    assert any(statement in text for text in found)


def test_time_on_a_surface_whose_speed_changes_is_no_symmetry():
    """With dz = y dx + k t dt the constraint is another one later; k t u^0 in place of k."""
    later = ("w == y*u", "w == y*u + k*t")
    found = refuted(examined(PARTICLE + STILL, TIMED, later))
    assert any("keeps the constraints" in text for text in found)
    lifted = ('{ x = "0*a" }', '{ z = "a*k*t" }')  # the surface, in time, moves with z
    found = examined(PARTICLE + STILL, TIMED, later, lifted)
    assert found["the flow of J keeps the constraints"] is Verdict.PROVED
