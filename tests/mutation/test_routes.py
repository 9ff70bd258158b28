"""Proofs bite: one sign flipped or one term dropped in a derivation, and a certificate refutes it.

Every route that a spec can name is tried. What no certificate of the named systems refutes must be
refuted by a source test; what neither sees fails here. The summary of the run counts them all.
"""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from coadjoint.derive import ROUTES
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

    def ask(file, old, new, systems, tests=()):
        request = {"file": file, "old": old, "new": new, "systems": systems, "tests": tests}
        server.stdin.write(json.dumps(request) + "\n")
        server.stdin.flush()
        return json.loads(server.stdout.readline())

    with server:
        yield ask
        server.stdin.close()


@pytest.mark.parametrize("mutant", ROUTE_MUTANTS, ids=lambda mutant: mutant.name)
def test_a_mutant_is_killed(mutant, judge, record_property):
    """A certificate or a source test refutes the changed derivation."""
    found = judge(mutant.file, mutant.old, mutant.new, mutant.systems, mutant.tests)
    assert found != FAILED
    assert found, f"nothing refutes {mutant.name}"
    record_property("refuted by", found)


@pytest.mark.parametrize("system", sorted({s for m in ROUTE_MUTANTS for s in m.systems}))
def test_the_unchanged_engine_is_not_refuted(system, judge):
    """The certificates hold without a change: what is refuted is the change."""
    same = "def derive("
    assert judge("derive/euler_poincare.py", same, same, [system]) == ""


def test_a_change_of_words_survives(judge):
    """The judge can let something pass: another title of a step is no other motion."""
    found = judge("derive/euler_poincare.py", '"Momenta"', '"Impulses"', ["rigid_body"])
    assert found == ""


def test_every_route_has_mutants():
    """At least two for each route, more than forty in all, all different."""
    counts = {route: sum(m.route == route for m in ROUTE_MUTANTS) for route in ROUTES}
    assert min(counts.values()) >= 2, counts
    assert len({(m.file, m.old, m.new) for m in ROUTE_MUTANTS}) == len(ROUTE_MUTANTS) >= 40
