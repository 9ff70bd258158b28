"""Shipped fields as they are called: exact waves, what is kept, and points of other numbers."""

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError
from coadjoint.systems import kdv, landau_lifshitz, spin_chain, spin_chain_chiral
from tests.fields import cnoidal_wave, helix, precessing_wave

#: Systems with their exact waves, lengths and parameters.
WAVES = {
    "chiral": (spin_chain_chiral.system, precessing_wave, 10.0, {"L": 10.0}),
    "magnet": (
        landau_lifshitz.system,
        helix,
        20.0,
        {"L": 20.0, "a": [0, 0, 0.6], "B": [0, 0, 0.3]},
    ),
    "kdv": (kdv.system, cnoidal_wave, 12.0, {"L": 12.0, "c": 1.3}),
}


@pytest.mark.parametrize("name", WAVES)
def test_waves_travel_as_they_should(name):
    """Errors fall by 2^4, and by 2^6 with KdV's differences, as the points double.

    In NumPy, whose bits are those of C: a solver in C takes long to compile.
    """
    system, solution, length, parameters = WAVES[name]
    order, errors = 6 if name == "kdv" else 4, []
    end, options = (
        0.5,
        {"method": "dop853", "target": "numpy", "rtol": 1e-12, "atol": 1e-13, "samples": 2},
    )
    for N in (32, 64):
        s = np.arange(N) * length / N
        found = system.resize({"s": N}).simulate(
            solution(s, 0.0)[0].ravel(), (0, end), parameters=parameters, **options
        )
        errors.append(np.abs(found.state[:, -1].reshape(-1, N) - solution(s, end)[0]).max())
    assert errors[1] < 1e-3
    assert abs(np.log2(errors[0] / errors[1]) - order) < 0.3  # with the error of the path


@pytest.mark.parametrize(
    ("system", "kept"),
    [
        (spin_chain.system, {"energy", "P"}),
        (spin_chain_chiral.system, {"energy", "P", "M"}),
        (kdv.system, {"energy", "M"}),
    ],
    ids=lambda each: getattr(each, "name", ""),
)
def test_the_midpoint_keeps_what_is_quadratic(system, kept):
    """Energy and momenta to rounding; a method of order 4 without structure loses them."""
    small = system.resize({"s": 32})
    source = np.random.default_rng(3)
    state = source.normal(size=small.STATE.size) / 4
    by = {}
    for method in ("midpoint", "rk4"):
        found = small.simulate(state, (0, 0.2), step=0.01, method=method, target="numpy", samples=2)
        assert kept <= set(found.drift)
        by[method] = max(np.max(np.abs(found.drift[name])) for name in kept)
    assert by["midpoint"] < 1e-13 < by["rk4"]


def test_spins_keep_their_lengths():
    """The default with a step is the midpoint on spheres, for each point."""
    small = landau_lifshitz.system.resize({"s": 24})
    source = np.random.default_rng(5)
    spins = source.normal(size=(3, 24))
    spins /= np.linalg.norm(spins, axis=0)
    found = small.simulate(spins.ravel(), (0, 0.4), step=0.02, target="numpy", samples=2)
    assert found.settings["method"] == "spherical_midpoint"
    lengths = np.linalg.norm(found.state.reshape(3, 24, -1), axis=0)
    np.testing.assert_allclose(lengths, 1, atol=1e-13)


def test_a_run_without_a_state_begins_at_the_profile():
    """The cosine of Zabusky and Kruskal, sampled when the system was made."""
    default = kdv.system.STATE["m"].default
    expected = np.cos(2 * np.pi * np.arange(256) / 256) / 3
    np.testing.assert_allclose(default, expected, atol=1e-15)
    assert kdv.system.resize({"s": 32}).STATE["m"].default is None


def test_too_few_points_for_the_differences_are_refused():
    """Seven points for KdV's differences of order 6 would meet themselves."""
    with pytest.raises(KernelArgumentError, match="at least 9"):
        kdv.system.resize({"s": 8})
