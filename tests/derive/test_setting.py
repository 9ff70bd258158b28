"""The Setting: constants with parameters, declared actions and packed matrices become elements."""

import pytest
import sympy

from coadjoint.derive import derive, make_setting
from coadjoint.exact import Element
from tests.specs import RIGID_BODY, emitted, prove_claims, shipped, spec

#: [e1, e2] = k e3, [e2, e3] = c1 e1, [e3, e1] = c2 e2, an algebra for all k and c.
SCALED = """
title = "a body with scaled axes"
routes = ["euler-poincare", "lie-poisson"]
[algebra]
basis = ["e1", "e2", "e3"]
[algebra.brackets]
"[e1, e2]" = "k*e3"
"[e2, e3]" = "c[1]*e1"
"[e3, e1]" = "c[2]*e2"
[variables]
Omega = { role = "velocity" }
Pi = { role = "momentum" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
c = { shape = [2], default = [1, 1] }
k = { default = 1 }
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2"
[claims]
casimirs = ["c1*Pi1^2 + c2*Pi2^2 + k*Pi3^2"]
"""
#: One generator that turns the plane at the rate w, and stretches it at the rate s.
SPINNING = """
title = "a turntable"
routes = ["euler-poincare", "lie-poisson"]
[algebra]
name = "R^1"
[representations.spiral]
matrices = { P1 = [["s", "-w"], ["w", "s"]] }
[variables]
xi = { role = "velocity", block = "P1" }
mu = { role = "momentum", block = "P1" }
a = { role = "advected", representation = "spiral" }
[parameters]
w = { default = 1 }
s = { default = 0 }
b = { shape = [2], default = [1, 2] }
[lagrangian]
l = "xi^2/2 - dot(b, a)"
"""


def zeros(found, expected):
    """Differences of two lists, multiplied out."""
    return [sympy.expand(a - b) for a, b in zip(found, expected, strict=True)]


def test_constants_with_parameters_live_in_the_field_of_the_state():
    """The parameter of a constant is the one of the formulas; numbers stay numbers."""
    setting = make_setting(spec(SCALED))
    row = setting.algebra.constants[0, 1]
    assert row[2] - setting.field["k"] == 0
    assert isinstance(row[2], Element)
    assert setting.take_constant(2) == 2
    assert setting.algebra is setting.algebra


@pytest.mark.parametrize("route", ["euler-poincare", "lie-poisson"])
def test_parameters_in_brackets_reach_the_equations(route):
    """(ad*_Omega Pi)_j = c_ij^k Omega_i Pi_k, written out for this table."""
    equations = derive(spec(SCALED), route)
    p1, p2, p3 = equations.state
    I1, I2, I3, c1, c2, k = equations.parameters
    w1, w2, w3 = p1 / I1, p2 / I2, p3 / I3
    expected = [c2 * w3 * p2 - k * w2 * p3, k * w1 * p3 - c1 * w3 * p1, c1 * w2 * p1 - c2 * w1 * p2]
    assert zeros(equations.rates, expected) == [0] * 3
    ones = {c1: 1, c2: 1, k: 1}
    body = emitted("rigid_body", route).rates
    assert zeros([rate.subs(ones) for rate in equations.rates], body) == [0] * 3


def test_equations_with_parameters_in_brackets_are_proved():
    """The weights of the Casimir are those of the brackets; with one exchanged it is refuted."""
    certificate = prove_claims(spec(SCALED))
    assert certificate.holds, str(certificate)
    (refuted,) = prove_claims(spec(SCALED, ("c2*Pi2^2", "c1*Pi2^2"))).refuted
    assert refuted.kind == "casimir"
    assert set(refuted.counterexample) >= {"c1", "c2"}


@pytest.mark.parametrize("route", ["euler-poincare", "lie-poisson"])
@pytest.mark.parametrize("side", ["left", "right"])
def test_parameters_in_an_action_reach_the_equations(route, side):
    """Left: da/dt = -xi (s + w JJ) a and dmu/dt = -dl/da . (s + w JJ) a; right: the opposite."""
    change = ('name = "R^1"', f'name = "R^1"\ninvariance = "{side}"')
    equations = derive(spec(SPINNING, change), route)
    mu, a1, a2, w, s, b1, b2 = (*equations.state, *equations.parameters)
    turned = [s * a1 - w * a2, w * a1 + s * a2]
    sign = 1 if side == "left" else -1
    expected = [b1 * turned[0] + b2 * turned[1], -mu * turned[0], -mu * turned[1]]
    assert zeros(equations.rates, [sign * rate for rate in expected]) == [0] * 3


def test_equations_with_parameters_in_an_action_are_proved():
    """A turning keeps a.a, which has Casimirs only where s = 0: the claim is refuted with s."""
    assert prove_claims(spec(SPINNING)).holds
    claim = '\n[claims]\ncasimirs = ["dot(a, a)"]\n'
    assert not prove_claims(spec(SPINNING + claim)).holds
    still = spec(SPINNING + claim, ('[["s", "-w"], ["w", "s"]]', '[[0, "-w"], ["w", 0]]'))
    assert prove_claims(still).holds


def test_velocities_and_momenta_stand_along_the_basis():
    """Blocks declared in another order end up at their places of the basis."""
    text = shipped("kirchhoff").path.read_text()
    lines = [x for x in text.splitlines() if x.startswith(("Pi  ", "P   "))]
    exchanged = text.replace("\n".join(lines), "\n".join(reversed(lines)))
    assert exchanged != text
    setting = make_setting(spec(exchanged))
    assert setting.momenta == ("Pi1", "Pi2", "Pi3", "P1", "P2", "P3")
    assert setting.state == ("P1", "P2", "P3", "Pi1", "Pi2", "Pi3")
    moved = derive(spec(exchanged)).rates
    assert list(moved[3:]) + list(moved[:3]) == list(emitted("kirchhoff").rates)


def test_the_sign_is_that_of_the_invariance():
    """+1 left, -1 right."""
    right = spec(RIGID_BODY, ('name = "so(3)"', 'name = "so(3)"\ninvariance = "right"'))
    assert (make_setting(spec()).sign, make_setting(right).sign) == (1, -1)
