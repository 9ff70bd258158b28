"""The kernels written by hand for the benchmarks compute what the generated ones do."""

from __future__ import annotations

import shutil
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
