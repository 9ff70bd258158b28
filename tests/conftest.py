"""What the tests share: the shipped specs, and exact random points."""

from __future__ import annotations

import random
from fractions import Fraction
from pathlib import Path

import pytest

from coadjoint.resources import derivations_folder

SYSTEMS = tuple(sorted(path.stem for path in Path(derivations_folder()).glob("*.toml")))


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


def pytest_terminal_summary(terminalreporter):
    """Report how many mutants of the engine the tests have killed, in all and by route."""
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


def _score(reports):
    """``3 killed / 4``."""
    killed = sum(report.outcome == "passed" for report in reports)
    return f"{killed} killed / {len(reports)}"
