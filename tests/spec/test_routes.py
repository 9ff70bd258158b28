"""Routes: one list of names in the schema, the table of starts, the engine and the docs."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import coadjoint
from coadjoint.derive.registry import load_route
from coadjoint.errors import SpecError
from coadjoint.spec.routes import ROUTES, energies_of
from tests.specs import RIGID_BODY, prove_claims, spec

DOCS = Path(__file__).parents[2] / "docs" / "routes.md"
PACKAGE = Path(coadjoint.__file__).parent

OSCILLATOR = """
title = "x"
routes = ["canonical"]
[variables]
q = { role = "coordinate", shape = [2] }
p = { role = "momentum", of = "q" }
[hamiltonian]
h = "dot(p, p)/2 + dot(q, q)/2"
"""


def test_engine_and_docs_know_the_registered_routes():
    """Every registered route has a module and a row of the docs; every module is registered."""
    names = set(ROUTES)
    assert all(callable(load_route(name)) for name in names)
    modules = {path.stem for path in PACKAGE.glob("derive/routes/*.py")} - {"__init__"}
    assert modules == {route.module for route in ROUTES.values()}
    rows = [line for line in DOCS.read_text().splitlines() if line.startswith("| `")]
    assert {name for row in rows for name in re.findall("`([a-z-]+)`", row.split("|")[1])} == names


#: A route as a person would add it: it differs from Euler-Poincare in the sign of what it is given.
NEW = """
from dataclasses import replace
from coadjoint.derive.routes import euler_poincare

def symbols(spec):
    return ("sigma",)

def derive(setting):
    found = euler_poincare.derive(setting)
    assert setting.field["sigma"] != 0
    rates = tuple(SIGN * rate for rate in found.exact.rates)
    return replace(found, route="new-route", exact=replace(found.exact, rates=rates))
"""
#: What it takes to prove it equal to another.
PROVE = """
import sys
from coadjoint.prove import prove
from coadjoint.spec import read_spec
claims = [c for c in prove(read_spec(sys.argv[1])).claims if "new-route give" in c.statement]
print(*[claim.verdict.value for claim in claims])
"""


@pytest.mark.parametrize(("sign", "verdict"), [("1", "proved"), ("-1", "refuted")])
def test_new_route_is_one_file_and_one_line(tmp_path, sign, verdict):
    """A module and a line make a route that specs can list, proved equal or refuted."""
    copy = shutil.copytree(PACKAGE, tmp_path / "coadjoint", ignore=shutil.ignore_patterns("*.pyc"))
    (copy / "derive/routes/new_route.py").write_text(NEW.replace("SIGN", sign))
    table = copy / "spec/routes.py"
    last = '    _in_frame("hamel", emitted=False),\n'
    assert table.read_text().count(last) == 1
    table.write_text(table.read_text().replace(last, last + '    _on_algebra("new-route"),\n'))
    sample = tmp_path / "sample.toml"
    sample.write_text(RIGID_BODY.replace('"lie-poisson"', '"new-route"'))
    found = subprocess.run(
        [sys.executable, "-c", PROVE, str(sample)],
        env=os.environ | {"PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert found.stdout.split() == [verdict]


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
        (OSCILLATOR, ('"canonical"', '"newton"'), "routes[1]", "newton", "[newton]"),
        (
            OSCILLATOR,
            ('"canonical"', '"euler-lagrange"'),
            "routes[1]",
            "euler-lagrange",
            "no Lagrangian",
        ),
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


POINT = """
title = "x"
routes = ["FIRST", "OTHER"]
[variables]
q = { role = "coordinate" }
v = { role = "velocity", of = "q" }
[lagrangian]
l = "v^2/2"
"""


@pytest.mark.parametrize(
    ("first", "other", "said"),
    [
        ("canonical", "euler-lagrange", "the state has velocities"),
        ("euler-lagrange", "nonholonomic", "here it is there to be proved equal"),
    ],
)
def test_a_route_in_other_variables_is_not_the_first(first, other, said):
    """Where another route gives the state; put behind that one it is proved equal to it."""
    with pytest.raises(SpecError, match=said) as caught:
        spec(POINT, ("FIRST", first), ("OTHER", other))
    assert (caught.value.key, caught.value.found) == ("routes[1]", first)
    assert f'Put "{other}" first.' in str(caught.value)
    assert prove_claims(spec(POINT, ("FIRST", other), ("OTHER", first))).holds


@pytest.mark.parametrize("other", ["euler-poincare", "lie-poisson", "clebsch", "newton-euler"])
@pytest.mark.parametrize("place", [0, 1])
def test_routes_of_momenta_are_refused_beside_velocities_in_the_state(other, place):
    """Over an algebra the two have different states; the advice is followed and leads on."""
    routes = ["nonholonomic"]
    routes.insert(place, other)
    body = (('Pi = { role = "momentum" }\n', ""), ('casimirs = ["dot(Pi, Pi)"]', ""))
    given = ('["euler-poincare", "lie-poisson"]', str(routes).replace("'", '"'))
    with pytest.raises(SpecError, match="moves momenta, and the state has velocities") as caught:
        spec(RIGID_BODY, *body, given)
    assert (caught.value.key, caught.value.found) == (f"routes[{place + 1}]", other)
    assert f'Remove "{other}"' in str(caught.value)
    assert spec(RIGID_BODY, *body, (given[0], '["nonholonomic"]'))
