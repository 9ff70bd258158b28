"""The kernels written by hand for the benchmarks compute what the generated ones do."""

from __future__ import annotations

import shutil
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from coadjoint.cli.arguments import load_system

BENCHMARKS = Path(__file__).resolve().parents[1] / "benchmarks"
SYSTEMS = ("rigid_body", "heavy_top", "kirchhoff")


@pytest.fixture
def c_kernels(monkeypatch):
    """The benchmark of C kernels, with few calls."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import c_kernels

    monkeypatch.setattr(c_kernels, "CALLS", 1)
    return c_kernels


@pytest.mark.parametrize("name", SYSTEMS)
def test_generated_c_agrees_with_c_by_hand(name, c_kernels, tmp_path):
    """Rates typed from the book in C and generated ones differ by rounding alone."""
    repeat = c_kernels.compiled("repeat", tmp_path).repeat
    hand = c_kernels.compiled(name, tmp_path).hand_rhs
    taken = c_kernels.contest(load_system(name), hand, repeat)
    assert set(taken) == {"generated", "by hand"}


def test_a_wrong_sign_by_hand_is_noticed(c_kernels, tmp_path, monkeypatch):
    """The comparison can fail: turn one sign in the kernel by hand and it does."""
    shutil.copytree(c_kernels.HAND, tmp_path / "hand")
    kernel = tmp_path / "hand" / "heavy_top.c"
    text = kernel.read_text()
    assert "g2 * x3 - g3 * x2" in text
    kernel.write_text(text.replace("g2 * x3 - g3 * x2", "g2 * x3 + g3 * x2"))
    monkeypatch.setattr(c_kernels, "HAND", tmp_path / "hand")
    repeat = c_kernels.compiled("repeat", tmp_path).repeat
    hand = c_kernels.compiled("heavy_top", tmp_path).hand_rhs
    system = load_system("heavy_top")
    monkeypatch.setattr(system, "pack", lambda _: np.arange(1.0, 9.0))
    with pytest.raises(AssertionError):
        c_kernels.contest(system, hand, repeat)


PEER_SYSTEMS = ("rigid_body", "heavy_top", "kirchhoff", "chaplygin_ball", "so8_body")


@pytest.mark.parametrize("name", PEER_SYSTEMS)
def test_equations_of_the_peers_agree_with_generated_rates(name, monkeypatch):
    """Rates typed from the books for heyoka are those of the kernels, and a spoiled one is not."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import peers
    from ensembles import SYSTEMS as CASES

    states, values = peers.initial_states(name, 4), np.array(CASES[name][1], float)
    generated = load_system(name).rhs(states, values, target="numpy")
    by_hand = np.array(peers.EQUATIONS[name](states, values))
    assert np.abs(generated - by_hand).max() <= 1e-15 * 10
    values[1] *= 1.5
    assert np.abs(generated - peers.EQUATIONS[name](states, values)).max() > 1e-3


def test_equal_error_is_read_between_points_in_logarithms(monkeypatch):
    """From (1e-4, 1) to (1e-8, 100) the curve passes 10 at 1e-6; finer than all is None."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    from ensembles import Point, time_at

    points = [Point("x", 0.0, 0, (t, t, t), e, e) for t, e in ((1.0, 1e-4), (100.0, 1e-8))]
    assert time_at(points, 1e-6) == pytest.approx(10.0)
    assert time_at(points, 1e-3) == 1.0
    assert time_at(points, 1e-9) is None


@pytest.fixture
def ensembles(monkeypatch):
    """The benchmark of ensembles."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return import_module("ensembles")


@pytest.mark.parametrize(
    "name",
    [
        "rigid_body",
        "heavy_top",
        "kirchhoff",
        "chaplygin_ball",
        "so4_body",
        "so6_body",
        "so8_body",
    ],
)
def test_peers_have_the_equations_of_the_systems(name, ensembles, monkeypatch):
    """Rates typed from books are those of the systems; a sign that is turned is noticed."""
    peers = import_module("peers")
    states = peers.initial_states(name, 3)
    ensembles.check_equations(name, states)
    right = peers.EQUATIONS[name]
    monkeypatch.setitem(peers.EQUATIONS, name, lambda x, p: [-right(x, p)[0], *right(x, p)[1:]])
    with pytest.raises(AssertionError, match=name):
        ensembles.check_equations(name, states)


def test_times_are_read_between_points_of_the_curve(ensembles):
    """At equal error in logarithms; none where no point is so accurate."""
    point = import_module("results").Point
    points = [
        point(who="x", tolerance=None, order=0, microseconds=(t, t, t), error=e, worst=e)
        for t, e in ((1.0, 1e-4), (4.0, 1e-8))
    ]
    assert ensembles.time_at(points, 1e-6) == pytest.approx(2.0)
    assert ensembles.time_at(points, 1e-2) == 1.0
    assert ensembles.time_at(points, 1e-9) is None
