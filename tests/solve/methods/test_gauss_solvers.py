"""Tests of the methods of Gauss as `simulate` has them: bits of C and NumPy, and what is kept."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from coadjoint.build.compiler import CompilerWarning
from coadjoint.declared import KernelContext, Quantity
from coadjoint.render.kernels import render_system
from coadjoint.solve import kernels
from coadjoint.solve.folders import load_folder
from coadjoint.solve.system import System
from tests.programs import program

METHODS = ("gauss4", "gauss6", "gauss8")


def make_context(rates: str = "y*z; -2*x*z; x*y") -> KernelContext:
    """Euler's equations in form: ``x^2 + y^2 + z^2`` and ``2 x^2 + y^2`` are kept."""
    parts = [("rhs", rates, (3,)),
             ("jacobian", "0; z; y; -2*z; 0; -2*x; y; x; 0", (3, 3)),
             ("energy", "x*x + y*y/2", ()),
             ("observables", "x*x + y*y/2; x*x + y*y + z*z", (2,))]  # fmt: skip
    return KernelContext(
        name="turning",
        spec="derivations/turning.toml",
        license="",
        routes=("Typed by hand.",),
        equations=("dx/dt = y z", "dy/dt = -2 x z", "dz/dt = x y"),
        state=tuple(Quantity(each, (), "1", (each,)) for each in "xyz"),
        parameters=(),
        observables=(
            Quantity("energy", (), "1", ("energy",), conserved=True),
            Quantity("square", (), "1", ("square",), conserved=True),
        ),
        programs=tuple(program(name, "x y z", "", "", text, shape) for name, text, shape in parts),
    )


def write(context: KernelContext, place: Path, spoil: tuple[str, str] | None = None) -> System:
    """A System in a folder, with something else in its solver in C."""
    place.mkdir()
    for file, text in render_system(context).items():
        if spoil and file == "solver.c":
            assert spoil[0] in text, spoil[0]
            text = text.replace(*spoil)
        (place / file).write_text(text)
    return load_folder(place)


def make_states(count: int = 21) -> np.ndarray:
    """States of several sizes, one of them at rest."""
    states = np.random.default_rng(2).normal(size=(3, count)) * np.linspace(0.2, 1.5, count)
    states[:, 4] = 0.0
    return states


@pytest.mark.parametrize("method", METHODS)
def test_c_has_the_bits_of_numpy(method: str, tmp_path: Path) -> None:
    """States at ends of steps and, by the cubic, between them."""
    system = write(make_context(), tmp_path / "turning")
    given = {"method": method, "step": 0.1, "samples": 33}
    one = system.simulate(make_states(), (0, 10), target="c", **given)
    other = system.simulate(make_states(), (0, 10), target="numpy", **given)
    assert (one.status == "OK").all()
    assert one.state.tobytes() == other.state.tobytes()
    assert abs(one.state[:, 5:, -1] - one.state[:, 5:, 0]).min() > 0


@pytest.mark.parametrize(
    ("method", "found", "put"),
    [
        ("gauss4", ": 0.5 * arc->length;", ": 0.25 * arc->length;"),
        ("gauss8", "total + stage_shares[s][j]", "total - stage_shares[s][j]"),
        ("gauss6", "found &= following[r] == search->middle[r]", "found &= ~(I){0}"),
        ("gauss4", "V total = arc->low[i]", "V total = 0.0 * arc->low[i]"),
        ("gauss8", "V added = rise + *low", "V added = rise + 0.0 * *low"),
    ],
)
def test_spoiled_text_is_caught(
    method: str, found: str, put: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another share, sum or stopping rule in the template has other bits than NumPy."""
    monkeypatch.setattr(kernels, "_said", set())
    system = write(make_context(), tmp_path / "turning", (found, put))
    with pytest.warns(CompilerWarning, match=f"{method} of turning.*differs from its NumPy twin"):
        system.simulate(make_states(), (0, 10), target="c", method=method, step=0.1, samples=9)


@pytest.mark.parametrize("method", METHODS)
def test_both_integrals_are_kept(method: str, tmp_path: Path) -> None:
    """Over 20000 steps they stay within 3e-14, and RK4 loses them."""
    system = write(make_context(), tmp_path / "turning")
    start = np.array([0.3, -0.7, 0.9])
    kept = system.simulate(start, (0, 2000), method=method, step=0.1, samples=101)
    lost = system.simulate(start, (0, 2000), method="rk4", step=0.1, samples=101)
    assert set(kept.drift) == {"energy", "square"}
    assert max(kept.drift.values()) < 3e-14
    assert min(lost.drift.values()) > 1e-9


def test_a_wrong_sign_of_a_rate_loses_an_integral(tmp_path: Path) -> None:
    """The rates are spoiled, and what was kept is not."""
    system = write(make_context("y*z; -2*x*z; -x*y"), tmp_path / "turning")
    found = system.simulate(np.array([0.3, -0.7, 0.9]), (0, 2), method="gauss6", step=0.1)
    assert found.drift["square"] > 1e-3


def test_a_step_that_is_too_long_is_told(tmp_path: Path) -> None:
    """The status, where it was, and what to do; shorter steps are solved."""
    system = write(make_context(), tmp_path / "turning")
    start = np.array([30.0, -70.0, 90.0])
    found = system.simulate(start, (0, 1), method="gauss8", step=0.1)
    assert found.status == "NOT_SOLVED"
    assert "take shorter steps" in found.message
    assert system.simulate(start, (0, 1), method="Gauss8", step=0.001).status == "OK"


def test_the_text_names_the_theorem() -> None:
    """Each method stands in the solver's head with its source."""
    text = render_system(make_context())["solver.c"]
    assert all(f"-D{name.upper()} makes the method of Gauss" in text for name in METHODS)


def test_sweeps_are_counted(tmp_path: Path) -> None:
    """More in longer steps, of each member, and in a file; explicit methods have none."""
    system = write(make_context(), tmp_path / "turning")
    few, many = (
        system.simulate(make_states(), (0, 2), method="gauss4", step=step)
        for step in (0.03125, 0.25)
    )
    assert few.sweeps.shape == many.sweeps.shape == (21,)
    assert 3 < few.sweeps[20] / few.steps[20] < many.sweeps[20] / many.steps[20] < 100
    assert few.member(20).sweeps == few.sweeps[20]
    assert system.simulate(make_states(), (0, 2), method="rk4", step=0.1).sweeps is None
