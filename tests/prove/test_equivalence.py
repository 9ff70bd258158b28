"""Equality of routes: every component of the rates is compared, whichever road the routes take."""

from dataclasses import replace

import pytest

from coadjoint.derive import derive, make_setting
from coadjoint.prove import Verdict
from tests.constrained import PARTICLE
from tests.specs import RIGID_BODY, prove_claims, shipped, spec

#: Routes that are compared in velocities, in the state, through a chart, and solve by solve.
COMPARED = {
    "velocities": spec(RIGID_BODY),
    "state": shipped("rigid_body"),
    "chart": replace(shipped("kepler"), routes=("poisson", "alignment")),
    "solves": spec(PARTICLE),
}

FREE = """
title = "A point with a force and friction"
routes = ["nonholonomic", "hamel", "euler-lagrange", "canonical"]
[variables]
q = { role = "coordinate", shape = [2] }
v = { role = "velocity", of = "q" }
[inputs]
u = { default = 0 }
[lagrangian]
l = "v1^2 + v1*v2 + (1 + q1^2)*v2^2 - q1*q2"
[forces]
v = "vector(u, q1)"
[dissipation]
R = "dot(v, v)/2"
"""
COMPARED["written out"] = replace(spec(FREE), routes=("nonholonomic", "euler-lagrange"))


def routes_of(declared):
    """Equations by every route, in one setting."""
    setting = make_setting(declared)
    return [derive(declared, route, setting=setting) for route in declared.routes]


def spoiled(equations, place):
    """Equations with one rate that is larger by 1."""
    rates = tuple(r + (n == place) for n, r in enumerate(equations.exact.rates))
    return replace(equations, exact=replace(equations.exact, rates=rates))


def is_refuted(declared, routes):
    """Whether some equivalence of the routes is refuted."""
    claims = [c for c in prove_claims(declared, routes).claims if c.kind == "equivalence"]
    assert claims
    return any(claim.verdict is Verdict.REFUTED for claim in claims)


@pytest.mark.parametrize("road", COMPARED)
def test_every_component_of_the_rates_is_compared(road):
    """Routes that differ in a single rate are told apart, in the last one as in the first."""
    declared = COMPARED[road]
    first, *others = routes_of(declared)
    assert others
    assert not is_refuted(declared, [first, *others])
    other = others[-1]
    for place in range(len(other.exact.rates)):
        assert is_refuted(declared, [first, spoiled(other, place)]), place


def test_routes_in_a_frame_stand_beside_those_of_coordinates():
    """Without constraints they have the same state; what is emitted has the same names."""
    certificate = prove_claims(spec(FREE))
    certificate.require()
    said = [claim.statement for claim in certificate.claims if claim.kind == "equivalence"]
    assert "nonholonomic and euler-lagrange give the same motion" in said
    first, hamel, lagrange, _ = routes_of(spec(FREE))
    names = [each.components for each in first.exact.emitted]
    assert ("v_momentum1", "v_momentum2") in names
    for other in (hamel, lagrange):
        assert [each.components for each in other.exact.emitted] == names


def test_a_law_of_force_beside_a_route_in_a_frame():
    """The right law is proved, a wrong one refuted."""
    law = "[newton.q]\nforce = '-vector(q1, q2)'\n[lagrangian]"
    changes = (
        (', "hamel", "euler-lagrange", "canonical"', ', "newton"'),
        ("v1^2 + v1*v2 + (1 + q1^2)*v2^2 - q1*q2", "dot(v, v)/2 - dot(q, q)/2"),
        ("[lagrangian]", law),
        ("[inputs]\nu = { default = 0 }\n", ""),
        ('[forces]\nv = "vector(u, q1)"\n[dissipation]\nR = "dot(v, v)/2"', ""),
    )
    declared = spec(FREE, *changes)
    assert not is_refuted(declared, routes_of(declared))
    wrong = spec(FREE, *changes, ("-vector(q1, q2)", "-vector(q1, 2*q2)"))
    assert is_refuted(wrong, routes_of(wrong))
