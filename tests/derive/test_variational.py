"""Constraints imposed before the variation: normal extremals.

The area constraint is that of the Heisenberg group (Holm 2011, section 4.3.4; Montgomery 2002).
"""

from dataclasses import replace

import numpy as np
import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.derive.mechanics import legendre
from coadjoint.derive.mechanics.variational import normal_extremals
from coadjoint.derive.routes import canonical
from coadjoint.errors import DerivationError, SpecError
from coadjoint.prove import Verdict
from tests.specs import prove_claims, spec

PLANE = """
title = "Curves and their areas"
routes = ["canonical"]
[variables]
x = { role = "coordinate" }
y = { role = "coordinate" }
z = { role = "coordinate" }
px = { role = "momentum", of = "x" }
py = { role = "momentum", of = "y" }
pz = { role = "momentum", of = "z" }
u = { role = "velocity", of = "x" }
v = { role = "velocity", of = "y" }
w = { role = "velocity", of = "z" }
[lagrangian]
l = "(u^2 + v^2)/2"
[constraints]
area = "w == (x*v - y*u)/2"
variational = true
[claims]
conserved = ["energy"]
"""
GROUP = """
title = "The same on the group"
routes = ["lie-poisson"]
[algebra]
name = "h(1)"
[variables]
xi = { role = "velocity" }
mu = { role = "momentum" }
[lagrangian]
l = "(xi1^2 + xi2^2)/2"
[constraints]
horizontal = "xi3 == 0"
variational = true
[claims]
casimirs = ["mu3"]
conserved = ["energy"]
"""
ON_LINES = [
    ('routes = ["canonical"]', 'routes = ["nonholonomic"]'),
    ("variational = true\n", ""),
    *((f'p{q} = {{ role = "momentum", of = "{q}" }}\n', "") for q in "xyz"),
    ("(u^2 + v^2)/2", "(u^2 + v^2 + w^2)/2"),
]


def test_the_hamiltonian_is_that_of_the_normal_extremals():
    """H = (px - y pz/2)^2/2 + (py + x pz/2)^2/2."""
    equations = derive(spec(PLANE))
    f = equations.setting.field
    x, y, px, py, pz = (f[name] for name in ("x", "y", "px", "py", "pz"))
    by_hand = (px - y * pz / 2) ** 2 / 2 + (py + x * pz / 2) ** 2 / 2
    assert f.is_zero(equations.close(equations.exact.energy) - by_hand)


def test_the_curves_are_circles():
    """Here u' = -pz v and v' = pz u with pz constant, and w is the rate of the area."""
    equations = derive(spec(PLANE))
    rates = dict(zip((s.name for s in equations.state), equations.rates, strict=True))
    symbols = {name: sympy.Symbol(name) for name in rates}
    u, v, w = (equations.velocities[name] for name in ("u", "v", "w"))

    def rate(function):
        return sum(sympy.diff(function, symbols[name]) * rates[name] for name in rates)

    assert rates["pz"] == 0
    assert sympy.expand(rate(u) + symbols["pz"] * v) == 0
    assert sympy.expand(rate(v) - symbols["pz"] * u) == 0
    assert sympy.expand(w - (symbols["x"] * v - symbols["y"] * u) / 2) == 0


def test_dalemberts_principle_gives_straight_lines():
    """The same constraint after the variation: u' and v' are zero at x = y = 0, whatever w."""
    equations = derive(spec(PLANE, *ON_LINES))
    at_rest = {"x": 0, "y": 0, "u": 1, "v": 2}
    moved = dict(zip((s.name for s in equations.state), equations.rates, strict=True))
    assert [moved[name].subs(at_rest) for name in "uv"] == [0, 0]
    free = derive(spec(PLANE))
    at_rest |= {"px": 1, "py": 2, "pz": 3}
    turned = dict(zip((s.name for s in free.state), free.rates, strict=True))
    assert [turned[f"p{q}"].subs(at_rest) for q in "xy"] == [-3, sympy.Rational(3, 2)]


def test_the_group_has_the_same_motion():
    """mu1' = -mu3 mu2, mu2' = mu3 mu1 up to the orientation of the basis, xi = (mu1, mu2, 0)."""
    certificate = prove_claims(spec(GROUP))
    assert certificate.holds, str(certificate)
    equations = derive(spec(GROUP))
    f = equations.setting.field
    mu = [f[f"mu{n}"] for n in (1, 2, 3)]
    first, second, third = equations.exact.rates
    turned = equations.close(first) / (mu[1] * mu[2])
    assert f.as_number(turned) in (1, -1)
    assert f.is_zero(equations.close(second) + turned * mu[0] * mu[2])
    assert f.is_zero(third)
    assert [equations.close(value) for _, value in equations.exact.definitions] == [*mu[:2], f.zero]


def test_the_certificate_says_which_extremals_these_are():
    """The constraint holds, the action is stationary within it, and h is its Hamiltonian."""
    certificate = prove_claims(spec(PLANE))
    assert certificate.holds, str(certificate)
    said = [claim.statement for claim in certificate.claims]
    assert "xi = dh/dmu keeps area at every state" in said
    assert any("normal extremals" in each and "strictly abnormal" in each for each in said)
    assert not any("Legendre transform" in each for each in said)


def refuted(monkeypatch, change):
    """Statements that are refuted of changed extremals."""

    def spoil(setting):
        return change(normal_extremals(setting), setting.field)

    monkeypatch.setattr(legendre, "normal_extremals", spoil)
    monkeypatch.setattr(canonical, "normal_extremals", spoil)
    certificate = prove_claims(spec(PLANE))
    return [c.statement for c in certificate.claims if c.verdict is Verdict.REFUTED]


def test_another_hamiltonian_is_refuted(monkeypatch):
    """A term of its own gives other velocities, and another energy."""
    wrong = refuted(monkeypatch, lambda it, f: replace(it, energy=it.energy + f["py"] ** 2))
    assert "xi = dh/dmu" in wrong
    assert "h = <mu, xi> - l at xi = dh/dmu" in wrong


def test_other_velocities_are_refuted(monkeypatch):
    """Twice as fast along y the constraint holds, since w follows, and the action grows."""

    def faster(it, field):
        twice = [(n, 2 * value if n == "v" else value) for n, value in it.definitions]
        return replace(it, definitions=tuple(twice))

    wrong = refuted(monkeypatch, faster)
    assert any("normal extremals" in each for each in wrong)
    assert not any("keeps area" in each for each in wrong)


def test_shortest_curves_close_with_their_area():
    """From 0 with u = 1: a circle of radius 1/pz, z = (s - sin s)/(2 pz^2), s = pz t."""
    lam, t = 0.5, 1.25
    state = np.array([0.0, 0.0, 0.0, 1.0, 0.0, lam])
    exact = [
        np.sin(lam * t) / lam,
        (1 - np.cos(lam * t)) / lam,
        (lam * t - np.sin(lam * t)) / (2 * lam**2),
    ]
    equations = derive(spec(PLANE))
    rates = sympy.lambdify([equations.state], equations.rates)
    steps = 2000
    for _ in range(steps):
        h = t / steps
        k1 = np.array(rates(state))
        k2 = np.array(rates(state + h / 2 * k1))
        k3 = np.array(rates(state + h / 2 * k2))
        k4 = np.array(rates(state + h * k3))
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    assert state[:3] == pytest.approx(exact, abs=1e-12)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ([("variational = true", "variational = 1")], "found 1; expected true or false"),
        ([('area = "w == (x*v - y*u)/2"\n', "")], "[constraints] has no constraint"),
        ([('area = "w == (x*v - y*u)/2"', "area = true")], "expected an equation such as"),
        ([("[lagrangian]\nl", "[hamiltonian]\nh"), ("(u^2 + v^2)/2", "px^2")], "has no Lagrangian"),
        ([("[claims]", '[forces]\nx = "-u"\n[claims]')], "comes from a variation, which knows no"),
        ([('"canonical"', '"canonical", "euler-lagrange"')], "does not accept [constraints]"),
    ],
    ids=["no truth", "none", "no text", "no Lagrangian", "forces", "route"],
)
def test_what_is_no_such_constraint_is_refused(changes, said):
    """Before anything is derived."""
    with pytest.raises(SpecError) as caught:
        spec(PLANE, *changes)
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ([("(u^2 + v^2)/2", "u^2/2")], "Add the kinetic energy of every velocity"),
        ([("w == (x*v - y*u)/2", "x*w == y*u + z*v")], "no velocity has a constant factor in area"),
        ([("w == (x*v - y*u)/2", "w^2 == 1")], "is not linear in the velocities"),
    ],
    ids=["massless", "no factor", "square"],
)
def test_what_has_no_hamiltonian_is_refused(changes, said):
    """A direction without kinetic energy, and a constraint that gives no velocity."""
    with pytest.raises(DerivationError) as caught:
        derive(spec(PLANE, *changes))
    assert said in str(caught.value)


def test_false_is_after_the_variation():
    """`variational = false` is what is meant without it."""
    changes = [c for c in ON_LINES if c[0] != "variational = true\n"]
    after = spec(PLANE, *changes, ("variational = true", "variational = false"))
    assert [each.name for each in after.constraints] == ["area"]
    assert derive(after).rates == derive(spec(PLANE, *ON_LINES)).rates
