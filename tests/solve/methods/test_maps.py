"""Methods that are a sequence of maps, as a person runs them, and where they are refused."""

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError
from coadjoint.methods import MAPPED
from coadjoint.solve.folders import load_folder
from tests import specs
from tests.kernels import COMPILER

START = [0.4, 0.9, -0.3, 0.6, 0.0, 0.8]


@pytest.fixture(scope="module")
def load(tmp_path_factory):
    """A System of a shipped spec, rendered now."""

    def make(name):
        folder = tmp_path_factory.mktemp("maps") / name
        folder.mkdir()
        for file, text in specs.rendered(name).texts.items():
            (folder / file).write_text(text)
        return load_folder(folder)

    return make


@pytest.fixture(scope="module")
def top(load):
    """The heavy top."""
    return load("heavy_top")


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
@pytest.mark.parametrize("method", ["splitting", "splitting4", "splitting6", "kahan"])
def test_c_and_numpy_have_the_same_bits(top, method):
    """Of members and of one trajectory, at ends of steps and between them."""
    states = np.array(START)[:, np.newaxis] * np.linspace(0.5, 1.5, 13)
    for state in (START, states):
        runs = [
            top.simulate(state, t=(0, 3), method=method, step=0.0625, samples=31, target=target)
            for target in ("c", "numpy")
        ]
        assert np.array_equal(runs[0].state, runs[1].state)
        assert np.isfinite(runs[0].state).all()


def test_splittings_keep_casimirs_and_bound_the_energy(top):
    """Over a thousand units of time the energy does not drift; RK4's Casimirs do."""
    given = {"m": 1.0, "g": 0.7, "chi": [0.48, 0.36, 0.8]}
    bound = {"splitting": 2e-3, "splitting4": 5e-8, "splitting6": 1e-10}
    for method, most in bound.items():
        run = top.simulate(
            START, t=(0, 1000), method=method, step=0.05, parameters=given, samples=2001
        )
        for row in range(2):
            casimir = run[f"casimir{row + 1}"]
            assert np.abs(casimir - casimir[0]).max() < 1e-12
        assert 0 < run.drift["energy"] < most
    spoilt = top.simulate(START, t=(0, 1000), method="rk4", step=0.05, parameters=given)
    assert spoilt.drift["casimir1"] > 1e-7


def test_the_exact_body_keeps_everything_and_is_the_motion(load):
    """Against the Taylor method at the tightest tolerances."""
    body = load("rigid_body")
    run = body.simulate(START[:3], t=(0, 64), method="exact-body", step=0.5, samples=65)
    other = body.simulate(START[:3], t=(0, 64), rtol=1e-14, atol=1e-15, samples=65)
    assert np.abs(run.state - other.state).max() < 1e-12
    assert max(run.drift.values()) < 1e-14


def test_a_system_without_the_maps_refuses_with_the_reason(load, top):
    """The reason is that of the search."""
    damped = load("heavy_top_damped")
    with pytest.raises(KernelArgumentError, match="what dissipates cannot be followed back"):
        damped.simulate(START, t=(0, 1), method="splitting4", step=0.1)
    with pytest.raises(KernelArgumentError, match="no free motion of three components"):
        top.simulate(START, t=(0, 1), method="exact_body", step=0.1)
    with pytest.raises(KernelArgumentError, match="no estimate of its error; expected step="):
        top.simulate(START, t=(0, 1), method="splitting")


def test_each_method_tells_its_theorem():
    """With a source, and what it keeps."""
    assert [*MAPPED] == ["splitting", "splitting4", "splitting6", "kahan", "exact_body"]
    for each in MAPPED.values():
        assert "20" in each.theorem or "19" in each.theorem
        assert each.keeps
