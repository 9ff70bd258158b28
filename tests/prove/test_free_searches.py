"""Searches over motions without constraints: reversals, integrals and measures, against hand."""

import pytest

from coadjoint.prove import Verdict, prove
from coadjoint.prove.reversibility import _solve_parities
from tests.specs import RIGID_BODY, shipped, spec

LINE = """
title = "One degree of freedom"
routes = ["canonical"]
[variables]
q = { role = "coordinate" }
p = { role = "momentum", of = "q" }
[hamiltonian]
h = "ENERGY"
"""
LAGRANGIAN = """
title = "A mass that depends on its place"
routes = ["euler-lagrange", "canonical"]
[variables]
q = { role = "coordinate" }
v = { role = "velocity", of = "q" }
[lagrangian]
l = "(1 + q^2)*v^2/2 - q^4"
"""
TIME = ("[hamiltonian]", "[time]\nname = 't'\n[hamiltonian]")
INPUT = ("[hamiltonian]", "[inputs]\nu = { default = 0 }\n[hamiltonian]")


def found(declared, kind):
    """Statements of a kind, those that were decided with their verdicts."""
    certificate = prove(declared)
    assert certificate.holds, str(certificate)
    claims = {each.statement: each.verdict for each in certificate.claims if each.kind == kind}
    return claims | {each.statement: None for each in certificate.findings if each.kind == kind}


def line(energy, *changes):
    """A motion on a line with an energy."""
    return spec(LINE, ("ENERGY", energy), *changes)


NO_SIGNS = "no change of signs of the state takes the motion to its reverse"
BACK = "the motion is time reversible under"


@pytest.mark.parametrize(
    ("energy", "changes", "statement"),
    [
        ("p^2/2 + q^3", (), f"{BACK} p -> -p"),
        ("p^2/2 + p*q^2", (), f"{BACK} q -> -q"),  # h is even in q, and odd parts in p are there
        (
            "p^2/2 + p*q^2 + q",
            (),
            NO_SIGNS,
        ),
        ("p^2/2 + q*cos(t)", (TIME,), f"{BACK} p -> -p, t -> -t"),
        ("p^2/2 + u*q", (INPUT,), f"{BACK} p -> -p and inputs run backwards"),
    ],
)
def test_reversals_of_a_line(energy, changes, statement):
    """``h(Sx) = h(x)`` with S that turns the sign of the bracket reverses the motion."""
    assert found(line(energy, *changes), "transformation") == {statement: Verdict.PROVED}


def test_nothing_is_said_of_signs_in_functions_of_time():
    """Q -> -q reverses q sin(t), which is no matter of parities of monomials alone."""
    (statement,) = found(line("p^2/2 + q^2/2 + q*sin(t)", TIME), "transformation")
    assert statement.startswith("the motion is not time reversible under p -> -p, t -> -t: ")


def test_equations_modulo_2():
    """A + b = 1, b + c = 1, a = 1 gives b = 0, c = 1; with a + c = 1 there is none."""
    equations = [(frozenset("ab"), 1), (frozenset("bc"), 1), (frozenset("a"), 1)]
    assert _solve_parities(equations, "abc") == ["a", "c"]
    assert _solve_parities([*equations, (frozenset("ac"), 1)], "abc") is None


def test_integrals_of_lagranges_top_are_counted():
    """Products of E (2, 1), spin (1, 0), Gamma^2 (0, 2), Pi.Gamma (1, 1) up to (2, 2): ten."""
    (statement,) = found(shipped("heavy_top_lagrange"), "integrals")
    assert "a space of dimension 10 with constants, all polynomials in energy, spin" in statement


def test_a_symmetric_body_has_one_integral_more():
    """With I1 = I2 it is Pi3, a function of E and Pi^2 and no polynomial in them."""
    same = ("default = [1, 2, 3]", "default = [1, 1, 3]")
    text = ("dot(Omega, diag(I)*Omega)/2", "dot(Omega, diag(vector(I1, I1, I3))*Omega)/2")
    statements = found(spec(RIGID_BODY, same, text), "integrals")
    (statement,) = statements
    assert "a space of dimension 4 with constants at the most, 3 of it polynomials in" in statement
    (only,) = found(spec(), "integrals")
    assert "a space of dimension 3 with constants, all polynomials in energy, dot(Pi, Pi)" in only


def test_integrals_hold_for_all_inputs_and_at_all_times():
    """H = p1^2/2 + p2^2/2 + f q1 keeps p2, whatever f; with f = 0 it keeps p1 as well."""
    plane = LINE.replace('role = "coordinate" }', 'role = "coordinate", shape = [2] }')
    for force, count in (("u*q1", 3), ("t*q1", 3), ("0*q1", 10)):
        changes = (("ENERGY", f"dot(p, p)/2 + {force}"),)
        changes += (TIME,) * ("t*" in force) + (INPUT,) * ("u*" in force)
        statements = found(spec(plane, *changes), "integrals")
        (counted,) = [each for each in statements if each.startswith("integrals")]
        # 1, p2, p2^2; without a force L = q1 p2 - q2 p1 and six polynomials in p1, p2, and
        # L p1, L p2, L^2
        assert f"a space of dimension {count} " in counted
        assert any(each.startswith("p2 is conserved") for each in statements)
        assert ("for all inputs" in counted) == ("u*" in force)
        assert ("at all times" in counted) == ("t*" in force)


@pytest.mark.parametrize(
    ("name", "statement"),
    [
        ("rigid_body", "an invariant measure: dPi"),  # so(3) is unimodular
        ("affine_line", "an invariant measure, where its density is finite: |mu2|^(-1) dmu"),
        ("kepler", "an invariant measure: dr dv"),  # Liouville
        ("kirchhoff", "an invariant measure: dPi dP"),  # the kernel solves for velocities
    ],
)
def test_hamiltonian_motions_keep_volumes(name, statement):
    """By the trace of ad, which is zero but for the affine group of the line."""
    assert found(shipped(name), "measure")[statement] is Verdict.PROVED


def test_the_volume_of_phase_space_in_velocities():
    """Dq dp = (1 + q^2) dq dv, since p = (1 + q^2) v."""
    assert found(spec(LAGRANGIAN), "measure") == {
        "an invariant measure: |q^2 + 1| dq dv": Verdict.PROVED
    }


BRACKET = """
title = "A bracket that is no canonical one"
routes = ["poisson"]
[variables]
x = { role = "coordinate", shape = [4] }
[poisson.brackets]
"{x1, x2}" = "ONE"
"{x3, x4}" = "1 + x3^2"
"{x2, x4}" = "TWO"
[hamiltonian]
h = "x1^2/2 + x2*x3 + x4^3"
"""


@pytest.mark.parametrize(
    ("one", "two", "density"),
    [
        ("2", "0", "|2*x3^2 + 2|^(-1)"),
        ("1/(2 + x1)", "-2*x1/(2 + x1)", "|(x1 + 2)/(x3^2 + 1)|"),
    ],
)
def test_a_bracket_that_is_not_degenerate_has_liouvilles_measure(one, two, density):
    """One over the Pfaffian ``{x1, x2} {x3, x4}``, by hand: ``{x1, x3} = {x1, x4} = 0``."""
    declared = spec(BRACKET, ("ONE", one), ("TWO", two))
    (statement,) = found(declared, "measure")
    assert density in statement
    forced = spec(BRACKET, ("ONE", one), ("TWO", two), ("[hamiltonian]", FORCE))
    assert not any(density in each for each in found(forced, "measure"))


FORCE = '[forces]\nx = "vector(0, -x2^3, 0, 0)"\n[hamiltonian]'


@pytest.mark.parametrize(
    ("name", "value"), [("lorenz_gyrostat", "-sigma - b - 1"), ("bloch", "-2/T2 - 1/T1")]
)
def test_relaxing_motions_shrink_volumes(name, value):
    """``div X`` of Lorenz (1963), and of Bloch's equations: minus the rates of the components."""
    none, *_ = found(shipped(name), "measure")
    assert none.startswith("no measure rho ")
    assert none.endswith(f"div X = {value}")


def test_a_hamiltonian_of_fourth_order_with_friction():
    """Q' = p^3, p' = -1 - p: p^3 d ln rho/dq = 1 has no solution rho(q)."""
    damped = ("[hamiltonian]", '[forces]\np = "-p"\n[hamiltonian]')
    none, other = found(line("p^4/4 + q", damped), "measure")
    assert none.startswith("no measure rho dq dp with a smooth positive density rho(q)")
    # p + 1 is invariant with the cofactor -1 = div X
    assert other == "an invariant measure, where its density is finite: |p + 1|^(-1) dq dp"
