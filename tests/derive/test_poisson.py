"""The Poisson route: canonical and magnetic brackets against Hamilton's equations by hand."""

import pytest
import sympy

from coadjoint.derive import derive
from tests.specs import prove_claims, spec

PENDULUM = """
title = "plane pendulum"
routes = ["poisson"]
[poisson]
canonical = [["q", "p"]]
[variables]
q = { role = "coordinate" }
p = { role = "coordinate" }
[parameters]
g = { default = 1 }
[hamiltonian]
h = "p^2/2 - g*cos(q)"
[claims]
conserved = ["energy"]
"""
#: Two particles; momenta are declared before coordinates, and the pairs cross over.
PAIRS = """
title = "charge in a field"
routes = ["poisson"]
[poisson]
canonical = [["x", "u"], ["y", "v"]]
magnetic = { "{u, v}" = "B*(1 + x^2)" }
[variables]
v = { role = "coordinate" }
x = { role = "coordinate" }
y = { role = "coordinate" }
u = { role = "coordinate" }
[parameters]
B = { default = 1 }
k = { default = 1 }
[hamiltonian]
h = "(u^2 + v^2)/2 + k*x^2*y"
"""


def by_name(equations):
    """Rates by the name of the component."""
    return dict(zip(map(str, equations.state), equations.rates, strict=True))


def test_the_pendulum_is_canonical():
    """dq/dt = p, dp/dt = -g sin q."""
    q, p, g = sympy.symbols("q p g")
    assert by_name(derive(spec(PENDULUM))) == {"q": p, "p": -g * sympy.sin(q)}
    assert prove_claims(spec(PENDULUM)).holds


def test_exchanged_roles_are_exchanged_signs():
    """With [p, q] as the pair, time runs backwards: {p, q} = 1."""
    exchanged = derive(spec(PENDULUM, ('["q", "p"]', '["p", "q"]')))
    assert list(exchanged.rates) == [-rate for rate in derive(spec(PENDULUM)).rates]


def test_pairs_and_fields_go_by_name():
    """dx/dt = u, dy/dt = v, du/dt = B v - h_x, dv/dt = -B u - h_y, in any order of declaration."""
    x, y, u, v, B, k = sympy.symbols("x y u v B k")
    field = B * (1 + x**2)
    equations = derive(spec(PAIRS))
    assert tuple(map(str, equations.state)) == ("v", "x", "y", "u")
    expected = {"x": u, "y": v, "u": field * v - 2 * k * x * y, "v": -field * u - k * x**2}
    assert {n: sympy.expand(r) for n, r in by_name(equations).items()} == {
        n: sympy.expand(r) for n, r in expected.items()
    }


def test_a_pair_in_the_other_order_is_the_opposite_field():
    """{v, u} = B is {u, v} = -B."""
    first = derive(spec(PAIRS, ('"{u, v}" = "B*', '"{v, u}" = "B*')))
    second = derive(spec(PAIRS, ('"{u, v}" = "B*', '"{u, v}" = "-B*')))
    assert first.rates == second.rates != derive(spec(PAIRS)).rates


def test_the_bracket_is_proved_and_nothing_commutes_with_all():
    """A canonical bracket has no Casimirs, with or without a field; a false one is refuted."""
    certificate = prove_claims(spec(PAIRS))
    assert certificate.holds, str(certificate)
    statements = {claim.statement for claim in certificate.claims}
    assert any(text.startswith("there are no Casimirs but constants") for text in statements)
    (refuted,) = prove_claims(spec(PAIRS + '[claims]\ncasimirs = ["k + x"]\n')).refuted
    assert refuted.statement == "k + x is a Casimir"
    assert refuted.counterexample == {}


@pytest.mark.parametrize(("charge", "holds"), [("1", True), ("-1", False)])
def test_the_shifted_momentum_is_conserved(charge, holds):
    """In a constant field v + B x is conserved (k = 0); v - B x is not."""
    changes = [("B*(1 + x^2)", "B"), ("+ k*x^2*y", "+ k*x^2")]
    claim = f'[claims]\nconserved = ["v + {charge}*B*x"]\n'
    assert prove_claims(spec(PAIRS + claim, *changes)).holds is holds
