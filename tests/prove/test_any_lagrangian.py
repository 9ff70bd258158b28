"""Lagrangians that are not quadratic in the velocities, with velocities as the state."""

from fractions import Fraction

import numpy as np
import pytest

from coadjoint.derive import derive
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
KEPT = ("[claims]", '[constraints]\nplane = "Omega1 == Omega2"\n[claims]')
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
    """The measure det M dOmega is invariant, since dp is; div X is compared with differences of the rates."""
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
