"""The examples run, and what they compute is what they say."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


@pytest.fixture
def example(tmp_path, monkeypatch):
    """The names of an example, run as a module and not as a script."""
    monkeypatch.setenv("COADJOINT_CACHE", str(tmp_path))
    return lambda name: runpy.run_path(str(EXAMPLES / f"{name}.py"))


def test_precession_is_near_the_rule_of_thumb(example):
    """The mean rate of a fast top is within 1 % of m g chi / (I3 Omega3), and not equal to it."""
    ratio = example("heavy_top_precession")["main"]()
    assert 1e-4 < abs(ratio - 1) < 1e-2


def test_every_member_of_the_ensemble_keeps_its_energy(example):
    """A thousand steps of order 4 with step 0.01 lose less than 1e-8 of any member's energy."""
    assert 0 < example("ensemble")["main"](1001) < 1e-8


def test_the_rotor_stabilises_the_middle_axis(example):
    """Below L = 1/3 the body turns over, above it stays."""
    strayed = example("own_system")["main"]()
    assert [fall > 0.5 for fall in strayed.values()] == [True, True, False, False]
    assert all(fall < 0.01 for L, fall in strayed.items() if L > 1 / 3)


def test_the_rigid_body_moves_as_a_pendulum(example, tmp_path):
    """The angle on the elliptic cylinder follows the pendulum's equation; the picture is drawn."""
    difference, span = example("rigid_body_as_pendulum")["main"](str(tmp_path / "body.png"))
    assert difference < 1e-7  # the body is integrated with a relative tolerance of about 1e-9
    assert span > 1.0
    assert (tmp_path / "body.png").stat().st_size > 10_000


def test_the_rattleback_turns_round_one_way_only(example, tmp_path):
    """Against its sense the spin changes its sign, with it it stays; the trace is drawn."""
    last = example("rattleback")["main"](str(tmp_path / "trace.png"))
    assert last[-5.0] > 1
    assert last[5.0] > 4.5
    assert (tmp_path / "trace.png").stat().st_size > 10_000


def test_every_example_has_its_test():
    """No script of the folder is left out here."""
    tested = Path(__file__).read_text(encoding="utf-8")
    scripts = sorted(path.stem for path in EXAMPLES.glob("*.py"))
    assert len(scripts) == 5
    assert all(f'example("{name}")' in tested for name in scripts)
