"""Lagrangians that are not quadratic in velocities: these as the state, or momenta."""

from fractions import Fraction

import numpy as np
import pytest

from coadjoint.derive import derive
from coadjoint.derive.mechanics import radial
from coadjoint.errors import DerivationError
from coadjoint.lower.lowering import lower
from coadjoint.prove import Verdict
from coadjoint.prove.constrained import motion_of
from coadjoint.prove.measures import about_measure
from coadjoint.prove.projection import about_projection
from coadjoint.prove.reversibility import about_reversal
from coadjoint.prove.zero import decide_zero
from tests.constrained import PARTICLE, motion
from tests.specs import prove_claims, spec

#: A body whose kinetic energy has terms of third and fourth degree.
BODY = """
title = "A body"
routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
b = { positive = true, default = 1 }
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2 + b*dot(Omega, Omega)^2/4"
[claims]
conserved = ["energy"]
"""
CUBIC = ("b*dot(Omega, Omega)^2/4", "b*Omega3^3")
KEPT = ("[claims]", '[constraints]\nplane = "2*Omega1 == 2*Omega2"\n[claims]')
INERTIA, B = np.array([1.0, 2.0, 3.0]), 1.0


def accelerations(omega):
    """``M dOmega/dt = p x Omega`` with p and M of the quartic body, typed by hand."""
    square = omega @ omega
    p = INERTIA * omega + B * square * omega
    mass = np.diag(INERTIA) + B * (square * np.eye(3) + 2 * np.outer(omega, omega))
    return np.linalg.solve(mass, np.cross(p, omega)), np.linalg.det(mass)


def at(of, element, omega):
    """The value of a function of the body at exact numbers."""
    numbers = dict(zip(("Omega1", "Omega2", "Omega3"), omega, strict=True))
    numbers |= {"I1": 1, "I2": 2, "I3": 3, "b": 1}
    return float(of.field.evaluate(element, {n: Fraction(x) for n, x in numbers.items()}, Fraction))


def statements(examined):
    """What is said of a motion, each of it proved."""
    shown = []
    for statement, _, examine in examined:
        found = examine()
        decision = found if hasattr(found, "verdict") else None
        if decision is not None:
            assert decision.verdict is Verdict.PROVED, statement
        shown.append(statement)
    return shown


def test_a_body_moves_by_euler_poincare():
    """dp/dt = p x Omega with p = I Omega + b |Omega|^2 Omega, on all three routes."""
    certificate = prove_claims(spec(BODY))
    assert certificate.holds, str(certificate)
    of, omega = motion_of(derive(spec(BODY))), np.array([0.5, -0.25, 0.75])
    expected, _ = accelerations(omega)
    found = [at(of, of.decidable_rates[f"Omega{n}"], omega) for n in (1, 2, 3)]
    assert found == pytest.approx(expected, rel=1e-13)


def test_the_constraint_is_imposed_after_the_variation():
    """(m + 12 k u^2) u' = -m y (y u' + u v) with w = y u and 4 k u^3 in the momentum of u."""
    of = motion(PARTICLE, ("w^2)/2", "w^2)/2 + k*u^4"))
    m, k, y, u, v = (of.field[name] for name in "mkyuv")
    expected = -m * y * u * v / (m + 12 * k * u**2 + m * y**2)
    assert of.field.is_zero(of.decidable_rates["u"] - expected)
    assert prove_claims(spec(PARTICLE, ("w^2)/2", "w^2)/2 + k*u^4"))).holds


def test_the_divergence_knows_that_the_mass_matrix_turns(monkeypatch):
    """The density is det M, since dp is invariant; div X is compared with differences of rates."""
    of, omega, step = motion_of(derive(spec(BODY))), np.array([0.5, -0.25, 0.75]), 2.0**-17
    by_hand = 0.0
    for n, along in enumerate(np.eye(3)):
        ahead, behind = (accelerations(omega + s * step * along)[0] for s in (1, -1))
        by_hand += (ahead[n] - behind[n]) / (2 * step)
    assert at(of, of.divergence, omega) == pytest.approx(by_hand, rel=1e-6)
    none, measure = statements(about_measure(of))
    assert none.startswith("no measure rho dOmega with a constant rho")
    assert measure == "an invariant measure: |det(B^T M B)| dOmega"
    spoiled = motion_of(derive(spec(BODY)))
    rigid = spoiled.field.derivative
    monkeypatch.setattr(  # as if M did not depend on velocities
        type(spoiled), "_slope", lambda self, solve, row, v: rigid(solve.known[row], v)
    )
    assert statements(about_measure(spoiled)) == ["an invariant measure: dOmega"]


@pytest.mark.parametrize("changes", [(), (CUBIC,)], ids=["even", "odd"])
def test_reversal_looks_at_the_mass_matrix(changes):
    """|Omega|^4 is even; of Omega3^3 the mass matrix is not, while forces are."""
    (statement,) = statements(about_reversal(motion_of(derive(spec(BODY, *changes)))))
    reversible = statement == "the motion is time reversible under Omega -> -Omega"
    assert reversible is not bool(changes)


def test_projection_says_which_matrix_measures_the_change():
    """The kinetic energy of the change is no quadratic form."""
    equations = derive(spec(BODY, KEPT))
    said = [statement for statement, _, _ in about_projection(equations)]
    assert any("d . M d of the change d is stationary" in each for each in said)
    assert not any("the kinetic energy of the change" in each for each in said)
    certificate = prove_claims(spec(BODY, KEPT))
    assert certificate.holds, str(certificate)


def test_energy_is_the_one_of_the_momenta():
    """E = p . Omega - l = Omega . I Omega/2 + 3 b |Omega|^4/4; without the 3 it is not kept."""
    of = motion_of(derive(spec(BODY)))
    square = of.field.sum(of.field[f"Omega{n}"] ** 2 for n in (1, 2, 3))
    kinetic = of.field.sum(of.field[f"I{n}"] * of.field[f"Omega{n}"] ** 2 for n in (1, 2, 3))
    right, wrong = (kinetic / 2 + of.field["b"] * square**2 * n / 4 for n in (3, 1))
    assert of.field.is_zero(of.equations.exact.energy - right)
    assert decide_zero([of.rate(right)], of.field).verdict is Verdict.PROVED
    assert decide_zero([of.rate(wrong)], of.field).verdict is Verdict.REFUTED


# -- momenta as the state --------------------------------------------------------------------------

#: A charge in a magnetic field, twice as heavy along its second axis: T = (v1^2 + 2 v2^2)/2.
CHARGE = """
title = "A charge"
routes = ["euler-lagrange", "canonical"]
[variables]
q = { role = "coordinate", shape = [2] }
p = { role = "momentum", of = "q" }
v = { role = "velocity", of = "q" }
[parameters]
m = { positive = true, default = 1 }
c = { positive = true, default = 1 }
B = { default = 1 }
[lagrangian]
l = "-m*c^2*sqrt(1 - (v1^2 + 2*v2^2)/c^2) + B*q1*v2 - q1^2/2"
[claims]
conserved = ["energy"]
"""
OWN_MOMENTA = ('p = { role = "momentum", of = "q" }\n', "")


def test_a_function_of_one_quadratic_form_is_transformed_in_closed_form():
    """There v = K^-1 y/(m S), h = m c^2 S with S^2 = 1 + y . K^-1 y/(m c)^2, y = p - B q1 e2."""
    sample = spec(CHARGE)
    of = motion_of(derive(sample, "canonical"))
    field = of.field
    m, c, b, q1, p1, p2 = (field[name] for name in ("m", "c", "B", "q1", "p1", "p2"))
    y = p2 - b * q1
    s = field.call("sqrt", 1 + (p1**2 + y**2 / 2) / (m * c) ** 2)
    by_hand = {"q1": p1 / (m * s), "q2": y / (2 * m * s), "p2": field.zero}
    by_hand["p1"] = b * y / (2 * m * s) - q1
    for name, value in by_hand.items():
        assert field.is_zero(of.decidable_rates[name] - value), name
    assert field.is_zero(of.equations.close(of.equations.exact.energy) - m * c**2 * s - q1**2 / 2)
    certificate = prove_claims(sample)
    assert certificate.holds, str(certificate)
    said = [claim.statement for claim in certificate.claims]
    assert any("the Legendre transform is locally invertible" in each for each in said)
    assert "dh/dmu = xi on the route canonical" in said


def test_momenta_of_the_route_are_transformed_too():
    """With velocities as the state, canonical has momenta of its own."""
    certificate = prove_claims(spec(CHARGE, OWN_MOMENTA))
    assert certificate.holds, str(certificate)
    assert any("through p = dl/dv" in claim.statement for claim in certificate.claims)


def test_the_kernel_computes_what_a_hand_would():
    """One y = p2 - B q1, S by 4 products and 2 sums, each v by one product and quotient."""
    counted = lower(derive(spec(CHARGE)))["rhs"].operation_counts()
    assert (counted["sqrt"], counted["divide"]) == (1, 2)
    assert counted["multiply"] <= 1 + 4 + 2 + 1
    assert counted["add"] <= 1 + 2 + 1


NOT_CLOSED = (
    "v1^2/2 + v2^2/2 + (v1^2 + v2^2)^2",  # a cubic equation for T
    "-c^2*sqrt(1 - v1^2 - v2^2) + v1^4",  # no function of one form
    "exp(v1^2 + v2^2)",
)
#: Of a form about another point, at which the iteration would have to begin.
SHIFTED = "-c^2*sqrt(1 - (v1 - 1)^2 - v2^2)"


def of_charge(lagrangian):
    """The charge with another Lagrangian, as a change of the spec."""
    return CHARGE.split('l = "')[1].split('"')[0], lagrangian


def test_what_is_not_convex_at_rest_is_refused():
    """The message names the way out, and that way is open: the next test goes it."""
    with pytest.raises(DerivationError, match="at rest") as caught:
        derive(spec(CHARGE, of_charge(SHIFTED)), "canonical")
    assert "euler-lagrange" in str(caught.value)
    assert "velocities" in str(caught.value)


@pytest.mark.parametrize("lagrangian", [*NOT_CLOSED, SHIFTED])
def test_what_has_no_closed_form_has_hamiltons_equations_in_velocities(lagrangian):
    """Proved to be Euler and Lagrange's."""
    claims = prove_claims(spec(CHARGE, of_charge(lagrangian), OWN_MOMENTA)).claims
    (same,) = [each for each in claims if "give the same motion" in each.statement]
    assert same.verdict.name == "PROVED"


@pytest.mark.parametrize("lagrangian", NOT_CLOSED)
def test_what_has_no_closed_form_is_solved_in_the_kernel(lagrangian):
    """Where momenta are declared, on both routes."""
    changed = (CHARGE.split('l = "')[1].split('"')[0], lagrangian)
    certificate = prove_claims(spec(CHARGE, changed))
    assert certificate.holds, str(certificate)
    assert any("Newton" in claim.statement for claim in certificate.claims)


def test_a_wrong_solution_is_none(monkeypatch):
    """What comes out is put into p = dl/dv: another number for T is no solution."""
    monkeypatch.setattr(radial, "_slope_at", lambda field, *_: field.one)
    assert derive(spec(CHARGE)).iterations
