"""Proofs bite: one sign flipped or one term dropped in a derivation, and a certificate refutes it.

Every route that a spec can name is tried, what routes share, and specs themselves. What no
certificate of the named systems refutes must be refuted by a source test; what neither sees fails
here. The summary of the run counts them all.
"""

import json
import subprocess
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest

from coadjoint.spec.routes import ROUTES
from tests.mutation.mutant import ROOT, Mutant, module
from tests.mutation.routes import ROUTE_MUTANTS

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

    def ask(mutant, text=None):
        request = {
            "file": mutant.file,
            "text": mutant.text() if text is None else text,
            "route": mutant.route,
            "systems": mutant.systems,
            "tests": mutant.tests,
        }
        server.stdin.write(json.dumps(request) + "\n")
        server.stdin.flush()
        return json.loads(server.stdout.readline())

    with server:
        yield ask
        server.stdin.close()


#: Mutants of each route that every run tries, those by hand first; well-known mistakes, too.
REGULAR = 1


def choose_regular():
    """The mutants of every run; the others wait for campaigns."""
    tried, chosen = Counter(), []
    for mutant in ROUTE_MUTANTS:
        by_hand = not mutant.edit or mutant.always
        if by_hand and not mutant.equivalent and (mutant.fallacy or tried[mutant.route] < REGULAR):
            tried[mutant.route] += 1
            chosen.append(mutant)
    return chosen


def in_campaigns(regular, argument):
    """The mark of what belongs to no mutant of every run."""
    return () if argument in regular else pytest.mark.campaign


def killable():
    """The mutants that must be refuted."""
    regular = {mutant.name for mutant in choose_regular()}
    return [
        pytest.param(mutant, marks=in_campaigns(regular, mutant.name), id=mutant.name)
        for mutant in ROUTE_MUTANTS
        if not mutant.equivalent
    ]


#: Controls of every run; the others repeat what the suite proves and tests without a judge.
CONTROLS = 3


def judged():
    """Routes with the systems that judge their mutants."""
    pairs = sorted({(m.route, s) for m in ROUTE_MUTANTS for s in m.systems})
    regular = sorted({(m.route, s) for m in choose_regular() for s in m.systems})[:CONTROLS]
    return [pytest.param(*pair, marks=in_campaigns(regular, pair)) for pair in pairs]


def judging():
    """Source tests that judge mutants."""
    tests = sorted({test for m in ROUTE_MUTANTS for test in m.tests})
    regular = sorted({test for m in choose_regular() for test in m.tests})[:CONTROLS]
    return [pytest.param(test, marks=in_campaigns(regular, test)) for test in tests]


@pytest.mark.parametrize("mutant", killable())
def test_a_mutant_is_killed(mutant, judge, record_property):
    """A certificate or a source test refutes the changed derivation."""
    record_property("route", mutant.route)
    found = judge(mutant)
    assert found != FAILED
    assert found, f"nothing refutes {mutant.name}"
    record_property("refuted by", found)


@pytest.mark.campaign
@pytest.mark.parametrize(
    "mutant", [m for m in ROUTE_MUTANTS if m.equivalent], ids=lambda mutant: mutant.name
)
def test_an_equivalent_mutant_survives(mutant, judge):
    """Nothing refutes it, as the reason beside it says; what is refuted is not equivalent."""
    assert judge(mutant) == ""


def change(line, *systems, tests=()):
    """A change of the Euler-Poincare route, judged by all routes of systems, or by tests."""
    return Mutant(module("derive/euler_poincare"), line, "", systems, tests)


@pytest.mark.parametrize(("route", "system"), judged())
def test_the_unchanged_engine_is_not_refuted(route, system, judge):
    """The certificates hold without a change, by the routes that judge a mutant."""
    assert judge(replace(change("", system), route=route)) == ""


@pytest.mark.parametrize("test", judging())
def test_the_source_tests_pass_without_a_change(test, judge):
    """The tests that judge mutants exist and pass without a change."""
    assert judge(change("", tests=(test,))) == ""


def test_a_change_of_words_survives(judge):
    """A different title of a derivation step changes no equation, so nothing refutes it."""
    assert judge(change("_steps: rewrite 'Reduced Lagrangian' -> 'Lagrangian'", "rigid_body")) == ""


def test_a_change_that_cannot_be_read_is_no_refutation(judge):
    """A module that does not compile is a failure of the judge; a spec that is no TOML, too."""
    assert judge(change("", "rigid_body"), "def") == FAILED
    spec = Mutant("derivations/rigid_body.toml", "", systems=("rigid_body",))
    assert judge(spec) == ""
    assert judge(spec, "[") != ""


def test_every_line_names_one_change():
    """A change of the engine that renames what a line names fails here, with what there is."""
    for mutant in ROUTE_MUTANTS:
        assert mutant.text()
        assert mutant.systems or mutant.tests, mutant.name


def test_every_run_tries_every_route():
    """One mutant of each, and all mistakes that are well known."""
    regular = choose_regular()
    assert {m.route for m in regular} == {m.route for m in ROUTE_MUTANTS}
    assert {m.fallacy for m in ROUTE_MUTANTS} == {m.fallacy for m in regular}
    assert 30 <= len(regular) <= 80


def test_every_route_has_mutants():
    """At least four for each route, more than a hundred in all, all different."""
    counts = {route: sum(m.route == route for m in ROUTE_MUTANTS) for route in ROUTES}
    assert min(counts.values()) >= 4, counts
    assert len({(m.file, m.text()) for m in ROUTE_MUTANTS}) == len(ROUTE_MUTANTS) >= 150
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
