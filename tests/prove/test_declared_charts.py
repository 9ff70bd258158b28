"""Declared charts: the same motion in other variables is proved so, and any other is refuted.

Polar coordinates and their equations are those of every textbook (Landau and Lifshitz, Mechanics,
section 14); the canonical pair of a rigid body is Holm's (2011, section 2.5.5).
"""

import pytest

from coadjoint.derive import derive, make_setting
from coadjoint.prove import Verdict
from coadjoint.prove.agreement import about_equality
from coadjoint.prove.zero import Decision, Discovery, decide_zero
from tests.constrained import PARTICLE
from tests.derive.test_advice import SHIFTED
from tests.derive.test_configuration import FREE
from tests.prove.test_reductions import IN_STEP
from tests.specs import RIGID_BODY, prove_claims, spec

PLANE = """
title = "A particle in the plane on a spring"
routes = ["canonical"]
[variables]
x = { role = "coordinate", shape = [2] }
p = { role = "momentum", of = "x" }
[parameters]
m = { positive = true, default = 1 }
k = { default = 1 }
[hamiltonian]
h = "dot(p, p)/(2*m) + k*dot(x, x)/2"
[domain]
away = "dot(x, x) > 0"
[charts.polar]
variables = { r = [], phi = [], pr = [], L = [] }
MOTION
[charts.polar.map]
x = "r*vector(cos(phi), sin(phi))"
p = "pr*vector(cos(phi), sin(phi)) + L/r*vector(-sin(phi), cos(phi))"
"""
HAMILTON = """
hamiltonian = "(pr^2 + L^2/r^2)/(2*m) + k*r^2/2"
pairs = [["r", "pr"], ["phi", "L"]]
"""
RATES = """
rates = { r = "pr/m", phi = "L/(m*r^2)", pr = "L^2/(m*r^3) - k*r", L = "0" }
"""
#: The same in velocities, by Lagrange.
VELOCITIES = """
title = "A particle in the plane on a spring"
routes = ["euler-lagrange"]
[variables]
x = { role = "coordinate", shape = [2] }
v = { role = "velocity", of = "x" }
[parameters]
m = { positive = true, default = 1 }
k = { default = 1 }
[lagrangian]
l = "m*dot(v, v)/2 - k*dot(x, x)/2"
[domain]
away = "dot(x, x) > 0"
[charts.polar]
variables = { r = [], phi = [], u = [], w = [] }
lagrangian = "m*(u^2 + r^2*w^2)/2 - k*r^2/2"
pairs = [["r", "u"], ["phi", "w"]]
[charts.polar.map]
x = "r*vector(cos(phi), sin(phi))"
v = "u*vector(cos(phi), sin(phi)) + r*w*vector(-sin(phi), cos(phi))"
"""
PAIR = """
[charts.pair]
variables = { Q = [3], P = [3] }
map = { Pi = "cross(P, Q)" }
[charts.pair.rates]
Q = "cross(Q, inverse(diag(I))*cross(P, Q))"
P = "cross(P, inverse(diag(I))*cross(P, Q))"
"""
#: Cosine and sine as variables, on their circle.
CIRCLE = """
title = "A plane pendulum"
routes = ["canonical"]
[variables]
phi = { role = "coordinate" }
p = { role = "momentum", of = "phi" }
[hamiltonian]
h = "p^2/2"
[charts.slope]
variables = { s = [], y = [], c = [] }
map = { phi = "s", p = "y" }
where = ["c^2 - y^2"]
rates = { s = "y", y = "0", c = "0" }
"""
MOVING = """
title = "A free particle, seen from a train"
routes = ["canonical"]
time = { unit = "s" }
[variables]
x = { role = "coordinate" }
p = { role = "momentum", of = "x" }
[parameters]
m = { positive = true, default = 1 }
c = { default = 3 }
[hamiltonian]
h = "p^2/(2*m) + 0*t"
[charts.train]
variables = { y = [], w = [] }
map = { x = "y + c*t", p = "m*(w + c)" }
rates = { y = "w", w = "0" }
"""


def about(declared, name):
    """Statement and verdict of every claim about a chart."""
    claims = prove_claims(declared).claims
    found = {c.statement: c.verdict.value for c in claims if f"the chart {name}" in c.statement}
    assert found
    return found


def with_motion(text):
    """The particle in the plane with a motion of its chart."""
    return PLANE.replace("MOTION", text)


@pytest.mark.parametrize(
    "text",
    [with_motion(HAMILTON), with_motion(RATES), VELOCITIES],
    ids=["hamiltonian", "rates", "lagrangian"],
)
def test_polar_coordinates_have_the_same_motion(text):
    """By Hamilton's equations, by rates and by Lagrange's; the chart reaches an open set."""
    found = about(spec(text), "polar")
    assert set(found.values()) == {"proved"}
    assert any("give the same motion, through x = r*vector" in statement for statement in found)
    assert "the chart polar reaches an open set of states" in found


@pytest.mark.parametrize(
    ("text", "change"),
    [
        (HAMILTON, ("+ k*r^2/2", "- k*r^2/2")),
        (HAMILTON, ("L^2/r^2", "L^2")),
        (HAMILTON, ("+ L/r*vector", "- L/r*vector")),
        (HAMILTON, ('"phi", "L"', '"L", "phi"')),
        (RATES, ("L^2/(m*r^3) - k*r", "-L^2/(m*r^3) - k*r")),
        (RATES, ('"L/(m*r^2)"', '"L/(m*r)"')),
        (RATES, ("r*vector(cos(phi), sin(phi))", "r*vector(sin(phi), cos(phi))")),
    ],
)
def test_another_map_or_motion_is_refuted(text, change):
    """A sign, a power or an exchange is no chart of the same motion."""
    found = about(spec(with_motion(text), change), "polar")
    assert [v for statement, v in found.items() if "same motion" in statement] == ["refuted"]


@pytest.mark.parametrize("change", [("r^2*w^2", "r*w^2"), ("+ r*w*vector", "- r*w*vector")])
def test_another_lagrangian_or_map_is_refuted(change):
    """The metric of the plane is dr^2 + r^2 dphi^2."""
    found = about(spec(VELOCITIES, change), "polar")
    assert "refuted" in found.values()


def test_a_canonical_pair_of_the_rigid_body():
    """Pi = P x Q; with the product turned round it is another motion."""
    found = about(spec(RIGID_BODY + PAIR), "pair")
    assert set(found.values()) == {"proved"}
    turned = spec(RIGID_BODY + PAIR, ('"cross(Q, inverse', '"cross(P, inverse'))
    assert "refuted" in about(turned, "pair").values()


def test_relations_of_a_chart_are_kept_or_refuted():
    """c^2 = y^2 stays where c and y do, and not where c moves."""
    found = about(spec(CIRCLE), "slope")
    assert found["the chart slope keeps c^2 - y^2 = 0"] == "proved"
    found = about(spec(CIRCLE, ('c = "0"', 'c = "1"')), "slope")
    assert found["the chart slope keeps c^2 - y^2 = 0"] == "refuted"


def test_a_map_may_move():
    """From the train x = y + c t; a momentum that forgets the train is refuted."""
    assert set(about(spec(MOVING), "train").values()) == {"proved"}
    assert "refuted" in about(spec(MOVING, ("m*(w + c)", "m*w")), "train").values()


#: The particle w = y u: its speed along (1, 0, y) is constant, as its energy and v are.
ALONG = """
[charts.along]
variables = { X = [], Y = [], Z = [], S = [], V = [] }
map = { x = "X", y = "Y", z = "Z", u = "S/sqrt(1 + Y^2)", v = "V" }
[charts.along.rates]
X = "S/sqrt(1 + Y^2)"
Y = "V"
Z = "Y*S/sqrt(1 + Y^2)"
S = "0"
V = "0"
"""
KEPT = (
    ('"w == y*u"', '"w - y*u == 0"'),
    ('v = "V" }', 'v = "V", w = "Y*S/sqrt(1 + Y^2)" }'),
)
#: Two oscillators in step, in a position and a sum of position and momentum.
MIXED = """
[charts.mixed]
variables = { A = [], B = [] }
map = { q1 = "A", p1 = "B - A" }
rates = { A = "B - A", B = "B - 2*A - c*(B - A) + u*sin(t)" }
"""
#: Four coupled points: d2l/dv2 = 1 + J with ones in J, so that its inverse is 1 - J/5.
COUPLED = """
[charts.moving]
variables = { Q = [4], W = [4] }
map = { q = "Q", p = "W + (W1 + W2 + W3 + W4)*vector(1, 1, 1, 1)" }
rates = { Q = "W", W = "(Q1 + Q2 + Q3 + Q4)/5*vector(1, 1, 1, 1) - Q" }
"""
SUM = ("dot(v, v)/2", "dot(v, v)/2 + (v1 + v2 + v3 + v4)^2/2")


def verdicts(text, *changes):
    """Verdict by statement, of what is said of the equality of routes and charts."""
    declared = spec(text, *changes)
    setting = make_setting(declared)
    found = {}
    for statement, _, examine in about_equality([derive(declared, setting=setting)]):
        defects = examine()
        if not isinstance(defects, Decision | Discovery):
            defects = decide_zero(defects, setting.field)
        if isinstance(defects, Decision):  # how far a chart reaches may be a finding
            found[statement] = defects.verdict
    return found


@pytest.mark.parametrize(
    ("text", "changes", "wrong"),
    [
        (PARTICLE + ALONG, (), ('S = "0"', 'S = "S*V"')),
        (PARTICLE + ALONG, KEPT, ('S = "0"', 'S = "S*V"')),
        (IN_STEP + MIXED, (), ("- c*(B - A)", "+ c*(B - A)")),
        (FREE + COUPLED, (SHIFTED, SUM), ("/5*vector", "/4*vector")),
    ],
    ids=["constraint", "kept", "reduction", "solved"],
)
def test_charts_of_every_motion(text, changes, wrong):
    """Under constraints, on a section, and where velocities are solved for; spoiled, refuted."""
    found = verdicts(text, *changes)
    assert set(found.values()) == {Verdict.PROVED}
    assert any("the chart" in each and "same motion" in each for each in found)
    spoiled = verdicts(text, *changes, wrong)
    (false,) = {each for each, verdict in spoiled.items() if verdict is Verdict.REFUTED}
    assert "the chart" in false
    assert "same motion" in false


def test_a_chart_lies_on_the_constraints_that_are_kept():
    """Elsewhere the equations mean nothing."""
    assert verdicts(PARTICLE + ALONG, *KEPT)["the chart along lies where blade = 0"]
    wrong = ('w = "Y*S/sqrt(1 + Y^2)"', 'w = "2*Y*S/sqrt(1 + Y^2)"')
    spoiled = verdicts(PARTICLE + ALONG, *KEPT, wrong)
    assert spoiled["the chart along lies where blade = 0"] is Verdict.REFUTED
