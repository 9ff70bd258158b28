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
    """Report how many mutants of the engine the tests have killed."""
    reports = [report for found in terminalreporter.stats.values() for report in found]
    outcomes = [
        report.outcome
        for report in reports
        if "test_a_mutant_is_killed" in getattr(report, "nodeid", "")
        and getattr(report, "when", "") == "call"  # what was deselected has not run
    ]
    if outcomes:
        killed = outcomes.count("passed")
        terminalreporter.write_line(f"mutants: {killed} killed / {len(outcomes)}")
