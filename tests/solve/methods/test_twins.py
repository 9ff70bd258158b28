"""Tests of the methods on coadjoint orbits in C: their bits, and what rounding does to them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.solve.methods.algebras import make_lanes, make_memory
from tests.solve.methods.twins import NAMES, WRITTEN, Compiled, make_twin

CASES = [
    *((macro, "so(3)") for macro in NAMES if "MEAN" in macro), ("COADJOINT_MEAN", "se(3)"),
    # Compositions have the steps of the method that they are made of, which take long on se(3).
    *(pytest.param(macro, "se(3)", marks=pytest.mark.campaign)
      for macro in NAMES if "MEAN" in macro and macro != "COADJOINT_MEAN"),
    *((macro, name) for macro in NAMES if "SPHERICAL" in macro
      for name in ("so(3)", "so(3) x so(3)", "se(3)")),
    *((macro, "so(4)") for macro in NAMES if "ISOSPECTRAL" in macro),
]  # fmt: skip


def make_states(name: str, members: int = 12) -> Any:
    """States of many sizes; the last one is too large for a step, and one is 0."""
    x = np.random.default_rng(11).normal(size=(WRITTEN[name].size, members))
    x *= np.linspace(0.1, 2.0, members)
    x[:, 3] = 0.0
    x[:, -1] *= 20.0
    return x


def run_twin(macro: str, name: str, x: Any, h: float, count: int) -> tuple[Any, ...]:
    """The same in NumPy."""
    method, size = make_twin(WRITTEN[name], macro), np.full(x.shape[1], h)
    memory = make_memory(method, x)
    solved = made = None
    with np.errstate(all="ignore"):
        for _ in range(count):
            x, memory, solved, made = method.advance(make_lanes(x), size, x, memory)
    return x, memory, solved, made


@pytest.mark.parametrize(("macro", "name"), CASES)
def test_bits_are_those_of_numpy(macro: str, name: str, tmp_path: Path) -> None:
    """States, what rounding took of them, sweeps and lanes that are solved are the same in C."""
    x = make_states(name)
    compiled = Compiled(WRITTEN[name], macro, tmp_path)
    count = 1 if NAMES[macro][1] > 2 else 2
    found = compiled.run(x, 0.2, count)
    expected = run_twin(macro, name, x, 0.2, count)
    fine = expected[2]
    assert fine[:-1].all()
    assert not fine[-1]
    assert found[2].tolist() == fine.tolist()
    for one, other in zip(found[:2], expected[:2], strict=True):
        assert one[:, fine].tobytes() == other[:, fine].tobytes()
    assert found[3][fine].tolist() == expected[3][fine].tolist()
    assert len(set(found[3][fine].tolist())) > 1
    assert abs(found[0] - x)[:, 4:-1].min() > 0


@pytest.mark.parametrize(
    ("macro", "name", "one", "other"),
    [
        ("COADJOINT_MEAN", "se(3)", "length * 0.5 * turn[i]", "length * 0.25 * turn[i]"),
        ("COADJOINT_MEAN", "se(3)", "turn[i] + rows[i]", "turn[i]"),
        ("COADJOINT_MEAN", "se(3)", "2.0 * parts", "parts"),
        ("SPHERICAL_MIDPOINT", "se(3)", "1.5 - part * both", "1.25 - 0.5 * part * both"),
        ("SPHERICAL_MIDPOINT", "se(3)", "lean = lean + 2.0", "lean = lean + 1.0"),
        ("ISOSPECTRAL_MIDPOINT", "so(4)", "half * whole[STATE + i]", "whole[STATE + i]"),
        (
            "SPHERICAL_MIDPOINT",
            "so(3)",
            "choose(stays, scale, scale",
            "choose(stays, scale * rest, scale",
        ),
        ("SPHERICAL_MIDPOINT", "so(3)", "arc->low[i] + half", "half"),
        ("SPHERICAL_MIDPOINT", "so(3)", "3.0 * (last[i]", "2.0 * (last[i]"),
        ("COADJOINT_MEAN", "se(3)", "[r] == search->middle", "[r] == following"),
        ("COADJOINT_MEAN", "se(3)", "(int)FEW_ROWS ? 1 : 2", "(int)FEW_ROWS ? 1 : 1"),
        ("ISOSPECTRAL_MIDPOINT", "so(4)", "= search->done & confirm", "= confirm"),
    ],
)
def test_a_spoiled_text_is_caught(
    macro: str, name: str, one: str, other: str, tmp_path: Path
) -> None:
    """Other bits, lanes or sweeps, where a template says something else."""
    x, h = make_states(name), 0.2
    if "done &" not in one:
        x[:, -1] *= 0.01  # solved as others are, which takes less time
    if "parts" in one:
        x = np.tile(10 * x[:, :4], 3)
        h = 0.5
    if "done &" in one:
        h = 8.0
    expected = run_twin(macro, name, x, h, 3)
    found = Compiled(WRITTEN[name], macro, tmp_path, (one, other)).run(x, h, 3)
    same = [
        a.tobytes() == b.astype(a.dtype).tobytes() for a, b in zip(found, expected, strict=True)
    ]
    assert not all(same)


def find_growth(compiled: Compiled, name: str, h: float, count: int, members: int = 8) -> Any:
    """How far Casimirs are from where they began, relative to it."""
    rng = np.random.default_rng(2)
    x = rng.normal(size=(WRITTEN[name].size, members))
    x /= np.linalg.norm(x, axis=0)
    end, memory, solved, _ = compiled.run(x, h, count)
    low = memory[: len(x)]
    assert solved.all()

    def casimirs(y: Any) -> Any:
        y = y.astype(np.longdouble)
        if len(y) == 3:
            return np.array([(y * y).sum(axis=0)])
        if name.startswith("so(4)"):
            return np.array([(y * y).sum(axis=0), y[0] * y[5] - y[1] * y[4] + y[2] * y[3]])
        if "x" in name:
            return np.array([(y[:3] ** 2).sum(axis=0), (y[3:] ** 2).sum(axis=0)])
        return np.array([(y[3:] ** 2).sum(axis=0), (y[:3] * y[3:]).sum(axis=0)])

    return np.abs(casimirs(end + low.astype(np.longdouble)) - casimirs(x)).max(axis=1)


@pytest.mark.usefixtures("optimized")
@pytest.mark.parametrize(
    ("macro", "name"),
    [("COADJOINT_MEAN", "free body"),
     *(pytest.param("COADJOINT_MEAN", name, marks=pytest.mark.campaign)
       for name in ("heavy top", "so(4)")),
     ("SPHERICAL_MIDPOINT", "free body"), ("SPHERICAL_MIDPOINT", "heavy top"),
     ("SPHERICAL_MIDPOINT", "so(3) x so(3)"), ("ISOSPECTRAL_MIDPOINT", "so(4)")],
)  # fmt: skip
def test_rounding_does_not_accumulate(macro: str, name: str, tmp_path: Path) -> None:
    """Casimirs stay within 1e-12 over 1e6 steps."""
    growth = find_growth(Compiled(WRITTEN[name], macro, tmp_path), name, 0.1, 1_000_000)
    assert (growth < 1e-12).all()


def test_an_early_end_of_sweeps_is_caught(tmp_path: Path) -> None:
    """To stop where a sweep changes less than 2^-44 lets Casimirs drift."""
    spoil = (
        ("enum { ASKED = EXACT }", "enum { ASKED = FREE }"),
        ("small & ((change == 0.0) | turn->turned)", "small"),
    )
    compiled = Compiled(WRITTEN["free body"], "SPHERICAL_MIDPOINT", tmp_path, *spoil)
    assert (find_growth(compiled, "free body", 0.1, 1_000_000) > 1e-12).all()
