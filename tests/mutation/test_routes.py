"""Proofs bite: one sign flipped or one term dropped in a derivation, and a certificate refutes it.

Every route that a spec can name is tried, what routes share, and specs themselves. What no
certificate of the named systems refutes must be refuted by a source test; what neither sees fails
here. The summary of the run counts them all.
"""

import json
import subprocess
import sys
from dataclasses import asdict, replace
from pathlib import Path

import pytest

from coadjoint.spec.routes import ROUTES
from tests.mutation.route_mutants import RouteMutant
from tests.mutation.routes import ROUTE_MUTANTS

ROOT = Path(__file__).parents[2]
FAILED = "the judge itself failed"


@pytest.fixture(scope="module")
def judge():
    """A function from a change to what refutes it."""
    server = subprocess.Popen(
        [sys.executable, str(Path(__file__).with_name("route_judge.py"))],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        cwd=ROOT,
    )

    def ask(mutant):
        server.stdin.write(json.dumps(asdict(mutant)) + "\n")
        server.stdin.flush()
        return json.loads(server.stdout.readline())

    with server:
        yield ask
        server.stdin.close()


@pytest.mark.parametrize("mutant", ROUTE_MUTANTS, ids=lambda mutant: mutant.name)
def test_a_mutant_is_killed(mutant, judge, record_property):
    """A certificate or a source test refutes the changed derivation."""
    record_property("route", mutant.route)
    found = judge(mutant)
    assert found != FAILED
    assert found, f"nothing refutes {mutant.name}"
    record_property("refuted by", found)


def change(old, new, *systems, tests=()):
    """A change of the Euler-Poincare route, judged by all routes of systems, or by tests."""
    return RouteMutant(
        "", "src/coadjoint/derive/routes/euler_poincare.py", old, new, systems, tests
    )


@pytest.mark.parametrize("system", sorted({s for m in ROUTE_MUTANTS for s in m.systems}))
def test_the_unchanged_engine_is_not_refuted(system, judge):
    """The certificates hold without a change: what is refuted is the change."""
    assert judge(change("def derive(", "def derive(", system)) == ""


@pytest.mark.parametrize("tests", sorted({m.tests for m in ROUTE_MUTANTS} - {()}), ids=" ".join)
def test_the_source_tests_pass_without_a_change(tests, judge):
    """Those that judge what certificates let pass are there, and hold."""
    assert judge(change("def derive(", "def derive(", tests=tests)) == ""


def test_a_change_of_words_survives(judge):
    """The judge can let something pass: another title of a step is no other motion."""
    assert judge(change('"Momenta"', '"Impulses"', "rigid_body")) == ""


def test_a_piece_that_is_not_there_is_no_refutation(judge):
    """A change that cannot be made is a failure of the judge, of a module and of a spec."""
    missing = change("no such piece", "", "rigid_body")
    assert judge(missing) == FAILED
    assert judge(replace(missing, file="derivations/rigid_body.toml")) == FAILED


def test_every_piece_is_there_once():
    """A change of the engine that moves a piece moves the mutant, too."""
    for mutant in ROUTE_MUTANTS:
        found = (ROOT / mutant.file).read_text(encoding="utf-8").count(mutant.old)
        assert found == 1, f"{mutant.old!r} is {found} times in {mutant.file}"
        assert mutant.new != mutant.old
        assert mutant.systems or mutant.tests, mutant.name


def test_every_route_has_mutants():
    """At least four for each route, more than a hundred in all, all different."""
    counts = {route: sum(m.route == route for m in ROUTE_MUTANTS) for route in ROUTES}
    assert min(counts.values()) >= 4, counts
    assert len({(m.file, m.old, m.new) for m in ROUTE_MUTANTS}) == len(ROUTE_MUTANTS) >= 150
    assert len({m.name for m in ROUTE_MUTANTS}) == len(ROUTE_MUTANTS)


@pytest.mark.parametrize(
    "fallacy",
    [
        "dq/dt = p - a put in before varying",
        "dq/dt + rho(xi) q = 0 put in before varying",
        "g^-1 dg/dt = xi put in before varying",
        "the potential +S in the Lax pair",
        "lambda^2 N^2 in the place of lambda N^2",
        "the plus bracket for left invariance",
        "a wrong sign in M of a Lax pair",
        "minus a momentum map",
        "the magnetic bracket of the other sign",
        "a claimed Casimir of the wrong sign",
        "a constraint put in before varying",
        "a constraint without ds/dt",
        "a torque of the other sign",
        "s x Omega in the place of Omega x s",
    ],
)
def test_well_known_mistakes_are_among_them(fallacy):
    """Constraints put in before varying, printed slips and signs that books disagree about."""
    assert [m.fallacy for m in ROUTE_MUTANTS].count(fallacy) == 1
