"""Hamilton's equations in velocities, where no closed form gives these of the momenta."""

import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.derive.routes import canonical
from tests.specs import prove_claims, spec

#: A magnetic term that depends on the place, and a time-dependent one.
QUARTIC = """
title = "A particle in the plane with a quartic energy"
routes = ["euler-lagrange", "canonical"]
[variables]
x = { role = "coordinate", shape = [2], default = [1, 2] }
v = { role = "velocity", of = "x" }
[parameters]
a = { positive = true, default = 1 }
[time]
name = "t"
[forces]
v = "vector(-v1^3, 0)"
[lagrangian]
l = "dot(v, v)/2 + v1^4/4 + v1^2*v2^2 + v2^4/3 + a*x1*x2*v1 + sin(t)*v2 - x1^2/2 - x2^2*x1"
"""
#: Four velocities that the mass matrix couples.
COUPLED = """
title = "Four coupled coordinates"
routes = ["euler-lagrange", "canonical"]
[variables]
x = { role = "coordinate", shape = [4], default = [1, 2, 3, 4] }
v = { role = "velocity", of = "x" }
[lagrangian]
l = '''
dot(v, v)/2 + (v1 + v2)^2*x1^2/2 + (v2 + v3)^2*x2^2/2 + (v3 + v4)^2/2 + (v4 + v1)^2/2 + x1*x2*v1
- x1^2/2 - x2^2*x1 - x3*x4
'''
[claims]
conserved = ["energy"]
"""


@pytest.mark.parametrize("text", [QUARTIC, COUPLED], ids=["quartic", "coupled"])
def test_they_are_proved_to_give_the_same_motion(text):
    """Next to Euler and Lagrange's equations, with forces and time."""
    claims = prove_claims(spec(text)).claims
    assert all(claim.verdict.name == "PROVED" for claim in claims)
    assert any("canonical give the same motion" in claim.statement for claim in claims)


@pytest.mark.parametrize("text", [QUARTIC, COUPLED], ids=["quartic", "coupled"])
def test_another_two_form_is_refuted(monkeypatch, text):
    """Without the transpose of dp/dq the two-form would not be antisymmetric in dq."""
    monkeypatch.setattr(canonical, "transpose", lambda matrix: matrix)
    (same,) = [c for c in prove_claims(spec(text)).claims if "give the same motion" in c.statement]
    assert same.verdict.name == "REFUTED"


def test_they_have_the_form_on_paper():
    """(1 + 3 v^2) v' = -q of ``v^2/2 + v^4/4 - q^2/2``."""
    text = QUARTIC.replace(", shape = [2], default = [1, 2]", "").split("[parameters]")[0]
    equations = derive(spec(text + '[lagrangian]\nl = "v^2/2 + v^4/4 - x^2/2"\n'), "canonical")
    x, v = sympy.symbols("x v")
    assert equations.chart is None
    rates = dict(zip(map(str, equations.state), equations.rates, strict=True))
    assert rates["x"] == v
    assert sympy.cancel(rates["v"] + x / (1 + 3 * v**2)) == 0


def test_what_has_a_closed_form_is_moved_in_momenta_of_its_own():
    """A quadratic Lagrangian gives a chart of (q, p), as before."""
    text = QUARTIC.split("[time]")[0] + '[lagrangian]\nl = "a*dot(v, v)/2 - x1^2/2"\n'
    assert derive(spec(text), "canonical").chart is not None
