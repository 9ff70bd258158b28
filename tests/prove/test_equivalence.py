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
