"""A wrong derivation that keeps what should be kept is told from the right one all the same.

Plain Euler-Poincare equations of the constrained Lagrangian are the classical mistake (Holm 2011,
section 12.3.3): they put the constraints in before the variation.
"""

import pytest

from coadjoint.derive import derive
from coadjoint.derive.mechanics.almost_poisson import reduced_momenta
from coadjoint.prove import Verdict
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.equivalence import LegendreMap
from coadjoint.prove.integrability import about_integrability
from coadjoint.prove.momenta import about_momenta
from coadjoint.prove.zero import decide_zero
from tests.constrained import BALL, motion
from tests.specs import prove_claims, spec

#: The centred ball with Y = Omega x r Gamma already in its Lagrangian.
CONSTRAINED_TOO_SOON = """
title = "A ball, constrained before the variation"
routes = ["euler-poincare"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
Pi = { role = "momentum" }
Gamma = { role = "advected", representation = "vector" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
m = { positive = true, default = 1 }
r = { default = 1 }
[definitions]
s = "r*Gamma"
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2 + m*dot(cross(Omega, s), cross(Omega, s))/2"
[claims]
casimirs = ["dot(Pi, Gamma)", "dot(Gamma, Gamma)"]
conserved = ["energy"]
"""
#: The ball without gravity, which a centred one does not feel, and without an eccentricity.
CENTRED = (
    ("r*Gamma + chi", "r*Gamma"),
    (" - m*g*dot(Gamma, chi)", ""),
    ("g = { default = 1 }\n", ""),
    ('chi = { shape = [3], default = ["0.1", "0.2", "0.3"] }\n', ""),
)


def rates_of_both():
    """The rates of M and Gamma by both derivations, at the same Omega and Gamma, in one field."""
    right = motion(BALL, *CENTRED)
    momenta = dict(reduced_momenta(right.distribution))
    assert list(momenta) == ["Omega_momentum1", "Omega_momentum2", "Omega_momentum3"]
    positions = [right.field[f"Gamma{n}"] for n in (1, 2, 3)]
    ours = [right.rate(x) for x in (*momenta.values(), *positions)]
    wrong = derive(spec(CONSTRAINED_TOO_SOON))
    pulled = LegendreMap(wrong)
    theirs = [right.field.adopt(pulled.pull_back(wrong, x)) for x in wrong.exact.rates]
    same = zip(pulled.momenta.values(), momenta.values(), strict=True)
    assert all(right.field.adopt(a) == right.close(b) for a, b in same), "dl_c/dOmega is both"
    return right.field, ours, theirs


def test_the_wrong_derivation_keeps_energy_and_vertical_momentum():
    """Energy and M . Gamma are kept by it, so that no integral of these tells the two apart."""
    certificate = prove_claims(spec(CONSTRAINED_TOO_SOON))
    assert certificate.holds
    proved = {claim.statement for claim in certificate.claims if claim.verdict is Verdict.PROVED}
    assert {"the energy is conserved", "dot(Pi, Gamma) is a Casimir"} <= proved
    right = motion(BALL + '[momenta]\nvertical = { section = { Omega = "Gamma" } }\n', *CENTRED)
    assert decide_zero([right.energy_balance()], right.field).verdict is Verdict.PROVED
    ((statement, _, examine),) = about_momenta(right)
    assert statement == "vertical is conserved, by its momentum equation"
    assert examine().verdict is Verdict.PROVED


def test_the_engine_tells_the_wrong_derivation_from_the_motion():
    """Equality of the rates of M is refuted, with a point; those of Gamma are the same."""
    field, ours, theirs = rates_of_both()
    differences = [a - b for a, b in zip(ours, theirs, strict=True)]
    decision = decide_zero(differences[:3], field)
    assert decision.verdict is Verdict.REFUTED
    assert decision.method == "exact counterexample"
    assert {"Omega1", "Gamma1", "m", "r"} & decision.point.keys()
    assert decide_zero(differences[3:], field).verdict is Verdict.PROVED


@pytest.mark.parametrize("sign", [1, -1])
def test_what_it_misses_is_the_gyroscopic_force(sign):
    """M' is M x Omega, and the wrong one is off by -m r^2 (Omega . Gamma) Omega x Gamma."""
    field, ours, theirs = rates_of_both()
    Omega, Gamma = ([field[f"{n}{i}"] for i in (1, 2, 3)] for n in ("Omega", "Gamma"))
    along = field["m"] * field["r"] ** 2 * sum(a * b for a, b in zip(Omega, Gamma, strict=True))
    crossed = [Omega[i - 2] * Gamma[i - 1] - Omega[i - 1] * Gamma[i - 2] for i in range(3)]
    missed = [a + sign * along * c - b for a, b, c in zip(theirs, ours, crossed, strict=False)]
    expected = Verdict.PROVED if sign == 1 else Verdict.REFUTED
    assert decide_zero(missed[:3], field).verdict is expected


def test_constraining_first_does_no_harm_where_the_constraint_is_holonomic():
    """A wheel on a rail moves as l_c has it: (I + m r^2) theta'' = -k theta."""
    rail = """
title = "A wheel on a rail"
routes = ["nonholonomic"]
[variables]
x = { role = "coordinate" }
theta = { role = "coordinate" }
v = { role = "velocity", of = "x" }
omega = { role = "velocity", of = "theta" }
[parameters]
m = { positive = true, default = 1 }
I = { positive = true, default = 1 }
r = { default = 1 }
k = { default = 1 }
[lagrangian]
l = "m*v^2/2 + I*omega^2/2 - k*theta^2/2"
[constraints]
rolling = "v == r*omega"
"""
    right = motion(rail)
    acceleration = right.rate(right.field["omega"])
    whole = right.field["I"] + right.field["m"] * right.field["r"] ** 2
    assert acceleration == -right.field["k"] * right.field["theta"] / whole
    ((statement, *_),) = about_integrability(right.equations)
    assert statement.startswith("the constraint is integrable")


def test_rates_are_taken_by_the_solve():
    """The rate of a momentum without a determinant is the one with it."""
    ball = motion(BALL)
    assert isinstance(ball, ConstrainedRates)
    (momentum, *_) = dict(reduced_momenta(ball.distribution)).values()
    twice = ball.rate(momentum + ball.field["Omega1"]) - ball.rate(ball.field["Omega1"])
    assert ball.field.is_zero(twice - ball.rate(momentum))
