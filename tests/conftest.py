"""What the tests share: the shipped specs, and exact random points."""

from __future__ import annotations

import gc
import os
import random
import re
import signal
import tomllib
from collections import Counter
from fractions import Fraction
from pathlib import Path

import pytest

from coadjoint.build.compiler import OPTIMIZE
from coadjoint.resources import derivations_folder
from tests import specs

# Trees of expressions make no cycles, and many are alive: collections would only look at them.
gc.set_threshold(500_000, 20, 100)
# A run in the background ignores Ctrl-C, and its children would, too: tests send it to them.
signal.signal(signal.SIGINT, signal.default_int_handler)


_TEXTS = {
    path.stem: path.read_text(encoding="utf-8")
    for path in sorted(Path(derivations_folder()).glob("*.toml"))
}
#: Systems with an index whose members are all written out; tests/spec/test_windows.py sees to it.
WRITTEN = ("n_link_chain", "so8_body")
#: Fields along a coordinate of space, systems whose state is written out, and N equal members, or
#: entries of matrices of N rows.
FIELDS = tuple(name for name, text in _TEXTS.items() if "\n[space]\n" in text)
SYSTEMS = tuple(
    name
    for name, text in _TEXTS.items()
    if name in WRITTEN
    or (re.search(r"^\[(index|truncation)\]$", text, re.MULTILINE) is None and name not in FIELDS)
)
FAMILIES = tuple(name for name in _TEXTS if name not in (*SYSTEMS, *FIELDS))
#: The routes of each system, for lists of cases: to read the whole specs takes a second.
ROUTES_OF = {name: tuple(tomllib.loads(_TEXTS[name])["routes"]) for name in SYSTEMS}


@pytest.fixture(params=SYSTEMS)
def system(request: pytest.FixtureRequest) -> str:
    """The name of each shipped system in turn."""
    return str(request.param)


def rational_points(names, count, seed=0):
    """Random nonzero rationals by name."""
    source = random.Random(seed)
    return [
        {
            n: Fraction(source.choice((-1, 1)) * source.randint(1, 99), source.randint(1, 20))
            for n in names
        }
        for _ in range(count)
    ]


#: Seconds of processor time that one test may take in its own process. Children have limits of
#: their own; time by the clock decides nothing, since the machine may be busy with other work.
PROCESSOR_SECONDS = 300


def pytest_configure(config):
    """Where campaigns are run, proofs of claims are whole certificates."""
    everything = "not campaign" not in config.option.markexpr
    specs.SEARCH_EVERYWHERE = everything
    if not everything:  # what compilers make of a text is for tests of compilers and of the ladder
        os.environ.setdefault(OPTIMIZE, "0")


@pytest.fixture(scope="session")
def shared_folder(tmp_path_factory):
    """A folder of all processes of a run."""
    folder = tmp_path_factory.getbasetemp()
    return folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder


@pytest.fixture(scope="session")
def shared_cache(shared_folder):
    """Their cache, which holds nothing of the user's."""
    return shared_folder / "shared-cache"


@pytest.fixture
def optimized(monkeypatch):
    """Compilers do for a test what they do for users."""
    monkeypatch.delenv(OPTIMIZE, raising=False)


#: Names of all that was collected, before some of it is left out.
COLLECTED = pytest.StashKey[frozenset[str]]()
#: Cases that take more than a tenth of a second of processor time, where a shorter one of the same
#: test is left: only under `make test-all`. Times are those of a whole run, children counted.
LONG_CASES = frozenset(
    line
    for line in (Path(__file__).parent / "long_cases.txt").read_text(encoding="utf-8").splitlines()
    if line and not line.startswith("#")
)


@pytest.hookimpl(tryfirst=True)  # what is marked here is left out by those that come later
def pytest_collection_modifyitems(config, items):
    """Long cases are marked; the longest test comes first: it works in processes of its own."""
    config.stash[COLLECTED] = frozenset(item.nodeid for item in items)
    for item in items:
        if item.nodeid in LONG_CASES:
            item.add_marker(pytest.mark.long)
    items.sort(key=lambda item: item.name != "test_the_checked_in_tree_is_current")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item):
    """End a test that computes for too long."""

    def stop(_signal, _frame):
        pytest.fail(f"{item.name} took more than {PROCESSOR_SECONDS} s of processor time")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, PROCESSOR_SECONDS)
    try:
        return (yield)
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def pytest_terminal_summary(terminalreporter):
    """Report the mutants of the engine that were killed, and the cases of the adversary."""
    reports = [
        report
        for found in terminalreporter.stats.values()
        for report in found
        if "test_a_mutant_is_killed" in getattr(report, "nodeid", "")
        and getattr(report, "when", "") == "call"  # what was deselected has not run
    ]
    if reports:
        terminalreporter.write_line(f"mutants: {_score(reports)}")
    by_route = {}
    for report in reports:
        by_route.setdefault(dict(report.user_properties).get("route"), []).append(report)
    for route in sorted(by_route.keys() - {None}):
        terminalreporter.write_line(f"  {route}: {_score(by_route[route])}")
    verdicts = Counter()
    for found in terminalreporter.stats.values():
        for report in found:
            if getattr(report, "when", "") == "call":
                verdicts.update(dict(report.user_properties).get("adversary", {}))
    if verdicts:
        told = ", ".join(f"{count} {kind}" for kind, count in sorted(verdicts.items()))
        terminalreporter.write_line(f"adversary: {verdicts.total()} cases: {told}")


def _score(reports):
    """``3 killed / 4``."""
    killed = sum(report.outcome == "passed" for report in reports)
    return f"{killed} killed / {len(reports)}"
