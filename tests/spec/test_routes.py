"""Routes: one list of names in the schema, the table of starts, the engine and the docs."""

import re
from pathlib import Path
from typing import get_args

import pytest

from coadjoint.derive import ROUTES
from coadjoint.errors import SpecError
from coadjoint.spec.routes import STARTS, energies_of
from coadjoint.spec.schema import RouteName
from tests.specs import RIGID_BODY, spec

DOCS = Path(__file__).parents[2] / "docs" / "routes.md"

OSCILLATOR = """
title = "x"
routes = ["canonical"]
[variables]
q = { role = "coordinate", shape = [2] }
p = { role = "momentum", of = "q" }
[hamiltonian]
h = "dot(p, p)/2 + dot(q, q)/2"
"""


def test_schema_engine_and_docs_know_the_same_routes():
    """A route that one of them lacks cannot be asked for, followed or looked up."""
    names = set(STARTS)
    assert set(get_args(RouteName)) == names
    assert set(ROUTES) == names
    rows = [line for line in DOCS.read_text().splitlines() if line.startswith("| `")]
    assert {name for row in rows for name in re.findall("`([a-z-]+)`", row.split("|")[1])} == names


def test_bracket_that_pairs_nothing_takes_no_lagrangian():
    """Only canonical pairs tell velocities from momenta."""
    assert energies_of("nambu", ("poisson", "nambu")) == ("hamiltonian",)
    assert "lagrangian" in energies_of("canonical", ("poisson", "canonical"))


def test_state_is_declared_order_without_what_follows():
    """Momenta make velocities definitions; without momenta velocities are the state."""
    names = lambda s: [variable.name for variable in s.state]  # noqa: E731
    assert names(spec(OSCILLATOR)) == ["q", "p"]
    both = spec(OSCILLATOR, ("[hamiltonian]", 'v = { role = "velocity", of = "q" }\n[hamiltonian]'))
    assert names(both) == ["q", "p"]
    assert [variable.name for variable in both.defined] == ["v"]
    assert spec(OSCILLATOR).kind == "configuration"
    assert spec().kind == "algebra"


@pytest.mark.parametrize(
    ("text", "change", "key", "found", "said"),
    [
        (OSCILLATOR, ('of = "q"', 'of = "x"'), "variables.p.of", "x", "no coordinate 'x'"),
        (OSCILLATOR, (', of = "q"', ""), "variables.p.role", "momentum", 'of = "q"'),
        (
            OSCILLATOR,
            ("[hamiltonian]", 'P = { role = "momentum", of = "q" }\n[hamiltonian]'),
            "variables.P.of",
            "q",
            "'p' is the momentum of 'q' already",
        ),
        (
            OSCILLATOR,
            ("[hamiltonian]", 's = { role = "coordinate" }\n[hamiltonian]'),
            "variables.s",
            "s",
            "no velocity and no momentum",
        ),
        (
            OSCILLATOR,
            ("[hamiltonian]", 'a = { role = "advected" }\n[hamiltonian]'),
            "variables.a.role",
            "advected",
            "without [algebra]",
        ),
        (OSCILLATOR, ('"canonical"', '"clebsch"'), "routes[1]", "clebsch", "[algebra]"),
        (OSCILLATOR, ('"canonical"', '"newton"'), "routes", "newton", "[newton]"),
        (OSCILLATOR, ('"canonical"', '"euler-lagrange"'), "routes", "lagrangian", "no Lagrangian"),
        (
            RIGID_BODY,
            ('role = "momentum"', 'role = "momentum", of = "Omega"'),
            "variables.Pi.of",
            "Omega",
            "Remove of",
        ),
        (
            RIGID_BODY,
            ("[claims]", '[lax]\nL = "diag(I)"\nM = "diag(I)"\n[claims]'),
            "lax",
            "lax",
            '"lax"',
        ),
    ],
)
def test_slip_in_what_a_route_starts_from_is_refused(text, change, key, found, said):
    """The message says what is missing, or what stands there in vain."""
    with pytest.raises(SpecError) as caught:
        spec(text, change)
    assert (caught.value.key, caught.value.found) == (key, found)
    assert said in str(caught.value)


def test_momenta_that_are_no_state_are_never_emitted():
    """Where the state has velocities, the route canonical is proved equal to another route only."""
    particle = """
title = "x"
routes = ["canonical", "euler-lagrange"]
[variables]
q = { role = "coordinate" }
v = { role = "velocity", of = "q" }
[lagrangian]
l = "v^2/2"
"""
    with pytest.raises(SpecError, match="the state has velocities") as caught:
        spec(particle)
    assert (caught.value.key, caught.value.found) == ("routes[1]", "canonical")
    assert spec(particle, ('"canonical", "euler-lagrange"', '"euler-lagrange", "canonical"'))
